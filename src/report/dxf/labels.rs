//! Positions in plan at which texts cover neither objects nor each other.

use super::text::width;
use crate::cell::{Equipment, Placement, Role};
use crate::drawing::silhouette::{ABOVE, silhouette};
use crate::drawing::{Drawing, floor_corners};
use crate::geometry::{PlanePoint, bounding_box};
use crate::report::chart::labels::OccupiedBoxes;
use crate::units::wrapped;
use nalgebra::{Vector2, Vector3};

/// Number of straight lines that approximate an arc. The places along these lines count as occupied.
const ARC_PARTS: usize = 24;

/// Occupied places in plan, world frame, m.
pub struct Labels {
    taken: OccupiedBoxes,
    /// Height of texts, m.
    height: f64,
    /// Start of the next line of text in the column beside all objects: x and y in plan, m.
    column: Vector2<f64>,
}

impl Labels {
    /// Returns the places that the objects of a drawing and the lines of their dimensions occupy.
    ///
    /// The dimensions are left of and below the point `low`. The column of texts begins at `column`.
    pub fn new(
        drawing: &Drawing<'_>,
        operation: Option<usize>,
        height: f64,
        (low, column): (PlanePoint, Vector2<f64>),
    ) -> Self {
        let mut labels = Self { taken: OccupiedBoxes::default(), height, column };
        for (part, pose) in drawing.posed(operation, drawing.movement.frames(operation)) {
            let loops = silhouette(&part.mesh, &pose, &ABOVE).loops;
            labels.occupy(loops.iter().flatten().map(|p| (p.x, p.y)));
        }
        let (cell, layout) = (drawing.cell, &drawing.layout);
        let stands = cell.equipment.iter().map(|e| &e.footprint).zip(&layout.placements);
        for (footprint, at) in stands.chain([(&cell.robot.footprint, &layout.base)]) {
            labels.occupy(floor_corners(footprint, at).into_iter());
        }
        let placed = cell.equipment.iter().zip(&layout.placements);
        let placed: Vec<_> = placed.filter(|(equipment, _)| equipment.role == Role::Equipment).collect();
        for (equipment, at) in &placed {
            labels.occupy_yaw(equipment, at);
        }
        for at in placed.iter().map(|(_, at)| *at).chain([&layout.base]) {
            labels.occupy_line([(at.x, at.y), (at.x, low.1)].into_iter());
            labels.occupy_line([(at.x, at.y), (low.0, at.y)].into_iter());
        }
        for region in &drawing.regions {
            region.rings.iter().for_each(|ring| labels.occupy(ring.iter().map(|p| (p.x, p.y))));
        }
        for k in 0..drawing.fields.len() {
            let arrows = drawing.arrows(k, 0, crate::drawing::Component::Resultant);
            labels.occupy(arrows.iter().map(|arrow| (arrow.tip.x, arrow.tip.y)));
            let (nodes, radius) = (&drawing.fields[k].nodes, drawing.fields[k].radius());
            for at in nodes.iter().map(|node| node.position) {
                labels.occupy([(at.x - radius, at.y - radius), (at.x + radius, at.y + radius)].into_iter());
            }
        }
        for envelope in &drawing.envelopes {
            envelope.at_work.iter().for_each(|ring| labels.occupy_line(ring.iter().map(|p| (p.x, p.y))));
        }
        labels
    }

    fn occupy(&mut self, points: impl Iterator<Item = PlanePoint>) {
        if let Some((low, high)) = bounding_box(points) {
            self.taken.keep([low.0, low.1, high.0, high.1]);
        }
    }

    /// Occupies the lines and the arc of the angular dimension at the frame of a piece of equipment.
    fn occupy_yaw(&mut self, equipment: &Equipment, at: &Placement) {
        let (angle, radius) = (wrapped(at.yaw), yaw_radius(equipment, self.height));
        let on_circle = |turn: f64, radius: f64| (at.x + radius * turn.cos(), at.y + radius * turn.sin());
        self.occupy_line((0..=ARC_PARTS).map(|k| on_circle(angle * k as f64 / ARC_PARTS as f64, radius)));
        for side in [0.0, angle] {
            self.occupy_line([(at.x, at.y), on_circle(side, radius + self.height)].into_iter());
        }
    }

    /// Occupies the places along a polyline.
    fn occupy_line(&mut self, points: impl Iterator<Item = PlanePoint>) {
        let (mut before, beside) = (None::<PlanePoint>, 0.2 * self.height);
        for to in points {
            let from = before.replace(to).unwrap_or(to);
            let parts = ((to.0 - from.0).hypot(to.1 - from.1) / self.height).ceil().max(1.0);
            for k in 0..=parts as usize {
                let share = k as f64 / parts;
                let (x, y) = (from.0 + (to.0 - from.0) * share, from.1 + (to.1 - from.1) * share);
                self.taken.keep([x - beside, y - beside, x + beside, y + beside]);
            }
        }
    }

    /// Returns the left end of a text beside the box from `low` to `high`, and occupies the place of the
    /// text. Returns None if no place near the box is free.
    pub fn beside(&mut self, said: &str, (low, high): (PlanePoint, PlanePoint)) -> Option<Vector2<f64>> {
        let (wide, h) = (width(said, self.height), self.height);
        let middle = ((low.0 + high.0 - wide) / 2.0, (low.1 + high.1 - h) / 2.0);
        // `left` and `right` are the left ends of texts beside a vertical dimension line through the middle
        // of the box.
        let (left, right) = ((low.0 + high.0) / 2.0 - wide - 0.6 * h, (low.0 + high.0) / 2.0 + 0.6 * h);
        let steps = (0..8).map(|k| h * (0.7 + 1.2 * f64::from(k)));
        let places = steps.flat_map(|away| {
            [
                (middle.0, low.1 - away - h),
                (middle.0, high.1 + away),
                (high.0 + away, middle.1),
                (low.0 - away - wide, middle.1),
                (high.0 + away, high.1 + away),
                (high.0 + away, low.1 - away - h),
                (low.0 - away - wide, high.1 + away),
                (low.0 - away - wide, low.1 - away - h),
                (left, low.1 - away - h),
                (right, low.1 - away - h),
                (left, high.1 + away),
                (right, high.1 + away),
            ]
        });
        let mut places = places;
        let gap = 0.3 * h;
        let free = places.find(|(x, y)| self.taken.take([x - gap, y - gap, x + wide + gap, y + h + gap]));
        free.map(|(x, y)| Vector2::new(x, y))
    }

    /// Returns the left end of the next line of the column.
    pub fn next_line(&mut self) -> Vector2<f64> {
        let at = self.column;
        self.column.y -= 1.8 * self.height;
        at
    }
}

/// Returns the radius of the arc that dimensions the yaw of a piece of equipment, m.
pub fn yaw_radius(equipment: &Equipment, height: f64) -> f64 {
    let (length, width) = equipment.footprint.size;
    (length.max(width) / 2.0).max(6.0 * height)
}

/// Returns a point in plan at a height.
pub fn at_height(p: &Vector2<f64>, z: f64) -> Vector3<f64> {
    Vector3::new(p.x, p.y, z)
}
