//! Repeatability: the scatter of one robot that repeats a pose, computed from random errors of its joints.

use super::arm_series::PoseAccuracyTest;
use crate::cell::{JointKind, JointVector, MAX_JOINTS, Robot};
use crate::low_discrepancy::richtmyer_steps;
use crate::pose::Displacement;
use crate::reach::jacobian;
use crate::reading::normal_quantile::normal_quantile;
use crate::robot::Chain;
use nalgebra::Vector3;

/// Number of repetitions at each pose.
const REPETITIONS: usize = 4096;

/// Returns the standard deviations of the joint coordinates (rad or m) that give the robot the pose
/// repeatability `rp` (m) of ISO 9283. Returns None if no joint moves the TCP.
///
/// Every revolute joint scatters by the same angle. A prismatic joint scatters by that angle times the reach
/// of the arm, so all joints move the TCP by similar distances. The scatter is in proportion to `rp`.
pub fn joint_scatter(
    robot: &Robot,
    chain: &Chain,
    test: &PoseAccuracyTest<'_>,
    rp: f64,
) -> Option<JointVector> {
    let reach = robot.reach();
    let mut unit = [0.0; MAX_JOINTS];
    for (deviation, joint) in unit.iter_mut().zip(&robot.joints).filter(|(_, joint)| !joint.is_passive()) {
        *deviation = match joint.kind {
            JointKind::Revolute => 1.0,
            JointKind::Prismatic => reach,
        };
    }
    let scale = rp / repeatability(chain, test, &unit);
    scale.is_finite().then(|| unit.map(|deviation| deviation * scale))
}

/// Returns the repeatability RP (m) of ISO 9283, as the mean over the five poses. The errors of the joint
/// coordinates are normally distributed, with the standard deviations `deviations` (rad or m).
///
/// `RP = l + 3 S`, where l and S are the mean and the standard deviation of the distance from the
/// barycentre. The distances follow from the Jacobian.
pub fn repeatability(chain: &Chain, test: &PoseAccuracyTest<'_>, deviations: &JointVector) -> f64 {
    let count = REPETITIONS as f64;
    let of_pose = |columns: [Displacement; MAX_JOINTS]| {
        let mut at: Vec<(f64, f64)> = richtmyer_steps().take(chain.axes()).map(|step| (0.5, step)).collect();
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..REPETITIONS {
            let mut moved = Vector3::zeros();
            for ((u, step), (column, deviation)) in at.iter_mut().zip(columns.iter().zip(deviations)) {
                *u = (*u + *step).fract();
                let z = normal_quantile(u.clamp(1e-12, 1.0 - 1e-12));
                moved += column.position * (z * deviation);
            }
            sum += moved.norm();
            squares += moved.norm_squared();
        }
        let mean = sum / count;
        mean + 3.0 * ((squares - count * mean * mean) / (count - 1.0)).max(0.0).sqrt()
    };
    test.frames.iter().map(|frames| of_pose(jacobian(chain, frames))).sum::<f64>() / 5.0
}
