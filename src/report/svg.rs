//! The error map as a picture: the cell in plan, nodes coloured by error, arrows for the error in
//! the plane, circles round nodes that cannot be reached (the paper's Figs. 4 to 7 in plan).

use crate::cell::{Placement, Rectangle, Role};
use crate::compare::Assessment;
use crate::error_map::{NodeRecord, OperationMap, PostureRecord, Status};
use crate::units::mm_from_m;
use std::fmt::Write;

/// Longer side of the drawing area and the space round it, in px.
const SIDE: f64 = 820.0;
const MARGIN: f64 = 24.0;
const LEGEND: f64 = 118.0;

/// Least and greatest colour: viridis (M. Bigot, S. van der Walt and N. Smith; CC0) at equal steps,
/// even in lightness and safe for colour-blind readers.
const COLOURS: [(f64, f64, f64); 6] = [
    (68.0, 1.0, 84.0),
    (65.0, 68.0, 135.0),
    (42.0, 120.0, 142.0),
    (34.0, 168.0, 132.0),
    (122.0, 209.0, 81.0),
    (253.0, 231.0, 37.0),
];

/// World plan (m) to picture (px), y upwards.
struct View {
    low: (f64, f64),
    high: (f64, f64),
    scale: f64,
}

impl View {
    fn of(a: &Assessment<'_>) -> Self {
        let mut points: Vec<(f64, f64)> = corners(&a.cell.robot.footprint, &a.cell.base).to_vec();
        for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
            points.extend(corners(&equipment.footprint, at));
        }
        let fold = |pick: fn(&(f64, f64)) -> f64, start: f64, f: fn(f64, f64) -> f64| {
            points.iter().map(pick).fold(start, f)
        };
        let margin = 0.25;
        let low = (fold(|p| p.0, f64::MAX, f64::min) - margin, fold(|p| p.1, f64::MAX, f64::min) - margin);
        let high = (fold(|p| p.0, f64::MIN, f64::max) + margin, fold(|p| p.1, f64::MIN, f64::max) + margin);
        Self { low, high, scale: SIDE / (high.0 - low.0).max(high.1 - low.1) }
    }

    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (MARGIN + (x - self.low.0) * self.scale, MARGIN + 44.0 + (self.high.1 - y) * self.scale)
    }

    fn size(&self) -> (f64, f64) {
        let (w, h) = ((self.high.0 - self.low.0) * self.scale, (self.high.1 - self.low.1) * self.scale);
        // The legend needs its width, however narrow the cell.
        ((w + 2.0 * MARGIN).max(740.0), h + 2.0 * MARGIN + 44.0 + LEGEND)
    }
}

/// The picture of a layout with all its maps.
pub fn plan(a: &Assessment<'_>) -> String {
    let view = View::of(a);
    let (width, height) = view.size();
    let mut out = String::new();
    // Writing to a String cannot fail; the results below are dropped for that reason.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"system-ui, sans-serif\" font-size=\"13\" fill=\"#1b1f24\">"
    );
    let _ = writeln!(out, "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>");
    let title = super::text::headline(a.cell);
    let _ = writeln!(
        out,
        "<title>{0}</title>\n<text x=\"{MARGIN}\" y=\"{1}\" font-size=\"17\" font-weight=\"600\">{0}</text>",
        escaped(&title),
        MARGIN + 14.0
    );
    draw_equipment(&mut out, a, &view);
    let range = error_range(a);
    let enlarged = enlargement(a, &view);
    for map in &a.maps {
        draw_nodes(&mut out, a, map, &view, range, enlarged);
    }
    for (k, map) in a.maps.iter().enumerate() {
        draw_spot(&mut out, a, k, map, &view);
    }
    draw_names(&mut out, a, &view);
    draw_legend(&mut out, a, &view, range, enlarged);
    out.push_str("</svg>\n");
    out
}

fn corners(rectangle: &Rectangle, at: &Placement) -> [(f64, f64); 4] {
    let (sin, cos) = at.yaw.sin_cos();
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(u, v)| {
        let (x, y) = (rectangle.centre.0 + u * rectangle.size.0, rectangle.centre.1 + v * rectangle.size.1);
        (at.x + cos * x - sin * y, at.y + sin * x + cos * y)
    })
}

fn draw_equipment(out: &mut String, a: &Assessment<'_>, view: &View) {
    let mut outline = |rectangle: &Rectangle, at: &Placement, style: &str| {
        let points = corners(rectangle, at).map(|p| view.at(p)).map(|(x, y)| format!("{x:.1},{y:.1}"));
        let _ = writeln!(out, "<polygon points=\"{}\" {style}/>", points.join(" "));
    };
    for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
        let style = match equipment.role {
            Role::Equipment => "fill=\"#eef2f6\" stroke=\"#57606a\" stroke-width=\"1.4\"",
            Role::Obstacle => "fill=\"#c9ced6\" stroke=\"#57606a\" stroke-width=\"1\"",
        };
        outline(&equipment.footprint, at, style);
    }
    outline(
        &a.cell.robot.footprint,
        &a.cell.base,
        "fill=\"#fde7d3\" stroke=\"#bc4c00\" stroke-width=\"1.4\"",
    );
    let (x, y) = view.at((a.cell.base.x, a.cell.base.y));
    let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"#bc4c00\"/>");
}

fn middle(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0)
}

/// Off the edge that is farthest from the robot: a surface is full of nodes.
fn beside(corners: &[(f64, f64); 4], centre: (f64, f64), base: &Placement) -> (f64, f64) {
    let edges = (0..4).map(|k| middle(corners[k], corners[(k + 1) % 4]));
    let away = |p: &(f64, f64)| (p.0 - base.x).hypot(p.1 - base.y);
    let edge = edges.max_by(|p, q| away(p).total_cmp(&away(q))).unwrap_or(centre);
    let (dx, dy) = (edge.0 - centre.0, edge.1 - centre.1);
    let out = 0.13 / dx.hypot(dy).max(1e-9);
    (edge.0 + out * dx, edge.1 + out * dy)
}

/// Names last, with a halo, so that nothing covers them.
fn draw_names(out: &mut String, a: &Assessment<'_>, view: &View) {
    let mut name = |text: &str, (x, y): (f64, f64)| {
        let _ = writeln!(
            out,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\" font-weight=\"600\" stroke=\"#ffffff\" \
             stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            escaped(text)
        );
    };
    for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
        let corners = corners(&equipment.footprint, at);
        let centre = middle(corners[0], corners[2]);
        let place = if equipment.surface.is_some() { beside(&corners, centre, &a.cell.base) } else { centre };
        let (x, y) = view.at(place);
        name(&equipment.name, (x, y + 4.0));
    }
    let (x, y) = view.at((a.cell.base.x, a.cell.base.y));
    name("robot", (x, y + 22.0));
}

fn usable(map: &OperationMap) -> impl Iterator<Item = (&NodeRecord, &PostureRecord)> {
    map.nodes.iter().filter(|n| n.status == Status::Ok).filter_map(|n| Some((n, n.posture.as_ref()?)))
}

/// Least and greatest error in its sense over all maps, mm: one colour scale for all.
fn error_range(a: &Assessment<'_>) -> (f64, f64) {
    let errors = || a.maps.iter().flat_map(usable).map(|(_, p)| mm_from_m(p.in_sense));
    let (low, high) = (errors().fold(f64::MAX, f64::min), errors().fold(f64::MIN, f64::max));
    if low > high { (0.0, 1.0) } else { (low, high) }
}

/// Arrows are drawn this many times their true length: the longest spans 34 px.
fn enlargement(a: &Assessment<'_>, view: &View) -> f64 {
    let errors = a.maps.iter().flat_map(usable).map(|(_, p)| p.error.x.hypot(p.error.y));
    let longest = errors.fold(0.0, f64::max);
    let raw: f64 = if longest > 0.0 { 34.0 / (longest * view.scale) } else { 1.0 };
    // One or two leading digits read better than six.
    let digit = 10f64.powf(raw.log10().floor());
    (raw / digit).floor().max(1.0) * digit
}

fn draw_nodes(
    out: &mut String,
    a: &Assessment<'_>,
    map: &OperationMap,
    view: &View,
    range: (f64, f64),
    enlarged: f64,
) {
    for node in &map.nodes {
        let (x, y) = view.at((node.position.x, node.position.y));
        let reason = escaped(&node.status.reason(a.cell));
        let _ = match (&node.status, &node.posture) {
            (Status::Ok, Some(p)) => {
                let mm = mm_from_m(p.in_sense);
                let fill = colour((mm - range.0) / (range.1 - range.0).max(f64::MIN_POSITIVE));
                let arrow =
                    arrow((x, y), (p.error.x * enlarged * view.scale, -p.error.y * enlarged * view.scale));
                writeln!(
                    out,
                    "<g stroke=\"{fill}\"><title>({}, {}): {mm:.4} mm</title><path d=\"{arrow}\" fill=\"none\" \
                     stroke-width=\"1.5\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\" fill=\"{fill}\"/></g>",
                    node.i, node.j
                )
            }
            (Status::Collision { .. } | Status::Overlap(_), _) => writeln!(
                out,
                "<path d=\"M{:.1} {:.1}l7 7m0 -7l-7 7\" stroke=\"#cf222e\" stroke-width=\"1.5\" fill=\"none\"><title>{reason}</title></path>",
                x - 3.5,
                y - 3.5
            ),
            (status, _) => {
                let dash = if matches!(status, Status::JointLimit { .. }) {
                    " stroke-dasharray=\"2 1.6\""
                } else {
                    ""
                };
                writeln!(
                    out,
                    "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4.6\" fill=\"none\" stroke=\"#6e7781\"{dash}><title>{reason}</title></circle>"
                )
            }
        };
    }
}

/// Path of an arrow from a point: shaft and head.
fn arrow((x, y): (f64, f64), (dx, dy): (f64, f64)) -> String {
    let head = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        let size = 5.0 / dx.hypot(dy).max(5.0);
        (size * (cos * dx - sin * dy), size * (sin * dx + cos * dy))
    };
    let ((ax, ay), (bx, by)) = (head(2.7), head(-2.7));
    format!("M{x:.1} {y:.1}l{dx:.1} {dy:.1}l{ax:.1} {ay:.1}m{:.1} {:.1}l{bx:.1} {by:.1}", -ax, -ay)
}

fn draw_spot(out: &mut String, a: &Assessment<'_>, k: usize, map: &OperationMap, view: &View) {
    let Some((node, p)) = a.spot(k) else { return };
    let (x, y) = view.at((node.position.x, node.position.y));
    let operation = &a.cell.operations[map.operation];
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"9\" fill=\"none\" stroke=\"#bf3989\" stroke-width=\"2.4\"/>\
         <text x=\"{:.1}\" y=\"{:.1}\" fill=\"#99286e\" font-weight=\"600\" stroke=\"#ffffff\" stroke-width=\"3.5\" \
         paint-order=\"stroke\">{}: {:.3} mm</text>",
        x + 13.0,
        y - 9.0,
        escaped(&operation.name),
        mm_from_m(p.in_sense)
    );
}

fn draw_legend(out: &mut String, a: &Assessment<'_>, view: &View, range: (f64, f64), enlarged: f64) {
    let (_, height) = view.size();
    let top = height - LEGEND - 2.0;
    for k in 0..60 {
        let fill = colour(f64::from(k) / 59.0);
        let _ = writeln!(
            out,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"4.2\" height=\"12\" fill=\"{fill}\"/>",
            MARGIN + 4.0 * f64::from(k),
            top + 18.0
        );
    }
    let mut senses: Vec<_> = a.cell.operations.iter().map(|o| o.sense.name()).collect();
    senses.dedup();
    let mut text = |x: f64, y: f64, what: &str| {
        let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(what));
    };
    text(MARGIN, top + 10.0, &format!("error in {}", senses.join(", ")));
    text(MARGIN, top + 46.0, &format!("{:.2} mm", range.0));
    text(MARGIN + 190.0, top + 46.0, &format!("{:.2} mm", range.1));
    text(MARGIN, top + 68.0, &format!("arrows: error in x and y, {enlarged} times enlarged"));
    text(MARGIN + 330.0, top + 10.0, "out of reach");
    text(MARGIN + 330.0, top + 30.0, "beyond a joint limit");
    text(MARGIN + 330.0, top + 50.0, "collides");
    text(MARGIN + 330.0, top + 70.0, "spot chosen");
    let x = MARGIN + 315.0;
    let _ = writeln!(
        out,
        "<circle cx=\"{x}\" cy=\"{0:.1}\" r=\"4.6\" fill=\"none\" stroke=\"#6e7781\"/>\
         <circle cx=\"{x}\" cy=\"{1:.1}\" r=\"4.6\" fill=\"none\" stroke=\"#6e7781\" stroke-dasharray=\"2 1.6\"/>\
         <path d=\"M{2:.1} {3:.1}l7 7m0 -7l-7 7\" stroke=\"#cf222e\" stroke-width=\"1.5\" fill=\"none\"/>\
         <circle cx=\"{x}\" cy=\"{4:.1}\" r=\"7\" fill=\"none\" stroke=\"#bf3989\" stroke-width=\"2.4\"/>",
        top + 6.0,
        top + 26.0,
        x - 3.5,
        top + 42.0,
        top + 66.0
    );
    draw_scale_bar(out, view, top);
}

/// Half a metre, and the directions of the world axes.
fn draw_scale_bar(out: &mut String, view: &View, top: f64) {
    let (x, y, length) = (MARGIN + 520.0, top + 70.0, 0.5 * view.scale);
    let _ = writeln!(
        out,
        "<path d=\"M{x:.1} {0:.1}v8m0 -4h{length:.1}m0 -4v8\" stroke=\"#1b1f24\" fill=\"none\"/>\
         <text x=\"{1:.1}\" y=\"{0:.1}\" text-anchor=\"middle\">500 mm</text>\
         <path d=\"M{x:.1} {2:.1}h26m-5 -3l5 3l-5 3M{x:.1} {2:.1}v-26m-3 5l3 -5l3 5\" stroke=\"#1b1f24\" fill=\"none\"/>\
         <text x=\"{3:.1}\" y=\"{4:.1}\">x</text><text x=\"{5:.1}\" y=\"{6:.1}\">y</text>",
        y - 4.0,
        x + length / 2.0,
        top + 34.0,
        x + 30.0,
        top + 38.0,
        x - 3.0,
        top + 4.0
    );
}

/// A colour of the scale, 0 to 1.
fn colour(t: f64) -> String {
    let t = t.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let k = (t.floor() as usize).min(COLOURS.len() - 2);
    let (a, b, f) = (COLOURS[k], COLOURS[k + 1], t - k as f64);
    let mix = |a: f64, b: f64| (a + (b - a) * f).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// Text made safe for markup.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}
