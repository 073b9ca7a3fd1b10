//! Reader of the error sets of a robot: signed samples, tolerances or measured errors of its parameters.

use super::elastic;
use super::frame_error;
use super::measured_ranges;
use super::periodic;
use super::row_order::ErrorRows;
use super::tolerance;
use crate::cell::*;
use crate::files::keys::errors::{ErrorForm, ErrorSetForm, error_set};
use crate::files::keys::key::{Key, NumberRange};
use crate::files::keys::robot::robot;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Value;

/// Reads every `[errors.NAME]`; returns no error set if the number of axes is unknown.
pub fn read_all(
    t: &mut Table,
    axes: Option<usize>,
    joints: Option<&[Joint]>,
    convention: Option<Convention>,
    coupling: Option<&[Vec<f64>]>,
) -> Vec<ErrorSet> {
    let node = t.get(&robot::ERRORS);
    let Some(axes) = axes else { return Vec::new() };
    if let Some(node) = node
        && matches!(&node.value, Value::Table(entries) if entries.is_empty())
    {
        t.error(node.at, "the robot has no error set", robot::ERRORS.remedy);
    }
    let modified = convention == Some(Convention::Modified);
    let is_coupled = coupling
        .is_some_and(|rows| rows.iter().enumerate().any(|(i, row)| row.iter().take(i).any(|c| *c != 0.0)));
    let arm = ErrorRows { axes, joints: joints.unwrap_or(&[]), modified, is_coupled };
    t.named(&robot::ERRORS, |name, t| read(name, t, arm))
}

fn read(name: &str, t: &mut Table, arm: ErrorRows<'_>) -> Option<ErrorSet> {
    t.text(&error_set::SOURCE);
    let form: Option<ErrorSetForm> = t.word(&error_set::FORM);
    let of_lists = form.map(ErrorSetForm::of_lists);
    let values = read_values(name, t, arm, tolerance::range_of(of_lists));
    if matches!(form, Some(ErrorSetForm::Plain(_))) {
        measured_ranges::refuse(t);
    }
    let set = match form {
        Some(ErrorSetForm::Plain(ErrorForm::Tolerance)) => {
            periodic::refuse(t);
            tolerance::read(t, values, arm).map(ErrorSet::Tolerance)
        }
        Some(ErrorSetForm::Measured) => {
            let measured = tolerance::read_measured(t, values, arm)?;
            Some(ErrorSet::Measured(Box::new(measured)))
        }
        _ => {
            tolerance::refuse(t, of_lists);
            values.map(ErrorSet::Signed)
        }
    }?;
    elastic::refuse_too_many(&set, t);
    Some(set)
}

/// Reads the errors of the D-H rows and frames: one number for each parameter.
fn read_values(name: &str, t: &mut Table, arm: ErrorRows<'_>, range: NumberRange) -> Option<SignedErrors> {
    let n = arm.axes;
    let keys = [
        error_set::DQ_DEG,
        error_set::DQ_MM,
        error_set::DR,
        error_set::DL,
        error_set::DALPHA,
        error_set::DBETA,
    ];
    let [dq_deg, dq_mm, dr, dl, dalpha, dbeta] = keys.map(|key| t.numbers_of(&key, n, range));
    let base = frame_error::read_part(t, &error_set::BASE, range);
    let tool = frame_error::read_part(t, &error_set::TOOL, range);
    let joints = frame_error::read_joints(t, arm, range);
    let elastic = elastic::read(t, arm, range);
    let periodic = periodic::read(t, arm);
    let (dq_deg, dq_mm) = (dq_deg?, dq_mm?);
    check_joint_kinds(t, &error_set::DQ_DEG, &dq_deg, arm, JointKind::Revolute);
    check_joint_kinds(t, &error_set::DQ_MM, &dq_mm, arm, JointKind::Prismatic);
    // For every joint, one of the two values is zero.
    let dq = dq_deg.iter().zip(dq_mm).map(|(a, b)| a + b).collect();
    let (dr, dl, dalpha, dbeta) = (dr?, dl?, dalpha?, dbeta?);
    let (base, tool, joints, elastic, name) = (base?, tool?, joints?, elastic?, name.to_string());
    let periodic = periodic?;
    if arm.modified {
        refuse_first_row(t, &base, &joints);
    }
    let rows = SignedErrors { name, dq, dr, dl, dalpha, dbeta, base, tool, joints, elastic, periodic };
    let mut values = rows.values();
    arm.in_order(&mut values);
    let SignedErrors { name, periodic, .. } = rows;
    Some(SignedErrors::of_values(name, n, &values).with_periodic(periodic))
}

/// Refuses errors of the base and of joint 1 that duplicate errors of row 1 of a modified D-H table.
///
/// A modified row begins with its common normal l and twist alpha. So the error dalpha of the twist of row 1
/// has the effect of a rotation rx of the base. The error dl of l has the effect of a displacement x of joint
/// 1. The error dbeta of Hayati's fifth parameter has the effect of a rotation ry of this joint.
fn refuse_first_row(t: &mut Table, base: &[f64; PER_FRAME], joints: &[[f64; PER_FRAME]]) {
    let of_base = (
        error_set::BASE,
        base[3] != 0.0,
        "rx of `base` is the same error as dalpha",
        "the first number of dalpha_deg",
    );
    let is_joint = joints.first().is_some_and(|joint| joint[0] != 0.0 || joint[4] != 0.0);
    let place = "the first number of dl_mm (for x) or dbeta_deg (for ry)";
    let of_joint =
        (error_set::JOINTS, is_joint, "x and ry of joint 1 are the same errors as dl and dbeta", place);
    for (key, _, what, place) in [of_base, of_joint].into_iter().filter(|of| of.1) {
        let at = t.get(&key).map_or(t.at, |node| node.at);
        let message =
            format!("{what} of row 1, because the rows of this robot follow the modified D-H convention");
        t.error(at, message, format!("state this error as {place}"));
    }
}

/// Records a fault for every nonzero number of `key` whose joint is not of the kind `kind`.
fn check_joint_kinds(t: &mut Table, key: &Key, values: &[f64], arm: ErrorRows<'_>, kind: JointKind) {
    let Some(node) = t.get(key) else { return };
    let (is, right) = match kind {
        JointKind::Revolute => ("slides", "dq_mm"),
        JointKind::Prismatic => ("turns", "dq_deg"),
    };
    let pairs = arm.joints.iter().zip(values).enumerate();
    for (i, (joint, _)) in pairs.filter(|(_, (j, v))| j.kind != kind && **v != 0.0) {
        let message = format!("entry {} of `{}` must be 0: joint `{}` {is}", i + 1, key.name, joint.name);
        t.error(node.at, message, format!("give its error in {right}"));
    }
}
