//! What there is to see of a layout: solids, error map, envelope, motion. World frame, m and rad.
//!
//! A [`Drawing`] is plain data made once from an [`Assessment`]; every picture, page and CAD file is
//! rendered from it, so that all of them show the same.

mod arrows;
mod envelope;
mod field;
mod floor;
mod mesh;
mod movement;
mod node_glyph;
mod parts;
pub mod round_numbers;

pub use arrows::{Arrow, Component};
pub use envelope::{Rings, rings};
pub use field::{Field, Lens, Node, Take, lenses};
pub use floor::floor_corners;
pub use mesh::Mesh;
pub use movement::{Movement, Stop};
pub use node_glyph::{GlyphRing, GlyphStroke, GlyphTone, NodeGlyph, node_glyph};
pub use parts::{Carrier, Kind, Part};

use crate::assess::Assessment;
use crate::cell::{Cell, Layout};
use crate::pose::Pose;
use nalgebra::Vector3;

/// One layout as it looks.
pub struct Drawing<'a> {
    pub cell: &'a Cell,
    /// What it is called among others: start, best.
    pub name: String,
    pub layout: Layout,
    /// Robot base in the world.
    pub base: Pose,
    /// Height of the floor, m.
    pub floor: f64,
    pub parts: Vec<Part>,
    /// Who looks: the model and reading of each take of a field. The first is that of the cell.
    pub lenses: Vec<Lens>,
    /// The error map of every operation.
    pub fields: Vec<Field>,
    /// Where the arm reaches with its tool as in each operation; empty if not asked for.
    pub envelopes: Vec<Rings>,
    /// From home to every spot and back.
    pub movement: Movement,
}

/// How much of it is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Detail {
    /// Every model and reading that has an answer, not that of the cell alone.
    pub lenses: bool,
    pub envelopes: bool,
    /// Of a field with more nodes only every second, third, ... in both directions is kept.
    pub nodes: usize,
}

impl Detail {
    pub const FULL: Self = Self { lenses: true, envelopes: true, nodes: 4000 };
    pub const PLAIN: Self = Self { lenses: false, envelopes: true, nodes: usize::MAX };
}

impl<'a> Drawing<'a> {
    /// # Errors
    /// Why the robot cannot be used in another reading.
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
            base: a.layout.base.pose(),
            floor: a.cell.floor,
            parts: parts::parts(a),
            lenses,
            fields,
            envelopes,
            movement: Movement::new(a),
        })
    }

    /// Where a part is, the robot in the posture whose frames (world) are given.
    pub fn pose_of(&self, part: &Part, frames: &[Pose]) -> Pose {
        match part.carrier {
            Carrier::World(pose) => pose,
            Carrier::Link(k) => frames.get(k).copied().unwrap_or(self.base),
        }
    }

    /// The parts that are seen while the tool is at an operation (None: at none), each with its place.
    pub fn posed<'d>(
        &'d self,
        operation: Option<usize>,
        frames: &'d [Pose],
    ) -> impl Iterator<Item = (&'d Part, Pose)> {
        let seen = move |part: &&Part| part.operation.is_none_or(|o| Some(o) == operation);
        self.parts.iter().filter(seen).map(move |part| (part, self.pose_of(part, frames)))
    }

    /// Low and high corner of all that stands and moves, the robot at home.
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
