//! Arm in units of its own length, and Newton's method for a pose of the flange.

use super::elimination::solve_six;
use crate::pose::Pose;
use crate::robot::Link;
use nalgebra::{Matrix3, Vector3};

/// A pose is reached if its error, rad and in units of the arm's length, is below this value.
const POSE_ERROR: f64 = 1e-11;

/// Error (rad and units of the arm's length) that is due to rounding. Newton's method ends below this error.
const EXACT: f64 = 1e-13;

/// Largest share of the error that remains after a useful step. Once the pose is reached, Newton's method
/// ends if a step leaves a larger share.
const PROGRESS: f64 = 0.01;

/// Largest error of a pose, rad and in units of the arm's length, at which Newton's method continues.
const MAX_POSE_ERROR: f64 = 1.0;

/// Largest number of steps of Newton's method.
const STEPS: usize = 20;

/// Longest step of a joint, rad. A longer step is shortened without a change of direction.
const LONGEST_STEP: f64 = 0.5;

/// Length added to [`ScaledArm::reach`] as an allowance for rounding, in units of the arm's length.
const ROUNDING: f64 = 1e-9;

/// Six revolute axes with their lengths in units of the arm's length.
#[derive(Clone, Debug)]
pub(super) struct ScaledArm {
    /// Constant part of every link transform, which follows the rotation of its joint.
    pub links: [Pose; 6],
    /// The arm's length, m: a third of the sum of the distances between neighbouring D-H frames.
    pub length: f64,
    /// Upper bound of the distance of the origin of frame 5 from the origin of frame 0.
    reach: f64,
}

/// Solution to which Newton's method leads.
pub(super) struct RefinedJoints {
    /// Joint angles, rad.
    pub angles: [f64; 6],
    /// Largest joint change that the first Newton step requires, rad; 0 if no step is needed.
    ///
    /// The step itself can be smaller, because its largest joint change is limited to [`LONGEST_STEP`].
    pub first_step: f64,
}

impl ScaledArm {
    /// Returns the arm of six D-H rows.
    pub fn new(rows: &[Link; 6]) -> Self {
        let links = rows.map(|row| row.pose(1.0, 0.0, row.r));
        let sum: f64 = links.iter().map(|link| link.translation.norm()).sum();
        let length = if sum > 0.0 && sum.is_finite() { sum / 3.0 } else { 1.0 };
        let links = links.map(|link| Pose { translation: link.translation / length, ..link });
        let reach = links[..5].iter().map(|link| link.translation.norm()).sum::<f64>() + ROUNDING;
        Self { links, length, reach }
    }

    /// Returns a pose (m) with its translation in units of the arm's length.
    pub fn scaled(&self, pose: &Pose) -> Pose {
        Pose { translation: pose.translation / self.length, ..*pose }
    }

    /// Returns how far the origin of frame 5 lies outside its sphere of reach, in units of the arm's length.
    ///
    /// The result is at most 0 inside the sphere, and NaN or infinite if the pose is not finite.
    pub fn beyond_reach(&self, target: &Pose) -> f64 {
        (*target * self.links[5].inverse()).translation.norm() - self.reach
    }

    /// Returns the pose of the flange at joint angles (rad).
    pub fn flange(&self, angles: &[f64; 6]) -> Pose {
        angles
            .iter()
            .zip(&self.links)
            .fold(Pose::IDENTITY, |frame, (angle, link)| turned(&frame, *angle) * *link)
    }

    /// Returns the solution to which Newton's method leads from `angles` (rad); None if the flange does not
    /// reach `target`.
    ///
    /// Newton's method ends early, without the full accuracy, if it arrives at a known solution.
    pub fn refined(
        &self,
        mut angles: [f64; 6],
        target: &Pose,
        is_known: impl Fn(&[f64; 6]) -> bool,
    ) -> Option<RefinedJoints> {
        let (mut before, mut first_step) = (f64::INFINITY, None);
        for _ in 0..STEPS {
            let mut frame = Pose::IDENTITY;
            let axes: [(Vector3<f64>, Vector3<f64>); 6] = std::array::from_fn(|k| {
                let axis = (frame.rotation.column(2).into_owned(), frame.translation);
                frame = turned(&frame, angles[k]) * self.links[k];
                axis
            });
            let apart = target.rotation * frame.rotation.transpose();
            let turn =
                0.5 * Vector3::new(apart.m32 - apart.m23, apart.m13 - apart.m31, apart.m21 - apart.m12);
            let shift = target.translation - frame.translation;
            let error = turn.amax().max(shift.amax());
            // A rotation by more than a right angle has a small sine, too, but a negative trace.
            if error > MAX_POSE_ERROR || error.is_nan() || apart.trace() < 0.0 {
                return None;
            }
            if error < POSE_ERROR && (error < EXACT || error > PROGRESS * before) {
                return Some(RefinedJoints { angles, first_step: first_step.unwrap_or(0.0) });
            }
            before = error;
            let step = newton_step(&axes, &frame.translation, &turn, &shift)?;
            let longest = step.iter().fold(0.0_f64, |longest, by| longest.max(by.abs()));
            let first_step = *first_step.get_or_insert(longest);
            let share = if longest > LONGEST_STEP { LONGEST_STEP / longest } else { 1.0 };
            for (angle, by) in angles.iter_mut().zip(step) {
                *angle += share * by;
            }
            if is_known(&angles) {
                return Some(RefinedJoints { angles, first_step });
            }
        }
        let first_step = first_step.unwrap_or(0.0);
        (before < POSE_ERROR).then_some(RefinedJoints { angles, first_step })
    }
}

/// Returns the step of the joints (rad) that moves the flange by a small rotation and translation, in the
/// linear approximation.
///
/// `axes` are the direction and a point of each joint axis, and `end` is the origin of the flange. Returns
/// `None` if the posture is singular.
#[inline]
fn newton_step(
    axes: &[(Vector3<f64>, Vector3<f64>); 6],
    end: &Vector3<f64>,
    turn: &Vector3<f64>,
    shift: &Vector3<f64>,
) -> Option<[f64; 6]> {
    let mut rows = [[0.0; 7]; 6];
    for (k, (axis, origin)) in axes.iter().enumerate() {
        let moved = axis.cross(&(end - origin));
        for i in 0..3 {
            rows[i][k] = axis[i];
            rows[i + 3][k] = moved[i];
        }
    }
    for i in 0..3 {
        rows[i][6] = turn[i];
        rows[i + 3][6] = shift[i];
    }
    solve_six(rows)
}

/// Returns a frame after a rotation about the z axis of this frame by an angle (rad).
pub(super) fn turned(frame: &Pose, angle: f64) -> Pose {
    let (s, c) = angle.sin_cos();
    let (x, y, z) = (frame.rotation.column(0), frame.rotation.column(1), frame.rotation.column(2));
    Pose { rotation: Matrix3::from_columns(&[x * c + y * s, y * c - x * s, z.into_owned()]), ..*frame }
}
