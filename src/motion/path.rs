//! A straight move in joint coordinates, checked between samples too.
//!
//! A stretch of the move is free if in its middle every pair of solids is farther apart than they can
//! come nearer over half of it; otherwise it is halved (F. Schwarzer, M. Saha, J.-C. Latombe, "Adaptive
//! dynamic collision checking for single and multiple articulated robots in complex environments", IEEE
//! Transactions on Robotics 21, 2005). A point that joint i turns moves by at most
//!
//! ```text
//! |dtheta_i| (|l_i| + sum over the rows k after it of hypot(l_k, max |r_k|) + reach of the solid),
//! ```
//!
//! and by |dr_i| if it slides. The last row and the solid, which are rigid, are taken together. Two solids of the robot come nearer by the joints between them alone.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::clearance::{Hit, Load, Mover, Pair, Placed, Scene};
use crate::pose::Pose;
use crate::robot::Chain;

/// Solids that stay nearer than this, m, count as touching: smaller steps are not taken.
pub const RESOLUTION: f64 = 1e-4;

/// What a move touches first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathHit {
    /// Share of the move before it, 0 to 1.
    pub at: f64,
    pub hit: Hit,
}

/// The first contact of the robot on the straight move between two joint vectors (rad, m), with the
/// cell's clearance kept. None is proof that there is none; a contact may also be a passage nearer than
/// [`RESOLUTION`].
pub fn first_hit(
    chain: &Chain,
    scene: &Scene,
    placed: &Placed,
    (from, to): (&JointVector, &JointVector),
    load: Load,
) -> Option<PathHit> {
    if let Some(hit) = scene.base_hit(placed) {
        return Some(PathHit { at: 0.0, hit });
    }
    let movers = scene.movers();
    let speeds = Speeds::new(chain, from, to);
    let approached = |pair: Pair| {
        let first = pair.partner().map_or(0, |other| movers[other].frame);
        (pair, speeds.of(&movers[pair.mover], first))
    };
    let pairs: Vec<_> = scene.pairs(placed, load).into_iter().map(approached).collect();
    Walk { chain, scene, placed, from, to }.walk((0.0, 1.0), &pairs)
}

/// The joint vector at a share of a straight move.
pub(super) fn between(from: &JointVector, to: &JointVector, share: f64) -> JointVector {
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * share)
}

struct Walk<'w> {
    chain: &'w Chain,
    scene: &'w Scene,
    placed: &'w Placed,
    from: &'w JointVector,
    to: &'w JointVector,
}

impl Walk<'_> {
    fn frames(&self, share: f64) -> [Pose; MAX_JOINTS + 1] {
        let q = between(self.from, self.to, share);
        self.chain.frames(&self.chain.posture(&q)).links
    }

    /// The first contact between two shares. Pairs with how much nearer they come over the whole move, m:
    /// those that are apart over a stretch are apart over its halves.
    fn walk(&self, (low, high): (f64, f64), pairs: &[(Pair, f64)]) -> Option<PathHit> {
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let frames = self.frames(middle);
        let is_near =
            |(pair, speed): &&(Pair, f64)| !self.scene.is_apart(self.placed, &frames, *pair, speed * half);
        let near: Vec<_> = pairs.iter().filter(is_near).copied().collect();
        let (first, _) = near.first()?;
        let fastest = near.iter().map(|p| p.1).fold(0.0, f64::max);
        if fastest * half <= RESOLUTION {
            return Some(PathHit { at: middle, hit: self.scene.hit_of(self.placed, *first) });
        }
        self.walk((low, middle), &near).or_else(|| self.walk((middle, high), &near))
    }
}

/// How far the D-H coordinates go on a move, and how long the rows can be on it.
struct Speeds<'c> {
    chain: &'c Chain,
    /// rad or m.
    travel: JointVector,
    /// Axial offsets at both ends, m.
    offsets: [(f64, f64); MAX_JOINTS],
}

impl<'c> Speeds<'c> {
    fn new(chain: &'c Chain, from: &JointVector, to: &JointVector) -> Self {
        let (mut travel, mut offsets) = ([0.0; MAX_JOINTS], [(0.0, 0.0); MAX_JOINTS]);
        let (start, end) = (chain.posture(from), chain.posture(to));
        for i in 0..chain.axes() {
            let coupled = chain.coupling[i].iter().zip(from.iter().zip(to)).map(|(c, (a, b))| c * (b - a));
            travel[i] = coupled.sum::<f64>().abs();
            offsets[i] = (start.r[i], end.r[i]);
        }
        Self { chain, travel, offsets }
    }

    /// How far a point of a solid moves at most over the whole move, seen from frame `first`; m.
    fn of(&self, mover: &Mover, first: usize) -> f64 {
        let (mut sum, mut reach) = (0.0, 0.0);
        for i in (first..mover.frame).rev() {
            let link = &self.chain.links[i];
            // The farthest from the axis, and along it from the origin of the frame after the row.
            let (aside, along) = if i + 1 == mover.frame {
                let c = &mover.centre;
                let y = link.cos_alpha * c.y - link.sin_alpha * c.z;
                ((link.l + c.x).hypot(y), link.sin_alpha * c.y + link.cos_alpha * c.z)
            } else {
                (link.l.abs(), 0.0)
            };
            let slack = if i + 1 == mover.frame { mover.radius } else { reach };
            sum += self.travel[i]
                * match link.kind {
                    JointKind::Revolute => aside + slack,
                    JointKind::Prismatic => 1.0,
                };
            let (start, end) = self.offsets[i];
            reach = aside.hypot((along + start).abs().max((along + end).abs())) + slack;
        }
        sum
    }
}
