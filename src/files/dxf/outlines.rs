//! Closed outlines of the named layers of a drawing, in m.

use super::DxfFault;
use super::chords::polygon;
use super::drawing::PlanDrawing;
use super::entities::{PathVertex, PlanPath};
use super::expand::{Expanded, FlatShape, PlacedShape, PlaneMap, expanded};
use super::joined::{JOINT, OpenPath, joined};
use crate::files::fault::shown;
use crate::files::polygon::crossing_edges;
use crate::geometry::{PlanePoint, polygon_area, turn};
use nalgebra::Vector2;
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of outlines of a plan. Every posture is checked against the bodies of each outline, so the
/// number is limited.
const MAX_OUTLINES: usize = 200;

/// Largest number of corners of an outline.
const MAX_CORNERS: usize = 400;

/// Largest distance, m, at which two corners count as one, or at which a corner counts as lying on the line
/// between its neighbours.
const ROUNDING: f64 = 1e-9;

/// Least area of an outline, m2.
const MIN_AREA: f64 = 1e-8;

/// Outline of a floor plan, with its layer as the drawing writes it, and the line of the file at which
/// it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct FloorOutline {
    pub layer: String,
    pub line: usize,
    pub shape: OutlineShape,
}

/// Shape of an outline in the frame of the drawing, m.
#[derive(Debug, Clone, PartialEq)]
pub enum OutlineShape {
    /// Corners of a polygon that does not cross itself, anticlockwise.
    Polygon(Vec<PlanePoint>),
    Circle {
        centre: PlanePoint,
        radius: f64,
    },
}

/// Outlines of a drawing, with its faults and warnings.
#[derive(Debug, Default)]
pub struct Outlines {
    pub found: Vec<FloorOutline>,
    pub errors: Vec<DxfFault>,
    pub warnings: Vec<DxfFault>,
}

/// Returns the outlines on `layers` (names in upper case).
///
/// `unit` is the length of one unit of the drawing, m. Straight lines on the outer side of the outline
/// replace every arc. The lines are at most `tolerance` (m) away from the arc.
pub fn outlines(drawing: &PlanDrawing, layers: &BTreeSet<String>, unit: f64, tolerance: f64) -> Outlines {
    let mut all = Outlines::default();
    let Expanded { shapes, mut ignored } = match expanded(drawing, layers, unit) {
        Ok(expanded) => expanded,
        Err(fault) => return Outlines { errors: vec![fault], ..all },
    };
    let name = |layer: &str| drawing.layers.get(layer).map_or(layer, String::as_str).to_string();
    let mut open: BTreeMap<String, Vec<OpenPath>> = BTreeMap::new();
    for PlacedShape { shape, map, layer, line } in shapes {
        match shape {
            FlatShape::Circle { centre, radius } if map.keeps_arcs() => {
                let (at, radius) = (map.of(&centre), radius * map.stretch());
                all.circle(name(&layer), line, (at.x, at.y), radius);
            }
            FlatShape::Circle { centre, radius } => {
                let side = |x: f64| PathVertex { at: centre + Vector2::new(x, 0.0), bulge: 1.0 };
                all.closed(name(&layer), line, &[side(radius), side(-radius)], &map, tolerance);
            }
            FlatShape::Path(path) if path.is_closed => {
                all.closed(name(&layer), line, &path.vertices, &map, tolerance);
            }
            FlatShape::Path(path) if map.keeps_arcs() || path.vertices.iter().all(|v| v.bulge == 0.0) => {
                open.entry(layer).or_default().extend(moved(&path, &map, line));
            }
            FlatShape::Path(_) => {
                let what = "ARC in a block that is scaled unevenly".to_string();
                ignored.entry((layer, what)).or_insert((0, line)).0 += 1;
            }
        }
    }
    for (layer, paths) in open {
        let (closed, left) = joined(paths);
        for (path, line) in closed {
            let metres = PlaneMap::scaling(1.0);
            all.closed(name(&layer), line, &path.vertices, &metres, tolerance);
        }
        if let Some(first) = left.first() {
            let entry = ignored.entry((layer, "open line".to_string())).or_insert((0, first.line));
            entry.0 += left.len();
        }
    }
    for ((layer, what), (count, line)) in ignored {
        let times = if count == 1 { String::new() } else { format!(" ({count} of them)") };
        let message =
            format!("layer `{}`: {} is not read as an obstacle{times}", shown(&name(&layer)), shown(&what));
        all.warnings.push(DxfFault::new(line, message, CLOSED));
    }
    all.limit();
    all.warn_of_nested();
    all
}

const CLOSED: &str =
    "draw obstacles as closed polylines, circles, or lines and arcs whose ends meet within 0.01 mm";

/// Returns an open path in m; None if the path is not longer than [`JOINT`].
fn moved(path: &PlanPath, map: &PlaneMap, line: usize) -> Option<OpenPath> {
    let sign = if map.mirrors() { -1.0 } else { 1.0 };
    let vertex = |v: &PathVertex| PathVertex { at: map.of(&v.at), bulge: sign * v.bulge };
    let vertices: Vec<PathVertex> = path.vertices.iter().map(vertex).collect();
    let length: f64 = vertices.windows(2).map(|v| (v[1].at - v[0].at).norm()).sum();
    (length > JOINT).then_some(OpenPath { vertices, line })
}

impl Outlines {
    fn circle(&mut self, layer: String, line: usize, centre: PlanePoint, radius: f64) {
        if radius * radius < MIN_AREA {
            return self.errors.push(no_area(line, &layer));
        }
        self.found.push(FloorOutline { layer, line, shape: OutlineShape::Circle { centre, radius } });
    }

    /// Adds a closed outline. `map` converts its vertices to the frame of the drawing, m.
    fn closed(
        &mut self,
        layer: String,
        line: usize,
        vertices: &[PathVertex],
        map: &PlaneMap,
        tolerance: f64,
    ) {
        let shown_layer = shown(&layer);
        let fault = |message: String, help: &str| DxfFault::new(line, message, help);
        // An outline scaled by 0 has no area, so the tolerance does not matter. The lower limit of the
        // divisor avoids a division by 0.
        let local = tolerance / map.stretch().max(f64::MIN_POSITIVE);
        let corners = match polygon(vertices, local) {
            Ok(corners) => cleaned(corners.iter().map(|c| map.of(c)).collect()),
            Err(why) => {
                let message = format!("layer `{shown_layer}`: {why}");
                return self.errors.push(fault(message, "raise `tolerance_mm`"));
            }
        };
        let area = polygon_area(&corners.iter().map(|c| (c.x, c.y)).collect::<Vec<_>>());
        if corners.len() < 3 || area.abs() < MIN_AREA {
            return self.errors.push(no_area(line, &layer));
        }
        if corners.len() > MAX_CORNERS {
            let message = format!(
                "layer `{shown_layer}`: an outline has {} corners, more than {MAX_CORNERS}",
                corners.len()
            );
            return self.errors.push(fault(message, "raise `tolerance_mm`, or simplify the outline"));
        }
        if crossing_edges(&corners).is_some() {
            let message = format!("layer `{shown_layer}`: an outline crosses or touches itself");
            return self.errors.push(fault(message, "redraw it as one line round the obstacle"));
        }
        let mut corners: Vec<PlanePoint> = corners.iter().map(|c| (c.x, c.y)).collect();
        if area < 0.0 {
            corners.reverse();
        }
        self.found.push(FloorOutline { layer, line, shape: OutlineShape::Polygon(corners) });
    }

    /// Records an error if there are more than [`MAX_OUTLINES`] outlines, and drops the rest.
    fn limit(&mut self) {
        if let Some(beyond) = self.found.get(MAX_OUTLINES) {
            let message = format!("the layers have {} outlines, more than {MAX_OUTLINES}", self.found.len());
            let help = "name fewer layers, or delete outlines far from the robot";
            self.errors.push(DxfFault::new(beyond.line, message, help));
            self.found.truncate(MAX_OUTLINES);
        }
    }

    /// Warns of an outline within another outline. The whole inside of the outer outline is solid, even if
    /// the two lines are meant as the faces of a wall.
    fn warn_of_nested(&mut self) {
        let inside = |k: usize, j: usize| k != j && self.found[j].holds(self.found[k].first());
        let count = self.found.len();
        let nested = (0..count).find_map(|k| (0..count).find(|j| inside(k, *j)).map(|j| (k, j)));
        if let Some((k, j)) = nested {
            let (inner, outer) = (&self.found[k], &self.found[j]);
            let message = format!(
                "layer `{}`: an outline lies within the outline of layer `{}` at line {}; the whole \
                area within the outer outline is solid",
                shown(&inner.layer),
                shown(&outer.layer),
                outer.line + 1
            );
            let help =
                "draw a wall as one closed outline round its section, not as an inner and an outer line";
            self.warnings.push(DxfFault::new(inner.line, message, help));
        }
    }
}

impl FloorOutline {
    /// Returns a point of the outline.
    fn first(&self) -> PlanePoint {
        match &self.shape {
            OutlineShape::Polygon(corners) => corners[0],
            OutlineShape::Circle { centre, .. } => *centre,
        }
    }

    /// Returns whether a point lies within the outline: a ray crosses the edges an odd number of times.
    fn holds(&self, (x, y): PlanePoint) -> bool {
        match &self.shape {
            OutlineShape::Circle { centre, radius } => (x - centre.0).hypot(y - centre.1) < *radius,
            OutlineShape::Polygon(corners) => {
                let edges = corners.iter().zip(corners.iter().cycle().skip(1));
                let crossed = edges.filter(|(a, b)| {
                    (a.1 > y) != (b.1 > y) && x < a.0 + (y - a.1) / (b.1 - a.1) * (b.0 - a.0)
                });
                crossed.count() % 2 == 1
            }
        }
    }
}

fn no_area(line: usize, layer: &str) -> DxfFault {
    let message = format!("layer `{}`: an outline has almost no area", shown(layer));
    DxfFault::new(line, message, "delete it, or check the unit of the drawing")
}

/// Returns the corners without repeated corners and without corners on the line between their
/// neighbours.
fn cleaned(mut corners: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    let mut k = 0;
    while corners.len() >= 3 && k < corners.len() {
        let n = corners.len();
        let [a, b, c] = [corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]];
        let base = (c - a).norm();
        let height = turn((a.x, a.y), (b.x, b.y), (c.x, c.y)).abs();
        let is_between = (b - a).dot(&(c - b)) >= 0.0;
        if (b - a).norm() < ROUNDING || (is_between && height < ROUNDING * base) {
            corners.remove(k);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
    corners
}
