//! Check that all solids keep their clearance while robot and equipment move a little.

use super::bounding_capsule::overlapping;
use super::contact::Hit;
use super::distance::LinkBounds;
use super::pairs::{Against, Load, Pair};
use super::placed_solids::{LinkFrames, LinkPoses, PlacedSolids};
use super::robot_solids::RobotSolid;
use super::scene::Scene;
use nalgebra::Vector3;

/// Upper bounds, m, of the motion of solids from their nominal poses, relative to the robot base.
///
/// A robot solid is given by its index in [`Scene::bounding_spheres`]. For equipment, the index after the
/// last piece denotes fence and keep-out boxes, and None denotes the floor.
pub trait SolidMotion {
    /// Returns the bound for a robot solid.
    fn of_link(&self, link: usize) -> f64;

    /// Returns the bound for a piece of equipment.
    fn of_equipment(&self, equipment: Option<usize>) -> f64;

    /// Returns the bound for the relative motion of a robot solid and a piece of equipment. Returns None if
    /// only the sum of the two separate bounds is known.
    fn between(&self, link: usize, equipment: usize) -> Option<f64>;

    /// Returns the bound for the relative motion of two robot solids.
    fn between_links(&self, link: usize, other: usize) -> f64;
}

impl Scene {
    /// Returns the first pair of solids that may come nearer to each other than the clearance. The check
    /// assumes that every solid moves by at most its bound in `motion`. The result is None if all pairs
    /// certainly keep their clearance.
    ///
    /// `frames` are the nominal link frames in the robot base frame, and `operation` selects the held parts.
    pub fn first_unsafe(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        operation: usize,
        motion: &impl SolidMotion,
    ) -> Option<Hit> {
        if !self.enabled {
            return None;
        }
        let load = Load::of(Some(operation));
        let mut memory = LinkBounds::default();
        let mut is_safe = |pair: Pair, by: f64| self.is_apart(placed, frames, &mut memory, pair, by);
        let poses = LinkPoses { frames, base: placed.base.as_ref() };
        let there = |link: &RobotSolid| load.has(link) && !link.is_pedestal();
        for (k, link) in self.links.iter().enumerate().filter(|(_, link)| there(link)) {
            let (low, high) = poses.capsule(link).bounds();
            let own = motion.of_link(k);
            if link.frame > 0 {
                let pair = Pair { link: k, against: Against::Floor };
                let by = own + motion.of_equipment(None);
                if low.z - by <= self.floor && !is_safe(pair, by) {
                    return Some(self.hit_of(placed, pair));
                }
            }
            for (b, body) in placed.bodies.iter().enumerate() {
                let by = own + motion.of_equipment(Some(body.id.0));
                let room = Vector3::repeat(by);
                let pair = Pair { link: k, against: Against::Placed(b) };
                if overlapping((&(low - room), &(high + room)), (&body.low, &body.high))
                    && !load.spares(link, body.id.0)
                    && !is_safe(pair, motion.between(k, body.id.0).map_or(by, |less| less.min(by)))
                {
                    return Some(self.hit_of(placed, pair));
                }
            }
        }
        self.self_pairs(load)
            .map(|(less, more)| {
                (Pair { link: more, against: Against::Own(less) }, motion.between_links(more, less))
            })
            .find(|(pair, by)| !self.are_links_far(poses, *pair, *by) && !is_safe(*pair, *by))
            .map(|(pair, _)| self.hit_of(placed, pair))
    }

    /// Returns whether the bounding boxes of two robot solids are farther apart than `by` (m) along an axis
    /// of the world.
    fn are_links_far(&self, poses: LinkPoses<'_>, pair: Pair, by: f64) -> bool {
        let Against::Own(other) = pair.against else { return false };
        let (link, other) = (&self.links[pair.link], &self.links[other]);
        let ((a_low, a_high), (b_low, b_high)) =
            (poses.capsule(link).bounds(), poses.capsule(other).bounds());
        let room = Vector3::repeat(by);
        !overlapping((&(a_low - room), &(a_high + room)), (&b_low, &b_high))
    }
}
