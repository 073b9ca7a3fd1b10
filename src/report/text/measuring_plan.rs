//! Text of a plan of measuring poses.

use super::fixed;
use super::table::TextTable;
use crate::cell::Robot;
use crate::files::shown;
use crate::record::MeasuringPlanDocument;
use std::fmt::Write;

/// Returns the poses of a plan (without passive joints) and the expected error before and after the
/// measurement.
pub fn measuring_plan(robot: &Robot, document: &MeasuringPlanDocument) -> String {
    let (expected, tried) = (&document.expected, &document.tried);
    let mut out = format!(
        "{}: {} poses to calibrate {}, chosen from {} candidates ({} other poses collide, {} are hidden)\n\n",
        shown(&document.cell),
        document.poses.len(),
        shown(&document.robot),
        tried.candidates,
        tried.colliding,
        tried.hidden
    );
    let active: Vec<usize> = (0..robot.axes()).filter(|&i| !robot.joints[i].is_passive()).collect();
    let mut table = TextTable::indented(1);
    let joints = (1..=active.len()).map(|k| format!("q{k}"));
    let heads = ["reflector x", "y", "z"].map(String::from);
    table.row(["pose".to_string()].into_iter().chain(joints).chain(heads));
    for planned in &document.poses {
        let joints = active.iter().map(|&i| fixed(planned.joints[i], 2));
        let place = planned.reflector_mm.map(|mm| fixed(mm, 1));
        table.row([planned.pose.to_string()].into_iter().chain(joints).chain(place));
    }
    out.push_str(&table.render());
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "\nExpected rms error of predicted positions at {} nodes of the operations, after registration \
        of the base: {} mm without a measurement, {} mm with these poses, {} mm with {} other poses that fill \
        the joint space evenly. These figures leave out the error that the {} unknowns do not explain. The assumed \
        standard deviation of this error per axis is {} mm for the part that nearby poses share, and {} mm for the \
        part of each pose alone.",
        expected.nodes,
        fixed(expected.before_mm, 3),
        fixed(expected.after_mm, 3),
        fixed(expected.evenly_spread_mm, 3),
        document.poses.len(),
        document.unknowns,
        fixed(expected.shared_misfit_mm, 2),
        fixed(expected.own_misfit_mm, 2),
    );
    out
}
