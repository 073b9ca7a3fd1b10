//! Layouts with the working envelope: in plan and in a vertical section.

use super::axes::{self, AxisScale};
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry, SMALL};
use super::labels::OccupiedBoxes;
use super::plane_view::{PlaneView, longer_side, widened};
use super::solids::{KINDS, drawn, entry, rank};
use super::{WIDTH, signs, words};
use crate::assess::{Assessment, step_of, tolerance_of};
use crate::drawing::silhouette::{ABOVE, Silhouette, ViewAxes, silhouette};
use crate::drawing::{Drawing, DrawnPart, PartKind};
use crate::geometry::{PlanePoint, bounding_box};
use crate::reach::{Envelope, Fineness};
use crate::svg_text::{PathEnd, path_data};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;

/// Left end, right end and greatest height of the plot, px.
const PLOT: (f64, f64, f64) = (66.0, WIDTH - EDGE, 560.0);

/// Draws the layout from above in world axes, with the TCP at the spot of the operation. The envelope is
/// drawn at the height of the TCP.
pub fn layout_plan(a: &Assessment<'_>, drawing: &Drawing<'_>, operation: usize) -> String {
    let rings = a.reachable(operation);
    let envelope = rings.iter().map(|r| r.iter().map(|p| (mm_from_m(p.0), mm_from_m(p.1))).collect());
    let height = height_of(a, operation);
    let name = &a.cell.operations[operation].name;
    let view = LayoutView {
        drawing,
        operation,
        eye: ABOVE,
        origin: Vector3::zeros(),
        envelope: envelope.collect(),
        heading: format!("{name}: the layout from above ({})", drawing.name),
        said: format!(
            "envelope at the TCP height of the operation, z = {} mm; within the joint limits, collisions not checked",
            rounded(mm_from_m(height), 1)
        ),
        names: ("x of the world / mm", "y of the world / mm"),
        levels: Vec::new(),
    };
    view.draw()
}

/// Draws the layout from the side. The vertical plane through base axis and spot cuts the envelope; all other
/// objects are projected onto this plane.
pub fn layout_section(a: &Assessment<'_>, drawing: &Drawing<'_>, operation: usize) -> String {
    let inverse = a.workcell.inverse();
    let of = &a.cell.operations[operation];
    let (at, base) = (&a.layout.placements[of.equipment], &a.layout.base);
    let envelope = Envelope::new(inverse, &a.layout.attitudes[operation], at.yaw - base.yaw);
    let frame = base.pose();
    let azimuth = match drawing.fields[operation].spot.map(|spot| frame.inverse().transform(&spot)) {
        Some(spot) if spot.x.hypot(spot.y) > 1e-6 => spot.y.atan2(spot.x),
        _ => envelope.middle(),
    };
    let step = 2.0 * step_of(&a.cell.robot, inverse);
    let fine = Fineness { step, tolerance: tolerance_of(inverse, step), on_progress: &|_| () };
    let section = envelope.section(azimuth, &fine);
    let ring =
        |points: &Vec<[f64; 2]>| points.iter().map(|[r, z]| (mm_from_m(*r), mm_from_m(z + base.z))).collect();
    let (sin, cos) = (azimuth + base.yaw).sin_cos();
    let origin = frame.translation;
    let (right, up) = (Vector3::new(cos, sin, 0.0), Vector3::z());
    let view = LayoutView {
        drawing,
        operation,
        eye: [right, up, right.cross(&up)],
        // The vertical axis of the picture shows heights in the world frame.
        origin: Vector3::new(origin.x, origin.y, 0.0),
        envelope: section.outlines.iter().map(|o| ring(&o.points)).collect(),
        heading: format!("{}: the layout from the side ({})", of.name, drawing.name),
        said: format!(
            "cut through the base axis and the spot, {} deg from the x axis of the base; everything in front \
             of or behind the plane is projected onto it",
            rounded(deg_from_rad(azimuth), 1)
        ),
        names: ("away from the base axis / mm", "z of the world / mm"),
        levels: vec![("floor", drawing.floor), ("height of the tool", height_of(a, operation))],
    };
    view.draw()
}

/// Returns the height of the TCP at the nodes of an operation in the world frame, m.
fn height_of(a: &Assessment<'_>, operation: usize) -> f64 {
    let operation = &a.cell.operations[operation];
    a.layout.placements[operation.equipment].z + operation.standoff
}

/// Layout as seen in a view; coordinates in the plane of the picture are in mm.
struct LayoutView<'a> {
    drawing: &'a Drawing<'a>,
    operation: usize,
    eye: ViewAxes,
    /// Point of the world (m) at the origin of the picture.
    origin: Vector3<f64>,
    envelope: Vec<Vec<PlanePoint>>,
    heading: String,
    said: String,
    names: (&'static str, &'static str),
    /// Horizontal lines: name and height, m.
    levels: Vec<(&'static str, f64)>,
}

/// Part of the cell in a view.
struct VisiblePart<'a> {
    part: &'a DrawnPart,
    silhouette: Silhouette,
}

impl LayoutView<'_> {
    fn draw(&self) -> String {
        let parts = self.parts();
        let mut canvas = ChartCanvas::new(&self.heading, std::slice::from_ref(&self.said));
        let (left, right, height) = PLOT;
        let mut view =
            PlaneView::fitted(self.bounds(&parts), (right - left, height), (left, canvas.y + 26.0));
        // The plot is centred horizontally.
        view.left += (right - left - view.width()) / 2.0;
        let (x, y) = view.scales();
        axes::draw(&mut canvas, &x, &y, self.names);
        let ring = |o: &Vec<PlanePoint>| path_data(o.iter().map(|p| view.at(p)), PathEnd::Closed, 1);
        let reach: String = self.envelope.iter().map(ring).collect();
        canvas.path(&reach, &format!("{} fill-opacity=\"0.16\" fill-rule=\"evenodd\"", Ink::Sky.fill()));
        for part in &parts {
            canvas.put(&drawn(self.rings(part, &view), part.part.kind));
        }
        canvas.path(&reach, &Ink::Blue.line(1.6));
        let regions: String = self.regions(&view);
        if !regions.is_empty() {
            canvas.path(
                &regions,
                &format!("{} fill-opacity=\"0.3\" fill-rule=\"evenodd\"", Ink::Orange.fill()),
            );
            canvas.path(&regions, &Ink::Orange.line(1.2));
        }
        let mut taken = OccupiedBoxes::default();
        self.draw_levels(&mut canvas, &x, &y, &mut taken);
        self.draw_spots(&mut canvas, &view, &mut taken);
        self.draw_names(&mut canvas, &parts, &view, &mut taken);
        canvas.legend(&self.legend(&parts));
        canvas.finish()
    }

    /// Returns the SVG path data of the outlines of the regions, px; empty in a view from the side.
    fn regions(&self, view: &PlaneView) -> String {
        let rings = self.drawing.regions.iter().flat_map(|region| &region.rings);
        let ring =
            |r: &Vec<Vector3<f64>>| path_data(r.iter().map(|p| view.at(&self.seen(p))), PathEnd::Closed, 1);
        if self.levels.is_empty() { rings.map(ring).collect() } else { String::new() }
    }

    /// Projects a point of the world onto the plane of the picture, mm.
    fn seen(&self, p: &Vector3<f64>) -> PlanePoint {
        let from = p - self.origin;
        (mm_from_m(from.dot(&self.eye[0])), mm_from_m(from.dot(&self.eye[1])))
    }

    /// Returns the outlines of a part, mm.
    fn outlines(&self, part: &VisiblePart<'_>) -> Vec<Vec<PlanePoint>> {
        let zero = (self.origin.dot(&self.eye[0]), self.origin.dot(&self.eye[1]));
        let place = |p: &nalgebra::Vector2<f64>| (mm_from_m(p.x - zero.0), mm_from_m(p.y - zero.1));
        part.silhouette.loops.iter().map(|ring| ring.iter().map(place).collect()).collect()
    }

    /// Returns the outlines of a part, px.
    fn rings<'v>(
        &'v self,
        part: &VisiblePart<'_>,
        view: &'v PlaneView,
    ) -> impl Iterator<Item = Vec<(f64, f64)>> + 'v {
        let rings = self.outlines(part).into_iter();
        rings.map(|ring| ring.iter().map(|p| view.at(p)).collect())
    }

    /// Returns all visible parts, with the tool at the spot. The parts are in the order of drawing: by kind,
    /// then from the farthest to the nearest.
    fn parts(&self) -> Vec<VisiblePart<'_>> {
        let movement = &self.drawing.movement;
        let frames = movement.at(self.operation).unwrap_or(movement.home());
        let seen = self.drawing.posed(Some(self.operation), frames);
        let mut all: Vec<VisiblePart<'_>> = seen
            .map(|(part, pose)| VisiblePart { part, silhouette: silhouette(&part.mesh, &pose, &self.eye) })
            .collect();
        let order = |p: &VisiblePart<'_>| rank(p.part.kind);
        all.sort_by(|a, b| order(a).cmp(&order(b)).then(a.silhouette.depth.total_cmp(&b.silhouette.depth)));
        all
    }

    fn bounds(&self, parts: &[VisiblePart<'_>]) -> (PlanePoint, PlanePoint) {
        // From the side, a fence looks like a line on the floor or an endless wall, so the bounds ignore
        // fences.
        let counts = |p: &&VisiblePart<'_>| self.levels.is_empty() || p.part.kind != PartKind::Fence;
        let standing = parts.iter().filter(counts).flat_map(|p| self.outlines(p)).flatten();
        let points = standing.chain(self.envelope.iter().flatten().copied());
        let base = self.seen(&self.drawing.base.translation);
        let bounds = bounding_box(points.chain([base])).unwrap_or((base, base));
        widened(bounds, 0.04 * longer_side(bounds).max(100.0))
    }

    fn draw_levels(&self, canvas: &mut ChartCanvas, x: &AxisScale, y: &AxisScale, taken: &mut OccupiedBoxes) {
        for (k, (name, height)) in self.levels.iter().enumerate() {
            let (py, dash) =
                (y.at(mm_from_m(*height)), if k == 0 { "" } else { " stroke-dasharray=\"9 4\"" });
            let paint = format!("{}{dash}", Ink::Text.line(1.2));
            canvas.path(&format!("M{:.1} {py:.1}H{:.1}", x.px.0, x.px.1), &paint);
            let left = x.px.0 + 5.0;
            taken.keep([left, py - 15.0, left + words::width(name, SMALL), py]);
            canvas.label((left, py - 4.0), Anchor::Start, Ink::Faint, name);
        }
    }

    fn draw_spots(&self, canvas: &mut ChartCanvas, view: &PlaneView, taken: &mut OccupiedBoxes) {
        let field = &self.drawing.fields[self.operation];
        let (x, y) = view.at(&self.seen(&self.drawing.base.translation));
        canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {}/>", Ink::Text.fill()));
        if let Some(spot) = &field.spot {
            let (x, y) = view.at(&self.seen(spot));
            canvas.put(&signs::spot((x, y)));
            taken.keep([x - 10.0, y - 10.0, x + 10.0, y + 10.0]);
        }
    }

    /// Draws the name of each piece of equipment at a place where it covers no other name.
    fn draw_names(
        &self,
        canvas: &mut ChartCanvas,
        parts: &[VisiblePart<'_>],
        view: &PlaneView,
        taken: &mut OccupiedBoxes,
    ) {
        let named = |kind| matches!(kind, PartKind::Equipment | PartKind::Obstacle | PartKind::KeepOut);
        let mut owners: Vec<(&str, Vec<PlanePoint>)> = Vec::new();
        for visible in parts.iter().filter(|p| named(p.part.kind)) {
            let part = visible.part;
            let name = if part.kind == PartKind::KeepOut { &part.name } else { &part.owner };
            let points = self.rings(visible, view).flatten();
            match owners.iter_mut().find(|(owner, _)| owner == name) {
                Some((_, all)) => all.extend(points),
                None => owners.push((name, points.collect())),
            }
        }
        // Small objects are named first, because they have the fewest free places.
        let ends = |(name, points): (&'_ str, Vec<PlanePoint>)| {
            let (low, high) = bounding_box(points.into_iter()).unwrap_or_default();
            (name.to_string(), (low.0, low.1, high.0, high.1))
        };
        let mut owners: Vec<_> = owners.into_iter().map(ends).collect();
        owners.sort_by(|(_, a), (_, b)| {
            let area = |e: &(f64, f64, f64, f64)| (e.2 - e.0) * (e.3 - e.1);
            area(a).total_cmp(&area(b))
        });
        for (name, ends) in owners {
            let said = words::shortened(&name, SMALL, 170.0);
            let half = words::width(&said, SMALL) / 2.0;
            let x = ((ends.0 + ends.2) / 2.0).clamp(half + 4.0, WIDTH - half - 4.0);
            let middle = (ends.1 + ends.3) / 2.0;
            let tries = [middle, ends.3 + 12.0, ends.1 - 6.0, middle + 16.0, middle - 16.0, middle + 32.0];
            let free = tries.into_iter().find(|y| taken.take([x - half, y - 8.0, x + half, y + 6.0]));
            canvas.label((x, free.unwrap_or(middle) + 4.0), Anchor::Middle, Ink::Text, &said);
        }
    }

    fn legend(&self, parts: &[VisiblePart<'_>]) -> Vec<LegendEntry> {
        let ground = format!(
            "<path d=\"M-11 -6H11V6H-11Z\" {} fill-opacity=\"0.16\"/><path d=\"M-11 -6H11V6H-11Z\" {}/>",
            Ink::Sky.fill(),
            Ink::Blue.line(1.6)
        );
        let mut entries = Vec::new();
        if !self.envelope.is_empty() {
            entries.push(LegendEntry { mark: ground, said: "working envelope".into() });
        }
        let occurs = |kind: &PartKind| parts.iter().any(|p| p.part.kind == *kind);
        entries.extend(KINDS.into_iter().filter(occurs).map(entry));
        if self.drawing.fields[self.operation].spot.is_some() {
            let operation = self.drawing.fields[self.operation].operation;
            let said = signs::ring_name(self.drawing.cell.operations[operation].over);
            entries.push(LegendEntry { mark: signs::spot((0.0, 0.0)), said: said.into() });
        }
        if self.levels.is_empty() && !self.drawing.regions.is_empty() {
            let mark = format!("<path d=\"M-11 -6H11V6H-11Z\" {}/>", Ink::Orange.line(1.2));
            entries.push(LegendEntry { mark, said: "where the frame origin of a piece may be".into() });
        }
        entries
    }
}
