//! Solids of the cell at the poses that one layout gives them, and the poses of the robot's links.

use super::bodies::{EquipmentSolid, plain};
use super::bounding_capsule::{BoundingBox, BoundingCapsule, CONTACT_MARGIN};
use super::contact::Hit;
use super::robot_solids::RobotSolid;
use crate::cell::{MAX_JOINTS, Placement};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Solids of the equipment posed for one layout; the memory is reused between layouts.
#[derive(Default)]
pub struct PlacedSolids {
    /// Pose of the robot base in the world; None if the base frame is the world frame.
    pub(super) base: Option<Pose>,
    pub(super) bodies: Vec<PlacedSolid>,
    /// First contact of the robot base with equipment or fence, if there is one. No posture can avoid this
    /// contact.
    pub(super) base_hit: Option<Hit>,
}

/// Memory that speeds up [`Scene::is_free`](super::Scene::is_free) over a series of postures.
///
/// The memory never changes the result of a check, so one memory can serve several layouts.
#[derive(Default)]
pub struct ContactMemory {
    /// Indices of the robot solid and of the placed solid in the last contact.
    ///
    /// This pair is checked first, because it most likely collides in the next posture, too.
    pub(super) suspect: Option<(usize, usize)>,
    /// Bounding capsules of the robot solids in the last posture, world frame.
    pub(super) capsules: Vec<BoundingCapsule>,
}

/// Solid of a piece of equipment, or wall of the fence, posed for a layout.
#[derive(Clone, Copy)]
pub(super) struct PlacedSolid {
    /// Index of the equipment, and index of the solid of that equipment.
    pub(super) id: (usize, usize),
    pub(super) pose: Pose,
    /// Low corner of an axis-aligned bounding box in the world; `high` is the high corner.
    ///
    /// The box is [`CONTACT_MARGIN`] larger than the bounding box of the solid, on every side.
    pub(super) low: Vector3<f64>,
    pub(super) high: Vector3<f64>,
    /// Bounding box in the frame of the solid. The box of a leg depends on the layout, because the length of
    /// the leg does.
    pub(super) bounds: BoundingBox,
}

/// All solids of one piece of equipment, ready for collision checking.
pub(super) struct EquipmentSolids {
    pub(super) parts: Vec<EquipmentSolid>,
    /// Placement in the cell file; an obstacle always has this placement.
    pub(super) drawn: Placement,
    /// Solids posed at `drawn`.
    pub(super) posed: Vec<PlacedSolid>,
}

/// Poses of the link frames in the frame of the robot base.
pub(super) type LinkFrames = [Pose; MAX_JOINTS + 1];

/// Poses of the link frames in the robot base frame (`frames`), and pose of that frame in the world (`base`).
///
/// `base` is None if the base frame is the world frame.
#[derive(Clone, Copy)]
pub(super) struct LinkPoses<'a> {
    pub(super) frames: &'a LinkFrames,
    pub(super) base: Option<&'a Pose>,
}

impl LinkPoses<'_> {
    /// Returns the pose, in the world, of the frame that carries a robot solid.
    #[inline]
    pub(super) fn carrier(&self, link: &RobotSolid) -> Pose {
        let frame = link.carrier(self.frames);
        self.base.map_or(*frame, |base| *base * *frame)
    }

    /// Returns the bounding capsule of a robot solid, in the world.
    #[inline]
    pub(super) fn capsule(&self, link: &RobotSolid) -> BoundingCapsule {
        let capsule = link.capsule(link.carrier(self.frames));
        self.base.map_or(capsule, |base| capsule.at(base))
    }
}

impl PlacedSolids {
    /// Converts the pose of a frame from the robot base frame to the world frame.
    #[inline]
    pub(super) fn in_world(&self, frame: &Pose) -> Pose {
        self.base.map_or(*frame, |base| base * *frame)
    }
}

impl PlacedSolid {
    fn new(id: (usize, usize), pose: Pose, bounds: BoundingBox) -> Self {
        let middle = pose.transform(&bounds.centre);
        let room = (pose.rotation.abs() * bounds.half).add_scalar(CONTACT_MARGIN);
        Self { id, pose, low: middle - room, high: middle + room, bounds }
    }
}

impl EquipmentSolids {
    pub(super) fn new(e: usize, parts: Vec<EquipmentSolid>, drawn: Placement, floor: f64) -> Self {
        let mut solids = Self { parts, drawn, posed: Vec::new() };
        solids.posed = solids.at(e, &drawn, floor).collect();
        solids
    }

    /// Returns the solids of the equipment with index `e`, posed at a placement.
    ///
    /// `floor` is the height (m) of the floor, where the legs end.
    pub(super) fn at(&self, e: usize, at: &Placement, floor: f64) -> impl Iterator<Item = PlacedSolid> {
        let frame = at.pose();
        self.parts.iter().enumerate().filter_map(move |(s, part)| match part {
            EquipmentSolid::Convex(body) | EquipmentSolid::Mesh { body, .. } => {
                let (centre, half) = (plain(body.bounds.center()), plain(body.bounds.half_extents()));
                let bounds = BoundingBox { centre, half, is_solid: body.shape.as_cuboid().is_some() };
                Some(PlacedSolid::new((e, s), frame * body.local, bounds))
            }
            EquipmentSolid::Leg { x, y, half, top } => {
                let height = frame.translation.z + top - floor;
                let centre = Vector3::new(*x, *y, top - height / 2.0);
                let pose = Pose { translation: frame.transform(&centre), ..frame };
                let half = Vector3::new(half.0, half.1, height / 2.0);
                let bounds = BoundingBox { centre: Vector3::zeros(), half, is_solid: true };
                (height > 0.0).then(|| PlacedSolid::new((e, s), pose, bounds))
            }
        })
    }
}
