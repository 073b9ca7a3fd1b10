//! Layouts as plain data for pictures: solids, error maps, envelopes and motion. Positions are in the world
//! frame, except the meshes of parts, which are in the frame of their carrier. Units are m and rad.
//!
//! A [`Drawing`] is made once from an [`Assessment`]. Every picture, page and CAD file is rendered from that
//! drawing, so all of them show the same content.

mod arrows;
mod envelope;
mod field;
mod floor;
mod mesh;
mod movement;
mod node_glyph;
mod parts;
mod regions;
pub mod round_numbers;
pub mod silhouette;

pub use arrows::{Arrow, Component};
pub use envelope::{Rings, rings};
pub use field::{ErrorView, Field, FieldNode, ViewedErrors, lenses};
pub use floor::floor_corners;
pub use mesh::Mesh;
pub use movement::{Movement, MovementStop};
pub use node_glyph::{GlyphRing, GlyphStroke, GlyphTone, NodeGlyph, node_glyph};
pub use parts::{DrawnPart, PartCarrier, PartKind, fence_walls, pedestal};
pub use regions::DrawnRegion;

use crate::assess::Assessment;
use crate::cell::{Cell, Layout};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Layout in the form in which pictures show it.
pub struct Drawing<'a> {
    pub cell: &'a Cell,
    /// Name that distinguishes this layout from others, for example `start` or `best`.
    pub name: String,
    pub layout: Layout,
    pub is_feasible: bool,
    /// Whether every limit of the operations is met.
    pub meets_limits: bool,
    /// Pose of the robot base in the world.
    pub base: Pose,
    /// Height of the floor in the world frame, m.
    pub floor: f64,
    pub parts: Vec<DrawnPart>,
    /// Combinations of model and reading, one for each entry of [`Field::takes`]. The first is the
    /// combination of the cell.
    pub lenses: Vec<ErrorView>,
    /// Error map of every operation.
    pub fields: Vec<Field>,
    /// Regions of the robot base and of equipment. The region of a piece consists of the positions of its
    /// frame origin at which the layout is feasible. Each region is drawn at the height of this frame origin.
    /// The list is empty if no regions were computed.
    pub regions: Vec<DrawnRegion>,
    /// Working envelope of each operation; empty if [`Detail::envelopes`] is false.
    pub envelopes: Vec<Rings>,
    /// Motion from home through all spots and back to home.
    pub movement: Movement,
}

/// Level of detail of a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Detail {
    /// Whether errors are computed under every model and reading that the cell permits. Otherwise, they are
    /// computed only under the model and reading of the cell.
    pub lenses: bool,
    pub envelopes: bool,
    /// Approximate upper limit of the number of nodes of an error map. A map with more nodes keeps every k-th
    /// node along both axes. The stride k is the least integer for which the number of nodes divided by k^2
    /// is within the limit.
    pub nodes: usize,
}

impl Detail {
    /// Level of detail with envelopes and about 4000 nodes per error map. Errors are computed under every
    /// permitted model and reading.
    pub const FULL: Self = Self { lenses: true, envelopes: true, nodes: 4000 };
    /// Level of detail with envelopes and all nodes. Errors are computed only under the model and reading of
    /// the cell.
    pub const PLAIN: Self = Self { lenses: false, envelopes: true, nodes: usize::MAX };
}

impl<'a> Drawing<'a> {
    /// Makes the drawing of an assessed layout.
    ///
    /// # Errors
    ///
    /// Returns the reason if the cell cannot be evaluated under a model or reading that
    /// [`Detail::lenses`] requests.
    pub fn new(a: &Assessment<'a>, detail: &Detail) -> Result<Self, String> {
        let (lenses, fields) = field::fields(a, detail)?;
        let envelopes = if detail.envelopes {
            (0..a.maps.len()).map(|operation| rings(a, operation)).collect()
        } else {
            Vec::new()
        };
        Ok(Self {
            cell: a.cell,
            name: a.label.clone(),
            layout: a.layout.clone(),
            is_feasible: a.evaluation.objective.is_some(),
            meets_limits: a.meets_requirements(),
            base: a.layout.base.pose(),
            floor: a.cell.floor,
            parts: parts::parts(a),
            lenses,
            fields,
            regions: regions::regions(a),
            envelopes,
            movement: Movement::new(a),
        })
    }

    /// Returns the pose of a part in the world frame. `frames` are the robot's link frames in its present
    /// posture, also in the world frame.
    pub fn pose_of(&self, part: &DrawnPart, frames: &[Pose]) -> Pose {
        match part.carrier {
            PartCarrier::World(pose) => pose,
            PartCarrier::Link(k) => frames.get(k).copied().unwrap_or(self.base),
        }
    }

    /// Returns the parts that are visible at an operation, with their poses in the world frame. `frames` are
    /// the robot's link frames.
    ///
    /// If `operation` is None, only the parts that are always visible are returned.
    pub fn posed<'d>(
        &'d self,
        operation: Option<usize>,
        frames: &'d [Pose],
    ) -> impl Iterator<Item = (&'d DrawnPart, Pose)> {
        let seen = move |part: &&DrawnPart| part.operation.is_none_or(|o| Some(o) == operation);
        self.parts.iter().filter(seen).map(move |part| (part, self.pose_of(part, frames)))
    }

    /// Returns a box (world frame, m) that contains the base origin and all parts that are always visible.
    /// The robot is at home.
    pub fn extent(&self) -> (Vector3<f64>, Vector3<f64>) {
        let home = self.movement.home();
        let base = (self.base.translation, self.base.translation);
        let corners = self.posed(None, home).filter_map(|(part, pose)| {
            let (lo, hi) = part.mesh.extent()?;
            let middle = pose.transform(&((lo + hi) / 2.0));
            let half = pose.rotation.abs() * ((hi - lo) / 2.0);
            Some((middle - half, middle + half))
        });
        corners.fold(base, |(lo, hi), (a, b)| (lo.inf(&a), hi.sup(&b)))
    }
}
