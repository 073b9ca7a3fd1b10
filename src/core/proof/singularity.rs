//! Boxes of joint coordinates in which every posture is nearer to a singularity than the margin of the cell.
//!
//! The measure of this distance is the least singular value of the Jacobian. If the Jacobian changes, each
//! singular value changes by at most the spectral norm of the change (H. Weyl 1912). The Frobenius norm bounds
//! the spectral norm. It follows from bounds of the change of every column in the box.
//!
//! A rotation or a displacement of the whole arm does not change the singular values. A rotation of the tool
//! about the last axis does not change them either, if the TCP lies on this axis. So these two joints need no
//! coordinate.

use super::coordinates::Coordinates;
use super::taylor_model::{RigidPieces, radius};
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::kinematic_error::{JointValues, Screws};
use crate::layout::Workcell;
use crate::motion::Guard;

/// Largest distance of the TCP from the last axis, m, at which the TCP counts as a point of this axis.
const ON_AXIS: f64 = 1e-9;

/// Check of boxes and postures for the singularity margin of the cell.
pub(super) struct SingularityCheck<'a> {
    /// Motion rules with the margin; None if no posture is excluded.
    guard: Option<&'a Guard>,
}

impl<'a> SingularityCheck<'a> {
    /// Prepares the check. Joints marked in `held` have no coordinate in the boxes.
    pub fn new(workcell: &'a Workcell, screws: &Screws, held: &[bool; MAX_JOINTS]) -> Self {
        let last = screws.kinds.len() - 1;
        let from_axis = (screws.tip - screws.points[last]).cross(&screws.axes[last]).norm();
        let is_on_axis = screws.kinds[last] == JointKind::Revolute && from_axis < ON_AXIS;
        let is_known = !(1..last).any(|joint| held[joint]) && (!held[last] || is_on_axis);
        Self { guard: workcell.guard().filter(|_| is_known) }
    }

    /// Returns whether every posture in a box is nearer to a singularity than the margin. `joints` are the
    /// actuator coordinates in the centre of the box, rad or m. The box has the half widths `radii`, and
    /// `to_tip` leads from joint axis to joint axis, and from the last axis to the TCP.
    pub fn surrounds(
        &self,
        joints: &JointVector,
        radii: &JointValues,
        (screws, coordinates, to_tip): (&Screws, &Coordinates, &RigidPieces),
    ) -> bool {
        // Returns an upper bound of the Frobenius norm of the change in the Jacobian, whose lengths are
        // divided by `reach`.
        let change = |reach: f64| {
            let column = |(joint, kind): (usize, &JointKind)| {
                // An axis belongs to the links before and after its joint.
                let own = coordinates.turning[joint] & coordinates.turning[joint + 1];
                let turned = radius(radii, own);
                match kind {
                    JointKind::Revolute => {
                        turned.hypot(to_tip.turned(coordinates, radii, joint, own, 1) / reach)
                    }
                    JointKind::Prismatic => turned / reach,
                }
            };
            let columns = screws.kinds.iter().enumerate().map(column);
            columns.map(|change| change * change).sum::<f64>().sqrt()
        };
        self.guard.is_some_and(|guard| guard.is_nearly_singular(joints, change))
    }
}
