//! The error map as a picture: the cell in plan, nodes coloured by error, arrows for the error in
//! the plane, a sign on every node that cannot be used (the paper's Figs. 4 to 7 in plan).

use super::chart::Ink;
use super::chart::canvas::{Anchor, Canvas, SMALL, path};
use super::chart::labels::Taken;
use super::chart::{signs, words};
use super::colours::viridis_hex;
use super::legend::{Shown, draw_legend, fence_line, keep_out_line, reach_line};
use super::view::{View, corners, escaped};
use crate::assess::Assessment;
use crate::cell::{Placement, Role};
use crate::error_map::{NodeRecord, OperationMap, PostureRecord, Status};

/// Of a map with more nodes not all are drawn: a picture is no table.
const MOST: usize = 4000;

/// The picture of a layout with all its maps.
pub fn plan(a: &Assessment<'_>) -> String {
    let mut view = View::of(a);
    let mut canvas = Canvas::wide(&super::text::headline(a.cell), &[], view.width());
    view.top = canvas.y + 6.0;
    draw_equipment(&mut canvas, a, &view);
    let reach = draw_envelopes(&mut canvas, a, &view);
    let every = a.maps.iter().map(thinning).max().unwrap_or(1);
    let shown = Shown { range: error_range(a), enlarged: enlargement(a, &view), reach, every };
    for map in &a.maps {
        draw_nodes(&mut canvas, a, map, &view, &shown);
    }
    let mut taken = Taken::default();
    for (k, map) in a.maps.iter().enumerate() {
        draw_spot(&mut canvas, a, k, map, &view, &mut taken);
    }
    draw_names(&mut canvas, a, &view, &mut taken);
    let (_, top, _, height) = view.frame();
    canvas.y = top + height;
    draw_legend(&mut canvas, a, &view, &shown);
    canvas.finish()
}

fn draw_equipment(canvas: &mut Canvas, a: &Assessment<'_>, view: &View) {
    let mut outline = |points: &[(f64, f64)], fill: &str, line: &str| {
        let d = path(points.iter().map(|p| view.at(*p)), "Z");
        canvas.path(&d, fill);
        canvas.path(&d, line);
    };
    for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
        let fill = match equipment.role {
            Role::Equipment => Ink::Ground.fill(),
            Role::Obstacle => Ink::Grid.fill(),
        };
        outline(&corners(&equipment.footprint, at), &fill, &Ink::Faint.line(1.4));
    }
    let robot = corners(&a.cell.robot.footprint, &a.layout.base);
    let pale = format!("{} fill-opacity=\"0.35\"", Ink::Orange.fill());
    outline(&robot, &pale, &Ink::Orange.line(1.4));
    for space in &a.cell.keep_out {
        let (low, high) = (space.min, space.max);
        let points = [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)];
        outline(&points, "fill=\"none\"", &keep_out_line());
    }
    if let Some(fence) = &a.cell.fence {
        outline(&fence.corners, "fill=\"none\"", &fence_line());
    }
    let (x, y) = view.at((a.layout.base.x, a.layout.base.y));
    canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5\" {}/>", Ink::Vermilion.fill()));
}

/// How far the arm reaches at the height of each operation, cut off at the frame of the drawing; the
/// operations of each line drawn.
fn draw_envelopes(canvas: &mut Canvas, a: &Assessment<'_>, view: &View) -> Vec<String> {
    let (x, y, width, height) = view.frame();
    canvas.put(&format!(
        "<clipPath id=\"plan\"><rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/></clipPath>"
    ));
    let mut drawn: Vec<(String, String)> = Vec::new();
    for k in 0..a.maps.len() {
        let outlines = a.reachable(k);
        let d: String = outlines.iter().map(|o| path(o.iter().map(|p| view.at(*p)), "Z")).collect();
        let name = &a.cell.operations[a.maps[k].operation].name;
        // Operations of one height and attitude share an outline.
        match drawn.iter_mut().find(|(other, _)| *other == d) {
            Some((_, names)) => *names = format!("{names}, {name}"),
            None if d.is_empty() => {}
            None => drawn.push((d, name.clone())),
        }
    }
    for (k, (d, names)) in drawn.iter().enumerate() {
        canvas.put(&format!(
            "<path d=\"{d}\" clip-path=\"url(#plan)\" {}><title>reach at the height of {}</title></path>",
            reach_line(k),
            escaped(names)
        ));
    }
    drawn.into_iter().map(|(_, names)| names).collect()
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
fn draw_names(canvas: &mut Canvas, a: &Assessment<'_>, view: &View, taken: &mut Taken) {
    let (x, y) = view.at((a.layout.base.x, a.layout.base.y));
    draw_name(canvas, view, "robot", (x, y + 22.0), taken);
    for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
        let corners = corners(&equipment.footprint, at);
        let centre = view.at(middle(corners[0], corners[2]));
        let edge = equipment.surface.and_then(|_| far_edge(&corners, &a.layout.base)).map(|e| view.at(e));
        let (x, y) = edge.unwrap_or(centre);
        let (dx, dy) = (x - centre.0, y - centre.1);
        let away = 16.0 / dx.hypot(dy).max(16.0);
        let half = words::width(&equipment.name, SMALL) / 2.0;
        let side = (dx * away / 6.0).clamp(-1.0, 1.0);
        draw_name(canvas, view, &equipment.name, (x + dx * away + side * half, y + dy * away + 4.0), taken);
    }
}

/// A name round a point, moved so that it is inside the picture and, if there is room, over no other.
fn draw_name(canvas: &mut Canvas, view: &View, name: &str, (x, y): (f64, f64), taken: &mut Taken) {
    let said = words::shortened(name, SMALL, view.width() - 16.0);
    let half = words::width(&said, SMALL) / 2.0;
    let x = x.clamp(half + 6.0, view.width() - half - 6.0);
    let tries = [0.0, 15.0, -15.0, 30.0, -30.0].map(|dy| y + dy);
    let free = tries.into_iter().find(|y| taken.take([x - half, y - 11.0, x + half, y + 3.0]));
    canvas.label((x, free.unwrap_or(y)), Anchor::Middle, Ink::Text, &said);
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

fn is_kept(node: &NodeRecord, every: usize) -> bool {
    node.i.is_multiple_of(every) && node.j.is_multiple_of(every)
}

/// Every so many nodes of a map are drawn along both axes.
fn thinning(map: &OperationMap) -> usize {
    let kept = |every: usize| map.nodes.iter().filter(|n| is_kept(n, every)).count();
    (1..).find(|every| kept(*every) <= MOST).unwrap_or(1)
}

fn draw_nodes(canvas: &mut Canvas, a: &Assessment<'_>, map: &OperationMap, view: &View, shown: &Shown) {
    let (unit, every) = (a.cell.unit(), thinning(map));
    let (low, high) = shown.range;
    let stretch = shown.enlarged * view.scale;
    for node in map.nodes.iter().filter(|n| is_kept(n, every)) {
        let (x, y) = view.at((node.position.x, node.position.y));
        let at = format!("({}, {})", node.i, node.j);
        match (&node.status, &node.posture) {
            (Status::Ok, Some(p)) => {
                let value = unit.from_si(p.value);
                let fill = viridis_hex((value - low) / (high - low).max(f64::MIN_POSITIVE));
                let arrow = arrow((x, y), (p.error.x * stretch, -p.error.y * stretch));
                canvas.put(&format!(
                    "<g stroke=\"{fill}\"><title>{at}: {value:.4} {}</title><path d=\"{arrow}\" fill=\"none\" \
                     stroke-width=\"1.5\"/><circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\" fill=\"{fill}\"/></g>",
                    unit.word()
                ));
            }
            (status, _) => {
                let reason = escaped(&status.reason(a.cell));
                let sign = signs::sign(status.name(), (x, y), 4.4);
                canvas.put(&format!("<g><title>{at}: {reason}</title>{sign}</g>"));
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

fn draw_spot(
    canvas: &mut Canvas,
    a: &Assessment<'_>,
    k: usize,
    map: &OperationMap,
    view: &View,
    taken: &mut Taken,
) {
    let Some((node, p)) = a.spot(k) else { return };
    let (x, y) = view.at((node.position.x, node.position.y));
    let (unit, name) = (a.cell.unit(), &a.cell.operations[map.operation].name);
    if let Some(refined) = &a.refined[k] {
        let sign = signs::refined(view.at((refined.position.x, refined.position.y)));
        let value = unit.from_si(refined.value);
        let name = escaped(name);
        canvas.put(&format!("<g><title>{name} refined: {value:.4} {}</title>{sign}</g>", unit.word()));
    }
    canvas.put(&signs::spot((x, y)));
    taken.keep([x - 10.0, y - 10.0, x + 10.0, y + 10.0]);
    let value = format!(": {:.3} {}", unit.from_si(p.value), unit.word());
    let room = view.width() - 40.0 - words::width(&value, SMALL);
    let said = words::shortened(name, SMALL, room) + &value;
    // Beside the spot, on the side where it fits.
    let half = words::width(&said, SMALL) / 2.0 + 13.0;
    let side = if x + 2.0 * half < view.width() { half } else { -half };
    draw_name(canvas, view, &said, (x + side, y - 9.0), taken);
}
