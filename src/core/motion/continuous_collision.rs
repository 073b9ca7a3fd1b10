//! Continuous collision checking of a path of straight moves in joint coordinates.
//!
//! The distance between any two solids is computed in the middle of an interval of the path. The interval is
//! collision-free if the distance of every pair of solids exceeds the required clearance by a margin. This
//! margin is the amount by which the two solids can approach each other within half the interval. Otherwise
//! the interval is halved (F. Schwarzer, M. Saha, J.-C. Latombe, "Adaptive dynamic collision checking for
//! single and multiple articulated robots in complex environments", IEEE Transactions on Robotics 21, 2005).
//! The first interval is the whole path. Most pairs of solids are so far apart that this interval suffices.
//! Only the joints between two solids of the robot change the distance between these solids.

use super::motion_bounds::MotionBounds;
use crate::cell::{JointVector, MAX_JOINTS};
use crate::clearance::{Hit, LinkBounds, Load, Pair, PlacedSolids, Scene};
use crate::pose::Pose;
use crate::robot::Chain;

/// Resolution of the collision check, m. Solids whose distance exceeds the clearance by less than this
/// value may count as touching.
pub const RESOLUTION: f64 = 1e-4;

/// First contact on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathHit {
    /// Share of the path that is completed at the contact, from 0 to 1. Each move counts as an equal share of
    /// the path, whatever the length of the move.
    pub at: f64,
    pub hit: Hit,
}

/// Upper bounds of the deviations from a path. The robot deviates from the joint coordinates of the path, and
/// the equipment deviates from its placement.
#[derive(Default)]
pub struct PathSlack<'a> {
    /// Largest deviation of each D-H coordinate at each knot (joint vector) of the path, rad or m. The list
    /// is empty if the robot does not deviate from the path.
    ///
    /// The deviation during a move is at most the larger of the deviations at the two ends of the move.
    pub joints: &'a [JointVector],
    /// Function that returns the largest motion, m, of equipment, fence or floor relative to the robot base.
    ///
    /// The argument is the index of the equipment. The index after the last piece of equipment denotes the
    /// fence, and None denotes the floor. If there is no such function, equipment, fence and floor do not
    /// move.
    pub equipment: Option<&'a dyn Fn(Option<usize>) -> f64>,
    /// Function that returns an upper bound, m, of the decrease of the distance between two solids. The
    /// decrease comes from the deviations of robot and equipment.
    ///
    /// The first argument is a robot solid (an index into [`Scene::bounding_spheres`]). The second argument
    /// is equipment or fence (an index as in [`Self::equipment`]). The check uses the smaller of two values:
    /// this bound, and the sum of the deviations of the two solids. If the function returns None, the check
    /// uses the sum.
    pub between: Option<&'a dyn Fn(usize, usize) -> Option<f64>>,
}

/// Returns the first point of a path at which a solid of the robot may come too near to another solid.
///
/// The robot may deviate from the path, and equipment may deviate from its placement. `slack` holds the
/// upper bounds of these deviations.
///
/// The distance of the robot from equipment, fence and floor must be at least the clearance of the cell. Two
/// solids of the robot must not touch, but need no clearance.
///
/// The path consists of straight moves between the joint vectors in `knots`, rad or m. A path without a move
/// is not checked, and the result is None. For any other path, None proves that no pair of
/// [`Scene::each_pair`] comes too near. The check of the robot base ([`Scene::base_hit`]) ignores `slack`. A
/// reported contact may also be a near miss that the check does not resolve ([`RESOLUTION`]).
pub fn first_hit(
    chain: &Chain,
    scene: &Scene,
    placed: &PlacedSolids,
    knots: &[JointVector],
    load: Load,
    slack: &PathSlack<'_>,
) -> Option<PathHit> {
    let last = knots.len().checked_sub(1).filter(|moves| *moves > 0)?;
    if let Some(hit) = scene.base_hit(placed) {
        return Some(PathHit { at: 0.0, hit });
    }
    let mut pairs = Vec::new();
    scene.each_pair(placed, load, |pair| pairs.push(NumberedPair { number: pairs.len(), pair }));
    PathQuery { chain, scene, placed, knots, slack }.first_hit_between(0, last, &mut pairs)
}

/// Pair of solids, and the index of the pair among all pairs of the path.
#[derive(Clone, Copy)]
struct NumberedPair {
    number: usize,
    pair: Pair,
}

/// Pair of solids, with the largest possible decrease of their distance.
#[derive(Clone, Copy)]
struct ApproachingPair {
    number: usize,
    pair: Pair,
    /// Upper bound of the displacement of the first solid relative to the second without deviations, m. The
    /// displacement is that of the whole move, or of the path from its middle knot to either end.
    by: f64,
    /// Upper bound of the decrease of the distance that the deviations in [`PathSlack`] cause, m.
    slack: f64,
}

/// Returns the joint vector at the share `share` (0 to 1) of a straight move.
pub(super) fn between(from: &JointVector, to: &JointVector, share: f64) -> JointVector {
    std::array::from_fn(|i| from[i] + (to[i] - from[i]) * share)
}

/// Collision check of one path.
struct PathQuery<'w> {
    chain: &'w Chain,
    scene: &'w Scene,
    placed: &'w PlacedSolids,
    knots: &'w [JointVector],
    slack: &'w PathSlack<'w>,
}

impl<'w> PathQuery<'w> {
    fn frames(&self, q: &JointVector) -> [Pose; MAX_JOINTS + 1] {
        self.chain.frames(&self.chain.posture(q)).links
    }

    /// Returns the first contact between two knots; None if the moves between them are collision-free.
    ///
    /// Pairs that certainly remain apart between the two knots are not checked on the individual moves. The
    /// function moves the other pairs to the front of `pairs`.
    fn first_hit_between(&self, first: usize, last: usize, pairs: &mut [NumberedPair]) -> Option<PathHit> {
        let knots = &self.knots[first..=last];
        if last - first == 1 {
            let bounds = MotionBounds::of_move(self.chain, &knots[0], &knots[1]);
            let mut pairs = self.approaching(&bounds, first, last, pairs);
            return self.first_hit_in(first, &bounds, (0.0, 1.0), &mut pairs);
        }
        let middle = (last - first) / 2;
        let bounds = MotionBounds::from_middle(self.chain, knots, middle);
        let frames = self.frames(&knots[middle]);
        let (mut count, mut memory) = (0, LinkBounds::default());
        for (k, ApproachingPair { pair, by, slack, .. }) in
            self.approaching(&bounds, first, last, pairs).into_iter().enumerate()
        {
            if !self.scene.is_apart(self.placed, &frames, &mut memory, pair, by + slack) {
                pairs.swap(count, k);
                count += 1;
            }
        }
        let near = &mut pairs[..count];
        if near.is_empty() {
            return None;
        }
        let middle = first + middle;
        self.first_hit_between(first, middle, near).or_else(|| self.first_hit_between(middle, last, near))
    }

    /// Returns the pairs, each with the amount by which its distance can decrease between two knots.
    fn approaching(
        &self,
        bounds: &MotionBounds<'_>,
        first: usize,
        last: usize,
        pairs: &[NumberedPair],
    ) -> Vec<ApproachingPair> {
        let spheres = self.scene.bounding_spheres();
        let deviations = self.slack.joints.get(first..=last).unwrap_or_default();
        let deviation = bounds
            .deviating_by(std::array::from_fn(|i| deviations.iter().map(|by| by[i]).fold(0.0, f64::max)));
        let displacements = |link: usize, first| {
            let of_deviation = match deviations {
                [] => 0.0,
                _ => deviation.displacement(&spheres[link], first),
            };
            (bounds.displacement(&spheres[link], first), of_deviation)
        };
        let mut known = None;
        let approached = |&NumberedPair { number, pair }: &NumberedPair| {
            let equipment = self.scene.equipment_of(self.placed, pair);
            let moved = match (pair.partner(), self.slack.equipment) {
                (None, Some(motion)) => motion(equipment),
                _ => 0.0,
            };
            let of = (pair.link, first_frame(self.scene, pair));
            // Successive pairs often have a solid of the robot in common.
            let (by, deviating) = match known {
                Some((same, by)) if same == of => by,
                _ => displacements(of.0, of.1),
            };
            known = Some((of, (by, deviating)));
            let apart = deviating + moved;
            let known = self.slack.between.zip(equipment);
            let slack =
                known.and_then(|(between, k)| between(pair.link, k)).map_or(apart, |by| by.min(apart));
            ApproachingPair { number, pair, by, slack }
        };
        pairs.iter().map(approached).collect()
    }

    /// Returns the first contact in one interval of the move from the knot `first`; None if the interval is
    /// collision-free.
    ///
    /// The ends of the interval are shares of the move: 0 is its start, and 1 is its end. Pairs that remain
    /// apart in an interval are not checked again in the halves of that interval. The function moves the
    /// other pairs to the front of `pairs`.
    fn first_hit_in(
        &self,
        first: usize,
        bounds: &MotionBounds<'_>,
        (low, high): (f64, f64),
        pairs: &mut [ApproachingPair],
    ) -> Option<PathHit> {
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let frames = self.frames(&between(&self.knots[first], &self.knots[first + 1], middle));
        let spheres = self.scene.bounding_spheres();
        let (mut count, mut fastest, mut memory) = (0, 0.0, LinkBounds::default());
        let mut known = None;
        for k in 0..pairs.len() {
            let ApproachingPair { pair, by, slack, .. } = pairs[k];
            let of = (pair.link, first_frame(self.scene, pair));
            // Successive pairs often have a solid of the robot in common.
            let by = match known {
                Some((same, by)) if same == of => by,
                _ => bounds.displacement_around(&frames, &spheres[of.0], of.1, half, by),
            };
            known = Some((of, by));
            if !self.scene.is_apart(self.placed, &frames, &mut memory, pair, by + slack) {
                pairs.swap(count, k);
                count += 1;
                fastest = f64::max(fastest, by);
            }
        }
        let near = &mut pairs[..count];
        let nearest = near.iter().min_by_key(|p| p.number)?.pair;
        if fastest <= RESOLUTION {
            let at = (first as f64 + middle) / (self.knots.len() - 1) as f64;
            return Some(PathHit { at, hit: self.scene.hit_of(self.placed, nearest) });
        }
        self.first_hit_in(first, bounds, (low, middle), near)
            .or_else(|| self.first_hit_in(first, bounds, (middle, high), near))
    }
}

/// Returns the index of the frame that carries the second solid of a pair; 0 for equipment, fence and
/// floor.
fn first_frame(scene: &Scene, pair: Pair) -> usize {
    pair.partner().map_or(0, |other| scene.bounding_spheres()[other].frame)
}
