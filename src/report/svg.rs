//! The error map as a picture: the cell in plan, nodes coloured by error, arrows for the error in
//! the plane, circles round nodes that cannot be reached (the paper's Figs. 4 to 7 in plan).

use super::colours::viridis_hex;
use super::envelope::path;
use super::legend::{ENVELOPE_STYLE, draw_legend};
use super::view::{MARGIN, View, corners, escaped};
use crate::cell::{Placement, Rectangle, Role};
use crate::compare::Assessment;
use crate::error_map::{NodeRecord, OperationMap, PostureRecord, Status};
use std::fmt::Write;

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
    draw_envelopes(&mut out, a, &view);
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
        &a.layout.base,
        "fill=\"#fde7d3\" stroke=\"#bc4c00\" stroke-width=\"1.4\"",
    );
    let (x, y) = view.at((a.layout.base.x, a.layout.base.y));
    let _ = writeln!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" fill=\"#bc4c00\"/>");
}

/// How far the arm reaches at the height of each operation, cut off at the frame of the drawing.
fn draw_envelopes(out: &mut String, a: &Assessment<'_>, view: &View) {
    let (x, y, width, height) = view.frame();
    let _ = writeln!(
        out,
        "<clipPath id=\"plan\"><rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/></clipPath>"
    );
    let mut drawn: Vec<String> = Vec::new();
    for k in 0..a.maps.len() {
        let outlines = a.reachable(k);
        let path: String = outlines.iter().map(|o| path(o.iter().map(|p| view.at(*p)), "Z")).collect();
        // Operations of one height and attitude share an outline.
        if !path.is_empty() && !drawn.contains(&path) {
            let _ = writeln!(
                out,
                "<path d=\"{path}\" clip-path=\"url(#plan)\" fill=\"none\" {ENVELOPE_STYLE}><title>reach at the \
                 height of {}</title></path>",
                escaped(&a.cell.operations[a.maps[k].operation].name)
            );
            drawn.push(path);
        }
    }
}

fn middle(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0)
}

/// Middle of the edge that is farthest from the robot: a surface is full of nodes, its name stands
/// beside it.
fn far_edge(corners: &[(f64, f64); 4], base: &Placement) -> Option<(f64, f64)> {
    let edges = (0..4).map(|k| middle(corners[k], corners[(k + 1) % 4]));
    let away = |p: &(f64, f64)| (p.0 - base.x).hypot(p.1 - base.y);
    edges.max_by(|p, q| away(p).total_cmp(&away(q)))
}

/// Names last, with a halo, so that nothing covers them.
fn draw_names(out: &mut String, a: &Assessment<'_>, view: &View) {
    let mut name = |text: &str, (x, y): (f64, f64), anchor: &str| {
        let _ = writeln!(
            out,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-weight=\"600\" stroke=\"#ffffff\" \
             stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
            escaped(text)
        );
    };
    for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
        let corners = corners(&equipment.footprint, at);
        let centre = view.at(middle(corners[0], corners[2]));
        let edge = equipment.surface.and_then(|_| far_edge(&corners, &a.layout.base)).map(|e| view.at(e));
        let (x, y) = edge.unwrap_or(centre);
        let (dx, dy) = (x - centre.0, y - centre.1);
        let away = 16.0 / dx.hypot(dy).max(16.0);
        let anchor = match dx * away {
            side if side > 6.0 => "start",
            side if side < -6.0 => "end",
            _ => "middle",
        };
        name(&equipment.name, (x + dx * away, y + dy * away + 4.0), anchor);
    }
    let (x, y) = view.at((a.layout.base.x, a.layout.base.y));
    name("robot", (x, y + 22.0), "middle");
}

fn usable(map: &OperationMap) -> impl Iterator<Item = (&NodeRecord, &PostureRecord)> {
    map.nodes.iter().filter(|n| n.status == Status::Ok).filter_map(|n| Some((n, n.posture.as_ref()?)))
}

/// Least and greatest value over all maps, in its unit: one colour scale for all.
fn error_range(a: &Assessment<'_>) -> (f64, f64) {
    let errors = || a.maps.iter().flat_map(usable).map(|(_, p)| a.cell.unit().from_si(p.value));
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
    let unit = a.cell.unit().word();
    for node in &map.nodes {
        let (x, y) = view.at((node.position.x, node.position.y));
        let reason = escaped(&node.status.reason(a.cell));
        let _ = match (&node.status, &node.posture) {
            (Status::Ok, Some(p)) => {
                let value = a.cell.unit().from_si(p.value);
                let fill = viridis_hex((value - range.0) / (range.1 - range.0).max(f64::MIN_POSITIVE));
                let arrow =
                    arrow((x, y), (p.error.x * enlarged * view.scale, -p.error.y * enlarged * view.scale));
                writeln!(
                    out,
                    "<g stroke=\"{fill}\"><title>({}, {}): {value:.4} {unit}</title><path d=\"{arrow}\" fill=\"none\" \
                     stroke-width=\"1.5\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\" fill=\"{fill}\"/></g>",
                    node.i, node.j
                )
            }
            (Status::Collision { .. } | Status::Refused(_) | Status::Overlap(_) | Status::Unjudged(_), _) => {
                writeln!(
                    out,
                    "<path d=\"M{:.1} {:.1}l7 7m0 -7l-7 7\" stroke=\"#cf222e\" stroke-width=\"1.5\" fill=\"none\"><title>{reason}</title></path>",
                    x - 3.5,
                    y - 3.5
                )
            }
            (status, _) => {
                let missed = matches!(
                    status,
                    Status::JointLimit { .. } | Status::Attitude { .. } | Status::NotConverged { .. }
                );
                let dash = if missed { " stroke-dasharray=\"2 1.6\"" } else { "" };
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
    if let Some(refined) = &a.refined[k] {
        let (x, y) = view.at((refined.position.x, refined.position.y));
        let _ = writeln!(
            out,
            "<path d=\"M{:.1} {y:.1}l5 5l5 -5l-5 -5z\" fill=\"none\" stroke=\"#bf3989\" stroke-width=\"2\">\
             <title>{} refined: {:.4} {}</title></path>",
            x - 5.0,
            escaped(&operation.name),
            a.cell.unit().from_si(refined.value),
            a.cell.unit().word()
        );
    }
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"9\" fill=\"none\" stroke=\"#bf3989\" stroke-width=\"2.4\"/>\
         <text x=\"{:.1}\" y=\"{:.1}\" fill=\"#99286e\" font-weight=\"600\" stroke=\"#ffffff\" stroke-width=\"3.5\" \
         paint-order=\"stroke\">{}: {:.3} {}</text>",
        x + 13.0,
        y - 9.0,
        escaped(&operation.name),
        a.cell.unit().from_si(p.value),
        a.cell.unit().word()
    );
}
