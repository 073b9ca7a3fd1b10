//! Bounding shell of the reach: a cheap and safe test before any inverse kinematics.
//!
//! Every D-H row moves its frame by `r_i` along z_(i-1) and `l_i` along x_i. Joint i + 1 rotates about z_i,
//! so that `l_i x_i + r_(i+1) z_i` is rigid. The last row with the tool is a rigid vector v, too. The TCP is
//! a fixed point of the first axis plus vectors of these lengths in any direction. The distance of the TCP
//! from that point is at most the sum of the lengths. It is at least the longest length minus the others
//! (polygon inequality). Joint limits and attitude only reduce the reach. A fixed elevation e of the tool
//! axis a makes the vertical part `(v . a) sin(e)` of v known, which shifts the centre.

use super::Inverse;
use crate::cell::{Attitude, JointKind};
use crate::robot::{Chain, Link};
use nalgebra::Vector3;

/// Margin, m, above the tolerances of every inverse kinematics.
const MARGIN: f64 = 1e-6;

/// Spherical shell that contains every reachable TCP, base frame, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    pub centre: Vector3<f64>,
    pub inner: f64,
    pub outer: f64,
}

impl Shell {
    /// Returns a lower bound of the distance, m, between a set of points and the reachable points.
    ///
    /// The points of the set are at distances from `near` to `far` (m) from the centre of the shell. The
    /// bound is 0 if some of them may be reachable.
    pub fn gap(&self, near: f64, far: f64) -> f64 {
        (near - self.outer).max(self.inner - far).max(0.0)
    }
}

impl Inverse {
    /// Returns the shell outside which the arm cannot hold its TCP in an attitude.
    pub fn shell(&self, attitude: &Attitude) -> Shell {
        let chain = &self.chain;
        let known = self.fixed_elevation.or((attitude.tolerance == 0.0).then_some(attitude.elevation));
        let (up, tip) = tip(chain, known);
        let mut centre = chain.mount.translation + Vector3::z() * up;
        let mut lengths = vec![tip];
        for (i, link) in chain.links.iter().enumerate() {
            let (middle, travel) = offset(chain, i);
            let rigid = match i.checked_sub(1).map(|before| chain.links[before].l) {
                // Nothing rotates the offset along the first axis.
                None => {
                    centre += chain.mount.rotation.column(2) * middle;
                    0.0
                }
                Some(l) if i + 1 == chain.axes() && link.kind == JointKind::Revolute => l.abs(),
                Some(l) => l.hypot(middle),
            };
            lengths.push(LengthRange { rigid, travel });
        }
        let outer: f64 = lengths.iter().map(|l| l.rigid + l.travel).sum();
        let inner = lengths.iter().map(|l| 2.0 * l.rigid - outer).fold(0.0, f64::max);
        Shell { centre, inner: inner - MARGIN, outer: outer + MARGIN }
    }
}

/// Range of the length of a vector: from `rigid - travel` to `rigid + travel`, m.
struct LengthRange {
    rigid: f64,
    travel: f64,
}

/// Returns the axial offset of a row in the middle of its travel, and half the travel, m.
fn offset(chain: &Chain, i: usize) -> (f64, f64) {
    let link = &chain.links[i];
    let (mut middle, mut half) = (link.r, 0.0);
    if link.kind == JointKind::Prismatic {
        for (factor, other) in chain.coupling[i].iter().zip(&chain.links) {
            middle += factor * (other.limits.0 + other.limits.1) / 2.0;
            half += (factor * (other.limits.1 - other.limits.0) / 2.0).abs();
        }
    }
    (middle, half)
}

/// Returns the known vertical part, m, of the vector from the last but one frame to the TCP, and the
/// length of the rest.
fn tip(chain: &Chain, elevation: Option<f64>) -> (f64, LengthRange) {
    let row = chain.links.last().map_or_else(Vector3::zeros, |link| along_last(chain, link));
    let v = row + chain.tool.translation;
    let axis = chain.tool.rotation * chain.tool_axis;
    let (along, whole) = (v.dot(&axis), v.norm());
    if let Some(elevation) = elevation {
        let (level, aside) = ((along * elevation.cos()).abs(), (v - axis * along).norm());
        if level + aside < whole {
            let rest = LengthRange { rigid: level.max(aside), travel: level.min(aside) };
            return (along * elevation.sin(), rest);
        }
    }
    (0.0, LengthRange { rigid: whole, travel: 0.0 })
}

/// Returns common normal and offset of the last row in the last frame, where z_(n-1) is `(0, sin alpha, cos
/// alpha)`.
///
/// The offset of a first or prismatic row is 0 here, because [`offset`] returns it.
fn along_last(chain: &Chain, link: &Link) -> Vector3<f64> {
    let r = if link.kind == JointKind::Revolute && chain.axes() > 1 { link.r } else { 0.0 };
    Vector3::new(link.l, r * link.sin_alpha, r * link.cos_alpha)
}
