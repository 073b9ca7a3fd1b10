//! Continuous collision checking of a straight move in joint coordinates.
//!
//! The distance of every pair of solids is computed in the middle of an interval of the move. The interval is
//! free if every distance exceeds the required clearance by more than the pair can approach within half the
//! interval. Otherwise the interval is halved (F. Schwarzer, M. Saha, J.-C. Latombe, "Adaptive dynamic
//! collision checking for single and multiple articulated robots in complex environments", IEEE Transactions
//! on Robotics 21, 2005). A point that joint i rotates moves by at most
//!
//! ```text
//! |dtheta_i| (|l_i| + sum over the rows k after it of hypot(l_k, max |r_k|) + radius of the solid),
//! ```
//!
//! and by |dr_i| if joint i is prismatic. Here dtheta_i and dr_i are the changes of the D-H coordinates of
//! joint i, and l and r the length and offset of a D-H row. The lever arm of the last row ends at the centre
//! of the solid's bounding sphere. Only the joints between two solids of the robot change the distance of
//! these solids.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::clearance::{BoundingSphere, Hit, Load, Pair, PlacedSolids, Scene};
use crate::pose::Pose;
use crate::robot::Chain;

/// Resolution of the collision check, m: solids whose distance exceeds the clearance by less than this value
/// may count as touching.
pub const RESOLUTION: f64 = 1e-4;

/// First contact on a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathHit {
    /// Share of the move that is completed at the contact, 0 to 1.
    pub at: f64,
    pub hit: Hit,
}

/// Straight move in joint coordinates, rad or m.
#[derive(Debug, Clone, Copy)]
pub struct Move<'a> {
    pub from: &'a JointVector,
    pub to: &'a JointVector,
}

/// Returns the first point of a straight move at which the robot comes nearer than the clearance of the cell.
///
/// The result None proves that there is no contact. A reported contact may also be a near miss: solids that
/// pass each other within [`RESOLUTION`] of the clearance.
pub fn first_hit(
    chain: &Chain,
    scene: &Scene,
    placed: &PlacedSolids,
    line: Move<'_>,
    load: Load,
) -> Option<PathHit> {
    first_hit_with(chain, scene, placed, line, load, &PathSlack::default())
}

/// Deviations from a move: of the robot from its joint coordinates, and of the equipment from its placement.
#[derive(Default)]
pub struct PathSlack<'a> {
    /// Largest deviation of each D-H coordinate, rad or m.
    pub joints: JointVector,
    /// Motion of each piece of equipment relative to the robot base, m; None for the floor. Without this
    /// function, the equipment does not move.
    pub equipment: Option<&'a dyn Fn(Option<usize>) -> f64>,
    /// Upper bound, m, of the decrease of the distance between a robot solid (an index into
    /// [`Scene::bounding_spheres`]) and a piece of equipment. The function returns None if the bound is not less than
    /// the sum of both deviations.
    pub between: Option<&'a dyn Fn(usize, usize) -> Option<f64>>,
}

/// Returns the first point of a straight move at which the robot may come nearer than the clearance of the cell,
/// if robot and equipment deviate from the move by up to `slack`.
pub fn first_hit_with(
    chain: &Chain,
    scene: &Scene,
    placed: &PlacedSolids,
    line: Move<'_>,
    load: Load,
    slack: &PathSlack<'_>,
) -> Option<PathHit> {
    if let Some(hit) = scene.base_hit(placed) {
        return Some(PathHit { at: 0.0, hit });
    }
    let spheres = scene.bounding_spheres();
    let bounds = MotionBounds::new(chain, line);
    let deviation = MotionBounds { travel: slack.joints, ..bounds };
    let displacements = |sphere: &BoundingSphere, first| {
        (bounds.displacement(sphere, first), deviation.displacement(sphere, first))
    };
    // Most pairs are with equipment, so the displacement of a solid relative to the base is computed once.
    let from_base: Vec<_> = spheres.iter().map(|sphere| displacements(sphere, 0)).collect();
    let approached = |number: usize, pair: Pair| {
        let moved = match (pair.partner(), slack.equipment) {
            (None, Some(equipment)) => equipment(scene.equipment_of(placed, pair)),
            _ => 0.0,
        };
        let (by, deviating) = match pair.partner().map_or(0, |other| spheres[other].frame) {
            0 => from_base[pair.link],
            first => displacements(&spheres[pair.link], first),
        };
        let apart = deviating + moved;
        let known = slack.between.zip(scene.equipment_of(placed, pair));
        let slack = known.and_then(|(between, k)| between(pair.link, k)).map_or(apart, |by| by.min(apart));
        ApproachingPair { number, pair, by, slack }
    };
    let pairs = scene.pairs(placed, load).into_iter().enumerate();
    let mut pairs: Vec<_> = pairs.map(|(number, pair)| approached(number, pair)).collect();
    MoveCheck { chain, scene, placed, line }.first_hit_in(0.0, 1.0, &mut pairs)
}

/// Pair of solids, and how much their distance can decrease.
#[derive(Clone, Copy)]
struct ApproachingPair {
    /// Number of the pair among all pairs of the move.
    number: usize,
    pair: Pair,
    /// Greatest possible decrease of the distance over the whole move, m.
    by: f64,
    /// Greatest possible decrease because of deviations from the move, m.
    slack: f64,
}

/// Returns the joint vector at a share of a straight move.
pub(super) fn between(from: &JointVector, to: &JointVector, share: f64) -> JointVector {
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * share)
}

/// Collision check of one move.
struct MoveCheck<'w> {
    chain: &'w Chain,
    scene: &'w Scene,
    placed: &'w PlacedSolids,
    line: Move<'w>,
}

impl MoveCheck<'_> {
    fn frames(&self, share: f64) -> [Pose; MAX_JOINTS + 1] {
        let q = between(self.line.from, self.line.to, share);
        self.chain.frames(&self.chain.posture(&q)).links
    }

    /// Returns the first contact in one interval of the move; None if the interval is free.
    ///
    /// `low` and `high` are the ends of the interval, as shares of the move: 0 is its start, 1 its end.
    /// Pairs that stay apart in an interval are not checked again in the halves of that interval. The function moves
    /// the other pairs to the front of `pairs`.
    fn first_hit_in(&self, low: f64, high: f64, pairs: &mut [ApproachingPair]) -> Option<PathHit> {
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let frames = self.frames(middle);
        let mut count = 0;
        for k in 0..pairs.len() {
            let ApproachingPair { pair, by, slack, .. } = pairs[k];
            if !self.scene.is_apart(self.placed, &frames, pair, by * half + slack) {
                pairs.swap(count, k);
                count += 1;
            }
        }
        let near = &mut pairs[..count];
        let first = near.iter().min_by_key(|p| p.number)?.pair;
        let fastest = near.iter().map(|p| p.by).fold(0.0, f64::max);
        if fastest * half <= RESOLUTION {
            return Some(PathHit { at: middle, hit: self.scene.hit_of(self.placed, first) });
        }
        self.first_hit_in(low, middle, near).or_else(|| self.first_hit_in(middle, high, near))
    }
}

/// Upper bounds of the motion of points on the robot during one move.
#[derive(Clone, Copy)]
struct MotionBounds<'c> {
    chain: &'c Chain,
    /// Travel of each D-H coordinate, rad or m.
    travel: JointVector,
    /// Axial offset r of each row at the start and at the end of the move, m.
    offsets: [(f64, f64); MAX_JOINTS],
}

impl<'c> MotionBounds<'c> {
    fn new(chain: &'c Chain, Move { from, to }: Move<'_>) -> Self {
        let (mut travel, mut offsets) = ([0.0; MAX_JOINTS], [(0.0, 0.0); MAX_JOINTS]);
        let (start, end) = (chain.posture(from), chain.posture(to));
        for i in 0..chain.axes() {
            let coupled = chain.coupling[i].iter().zip(from.iter().zip(to)).map(|(c, (a, b))| c * (b - a));
            travel[i] = coupled.sum::<f64>().abs();
            offsets[i] = (start.r[i], end.r[i]);
        }
        Self { chain, travel, offsets }
    }

    /// Returns an upper bound of the displacement, relative to frame `first`, of the points in a sphere, m.
    fn displacement(&self, sphere: &BoundingSphere, first: usize) -> f64 {
        let (mut sum, mut reach) = (0.0, 0.0);
        for i in (first..sphere.frame).rev() {
            let link = &self.chain.links[i];
            // The lever arm ends at the centre of the sphere, or at the origin of the next frame. `aside` is
            // the distance of its end from the joint axis, and `along` is its coordinate along this axis
            // without r.
            let (aside, along) = if i + 1 == sphere.frame {
                let c = &sphere.centre;
                let y = link.cos_alpha * c.y - link.sin_alpha * c.z;
                ((link.l + c.x).hypot(y), link.sin_alpha * c.y + link.cos_alpha * c.z)
            } else {
                (link.l.abs(), 0.0)
            };
            let slack = if i + 1 == sphere.frame { sphere.radius } else { reach };
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
