//! Tool task of a posture: the controlled components of the TCP motion. The inverse kinematics controls these
//! components.
//!
//! If a target moves a little, the arm follows the target in the same branch. The joint motion then solves a
//! square system of equations. The system has three rows for the position of the TCP, and one row for each
//! controlled rotation.

use super::inverse::Inverse;
use super::numeric::jacobian;
use super::solver::ChainSolver;
use super::tool_attitudes::ToolAttitudes;
use crate::cell::MAX_JOINTS;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix6, Vector3};

/// Largest number of rows of a [`ToolTask`]: three for the position and three for the rotation.
pub const MAX_ROWS: usize = 6;

/// One controlled component of the rotation of the tool.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RotationRow {
    /// Component of the angular velocity along a fixed direction of the base frame.
    Along(Vector3<f64>),
    /// Sum of the joint rates multiplied by these coefficients, which are the same in every posture.
    Joints([f64; MAX_JOINTS]),
}

/// Controlled components of the TCP motion at one posture: its position, and some components of its rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToolTask {
    /// Number of rows: linear equations for the joint rates, one per controlled component. This number equals
    /// the number of active joints.
    pub rows: usize,
    /// Indices of the joints that follow the target; the other joints do not move. Only the first `rows`
    /// entries are used.
    pub active: [usize; MAX_ROWS],
    /// Controlled components of the rotation.
    ///
    /// Each entry holds a component and its required rate. This rate applies if the reference azimuth
    /// ([`Inverse::heading`]) rotates at 1 rad/s. Only the first `rows - 3` entries are used.
    pub rotation: [(RotationRow, f64); MAX_ROWS - 3],
    /// Whether the reference azimuth ([`Inverse::heading`]) is the direction from the base axis to the
    /// target. Otherwise, this azimuth is fixed in the surface.
    pub radial: bool,
    /// Whether the tool keeps its whole orientation relative to the reference azimuth ([`Inverse::heading`]).
    pub keeps_orientation: bool,
}

impl Inverse {
    /// Returns the tool task of the posture whose frames are `frames`.
    ///
    /// Returns None in three cases, because no square system describes the motion:
    ///
    /// - A planar arm has to keep an azimuth or a spin that its joints do not control.
    /// - The numeric solver solves an arm that has neither six nor seven joints. A five-axis arm with a
    ///   vertical tool and a free spin is an exception.
    /// - The numeric solver may tilt the tool within a tolerance.
    pub fn tool_task(&self, attitudes: &ToolAttitudes, frames: &Frames) -> Option<ToolTask> {
        let (set, axes) = (&attitudes.set, self.chain.axes());
        let along = |e: Vector3<f64>| (RotationRow::Along(e), e.z);
        let whole = [Vector3::x(), Vector3::y(), Vector3::z()].map(along);
        let task = |held: Option<usize>, rotation: &[(RotationRow, f64)], keeps_orientation| {
            let mut all = ToolTask {
                rows: 3 + rotation.len(),
                active: [0; MAX_ROWS],
                rotation: whole,
                radial: set.radial,
                keeps_orientation,
            };
            let active = (0..axes).filter(|j| Some(*j) != held);
            all.active.iter_mut().zip(active).for_each(|(place, joint)| *place = joint);
            all.rotation.iter_mut().zip(rotation).for_each(|(place, row)| *place = *row);
            let is_square = axes - usize::from(held.is_some()) == all.rows;
            is_square.then_some(all)
        };
        match &self.solver {
            ChainSolver::Planar(arm) if set.is_checked(arm.rolls()) => None,
            ChainSolver::Planar(arm) => {
                let pitch = (RotationRow::Joints(pitch(frames)), 0.0);
                if !arm.rolls() {
                    return task(None, &[pitch], false);
                }
                // The last joint rolls a vertical tool about the vertical, and otherwise does not move.
                let mut row = [0.0; MAX_JOINTS];
                row[4] = if set.vertical { frames.links[4].rotation[(2, 2)].signum() } else { 1.0 };
                row[0] = f64::from(u8::from(set.vertical));
                task(None, &[pitch, (RotationRow::Joints(row), row[0])], set.vertical)
            }
            ChainSolver::Pose(solver) if solver.is_scara() => task(None, &[along(Vector3::z())], true),
            ChainSolver::Pose(_) => task(None, &whole, true),
            ChainSolver::Redundant(_) if self.follower.is_some() => {
                task(Some(best_held(&self.chain, frames)), &whole, true)
            }
            ChainSolver::Redundant(joint) => task(Some(joint.index()), &whole, true),
            ChainSolver::Numeric(_) if set.tolerance > 0.0 => None,
            ChainSolver::Numeric(_) => match axes {
                5 if set.vertical && set.spin_is_free => task(None, &whole[..2], false),
                6 => task(None, &whole, true),
                7 => task(Some(best_held(&self.chain, frames)), &whole, true),
                _ => None,
            },
        }
    }
}

/// Returns the coefficients of the pitch rate of a planar arm: 1 or -1 for each of the three parallel axes,
/// otherwise 0.
fn pitch(frames: &Frames) -> [f64; MAX_JOINTS] {
    let axis = |j: usize| frames.links[j].rotation.column(2).into_owned();
    let mut row = [0.0; MAX_JOINTS];
    (1..4).for_each(|j| row[j] = axis(1).dot(&axis(j)).signum());
    row
}

/// Returns the index of the joint of a seven-axis arm that should stay fixed at this posture.
///
/// The removal of one column from the 6 x 7 Jacobian matrix leaves a 6 x 6 matrix. The absolute determinant
/// of this matrix is largest if the column of the returned joint is removed.
///
/// This joint has the largest share in the self-motion of the arm.
pub(super) fn best_held(chain: &Chain, frames: &Frames) -> usize {
    let columns = jacobian(chain, frames);
    let volume = |held: usize| {
        let mut kept = Matrix6::zeros();
        for (mut column, j) in kept.column_iter_mut().zip((0..7).filter(|j| *j != held)) {
            column.fixed_rows_mut::<3>(0).copy_from(&columns[j].position);
            column.fixed_rows_mut::<3>(3).copy_from(&columns[j].rotation);
        }
        kept.determinant().abs()
    };
    (0..7).max_by(|a, b| volume(*a).total_cmp(&volume(*b))).unwrap_or(0)
}
