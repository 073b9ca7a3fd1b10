//! Robot solids against equipment solids, in three dimensions.

use super::bodies::{Body, Part, intersecting, parry_pose, part, touching};
use super::decomposition::Remember;
use super::distance::{self, Mover};
use super::fence;
use super::hit::{Hit, SolidRef};
use super::links::{self, Link};
use super::own_pairs::{self, OwnPair};
use crate::cell::{Cell, Layout, MAX_JOINTS};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math as pm;
use parry3d::shape::{self, SharedShape};

/// The solids of a cell, made ready once. Robot solids are swollen by the clearance.
pub struct Scene {
    pub(super) links: Vec<Link>,
    /// One per link.
    pub(super) movers: Vec<Mover>,
    /// What of the robot is checked against what, and what may touch.
    own_pairs: Vec<OwnPair>,
    /// Links of the pairs that are checked.
    pub(super) checked: Vec<(usize, usize)>,
    /// Of the equipment, and after it of the fence.
    pub(super) parts: Vec<Vec<Part>>,
    /// The frame after the last joint.
    pub(super) last: usize,
    pub(super) floor: f64,
    pub(super) clearance: f64,
    pub(super) enabled: bool,
}

/// The equipment solids of one layout; reused from layout to layout.
#[derive(Default)]
pub struct Placed {
    /// The robot base in the world; None: where that is.
    base: Option<Pose>,
    pub(super) bodies: Vec<PlacedBody>,
    /// What the base itself touches, whatever the arm does.
    pub(super) base_hit: Option<Hit>,
    /// Link, its body and placed body that touched last: the next posture most likely does, too.
    suspect: Option<(usize, usize, usize)>,
}

pub(super) struct PlacedBody {
    pub(super) id: (usize, usize),
    pub(super) pose: pm::Pose,
    bounds: Aabb,
    /// Bounds in the frame of the solid.
    pub(super) local_bounds: Aabb,
    /// A leg of this layout; None: the shape of the scene.
    pub(super) leg: Option<shape::Cuboid>,
}

impl Placed {
    pub(super) fn in_world(&self, frame: &Pose) -> Pose {
        self.base.map_or(*frame, |base| base * *frame)
    }
}

impl Scene {
    pub fn new(cell: &Cell) -> Self {
        Self::remembering(cell, &mut |_, compute| compute())
    }

    /// The same with what takes long to compute, the convex parts of link meshes, kept elsewhere.
    pub fn remembering(cell: &Cell, remember: &mut Remember<'_>) -> Self {
        let links = links::all(cell, remember);
        let parts = |e: &crate::cell::Equipment| e.solids.iter().map(|s| part(&s.shape)).collect();
        let own_pairs = if cell.collision { own_pairs::find(cell, &links) } else { Vec::new() };
        let place = |id: SolidRef| links.iter().position(|l| l.id == id);
        let checked = own_pairs.iter().filter(|p| p.allowed.is_none());
        Self {
            checked: checked.filter_map(|p| place(p.a).zip(place(p.b))).collect(),
            own_pairs,
            parts: cell.equipment.iter().map(parts).chain([fence::walls(cell)]).collect(),
            last: cell.robot.axes(),
            floor: cell.floor,
            clearance: cell.clearance,
            enabled: cell.collision,
            movers: distance::movers(&links),
            links,
        }
    }

    /// Every pair of solids of the robot, tool and held parts included, and why it may touch.
    pub fn own_pairs(&self) -> &[OwnPair] {
        &self.own_pairs
    }

    /// Poses the equipment of a layout.
    pub fn place(&self, layout: &Layout, placed: &mut Placed) {
        placed.bodies.clear();
        let base = layout.base.pose();
        placed.base = (base != Pose::identity()).then_some(base);
        (placed.base_hit, placed.suspect) = (None, None);
        if !self.enabled {
            return;
        }
        let frames = layout.placements.iter().map(|at| at.pose()).chain([Pose::identity()]);
        for (e, (parts, frame)) in self.parts.iter().zip(frames).enumerate() {
            let bodies = parts.iter().enumerate().filter_map(|(s, part)| self.posed((e, s), part, &frame));
            placed.bodies.extend(bodies);
        }
        for link in self.links.iter().filter(|l| l.frame == 0) {
            placed.base_hit = placed.base_hit.or_else(|| self.first_hit(link, &base, placed));
        }
    }

    fn posed(&self, id: (usize, usize), part: &Part, frame: &Pose) -> Option<PlacedBody> {
        match part {
            Part::Convex(body) | Part::Mesh { body, .. } => {
                let pose = parry_pose(&(*frame * body.local));
                let (bounds, local_bounds) = (body.shape.compute_aabb(&pose), body.bounds);
                Some(PlacedBody { id, pose, bounds, local_bounds, leg: None })
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

    /// The first contact of the robot with its link frames (in the base) at `frames`, or None. With
    /// the parts that `operation` holds; None: with empty hands.
    pub fn hit(
        &self,
        placed: &Placed,
        frames: &[Pose; MAX_JOINTS + 1],
        operation: Option<usize>,
    ) -> Option<Hit> {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit;
        }
        let there = |link: &&Link| link.frame > 0 && link.is_there(operation);
        let outside = self
            .links
            .iter()
            .filter(there)
            .find_map(|link| self.first_hit(link, &placed.in_world(&frames[link.frame]), placed));
        outside.or_else(|| self.own_hit(frames, operation))
    }

    /// Whether [`Self::hit`] finds nothing, asked faster for one posture after another.
    pub fn is_free(
        &self,
        placed: &mut Placed,
        frames: &[Pose; MAX_JOINTS + 1],
        operation: Option<usize>,
    ) -> bool {
        if let Some((k, b, body)) = placed.suspect
            && self.links[k].is_there(operation)
            && let link = &self.links[k]
            && let frame = placed.in_world(&frames[link.frame])
            && self.touches(&link.bodies[b], &link.bodies[b].pose_in(&frame), &placed.bodies[body])
        {
            return false;
        }
        let hit = self.hit(placed, frames, operation);
        placed.suspect = None;
        if let Some(Hit { solid, other }) = hit {
            let link = self.links.iter().position(|l| l.id == solid && l.frame > 0);
            let body = placed.bodies.iter().position(|b| self.name(b.id) == other);
            placed.suspect = link.zip(body).map(|(link, body)| (link, 0, body));
        }
        hit.is_none()
    }

    /// What a placed body is: a solid of an equipment, or a wall of the fence.
    pub(super) fn name(&self, (e, s): (usize, usize)) -> SolidRef {
        if e + 1 == self.parts.len() { SolidRef::Fence(s) } else { SolidRef::Equipment(e, s) }
    }

    /// The first contact of the robot with itself.
    fn own_hit(&self, frames: &[Pose; MAX_JOINTS + 1], operation: Option<usize>) -> Option<Hit> {
        let pairs = self.checked.iter().map(|&(a, b)| (&self.links[a], &self.links[b]));
        let mut there = pairs.filter(|(a, b)| a.is_there(operation) && b.is_there(operation));
        let found = there.find(|(a, b)| a.touches(a.carrier(frames), b, b.carrier(frames)));
        found.map(|(a, b)| Hit { solid: b.id, other: a.id })
    }

    fn first_hit(&self, link: &Link, frame: &Pose, placed: &Placed) -> Option<Hit> {
        link.bodies.iter().find_map(|body| {
            let pose = body.pose_in(frame);
            let bounds = body.shape.compute_aabb(&pose);
            // The base stands on the floor.
            if link.frame > 0 && bounds.mins.z <= self.floor {
                return Some(Hit { solid: link.id, other: SolidRef::Floor });
            }
            let mut near = placed.bodies.iter().filter(|b| b.bounds.intersects(&bounds));
            let found = near.find(|b| {
                let may_touch = link.spared != Some(b.id.0);
                may_touch && (self.touches(body, &pose, b) || self.swallows(link, frame, b))
            });
            found.map(|b| Hit { solid: link.id, other: self.name(b.id) })
        })
    }

    /// Whether a closed link mesh holds a point of the other solid.
    pub(super) fn swallows(&self, link: &Link, frame: &Pose, other: &PlacedBody) -> bool {
        let Some(shell) = &link.shell else { return false };
        let inside = match &self.parts[other.id.0][other.id.1] {
            Part::Convex(body) | Part::Mesh { body, .. } => body.inside,
            Part::Leg { .. } => pm::Vector::ZERO,
        };
        shell.holds(&(shell.pose_in(frame).inverse() * (other.pose * inside)))
    }

    /// Bounds in the frame of the other solid, then the shapes themselves.
    fn touches(&self, link: &Body, pose: &pm::Pose, other: &PlacedBody) -> bool {
        let relative = other.pose.inv_mul(pose);
        if !link.bounds_in(&relative).intersects(&other.local_bounds) {
            return false;
        }
        match (&self.parts[other.id.0][other.id.1], &other.leg) {
            (_, Some(leg)) => intersecting(leg, &relative, &*link.shape),
            (Part::Convex(body), None) => touching(body, &relative, link),
            (Part::Mesh { body, closed }, None) => {
                let near = |s: &SharedShape| s.compute_aabb(&relative).intersects(&other.local_bounds);
                let hits = |s: &SharedShape| near(s) && intersecting(&*body.shape, &relative, &**s);
                let whole = std::slice::from_ref(&link.shape);
                let pieces = if link.pieces.is_empty() { whole } else { &link.pieces };
                // A closed mesh that is not touched but holds one point of the link holds all of it.
                pieces.iter().any(hits) || *closed && body.holds(&(relative * link.inside))
            }
            (Part::Leg { .. }, None) => false,
        }
    }
}
