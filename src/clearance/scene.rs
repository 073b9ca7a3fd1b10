//! Robot solids against equipment solids, in three dimensions.

use super::bodies::{Body, Part, intersecting, parry_pose, part, plain, touching, vector};
use super::decomposition::Remember;
use super::distance;
use super::distance::Mover;
use super::fence;
use super::hit::{Hit, SolidRef};
use super::links;
use super::links::Link;
use super::own_pairs;
use super::own_pairs::OwnPair;
use super::rod::{Bulk, Rod, UNSURE, Verdict, overlapping};
use crate::cell::{Cell, Equipment, Layout, MAX_JOINTS, Placement};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::bounding_volume::BoundingVolume;
use parry3d::math as pm;
use parry3d::shape::{Cuboid, SharedShape};

/// The solids of a cell, made ready once. Robot solids are swollen by the clearance.
pub struct Scene {
    pub(super) links: Vec<Link>,
    /// One per link.
    pub(super) movers: Vec<Mover>,
    /// What of the robot is checked against what, and what may touch.
    own_pairs: Vec<OwnPair>,
    /// Links of the pairs that are checked.
    pub(super) checked: Vec<(usize, usize)>,
    /// Of the equipment, and after it the walls of the fence.
    pub(super) stands: Vec<Stand>,
    /// The frame after the last joint.
    pub(super) last: usize,
    pub(super) floor: f64,
    pub(super) clearance: f64,
    pub(super) enabled: bool,
}

/// The solids of an equipment.
pub(super) struct Stand {
    pub(super) parts: Vec<Part>,
    /// Where the cell as drawn has it, as obstacles always stand, and its solids there.
    drawn: Placement,
    posed: Vec<PlacedBody>,
}

/// The equipment solids of one layout; reused from layout to layout.
#[derive(Default)]
pub struct Placed {
    /// The robot base in the world; None: where that is.
    base: Option<Pose>,
    pub(super) bodies: Vec<PlacedBody>,
    /// What the base itself touches, whatever the arm does.
    pub(super) base_hit: Option<Hit>,
}

/// Memory that speeds up [`Scene::is_free`] over a series of postures. It changes no verdict, so one memory
/// serves any layout.
#[derive(Default)]
pub struct ContactMemory {
    /// Link and placed body that touched last: the next posture most likely touches there, too.
    suspect: Option<(usize, usize)>,
    /// Bounding capsules of the links at the last posture.
    rods: Vec<Rod>,
}

#[derive(Clone, Copy)]
pub(super) struct PlacedBody {
    pub(super) id: (usize, usize),
    pub(super) pose: Pose,
    /// Low and high corner in the world, with room for what is unsure.
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// In the frame of the solid; a leg is cut to length for the layout.
    pub(super) bulk: Bulk,
}

/// The frames of the links in the base.
type Links = [Pose; MAX_JOINTS + 1];

/// Where the links are: their frames in the base, and the base in the world if that is another frame.
#[derive(Clone, Copy)]
struct Stance<'a> {
    frames: &'a Links,
    base: Option<&'a Pose>,
}

impl Stance<'_> {
    /// The frame that a link moves with, in the world.
    fn carrier(&self, link: &Link) -> Pose {
        let frame = link.carrier(self.frames);
        self.base.map_or(*frame, |base| *base * *frame)
    }

    /// What holds a link, in the world.
    fn rod(&self, link: &Link) -> Rod {
        let rod = link.rod(link.carrier(self.frames));
        self.base.map_or(rod, |base| rod.at(base))
    }
}

impl Placed {
    pub(super) fn in_world(&self, frame: &Pose) -> Pose {
        self.base.map_or(*frame, |base| base * *frame)
    }
}

impl PlacedBody {
    fn new(id: (usize, usize), pose: Pose, bulk: Bulk) -> Self {
        let middle = pose.transform(&bulk.centre);
        let room = (pose.rotation.abs() * bulk.half).add_scalar(UNSURE);
        Self { id, pose, low: middle - room, high: middle + room, bulk }
    }
}

impl Stand {
    fn new(e: usize, parts: Vec<Part>, drawn: Placement, floor: f64) -> Self {
        let mut stand = Self { parts, drawn, posed: Vec::new() };
        stand.posed = stand.at(e, &drawn, floor).collect();
        stand
    }

    /// Its solids, as equipment number `e` at a placement.
    fn at(&self, e: usize, at: &Placement, floor: f64) -> impl Iterator<Item = PlacedBody> {
        let frame = at.pose();
        self.parts.iter().enumerate().filter_map(move |(s, part)| match part {
            Part::Convex(body) | Part::Mesh { body, .. } => {
                let (centre, half) = (plain(body.bounds.center()), plain(body.bounds.half_extents()));
                let bulk = Bulk { centre, half, is_solid: body.shape.as_cuboid().is_some() };
                Some(PlacedBody::new((e, s), frame * body.local, bulk))
            }
            Part::Leg { x, y, half, top } => {
                let height = frame.translation.z + top - floor;
                let centre = Vector3::new(*x, *y, top - height / 2.0);
                let pose = Pose { translation: frame.transform(&centre), ..frame };
                let half = Vector3::new(half.0, half.1, height / 2.0);
                let bulk = Bulk { centre: Vector3::zeros(), half, is_solid: true };
                (height > 0.0).then(|| PlacedBody::new((e, s), pose, bulk))
            }
        })
    }
}

impl Scene {
    pub fn new(cell: &Cell) -> Self {
        Self::remembering(cell, &mut |_, compute| compute())
    }

    /// The same with what takes long to compute, the convex parts of link meshes, kept elsewhere.
    pub fn remembering(cell: &Cell, remember: &mut Remember<'_>) -> Self {
        let links = links::all(cell, remember);
        let own_pairs = if cell.collision { own_pairs::find(cell, &links) } else { Vec::new() };
        let place = |id: SolidRef| links.iter().position(|l| l.id == id);
        let checked = own_pairs.iter().filter(|p| p.allowed.is_none());
        let solids = |e: &Equipment| e.solids.iter().map(|s| part(&s.shape)).collect();
        let equipment = cell.equipment.iter().map(solids).zip(cell.start().placements);
        let walls = (fence::walls(cell), Placement::from_values([0.0; 4]));
        let stands = equipment.chain([walls]).enumerate();
        Self {
            checked: checked.filter_map(|p| place(p.a).zip(place(p.b))).collect(),
            own_pairs,
            stands: stands.map(|(e, (parts, at))| Stand::new(e, parts, at, cell.floor)).collect(),
            last: cell.robot.axes(),
            floor: cell.floor,
            clearance: cell.clearance,
            movers: distance::movers(&links),
            enabled: cell.collision,
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
        placed.base_hit = None;
        if !self.enabled {
            return;
        }
        for (e, stand) in self.stands.iter().enumerate() {
            // The walls stand after the equipment, where they are drawn.
            let at = layout.placements.get(e).unwrap_or(&stand.drawn);
            if *at == stand.drawn {
                placed.bodies.extend_from_slice(&stand.posed);
            } else {
                placed.bodies.extend(stand.at(e, at, self.floor));
            }
        }
        let base = self.links.iter().filter(|l| l.frame == 0);
        let stance = Stance { frames: &[Pose::IDENTITY; MAX_JOINTS + 1], base: placed.base.as_ref() };
        let mut hits = base.filter_map(|l| self.first_hit(l, &stance.rod(l), stance, &placed.bodies));
        placed.base_hit = hits.next().map(|(hit, _)| hit);
    }

    /// The first contact of the robot with its link frames (in the base) at `frames`, or None. With
    /// the parts that `operation` holds; None: with empty hands.
    pub fn hit(&self, placed: &Placed, frames: &Links, operation: Option<usize>) -> Option<Hit> {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit;
        }
        let stance = Stance { frames, base: placed.base.as_ref() };
        let rods: Vec<Rod> = self.links.iter().map(|l| stance.rod(l)).collect();
        let outside = self.outside_hit(&placed.bodies, stance, &rods, operation);
        outside.map(|(_, (hit, _))| hit).or_else(|| self.own_hit(frames, &rods, operation))
    }

    /// Returns whether [`Self::hit`] finds no contact; faster for a series of postures.
    pub fn is_free(
        &self,
        placed: &Placed,
        frames: &Links,
        operation: Option<usize>,
        memory: &mut ContactMemory,
    ) -> bool {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit.is_none();
        }
        let stance = Stance { frames, base: placed.base.as_ref() };
        let ContactMemory { suspect, rods } = memory;
        if let Some((k, body)) = *suspect
            && let (Some(link), Some(body)) = (self.links.get(k), placed.bodies.get(body))
            && link.is_there(operation)
            && link.spared != Some(body.id.0)
            && self.touches(link, &stance.rod(link), stance, body)
        {
            return false;
        }
        rods.clear();
        rods.extend(self.links.iter().map(|l| stance.rod(l)));
        let outside = self.outside_hit(&placed.bodies, stance, rods, operation);
        *suspect = outside.and_then(|(k, (_, body))| Some((k, body?)));
        outside.is_none() && self.own_hit(frames, rods, operation).is_none()
    }

    /// The first contact of what moves with equipment or floor, after the number of its link.
    fn outside_hit(
        &self,
        bodies: &[PlacedBody],
        stance: Stance<'_>,
        rods: &[Rod],
        operation: Option<usize>,
    ) -> Option<(usize, (Hit, Option<usize>))> {
        let moving = self.links.iter().zip(rods).enumerate();
        let mut there = moving.filter(|(_, (l, _))| l.frame > 0 && l.is_there(operation));
        there.find_map(|(k, (link, rod))| Some((k, self.first_hit(link, rod, stance, bodies)?)))
    }

    /// The first contact of the robot with itself.
    fn own_hit(&self, frames: &Links, rods: &[Rod], operation: Option<usize>) -> Option<Hit> {
        let there = |k: usize| self.links[k].is_there(operation);
        let mut pairs = self.checked.iter().filter(|(a, b)| there(*a) && there(*b));
        let touch = |&&(i, j): &&(usize, usize)| {
            let (a, b) = (&self.links[i], &self.links[j]);
            a.is_near(&rods[i], b, &rods[j]) && a.touches_near(a.carrier(frames), b, b.carrier(frames))
        };
        pairs.find(touch).map(|&(i, j)| Hit { solid: self.links[j].id, other: self.links[i].id })
    }

    /// The first contact of a link (held by `rod`) with the floor or a placed body, and the number of that.
    fn first_hit(
        &self,
        link: &Link,
        rod: &Rod,
        stance: Stance<'_>,
        bodies: &[PlacedBody],
    ) -> Option<(Hit, Option<usize>)> {
        let (low, high) = rod.bounds();
        // The base stands on the floor.
        if link.frame > 0 && low.z <= self.floor && link.lowest(rod, &stance.carrier(link)) <= self.floor {
            return Some((Hit { solid: link.id, other: SolidRef::Floor }, None));
        }
        let found = bodies.iter().position(|b| {
            overlapping((&low, &high), (&b.low, &b.high))
                && link.spared != Some(b.id.0)
                && self.touches(link, rod, stance, b)
        });
        found.map(|k| (Hit { solid: link.id, other: self.name(bodies[k].id) }, Some(k)))
    }

    /// What a placed body is: a solid of an equipment, or a wall of the fence.
    pub(super) fn name(&self, (e, s): (usize, usize)) -> SolidRef {
        if e + 1 == self.stands.len() { SolidRef::Fence(s) } else { SolidRef::Equipment(e, s) }
    }

    /// Whether a link (held by `rod`) shares a point with a placed body.
    fn touches(&self, link: &Link, rod: &Rod, stance: Stance<'_>, other: &PlacedBody) -> bool {
        let seen = rod.seen_from(&other.pose);
        let part = &self.stands[other.id.0].parts[other.id.1];
        let mut verdict = seen.against_box(&other.bulk);
        if verdict != Verdict::Apart
            && let Part::Mesh { body, closed } = part
            && let Some(mesh) = body.shape.as_trimesh()
        {
            verdict = seen.against_mesh(mesh);
            // What a closed mesh does not touch but holds one point of, it holds all of.
            if verdict == Verdict::Apart && *closed && body.holds(&vector(&seen.a)) {
                return true;
            }
        }
        match verdict {
            Verdict::Apart => false,
            Verdict::Touching => true,
            Verdict::Unclear => {
                let (pose, frame) = (parry_pose(&other.pose), stance.carrier(link));
                let touch = |b: &Body| touches_part(b, &pose.inv_mul(&b.pose_in(&frame)), part, other);
                link.bodies.iter().any(touch) || swallows(link, &frame, part, &pose)
            }
        }
    }
}

/// Whether a closed link mesh holds a point of the other solid.
pub(super) fn swallows(link: &Link, frame: &Pose, part: &Part, pose: &pm::Pose) -> bool {
    let Some(shell) = &link.shell else { return false };
    let inside = match part {
        Part::Convex(body) | Part::Mesh { body, .. } => body.inside,
        Part::Leg { .. } => pm::Vector::ZERO,
    };
    shell.holds(&(shell.pose_in(frame).inverse() * (*pose * inside)))
}

/// parry's verdict, with the body of a link at `relative` in the frame of the other: bounds first, then
/// the shapes themselves.
fn touches_part(link: &Body, relative: &pm::Pose, part: &Part, other: &PlacedBody) -> bool {
    match part {
        Part::Convex(body) => {
            link.bounds_in(relative).intersects(&body.bounds) && touching(body, relative, link)
        }
        Part::Leg { .. } => intersecting(&Cuboid::new(vector(&other.bulk.half)), relative, &*link.shape),
        Part::Mesh { body, closed } => {
            let near = |s: &SharedShape| s.compute_aabb(relative).intersects(&body.bounds);
            let hits = |s: &SharedShape| near(s) && intersecting(&*body.shape, relative, &**s);
            let whole = std::slice::from_ref(&link.shape);
            let pieces = if link.pieces.is_empty() { whole } else { &link.pieces };
            // A closed mesh that is not touched but holds one point of the link holds all of it.
            pieces.iter().any(hits) || *closed && body.holds(&(*relative * link.inside))
        }
    }
}
