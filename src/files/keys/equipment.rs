//! Equipment: work surface, solids, floor space and placement.

use super::coordinate;
use super::frame;
use super::misplacement;
use super::solid;
use super::solid::Carrier;
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::units;
use nalgebra::Vector3;

/// Reads `[equipment.NAME]` or `[obstacle.NAME]`, usually `from` an equipment file.
pub fn read(name: &str, node: &Node, role: Role, lib: &mut Library<'_>) -> Option<Equipment> {
    let what = if role == Role::Equipment { "an equipment" } else { "an obstacle" };
    Table::read(node, what, lib, |t, lib| {
        crate::files::header::header(t, "equipment", lib)?;
        t.text_or("name", name, lib);
        t.text_or("source", "", lib);
        let before = lib.errors();
        let surface = t.get("surface").and_then(|node| solid::read_rectangle(node, "`surface`", lib));
        let solids = solid::read_all(t, Carrier::Equipment, lib, |_, solid, _| solid);
        let drawn = crate::cell::extent_of(solids.iter().map(|s| &s.shape));
        let extents = [drawn, surface.map(|s| top(&s))].into_iter().flatten();
        let extent = extents.reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
        let sound = lib.errors() == before;
        let needed: &[_] = if sound { &["footprint", "solid", "surface"] } else { &[] };
        let footprint = solid::read_footprint(t, extent, needed, lib);
        let placement = read_placement(t, role, lib);
        // Found by its name when all are read.
        if let Some(node) = t.get("stands_on")
            && value::text(node, "stands_on", lib).is_some()
            && role == Role::Obstacle
        {
            let help = "make it an [equipment.NAME], or give its place in the world";
            lib.error(node.at, "an obstacle stands still: it has no `stands_on`".into(), help);
        }
        let errors = t.get("errors").map(|node| read_errors(node, role, lib));
        let tolerance = match t.get("placement_tolerance") {
            Some(node) => misplacement::read(node, "`placement_tolerance`", role, lib),
            None => Some(PlacementTolerance::default()),
        };
        let (footprint, placement, tolerance) = (footprint?, placement?, tolerance?);
        let (name, errors) = (name.to_string(), errors.flatten());
        Some(Equipment { name, role, surface, footprint, solids, on: None, placement, errors, tolerance })
    })
}

/// The errors of its placement or fixture.
fn read_errors(node: &Node, role: Role, lib: &mut Library<'_>) -> Option<FrameErrors> {
    if role == Role::Obstacle {
        let help = "make it an [equipment.NAME] if work is done on it, or remove them";
        lib.error(node.at, "an obstacle has no `errors`".into(), help);
        return None;
    }
    frame::read_errors(node, lib)
}

/// Extent of a work surface.
fn top(surface: &Rectangle) -> crate::cell::Extent {
    let half = Vector3::new(surface.size.0, surface.size.1, 0.0) / 2.0;
    let centre = Vector3::new(surface.centre.0, surface.centre.1, 0.0);
    (centre - half, centre + half)
}

fn read_placement(t: &mut Table<'_>, role: Role, lib: &mut Library<'_>) -> Option<[Coordinate; 4]> {
    let node = t.need("placement", "add placement = { x_mm = 0, y_mm = 1000, z_mm = 600 }")?;
    Table::read(node, "`placement`", lib, |t, lib| read_coordinates(t, role, lib))
}

/// x, y, z, yaw, each fixed or a search variable.
pub fn read_coordinates(t: &mut Table<'_>, role: Role, lib: &mut Library<'_>) -> Option<[Coordinate; 4]> {
    let x = read_coordinate(t, "x_mm", units::m_from_mm, role, lib);
    let y = read_coordinate(t, "y_mm", units::m_from_mm, role, lib);
    let z = read_coordinate(t, "z_mm", units::m_from_mm, role, lib);
    let yaw = match t.get("yaw_deg") {
        Some(_) => read_coordinate(t, "yaw_deg", units::rad_from_deg, role, lib),
        None => Some(Coordinate::Fixed(0.0)),
    };
    Some([x?, y?, z?, yaw?])
}

fn read_coordinate(
    t: &mut Table<'_>,
    key: &'static str,
    si: fn(f64) -> f64,
    role: Role,
    lib: &mut Library<'_>,
) -> Option<Coordinate> {
    let node = t.need(key, format!("add {key} = 0, or {{ min = -500, max = 500 }} to let it be searched"))?;
    let is_free = matches!(node.value, Value::Table(_) | Value::Array(_));
    if is_free && role == Role::Obstacle {
        let message = format!("`{key}` of an obstacle cannot be a range");
        lib.error(node.at, message, "give it one number, or make it an [equipment.NAME]");
        return None;
    }
    coordinate::read(node, key, si, lib)
}

/// Finds by their names what stands on what; says what cannot be.
pub fn tie(root: &mut Table<'_>, all: &mut [Equipment], lib: &mut Library<'_>) {
    let names: Vec<String> = all.iter().map(|e| e.name.clone()).collect();
    let groups = ["equipment", "obstacle"].map(|group| root.get(group));
    let entries = groups.into_iter().flatten().flat_map(|node| node.value.entries());
    for (name, _, node) in entries {
        let Some(k) = names.iter().position(|n| n == name) else { continue };
        let Some(tied) = node.value.get("stands_on") else { continue };
        let Value::Text(under) = &tied.value else { continue };
        match names.iter().position(|n| n == under) {
            Some(found) if found != k => all[k].on = Some(found),
            Some(_) => lib.error(tied.at, format!("`{}` cannot stand on itself", shown(name)), "remove it"),
            None if !root.partial => {
                let others = || names.iter().filter(|n| *n != name).map(String::as_str);
                let help = match did_you_mean(under, others()) {
                    Some(near) => format!("did you mean \"{}\"?", shown(near)),
                    None => format!("there is: {}", listed(others())),
                };
                lib.error(tied.at, format!("there is no equipment `{}`", shown(under)), help);
            }
            None => {}
        }
        if circular(all, k) {
            all[k].on = None;
            let message = format!("`{}` would stand on itself by way of `{}`", shown(name), shown(under));
            lib.error(tied.at, message, "let one of them stand on the floor");
        }
    }
}

/// Whether the ties from one equipment lead back to it.
fn circular(all: &[Equipment], k: usize) -> bool {
    let mut under = all[k].on;
    while let Some(next) = under {
        if next == k {
            return true;
        }
        under = all[next].on;
    }
    false
}

/// `[keep_out.NAME]`: low and high corner of a box, world frame.
pub fn read_keep_out(name: &str, node: &Node, lib: &mut Library<'_>) -> Option<KeepOut> {
    Table::read(node, "a keep-out box", lib, |t, lib| {
        let min = t.vector("min_mm", Must::BeFinite, lib);
        let max = t.vector("max_mm", Must::BeFinite, lib);
        let (min, max) = (min?, max?);
        if let Some(axis) = (0..3).find(|&i| min[i] >= max[i]) {
            let (low, high) = (units::mm_from_m(min[axis]), units::mm_from_m(max[axis]));
            let (axis, low, high) = (["x", "y", "z"][axis], plain(low), plain(high));
            let message = format!("the box is empty: in {axis}, min_mm {low} is not below max_mm {high}");
            lib.error(t.at, message, "give the low corner as min_mm, the high one as max_mm");
        }
        Some(KeepOut { name: name.to_string(), min, max })
    })
}
