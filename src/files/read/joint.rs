//! Reader of the joints of a robot: D-H rows, their coupling and the home posture.

use super::rate;
use crate::cell::*;
use crate::files::fault::{Severity, shown};
use crate::files::keys::key::{Key, NumberRange};
use crate::files::keys::robot::{JointMotion, joint, robot};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Node;
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units;
use std::collections::HashSet;

/// Joint limit, degrees. If no revolute joint has a larger limit, the limits are probably in radians.
const SUSPICIOUS_LIMIT_DEG: f64 = 7.0;

/// Reads the D-H rows of a robot.
pub fn read_all(t: &mut Table) -> Option<Vec<Joint>> {
    let (node, rows) = (t.get(&robot::JOINT)?, t.items(&robot::JOINT)?);
    let joints: Option<Vec<Joint>> = t.tables(&robot::JOINT, read)?.into_iter().collect();
    let joints = joints?;
    let mut names = HashSet::new();
    for (joint, row) in joints.iter().zip(rows) {
        if !names.insert(&joint.name) {
            let message = format!("two joints are named `{}`", joint.name);
            t.error(
                row.at,
                message,
                "give each joint a unique name, because messages refer to a joint by its name",
            );
        }
    }
    let turns = |j: &&Joint| j.kind == JointKind::Revolute && !j.is_passive();
    let mut turning = joints.iter().filter(turns).peekable();
    let small =
        |j: &Joint| j.limits.0.abs().max(j.limits.1.abs()) <= units::rad_from_deg(SUSPICIOUS_LIMIT_DEG);
    if turning.peek().is_some() && turning.all(small) {
        let message = format!("no revolute joint has a limit beyond {SUSPICIOUS_LIMIT_DEG} degrees");
        t.lib.fault(
            node.at,
            Severity::Warning,
            message,
            "are the limits in radians? they are read in degrees",
        );
    }
    Some(joints)
}

fn read(t: &mut Table) -> Option<Joint> {
    let name = t.name(&joint::NAME);
    let (r, l, alpha) = (t.number(&joint::R), t.number(&joint::L), t.number(&joint::ALPHA));
    let Some(motion) = t.word::<JointMotion>(&joint::MOTION) else {
        // Without the kind, the other keys of the joint cannot be checked.
        t.give_up();
        return None;
    };
    t.apply_rules(&joint::MOTION, motion.name());
    let (kind, theta, limits) = match motion {
        JointMotion::Revolute => (JointKind::Revolute, &joint::Q_OFFSET, read_limits(t, &joint::LIMITS_DEG)),
        JointMotion::Prismatic => (JointKind::Prismatic, &joint::THETA, read_limits(t, &joint::LIMITS_MM)),
        JointMotion::Passive => (JointKind::Revolute, &joint::Q_OFFSET, Some((0.0, 0.0))),
    };
    let theta = t.number(theta);
    let rates = if motion == JointMotion::Passive { RateLimits::default() } else { rate::read_row(t, kind) };
    let (name, theta, limits) = (name?, theta?, limits?);
    Some(Joint { name, kind, theta, r: r?, l: l?, alpha: alpha?, limits, rates })
}

/// Reads the lower and the upper limit of a joint, rad or m.
fn read_limits(t: &mut Table, key: &Key) -> Option<(f64, f64)> {
    let (node, name) = (t.get(key)?, key.name);
    let limits = value::numbers(node, &format!("`{name}`"), 2, NumberRange::Finite, t.lib)?;
    let (low, high) = (plain(limits[0]), plain(limits[1]));
    if limits[0] > limits[1] {
        let message = format!("`{name}` are reversed: {low} is above {high}");
        t.error(node.at, message, format!("write {name} = [{high}, {low}]"));
    } else if limits[0] == limits[1] {
        let message = format!("`{name}` leave no travel: both are {low}");
        t.error(
            node.at,
            message,
            "compute a D-H table without this joint, or use a URDF in which this joint is fixed",
        );
    }
    Some((key.unit().si(limits[0]), key.unit().si(limits[1])))
}

/// Reads the matrix `coupling`: row i gives D-H coordinate i as a linear combination of actuator coordinates.
///
/// If the matrix is missing, every D-H coordinate equals the coordinate of its own actuator.
pub fn read_coupling(t: &mut Table, n: usize) -> Option<Vec<Vec<f64>>> {
    let Some(node) = t.get(&robot::COUPLING) else {
        let unit = |i| (0..n).map(|j| f64::from(u8::from(i == j))).collect();
        return Some((0..n).map(unit).collect());
    };
    let Some(rows) = node.value.items().filter(|rows| rows.len() == n) else {
        let help = "row i gives D-H coordinate i as a weighted sum of the actuator coordinates";
        let given = node.value.count_or_kind();
        t.error(node.at, format!("`coupling` must be a list of {n} rows of {n} numbers, not {given}"), help);
        return None;
    };
    let rows: Vec<_> = rows.iter().enumerate().map(|(i, row)| read_coupling_row(row, i, n, t)).collect();
    rows.into_iter().collect()
}

fn read_coupling_row(row: &Node, i: usize, n: usize, t: &mut Table) -> Option<Vec<f64>> {
    let what = format!("row {} of `coupling`", i + 1);
    let values = value::numbers(row, &what, n, NumberRange::Finite, t.lib)?;
    if values[i] != 1.0 || values[i + 1..].iter().any(|&v| v != 0.0) {
        let message = format!("entry {} of {what} must be 1, and the entries after it must be 0", i + 1);
        t.error(
            row.at,
            message,
            "row i lists the factor of every actuator in D-H coordinate i: 1 for actuator i, 0 for later actuators",
        );
    }
    Some(values)
}

/// Reads the home posture: one number for each joint, degrees or mm in the file, rad or m in the result.
///
/// If the key is missing, each coordinate is 0, or the middle of its limits if they exclude 0.
pub fn read_home(t: &mut Table, joints: &[Joint]) -> Option<JointVector> {
    let mut home = [0.0; MAX_JOINTS];
    let Some(node) = t.get(&robot::HOME) else {
        for (q, joint) in home.iter_mut().zip(joints) {
            let (low, high) = joint.limits;
            *q = if (low..=high).contains(&0.0) { 0.0 } else { (low + high) / 2.0 };
        }
        return Some(home);
    };
    let given = value::numbers(node, "`home`", joints.len(), NumberRange::Finite, t.lib)?;
    for (i, (joint, &q)) in joints.iter().zip(&given).enumerate() {
        let turns = joint.kind == JointKind::Revolute;
        home[i] = if turns { units::rad_from_deg(q) } else { units::m_from_mm(q) };
        let (low, high) = joint.limits;
        if !(low..=high).contains(&home[i]) {
            let shown_limit = |v| plain(if turns { units::deg_from_rad(v) } else { units::mm_from_m(v) });
            let (low, high, name) = (shown_limit(low), shown_limit(high), shown(&joint.name));
            let message = format!("entry {} of `home` is outside the limits of joint `{name}`", i + 1);
            let at = node.value.items().map_or(node.at, |items| items[i].at);
            t.error(at, message, format!("write a value from {low} to {high}, not {}", plain(q)));
        }
    }
    Some(home)
}

/// Records a fault for every passive joint that follows no actuator.
pub fn refuse_idle(rows: &[Node], joints: &[Joint], coupling: &[Vec<f64>], t: &mut Table) {
    for (i, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.is_passive()) {
        let meant = rows[i].value.get("kind").is_some();
        if meant && coupling[i][..i].iter().all(|&c| c == 0.0) {
            let message = format!("nothing moves the passive joint `{}`", shown(&joint.name));
            t.error(rows[i].at, message, "state in its row of `coupling` which actuators it follows");
        }
    }
}
