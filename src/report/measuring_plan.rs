//! Plan of measuring poses as CSV. The user adds the measured positions to this file.

use super::csv::put;
use crate::cell::{Cell, JointKind};
use crate::record::MeasuringPlanDocument;

/// Writes one row for each pose: number, joint coordinates and empty columns for the measured position.
/// Passive joints are left out.
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn csv(cell: &Cell, document: &MeasuringPlanDocument) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let active: Vec<_> =
        cell.robot.joints.iter().enumerate().filter(|(_, joint)| !joint.is_passive()).collect();
    let joints = active.iter().enumerate().map(|(k, (_, joint))| match joint.kind {
        JointKind::Revolute => format!("q{}_deg", k + 1),
        JointKind::Prismatic => format!("q{}_mm", k + 1),
    });
    let position = ["x_mm", "y_mm", "z_mm"].map(String::from);
    put(&mut writer, &["pose".into()].into_iter().chain(joints).chain(position).collect::<Vec<_>>())?;
    for planned in &document.poses {
        let joints = active.iter().map(|(i, _)| planned.joints[*i].to_string());
        let row = [planned.pose.to_string()].into_iter().chain(joints).chain([(); 3].map(|()| String::new()));
        put(&mut writer, &row.collect::<Vec<_>>())?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}
