//! Bounds of the motion of a cell's solids relative to the robot base, if equipment and base are misplaced.

use super::joint_enclosure::JointEnclosure;
use crate::cell::{Cell, Layout, Placement, PlacementTolerance, Rectangle};
use crate::clearance::{BoundingSphere, SolidMotion};
use crate::robot::{Chain, Frames};

/// Upper bounds of the motion of equipment, fence and floor relative to the robot base, m.
#[derive(Debug, Clone, Default)]
pub struct Misplacements {
    /// Bound of the motion of each piece of equipment; the last entry is the bound for the fence
    /// and the keep-out boxes.
    equipment: Vec<f64>,
    /// Bound of the motion of the floor below the robot.
    floor: f64,
}

impl Misplacements {
    /// Computes the bounds of a layout, reusing the memory of `self`. The robot solids stay within the radius
    /// `reach` (m) around the base.
    pub fn set(&mut self, cell: &Cell, layout: &Layout, reach: f64) {
        self.equipment.clear();
        for k in 0..cell.equipment.len() {
            let at = &layout.placements[k];
            let size = farthest(&cell.equipment[k].footprint);
            let (mut slid, mut turned, mut sum) = (0.0, 0.0, 0.0);
            let mut add = |body: &Placement, tolerance: &PlacementTolerance| {
                let [x, y, z, yaw] = tolerance.0;
                let lever = (at.x - body.x).hypot(at.y - body.y) + size;
                slid += x.hypot(y).hypot(z);
                turned += yaw;
                sum += yaw * lever;
            };
            let mut piece = Some(k);
            while let Some(body) = piece {
                add(&layout.placements[body], &cell.equipment[body].tolerance);
                piece = cell.equipment[body].on;
            }
            add(&layout.base, &cell.base_tolerance);
            // The lever arms grow by at most the motion of the other bodies.
            self.equipment.push((slid + sum) * (1.0 + turned));
        }
        let [x, y, z, yaw] = cell.base_tolerance.0;
        // The fence may have any size, but only its points within reach count.
        self.equipment.push(x.hypot(y).hypot(z) + yaw * reach);
        self.floor = z;
    }

    /// Returns the bound of the motion of a piece of equipment, m. The index after the last piece stands for
    /// fence and keep-out boxes, and None stands for the floor.
    pub fn of(&self, equipment: Option<usize>) -> f64 {
        equipment.map_or(self.floor, |k| self.equipment[k])
    }
}

/// Motion of all solids while the arm follows the target of one operation.
pub struct PostureMotion<'a> {
    pub chain: &'a Chain,
    /// Link frames of the nominal posture.
    pub frames: &'a Frames,
    pub joints: &'a JointEnclosure,
    /// Bounding spheres of the robot solids.
    pub spheres: &'a [BoundingSphere],
    pub misplacements: &'a Misplacements,
    pub cell: &'a Cell,
    pub layout: &'a Layout,
    /// Index of the equipment on which the operation happens.
    pub equipment: usize,
}

impl PostureMotion<'_> {
    fn displacement(&self, link: usize, first: usize) -> f64 {
        let sphere = &self.spheres[link];
        let centre = self.frames.links[sphere.frame].transform(&sphere.centre);
        let ball = (&centre, sphere.radius);
        self.joints.displacement(self.chain, self.frames, ball, (first, sphere.frame))
    }
}

impl SolidMotion for PostureMotion<'_> {
    fn of_link(&self, link: usize) -> f64 {
        if self.spheres[link].frame == 0 { 0.0 } else { self.displacement(link, 0) }
    }

    fn of_equipment(&self, equipment: Option<usize>) -> f64 {
        self.misplacements.of(equipment)
    }

    fn between(&self, link: usize, equipment: usize) -> Option<f64> {
        let sphere = &self.spheres[link];
        let follows = sphere.frame == self.chain.axes() && self.cell.rides_on(self.equipment, equipment);
        follows.then(|| {
            // The TCP follows the equipment exactly, so the tool only rotates about the TCP.
            let centre = self.frames.links[sphere.frame].transform(&sphere.centre);
            let lever = (centre - self.frames.tcp.translation).norm() + sphere.radius;
            let tcp = self.layout.base.pose().transform(&self.frames.tcp.translation);
            // Relative to a carrier, the equipment moves by its own tolerances and by the tolerances of the
            // pieces in between.
            let (mut piece, mut slid, mut turned, mut sum) = (self.equipment, 0.0, 0.0, 0.0);
            while piece != equipment {
                let (at, [x, y, z, yaw]) =
                    (&self.layout.placements[piece], self.cell.equipment[piece].tolerance.0);
                slid += x.hypot(y).hypot(z);
                turned += yaw;
                sum += yaw * ((tcp.x - at.x).hypot(tcp.y - at.y) + lever);
                piece = self.cell.equipment[piece].on.unwrap_or(equipment);
            }
            self.joints.tool_turn * lever + (slid + sum) * (1.0 + turned)
        })
    }

    fn between_links(&self, link: usize, other: usize) -> f64 {
        self.displacement(link, self.spheres[other].frame)
    }
}

/// Returns the distance from the origin to the farthest point of a rectangle, m.
fn farthest(r: &Rectangle) -> f64 {
    (r.centre.0.abs() + r.size.0 / 2.0).hypot(r.centre.1.abs() + r.size.1 / 2.0)
}
