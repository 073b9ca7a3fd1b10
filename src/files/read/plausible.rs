//! Warnings about sizes that are probably in a wrong unit.
//!
//! A size is suspicious if it is more than 20 times the robot's reach, or less than a twentieth of the
//! reach. An elastic error is suspicious if it may rotate a joint by more than 5 degrees. The largest
//! length tolerance is suspicious if it is more than a twentieth of the reach, or less than a millionth
//! of the reach.

use crate::cell::Coordinate;
use crate::cell::{Cell, Equipment, Role};
use crate::cell::{ErrorSet, Parameter, SignedErrors, Tolerance};
use crate::cell::{Shape, extent_of};
use crate::files::fault::Severity;
use crate::files::toml::document::Library;
use crate::files::toml::tree::{At, Node};
use crate::kinematic_error::largest_deflection;
use crate::robot::Chain;
use crate::units::{deg_from_rad, mm_from_m, rounded};

const FACTOR: f64 = 20.0;

/// Deflection of a joint under gravity, degrees, above which an elastic error is probably in a wrong unit.
const MAX_DEFLECTION_DEG: f64 = 5.0;

/// Largest distance, m, by which rounding may put equipment below its supporting surface or beside it.
const MAX_STAND_GAP: f64 = 1e-6;

/// A tolerance is too small for any manufacturing process if it is below this share of the robot's reach.
const LEAST_DEVIATION: f64 = 1e-6;

/// Object with a size, m, and the place in the file at which a warning points.
struct SizedObject {
    what: String,
    at: At,
    size: f64,
}

/// Warns of objects, link solids and tolerances whose size does not fit the reach of the robot. Also warns of
/// implausible elastic errors, and of equipment that does not stand properly on its support.
pub fn warn(cell: &Cell, root: &Node, lib: &mut Library<'_>) {
    let reach = cell.robot.reach();
    let side = |thing: &SizedObject| side(thing.size, reach);
    let reach_mm = millimetres(reach);
    let robot = place_of(root, "robot");
    warn_of_deflections(cell, place_of(root, "errors"), lib);
    if let ErrorSet::Tolerance(set) = cell.error_set() {
        warn_of_tolerance(set, cell.robot.axes(), reach, place_of(root, "errors"), lib);
    }
    warn_of_stands(cell, root, lib);
    let standing = standing(cell, root);
    if let [first, _, ..] = &standing[..]
        && let Some(all) = side(first)
        && standing.iter().all(|thing| side(thing) == Some(all))
    {
        let message = format!(
            "each piece of equipment, obstacle and keep-out box measures {all} the reach of the robot \
             ({reach_mm} mm)"
        );
        lib.fault(robot, Severity::Warning, message, "are the lengths of the robot really in mm?");
        return;
    }
    let sizes = cell.robot.solids.iter().map(|s| extent_size([&s.solid.shape]));
    let what = "the largest solid of the robot".to_string();
    let links = sizes.reduce(f64::max).map(|size| SizedObject { what, at: robot, size });
    for thing in standing.iter().chain(&links) {
        let Some(side) = side(thing) else { continue };
        let size = millimetres(thing.size);
        let message =
            format!("{} measures {size} mm, {side} the reach of the robot ({reach_mm} mm)", thing.what);
        lib.fault(
            thing.at,
            Severity::Warning,
            message,
            "are all lengths really in mm, including the lengths of the robot?",
        );
    }
}

/// Warns if the largest tolerance of an offset, a common normal or a joint frame position is suspicious.
///
/// Angles are not checked, because an angle in a wrong unit has a plausible size, too.
fn warn_of_tolerance(set: &Tolerance, axes: usize, reach: f64, at: At, lib: &mut Library<'_>) {
    let varies_alone = |k: &usize| !set.covariance.iter().any(|c| c.parameters.contains(k));
    let is_length =
        |p: &Parameter| matches!(p, Parameter::Dr(_) | Parameter::Dl(_) | Parameter::Joint(_, 0..3));
    let lengths = Parameter::of_robot(axes).enumerate().filter(|(k, p)| is_length(p) && varies_alone(k));
    let largest = lengths.map(|(k, _)| set.spreads[k].plus_minus).fold(0.0, f64::max);
    let share = if largest > reach / FACTOR {
        "more than a twentieth"
    } else if largest > 0.0 && largest < reach * LEAST_DEVIATION {
        "less than a millionth"
    } else {
        return;
    };
    let message = format!(
        "the largest length tolerance of `{}` (dr_mm, dl_mm, position_mm of joints) is {share} of the reach",
        set.name
    );
    lib.fault(at, Severity::Warning, message, "are its lengths really in mm?");
}

/// Warns if elastic errors may rotate a joint by an implausible angle. Also warns if compliances have no
/// effect, because the joints carry no mass.
fn warn_of_deflections(cell: &Cell, at: At, lib: &mut Library<'_>) {
    let (chain, set) = (Chain::new(&cell.robot).with_errors(cell.error_set()), cell.error_set());
    let name = set.name();
    let (signed, spreads) = (set.signed().map(SignedErrors::values), set.tolerance().spreads);
    let value = |k: usize| spreads[k].plus_minus.max(signed.as_ref().map_or(0.0, |values| values[k].abs()));
    let used =
        Parameter::of_robot(chain.axes()).enumerate().filter(|(k, p)| p.is_elastic() && value(*k) > 0.0);
    let frames = chain.frames(&chain.zero_posture());
    let mut lacks_masses = false;
    for (k, parameter) in used {
        let Some(largest) = largest_deflection(&chain, &frames, parameter, k) else { continue };
        let is_held = cell.operations.iter().any(|o| o.held.mass > 0.0);
        lacks_masses |= largest.factor == 0.0 && matches!(parameter, Parameter::Compliance(_)) && !is_held;
        let angle = deg_from_rad(largest.factor * value(k));
        if angle > MAX_DEFLECTION_DEG {
            let message = format!(
                "`{}` of `{name}` rotates its joint by up to {} degrees",
                parameter.name(),
                rounded(angle, 1)
            );
            let help = match parameter {
                Parameter::Periodic(_) => "are its coefficients really in degrees?",
                _ => "is its value really in degrees per m (elastic) or degrees per N m (compliance)?",
            };
            lib.fault(at, Severity::Warning, message, help);
        }
    }
    if lacks_masses {
        let message =
            format!("compliances of `{name}` have no effect: nothing that the joints carry has a mass");
        lib.fault(
            at,
            Severity::Warning,
            message,
            "add [[robot.mass]], or mass_kg of the tool or of the held part",
        );
    }
}

fn side(size: f64, reach: f64) -> Option<&'static str> {
    if size > FACTOR * reach {
        Some("more than 20 times")
    } else if size < reach / FACTOR {
        Some("less than a twentieth of")
    } else {
        None
    }
}

/// Warns of equipment that intersects its supporting surface or stands beside it, at the placements before a
/// search.
fn warn_of_stands(cell: &Cell, root: &Node, lib: &mut Library<'_>) {
    for e in &cell.equipment {
        let Some(under) = e.on.map(|k| &cell.equipment[k]) else { continue };
        let at = root.value.get("equipment").map_or(root.at, |node| place_of(node, &e.name));
        let [x, y, z, _] = e.placement.each_ref().map(Coordinate::start);
        let low = extent_of(e.solids.iter().map(|s| &s.shape)).map_or(0.0, |(low, _)| low.z);
        if z + low < -MAX_STAND_GAP {
            let by = millimetres(-(z + low));
            let message = format!("`{}` reaches {by} mm below the surface of `{}`", e.name, under.name);
            lib.fault(
                at,
                Severity::Warning,
                message,
                "z_mm is the height of the frame of the carried equipment above the surface of its carrier",
            );
        }
        let top = under.surface.unwrap_or(under.footprint);
        let beside = |v: f64, centre: f64, size: f64| (v - centre).abs() > size / 2.0 + MAX_STAND_GAP;
        if beside(x, top.centre.0, top.size.0) || beside(y, top.centre.1, top.size.1) {
            let message = format!("`{}` stands beside `{}`, not on it", e.name, under.name);
            lib.fault(
                at,
                Severity::Warning,
                message,
                "its x_mm and y_mm are in the frame of the equipment that it stands on",
            );
        }
    }
}

/// Returns equipment, obstacles and keep-out boxes with their sizes.
fn standing(cell: &Cell, root: &Node) -> Vec<SizedObject> {
    let at = |group: &str, name: &str| root.value.get(group).map(|node| place_of(node, name));
    let equipment = cell.equipment.iter().map(|e| {
        let group = if e.role == Role::Equipment { "equipment" } else { "obstacle" };
        SizedObject {
            what: format!("`{}`", e.name),
            at: at(group, &e.name).unwrap_or(root.at),
            size: equipment_size(e),
        }
    });
    let keep_out = cell.keep_out.iter().map(|k| SizedObject {
        what: format!("keep-out box `{}`", k.name),
        at: at("keep_out", &k.name).unwrap_or(root.at),
        size: (k.max - k.min).max(),
    });
    equipment.chain(keep_out).collect()
}

fn place_of(table: &Node, key: &str) -> At {
    table.value.entries().iter().find(|(k, ..)| k == key).map_or(table.at, |(_, at, _)| *at)
}

fn millimetres(m: f64) -> f64 {
    rounded(mm_from_m(m), 1)
}

fn equipment_size(e: &Equipment) -> f64 {
    let drawn = extent_size(e.solids.iter().map(|s| &s.shape));
    let surface = e.surface.map_or(0.0, |s| s.size.0.max(s.size.1));
    drawn.max(surface).max(e.footprint.size.0).max(e.footprint.size.1)
}

fn extent_size<'s>(shapes: impl IntoIterator<Item = &'s Shape>) -> f64 {
    extent_of(shapes).map_or(0.0, |(lo, hi)| (hi - lo).max())
}
