//! Manipulability and joint-limit distance: how far a posture is from singularities and limits.

use crate::cell::{JointVector, MAX_JOINTS};
use crate::reach::jacobian;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix6, SMatrix, Vector3};

/// Geometric Jacobian: three rows for the position, divided by the reach of the arm, then three rows for the
/// rotation.
pub(super) type ScaledJacobian = SMatrix<f64, 6, MAX_JOINTS>;

/// Measures of a posture that a search may maximize besides minimizing the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Least distance of a joint from its limit, as a share of half its range.
    ///
    /// 1 is the middle of the range, 0 the limit, and a negative value is beyond the limit.
    pub limits: f64,
    /// Joint that is nearest to a limit.
    pub joint: usize,
    /// Manipulability measure; see [`singularity`].
    pub singularity: f64,
}

/// Returns the joint-limit distance and the manipulability at joint coordinates (rad, m); `reach` is a
/// characteristic length of the arm, m.
pub fn measures(chain: &Chain, joints: &JointVector, reach: f64) -> Measures {
    let frames = chain.frames(&chain.posture(joints));
    let moving = chain.links.iter().zip(joints).enumerate().filter(|(_, (link, _))| is_moving(link.limits));
    let share = moving.map(|(i, (link, q))| {
        let (low, high) = link.limits;
        (i, (q - low).min(high - q) / ((high - low) / 2.0))
    });
    let (joint, limits) = share.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0));
    Measures { limits, joint, singularity: singularity(chain, &frames, reach) }
}

/// Returns the least singular value of the geometric Jacobian, with lengths divided by `reach` (m).
///
/// It is a measure of manipulability, 0 in a singular posture (C. A. Klein, B. E. Blaho, "Dexterity measures
/// for the design and control of kinematically redundant manipulators", IJRR 6(2), 1987). J. Angeles,
/// Fundamentals of Robotic Mechanical Systems, explains the division by a characteristic length. An arm with
/// n < 6 actuators moves the TCP in only n directions. The measure is then the n-th largest singular value.
pub fn singularity(chain: &Chain, frames: &Frames, reach: f64) -> f64 {
    let actuators = chain.links.iter().filter(|link| is_moving(link.limits)).count();
    let mut values: [f64; 6] = scaled_jacobian(chain, frames, reach).singular_values().into();
    values.sort_by(|a, b| b.total_cmp(a));
    actuators.min(6).checked_sub(1).map_or(0.0, |last| values[last])
}

/// Returns whether the [`singularity`] measure of a posture is at least `least`.
///
/// All singular values of a matrix J are at least s if the matrix `J^T J - s^2` is positive definite. This test
/// takes a tenth of the time of a singular value decomposition.
pub fn is_regular(chain: &Chain, frames: &Frames, reach: f64, least: f64) -> bool {
    let jacobian = scaled_jacobian(chain, frames, reach);
    let moving = || (0..chain.axes()).filter(|&j| is_moving(chain.links[j].limits));
    let count = moving().count();
    // Unused rows and columns are those of the identity.
    let mut gram = Matrix6::identity();
    if count > 6 {
        gram.copy_from(&(jacobian * jacobian.transpose()));
    } else {
        for (a, j) in moving().enumerate() {
            for (b, k) in moving().enumerate() {
                gram[(a, b)] = jacobian.column(j).dot(&jacobian.column(k));
            }
        }
    }
    (0..count.min(6)).for_each(|k| gram[(k, k)] -= least * least);
    gram.cholesky().is_some()
}

/// Returns the geometric Jacobian with lengths divided by `reach` (m). The column of a passive joint is 0.
pub(super) fn scaled_jacobian(chain: &Chain, frames: &Frames, reach: f64) -> ScaledJacobian {
    let mut columns = ScaledJacobian::zeros();
    let all = jacobian(chain, frames);
    for j in (0..chain.axes()).filter(|&j| is_moving(chain.links[j].limits)) {
        let position: Vector3<f64> = all[j].position / reach;
        columns.fixed_view_mut::<3, 1>(0, j).copy_from(&position);
        columns.fixed_view_mut::<3, 1>(3, j).copy_from(&all[j].rotation);
    }
    columns
}

fn is_moving((low, high): (f64, f64)) -> bool {
    low < high
}
