//! The working envelope with everything that stands in it: in plan and in upright section.

use super::axes;

use super::axes::Scale;
use super::canvas::{Anchor, Canvas, EDGE, Entry, Ink, SMALL, path};
use super::iso::Point;
use super::labels::Taken;
use super::outline::{drawn, silhouette};
use super::{WIDTH, signs, words};
use crate::assess::{Assessment, step_of, tolerance_of};
use crate::drawing::{Drawing, Kind, Part};
use crate::reach::{Envelope, Fineness};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;

/// Left end, right end and greatest height of the plot, px.
const PLOT: (f64, f64, f64) = (66.0, WIDTH - EDGE, 560.0);

/// Seen from above, world axes: the envelope at the height of the operation's TCP, the robot at its spot.
pub fn layout_plan(a: &Assessment<'_>, drawing: &Drawing<'_>, operation: usize) -> String {
    let rings = a.reachable(operation);
    let envelope = rings.iter().map(|r| r.iter().map(|p| (mm_from_m(p.0), mm_from_m(p.1))).collect());
    let height = height_of(a, operation);
    let name = &a.cell.operations[operation].name;
    let view = View {
        drawing,
        operation,
        seen: Box::new(|p| (mm_from_m(p.x), mm_from_m(p.y))),
        depth: |p| p.z,
        envelope: envelope.collect(),
        heading: format!("{name}: the layout from above ({})", drawing.name),
        said: format!(
            "envelope at the height of the tool there, z = {} mm; joint limits kept, collisions not looked at",
            rounded(mm_from_m(height), 1)
        ),
        names: ("x of the world / mm", "y of the world / mm"),
        levels: Vec::new(),
    };
    view.draw()
}

/// Seen from the side, in the upright plane through the base axis and the spot of the operation: the
/// envelope cut there, everything else projected on it.
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
    let fine = Fineness { step, tolerance: tolerance_of(inverse, step), asked: &|_| () };
    let section = envelope.section(azimuth, &fine);
    let ring =
        |points: &Vec<[f64; 2]>| points.iter().map(|[r, z]| (mm_from_m(*r), mm_from_m(z + base.z))).collect();
    let (sin, cos) = (azimuth + base.yaw).sin_cos();
    let origin = frame.translation;
    let along = move |p: &Vector3<f64>| (p.x - origin.x) * cos + (p.y - origin.y) * sin;
    let view = View {
        drawing,
        operation,
        seen: Box::new(move |p| (mm_from_m(along(p)), mm_from_m(p.z))),
        depth: |_| 0.0,
        envelope: section.outlines.iter().map(|o| ring(&o.points)).collect(),
        heading: format!("{}: the layout from the side ({})", of.name, drawing.name),
        said: format!(
            "cut through the base axis and the spot, {} deg from the x axis of the base; what stands before or \
             behind is projected on it",
            rounded(deg_from_rad(azimuth), 1)
        ),
        names: ("away from the base axis / mm", "z of the world / mm"),
        levels: vec![("floor", drawing.floor), ("height of the tool", height_of(a, operation))],
    };
    view.draw()
}

/// Of the TCP at the nodes of an operation, world, m.
fn height_of(a: &Assessment<'_>, operation: usize) -> f64 {
    let operation = &a.cell.operations[operation];
    a.layout.placements[operation.equipment].z + operation.standoff
}

/// From the world, m, to the picture, mm.
type Seen = Box<dyn Fn(&Vector3<f64>) -> Point>;

/// One side from which the layout is seen.
struct View<'a> {
    drawing: &'a Drawing<'a>,
    operation: usize,
    /// A point of the world in mm of the picture.
    seen: Seen,
    /// What lies higher is drawn later.
    depth: fn(&Vector3<f64>) -> f64,
    envelope: Vec<Vec<Point>>,
    heading: String,
    said: String,
    names: (&'static str, &'static str),
    /// Lines across, m.
    levels: Vec<(&'static str, f64)>,
}

/// A part as polygons in mm, with what orders it.
struct Shape<'a> {
    part: &'a Part,
    polygons: Vec<Vec<Point>>,
    depth: f64,
}

impl View<'_> {
    fn draw(&self) -> String {
        let shapes = self.shapes();
        let mut canvas = Canvas::new(&self.heading, std::slice::from_ref(&self.said));
        let (low, high) = self.bounds(&shapes);
        let ((left, right, most), size) = (PLOT, [high[0] - low[0], high[1] - low[1]]);
        let px = ((right - left) / size[0]).min(most / size[1]);
        let top = canvas.y + 26.0;
        // In the middle of the picture.
        let left = left + ((right - left) - size[0] * px) / 2.0;
        let x = Scale::linear(low[0], high[0], (left, left + size[0] * px));
        let y = Scale::linear(low[1], high[1], (top + size[1] * px, top));
        let place = |p: &Point| (x.at(p.0), y.at(p.1));
        axes::draw(&mut canvas, &x, &y, self.names);
        let d: String = self.envelope.iter().map(|o| path(o.iter().map(place), "Z")).collect();
        canvas.path(&d, &format!("{} fill-opacity=\"0.16\" fill-rule=\"evenodd\"", Ink::Sky.fill()));
        for shape in &shapes {
            let (fill, line) = look(shape.part.kind);
            canvas.put(&drawn(&shape.polygons, &place, &fill, &line));
        }
        canvas.path(&d, &Ink::Blue.line(1.6));
        let mut taken = Taken::default();
        self.draw_levels(&mut canvas, &x, &y, &mut taken);
        self.draw_spots(&mut canvas, &place, &mut taken);
        self.draw_names(&mut canvas, &shapes, &place, &mut taken);
        canvas.legend(&self.legend(&shapes));
        canvas.finish()
    }

    /// Everything to be seen with the tool at the spot, the lowest first.
    fn shapes(&self) -> Vec<Shape<'_>> {
        let movement = &self.drawing.movement;
        let frames = movement.at(self.operation).unwrap_or(movement.home());
        let seen = self.drawing.posed(Some(self.operation), frames);
        let mut all: Vec<Shape<'_>> = seen
            .map(|(part, pose)| {
                let depth = part.mesh.positions.iter().map(|p| (self.depth)(&pose.transform(p)));
                let polygons = silhouette(&part.mesh, |p| (self.seen)(&pose.transform(p)));
                Shape { part, polygons, depth: depth.fold(f64::MIN, f64::max) }
            })
            .collect();
        all.sort_by(|a, b| rank(a.part.kind).cmp(&rank(b.part.kind)).then(a.depth.total_cmp(&b.depth)));
        all
    }

    fn bounds(&self, shapes: &[Shape<'_>]) -> ([f64; 2], [f64; 2]) {
        // From the side a fence is a line on the floor, or a wall that has no end.
        let counts = |s: &&Shape<'_>| self.levels.is_empty() || s.part.kind != Kind::Fence;
        let standing = shapes.iter().filter(counts).flat_map(|s| s.polygons.iter().flatten());
        let points = standing.chain(self.envelope.iter().flatten());
        let base = (self.seen)(&self.drawing.base.translation);
        let start = ([base.0, base.1], [base.0, base.1]);
        let (low, high) = points
            .fold(start, |(lo, hi), p| ([lo[0].min(p.0), lo[1].min(p.1)], [hi[0].max(p.0), hi[1].max(p.1)]));
        let margin = 0.04 * (high[0] - low[0]).max(high[1] - low[1]).max(100.0);
        (low.map(|v| v - margin), high.map(|v| v + margin))
    }

    fn draw_levels(&self, canvas: &mut Canvas, x: &Scale, y: &Scale, taken: &mut Taken) {
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

    fn draw_spots(&self, canvas: &mut Canvas, place: &impl Fn(&Point) -> (f64, f64), taken: &mut Taken) {
        let field = &self.drawing.fields[self.operation];
        let (x, y) = place(&(self.seen)(&self.drawing.base.translation));
        canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {}/>", Ink::Text.fill()));
        if let Some(spot) = &field.spot {
            let (x, y) = place(&(self.seen)(spot));
            canvas.put(&signs::spot((x, y)));
            taken.keep([x - 10.0, y - 10.0, x + 10.0, y + 10.0]);
        }
    }

    /// The name of each equipment, where it covers no other.
    fn draw_names(
        &self,
        canvas: &mut Canvas,
        shapes: &[Shape<'_>],
        place: &impl Fn(&Point) -> (f64, f64),
        taken: &mut Taken,
    ) {
        let named = |kind| matches!(kind, Kind::Equipment | Kind::Obstacle | Kind::KeepOut);
        let mut owners: Vec<(&str, Vec<Point>)> = Vec::new();
        for Shape { part, polygons, .. } in shapes.iter().filter(|s| named(s.part.kind)) {
            let name = if part.kind == Kind::KeepOut { &part.name } else { &part.owner };
            let points = polygons.iter().flatten().map(place);
            match owners.iter_mut().find(|(owner, _)| owner == name) {
                Some((_, all)) => all.extend(points),
                None => owners.push((name, points.collect())),
            }
        }
        let ends = |points: &[Point]| {
            points.iter().fold((f64::MAX, f64::MAX, f64::MIN, f64::MIN), |e, p| {
                (e.0.min(p.0), e.1.min(p.1), e.2.max(p.0), e.3.max(p.1))
            })
        };
        // The smallest first: it has the least choice.
        let mut owners: Vec<_> = owners.into_iter().map(|(name, points)| (name, ends(&points))).collect();
        owners.sort_by(|(_, a), (_, b)| {
            let area = |e: &(f64, f64, f64, f64)| (e.2 - e.0) * (e.3 - e.1);
            area(a).total_cmp(&area(b))
        });
        for (name, ends) in owners {
            let said = words::shortened(name, SMALL, 170.0);
            let half = words::width(&said, SMALL) / 2.0;
            let x = ((ends.0 + ends.2) / 2.0).clamp(half + 4.0, WIDTH - half - 4.0);
            let middle = (ends.1 + ends.3) / 2.0;
            let tries = [middle, ends.3 + 12.0, ends.1 - 6.0, middle + 16.0, middle - 16.0, middle + 32.0];
            let free = tries.into_iter().find(|y| taken.take([x - half, y - 8.0, x + half, y + 6.0]));
            canvas.label((x, free.unwrap_or(middle) + 4.0), Anchor::Middle, Ink::Text, &said);
        }
    }

    fn legend(&self, shapes: &[Shape<'_>]) -> Vec<Entry> {
        let ground = format!(
            "<path d=\"M-11 -6H11V6H-11Z\" {} fill-opacity=\"0.16\"/><path d=\"M-11 -6H11V6H-11Z\" {}/>",
            Ink::Sky.fill(),
            Ink::Blue.line(1.6)
        );
        let mut entries = Vec::new();
        if !self.envelope.is_empty() {
            entries.push(Entry { mark: ground, said: "can be reached".into() });
        }
        for kind in KINDS.iter().filter(|kind| shapes.iter().any(|s| s.part.kind == **kind)) {
            let (fill, line) = look(*kind);
            let square = vec![vec![(-9.0, -5.0), (9.0, -5.0), (9.0, 5.0), (-9.0, 5.0)]];
            entries.push(Entry { mark: drawn(&square, &|p| *p, &fill, &line), said: kind.name().into() });
        }
        if self.drawing.fields[self.operation].spot.is_some() {
            entries.push(Entry { mark: signs::spot((0.0, 0.0)), said: "spot chosen".into() });
        }
        entries
    }
}

/// In the order in which they are drawn.
const KINDS: [Kind; 7] =
    [Kind::Fence, Kind::KeepOut, Kind::Equipment, Kind::Obstacle, Kind::Held, Kind::Robot, Kind::Tool];

fn rank(kind: Kind) -> usize {
    KINDS.iter().position(|k| *k == kind).unwrap_or(KINDS.len())
}

/// Fill and line.
fn look(kind: Kind) -> (String, String) {
    let none = "fill=\"none\"".to_string();
    match kind {
        Kind::Equipment => (Ink::Ground.fill(), Ink::Faint.line(2.4)),
        Kind::Obstacle => (Ink::Grid.fill(), Ink::Faint.line(2.4)),
        Kind::Fence => (none, Ink::Text.line(1.4)),
        Kind::KeepOut => (none, format!("{} stroke-dasharray=\"6 4\"", Ink::Vermilion.line(1.6))),
        Kind::Held => (Ink::Purple.fill(), Ink::Faint.line(2.0)),
        Kind::Robot => (Ink::Orange.fill(), Ink::Faint.line(2.0)),
        Kind::Tool => (Ink::Vermilion.fill(), Ink::Faint.line(2.0)),
    }
}
