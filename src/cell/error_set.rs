//! Error sets of a robot: signed samples of its kinematic errors.

use super::document::Library;
use super::error_model::*;
use super::reader::{Table, read_named};
use super::robot_model::*;
use super::tree::{Node, Value};
use super::value::Must;
use crate::units;

/// Reads every `[errors.NAME]`; without the joints only what does not depend on them.
pub fn read_all(
    t: &mut Table<'_>,
    rows: Option<&[Node]>,
    joints: Option<&[Joint]>,
    lib: &mut Library<'_>,
) -> Vec<ErrorSet> {
    let help = "add [errors.NAME] with kind = \"signed\", dr_mm, dl_mm and dalpha_deg";
    let node = t.need("errors", help);
    let Some(rows) = rows else { return Vec::new() };
    if let Some(node) = node
        && matches!(&node.value, Value::Table(entries) if entries.is_empty())
    {
        lib.error(node.at, "no error set".into(), help);
    }
    read_named(t, "errors", lib, |name, node, lib| {
        Table::read(node, "an error set", lib, |t, lib| read(name, t, rows.len(), joints, lib))
    })
}

fn read(
    name: &str,
    t: &mut Table<'_>,
    n: usize,
    joints: Option<&[Joint]>,
    lib: &mut Library<'_>,
) -> Option<ErrorSet> {
    let lengths = |v: Vec<f64>| v.into_iter().map(units::m_from_mm).collect::<Vec<_>>();
    let angles = |v: Vec<f64>| v.into_iter().map(units::rad_from_deg).collect::<Vec<_>>();
    t.text("source", lib);
    // A tolerance will be a type of its own; the word keeps the two apart in files from the start.
    t.choice("kind", &["signed"], |k| k, None, lib);
    let dq_deg = t.numbers_or_zero("dq_deg", n, lib);
    let dq_mm = t.numbers_or_zero("dq_mm", n, lib);
    let dr = t.numbers("dr_mm", n, Must::BeFinite, lib).map(lengths);
    let dl = t.numbers("dl_mm", n, Must::BeFinite, lib).map(lengths);
    let dalpha = t.numbers("dalpha_deg", n, Must::BeFinite, lib).map(angles);
    let (dq_deg, dq_mm) = (dq_deg?, dq_mm?);
    fits(t, "dq_deg", &dq_deg, joints, JointKind::Revolute, lib);
    fits(t, "dq_mm", &dq_mm, joints, JointKind::Prismatic, lib);
    // One of the two is zero for every joint.
    let dq = angles(dq_deg).iter().zip(lengths(dq_mm)).map(|(a, b)| a + b).collect();
    let (name, dbeta, frame) = (name.to_string(), vec![0.0; n], [0.0; PER_FRAME]);
    let (dr, dl, dalpha) = (dr?, dl?, dalpha?);
    Some(ErrorSet::Signed(SignedErrors { name, dq, dr, dl, dalpha, dbeta, base: frame, tool: frame }))
}

/// An error of a joint coordinate has the unit of that joint.
fn fits(
    t: &mut Table<'_>,
    key: &'static str,
    values: &[f64],
    joints: Option<&[Joint]>,
    kind: JointKind,
    lib: &mut Library<'_>,
) {
    let Some(node) = t.get(key) else { return };
    let (is, right) = match kind {
        JointKind::Revolute => ("slides", "dq_mm"),
        JointKind::Prismatic => ("turns", "dq_deg"),
    };
    let pairs = joints.unwrap_or(&[]).iter().zip(values).enumerate();
    for (i, (joint, _)) in pairs.filter(|(_, (j, v))| j.kind != kind && **v != 0.0) {
        let message = format!("number {} of `{key}` must be 0: joint `{}` {is}", i + 1, joint.name);
        lib.error(node.at, message, format!("give its error in {right}"));
    }
}
