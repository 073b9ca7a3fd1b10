//! Manipulability and joint-limit distance: measures of how far a posture is from singularities and from
//! joint limits.

use crate::cell::{JointVector, MAX_JOINTS};
use crate::reach::jacobian;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix6, SMatrix, Vector3, Vector6};

/// Geometric Jacobian: three rows for the position, divided by the reach of the arm, then three rows for the
/// rotation.
pub(super) type ScaledJacobian = SMatrix<f64, 6, MAX_JOINTS>;

/// Least diagonal entry of the Cholesky factor of `J^T J`, where J is the scaled Jacobian. At this value, the
/// solution of the normal equations keeps about half of its digits.
const WELL_CONDITIONED: f64 = 1e-4;

/// Measures of how far a posture is from joint limits and singularities. A search can maximize these measures
/// while it minimizes the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Least distance of a joint from its nearer limit, as a share of half the joint's range.
    ///
    /// The value is 1 in the middle of the range and 0 at the limit. Beyond the limit, it is negative.
    pub limits: f64,
    /// Index of the joint with the least value of [`Self::limits`].
    pub joint: usize,
    /// Manipulability measure that [`singularity`] returns.
    pub singularity: f64,
}

/// Returns the joint-limit distance and the manipulability at joint coordinates (rad, m). `reach` is a
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
/// This value is a measure of manipulability, and is 0 in a singular posture (C. A. Klein, B. E. Blaho,
/// "Dexterity measures for the design and control of kinematically redundant manipulators", IJRR 6(2),
/// 1987). J. Angeles, Fundamentals of Robotic Mechanical Systems, explains the division by a characteristic
/// length. An arm with n < 6 actuators moves the TCP in only n directions. The measure is then the n-th
/// largest singular value.
pub fn singularity(chain: &Chain, frames: &Frames, reach: f64) -> f64 {
    let actuators = chain.links.iter().filter(|link| is_moving(link.limits)).count();
    let mut values: [f64; 6] = scaled_jacobian(chain, frames, reach).singular_values().into();
    values.sort_by(|a, b| b.total_cmp(a));
    actuators.min(6).checked_sub(1).map_or(0.0, |last| values[last])
}

/// Returns whether the [`singularity`] measure of a posture exceeds `least`.
///
/// All singular values of a matrix J exceed s if the matrix `J^T J - s^2 I` is positive definite. Here s is
/// `least`, and I is the identity matrix. For more than six moving joints, `J J^T` replaces `J^T J`. This
/// test takes a tenth of the time of a singular value decomposition.
///
/// A chain without moving joints counts as regular, although [`singularity`] returns 0 for it.
pub fn is_regular(chain: &Chain, frames: &Frames, reach: f64, least: f64) -> bool {
    let jacobian = scaled_jacobian(chain, frames, reach);
    let count = moving_joints(chain).count();
    let mut gram = match count > 6 {
        true => jacobian * jacobian.transpose(),
        false => gram(chain, &jacobian),
    };
    (0..count.min(6)).for_each(|k| gram[(k, k)] -= least * least);
    gram.cholesky().is_some()
}

/// Returns `J^T J` over the columns of the moving joints. The chain must have at most six moving joints. If
/// it has fewer, the remaining rows and columns are those of the identity matrix.
fn gram(chain: &Chain, jacobian: &ScaledJacobian) -> Matrix6<f64> {
    let mut gram = Matrix6::identity();
    for (a, j) in moving_joints(chain).enumerate() {
        for (b, k) in moving_joints(chain).enumerate().take(a + 1) {
            let product = (0..6).map(|row| jacobian[(row, j)] * jacobian[(row, k)]).sum();
            (gram[(a, b)], gram[(b, a)]) = (product, product);
        }
    }
    gram
}

/// Returns the indices of the joints that move.
fn moving_joints(chain: &Chain) -> impl Iterator<Item = usize> {
    (0..chain.axes()).filter(|&j| is_moving(chain.links[j].limits))
}

/// Returns the joint displacements that cause the motion `motion` of the TCP, in the least-squares sense. If
/// there are several solutions, the function returns the solution of least norm. The displacement in `motion`
/// is divided by `reach`, like the position rows of the Jacobian.
///
/// The function solves the normal equations, which takes a fifth of the time of a singular value
/// decomposition. It uses this decomposition only for a nearly singular posture or for more than six moving
/// joints. Singular values below `rank_tolerance` count as 0. Returns None if the decomposition fails.
pub(super) fn joint_displacements(
    chain: &Chain,
    frames: &Frames,
    reach: f64,
    motion: &Vector6<f64>,
    rank_tolerance: f64,
) -> Option<JointVector> {
    let jacobian = scaled_jacobian(chain, frames, reach);
    let mut solved = [0.0; MAX_JOINTS];
    if moving_joints(chain).count() <= 6
        && let Some(factor) = gram(chain, &jacobian).cholesky()
        && factor.l_dirty().diagonal().min() >= WELL_CONDITIONED
    {
        let mut right = Vector6::zeros();
        moving_joints(chain).enumerate().for_each(|(a, j)| right[a] = jacobian.column(j).dot(motion));
        factor.solve_mut(&mut right);
        moving_joints(chain).enumerate().for_each(|(a, j)| solved[j] = right[a]);
        return Some(solved);
    }
    let least = jacobian.svd(true, true).solve(motion, rank_tolerance).ok()?;
    solved.copy_from_slice(least.as_slice());
    Some(solved)
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
