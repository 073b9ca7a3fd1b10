//! Drawing of the cell on paper: plan and front view to scale, with dimensions and a title block.
//!
//! Sizes are in mm on paper. The sheet is A4 or A3 landscape (ISO 216), with a scale of ISO 5455. Outlines
//! are 0.35 mm wide and inner edges 0.18 mm (ISO 128). Print the sheet at 100 %.

mod dimensions;
mod title;

use crate::drawing::silhouette::{ABOVE, FRONT, Silhouette, ViewAxes, silhouette};
use crate::drawing::{Component, Drawing, Field, PartKind, floor_corners};
use crate::svg_text::{PathEnd, escaped, path_data};
use crate::units::mm_from_m;
use nalgebra::{Vector2, Vector3};
use std::fmt::Write;

/// Scales of ISO 5455; the entry `n` means 1:n.
const SCALES: [f64; 13] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4];
/// Paper formats: name, width and height, mm.
const PAPERS: [(&str, f64, f64); 2] = [("A4", 297.0, 210.0), ("A3", 420.0, 297.0)];
/// Margin around the frame, mm on paper.
const MARGIN: f64 = 8.0;
/// Margin between the frame and the views, mm on paper.
const VIEW_MARGIN: f64 = 6.0;
/// Height of the heading of a view, mm on paper.
const HEADING: f64 = 8.0;
/// Distance between two views, mm on paper.
const VIEW_GAP: f64 = 14.0;
/// Height of the title block, mm on paper.
const TITLE: f64 = 30.0;

/// Solid with its silhouette in a view.
struct SheetSolid {
    kind: PartKind,
    silhouette: Silhouette,
}

/// Mapping from the plane of a view (right and up, m) to the paper (mm).
pub struct SheetView {
    low: Vector2<f64>,
    high: Vector2<f64>,
    /// Position of the lower left corner on the paper, mm.
    left: f64,
    bottom: f64,
    /// Scale of the view, 1:ratio.
    ratio: f64,
}

impl SheetView {
    fn at(&self, p: &Vector2<f64>) -> (f64, f64) {
        let [u, v] = [p.x - self.low.x, p.y - self.low.y].map(|m| mm_from_m(m) / self.ratio);
        (self.left + u, self.bottom - v)
    }

    fn plan(&self, p: &Vector3<f64>) -> (f64, f64) {
        self.at(&p.xy())
    }

    fn size(&self) -> (f64, f64) {
        size(&self.low, &self.high, self.ratio)
    }
}

fn size(low: &Vector2<f64>, high: &Vector2<f64>, ratio: f64) -> (f64, f64) {
    let size = (high - low).map(|m| mm_from_m(m) / ratio);
    (size.x, size.y)
}

/// Returns the sheet with the robot at the spot of an operation, or at home. The sheet shows the errors under
/// the model and the reading of the cell.
pub fn sheet(drawing: &Drawing<'_>, operation: Option<usize>) -> String {
    let views = [ABOVE, FRONT].map(|eye| seen(drawing, operation, &eye));
    let bounds = [0, 1].map(|k| bounds(drawing, &views[k], k == 0));
    let rows = title::rows(drawing);
    let (paper, ratio) = fitting(&bounds, rows);
    let (name, width, height) = paper;
    let away = dimensions::room(drawing);
    let [plan, front] = bounds;
    let bottom = height - MARGIN - TITLE - VIEW_MARGIN;
    let plan = SheetView {
        low: plan.0,
        high: plan.1,
        left: MARGIN + VIEW_MARGIN + away,
        bottom: bottom - away,
        ratio,
    };
    let left = plan.left + plan.size().0 + VIEW_GAP;
    let top = MARGIN + VIEW_MARGIN + HEADING;
    let front = SheetView {
        low: front.0,
        high: front.1,
        left,
        bottom: top + size(&front.0, &front.1, ratio).1,
        ratio,
    };
    let mut out = String::new();
    // Writing to a String cannot fail; the results here are dropped for that reason.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"system-ui, sans-serif\" font-size=\"2.6\" fill=\"#000000\" \
         stroke-linejoin=\"round\">\n<title>{}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>",
        escaped(&drawing.cell.name)
    );
    heading(&mut out, (plan.left, plan.bottom - plan.size().1), "plan");
    heading(&mut out, (front.left, front.bottom - front.size().1), "front, seen along y");
    let [above, before] = views;
    draw(&mut out, &plan, above);
    draw(&mut out, &front, before);
    floor(&mut out, drawing, &front);
    for (k, field) in drawing.fields.iter().enumerate() {
        map(&mut out, drawing, &plan, (k, field));
    }
    regions(&mut out, drawing, &plan);
    (0..drawing.fields.len()).for_each(|k| spot(&mut out, drawing, [&plan, &front], &drawing.fields[k]));
    dimensions::draw(&mut out, drawing, &plan);
    title::list(&mut out, drawing, (front.left, front.bottom + 2.0 * VIEW_MARGIN));
    title::block(&mut out, drawing, (name, width, height), (ratio, operation));
    out.push_str("</svg>\n");
    out
}

/// Returns the solids of a view, the farthest first.
fn seen(drawing: &Drawing<'_>, operation: Option<usize>, eye: &ViewAxes) -> Vec<SheetSolid> {
    let parts = drawing.posed(operation, drawing.movement.frames(operation));
    let mut all: Vec<SheetSolid> = parts
        .map(|(part, pose)| SheetSolid { kind: part.kind, silhouette: silhouette(&part.mesh, &pose, eye) })
        .collect();
    all.sort_by(|a, b| a.silhouette.depth.total_cmp(&b.silhouette.depth));
    all
}

/// Returns the bounds of a view. The bounds of the plan include the floor spaces.
fn bounds(drawing: &Drawing<'_>, view: &[SheetSolid], is_plan: bool) -> (Vector2<f64>, Vector2<f64>) {
    let mut points: Vec<Vector2<f64>> =
        view.iter().flat_map(|s| s.silhouette.loops.iter().flatten()).copied().collect();
    let (cell, layout) = (drawing.cell, &drawing.layout);
    if is_plan {
        let stands = cell.equipment.iter().map(|e| &e.footprint).zip(&layout.placements);
        let all = stands.chain([(&cell.robot.footprint, &layout.base)]);
        points.extend(all.flat_map(|(f, at)| floor_corners(f, at)).map(|(x, y)| Vector2::new(x, y)));
    } else {
        points.push(Vector2::new(layout.base.x, drawing.floor));
    }
    let pairs = points.iter().map(|p| (*p, *p));
    pairs.reduce(|(lo, hi), (p, q)| (lo.inf(&p), hi.sup(&q))).unwrap_or_default()
}

/// Returns the paper and the scale. The scale is the largest at which the views fit on the larger paper. The
/// paper is the smallest on which the views fit at this scale.
fn fitting(
    [plan, front]: &[(Vector2<f64>, Vector2<f64>); 2],
    (rows, away): (usize, f64),
) -> ((&'static str, f64, f64), f64) {
    let fits = |(_, width, height): &(&str, f64, f64), ratio: f64| {
        let (plan, front) = (size(&plan.0, &plan.1, ratio), size(&front.0, &front.1, ratio));
        let list = 2.0 * VIEW_MARGIN + title::LINE * rows as f64;
        let inside = 2.0 * (MARGIN + VIEW_MARGIN);
        let tall = (plan.1 + away).max(front.1 + list);
        away + plan.0 + VIEW_GAP + front.0.max(title::LIST) <= width - inside
            && HEADING + tall <= height - inside - TITLE
    };
    let last = SCALES.len() - 1;
    let scale = SCALES.into_iter().find(|ratio| fits(&PAPERS[1], *ratio)).unwrap_or(SCALES[last]);
    (PAPERS.into_iter().find(|paper| fits(paper, scale)).unwrap_or(PAPERS[1]), scale)
}

fn heading(out: &mut String, (left, top): (f64, f64), text: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{left:.2}\" y=\"{:.2}\" font-size=\"3.5\" font-weight=\"600\">{text}</text>",
        top - 3.0
    );
}

/// Returns the fill and line attributes of a kind of part.
fn style(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Robot => "fill=\"#fde7d3\" stroke=\"#8a3800\"",
        PartKind::Tool => "fill=\"#f3c9a5\" stroke=\"#8a3800\"",
        PartKind::HeldPart => "fill=\"#cdeee2\" stroke=\"#00543d\"",
        PartKind::Equipment => "fill=\"#f4f6f8\" stroke=\"#000000\"",
        PartKind::Obstacle => "fill=\"#d9dde2\" stroke=\"#000000\"",
        PartKind::Fence => "fill=\"none\" stroke=\"#000000\" stroke-dasharray=\"3 1\"",
        PartKind::KeepOut => "fill=\"none\" stroke=\"#b00020\" stroke-dasharray=\"1.5 1\"",
    }
}

fn draw(out: &mut String, view: &SheetView, solids: Vec<SheetSolid>) {
    for SheetSolid { kind, silhouette } in solids {
        let outline: String = silhouette
            .loops
            .iter()
            .map(|ring| path_data(ring.iter().map(|p| view.at(p)), PathEnd::Closed, 2))
            .collect();
        let edges: String = silhouette
            .edges
            .iter()
            .map(|edge| path_data(edge.iter().map(|p| view.at(p)), PathEnd::Open, 2))
            .collect();
        let _ = writeln!(
            out,
            "<g {}><path d=\"{outline}\" stroke-width=\"0.35\"/><path d=\"{edges}\" stroke-width=\"0.18\"/></g>",
            style(kind)
        );
    }
}

fn floor(out: &mut String, drawing: &Drawing<'_>, front: &SheetView) {
    let [(left, y), (right, _)] =
        [front.low.x, front.high.x].map(|x| front.at(&Vector2::new(x, drawing.floor)));
    let _ =
        writeln!(out, "<path d=\"M{left:.2} {y:.2}H{right:.2}\" stroke=\"#000000\" stroke-width=\"0.5\"/>");
}

/// Draws working envelope, nodes and errors of an operation in plan.
fn map(out: &mut String, drawing: &Drawing<'_>, view: &SheetView, (k, field): (usize, &Field)) {
    let (x, y, (width, height)) = (view.left, view.bottom, view.size());
    let reach = drawing.envelopes.get(k).map_or(&[][..], |rings| &rings.at_work);
    let ring = |r: &Vec<Vector3<f64>>| path_data(r.iter().map(|p| view.plan(p)), PathEnd::Closed, 2);
    let _ = writeln!(
        out,
        "<clipPath id=\"view{k}\"><rect x=\"{x:.2}\" y=\"{:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"/></clipPath>\
         <path d=\"{}\" clip-path=\"url(#view{k})\" fill=\"none\" stroke=\"#0969a8\" stroke-width=\"0.18\" \
         stroke-dasharray=\"2.5 1\"/>",
        y - height,
        reach.iter().map(ring).collect::<String>()
    );
    let radius = (mm_from_m(field.radius()) / view.ratio).clamp(0.4, 1.2);
    let mut circles = [String::new(), String::new()];
    for node in &field.nodes {
        let (x, y) = view.plan(&node.position);
        let r = if node.is_ok() { 0.25 } else { radius };
        let _ =
            write!(circles[usize::from(node.is_ok())], "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{r:.2}\"/>");
    }
    let mut lines = String::new();
    for arrow in drawing.arrows(k, 0, Component::Resultant) {
        let [a, b, ..] = arrow.barbs();
        lines += &path_data([arrow.tail, arrow.tip].iter().map(|p| view.plan(p)), PathEnd::Open, 2);
        lines += &path_data([a, arrow.tip, b].iter().map(|p| view.plan(p)), PathEnd::Open, 2);
    }
    let [out_of_reach, usable] = circles;
    let _ = writeln!(
        out,
        "<g fill=\"none\" stroke=\"#57606a\" stroke-width=\"0.18\">{out_of_reach}</g><g>{usable}</g>\
         <path d=\"{lines}\" fill=\"none\" stroke=\"#00543d\" stroke-width=\"0.18\"/>"
    );
}

/// Draws in plan where the frame origin of each piece may stand.
fn regions(out: &mut String, drawing: &Drawing<'_>, view: &SheetView) {
    let rings = drawing.regions.iter().flat_map(|region| &region.rings);
    let outline: String =
        rings.map(|ring| path_data(ring.iter().map(|p| view.plan(p)), PathEnd::Closed, 2)).collect();
    if !outline.is_empty() {
        let _ = writeln!(
            out,
            "<path class=\"region\" d=\"{outline}\" fill=\"#b35900\" fill-opacity=\"0.25\" \
             fill-rule=\"evenodd\" stroke=\"#b35900\" stroke-width=\"0.25\"/>"
        );
    }
}

/// Draws the spot of an operation in both views.
fn spot(out: &mut String, drawing: &Drawing<'_>, [plan, front]: [&SheetView; 2], field: &Field) {
    let Some(at) = field.spot else { return };
    let name = escaped(&drawing.cell.operations[field.operation].name);
    for (x, y) in [plan.plan(&at), front.at(&at.xz())] {
        let _ = writeln!(
            out,
            "<path d=\"M{:.2} {y:.2}h6M{x:.2} {:.2}v6\" stroke=\"#99286e\" stroke-width=\"0.25\"/>\
             <circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"1.8\" fill=\"none\" stroke=\"#99286e\" stroke-width=\"0.5\"/>\
             <text x=\"{:.2}\" y=\"{:.2}\" fill=\"#99286e\" font-weight=\"600\" stroke=\"#ffffff\" stroke-width=\"0.8\" \
             paint-order=\"stroke\">{name}</text>",
            x - 3.0,
            y - 3.0,
            x + 2.6,
            y - 1.6
        );
    }
}
