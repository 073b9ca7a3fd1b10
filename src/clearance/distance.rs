//! How far the robot is from what it must not touch.
//!
//! Rounded solids are asked as what they were before rounding, capsules as their segments, and the
//! radius is taken off: parry's distances of round shapes are off by up to 1.2e-5 m. Of two convex
//! solids the answer is the gap along the direction between the nearest points that parry found, which
//! both solids leave free: never more than the distance, whatever parry missed.

use super::bodies::{Body, Part, parry_pose, vector};
use super::hit::{Hit, SolidRef};
use super::links::Link;
use super::scene::{Placed, PlacedBody, Scene, swallows};
use crate::cell::MAX_JOINTS;
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math as pm;
use parry3d::query::{ClosestPoints, DefaultQueryDispatcher, QueryDispatcher};
use parry3d::shape::{Cuboid, Shape, SharedShape};

/// A distance is never more than this above the true one, m.
pub const ACCURACY: f64 = 1e-6;

/// To be farther than this from a mesh, m, its bounds are asked alone: triangles within it are many.
const COARSE: f64 = 0.1;

/// How near the robot is to anything else.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearness {
    /// m; 0 if they touch, at most what was asked for.
    pub distance: f64,
    /// The nearest two solids; None: nothing is nearer than what was asked for.
    pub pair: Option<Hit>,
}

/// What the robot holds on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Load {
    /// Operations whose parts are held, and whether those that rest on its surface may touch it.
    held: [Option<(usize, bool)>; 2],
}

/// Two solids that may meet, at least one of which the robot moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// Index into [`Scene::movers`].
    pub mover: usize,
    against: Against,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Against {
    Floor,
    /// Index into the bodies of a layout.
    Placed(usize),
    /// Another solid of the robot, which moves less.
    Own(usize),
}

/// What a bound of motion needs of a solid of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mover {
    /// 0: the base, k: the frame after row k.
    pub frame: usize,
    /// A ball that holds it: centre in that frame, m.
    pub centre: Vector3<f64>,
    pub radius: f64,
}

impl Load {
    /// What an operation holds while it is done; None: nothing.
    pub fn of(operation: Option<usize>) -> Self {
        Self { held: [operation.map(|o| (o, true)), None] }
    }

    /// What either of two operations holds, on the way between them; `rests`: whether it still rests on
    /// the surface there.
    pub fn between(from: (usize, bool), to: (usize, bool)) -> Self {
        Self { held: [Some(from), Some(to)] }
    }

    fn has(&self, link: &Link) -> bool {
        link.operation.is_none_or(|o| self.held.iter().flatten().any(|h| h.0 == o))
    }

    fn spares(&self, link: &Link, equipment: usize) -> bool {
        let rests = || self.held.iter().flatten().any(|h| Some(h.0) == link.operation && h.1);
        link.spared == Some(equipment) && rests()
    }
}

/// What bounds the motion of every link.
pub(super) fn movers(links: &[Link]) -> Vec<Mover> {
    let ball = |body: &Body| {
        let ball = body.shape.compute_local_bounding_sphere();
        let centre = Vector3::new(ball.center.x, ball.center.y, ball.center.z);
        (body.local.transform(&centre), ball.radius)
    };
    let mover = |link: &Link| {
        let balls: Vec<_> = link.bare.iter().map(ball).collect();
        let centre = balls.iter().map(|b| b.0).sum::<Vector3<f64>>() / balls.len().max(1) as f64;
        let radius = balls.iter().map(|b| (b.0 - centre).norm() + b.1).fold(0.0, f64::max);
        Mover { frame: link.frame, centre, radius }
    };
    links.iter().map(mover).collect()
}

impl Pair {
    /// The solid of the robot that the first is checked against; None: it stands still.
    pub fn partner(&self) -> Option<usize> {
        if let Against::Own(other) = self.against { Some(other) } else { None }
    }
}

impl Scene {
    /// The solids of the robot, held parts included.
    pub fn movers(&self) -> &[Mover] {
        &self.movers
    }

    /// What the base touches, whatever the arm does.
    pub fn base_hit(&self, placed: &Placed) -> Option<Hit> {
        placed.base_hit
    }

    /// Every pair that can meet while the arm moves; none if collision is not checked.
    pub fn pairs(&self, placed: &Placed, load: Load) -> Vec<Pair> {
        if !self.enabled {
            return Vec::new();
        }
        let own = self.checked.iter().filter(|(a, b)| load.has(&self.links[*a]) && load.has(&self.links[*b]));
        let own = own.map(|&(a, b)| {
            let (less, more) = if self.links[a].frame < self.links[b].frame { (a, b) } else { (b, a) };
            Pair { mover: more, against: Against::Own(less) }
        });
        self.outer(placed, load).filter(|p| self.links[p.mover].frame > 0).chain(own).collect()
    }

    /// The pairs of robot and surroundings.
    fn outer<'s>(&'s self, placed: &'s Placed, load: Load) -> impl Iterator<Item = Pair> + 's {
        let links = self.links.iter().enumerate().filter(move |(_, link)| load.has(link));
        links.flat_map(move |(mover, link)| {
            let floor = (link.frame > 0).then_some(Pair { mover, against: Against::Floor });
            let bodies = placed.bodies.iter().enumerate();
            let bodies = bodies.filter(move |(_, b)| !load.spares(link, b.id.0));
            bodies.map(move |(k, _)| Pair { mover, against: Against::Placed(k) }).chain(floor)
        })
    }

    /// The two solids of a pair.
    pub fn hit_of(&self, placed: &Placed, pair: Pair) -> Hit {
        let other = match pair.against {
            Against::Floor => SolidRef::Floor,
            Against::Placed(k) => self.name(placed.bodies[k].id),
            Against::Own(other) => self.links[other].id,
        };
        Hit { solid: self.links[pair.mover].id, other }
    }

    /// Least distance of the robot to equipment, floor and fence, up to `max` (m): with its link frames
    /// (in the base) at `frames` and the parts that `operation` holds. Of the solids as they are drawn,
    /// the clearance aside; of the robot to itself nothing is said.
    pub fn distance(
        &self,
        placed: &Placed,
        frames: &[Pose; MAX_JOINTS + 1],
        operation: Option<usize>,
        max: f64,
    ) -> Nearness {
        self.nearest(placed, frames, self.outer(placed, Load::of(operation)), max)
    }

    /// The same while an operation is done on an equipment, without the pairs of which every layout has the
    /// same: what is mounted behind the last joint is near that equipment by intent, as near as the standoff
    /// says; what only the first joint moves, which turns upright or slides along, is near the floor.
    pub fn distance_at_work(
        &self,
        placed: &Placed,
        frames: &[Pose; MAX_JOINTS + 1],
        (operation, equipment): (usize, usize),
        max: f64,
    ) -> Nearness {
        let is_usual = |pair: &Pair| match pair.against {
            Against::Floor => self.links[pair.mover].frame <= 1,
            Against::Placed(k) => {
                self.links[pair.mover].frame == self.last && placed.bodies[k].id.0 == equipment
            }
            Against::Own(_) => false,
        };
        let pairs = self.outer(placed, Load::of(Some(operation))).filter(|p| !is_usual(p));
        self.nearest(placed, frames, pairs, max)
    }

    fn nearest(
        &self,
        placed: &Placed,
        frames: &[Pose; MAX_JOINTS + 1],
        pairs: impl Iterator<Item = Pair>,
        max: f64,
    ) -> Nearness {
        let mut nearest = Nearness { distance: max, pair: None };
        if !self.enabled {
            return nearest;
        }
        for pair in pairs {
            let distance = self.gap(placed, frames, pair, nearest.distance);
            if distance < nearest.distance {
                nearest = Nearness { distance, pair: Some(self.hit_of(placed, pair)) };
            }
        }
        nearest
    }

    /// Whether every point of the first solid of a pair may move by `by` (m) and still keep the clearance
    /// to the second (of a pair of the robot: not touch it).
    pub fn is_apart(&self, placed: &Placed, frames: &[Pose; MAX_JOINTS + 1], pair: Pair, by: f64) -> bool {
        let clearance = if pair.partner().is_some() { 0.0 } else { self.clearance };
        let wanted = clearance + by + ACCURACY;
        if let Against::Placed(k) = pair.against
            && wanted > COARSE
            && self.is_mesh(&placed.bodies[k])
        {
            let (link, other) = (&self.links[pair.mover], &placed.bodies[k]);
            let (frame, pose) = (placed.in_world(link.carrier(frames)), parry_pose(&other.pose));
            let is_near = |b: &Body| near(b, &pose.inv_mul(&b.pose_in(&frame)), &bounds_of(other), wanted);
            return !link.bare.iter().any(is_near);
        }
        self.gap(placed, frames, pair, wanted) >= wanted
    }

    fn is_mesh(&self, body: &PlacedBody) -> bool {
        matches!(self.stands[body.id.0].parts[body.id.1], Part::Mesh { .. })
    }

    /// Distance of a pair, at most `max`.
    fn gap(&self, placed: &Placed, frames: &[Pose; MAX_JOINTS + 1], pair: Pair, max: f64) -> f64 {
        let link = &self.links[pair.mover];
        match pair.against {
            Against::Floor => {
                let frame = placed.in_world(&frames[link.frame]);
                let low = |b: &Body| b.shape.compute_aabb(&b.pose_in(&frame)).mins.z;
                let low = link.bare.iter().map(low).fold(f64::INFINITY, f64::min);
                (low - self.floor).clamp(0.0, max)
            }
            Against::Placed(k) => {
                let carrier = link.carrier(frames);
                self.gap_to_placed(link, &placed.in_world(carrier), &placed.bodies[k], max)
            }
            Against::Own(other) => gap_of_links(link, &self.links[other], frames, max),
        }
    }

    fn gap_to_placed(&self, link: &Link, frame: &Pose, other: &PlacedBody, max: f64) -> f64 {
        let (part, pose) = (&self.stands[other.id.0].parts[other.id.1], parry_pose(&other.pose));
        if swallows(link, frame, part, &pose) {
            return 0.0;
        }
        let mut gap = max;
        for body in &link.bare {
            let relative = pose.inv_mul(&body.pose_in(frame));
            if !near(body, &relative, &bounds_of(other), gap) {
                continue;
            }
            match part {
                Part::Leg { .. } => {
                    let leg = Cuboid::new(vector(&other.bulk.half));
                    gap = gap_of_cores((&leg, 0.0), &relative, core(body), gap);
                }
                Part::Convex(solid) => gap = gap_of_cores(core(solid), &relative, core(body), gap),
                Part::Mesh { body: mesh, closed } => {
                    if *closed && mesh.holds(&(relative * body.inside)) {
                        return 0.0;
                    }
                    gap = gap_to_mesh(&*mesh.shape, &relative, body, gap);
                }
            }
        }
        gap
    }
}

/// Bounds of a placed body in its own frame.
fn bounds_of(body: &PlacedBody) -> Aabb {
    Aabb::from_half_extents(vector(&body.bulk.centre), vector(&body.bulk.half))
}

/// Distance of two solids of the robot, at most `max`.
fn gap_of_links(link: &Link, other: &Link, frames: &[Pose; MAX_JOINTS + 1], max: f64) -> f64 {
    let (frame, there) = (link.carrier(frames), other.carrier(frames));
    if link.swallows(frame, other, there) || other.swallows(there, link, frame) {
        return 0.0;
    }
    let mut gap = max;
    for b in &link.bare {
        let pose = b.pose_in(frame);
        for a in &other.bare {
            let relative = a.pose_in(there).inv_mul(&pose);
            if near(b, &relative, &a.bounds, gap) {
                gap = gap_of_cores(core(a), &relative, core(b), gap);
            }
        }
    }
    gap
}

/// Whether the bounds of a body are within `by` of other bounds, in whose frame it is at `relative`.
fn near(body: &Body, relative: &pm::Pose, bounds: &Aabb, by: f64) -> bool {
    body.bounds_in(relative).loosened(by).intersects(bounds)
}

/// What rounding a shape has started from, and by how much it was rounded (m).
type Core<'b> = (&'b dyn Shape, f64);

fn core(body: &Body) -> Core<'_> {
    match (&body.unswollen, body.shape.as_capsule()) {
        (Some((shape, by)), _) => (&**shape, *by),
        (None, Some(capsule)) => (&capsule.segment, capsule.radius),
        (None, None) => (&*body.shape, 0.0),
    }
}

fn gap_to_mesh(mesh: &dyn Shape, relative: &pm::Pose, body: &Body, max: f64) -> f64 {
    let piece = |shape: &SharedShape, max: f64| match shape.as_capsule() {
        Some(capsule) => gap_of_cores((mesh, 0.0), relative, (&capsule.segment, capsule.radius), max),
        None => gap_of_cores((mesh, 0.0), relative, core(body), max),
    };
    let whole = std::slice::from_ref(&body.shape);
    let pieces = if body.pieces.is_empty() { whole } else { &body.pieces };
    pieces.iter().fold(max, |gap, shape| piece(shape, gap))
}

/// Distance of two solids, at most `max`; `relative`: the pose of `b` in the frame of `a`.
fn gap_of_cores((a, ra): Core<'_>, relative: &pm::Pose, (b, rb): Core<'_>, max: f64) -> f64 {
    let round = ra + rb;
    let found = DefaultQueryDispatcher.closest_points(relative, a, b, max + round);
    let core_gap = match found {
        Ok(ClosestPoints::Disjoint) => return max,
        Ok(ClosestPoints::WithinMargin(p, q)) => {
            let apart = relative * q - p;
            certified(a, relative, b, &apart).unwrap_or(apart.length())
        }
        // A contact is the safe answer to what parry cannot tell.
        Ok(ClosestPoints::Intersecting) | Err(_) => 0.0,
    };
    (core_gap - round).clamp(0.0, max)
}

/// The gap that two convex solids leave free along a direction from the first to the second.
fn certified(a: &dyn Shape, relative: &pm::Pose, b: &dyn Shape, direction: &pm::Vector) -> Option<f64> {
    let (a, b, n) = (a.as_support_map()?, b.as_support_map()?, direction.try_normalize()?);
    let far = a.local_support_point(n).dot(n);
    Some(b.support_point(relative, -n).dot(n) - far)
}
