//! Error sets of a robot: signed samples or tolerances of its kinematic parameters.

use super::frame;
use super::rows::Arm;
use super::tolerance;
use super::tolerance::Kind;
use crate::cell::*;
use crate::files::toml::document::Library;
use crate::files::toml::reader::{Table, read_named};
use crate::files::toml::tree::Value;
use crate::files::toml::value::Must;
use crate::units;

/// Reads every `[errors.NAME]`; without the joints only what does not depend on them.
pub fn read_all(
    t: &mut Table<'_>,
    axes: Option<usize>,
    joints: Option<&[Joint]>,
    convention: Option<Convention>,
    lib: &mut Library<'_>,
) -> Vec<ErrorSet> {
    let help = "add [errors.NAME] with kind = \"signed\", dr_mm, dl_mm and dalpha_deg";
    let node = t.need("errors", help);
    let Some(axes) = axes else { return Vec::new() };
    if let Some(node) = node
        && matches!(&node.value, Value::Table(entries) if entries.is_empty())
    {
        lib.error(node.at, "no error set".into(), help);
    }
    let modified = convention == Some(Convention::Modified);
    let arm = Arm { axes, joints: joints.unwrap_or(&[]), modified };
    read_named(t, "errors", lib, |name, node, lib| {
        Table::read(node, "an error set", lib, |t, lib| read(name, t, arm, lib))
    })
}

fn read(name: &str, t: &mut Table<'_>, arm: Arm<'_>, lib: &mut Library<'_>) -> Option<ErrorSet> {
    t.text("source", lib);
    let kind = Kind::read(t, lib);
    let values = read_values(name, t, arm, Kind::must(kind), lib);
    if kind == Some(Kind::Tolerance) {
        return tolerance::read(t, values, arm, lib).map(ErrorSet::Tolerance);
    }
    tolerance::refuse(t, kind, lib);
    values.map(ErrorSet::Signed)
}

/// The rows and frames: one number for each parameter.
fn read_values(
    name: &str,
    t: &mut Table<'_>,
    arm: Arm<'_>,
    must: Must,
    lib: &mut Library<'_>,
) -> Option<SignedErrors> {
    let n = arm.axes;
    let lengths = |v: Vec<f64>| v.into_iter().map(units::m_from_mm).collect::<Vec<_>>();
    let angles = |v: Vec<f64>| v.into_iter().map(units::rad_from_deg).collect::<Vec<_>>();
    let dq_deg = t.numbers_or_zero("dq_deg", n, must, lib);
    let dq_mm = t.numbers_or_zero("dq_mm", n, must, lib);
    // Joint frames say it all: the rows may be left out.
    let rows = if t.get("joints").is_some() { Table::numbers_or_zero } else { Table::numbers };
    let dr = rows(t, "dr_mm", n, must, lib).map(lengths);
    let dl = rows(t, "dl_mm", n, must, lib).map(lengths);
    let dalpha = rows(t, "dalpha_deg", n, must, lib).map(angles);
    let dbeta = t.numbers_or_zero("dbeta_deg", n, must, lib).map(angles);
    let base = frame::read_part(t, "base", must, lib);
    let tool = frame::read_part(t, "tool", must, lib);
    let joints = frame::read_joints(t, arm, must, lib);
    let (dq_deg, dq_mm) = (dq_deg?, dq_mm?);
    fits(t, "dq_deg", &dq_deg, arm, JointKind::Revolute, lib);
    fits(t, "dq_mm", &dq_mm, arm, JointKind::Prismatic, lib);
    // One of the two is zero for every joint.
    let dq = angles(dq_deg).iter().zip(lengths(dq_mm)).map(|(a, b)| a + b).collect();
    let (dr, dl, dalpha, dbeta) = (dr?, dl?, dalpha?, dbeta?);
    let (base, tool, joints, name) = (base?, tool?, joints?, name.to_string());
    if arm.modified {
        refuse_first_row(t, &base, &joints, lib);
    }
    let rows = SignedErrors { name: name.clone(), dq, dr, dl, dalpha, dbeta, base, tool, joints };
    let mut values = rows.values();
    arm.in_order(&mut values);
    Some(SignedErrors::of_values(name, n, &values))
}

/// Modified rows begin with the common normal: what row 1 says of it stands there alone.
fn refuse_first_row(
    t: &mut Table<'_>,
    base: &[f64; PER_FRAME],
    joints: &[[f64; PER_FRAME]],
    lib: &mut Library<'_>,
) {
    let of_base = ("base", base[3] != 0.0, "rx of `base` is dalpha", "number 1 of dalpha_deg");
    let is_joint = joints.first().is_some_and(|joint| joint[0] != 0.0 || joint[4] != 0.0);
    let of_joint =
        ("joints", is_joint, "x and ry of joint 1 are dl and dbeta", "number 1 of dl_mm and dbeta_deg");
    for (key, _, what, place) in [of_base, of_joint].into_iter().filter(|of| of.1) {
        let at = t.get(key).map_or(t.at, |node| node.at);
        let message = format!("{what} of row 1: this robot has modified rows");
        lib.error(at, message, format!("give it as {place}"));
    }
}

/// An error of a joint coordinate has the unit of that joint.
fn fits(
    t: &mut Table<'_>,
    key: &'static str,
    values: &[f64],
    arm: Arm<'_>,
    kind: JointKind,
    lib: &mut Library<'_>,
) {
    let Some(node) = t.get(key) else { return };
    let (is, right) = match kind {
        JointKind::Revolute => ("slides", "dq_mm"),
        JointKind::Prismatic => ("turns", "dq_deg"),
    };
    let pairs = arm.joints.iter().zip(values).enumerate();
    for (i, (joint, _)) in pairs.filter(|(_, (j, v))| j.kind != kind && **v != 0.0) {
        let message = format!("number {} of `{key}` must be 0: joint `{}` {is}", i + 1, joint.name);
        lib.error(node.at, message, format!("give its error in {right}"));
    }
}
