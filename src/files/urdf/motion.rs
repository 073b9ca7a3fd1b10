//! Joints between base and tip: which joints move, their limits and their coupling.

use super::dh;

use super::dh::Axis;
use super::model::*;
use super::tree::LinkChain;
use crate::cell::{JointKind, MAX_JOINTS};
use crate::files::fault::{Severity, shown};
use crate::files::toml::document::Library;
use crate::files::toml::value;
use crate::pose::Pose;
use std::f64::consts::TAU;

/// Length, m, above which a value is probably in mm, because no arm is that long.
pub const TOO_LONG: f64 = 20.0;

/// A joint limit above this value, rad, causes a warning that the limit is probably in degrees.
const MANY_TURNS: f64 = 4.0 * TAU;
/// A URDF with a joint limit above this value, rad, is refused.
const TOO_MANY_TURNS: f64 = 1e3;

/// A speed of a revolute joint above this value, rad/s, causes a warning that the speed is probably in
/// degrees/s.
const TOO_FAST: f64 = 60.0;

/// Axial offset of a row, m, that only nearly parallel axes have.
const FAR_ROW: f64 = 5.0;

/// Two axes are probably meant to be exactly parallel or at right angles if they deviate by less than this
/// value, rad.
const NEARLY: f64 = 1e-3;

/// Moving joint: the properties that its D-H row does not contain.
pub struct MovingJoint {
    pub name: String,
    pub limits: (f64, f64),
    /// Maximum speed, rad/s or m/s; None if the URDF does not state it.
    pub velocity: Option<f64>,
    /// Coordinate of the joint with all actuators at 0, rad or m: the offset of a mimic joint, or 0.
    pub offset: f64,
    /// Row of the joint in the coupling matrix.
    pub coupling: Vec<f64>,
}

pub struct Motion {
    pub axes: Vec<Axis>,
    pub movers: Vec<MovingJoint>,
    /// Pose of the tip link in the frame of the last moving joint.
    pub flange: Pose,
}

/// Reads the joints between base and tip and records every fault. The result is valid only if no fault was
/// recorded.
pub fn read(urdf: &Urdf, way: &LinkChain, lib: &mut Library<'_>) -> Option<Motion> {
    let before = lib.errors();
    let joints: Vec<_> = way.joints.iter().map(|&j| &urdf.joints[j]).collect();
    joints.iter().for_each(|joint| refuse_length(joint, lib));
    let moving: Vec<_> = joints.iter().copied().filter(|j| j.kind != UrdfJointKind::Fixed).collect();
    refuse_count(urdf, &moving, lib);
    let mut movers: Vec<MovingJoint> = Vec::new();
    for (i, joint) in moving.iter().enumerate().take(MAX_JOINTS) {
        let mover = read_mover(i, joint, &moving, &movers, lib);
        movers.push(mover.unwrap_or_else(|| MovingJoint::alone(i, moving.len(), String::new(), (0.0, 0.0))));
    }
    if lib.errors() > before {
        return None;
    }
    let mut at = Pose::identity();
    let mut axes = Vec::new();
    for joint in joints {
        at = at * joint.origin;
        let kind = match joint.kind {
            UrdfJointKind::Fixed => continue,
            UrdfJointKind::Prismatic => JointKind::Prismatic,
            _ => JointKind::Revolute,
        };
        axes.push(Axis { kind, origin: std::mem::replace(&mut at, Pose::identity()), direction: joint.axis });
    }
    Some(Motion { axes, movers, flange: at })
}

impl MovingJoint {
    fn alone(i: usize, n: usize, name: String, limits: (f64, f64)) -> Self {
        let coupling = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        Self { name, limits, velocity: None, offset: 0.0, coupling }
    }
}

fn refuse_length(joint: &UrdfJoint, lib: &mut Library<'_>) {
    let longest = joint.origin.translation.amax();
    if longest > TOO_LONG {
        let message = format!(
            "the origin of joint `{}` is {longest} m away from its parent link along one axis",
            shown(&joint.name.name)
        );
        lib.error(joint.origin_at, message, "a URDF states lengths in m: is this origin in mm?");
    }
}

fn refuse_count(urdf: &Urdf, moving: &[&UrdfJoint], lib: &mut Library<'_>) {
    if moving.iter().all(|j| j.mimic.is_some()) || moving.len() > MAX_JOINTS {
        let at = moving.get(MAX_JOINTS).map_or(urdf.at, |j| j.name.at);
        let message = if moving.len() > MAX_JOINTS {
            format!(
                "the chain from base to tip link has {} moving joints; at most {MAX_JOINTS} are allowed",
                moving.len()
            )
        } else {
            "no joint between base and tip link moves independently".to_string()
        };
        lib.error(at, message, "choose the chain of the arm with base_link and tip_link");
    }
}

fn read_mover(
    i: usize,
    joint: &UrdfJoint,
    moving: &[&UrdfJoint],
    before: &[MovingJoint],
    lib: &mut Library<'_>,
) -> Option<MovingJoint> {
    let name = value::checked_name(&joint.name.name, joint.name.at, lib);
    if matches!(joint.kind, UrdfJointKind::Floating | UrdfJointKind::Planar) {
        let message = format!("joint `{}` is {}", shown(&joint.name.name), joint.kind.name());
        lib.error(
            joint.name.at,
            message,
            "only revolute, continuous, prismatic and fixed joints can be read",
        );
        return None;
    }
    if let Some(mimic) = &joint.mimic {
        return read_mimic(i, joint, mimic, moving, before, lib);
    }
    let limits = read_limits(joint, lib);
    warn_of_speed(joint, lib);
    let velocity = joint.velocity.map(|(velocity, _)| velocity);
    Some(MovingJoint { velocity, ..MovingJoint::alone(i, moving.len(), name?, limits?) })
}

fn read_limits(joint: &UrdfJoint, lib: &mut Library<'_>) -> Option<(f64, f64)> {
    let name = shown(&joint.name.name);
    if joint.kind == UrdfJointKind::Continuous {
        let message = format!("the continuous joint `{name}` is read with limits of -360 and 360 degrees");
        let help = "if its cables allow less, make it revolute and give limits";
        lib.fault(joint.name.at, Severity::Warning, message, help);
        return Some((-TAU, TAU));
    }
    let Some((lower, upper, at)) = joint.limits else {
        let message = format!("joint `{name}` has no limits");
        let help = "add <limit lower=\"...\" upper=\"...\"/>: other programs read missing limits as \
                    0 to 0, which leaves no travel";
        lib.error(joint.name.at, message, help);
        return None;
    };
    let farthest = lower.abs().max(upper.abs());
    let (most, unit) = match joint.kind {
        UrdfJointKind::Prismatic => (TOO_LONG, "m: is this limit in mm?"),
        _ => (TOO_MANY_TURNS, "rad: is this limit in degrees?"),
    };
    if lower > upper {
        let message = format!("the limits of joint `{name}` are reversed: {lower} is above {upper}");
        lib.error(at, message, "swap lower and upper");
    } else if lower == upper {
        let message = format!("the limits of joint `{name}` leave no travel: both are {lower}");
        lib.error(at, message, "make it fixed, or write the limits");
    } else if farthest > most {
        let message = format!("a limit of joint `{name}` is too far from 0: {farthest}, more than {most}");
        lib.error(at, message, format!("limits of a URDF are in {unit}"));
    } else if joint.kind == UrdfJointKind::Revolute && farthest > MANY_TURNS {
        let message = format!("joint `{name}` turns by up to {farthest} rad, more than four turns");
        lib.fault(at, Severity::Warning, message, "limits of a URDF are in rad: is this limit in degrees?");
    }
    Some((lower, upper))
}

/// Warns of a speed that is probably in degrees or mm per s.
fn warn_of_speed(joint: &UrdfJoint, lib: &mut Library<'_>) {
    let Some((velocity, at)) = joint.velocity else { return };
    let (most, unit, help) = match joint.kind {
        UrdfJointKind::Prismatic => (TOO_LONG, "m/s", "speeds of a URDF are in m/s: is this speed in mm/s?"),
        _ => (TOO_FAST, "rad/s", "speeds of a URDF are in rad/s: is this speed in degrees/s?"),
    };
    if velocity > most {
        let message = format!("joint `{}` moves by up to {velocity} {unit}", shown(&joint.name.name));
        lib.fault(at, Severity::Warning, message, help);
    }
}

/// Reads a mimic joint as a row of the coupling and an offset. A mimic joint follows an earlier joint of the
/// chain.
fn read_mimic(
    i: usize,
    joint: &UrdfJoint,
    mimic: &Mimic,
    moving: &[&UrdfJoint],
    before: &[MovingJoint],
    lib: &mut Library<'_>,
) -> Option<MovingJoint> {
    let name = shown(&joint.name.name);
    let followed = before.len().min(i);
    let Some(j) = moving[..followed].iter().position(|other| other.name.name == mimic.joint.name) else {
        let message = format!(
            "joint `{name}` mimics `{}`, which does not precede it in the chain",
            shown(&mimic.joint.name)
        );
        let help = "a joint can only follow a joint that comes before it in the chain from base to tip link";
        lib.error(mimic.joint.at, message, help);
        return None;
    };
    let other = &before[j];
    let mut mover = MovingJoint::alone(i, moving.len(), joint.name.name.clone(), (0.0, 0.0));
    mover.offset = mimic.multiplier * other.offset + mimic.offset;
    for k in (0..=j).filter(|&k| k < j || moving[j].mimic.is_none()) {
        mover.coupling[k] = mimic.multiplier * other.coupling[k];
    }
    if mover.coupling[..i].iter().all(|&c| c == 0.0) {
        let message = format!("nothing moves the mimic joint `{name}`: its multiplier is 0");
        lib.error(mimic.joint.at, message, "make it fixed");
        return None;
    }
    warn_beyond(joint, &mover, before, lib);
    Some(mover)
}

/// Warns if a mimic joint can leave its limits.
///
/// The limits of a mimic joint are not enforced, but the limits of the joints that it follows are enforced.
fn warn_beyond(joint: &UrdfJoint, mover: &MovingJoint, before: &[MovingJoint], lib: &mut Library<'_>) {
    let Some((lower, upper, at)) = joint.limits else { return };
    let (mut low, mut high) = (mover.offset, mover.offset);
    for (c, other) in mover.coupling.iter().zip(before) {
        let ends = (c * other.limits.0, c * other.limits.1);
        (low, high) = (low + ends.0.min(ends.1), high + ends.0.max(ends.1));
    }
    if low < lower - 1e-9 || high > upper + 1e-9 {
        let name = shown(&joint.name.name);
        let message = format!("the mimic joint `{name}` moves from {low:.4} to {high:.4}, beyond its limits");
        lib.fault(at, Severity::Warning, message, "narrow the limits of the joint that it follows");
    }
}

/// Warns of axes that are almost parallel or almost at right angles, and of rows that do not reproduce the
/// URDF.
pub fn warn_of_slants(
    urdf: &Urdf,
    way: &LinkChain,
    motion: &Motion,
    derived: &dh::Derived,
    lib: &mut Library<'_>,
) {
    let moving = way.joints.iter().map(|&j| &urdf.joints[j]).filter(|j| j.kind != UrdfJointKind::Fixed);
    let moving: Vec<_> = moving.collect();
    for (k, pair) in dh::directions(&motion.axes).windows(2).enumerate() {
        let angle = dh::angle(&pair[0], &pair[1]);
        let off = angle.min(std::f64::consts::FRAC_PI_2 - angle);
        if off <= dh::MAX_EXACT_GAP || off >= NEARLY {
            continue;
        }
        let names = (shown(&motion.movers[k].name), shown(&motion.movers[k + 1].name));
        let (what, so) = if angle < NEARLY {
            let away = derived.rows[k].r.abs().max(derived.rows.get(k + 1).map_or(0.0, |row| row.r.abs()));
            (
                "parallel",
                format!(
                    "; their rows have an offset of {away:.3} m along the axes, so errors stated for these rows are not meaningful"
                ),
            )
        } else {
            ("at right angles", String::new())
        };
        let message = format!(
            "the axes of `{}` and `{}` are almost {what}: the deviation is {off:.1e} rad{so}",
            names.0, names.1
        );
        let help = "if the angle is meant to be exact, write it with all digits, such as 1.5707963267948966";
        lib.fault(moving[k + 1].origin_at, Severity::Warning, message, help);
    }
    let is_far = |row: &&(usize, &dh::UrdfDhRow)| row.1.r.abs() > FAR_ROW;
    if let Some((k, row)) = derived.rows.iter().enumerate().find(|row| is_far(&row)) {
        let message = format!(
            "the axis of `{}` is nearly parallel to a neighbouring axis: its D-H row has an axial offset of {:.0} m, so \
             errors guessed for the rows are far too large",
            shown(&motion.movers[k].name),
            row.r.abs()
        );
        let help = "use the nominal URDF of the arm, and give this one as its calibration: sweetspot calibrate \
                    NOMINAL.urdf CALIBRATED.urdf";
        lib.fault(moving[k].origin_at, Severity::Warning, message, help);
    }
    if derived.gap >= dh::MAX_EXACT_GAP || derived.gap.is_nan() {
        let message = format!(
            "no D-H rows reproduce this URDF exactly: the best rows differ by up to {:.1e} m",
            derived.gap
        );
        let help = "almost parallel axes are the cause: write the angles with all digits";
        lib.fault(urdf.at, Severity::Warning, message, help);
    }
}
