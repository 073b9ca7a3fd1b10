//! Heat map of the error over a work surface: colour bands, iso-lines, symbols of unusable nodes.

use super::axes;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry, SMALL};
use super::colour_scale::ColourScale;
use super::iso::IsoSurface;
use super::labels::OccupiedBoxes;
use super::plane_view::{PlaneView, longer_side, widened};
use super::{WIDTH, signs, words};
use crate::cell::Unit;
use crate::drawing::{Drawing, Field, PartCarrier, ViewedErrors};
use crate::geometry::{PlanePoint, bounding_box};
use crate::pose::Pose;
use crate::svg_text::{PathEnd, escaped, path_data};
use crate::units::mm_from_m;
use nalgebra::Vector3;

/// Left end, right end and greatest height of the plot, px.
const PLOT: (f64, f64, f64) = (62.0, WIDTH - EDGE - 112.0, 470.0);
/// Length that determines the least margin of the plot, mm. The margin is 6 % of the longer side of the
/// mapped area, but at least 6 % of this length.
const MIN_SPAN: f64 = 100.0;
/// Largest number of nodes with tooltips. A map with more nodes has no tooltips.
const MAX_TITLES: usize = 400;

/// Draws the error map of one operation for one sense, under one model and reading.
///
/// `field` is the index of the operation's map in [`Drawing::fields`]. `take` is the index of the model and
/// reading in [`Field::takes`]. `sense` is an index into [`Field::senses`]. The colours span `range` (m or
/// rad), which several maps may share. The axes of the plot are the axes of the work surface.
pub fn heat_map(drawing: &Drawing<'_>, field: usize, take: usize, sense: usize, range: (f64, f64)) -> String {
    let field = &drawing.fields[field];
    let map = HeatMap::new(drawing, field, &field.takes[take], sense, range);
    let mut canvas = ChartCanvas::new(&map.heading(), &map.remarks());
    let (left, right, most) = PLOT;
    let view = PlaneView::fitted(map.bounds, (right - left, most), (left, canvas.y + 26.0));
    let (x, y) = view.scales();
    let place = |p: &PlanePoint| view.at(p);
    let of = map.of.as_str();
    axes::draw(&mut canvas, &x, &y, (&format!("x of {of} / mm"), &format!("y of {of} / mm")));
    map.draw_ground(&mut canvas, &place);
    let points: Vec<PlanePoint> = map.points.iter().map(place).collect();
    let surface = IsoSurface::new(field.size, &points, &map.values);
    map.draw_bands(&mut canvas, &surface);
    let mut taken = OccupiedBoxes::default();
    map.draw_nodes(&mut canvas, &surface, &points);
    map.draw_spots(&mut canvas, &place, &mut taken);
    map.draw_lines(&mut canvas, &surface, &mut taken);
    let foot = map.scale.draw_bar(
        &mut canvas,
        map.unit.word(),
        (view.right() + 26.0, view.top),
        (view.height() - 60.0).clamp(110.0, 220.0),
    );
    map.draw_way_to_robot(&mut canvas, (view.right() + 60.0, foot + 34.0), drawing);
    canvas.y = canvas.y.max(foot + 86.0);
    canvas.legend(&map.legend());
    canvas.finish()
}

/// Error map with positions in the surface frame (mm) and values in the unit of the sense.
struct HeatMap<'a> {
    drawing: &'a Drawing<'a>,
    field: &'a Field,
    take: &'a ViewedErrors,
    sense: usize,
    unit: Unit,
    /// Frame of the surface in the world.
    frame: Pose,
    of: String,
    points: Vec<PlanePoint>,
    values: Vec<Option<f64>>,
    /// Corners of the surface; empty if the frame of the surface is not known.
    ground: Vec<PlanePoint>,
    bounds: (PlanePoint, PlanePoint),
    scale: ColourScale,
}

impl<'a> HeatMap<'a> {
    fn new(
        drawing: &'a Drawing<'a>,
        field: &'a Field,
        take: &'a ViewedErrors,
        sense: usize,
        range: (f64, f64),
    ) -> Self {
        let cell = drawing.cell;
        let equipment = cell.operations[field.operation].equipment;
        let stands = drawing.parts.iter().find(|p| p.equipment == Some(equipment));
        let frame =
            stands.and_then(|p| if let PartCarrier::World(pose) = p.carrier { Some(pose) } else { None });
        let surface = cell.equipment[equipment].surface.filter(|_| frame.is_some());
        let of = if frame.is_some() { cell.equipment[equipment].name.clone() } else { "the world".into() };
        let frame = frame.unwrap_or(Pose::IDENTITY);
        let unit = field.senses[sense].unit;
        let usable =
            |(node, value): (&crate::drawing::FieldNode, &Option<f64>)| value.filter(|_| node.is_ok());
        let values = field.nodes.iter().zip(&take.values[sense]).map(usable);
        let values: Vec<_> = values.map(|v| v.map(|v| unit.from_si(v))).collect();
        let points: Vec<PlanePoint> = field.nodes.iter().map(|n| in_mm(&frame, &n.position)).collect();
        let ground: Vec<PlanePoint> = surface.map_or(Vec::new(), |r| {
            let corner = |(u, v): (f64, f64)| (r.centre.0 + u * r.size.0, r.centre.1 + v * r.size.1);
            let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(corner);
            corners.map(|(x, y)| (mm_from_m(x), mm_from_m(y))).to_vec()
        });
        let bounds = bounding_box(points.iter().chain(&ground).copied()).unwrap_or_default();
        let bounds = widened(bounds, 0.06 * longer_side(bounds).max(MIN_SPAN));
        let scale = ColourScale::new(unit.from_si(range.0), unit.from_si(range.1));
        Self { drawing, field, take, sense, unit, frame, of, points, values, ground, bounds, scale }
    }

    fn heading(&self) -> String {
        let cell = self.drawing.cell;
        let lens = self.drawing.lenses[self.take.lens];
        let name = &cell.operations[self.field.operation].name;
        format!(
            "{name}: {} in {}, {} model ({})",
            lens.reading_word(),
            self.field.senses[self.sense].name,
            lens.model.name(),
            self.drawing.name
        )
    }

    fn remarks(&self) -> Vec<String> {
        let word = self.unit.word();
        let usable = self.values.iter().flatten();
        let range = usable.clone().map(|v| (*v, *v)).reduce(|(l, h), (a, b)| (l.min(a), h.max(b)));
        let spans = range.map_or(String::new(), |(low, high)| {
            format!(": {} to {} {word}", words::figure(low), words::figure(high))
        });
        let mut said = vec![format!("{} of {} nodes are usable{spans}", usable.count(), self.values.len())];
        if self.field.every > 1 {
            let every = self.field.every;
            said.push(format!("along each axis, one in every {every} nodes is drawn"));
        }
        if !self.scale.levels().is_empty() {
            let step = words::number(self.scale.step, self.scale.step);
            said.push(format!(
                "iso-lines every {step} {word}, interpolated linearly; the centre of a grid square has the mean of \
                 its corners"
            ));
        }
        said
    }

    fn draw_ground(&self, canvas: &mut ChartCanvas, place: &impl Fn(&PlanePoint) -> (f64, f64)) {
        let outline = path_data(self.ground.iter().map(place), PathEnd::Closed, 1);
        canvas.path(&outline, &Ink::Ground.fill());
        canvas.path(&outline, &Ink::Axis.line(1.2));
    }

    /// Draws the colour bands, the lowest values first. The area of a band extends under all bands of higher
    /// values, so no seam is visible.
    fn draw_bands(&self, canvas: &mut ChartCanvas, surface: &IsoSurface) {
        let Some((least, most)) = surface.range() else { return };
        let bands = self.scale.bands();
        let first = bands.iter().rposition(|(edge, _)| *edge <= least).unwrap_or(0);
        for (k, (edge, colour)) in bands.iter().enumerate().skip(first) {
            if *edge > most {
                break;
            }
            let level = if k == first { f64::NEG_INFINITY } else { *edge };
            let d: String = surface
                .above(level)
                .iter()
                .map(|p| path_data(p.iter().copied(), PathEnd::Closed, 1))
                .collect();
            canvas.path(&d, &format!("fill=\"{colour}\""));
        }
    }

    fn draw_lines(&self, canvas: &mut ChartCanvas, surface: &IsoSurface, taken: &mut OccupiedBoxes) {
        for level in self.scale.levels() {
            let lines = surface.lines(level);
            let d: String = lines.iter().map(|l| path_data(l.iter().copied(), PathEnd::Open, 1)).collect();
            canvas.path(&d, "fill=\"none\" stroke=\"#1b1f24\" stroke-width=\"1\" stroke-opacity=\"0.75\"");
            let said = words::number(level, self.scale.step);
            let half = words::width(&said, SMALL) / 2.0 + 2.0;
            let length = |l: &&Vec<PlanePoint>| l.windows(2).map(|w| distance(w[0], w[1])).sum::<f64>();
            let Some(longest) = lines.iter().max_by(|a, b| length(a).total_cmp(&length(b))) else { continue };
            if length(&longest) < 2.5 * half {
                continue;
            }
            let tries = [4, 3, 5, 2, 6, 1, 7].map(|k| longest[longest.len() * k / 8]);
            let free = tries.into_iter().find(|(x, y)| taken.take([x - half, y - 7.0, x + half, y + 7.0]));
            if let Some((x, y)) = free {
                canvas.label((x, y + 4.3), Anchor::Middle, Ink::Text, &said);
            }
        }
    }

    fn draw_nodes(&self, canvas: &mut ChartCanvas, surface: &IsoSurface, points: &[PlanePoint]) {
        let near = points.windows(2).map(|w| distance(w[0], w[1])).filter(|d| *d > 0.0);
        let r = (near.fold(f64::MAX, f64::min) * 0.32).clamp(1.5, 5.0);
        for (k, node) in self.field.nodes.iter().enumerate() {
            let (x, y) = points[k];
            let title = |said: String| match points.len() <= MAX_TITLES {
                true => format!("<title>({}, {}): {}</title>", node.i, node.j, escaped(&said)),
                false => String::new(),
            };
            match self.values[k] {
                None => {
                    let sign = signs::sign(node.sign, (x, y), r);
                    canvas.put(&format!("<g>{}{sign}</g>", title(node.reason.clone())));
                }
                Some(value) => {
                    let said = title(format!("{} {}", words::figure(value), self.unit.word()));
                    let colour = self.scale.colour(value);
                    let look = match surface.covers(k) {
                        // A node that would be too small is not drawn.
                        true if r < 2.0 => continue,
                        true => "r=\"1.6\" fill=\"#ffffff\" fill-opacity=\"0.8\"".to_string(),
                        false => format!("r=\"{:.1}\" fill=\"{colour}\" stroke=\"#57606a\"", r.max(4.0)),
                    };
                    canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" {look}>{said}</circle>"));
                }
            }
        }
    }

    fn draw_spots(
        &self,
        canvas: &mut ChartCanvas,
        place: &impl Fn(&PlanePoint) -> (f64, f64),
        taken: &mut OccupiedBoxes,
    ) {
        let at = |p: &Vector3<f64>| place(&in_mm(&self.frame, p));
        if let Some(k) = self.other_spot() {
            canvas.put(&signs::other_spot(place(&self.points[k])));
        }
        if let Some(p) = &self.field.refined {
            canvas.put(&signs::refined(at(p)));
        }
        let Some((x, y)) = self.field.spot.as_ref().map(at) else { return };
        canvas.put(&signs::spot((x, y)));
        taken.keep([x - 10.0, y - 10.0, x + 10.0, y + 10.0]);
        let Some(value) = self.field.best.and_then(|k| self.values[k]) else { return };
        let said = format!("{} {}", words::figure(value), self.unit.word());
        let wide = words::width(&said, SMALL);
        let (dx, anchor) =
            if x + wide + 14.0 < PLOT.1 { (13.0, Anchor::Start) } else { (-13.0, Anchor::End) };
        let left = if dx > 0.0 { x + dx } else { x + dx - wide };
        taken.keep([left, y - 9.0, left + wide, y + 8.0]);
        canvas.label((x + dx, y + 4.3), anchor, Ink::Spot, &said);
    }

    /// Returns the index of the best node under this model and reading, unless that node is the chosen spot.
    fn other_spot(&self) -> Option<usize> {
        self.take.best.filter(|k| Some(*k) != self.field.best)
    }

    fn draw_way_to_robot(&self, canvas: &mut ChartCanvas, (x, y): (f64, f64), drawing: &Drawing<'_>) {
        let base = in_mm(&self.frame, &drawing.base.translation);
        let (low, high) = self.bounds;
        let middle = ((low.0 + high.0) / 2.0, (low.1 + high.1) / 2.0);
        let (dx, dy) = (base.0 - middle.0, middle.1 - base.1);
        let far = dx.hypot(dy);
        if far > 1.0 {
            let (ux, uy) = (dx / far, dy / far);
            let tip = (x + 18.0 * ux, y + 18.0 * uy);
            let barb = |side: f64| (tip.0 - 8.0 * ux - side * 5.0 * uy, tip.1 - 8.0 * uy + side * 5.0 * ux);
            let shaft = path_data([(x - 18.0 * ux, y - 18.0 * uy), tip].into_iter(), PathEnd::Open, 1);
            canvas.path(
                &(shaft + &path_data([barb(1.0), tip, barb(-1.0)].into_iter(), PathEnd::Open, 1)),
                &Ink::Text.line(1.8),
            );
        }
        canvas.text((x, y + 34.0), Anchor::Middle, Ink::Text, "robot base");
        let said = format!("{} mm", words::number(far, 1.0));
        canvas.text((x, y + 50.0), Anchor::Middle, Ink::Faint, &said);
    }

    fn legend(&self) -> Vec<LegendEntry> {
        let origin = (0.0, 0.0);
        let entry = |is_there: bool, mark: String, said: &str| {
            is_there.then(|| LegendEntry { mark, said: said.to_string() })
        };
        let spot = signs::ring_name(self.drawing.cell.operations[self.field.operation].over);
        let spots = [
            entry(self.field.spot.is_some(), signs::spot(origin), spot),
            entry(self.field.refined.is_some(), signs::refined(origin), "spot between the nodes"),
            entry(self.other_spot().is_some(), signs::other_spot(origin), "spot in this reading"),
        ];
        let signs = self.field.nodes.iter().map(|n| n.sign);
        spots.into_iter().flatten().chain(signs::entries(signs)).collect()
    }
}

fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// Converts a point of the world (m) to its x and y in `frame`, mm.
fn in_mm(frame: &Pose, p: &Vector3<f64>) -> PlanePoint {
    let p = frame.inverse().transform(p);
    (mm_from_m(p.x), mm_from_m(p.y))
}
