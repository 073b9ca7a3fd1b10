//! Error table for a robot file. The errors come from a fit to measured positions, or from a file with the
//! result of a finished calibration.

use crate::calibration::{Calibration, Unknown};
use crate::cell::{Convention, JointKind, PER_FRAME, Parameter, PeriodicError, Robot, SignedErrors};
use crate::files::toml_string;
use crate::record::CalibrationDocument;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use std::fmt::Write;

/// Returns the table with the identified errors (including elastic terms) and their covariance.
///
/// The table uses the row numbers and the parameter names of the robot file.
pub fn table(robot: &Robot, calibration: &Calibration, document: &CalibrationDocument) -> String {
    let poses: usize = document.sessions.iter().map(|s| s.poses).sum();
    let head = format!(
        "[errors.measured]\nkind = \"measured\"\nsource = \"sweetspot calibrate: {poses} measured positions, \
         residual {} mm per axis\"\n",
        rounded(document.residual_mm.unwrap_or(0.0), 3)
    );
    let parts = [
        head,
        ranges(robot, calibration),
        lists(robot, calibration),
        elastic(calibration),
        periodic(calibration),
        covariance(robot, calibration),
    ];
    parts.concat()
}

/// Returns the range of every joint among the measured postures, degrees or mm.
fn ranges(robot: &Robot, calibration: &Calibration) -> String {
    let range = |(joint, (low, high)): (usize, &(f64, f64))| {
        let of_file = if slides(robot, joint) { mm_from_m } else { deg_from_rad };
        format!("[{}, {}]", rounded(of_file(*low), 4), rounded(of_file(*high), 4))
    };
    let all: Vec<String> = calibration.ranges.iter().enumerate().map(range).collect();
    format!("measured_ranges = [{}]\n", all.join(", "))
}

/// Returns the errors of the D-H rows: one list for each key of the error set, such as `dq_deg`. A list of
/// zeros is left out, unless the error set requires its key.
fn lists(robot: &Robot, calibration: &Calibration) -> String {
    let axes = robot.axes();
    let [mut dq_deg, mut dq_mm, mut dr, mut dl, mut dalpha, mut dbeta] = [(); 6].map(|()| vec![0.0; axes]);
    for identified in calibration.parameters() {
        let (mm, deg) = (mm_from_m(identified.value), deg_from_rad(identified.value));
        match of_file(robot, identified.unknown) {
            Parameter::Dq(i) if slides(robot, i) => dq_mm[i] = mm,
            Parameter::Dq(i) => dq_deg[i] = deg,
            Parameter::Dr(i) => dr[i] = mm,
            Parameter::Dl(i) => dl[i] = mm,
            Parameter::Dalpha(i) => dalpha[i] = deg,
            Parameter::Dbeta(i) => dbeta[i] = deg,
            _ => {}
        }
    }
    // The errors dr, dl and dalpha are required keys of an error set.
    let lists = [
        ("dq_deg", dq_deg, false),
        ("dq_mm", dq_mm, false),
        ("dr_mm", dr, true),
        ("dl_mm", dl, true),
        ("dalpha_deg", dalpha, true),
        ("dbeta_deg", dbeta, false),
    ];
    let written = lists.iter().filter(|(_, list, required)| *required || list.iter().any(|v| *v != 0.0));
    let line =
        |(key, list, _): &(&str, Vec<f64>, bool)| format!("{key} = [{}]\n", numbers(list.iter().copied()));
    written.map(line).collect()
}

/// Returns the elastic terms; empty if there are none.
fn elastic(calibration: &Calibration) -> String {
    let terms = calibration.identified.iter().filter_map(|identified| match identified.unknown {
        Unknown::Elastic { joint, link } => Some(format!(
            "    {{ joint = {}, link = {}, deg_per_m = {} }},\n",
            joint + 1,
            link + 1,
            rounded(deg_from_rad(identified.value), 7)
        )),
        Unknown::Row(_) | Unknown::Harmonic { .. } => None,
    });
    let terms: String = terms.collect();
    if terms.is_empty() { terms } else { format!("elastic = [\n{terms}]\n") }
}

/// Returns the periodic errors of the joints; empty if there are none.
fn periodic(calibration: &Calibration) -> String {
    let errors = calibration.periodic_errors();
    if errors.is_empty() {
        return String::new();
    }
    let list = |values: &[f64]| {
        let shown = values.iter().map(|v| rounded(deg_from_rad(*v), 7).to_string());
        shown.collect::<Vec<_>>().join(", ")
    };
    let entry = |error: &PeriodicError| {
        let (joint, cos, sin) = (error.joint + 1, list(&error.cos), list(&error.sin));
        format!("    {{ joint = {joint}, cos_deg = [{cos}], sin_deg = [{sin}] }},\n")
    };
    let entries: String = errors.iter().map(entry).collect();
    format!("periodic = [\n{entries}]\n")
}

/// Returns the table `covariance` of the robot file, with all digits of its numbers. The covariance includes
/// the errors that the identified parameters do not explain (misfit).
///
/// The misfit of a joint is stated as a variance of its coordinate. This variance includes the uncertainty of
/// the periodic error of the joint. The misfit of positions is stated as a variance of the TCP position.
fn covariance(robot: &Robot, calibration: &Calibration) -> String {
    let identified = calibration.parameters().iter().map(|i| of_file(robot, i.unknown));
    let mut parameters: Vec<Parameter> = identified.collect();
    let misfit = &calibration.misfit;
    let of_joints = misfit.joints.iter().enumerate().map(|(joint, variance)| {
        (Parameter::Dq(joint), variance + calibration.variance_of_periodic_error(joint))
    });
    let of_tool = (0..3).map(|axis| (Parameter::Tool(axis), misfit.position));
    let unexplained: Vec<_> = of_joints.chain(of_tool).collect();
    for (parameter, _) in &unexplained {
        if !parameters.contains(parameter) {
            parameters.push(*parameter);
        }
    }
    let size = parameters.len();
    let mut matrix = calibration.covariance_beside_periodic_errors().resize(size, size, 0.0);
    for (k, parameter) in parameters.iter().enumerate() {
        let own = unexplained.iter().find(|(unexplained, _)| unexplained == parameter);
        matrix[(k, k)] += own.map_or(0.0, |(_, variance)| *variance);
    }
    let scales: Vec<f64> = parameters.iter().map(|parameter| scale(robot, *parameter)).collect();
    let names: Vec<String> = parameters.iter().map(|parameter| format!("\"{}\"", parameter.name())).collect();
    let mut out = format!("[errors.measured.covariance]\nparameters = [{}]\nmatrix = [\n", names.join(", "));
    for i in 0..size {
        // The lower half of the matrix repeats the upper half. The matrix in the file is therefore symmetric
        // to the last digit.
        let entry = |j: usize| {
            let (a, b) = (i.min(j), i.max(j));
            format!("{:e}", matrix[(a, b)] * scales[a] * scales[b])
        };
        let row: Vec<String> = (0..size).map(entry).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(out, "    [{}],", row.join(", "));
    }
    out + "]\n"
}

/// Returns the number of mm or degrees in one unit (m or rad) of a parameter.
fn scale(robot: &Robot, parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Dr(_) | Parameter::Dl(_) | Parameter::Tool(_) => mm_from_m(1.0),
        Parameter::Dq(i) if slides(robot, i) => mm_from_m(1.0),
        _ => deg_from_rad(1.0),
    }
}

/// Converts an unknown of the fit to a parameter of the robot file.
///
/// The unknowns of the fit refer to standard D-H rows. If the robot file has modified rows, the common
/// normal of standard row `i` belongs to the modified row `i + 1`.
fn of_file(robot: &Robot, unknown: Unknown) -> Parameter {
    let shift = usize::from(robot.convention == Convention::Modified);
    match unknown {
        Unknown::Row(Parameter::Dl(i)) => Parameter::Dl(i + shift),
        Unknown::Row(Parameter::Dalpha(i)) => Parameter::Dalpha(i + shift),
        Unknown::Row(Parameter::Dbeta(i)) => Parameter::Dbeta(i + shift),
        Unknown::Row(parameter) => parameter,
        Unknown::Elastic { joint, link } => Parameter::Elastic(joint, link),
        // Periodic errors count as misfit of their joint.
        Unknown::Harmonic { joint, .. } => Parameter::Dq(joint),
    }
}

fn slides(robot: &Robot, joint: usize) -> bool {
    robot.joints[joint].kind == JointKind::Prismatic
}

fn numbers(values: impl Iterator<Item = f64>) -> String {
    values.map(|v| rounded(v, 7).to_string()).collect::<Vec<_>>().join(", ")
}

/// Number of decimals of stated errors, in mm and degrees.
const STATED_DECIMALS: i32 = 10;

/// Returns the table with the errors of a finished calibration, as a signed sample. `source` names the file
/// with the result of this calibration.
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
