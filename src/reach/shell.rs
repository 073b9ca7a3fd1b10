//! A spherical shell that holds every TCP an arm can reach: a cheap and safe test before any inverse
//! kinematics.
//!
//! Every D-H row moves its frame by `r_i` along z_(i-1) and `l_i` along x_i. Joint i + 1 turns about
//! z_i, so that `l_i x_i + r_(i+1) z_i` is rigid; the last row with the tool is a rigid vector v, too.
//! The TCP is a fixed point of the first axis plus vectors of these lengths in any direction: it lies
//! at most their sum away, and at least the longest less the others (polygon inequality). Joint limits
//! and attitude only take away. Where the elevation e of the tool axis a is fixed, the vertical part
//! `(v . a) sin(e)` of v is known and shifts the centre.

use super::Inverse;
use crate::cell::{Attitude, JointKind};
use crate::robot::{Chain, Link};
use nalgebra::Vector3;

/// Above the tolerances of every inverse kinematics, m.
const ROUNDING: f64 = 1e-6;

/// In the base frame, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shell {
    pub centre: Vector3<f64>,
    pub inner: f64,
    pub outer: f64,
}

impl Shell {
    /// How far points at distances from `near` to `far` of the centre are at least from all that can be
    /// reached, m; 0 if some of them may be reached.
    pub fn gap(&self, (near, far): (f64, f64)) -> f64 {
        (near - self.outer).max(self.inner - far).max(0.0)
    }
}

impl Inverse {
    /// The shell outside which the TCP cannot be held in this attitude.
    pub fn shell(&self, attitude: &Attitude) -> Shell {
        let chain = &self.chain;
        let known = self.kept.or((attitude.tolerance == 0.0).then_some(attitude.elevation));
        let (up, tip) = tip(chain, known);
        let mut centre = chain.mount.translation + Vector3::z() * up;
        let mut lengths = vec![tip];
        for (i, link) in chain.links.iter().enumerate() {
            let (middle, travel) = offset(chain, i);
            let rigid = match i.checked_sub(1).map(|before| chain.links[before].l) {
                // Along the first axis nothing turns the offset.
                None => {
                    centre += chain.mount.rotation.column(2) * middle;
                    0.0
                }
                Some(l) if i + 1 == chain.axes() && link.kind == JointKind::Revolute => l.abs(),
                Some(l) => l.hypot(middle),
            };
            lengths.push(Length { rigid, travel });
        }
        let outer: f64 = lengths.iter().map(|l| l.rigid + l.travel).sum();
        let inner = lengths.iter().map(|l| 2.0 * l.rigid - outer).fold(0.0, f64::max);
        Shell { centre, inner: inner - ROUNDING, outer: outer + ROUNDING }
    }
}

/// Of a vector: from `rigid - travel` to `rigid + travel`, m.
struct Length {
    rigid: f64,
    travel: f64,
}

/// Axial offset of a row in the middle of its travel, and half the travel, m.
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

/// The rigid vector from the last frame but one to the TCP: its known vertical part, and the length of
/// the rest.
fn tip(chain: &Chain, elevation: Option<f64>) -> (f64, Length) {
    let row = chain.links.last().map_or_else(Vector3::zeros, |link| along_last(chain, link));
    let v = row + chain.tool.translation;
    let axis = chain.tool.rotation * chain.tool_axis;
    let (along, whole) = (v.dot(&axis), v.norm());
    if let Some(elevation) = elevation {
        let (level, aside) = ((along * elevation.cos()).abs(), (v - axis * along).norm());
        if level + aside < whole {
            let rest = Length { rigid: level.max(aside), travel: level.min(aside) };
            return (along * elevation.sin(), rest);
        }
    }
    (0.0, Length { rigid: whole, travel: 0.0 })
}

/// Common normal and offset of the last row in the last frame: z_(n-1) is `(0, sin alpha, cos alpha)`
/// there. The offset of a first or sliding row is counted elsewhere.
fn along_last(chain: &Chain, link: &Link) -> Vector3<f64> {
    let r = if link.kind == JointKind::Revolute && chain.axes() > 1 { link.r } else { 0.0 };
    Vector3::new(link.l, r * link.sin_alpha, r * link.cos_alpha)
}
