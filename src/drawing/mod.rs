//! What there is to see of a layout: solids, error map, envelope, motion. World frame, m and rad.
//!
//! A [`Drawing`] is plain data made once from an [`Assessment`]; every picture, page and CAD file is
//! rendered from it, so that all of them show the same.

mod arrows;
mod envelope;
mod field;
mod mesh;
mod movement;
mod parts;

pub use arrows::{Arrow, Component};
pub use envelope::{Rings, rings};
pub use field::{Field, Lens, Node, Take, lenses};
pub use mesh::Mesh;
pub use movement::{Movement, Stop};
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

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
mod tests {
    use super::*;
    use crate::layout::Workcell;

    fn workcell(name: &str) -> Workcell {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/cells/");
        let mut read = |path: &str| std::fs::read(format!("{folder}{path}")).map_err(|e| e.to_string());
        Workcell::new(crate::files::load(name, &mut read).unwrap().cell).unwrap()
    }

    #[test]
    fn a_drawing_shows_what_the_assessment_says() {
        let workcell = workcell("hitachi_paper.toml");
        let a = Assessment::new("start", &workcell, workcell.cell.start());
        let drawing = Drawing::new(&a, &Detail::FULL).unwrap();
        let field = &drawing.fields[0];
        assert_eq!((field.nodes.len(), field.size, field.usable().count()), (99, (11, 9), 80));
        assert_eq!(drawing.lenses.len(), field.takes.len());
        assert_eq!(drawing.lenses.len(), 9, "{:?}", drawing.lenses);
        // The first lens is the cell's own.
        let own = field.range(0, field.sense).unwrap().0;
        assert!((own - a.maps[0].value.unwrap()).abs() < 1e-15);
        // The worst case is never less than the signed sample, node by node.
        let lens = |reading| drawing.lenses.iter().position(|l| l.reading == reading).unwrap();
        let [signed, worst] = [crate::cell::Reading::Signed, crate::cell::Reading::WorstCase].map(lens);
        for k in field.usable() {
            let value = |take: usize| field.takes[take].values[field.sense][k].unwrap();
            assert!(value(worst) >= value(signed), "node {k}");
        }
        assert!(!drawing.envelopes[0].at_work.is_empty() && !drawing.envelopes[0].around.is_empty());
    }

    #[test]
    fn the_robot_moves_from_home_to_its_spots_and_back() {
        let workcell = workcell("hitachi_cell.toml");
        let a = Assessment::new("start", &workcell, workcell.cell.start());
        let drawing = Drawing::new(&a, &Detail::PLAIN).unwrap();
        let movement = &drawing.movement;
        assert_eq!(movement.frames.len(), movement.times.len());
        assert!(movement.times.windows(2).all(|t| t[0] < t[1]));
        let spots = (0..a.maps.len()).filter(|k| a.spot(*k).is_some()).count();
        assert_eq!(movement.stops.len(), spots + 2);
        for k in 0..a.maps.len() {
            let Some((node, _)) = a.spot(k) else { continue };
            let tcp = movement.at(k).unwrap().last().unwrap();
            assert!((tcp.translation - node.position).norm() < 1e-9);
        }
        // No joint frame leaps from one picture to the next.
        for pair in movement.frames.windows(2) {
            let far = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a.translation - b.translation).norm());
            assert!(far.fold(0.0, f64::max) < 0.25);
        }
        assert_eq!(drawing.lenses.len(), 1);
    }

    #[test]
    fn a_large_map_is_thinned_and_keeps_its_spot() {
        let workcell = workcell("hitachi_cell.toml");
        let a = Assessment::new("start", &workcell, workcell.cell.start());
        let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 30 }).unwrap();
        for (field, map) in drawing.fields.iter().zip(&a.maps) {
            assert!(field.every > 1 && field.nodes.len() <= 30);
            assert_eq!(field.nodes.len(), field.size.0 * field.size.1);
            assert_eq!(field.spot, map.best_node().map(|n| n.position));
        }
    }

    /// The bars of a robot without solids join the origins of its frames.
    #[test]
    fn every_robot_is_to_be_seen() {
        for name in ["ur_cell.toml", "panda_cell.toml", "scara_cell.toml", "track_cell.toml"] {
            let mut workcell = workcell(name);
            let (solids, tools) = (workcell.cell.robot.solids.len(), workcell.cell.robot.tool_solids);
            workcell.cell.robot.solids.drain(..solids - tools);
            let a = Assessment::new("start", &workcell, workcell.cell.start());
            let parts = parts::parts(&a);
            let robot: Vec<_> = parts.iter().filter(|p| p.kind == Kind::Robot).collect();
            assert!(robot.len() > 2, "{name}");
            assert_eq!(parts.iter().filter(|p| p.kind == Kind::Tool).count(), tools, "{name}");
        }
    }
}
