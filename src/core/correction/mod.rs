//! Correction of a program: the joint coordinates with which a robot with errors reaches a target.
//!
//! Let T(q) be the nominal pose of the TCP at the joint coordinates q, and E(q) the error of this pose
//! according to the nonlinear model. The correction solves `E(q) T(q) = T*` for a target T*. The pose command
//! is then the nominal pose T(q). If a controller without calibration receives this command, the robot
//! reaches T*.
//!
//! Newton's method uses the geometric Jacobian of the nominal arm. The relative difference between this
//! Jacobian and the Jacobian of the arm with errors is about 0.001. So each step multiplies the remaining
//! error by about 0.001, or by a larger factor near a singular posture. Position has priority over
//! orientation. An arm with fewer than six joints attains the position, but only approximates the
//! orientation. Motions in the null space of the position rows of the Jacobian do not move the TCP. A
//! least-squares solution selects the motion in this null space that leaves the least orientation error.

mod step;

use crate::cell::{JointVector, MAX_JOINTS};
use crate::pose::{Displacement, Pose, SmallRotation};
use crate::reach::{jacobian, rotation_vector};
use crate::robot::{Chain, Frames};
use step::step;

/// Largest number of Newton steps.
pub const MAX_STEPS: usize = 500;

/// Largest change of a joint in one step, rad or m.
const LONGEST_STEP: f64 = 0.1;

/// The method has converged when the change of the joints (rad or m) is below this value.
const CONVERGED: f64 = 1e-11;

/// Largest distance, m, between the TCP and the target at which a correction counts as converged.
const ON_TARGET: f64 = 1e-9;

/// Joint coordinates that bring the TCP to a target in spite of the errors of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
    /// Pose command: the nominal pose of the TCP at these coordinates, in the base frame.
    pub command: Pose,
    /// Remaining error: position (m) and rotation vector (rad) from the target to the attained pose, base
    /// frame.
    pub rest: Displacement,
    pub steps: usize,
    /// Whether the last Newton step is negligible and the TCP is at the target.
    pub converged: bool,
    /// Index of the joint that exceeds its limits by the largest share of its travel. None if all joints
    /// are within their limits.
    pub beyond: Option<usize>,
}

/// Returns the corrected joint coordinates for a target (base frame).
///
/// `start` holds joint coordinates near the solution, such as those of the nominal robot at the target.
/// `error` returns the error of the TCP in the base frame for given link frames. A joint is passive if its
/// lower limit equals its upper limit. The function does not change the actuator coordinates of passive
/// joints.
pub fn corrected(
    chain: &Chain,
    start: &JointVector,
    target: &Pose,
    mut error: impl FnMut(&Frames) -> Displacement,
) -> Correction {
    let active: Vec<usize> = (0..chain.axes()).filter(|&i| !chain.links[i].is_passive()).collect();
    let (mut joints, mut steps, mut is_still) = (*start, 0, false);
    loop {
        let frames = chain.frames(&chain.posture(&joints));
        let rest = rest_of(target, &frames.tcp, &error(&frames));
        if is_still || steps == MAX_STEPS {
            let converged = is_still && rest.position.norm() < ON_TARGET;
            let beyond = beyond_limits(chain, &joints);
            return Correction { joints, command: frames.tcp, rest, steps, converged, beyond };
        }
        let columns = jacobian(chain, &frames);
        let mut change = step(&active.iter().map(|&i| columns[i]).collect::<Vec<_>>(), &(rest * -1.0));
        let largest = change.iter().fold(0.0_f64, |most, by| most.max(by.abs()));
        if largest > LONGEST_STEP {
            change.iter_mut().for_each(|by| *by *= LONGEST_STEP / largest);
        }
        active.iter().zip(&change).for_each(|(&i, by)| joints[i] += by);
        is_still = largest < CONVERGED;
        steps += 1;
    }
}

/// Returns the displacement from the target to the attained pose. The attained pose is the nominal pose `tcp`
/// displaced by `error`.
fn rest_of(target: &Pose, tcp: &Pose, error: &Displacement) -> Displacement {
    let back = rotation_vector(&(tcp.rotation * target.rotation.transpose()));
    let rotation = SmallRotation::of(&error.rotation).after(&SmallRotation::of(&back)).vector();
    Displacement { position: tcp.translation - target.translation + error.position, rotation }
}

/// Returns the index of the joint that exceeds its limits by the largest share of its travel. A passive joint
/// has no travel and is left out.
///
/// Returns None if all joints are within their limits.
fn beyond_limits(chain: &Chain, joints: &JointVector) -> Option<usize> {
    let excess = |i: usize| {
        let (low, high) = chain.links[i].limits;
        (low - joints[i]).max(joints[i] - high) / (high - low)
    };
    let active = (0..chain.axes().min(MAX_JOINTS)).filter(|&i| !chain.links[i].is_passive());
    let all = active.filter(|&i| excess(i) > 0.0);
    all.max_by(|&a, &b| excess(a).total_cmp(&excess(b)))
}
