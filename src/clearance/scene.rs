//! Robot solids against equipment solids, in three dimensions.

use super::bodies::{Body, Part, parry_pose, part, swollen};
use crate::cell::{Cell, Layout, MAX_JOINTS};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math as pm;
use parry3d::query::{DefaultQueryDispatcher, QueryDispatcher};
use parry3d::shape::{self, SharedShape};

/// Solids nearer than this touch, m: more than parry's rounding, so that every contact is one.
const TOUCHING: f64 = 1e-7;

/// What a robot solid touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hit {
    /// Index into [`crate::cell::Robot::solids`].
    pub solid: usize,
    /// Index into [`Cell::equipment`] and its solids; None for the floor.
    pub other: Option<(usize, usize)>,
}

/// The solids of a cell, made ready once. Robot solids are swollen by the clearance.
pub struct Scene {
    links: Vec<(usize, Body)>,
    parts: Vec<Vec<Part>>,
    base: Pose,
    floor: f64,
    enabled: bool,
}

/// The equipment solids of one layout; reused from layout to layout.
#[derive(Default)]
pub struct Placed {
    bodies: Vec<PlacedBody>,
    /// What the base itself touches, whatever the arm does.
    base_hit: Option<Hit>,
    /// The pair that touched last: the next posture most likely touches it, too.
    suspect: Option<(usize, usize)>,
}

struct PlacedBody {
    id: (usize, usize),
    pose: pm::Pose,
    bounds: Aabb,
    /// Bounds in the frame of the solid.
    local_bounds: Aabb,
    /// A leg of this layout; None: the shape of the scene.
    leg: Option<shape::Cuboid>,
}

impl Scene {
    pub fn new(cell: &Cell) -> Self {
        let link = |s: &crate::cell::LinkSolid| (s.link, swollen(&s.solid.shape, cell.clearance + TOUCHING));
        let parts = |e: &crate::cell::Equipment| e.solids.iter().map(|s| part(&s.shape)).collect();
        Self {
            links: cell.robot.solids.iter().map(link).collect(),
            parts: cell.equipment.iter().map(parts).collect(),
            base: cell.base.pose(),
            floor: cell.floor,
            enabled: cell.collision,
        }
    }

    /// Poses the equipment of a layout.
    pub fn place(&self, layout: &Layout, placed: &mut Placed) {
        placed.bodies.clear();
        (placed.base_hit, placed.suspect) = (None, None);
        if !self.enabled {
            return;
        }
        for (e, (parts, at)) in self.parts.iter().zip(&layout.placements).enumerate() {
            let frame = at.pose();
            let bodies = parts.iter().enumerate().filter_map(|(s, part)| self.posed((e, s), part, &frame));
            placed.bodies.extend(bodies);
        }
        for solid in (0..self.links.len()).filter(|&solid| self.links[solid].0 == 0) {
            let pose = parry_pose(&(self.base * self.links[solid].1.local));
            placed.base_hit = placed.base_hit.or_else(|| self.first_hit(solid, &pose, placed));
        }
    }

    fn posed(&self, id: (usize, usize), part: &Part, frame: &Pose) -> Option<PlacedBody> {
        match part {
            Part::Convex(body) | Part::Mesh { body, .. } => {
                let pose = parry_pose(&(*frame * body.local));
                let local_bounds = body.shape.compute_local_aabb();
                Some(PlacedBody { id, pose, bounds: body.shape.compute_aabb(&pose), local_bounds, leg: None })
            }
            Part::Leg { x, y, half, top } => {
                let height = frame.translation.z + top - self.floor;
                if height <= 0.0 {
                    return None;
                }
                let centre = Vector3::new(*x, *y, top - height / 2.0);
                let pose = parry_pose(&Pose { translation: frame.transform(&centre), ..*frame });
                let leg = shape::Cuboid::new(pm::Vector::new(half.0, half.1, height / 2.0));
                Some(PlacedBody {
                    id,
                    pose,
                    bounds: leg.aabb(&pose),
                    local_bounds: leg.local_aabb(),
                    leg: Some(leg),
                })
            }
        }
    }

    /// The first contact of the robot with its link frames (in the base) at `frames`, or None.
    pub fn hit(&self, placed: &Placed, frames: &[Pose; MAX_JOINTS + 1]) -> Option<Hit> {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit;
        }
        (0..self.links.len()).filter(|&solid| self.links[solid].0 > 0).find_map(|solid| {
            let pose = self.link_pose(solid, frames);
            let low = self.links[solid].1.shape.compute_aabb(&pose).mins.z;
            if low <= self.floor {
                Some(Hit { solid, other: None })
            } else {
                self.first_hit(solid, &pose, placed)
            }
        })
    }

    /// Whether [`Self::hit`] finds nothing, asked faster for one posture after another.
    pub fn is_free(&self, placed: &mut Placed, frames: &[Pose; MAX_JOINTS + 1]) -> bool {
        if let Some((solid, k)) = placed.suspect
            && self.touches(solid, &self.link_pose(solid, frames), &placed.bodies[k])
        {
            return false;
        }
        let hit = self.hit(placed, frames);
        placed.suspect = hit.and_then(|h| {
            let other = h.other.filter(|_| self.links[h.solid].0 > 0)?;
            Some((h.solid, placed.bodies.iter().position(|b| b.id == other)?))
        });
        hit.is_none()
    }

    fn link_pose(&self, solid: usize, frames: &[Pose; MAX_JOINTS + 1]) -> pm::Pose {
        let (link, body) = &self.links[solid];
        parry_pose(&(self.base * frames[*link] * body.local))
    }

    fn first_hit(&self, solid: usize, pose: &pm::Pose, placed: &Placed) -> Option<Hit> {
        let bounds = self.links[solid].1.shape.compute_aabb(pose);
        let mut near = placed.bodies.iter().filter(|b| b.bounds.intersects(&bounds));
        near.find(|b| self.touches(solid, pose, b)).map(|b| Hit { solid, other: Some(b.id) })
    }

    /// Bounds in the frame of the other solid, then the shapes themselves.
    fn touches(&self, solid: usize, pose: &pm::Pose, other: &PlacedBody) -> bool {
        let link = &self.links[solid].1;
        let relative = other.pose.inv_mul(pose);
        if !link.shape.compute_aabb(&relative).intersects(&other.local_bounds) {
            return false;
        }
        match (&self.parts[other.id.0][other.id.1], &other.leg) {
            (_, Some(leg)) => intersecting(leg, &relative, &*link.shape),
            (Part::Convex(body), None) => match (body.shape.as_ball(), &link.unswollen) {
                (Some(ball), Some((shape, by))) => {
                    intersecting(&shape::Ball::new(ball.radius + by), &relative, &**shape)
                }
                _ => intersecting(&*body.shape, &relative, &*link.shape),
            },
            (Part::Mesh { body, closed }, None) => {
                let near = |s: &SharedShape| s.compute_aabb(&relative).intersects(&other.local_bounds);
                let hits = |s: &SharedShape| near(s) && intersecting(&*body.shape, &relative, &**s);
                let whole = std::slice::from_ref(&link.shape);
                let pieces = if link.pieces.is_empty() { whole } else { &link.pieces };
                // A closed mesh that is not touched but holds one point of the link holds all of it.
                let point = relative * link.inside;
                let held = || {
                    other.local_bounds.contains_local_point(point) && body.shape.contains_local_point(point)
                };
                pieces.iter().any(hits) || *closed && held()
            }
            (Part::Leg { .. }, None) => false,
        }
    }
}

/// parry answers every pair of the shapes built here; should it not, a collision is the safe answer.
fn intersecting(a: &dyn shape::Shape, b_in_a: &pm::Pose, b: &dyn shape::Shape) -> bool {
    DefaultQueryDispatcher.intersection_test(b_in_a, a, b).map_or(true, |answer| answer.intersecting)
}
