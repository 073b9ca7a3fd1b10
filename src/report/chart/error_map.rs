//! Picture of the error maps of a layout in plan (Figs. 4 to 7 of the seed paper).
//!
//! The colour of a node shows its value, and its arrow shows the x and y components of its error. A symbol
//! on every unusable node shows why the node cannot be used.

use super::canvas::{Anchor, ChartCanvas, Ink, SMALL};
use super::error_map_legend::{draw_legend, reach_line};
use super::error_map_picture::{ErrorMapPicture, MARGIN, MapScales};
use super::labels::OccupiedBoxes;
use super::plane_view::{PlaneView, widened};
use super::{signs, solids, words};
use crate::assess::Assessment;
use crate::cell::{Placement, Role};
use crate::colours::viridis_hex;
use crate::drawing::round_numbers::{DIGITS, round_down};
use crate::drawing::{ErrorView, PartKind, floor_corners};
use crate::error_map::{NodeRecord, OperationMap, PostureRecord};
use crate::geometry::{PlanePoint, bounding_box};
use crate::svg_text::{PathEnd, escaped, path_data};
use nalgebra::Vector2;

/// Largest number of nodes of a map that are drawn.
const MAX_NODES: usize = 4000;
/// Longer side of the drawing area, px.
const LONGER_SIDE: f64 = 820.0;
/// Least width of the picture, px, into which heading and legend fit.
const MIN_WIDTH: f64 = 740.0;
/// Width of the strip of floor shown round all objects, m.
const SURROUNDINGS: f64 = 0.25;
/// Length of the longest arrow, px.
const LONGEST_ARROW: f64 = 34.0;

/// Returns the picture of a layout with all its maps.
pub fn error_map(a: &Assessment<'_>) -> String {
    let mut plan = ErrorMapPicture::new(a);
    plan.draw_equipment();
    let reach = plan.draw_envelopes();
    let every = a.maps.iter().map(thinning).max().unwrap_or(1);
    let scales = MapScales { range: error_range(a), enlarged: plan.enlargement(), reach, every };
    for map in &a.maps {
        plan.draw_nodes(map, &scales);
    }
    for k in 0..a.maps.len() {
        plan.draw_spot(k);
    }
    plan.draw_names();
    plan.canvas.y = plan.view.bottom();
    draw_legend(&mut plan, &scales);
    plan.canvas.finish()
}

/// Returns the bounds of all objects in the cell, m.
fn bounds(a: &Assessment<'_>) -> (PlanePoint, PlanePoint) {
    let standing = a.cell.equipment.iter().zip(&a.layout.placements);
    let standing = standing.flat_map(|(equipment, at)| floor_corners(&equipment.footprint, at));
    let fence = a.cell.fence.iter().flat_map(|f| &f.corners).copied();
    let keep_out = a.cell.keep_out.iter().flat_map(|k| [(k.min.x, k.min.y), (k.max.x, k.max.y)]);
    let base = floor_corners(&a.cell.robot.footprint, &a.layout.base).into_iter();
    let all = bounding_box(base.chain(standing).chain(fence).chain(keep_out));
    widened(all.unwrap_or_default(), SURROUNDINGS)
}

impl<'a> ErrorMapPicture<'a> {
    fn new(a: &'a Assessment<'a>) -> Self {
        let bounds = bounds(a);
        let mut view = PlaneView::fitted(bounds, (LONGER_SIDE, LONGER_SIDE), (MARGIN, 0.0));
        let width = (view.width() + 2.0 * MARGIN).max(MIN_WIDTH);
        let canvas = ChartCanvas::wide(&crate::report::text::headline(a.cell), &[], width);
        view.top = canvas.y + 6.0;
        Self { a, canvas, view, width, taken: OccupiedBoxes::default() }
    }

    /// Draws floor spaces, keep-out spaces, the fence and the base axis.
    fn draw_equipment(&mut self) {
        let (cell, layout) = (self.a.cell, &self.a.layout);
        let mut shapes: Vec<(PartKind, Vec<PlanePoint>)> = Vec::new();
        for (equipment, at) in cell.equipment.iter().zip(&layout.placements) {
            let kind = match equipment.role {
                Role::Equipment => PartKind::Equipment,
                Role::Obstacle => PartKind::Obstacle,
            };
            shapes.push((kind, floor_corners(&equipment.footprint, at).to_vec()));
        }
        for space in &cell.keep_out {
            let (low, high) = (space.min, space.max);
            let corners = [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)];
            shapes.push((PartKind::KeepOut, corners.to_vec()));
        }
        shapes.extend(cell.fence.iter().map(|fence| (PartKind::Fence, fence.corners.clone())));
        for (kind, corners) in shapes {
            let ring = corners.iter().map(|p| self.view.at(p)).collect();
            self.canvas.put(&solids::drawn([ring].into_iter(), kind));
        }
        let robot = floor_corners(&cell.robot.footprint, &layout.base);
        let robot = self.path(&robot, PathEnd::Closed);
        self.canvas.path(&robot, &format!("{} fill-opacity=\"0.35\"", Ink::Orange.fill()));
        self.canvas.path(&robot, &Ink::Orange.line(1.4));
        let (x, y) = self.view.at(&(layout.base.x, layout.base.y));
        self.canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" {}/>", Ink::Vermilion.fill()));
    }

    /// Returns SVG path data through points of the plan, given as x and y of the world frame, m.
    fn path(&self, points: &[PlanePoint], end: PathEnd) -> String {
        path_data(points.iter().map(|p| self.view.at(p)), end, 1)
    }

    /// Draws the reach of the arm at the height of each operation, clipped at the frame of the drawing.
    /// Returns, for each outline, the names of the operations that share the outline.
    fn draw_envelopes(&mut self) -> Vec<String> {
        let (a, view) = (self.a, self.view);
        self.canvas.put(&format!(
            "<clipPath id=\"plan\"><rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>",
            view.left,
            view.top,
            view.width(),
            view.height()
        ));
        let mut drawn: Vec<(String, String)> = Vec::new();
        for k in 0..a.maps.len() {
            let d: String = a.reachable(k).iter().map(|o| self.path(o, PathEnd::Closed)).collect();
            let name = &a.cell.operations[a.maps[k].operation].name;
            // Operations with equal height and tool orientation share an outline.
            match drawn.iter_mut().find(|(other, _)| *other == d) {
                Some((_, names)) => *names = format!("{names}, {name}"),
                None if d.is_empty() => {}
                None => drawn.push((d, name.clone())),
            }
        }
        for (k, (d, names)) in drawn.iter().enumerate() {
            self.canvas.put(&format!(
                "<path d=\"{d}\" clip-path=\"url(#plan)\" {}><title>reach at the height of {}</title></path>",
                reach_line(k),
                escaped(names)
            ));
        }
        drawn.into_iter().map(|(_, names)| names).collect()
    }

    /// Draws names last, with a halo, so that nothing covers them.
    fn draw_names(&mut self) {
        let (a, view) = (self.a, self.view);
        let (x, y) = view.at(&(a.layout.base.x, a.layout.base.y));
        self.draw_name("robot", (x, y + 22.0));
        for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
            let corners = floor_corners(&equipment.footprint, at);
            let centre = view.at(&middle(corners[0], corners[2]));
            let edge = equipment.surface.and_then(|_| far_edge(&corners, &a.layout.base));
            let (x, y) = edge.map_or(centre, |e| view.at(&e));
            let (dx, dy) = (x - centre.0, y - centre.1);
            let away = 16.0 / dx.hypot(dy).max(16.0);
            let half = words::width(&equipment.name, SMALL) / 2.0;
            let side = (dx * away / 6.0).clamp(-1.0, 1.0);
            self.draw_name(&equipment.name, (x + dx * away + side * half, y + dy * away + 4.0));
        }
    }

    /// Draws a name centred on a point. Moves the name into the picture and, if possible, away from other
    /// names.
    fn draw_name(&mut self, name: &str, (x, y): (f64, f64)) {
        let said = words::shortened(name, SMALL, self.width - 16.0);
        let half = words::width(&said, SMALL) / 2.0;
        let x = x.clamp(half + 6.0, self.width - half - 6.0);
        let tries = [0.0, 15.0, -15.0, 30.0, -30.0].map(|dy| y + dy);
        let free = tries.into_iter().find(|y| self.taken.take([x - half, y - 11.0, x + half, y + 3.0]));
        self.canvas.label((x, free.unwrap_or(y)), Anchor::Middle, Ink::Text, &said);
    }

    /// Returns the factor by which the errors are enlarged relative to the scale of the plan.
    /// The longest arrow has about the length [`LONGEST_ARROW`].
    fn enlargement(&self) -> f64 {
        let errors =
            self.a.maps.iter().flat_map(|map| map.usable().map(|(_, _, p)| drawn_error(self.a, map, p)));
        let longest = errors.map(|error| error.norm()).fold(0.0, f64::max);
        // A factor with one significant digit is easier to read than a factor with six digits.
        if longest > 0.0 { round_down(LONGEST_ARROW / (longest * self.view.scale), DIGITS) } else { 1.0 }
    }

    fn draw_nodes(&mut self, map: &OperationMap, scales: &MapScales) {
        let (unit, every) = (self.a.cell.unit(), thinning(map));
        let (low, high) = scales.range;
        let stretch = scales.enlarged * self.view.scale;
        let is_signed = ErrorView::of(self.a.cell).is_signed();
        for node in map.nodes.iter().filter(|n| is_kept(n, every)) {
            let (x, y) = self.view.at(&(node.position.x, node.position.y));
            let at = format!("({}, {})", node.i, node.j);
            let markup = match node.usable_posture() {
                Some(p) => {
                    let value = unit.from_si(p.value);
                    let fill = viridis_hex((value - low) / (high - low).max(f64::MIN_POSITIVE));
                    let error = drawn_error(self.a, map, p) * stretch;
                    let arrow = arrows((x, y), (error.x, -error.y), is_signed);
                    format!(
                        "<g stroke=\"{fill}\"><title>{at}: {value:.4} {}</title><path d=\"{arrow}\" fill=\"none\" \
                         stroke-width=\"1.5\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\" fill=\"{fill}\"/></g>",
                        unit.word()
                    )
                }
                None => {
                    let reason = escaped(&node.status.reason(self.a.cell));
                    let sign = signs::sign(node.status.sign(), (x, y), 4.4);
                    format!("<g><title>{at}: {reason}</title>{sign}</g>")
                }
            };
            self.canvas.put(&markup);
        }
    }

    fn draw_spot(&mut self, k: usize) {
        let (a, view) = (self.a, self.view);
        let Some((node, p)) = a.spot(k) else { return };
        let (x, y) = view.at(&(node.position.x, node.position.y));
        let (unit, name) = (a.cell.unit(), &a.cell.operations[a.maps[k].operation].name);
        if let Some(refined) = &a.refined[k] {
            let sign = signs::refined(view.at(&(refined.position.x, refined.position.y)));
            let value = unit.from_si(refined.value);
            let name = escaped(name);
            self.canvas
                .put(&format!("<g><title>{name} refined: {value:.4} {}</title>{sign}</g>", unit.word()));
        }
        self.canvas.put(&signs::spot((x, y)));
        self.taken.keep([x - 10.0, y - 10.0, x + 10.0, y + 10.0]);
        let value = format!(": {:.3} {}", unit.from_si(p.value), unit.word());
        let room = self.width - 40.0 - words::width(&value, SMALL);
        let said = words::shortened(name, SMALL, room) + &value;
        // The label is beside the spot, on the side where it fits.
        let half = words::width(&said, SMALL) / 2.0 + 13.0;
        let side = if x + 2.0 * half < self.width { half } else { -half };
        self.draw_name(&said, (x + side, y - 9.0));
    }
}

fn middle(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0)
}

/// Returns the middle of the edge farthest from the robot, where the name of a surface is placed.
fn far_edge(corners: &[(f64, f64); 4], base: &Placement) -> Option<(f64, f64)> {
    let edges = (0..4).map(|k| middle(corners[k], corners[(k + 1) % 4]));
    let away = |p: &(f64, f64)| (p.0 - base.x).hypot(p.1 - base.y);
    edges.max_by(|p, q| away(p).total_cmp(&away(q)))
}

/// Returns the least and the greatest value over all maps, in the unit of the objective. Returns (0, 1) if no
/// node is usable.
fn error_range(a: &Assessment<'_>) -> (f64, f64) {
    let errors =
        || a.maps.iter().flat_map(OperationMap::usable).map(|(_, _, p)| a.cell.unit().from_si(p.value));
    let (low, high) = (errors().fold(f64::MAX, f64::min), errors().fold(f64::MIN, f64::max));
    if low > high { (0.0, 1.0) } else { (low, high) }
}

fn is_kept(node: &NodeRecord, every: usize) -> bool {
    node.i.is_multiple_of(every) && node.j.is_multiple_of(every)
}

/// Returns the thinning `n` of a map: every n-th node along each axis is drawn.
fn thinning(map: &OperationMap) -> usize {
    let kept = |every: usize| map.nodes.iter().filter(|n| is_kept(n, every)).count();
    (1..).find(|every| kept(*every) <= MAX_NODES).unwrap_or(1)
}

/// Returns the error in x and y that the arrow of a node shows, m.
///
/// A worst case or a statistic has no sign. The length of its arrow is its value for the sense `xy` (error in
/// the horizontal plane). The arrow points in the direction of the error at the worst corner of the tolerance
/// box.
fn drawn_error(a: &Assessment<'_>, map: &OperationMap, p: &PostureRecord) -> Vector2<f64> {
    let (cell, error) = (a.cell, p.error.xy());
    let Some(sense) = map.sense("xy").filter(|_| !ErrorView::of(cell).is_signed()) else { return error };
    let size = p.figures[sense].in_reading(cell.reading, cell.quantity);
    error.try_normalize(0.0).map_or(error, |direction| direction * size)
}

/// Returns the SVG path of the arrow of an error. An error without a sign has two opposite arrows.
fn arrows(at: (f64, f64), (dx, dy): (f64, f64), is_signed: bool) -> String {
    let there = arrow(at, (dx, dy));
    if is_signed { there } else { there + &arrow(at, (-dx, -dy)) }
}

/// Returns the SVG path of an arrow with shaft and head.
fn arrow((x, y): (f64, f64), (dx, dy): (f64, f64)) -> String {
    let head = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        let size = 5.0 / dx.hypot(dy).max(5.0);
        (size * (cos * dx - sin * dy), size * (sin * dx + cos * dy))
    };
    let ((ax, ay), (bx, by)) = (head(2.7), head(-2.7));
    format!("M{x:.1} {y:.1}l{dx:.1} {dy:.1}l{ax:.1} {ay:.1}m{:.1} {:.1}l{bx:.1} {by:.1}", -ax, -ay)
}
