//! Layout of a cell with its solids posed: the context in which postures are judged.

use super::demand::Demand;
use super::held_posture::HeldPosture;
use super::mapper::Mapper;
use super::outcome::Spot;
use crate::cell::{Attitude, JointVector, Layout, Placement};
use crate::clearance::PlacedSolids;
use crate::motion::OperationPosture;
use crate::reach::ToolAttitudes;
use nalgebra::{Matrix3, Vector3};

/// Layout of a cell with its solids posed.
///
/// All functions that judge postures take layout and solids as one object. The solids thus always belong to
/// the layout.
pub struct PlacedLayout<'a> {
    pub(super) mapper: &'a Mapper,
    pub(super) layout: &'a Layout,
    pub(super) solids: PlacedSolids,
    /// Demand that every posture must meet at all misplacements; None if misplacements are not considered.
    pub(super) demand: Option<Demand<'a>>,
    /// Posture that each operation keeps, for spots with the branch index [`crate::reach::CONTINUED`].
    pub(super) kept: &'a [Option<HeldPosture>],
}

/// Surface of one operation in one layout, in the robot base frame.
pub struct PlacedSurface<'a> {
    pub operation: usize,
    /// Pose of the equipment in the robot base frame.
    pub at: Placement,
    pub attitude: &'a Attitude,
    /// Rotation from world axes to the robot base frame.
    pub world: Matrix3<f64>,
}

impl<'a> PlacedLayout<'a> {
    /// Sets the poses of the solids of a layout.
    pub fn new(mapper: &'a Mapper, layout: &'a Layout) -> Self {
        Self::reusing(mapper, layout, PlacedSolids::default())
    }

    /// Sets the poses of the solids of a layout, and reuses the memory of another layout's solids.
    pub fn reusing(mapper: &'a Mapper, layout: &'a Layout, mut solids: PlacedSolids) -> Self {
        mapper.scene.place(layout, &mut solids);
        Self { mapper, layout, solids, demand: None, kept: &[] }
    }

    /// Returns this layout with a demand that every posture must meet at all misplacements. If `demand` is
    /// None, misplacements are not considered.
    #[must_use]
    pub fn demanding(self, demand: Option<Demand<'a>>) -> Self {
        Self { demand, ..self }
    }

    /// Returns this layout with kept postures: operation k keeps the posture `kept[k]`. The entry is None if
    /// the operation keeps no posture.
    ///
    /// For a spot with the branch index [`crate::reach::CONTINUED`], the numeric solver computes the posture
    /// at the target in this layout. The solver starts at the kept posture.
    #[must_use]
    pub fn keeping(self, kept: &'a [Option<HeldPosture>]) -> Self {
        Self { kept, ..self }
    }

    /// Returns the demand that every posture must meet at all misplacements; None if misplacements are not
    /// considered.
    pub fn demand(&self) -> Option<Demand<'a>> {
        self.demand
    }

    /// Returns the layout.
    pub fn layout(&self) -> &'a Layout {
        self.layout
    }

    /// Returns the solids, so that the next layout can reuse their memory.
    pub fn into_solids(self) -> PlacedSolids {
        self.solids
    }

    /// Returns the surface of an operation.
    pub(super) fn surface(&self, operation: usize) -> PlacedSurface<'a> {
        let (mapper, layout) = (self.mapper, self.layout);
        let at = layout.placements[mapper.setups[operation].equipment].seen_from(&layout.base);
        let (attitude, world) = (&layout.attitudes[operation], layout.base.from_world());
        PlacedSurface { operation, at, attitude, world }
    }

    /// Computes the joint coordinates of an operation at its spot; None if the branch of the spot does not
    /// exist in this layout.
    pub fn operation_posture(&self, operation: usize, spot: &Spot) -> Option<OperationPosture> {
        let surface = self.surface(operation);
        let (target, attitudes) = (self.target(&surface, spot.node), self.attitudes(&surface));
        let kept = self.kept_posture(operation);
        let joints = self.mapper.branch_at(&target, &attitudes, spot.branch, kept.as_ref())?.joints;
        Some(OperationPosture { operation, joints })
    }

    /// Returns the least distance, m, from the robot at `joints` to everything that it must not touch during
    /// an operation.
    ///
    /// Distances above `max` count as `max`.
    pub fn distance_at_work(&self, operation: usize, joints: &JointVector, max: f64) -> f64 {
        let (frames, equipment) = (self.mapper.frames(joints), self.mapper.setups[operation].equipment);
        self.mapper.scene.distance_at_work(&self.solids, &frames.links, operation, equipment, max).distance
    }

    /// Returns the posture that an operation keeps; None if the operation keeps no posture.
    pub(super) fn kept_posture(&self, operation: usize) -> Option<HeldPosture> {
        self.kept.get(operation).copied().flatten()
    }

    /// Prepares the attitudes of an operation for its surface.
    pub(super) fn attitudes(&self, surface: &PlacedSurface<'_>) -> ToolAttitudes {
        self.mapper.arm.inverse.tool_attitudes(surface.attitude, surface.at.yaw)
    }

    /// Returns the TCP target of a node, in the base frame, m.
    pub(super) fn target(&self, surface: &PlacedSurface<'_>, node: usize) -> Vector3<f64> {
        self.mapper.setups[surface.operation].grid.target(&surface.at, node)
    }
}
