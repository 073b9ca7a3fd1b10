//! The table `[errors.measured]` of a robot file, from a calibration.

use crate::calibration::{Calibration, Unknown};
use crate::cell::{Convention, JointKind, PER_FRAME, Parameter, Robot, SignedErrors};
use crate::files::toml_string;
use crate::record::CalibrationDocument;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use std::fmt::Write;

/// Returns the table with the identified errors of the Denavit-Hartenberg rows as a signed sample.
///
/// The rows are those of the robot file. Elastic terms are comments, because an error set has no such terms.
pub fn table(robot: &Robot, calibration: &Calibration, document: &CalibrationDocument) -> String {
    let axes = robot.axes();
    // A modified row begins with the common normal at the end of the standard row before it.
    let shift = usize::from(robot.convention == Convention::Modified);
    let [mut dq_deg, mut dq_mm, mut dr, mut dl, mut dalpha, mut dbeta] = [(); 6].map(|()| vec![0.0; axes]);
    for identified in &calibration.identified {
        let (mm, deg) = (mm_from_m(identified.value), deg_from_rad(identified.value));
        match identified.unknown {
            Unknown::Row(Parameter::Dq(i)) => match robot.joints[i].kind {
                JointKind::Revolute => dq_deg[i] = deg,
                JointKind::Prismatic => dq_mm[i] = mm,
            },
            Unknown::Row(Parameter::Dr(i)) => dr[i] = mm,
            Unknown::Row(Parameter::Dl(i)) => dl[i + shift] = mm,
            Unknown::Row(Parameter::Dalpha(i)) => dalpha[i + shift] = deg,
            Unknown::Row(Parameter::Dbeta(i)) => dbeta[i + shift] = deg,
            Unknown::Row(_) | Unknown::Elastic { .. } => {}
        }
    }
    let poses: usize = document.sessions.iter().map(|s| s.poses).sum();
    let mut out = format!(
        "[errors.measured]\nkind = \"signed\"\nsource = \"sweetspot calibrate: {poses} measured positions, \
         residual {} mm per axis\"\n",
        rounded(document.residual_mm.unwrap_or(0.0), 3)
    );
    let lists = [
        ("dq_deg", dq_deg),
        ("dq_mm", dq_mm),
        ("dr_mm", dr),
        ("dl_mm", dl),
        ("dalpha_deg", dalpha),
        ("dbeta_deg", dbeta),
    ];
    // Writing to a String cannot fail.
    for (key, list) in lists.iter().filter(|(_, list)| list.iter().any(|v| *v != 0.0)) {
        let numbers: Vec<_> = list.iter().map(|v| rounded(*v, 7).to_string()).collect();
        let _ = writeln!(out, "{key} = [{}]", numbers.join(", "));
    }
    let elastic = calibration.identified.iter().zip(&document.parameters);
    for (_, entry) in elastic.filter(|(i, _)| matches!(i.unknown, Unknown::Elastic { .. })) {
        let _ = writeln!(out, "# {}: {} {}", entry.name, rounded(entry.value, 7), entry.unit);
    }
    out
}

/// Decimals of stated errors: 1e-10 mm and degrees.
const STATED_DECIMALS: i32 = 10;

/// Returns the table with the errors that a file states, as a signed sample.
pub fn stated_table(robot: &Robot, errors: &SignedErrors, source: &str) -> String {
    let source = toml_string(&format!("sweetspot calibrate: {source}"));
    let mut out = format!("[errors.measured]\nkind = \"signed\"\nsource = {source}\n");
    let list = |values: &[f64]| {
        let numbers: Vec<_> = values.iter().map(|v| rounded(*v, STATED_DECIMALS).to_string()).collect();
        format!("[{}]", numbers.join(", "))
    };
    let in_mm = |values: &[f64]| list(&values.iter().map(|v| mm_from_m(*v)).collect::<Vec<_>>());
    let in_deg = |values: &[f64]| list(&values.iter().map(|v| deg_from_rad(*v)).collect::<Vec<_>>());
    let of_kind = |kind: JointKind| -> Vec<f64> {
        let all = errors.dq.iter().zip(&robot.joints);
        all.map(|(dq, joint)| if joint.kind == kind { *dq } else { 0.0 }).collect()
    };
    let (turns, slides) = (of_kind(JointKind::Revolute), of_kind(JointKind::Prismatic));
    let mut row = |key: &str, values: &[f64], text: String| {
        if values.iter().any(|v| *v != 0.0) {
            let _ = writeln!(out, "{key} = {text}");
        }
    };
    row("dq_deg", &turns, in_deg(&turns));
    row("dq_mm", &slides, in_mm(&slides));
    row("dr_mm", &errors.dr, in_mm(&errors.dr));
    row("dl_mm", &errors.dl, in_mm(&errors.dl));
    row("dalpha_deg", &errors.dalpha, in_deg(&errors.dalpha));
    let frame = |values: &[f64; PER_FRAME]| {
        format!("position_mm = {}, rotation_deg = {}", in_mm(&values[..3]), in_deg(&values[3..]))
    };
    row("tool", &errors.tool, format!("{{ {} }}", frame(&errors.tool)));
    out.push_str("joints = [\n");
    let joints = errors.joints.iter().enumerate().filter(|(_, values)| values.iter().any(|v| *v != 0.0));
    for (k, values) in joints {
        let _ = writeln!(out, "  {{ joint = {}, {} }},", k + 1, frame(values));
    }
    out.push_str("]\n");
    out
}
