//! Bound of the change of the geometric Jacobian in a joint enclosure.
//!
//! The least singular value of the Jacobian changes by at most this change (H. Weyl 1912). A rotation of the
//! whole arm about its first axis does not change the singular values, so this rotation is left out.
//!
//! The change is expanded in the coordinates of the [`PosedChain`]. Its linear part is exact. A column of the
//! Jacobian is the cross product of the joint axis and the pieces of the arm from this axis to the TCP. Let
//! `rho` be the largest change of all coordinates that rotate the axis or a piece, and s the length of the
//! piece. The second derivative of the product along a straight path is at most `s rho^2`. If a prismatic
//! coordinate lengthens the piece by up to r, `2 rho r` is added to this bound.

use super::joint_enclosure::JointEnclosure;
use super::posed_chain::{Piece, PosedChain, Rows};
use crate::reach::ToolTask;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

impl JointEnclosure {
    /// Returns an upper bound of the change of the geometric Jacobian in the enclosure. The change is
    /// measured by its Frobenius norm, with lengths divided by `reach` (m).
    ///
    /// Each column of the Jacobian refers to one actuator.
    pub fn jacobian_change(&self, chain: &Chain, task: &ToolTask, frames: &Frames, reach: f64) -> f64 {
        let posed = PosedChain::new(chain, task, frames);
        let mut half = self.coordinates;
        if posed.begins_with_rotation_of_arm() {
            half[0] = 0.0;
        }
        let square = |joint: usize| {
            let (moved, turned) = column_change(&posed, frames, joint, &half);
            (moved / reach).powi(2) + turned.powi(2)
        };
        let squares: f64 = (0..chain.axes()).map(square).sum();
        // The coupling multiplies the columns.
        let coupling = &chain.coupling;
        let is_coupled = (0..chain.axes()).any(|i| (0..i).any(|j| coupling[i][j] != 0.0));
        let factor = coupling.iter().flatten().map(|c| c * c).sum::<f64>().sqrt();
        squares.sqrt() * if is_coupled { factor } else { 1.0 }
    }
}

/// Returns upper bounds of the changes of one column of the Jacobian: of the motion of the TCP (m or 1), and
/// of the rotation. Every coordinate changes by at most its entry in `half`.
fn column_change(posed: &PosedChain<'_>, frames: &Frames, joint: usize, half: &Rows) -> (f64, f64) {
    let active = &posed.task.active[..posed.task.rows];
    let (mut moved, mut turned) = (0.0, 0.0);
    for (c, by) in half.iter().enumerate().take(active.len()) {
        let mut rates = (Vector3::zeros(), Vector3::zeros());
        for (k, &other) in active.iter().enumerate().filter(|(k, _)| posed.to_theta[*k][c] != 0.0) {
            let (motion, turn) = posed.column_rate(joint, other);
            rates.0 += motion * posed.to_theta[k][c];
            rates.1 += turn * posed.to_theta[k][c];
        }
        moved += by * rates.0.norm();
        turned += by * rates.1.norm();
    }
    let sum = |bits: u8| -> f64 {
        half.iter().enumerate().filter(|(c, _)| bits >> c & 1 == 1).map(|(_, by)| by).sum()
    };
    // Number of active joints before the joint, and up to the joint.
    let before = active.iter().filter(|other| **other < joint).count();
    let up_to = active.iter().filter(|other| **other <= joint).count();
    // The axis belongs to the links before and after its joint.
    let turning = |count: usize| count.checked_sub(1).map_or(0, |piece| posed.pieces[piece].turning);
    let own = turning(before) & turning(up_to);
    if !posed.turns(joint) {
        return (moved + sum(own).powi(2) / 2.0, 0.0);
    }
    let from = frames.links[joint].translation;
    let to = active.get(up_to).map_or(frames.tcp.translation, |next| frames.links[*next].translation);
    let first = up_to.checked_sub(1).map(|piece| ((to - from).norm(), piece));
    let whole = (up_to..active.len()).map(|piece| (posed.pieces[piece].length, piece));
    let second = |(length, piece): (f64, usize)| {
        let Piece { turning, slides, .. } = posed.pieces[piece];
        let (rho, slid) = (sum(own | turning), if slides { half[piece] } else { 0.0 });
        (length + slid) * rho * rho + 2.0 * rho * slid
    };
    moved += first.into_iter().chain(whole).map(second).sum::<f64>() / 2.0;
    (moved, turned + sum(own).powi(2) / 2.0)
}
