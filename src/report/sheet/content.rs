//! Content of the two views: solids, names, working envelope, nodes, errors, regions and spots.

use super::SheetView;
use super::ink::{TextAnchor, TextStyle, put, stroke};
use crate::drawing::silhouette::{Silhouette, ViewAxes, silhouette};
use crate::drawing::{Component, Drawing, Field, PartKind, floor_corners};
use crate::files::shown;
use crate::geometry::bounding_box;
use crate::report::chart::labels::OccupiedBoxes;
use crate::svg_text::{PathEnd, path_data};
use crate::units::mm_from_m;
use nalgebra::{Vector2, Vector3};
use std::fmt::Write;

/// Solid with its silhouette in a view.
pub struct SheetSolid {
    kind: PartKind,
    owner: String,
    pub silhouette: Silhouette,
}

/// Returns the solids of a view, the farthest first.
pub fn seen(drawing: &Drawing<'_>, operation: Option<usize>, eye: &ViewAxes) -> Vec<SheetSolid> {
    let parts = drawing.posed(operation, drawing.movement.frames(operation));
    let solid = |(part, pose): (&crate::drawing::DrawnPart, crate::pose::Pose)| SheetSolid {
        kind: part.kind,
        owner: if part.kind == PartKind::KeepOut { part.name.clone() } else { part.owner.clone() },
        silhouette: silhouette(&part.mesh, &pose, eye),
    };
    let mut all: Vec<SheetSolid> = parts.map(solid).collect();
    all.sort_by(|a, b| a.silhouette.depth.total_cmp(&b.silhouette.depth));
    all
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

/// Draws the solids of a view: outlines 0.35 mm wide and inner edges 0.18 mm (ISO 128).
pub fn draw(out: &mut String, view: &SheetView, solids: &[SheetSolid]) {
    for SheetSolid { kind, silhouette, .. } in solids {
        let line = |points: &[Vector2<f64>], end| path_data(points.iter().map(|p| view.at(p)), end, 2);
        let outline: String = silhouette.loops.iter().map(|ring| line(ring, PathEnd::Closed)).collect();
        let edges: String = silhouette.edges.iter().map(|edge| line(edge, PathEnd::Open)).collect();
        let _ = writeln!(
            out,
            "<g {}><path d=\"{outline}\" stroke-width=\"0.35\"/><path d=\"{edges}\" stroke-width=\"0.18\"/></g>",
            style(*kind)
        );
    }
}

/// Draws the floor in the front view.
pub fn floor(out: &mut String, drawing: &Drawing<'_>, front: &SheetView) {
    let [(left, y), (right, _)] =
        [front.low.x, front.high.x].map(|x| front.at(&Vector2::new(x, drawing.floor)));
    stroke(out, &format!("M{left:.2} {y:.2}H{right:.2}"), "#000000", 0.5);
}

/// Draws working envelope, nodes and errors of an operation in plan.
pub fn map(out: &mut String, drawing: &Drawing<'_>, view: &SheetView, (k, field): (usize, &Field)) {
    let reach = drawing.envelopes.get(k).map_or(&[][..], |rings| &rings.at_work);
    let ring = |r: &Vec<Vector3<f64>>| path_data(r.iter().map(|p| view.plan(p)), PathEnd::Closed, 2);
    let _ = writeln!(
        out,
        "<path class=\"reach\" d=\"{}\" fill=\"none\" stroke=\"#0969a8\" stroke-width=\"0.18\" stroke-dasharray=\"2.5 1\"/>",
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

/// Draws the region of each piece in plan: the places where the origin of its frame may be.
pub fn regions(out: &mut String, drawing: &Drawing<'_>, view: &SheetView) {
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

const SPOT: &str = "#99286e";

/// Draws the spots in a view, where `place` maps a point of the world to the plane of the view. A name covers
/// no occupied box if one of its places is free.
pub fn spots(
    out: &mut String,
    drawing: &Drawing<'_>,
    place: impl Fn(&Vector3<f64>) -> (f64, f64),
    taken: &mut OccupiedBoxes,
) {
    for field in &drawing.fields {
        let Some((x, y)) = field.spot.as_ref().map(&place) else { continue };
        stroke(out, &format!("M{:.2} {y:.2}h6M{x:.2} {:.2}v6", x - 3.0, y - 3.0), SPOT, 0.25);
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"1.8\" fill=\"none\" stroke=\"{SPOT}\" stroke-width=\"0.5\"/>"
        );
        taken.keep([x - 2.0, y - 2.0, x + 2.0, y + 2.0]);
    }
    let paint = format!(" fill=\"{SPOT}\"");
    for field in &drawing.fields {
        let Some((x, y)) = field.spot.as_ref().map(&place) else { continue };
        let said = shown(&drawing.cell.operations[field.operation].name);
        let style = TextStyle::plain(2.6).bold().rimmed();
        let wide = style.width(&said);
        let right = [(x + 2.6, y - 1.6), (x + 2.6, y + 3.4)];
        let left = right.map(|(_, at)| (x - 2.6 - wide, at));
        let at = free_place(taken, right.into_iter().chain(left), wide);
        put(out, at, style, &paint, &said);
    }
}

/// Returns the first place at which a text of the width `wide` (mm) covers no occupied box. Adds the box of
/// the text at this place to the occupied boxes. If no place is free, returns the first place and adds no
/// box.
fn free_place(
    taken: &mut OccupiedBoxes,
    places: impl Iterator<Item = (f64, f64)> + Clone,
    wide: f64,
) -> (f64, f64) {
    let mut all = places.clone();
    let free = all.find(|(x, y)| taken.take([*x, y - 2.4, x + wide, y + 0.8]));
    free.or_else(|| places.clone().next()).unwrap_or_default()
}

/// Draws the names of robot, equipment, obstacles and keep-out spaces in plan. A name covers no occupied box
/// if one of its places is free.
pub fn names(
    out: &mut String,
    drawing: &Drawing<'_>,
    view: &SheetView,
    solids: &[SheetSolid],
    taken: &mut OccupiedBoxes,
) {
    for (name, (low, high)) in extents(drawing, view, solids) {
        let style = TextStyle::plain(2.6).rimmed().anchored(TextAnchor::Start);
        let said = shown(&name);
        let wide = style.width(&said);
        let x = (low.0 + high.0 - wide) / 2.0;
        let middle = (low.1 + high.1) / 2.0 + 0.9;
        let heights =
            [middle, high.1 + 3.2, low.1 - 1.0, middle + 4.0, middle - 4.0, middle + 8.0, middle - 8.0];
        let places = heights.into_iter().map(|y| (x, y));
        let beside = [(high.0 + 1.0, middle), (low.0 - wide - 1.0, middle)];
        let at = free_place(taken, places.chain(beside), wide);
        put(out, at, style, "", &said);
    }
}

type PaperBox = ((f64, f64), (f64, f64));

/// Returns the bounding boxes on paper of all objects with a name, the smallest box first.
fn extents(drawing: &Drawing<'_>, view: &SheetView, solids: &[SheetSolid]) -> Vec<(String, PaperBox)> {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    let mut all: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    let on_paper = |(x, y): (f64, f64)| view.at(&Vector2::new(x, y));
    let base = floor_corners(&cell.robot.footprint, &layout.base).map(on_paper);
    all.push((cell.robot.name.clone(), base.to_vec()));
    for (e, at) in cell.equipment.iter().zip(&layout.placements) {
        // The surface of equipment holds the arrows, so the name is placed within the floor space or beside
        // it.
        all.push((e.name.clone(), floor_corners(&e.footprint, at).map(on_paper).to_vec()));
    }
    for solid in solids.iter().filter(|s| s.kind == PartKind::KeepOut) {
        let points = solid.silhouette.loops.iter().flatten().map(|p| view.at(p)).collect();
        all.push((solid.owner.clone(), points));
    }
    let boxed = |(name, points): (String, Vec<(f64, f64)>)| Some((name, bounding_box(points.into_iter())?));
    let mut all: Vec<(String, PaperBox)> = all.into_iter().filter_map(boxed).collect();
    let area = |(_, (low, high)): &(String, PaperBox)| (high.0 - low.0) * (high.1 - low.1);
    all.sort_by(|a, b| area(a).total_cmp(&area(b)));
    all
}
