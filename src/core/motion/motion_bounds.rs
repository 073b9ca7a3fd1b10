//! Upper bounds of the displacements of the robot's solids along a path in joint coordinates.
//!
//! Over any part of a path, a revolute joint i displaces a point of a solid by at most
//!
//! ```text
//! |dtheta_i| (|l_i| + sum over the rows k after it of hypot(l_k, max |r_k|) + radius of the solid),
//! ```
//!
//! and a prismatic joint i by at most |dr_i|. Here dtheta_i and dr_i are the changes of the D-H
//! coordinates of joint i. The length and the offset of a D-H row are l and r. The link that
//! carries the solid has the last of these rows. In this row, the centre of the solid's bounding sphere
//! replaces the origin of the frame after the link (F. Schwarzer, M. Saha, J.-C. Latombe, IEEE Transactions
//! on Robotics 21, 2005).
//!
//! Around one posture of a straight move, a Taylor expansion gives a closer bound. The first-order term
//! contains the velocity of the point at that posture. Opposite rotations of joints cancel each other in this
//! velocity. The second-order term contains the second derivative of the position with respect to the share
//! of the move. This derivative is at most twice the product of the bound above and the sum of all
//! |dtheta_i|, both taken over the whole move.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::clearance::BoundingSphere;
use crate::pose::Pose;
use crate::robot::Chain;
use nalgebra::Vector3;

/// Upper bounds of the motion of points on the robot during a part of a path.
#[derive(Clone, Copy)]
pub struct MotionBounds<'c> {
    chain: &'c Chain,
    /// Change of each D-H coordinate on a straight move, or an upper bound of its absolute value, rad or m.
    travel: JointVector,
    /// Least and greatest axial offset r of each row during the motion, m.
    offsets: [(f64, f64); MAX_JOINTS],
}

impl<'c> MotionBounds<'c> {
    /// Returns the bounds of a straight move in joint coordinates.
    pub fn of_move(chain: &'c Chain, from: &JointVector, to: &JointVector) -> Self {
        let travel = changes(chain, from, to);
        Self { chain, travel, offsets: offsets(chain, [from, to]) }
    }

    /// Returns the bounds of the motion from a posture to all postures near it. `travel` is the largest change
    /// of each D-H coordinate, rad or m.
    pub fn around(chain: &'c Chain, joints: &JointVector, travel: JointVector) -> Self {
        let mut offsets = offsets(chain, [joints]);
        for ((range, by), link) in offsets.iter_mut().zip(travel).zip(&chain.links) {
            if link.kind == JointKind::Prismatic {
                *range = (range.0 - by, range.1 + by);
            }
        }
        Self { chain, travel, offsets }
    }

    /// Returns bounds of the motion along a path from its knot `middle` to either end. The bounds hold for
    /// both ends.
    pub fn from_middle(chain: &'c Chain, knots: &[JointVector], middle: usize) -> Self {
        let sum = |part: &[JointVector]| {
            let mut sum = [0.0; MAX_JOINTS];
            for ends in part.windows(2) {
                let change = changes(chain, &ends[0], &ends[1]);
                sum.iter_mut().zip(change).for_each(|(sum, by)| *sum += by.abs());
            }
            sum
        };
        let (before, after) = (sum(&knots[..=middle]), sum(&knots[middle..]));
        let travel = std::array::from_fn(|i| f64::max(before[i], after[i]));
        Self { chain, travel, offsets: offsets(chain, knots) }
    }

    /// Returns the bounds of the motion if each D-H coordinate deviates from the path by up to `travel`,
    /// rad or m.
    pub fn deviating_by(&self, travel: JointVector) -> Self {
        Self { travel, ..*self }
    }

    /// Returns an upper bound of the displacement of the points in a sphere relative to frame `first`, m.
    pub fn displacement(&self, sphere: &BoundingSphere, first: usize) -> f64 {
        let (mut sum, mut reach) = (0.0, 0.0);
        for i in (first..sphere.frame).rev() {
            let link = &self.chain.links[i];
            // The lever arm ends at the centre of the sphere, or at the origin of the next frame. `aside`
            // is the distance of this end from the joint axis, and `along` is the coordinate of the end
            // along this axis, without r.
            let (aside, along) = if i + 1 == sphere.frame {
                let c = &sphere.centre;
                let y = link.cos_alpha * c.y - link.sin_alpha * c.z;
                ((link.l + c.x).hypot(y), link.sin_alpha * c.y + link.cos_alpha * c.z)
            } else {
                (link.l.abs(), 0.0)
            };
            let slack = if i + 1 == sphere.frame { sphere.radius } else { reach };
            sum += self.travel[i].abs()
                * match link.kind {
                    JointKind::Revolute => aside + slack,
                    JointKind::Prismatic => 1.0,
                };
            let (least, greatest) = self.offsets[i];
            reach = aside.hypot((along + least).abs().max((along + greatest).abs())) + slack;
        }
        sum
    }

    /// Returns an upper bound of the displacement of the points in a sphere relative to frame `first`, m.
    /// The bound holds on either side of one posture of a straight move.
    ///
    /// `frames` are the link frames of the posture, and `half` is the share of the move on either side.
    /// `whole` is the [`Self::displacement`] of the whole move.
    pub fn displacement_around(
        &self,
        frames: &[Pose; MAX_JOINTS + 1],
        sphere: &BoundingSphere,
        first: usize,
        half: f64,
        whole: f64,
    ) -> f64 {
        let centre = frames[sphere.frame].transform(&sphere.centre);
        let (mut velocity, mut rotation, mut turned) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        let joints = frames.iter().zip(&self.travel).zip(&self.chain.links);
        for ((frame, travel), link) in joints.take(sphere.frame).skip(first) {
            let by: Vector3<f64> = frame.rotation.column(2) * *travel;
            match link.kind {
                JointKind::Revolute => {
                    velocity += by.cross(&(centre - frame.translation));
                    rotation += by;
                    turned += travel.abs();
                }
                JointKind::Prismatic => velocity += by,
            }
        }
        let speed = velocity.norm() + rotation.norm() * sphere.radius;
        half * whole.min(speed + half * turned * whole)
    }
}

/// Returns the change of each D-H coordinate on a move in joint coordinates, rad or m.
fn changes(chain: &Chain, from: &JointVector, to: &JointVector) -> JointVector {
    let mut changes = [0.0; MAX_JOINTS];
    for (change, row) in changes.iter_mut().zip(&chain.coupling).take(chain.axes()) {
        *change = row.iter().zip(from.iter().zip(to)).map(|(c, (a, b))| c * (b - a)).sum();
    }
    changes
}

/// Returns the least and the greatest axial offset r of each row over the knots of a path, m.
fn offsets<'k>(chain: &Chain, knots: impl IntoIterator<Item = &'k JointVector>) -> [(f64, f64); MAX_JOINTS] {
    let mut offsets = [(f64::INFINITY, f64::NEG_INFINITY); MAX_JOINTS];
    for q in knots {
        for (i, range) in offsets.iter_mut().enumerate().take(chain.axes()) {
            let r = chain.offset(i, q);
            *range = (range.0.min(r), range.1.max(r));
        }
    }
    offsets
}
