//! Collision checking in three dimensions: the robot against equipment, fence, floor and itself.
//!
//! Broad phase: bounding boxes and bounding capsules. Narrow phase: closed forms for capsules, then parry3d
//! for the pairs that the closed forms cannot decide.

use super::arm_part::ArmPart;
use super::bodies::{CollisionBody, EquipmentSolid, intersecting, parry_pose, part, touching, vector};
use super::bounding_capsule::{BoundingCapsule, ContactVerdict, overlapping};
use super::bounding_sphere::{BoundingSphere, bounding_spheres};
use super::contact::{Hit, SolidRef};
use super::convex_decomposition::Remember;
use super::fence;
use super::placed_solids::{
    ContactMemory, EquipmentSolids, LinkFrames, LinkPoses, PlacedSolid, PlacedSolids,
};
use super::robot_solids::{self, RobotSolid};
use super::self_collision_pairs::{self, SelfCollisionPair};
use crate::cell::{Cell, Equipment, KeepOut, Layout, MAX_JOINTS, Placement, Shape};
use crate::pose::Pose;
use parry3d::bounding_volume::BoundingVolume;
use parry3d::math as pm;
use parry3d::shape::{Cuboid, SharedShape};

/// All solids of a cell, prepared once for collision checking.
///
/// Each robot solid is stored in two sizes. Checks against equipment, fence and floor use the solid enlarged
/// by the clearance plus 1e-7 m. Checks of the robot against itself use the solid enlarged by only 1e-7 m.
pub struct Scene {
    pub(super) links: Vec<RobotSolid>,
    /// Bounding spheres of the robot solids, in the order of `links`.
    pub(super) bounding_spheres: Vec<BoundingSphere>,
    /// Pairs of robot solids; each pair states whether a contact is allowed, and why.
    self_collision_pairs: Vec<SelfCollisionPair>,
    /// Pairs of robot solids that must not touch, as indices into `links`.
    pub(super) checked: Vec<(usize, usize)>,
    /// Solids of each piece of equipment; the last entry holds the walls of the fence and the keep-out boxes.
    pub(super) equipment: Vec<EquipmentSolids>,
    /// Number of walls in the last entry of `equipment`. The keep-out boxes follow the walls.
    walls: usize,
    /// Index of the frame after the last joint.
    pub(super) last: usize,
    /// Height of the floor in the world, m.
    pub(super) floor: f64,
    pub(super) clearance: f64,
    pub(super) enabled: bool,
}

impl Scene {
    /// Prepares the solids of a cell.
    pub fn new(cell: &Cell) -> Self {
        Self::remembering(cell, &mut |_, compute| compute())
    }

    /// Prepares the solids like [`Self::new`]. `remember` caches the convex decomposition of link meshes.
    pub fn remembering(cell: &Cell, remember: &mut Remember<'_>) -> Self {
        let links = robot_solids::all(cell, remember);
        let self_collision_pairs =
            if cell.collision { self_collision_pairs::find(cell, &links) } else { Vec::new() };
        let place = |id: SolidRef| links.iter().position(|l| l.id == id);
        let checked = self_collision_pairs.iter().filter(|p| p.allowed.is_none());
        let solids = |e: &Equipment| e.solids.iter().map(|s| part(&s.shape)).collect();
        let equipment = cell.equipment.iter().map(solids).zip(cell.start().placements);
        let mut fixed = fence::walls(cell);
        let walls = fixed.len();
        fixed.extend(cell.keep_out.iter().map(keep_out_box));
        let equipment = equipment.chain([(fixed, Placement::from_values([0.0; 4]))]).enumerate();
        Self {
            checked: checked.filter_map(|p| place(p.a).zip(place(p.b))).collect(),
            self_collision_pairs,
            equipment: equipment
                .map(|(e, (parts, at))| EquipmentSolids::new(e, parts, at, cell.floor))
                .collect(),
            walls,
            last: cell.robot.axes(),
            floor: cell.floor,
            clearance: cell.clearance,
            bounding_spheres: bounding_spheres(&links),
            enabled: cell.collision,
            links,
        }
    }

    /// Returns every pair of robot solids. The solids of tool and held parts count as robot solids.
    ///
    /// Each pair states whether a contact is allowed, and why. If self-collision is not checked, only pairs
    /// with the pedestal are returned.
    pub fn self_collision_pairs(&self) -> &[SelfCollisionPair] {
        &self.self_collision_pairs
    }

    /// Sets the poses of the equipment of a layout, and checks the robot base for contact with equipment,
    /// fence and keep-out boxes.
    pub fn place(&self, layout: &Layout, placed: &mut PlacedSolids) {
        placed.bodies.clear();
        let base = layout.base.pose();
        placed.base = (base != Pose::identity()).then_some(base);
        placed.base_hit = None;
        if !self.enabled {
            return;
        }
        for (e, solids) in self.equipment.iter().enumerate() {
            // The last entry, after all equipment, holds walls of the fence and keep-out boxes. They never
            // move.
            let at = layout.placements.get(e).unwrap_or(&solids.drawn);
            if *at == solids.drawn {
                placed.bodies.extend_from_slice(&solids.posed);
            } else {
                placed.bodies.extend(solids.at(e, at, self.floor));
            }
        }
        // The floor plan checks the pedestal against equipment.
        let base = self.links.iter().filter(|l| l.frame == 0 && !l.is_pedestal());
        let poses = LinkPoses { frames: &[Pose::IDENTITY; MAX_JOINTS + 1], base: placed.base.as_ref() };
        let mut hits = base.filter_map(|l| self.first_hit(l, &poses.capsule(l), poses, &placed.bodies));
        placed.base_hit = hits.next().map(|(hit, _)| hit);
        let first =
            placed.bodies.iter().position(|body| self.is_keep_out(body)).unwrap_or(placed.bodies.len());
        let mut pedestal = self.links.iter().filter(|l| l.is_pedestal());
        let in_keep_out = pedestal
            .find_map(|l| self.first_hit(l, &poses.capsule(l), poses, &placed.bodies[first..]))
            .map(|(hit, _)| hit);
        placed.base_hit = placed.base_hit.or(in_keep_out);
    }

    /// Returns the first contact of the robot with equipment, fence, floor or itself, if there is one.
    ///
    /// `frames` are the link frames in the robot base frame. `operation` selects the held parts to check; the
    /// robot holds nothing if `operation` is None.
    pub fn hit(&self, placed: &PlacedSolids, frames: &LinkFrames, operation: Option<usize>) -> Option<Hit> {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit;
        }
        let poses = LinkPoses { frames, base: placed.base.as_ref() };
        let capsules: Vec<BoundingCapsule> = self.links.iter().map(|l| poses.capsule(l)).collect();
        let whole = ArmPart::Whole;
        let outside = self.outside_hit(whole, &placed.bodies, poses, &capsules, operation);
        outside.map(|(_, (hit, _))| hit).or_else(|| self.own_hit(whole, frames, &capsules, operation))
    }

    /// Returns whether [`Self::hit`] finds no contact. `memory` speeds up the checks of a series of postures.
    pub fn is_free(
        &self,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        operation: Option<usize>,
        memory: &mut ContactMemory,
    ) -> bool {
        self.is_part_free(ArmPart::Whole, placed, frames, operation, memory)
    }

    /// Returns whether the given part of the arm touches nothing.
    ///
    /// The whole arm touches nothing if its two parts, before and after the last joint, touch nothing. A
    /// contact between the two parts counts for the part after the last joint only.
    pub fn is_part_free(
        &self,
        part: ArmPart,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        operation: Option<usize>,
        memory: &mut ContactMemory,
    ) -> bool {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit.is_none();
        }
        if self.touches_again(part, placed, frames, operation, memory) {
            return false;
        }
        let poses = LinkPoses { frames, base: placed.base.as_ref() };
        let ContactMemory { suspect, capsules } = memory;
        capsules.clear();
        capsules.extend(self.links.iter().map(|l| poses.capsule(l)));
        let outside = self.outside_hit(part, &placed.bodies, poses, capsules, operation);
        if let Some((k, (_, Some(body)))) = outside {
            *suspect = Some((k, body));
        }
        outside.is_none() && self.own_hit(part, frames, capsules, operation).is_none()
    }

    /// Returns whether the given part of the arm has the contact that was found last. The base of the robot
    /// counts as a part of the arm.
    ///
    /// This check is much faster than [`Self::is_part_free`]. Neighbouring postures often have the same
    /// contact.
    pub fn touches_again(
        &self,
        part: ArmPart,
        placed: &PlacedSolids,
        frames: &LinkFrames,
        operation: Option<usize>,
        memory: &ContactMemory,
    ) -> bool {
        if !self.enabled || placed.base_hit.is_some() {
            return placed.base_hit.is_some();
        }
        let poses = LinkPoses { frames, base: placed.base.as_ref() };
        let Some((k, body)) = memory.suspect else { return false };
        let (Some(link), Some(body)) = (self.links.get(k), placed.bodies.get(body)) else { return false };
        link.is_there(operation)
            && part.has(link.frame, self.last)
            && link.may_touch != Some(body.id.0)
            && self.touches(link, &poses.capsule(link), poses, body)
    }

    /// Returns the first moving robot solid that touches equipment, fence or floor.
    ///
    /// The index of the robot solid comes first, then its contact as returned by [`Self::first_hit`].
    /// Self-collisions are not checked.
    fn outside_hit(
        &self,
        part: ArmPart,
        bodies: &[PlacedSolid],
        poses: LinkPoses<'_>,
        capsules: &[BoundingCapsule],
        operation: Option<usize>,
    ) -> Option<(usize, (Hit, Option<usize>))> {
        let moving = self.links.iter().zip(capsules).enumerate();
        let is_asked = |l: &RobotSolid| l.frame > 0 && l.is_there(operation) && part.has(l.frame, self.last);
        let mut there = moving.filter(|(_, (l, _))| is_asked(l));
        there.find_map(|(k, (link, capsule))| Some((k, self.first_hit(link, capsule, poses, bodies)?)))
    }

    /// Returns the first self-collision of the robot in which the solid farther along the chain belongs to
    /// `part`.
    pub(super) fn own_hit(
        &self,
        part: ArmPart,
        frames: &LinkFrames,
        capsules: &[BoundingCapsule],
        operation: Option<usize>,
    ) -> Option<Hit> {
        let there = |k: usize| self.links[k].is_there(operation);
        let farther = |(a, b): &(usize, usize)| self.links[*a].frame.max(self.links[*b].frame);
        let mut pairs = self
            .checked
            .iter()
            .filter(|pair| there(pair.0) && there(pair.1) && part.has(farther(pair), self.last));
        let touch = |&&(i, j): &&(usize, usize)| {
            let (a, b) = (&self.links[i], &self.links[j]);
            a.is_near(&capsules[i], b, &capsules[j])
                && a.touches_near(a.carrier(frames), b, b.carrier(frames))
        };
        pairs.find(touch).map(|&(i, j)| Hit { solid: self.links[j].id, other: self.links[i].id })
    }

    /// Returns the first contact of a robot solid with floor, equipment or fence.
    ///
    /// The second value is the index of the placed solid; None for the floor.
    fn first_hit(
        &self,
        link: &RobotSolid,
        capsule: &BoundingCapsule,
        poses: LinkPoses<'_>,
        bodies: &[PlacedSolid],
    ) -> Option<(Hit, Option<usize>)> {
        let (low, high) = capsule.bounds();
        // The base may stand on the floor, so its contact with the floor is not a collision.
        if link.frame > 0 && low.z <= self.floor && link.lowest(capsule, &poses.carrier(link)) <= self.floor {
            return Some((Hit { solid: link.id, other: SolidRef::Floor }, None));
        }
        let found = bodies.iter().position(|b| {
            overlapping((&low, &high), (&b.low, &b.high))
                && link.may_touch != Some(b.id.0)
                && self.touches(link, capsule, poses, b)
        });
        found.map(|k| (Hit { solid: link.id, other: self.name(bodies[k].id) }, Some(k)))
    }

    /// Returns a reference to a placed solid: a solid of a piece of equipment, or a wall of the fence.
    pub(super) fn name(&self, (e, s): (usize, usize)) -> SolidRef {
        match e + 1 == self.equipment.len() {
            true if s < self.walls => SolidRef::Fence(s),
            true => SolidRef::KeepOut(s - self.walls),
            false => SolidRef::Equipment(e, s),
        }
    }

    /// Returns whether a placed solid is a keep-out box.
    pub(super) fn is_keep_out(&self, body: &PlacedSolid) -> bool {
        matches!(self.name(body.id), SolidRef::KeepOut(_))
    }

    /// Returns whether a robot solid, bounded by `capsule`, shares a point with a placed solid.
    fn touches(
        &self,
        link: &RobotSolid,
        capsule: &BoundingCapsule,
        poses: LinkPoses<'_>,
        other: &PlacedSolid,
    ) -> bool {
        let seen = capsule.seen_from(&other.pose);
        let part = &self.equipment[other.id.0].parts[other.id.1];
        let mut verdict = seen.against_box(&other.bounds);
        if verdict != ContactVerdict::Apart
            && let EquipmentSolid::Mesh { body, closed } = part
            && let Some(mesh) = body.shape.as_trimesh()
        {
            verdict = seen.against_mesh(mesh);
            // A body that does not touch the surface lies wholly inside the mesh if one point of the body
            // lies inside.
            if verdict == ContactVerdict::Apart && *closed && body.holds(&vector(&seen.a)) {
                return true;
            }
        }
        match verdict {
            ContactVerdict::Apart => false,
            ContactVerdict::Touching => true,
            ContactVerdict::Unclear => {
                let (pose, frame) = (parry_pose(&other.pose), poses.carrier(link));
                let touch =
                    |b: &CollisionBody| touches_part(b, &pose.inv_mul(&b.pose_in(&frame)), part, other);
                link.bodies.iter().any(touch) || swallows(link, &frame, part, &pose)
            }
        }
    }
}

/// Returns whether the closed mesh of a robot solid contains the point [`CollisionBody::inside`] of an
/// equipment solid.
///
/// For a leg, the tested point is the centre of the leg.
pub(super) fn swallows(link: &RobotSolid, frame: &Pose, part: &EquipmentSolid, pose: &pm::Pose) -> bool {
    let Some(shell) = &link.shell else { return false };
    let inside = match part {
        EquipmentSolid::Convex(body) | EquipmentSolid::Mesh { body, .. } => body.inside,
        EquipmentSolid::Leg { .. } => pm::Vector::ZERO,
    };
    shell.holds(&(shell.pose_in(frame).inverse() * (*pose * inside)))
}

/// Returns whether a body of a robot solid touches an equipment solid.
///
/// Bounding boxes are checked first, then the shapes by parry3d.
///
/// `relative` is the pose of the body in the frame of the equipment solid.
fn touches_part(
    link: &CollisionBody,
    relative: &pm::Pose,
    part: &EquipmentSolid,
    other: &PlacedSolid,
) -> bool {
    match part {
        EquipmentSolid::Convex(body) => {
            link.bounds_in(relative).intersects(&body.bounds) && touching(body, relative, link)
        }
        EquipmentSolid::Leg { .. } => {
            intersecting(&Cuboid::new(vector(&other.bounds.half)), relative, &*link.shape)
        }
        EquipmentSolid::Mesh { body, closed } => {
            let near = |s: &SharedShape| s.compute_aabb(relative).intersects(&body.bounds);
            let hits = |s: &SharedShape| near(s) && intersecting(&*body.shape, relative, &**s);
            let whole = std::slice::from_ref(&link.shape);
            let pieces = if link.pieces.is_empty() { whole } else { &link.pieces };
            // A link that does not touch the surface lies wholly inside the mesh if one point of the link
            // lies inside.
            pieces.iter().any(hits) || *closed && body.holds(&(*relative * link.inside))
        }
    }
}

/// Returns a keep-out box as a solid in the world frame.
fn keep_out_box(keep_out: &KeepOut) -> EquipmentSolid {
    let (low, high) = (keep_out.min, keep_out.max);
    let pose = Pose { translation: (low + high) / 2.0, ..Pose::IDENTITY };
    part(&Shape::Box { pose, size: high - low })
}
