//! The D-H rows derived from a URDF.

use super::table::TextTable;
use crate::cell::{JointKind, Robot, UrdfOrigin};
use crate::files::shown;
use crate::pose::Pose;
use crate::record::roll_pitch_yaw;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;

/// Returns the derived D-H rows of a robot and the unused elements of its URDF. The text is empty for a robot
/// given by D-H rows.
pub fn derived(robot: &Robot) -> String {
    let Some(UrdfOrigin { file, base_link, tip_link, tip, ignored }) = &robot.urdf else {
        return String::new();
    };
    let mut table = TextTable::indented(2);
    table.row(["row", "joint", "theta deg", "r mm", "l mm", "alpha deg", "from", "to", ""]);
    for (k, joint) in robot.joints.iter().enumerate() {
        let (unit, si): (_, fn(f64) -> f64) = match joint.kind {
            JointKind::Revolute => ("deg", deg_from_rad),
            JointKind::Prismatic => ("mm", mm_from_m),
        };
        let numbers =
            [deg_from_rad(joint.theta), mm_from_m(joint.r), mm_from_m(joint.l), deg_from_rad(joint.alpha)];
        let numbers = numbers.map(|v| rounded(v, 6).to_string());
        let limits = [joint.limits.0, joint.limits.1].map(|v| rounded(si(v), 4).to_string());
        let unit = if joint.is_passive() { "passive" } else { unit };
        let head = [format!("A{}", k + 1), shown(&joint.name)];
        table.row(head.into_iter().chain(numbers).chain(limits).chain([unit.to_string()]));
    }
    let counts: Vec<_> = ignored.iter().map(|(what, n)| format!("{n} {}", shown(what))).collect();
    format!(
        "D-H rows from {}, {} to {}: A = Rz(theta + q) Tz(r) Tx(l) Rx(alpha)\n{}\
         {}{}  {} solids of the links; not used: {}\n",
        shown(file),
        shown(base_link),
        shown(tip_link),
        table.render(),
        placed("base link to frame 0", &robot.mount),
        placed("last frame to tip link", tip),
        robot.solids.len(),
        if counts.is_empty() { "nothing".to_string() } else { counts.join(", ") },
    )
}

fn placed(what: &str, pose: &Pose) -> String {
    if *pose == Pose::identity() {
        return format!("  {what}: identical\n");
    }
    let triple = |v: Vector3<f64>| v.iter().map(|v| rounded(*v, 6).to_string()).collect::<Vec<_>>().join(" ");
    let (at, turn) = (pose.translation.map(mm_from_m), roll_pitch_yaw(pose).map(deg_from_rad));
    format!("  {what}: {} mm, roll pitch yaw {} deg\n", triple(at), triple(turn))
}
