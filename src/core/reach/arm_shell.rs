//! Bounding shell of the reach: a cheap and safe test before any inverse kinematics.
//!
//! Row i of the D-H table moves its frame by the offset `r_i` along z_(i-1) and the length `l_i` along x_i. A
//! revolute joint i + 1 rotates about z_i, so the vector `l_i x_i + r_(i+1) z_i` has a constant length. Let n
//! be the number of joints, and let v be `l_n x_n` plus the vector from the last D-H frame to the TCP. If the
//! last of several joints is revolute, v also contains its offset `r_n z_(n-1)`. In this case,
//! the previous vector consists only of `l_(n-1) x_(n-1)`. The vector v has a constant length, too. The
//! position of the TCP is a fixed point of the first axis plus the sum of these vectors. The shell allows
//! arbitrary directions of these vectors. So the distance of the TCP from that point is at most the sum of
//! the lengths. The distance is at least the longest length minus the sum of the other lengths (polygon
//! inequality). If joint i + 1 is prismatic, r_(i+1) varies, so the vector has a range of lengths. Joint
//! limits and attitude only reduce the reach.
//!
//! Let the unit vector a be the tool axis. If the elevation e of this axis is fixed, the vertical component
//! of `(v . a) a` is known: `(v . a) sin(e)`. This component shifts the centre of the shell.

use super::inverse::Inverse;
use super::shell::Shell;
use crate::cell::{Attitude, JointKind};
use crate::robot::{Chain, Link};
use nalgebra::Vector3;

/// Length, m, by which the shell is enlarged on both sides. This length exceeds the tolerance of every solver
/// of the inverse kinematics.
const MARGIN: f64 = 1e-6;

impl Inverse {
    /// Returns a shell that contains every TCP position that the arm can reach in the attitude `attitude`.
    pub fn shell(&self, attitude: &Attitude) -> Shell {
        let chain = &self.chain;
        let known = self.fixed_elevation.or((attitude.tolerance == 0.0).then_some(attitude.elevation));
        let (up, tip) = tip(chain, known);
        let mut centre = chain.mount.translation + Vector3::z() * up;
        let mut lengths = vec![tip];
        for (i, link) in chain.links.iter().enumerate() {
            let (middle, travel) = offset(chain, i);
            let rigid = match i.checked_sub(1).map(|before| chain.links[before].l) {
                // No joint rotates the offset along the first axis.
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

/// Range of the length of a vector, m: from `rigid - travel` to `rigid + travel`.
struct LengthRange {
    rigid: f64,
    travel: f64,
}

/// Returns the axial offset of D-H row `i` in the middle of its travel, and half the travel, m.
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

/// Splits the vector v of the module documentation, which ends at the TCP, into a vertical component and a
/// remainder.
///
/// Returns the vertical component (m) and the range of the length of the remainder.
///
/// The vertical component follows from `elevation` (rad), the elevation of the tool axis. This component is 0
/// if `elevation` is None, or if the remainder could be as long as the whole vector.
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

/// Returns the sum of the common normal and the axial offset of the last D-H row, in the last frame, m.
///
/// The axial offset is along the joint axis, which is `(0, sin alpha, cos alpha)` in that frame. For a
/// prismatic joint or a chain of one joint, the axial offset is left out, because [`Inverse::shell`] adds it
/// separately.
fn along_last(chain: &Chain, link: &Link) -> Vector3<f64> {
    let r = if link.kind == JointKind::Revolute && chain.axes() > 1 { link.r } else { 0.0 };
    Vector3::new(link.l, r * link.sin_alpha, r * link.cos_alpha)
}
