//! CAD drawing: DXF of release 2000 in mm, z up. The drawing has one layer for each kind of object, one block
//! for each object, and a title block in paper space.

mod file;
mod labels;
mod layers;
mod paper;
mod pieces;
#[doc(hidden)] // open for tests/it
pub mod planar_face;
#[doc(hidden)] // open for tests/it
pub mod simplified;
#[doc(hidden)] // open for tests/it
pub mod text;

use crate::cell::{Equipment, Placement, Role};
use crate::drawing::{Component, Drawing, DrawnRegion, Field};
use crate::files::shown;
use crate::units::{deg_from_rad, mm_from_m, rounded, wrapped};
use file::DxfFile;
use labels::{Labels, at_height, yaw_radius};
use layers::{DIMENSIONS, ENVELOPE, REGION, SPOT, TEXT};
use nalgebra::{Vector2, Vector3};
use planar_face::planar_faces;
use text::broken;

/// Text height as a share of the longer side of the cell, and the least text height, m.
const HEIGHT: (f64, f64) = (1.0 / 90.0, 0.015);

/// Largest number of characters in a line of the title.
const TITLE_WIDTH: usize = 78;

/// Returns the drawing with the robot at the spot of an operation, or at home. The drawing shows the errors
/// under the model and the reading of the cell.
pub fn dxf(drawing: &Drawing<'_>, operation: Option<usize>) -> Vec<u8> {
    let (low, high) = bounds(drawing);
    let side = (high - low).x.max((high - low).y);
    let height = (side * HEIGHT.0).max(HEIGHT.1);
    let mut file = DxfFile::new(height);
    let column = Vector2::new(high.x + 4.0 * height, high.y - height);
    let mut labels = Labels::new(drawing, operation, height, ((low.x, low.y), column));
    let faces = pieces::write(&mut file, drawing, operation, &mut labels);
    (0..drawing.envelopes.len()).for_each(|k| envelope(&mut file, drawing, k));
    drawing.regions.iter().for_each(|drawn| region(&mut file, drawn));
    for k in 0..drawing.fields.len() {
        nodes(&mut file, &drawing.fields[k]);
        arrows(&mut file, drawing, k);
        spot(&mut file, drawing, &drawing.fields[k], &mut labels);
    }
    dimensions(&mut file, drawing, &low, &mut labels);
    titles(&mut file, drawing, (&low, &high), operation);
    paper::write(&mut file, drawing);
    file.bytes(&layers::used(drawing, faces))
}

/// Returns the bounding box of all parts, working envelopes and regions, world frame, m.
fn bounds(drawing: &Drawing<'_>) -> (Vector3<f64>, Vector3<f64>) {
    let reach = (0..drawing.envelopes.len()).filter_map(|k| Some((k, radii(drawing, k)?.1)));
    let circles = reach.flat_map(|(_, radius)| {
        let (centre, half) = (drawing.base.translation, Vector3::new(radius, radius, 0.0));
        [centre - half, centre + half]
    });
    let regions = drawing.regions.iter().flat_map(|region| &region.rings).flatten().copied();
    circles.chain(regions).fold(drawing.extent(), |(lo, hi), p| (lo.inf(&p), hi.sup(&p)))
}

/// Writes a closed horizontal line.
fn flat_ring(file: &mut DxfFile, layer: &str, ring: &[Vector3<f64>]) {
    if let [first, _, _, ..] = ring {
        let points: Vec<(f64, f64)> = ring.iter().map(|p| (p.x, p.y)).collect();
        file.outline(layer, &points, first.z);
    }
}

/// Writes the region in which the frame origin of the robot base or of a piece of equipment may lie. The
/// region is written as outlines, and as faces (REGION entities).
///
/// Programs without an ACIS kernel show the outlines only.
fn region(file: &mut DxfFile, region: &DrawnRegion) {
    region.rings.iter().for_each(|ring| flat_ring(file, REGION, ring));
    let Some(z) = region.rings.iter().flatten().next().map(|p| p.z) else { return };
    let rings: Vec<Vec<_>> =
        region.rings.iter().map(|ring| ring.iter().map(|p| (p.x, p.y)).collect()).collect();
    planar_faces(&rings).iter().for_each(|face| file.region(REGION, face, z));
}

/// Returns the least and the greatest distance (m) of the working envelope from the base axis, at the height
/// of the TCP at the nodes.
fn radii(drawing: &Drawing<'_>, k: usize) -> Option<(f64, f64)> {
    let centre = drawing.base.translation.xy();
    let points = drawing.envelopes[k].at_work.iter().flatten();
    let away = points.map(|p| (p.xy() - centre).norm()).map(|r| (r, r));
    away.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
}

/// Writes the outlines of the working envelope at the height of the TCP at the nodes. Writes two circles
/// about the base axis through the nearest and the farthest point of the outlines.
fn envelope(file: &mut DxfFile, drawing: &Drawing<'_>, k: usize) {
    let rings = &drawing.envelopes[k].at_work;
    rings.iter().for_each(|ring| flat_ring(file, ENVELOPE, ring));
    let Some((least, greatest)) = radii(drawing, k) else { return };
    let height = rings.iter().flatten().next().map_or(0.0, |p| p.z);
    let centre = at_height(&drawing.base.translation.xy(), height);
    [least, greatest].iter().filter(|r| **r > 0.0).for_each(|r| file.circle(ENVELOPE, &centre, *r));
}

fn nodes(file: &mut DxfFile, field: &Field) {
    for node in &field.nodes {
        // Usable nodes have small circles, because arrows begin there.
        let (layer, radius) = match node.is_ok() {
            true => ("NODES_OK", field.radius() / 4.0),
            false => ("NODES_OUT", field.radius()),
        };
        file.circle(layer, &node.position, radius);
    }
}

fn arrows(file: &mut DxfFile, drawing: &Drawing<'_>, field: usize) {
    let layers = ["ARROWS_X", "ARROWS_Y", "ARROWS_Z", "ARROWS_R"];
    for (component, layer) in Component::ALL.into_iter().zip(layers) {
        for arrow in drawing.arrows(field, 0, component) {
            file.line(layer, &arrow.tail, &arrow.tip);
            arrow.barbs().iter().for_each(|end| file.line(layer, &arrow.tip, end));
        }
    }
}

/// Writes a spot. A line leads from the spot to its text in the column beside all objects.
fn spot(file: &mut DxfFile, drawing: &Drawing<'_>, field: &Field, labels: &mut Labels) {
    let Some(at) = field.spot else { return };
    let radius = 1.4 * field.radius();
    file.circle(SPOT, &at, radius);
    for axis in [Vector3::x(), Vector3::y()] {
        file.line(SPOT, &(at - axis * (1.5 * radius)), &(at + axis * (1.5 * radius)));
    }
    if let Some(refined) = field.refined {
        file.circle(SPOT, &refined, 0.4 * radius);
    }
    let operation = &drawing.cell.operations[field.operation];
    let value = field.best.and_then(|k| field.takes[0].values[field.sense][k]);
    let unit = operation.sense.unit;
    let value = value.map_or(String::new(), |v| {
        format!(", {} {} {}", operation.sense.name, rounded(unit.from_si(v), 3), unit.word())
    });
    let position = at.map(|v| rounded(mm_from_m(v), 1));
    let said = format!("{}{value} at {}, {}, {}", operation.name, position.x, position.y, position.z);
    let beside = at_height(&labels.next_line(), at.z);
    let end = beside + Vector3::new(-0.5 * file.height, 0.5 * file.height, 0.0);
    let start = at + (end - at).try_normalize(1e-9).unwrap_or_else(Vector3::x) * radius;
    file.line(SPOT, &start, &end);
    file.text(SPOT, &beside, &said, (0.0, false));
}

/// Returns a tolerance (half width) as text: a plus-minus sign, the number and the unit sign `sign`. Returns
/// an empty text if the tolerance is 0.
fn plus_minus(half: f64, sign: &str) -> String {
    if half == 0.0 { String::new() } else { format!(" \u{b1}{}{sign}", rounded(half, 3)) }
}

/// Writes the dimensions from the robot base to the frame of every piece of equipment. The dimensions along x
/// and y are below and left of all objects. The yaw is at the frame, and the height is in the column of
/// texts.
fn dimensions(file: &mut DxfFile, drawing: &Drawing<'_>, low: &Vector3<f64>, labels: &mut Labels) {
    let base = Vector3::new(drawing.base.translation.x, drawing.base.translation.y, drawing.floor);
    let all = drawing.cell.equipment.iter().zip(&drawing.layout.placements);
    for (k, (equipment, at)) in all.filter(|(e, _)| e.role == Role::Equipment).enumerate() {
        // The tolerances of a piece that stands on another piece are along the axes of the lower piece. They
        // are not shown, because the dimensions are along the world axes.
        let given = if equipment.on.is_none() { equipment.tolerance.0 } else { [0.0; 4] };
        let to = Vector3::new(at.x, at.y, drawing.floor);
        let away = file.height * (5.0 + 3.0 * k as f64);
        let corner = low - Vector3::new(away, away, 0.0);
        for (axis, upright) in [(0, false), (1, true)] {
            let after = plus_minus(mm_from_m(given[axis]), "");
            file.dimension(DIMENSIONS, [&base, &to], (&corner, upright), &after);
        }
        yaw(file, (equipment, at), given[3], labels);
        let said = format!(
            "{}: {}{} above the base",
            shown(&equipment.name),
            rounded(mm_from_m(at.z - drawing.base.translation.z), 1),
            plus_minus(mm_from_m(given[2]), "")
        );
        let beside = at_height(&labels.next_line(), drawing.floor);
        file.text(DIMENSIONS, &beside, &said, (0.0, false));
    }
}

/// Writes the yaw of a piece of equipment as an angular dimension at the frame of the equipment. The number
/// is at a free place near the arc. If no place is free, the number is in the column of texts.
fn yaw(file: &mut DxfFile, (equipment, at): (&Equipment, &Placement), tolerance: f64, labels: &mut Labels) {
    let angle = wrapped(at.yaw);
    let after = plus_minus(deg_from_rad(tolerance), "\u{b0}");
    let said = format!("{}\u{b0}{after}", rounded(deg_from_rad(angle), 2));
    let radius = yaw_radius(equipment, file.height);
    let frame = at.pose().translation;
    let end = frame.xy() + Vector2::new((angle / 2.0).cos(), (angle / 2.0).sin()) * radius;
    let wide = text::width(&said, file.height);
    let place = labels.beside(&said, ((end.x, end.y), (end.x, end.y))).unwrap_or_else(|| labels.next_line());
    let middle = place + Vector2::new(wide / 2.0, 0.5 * file.height);
    file.angular_dimension(DIMENSIONS, &frame, (angle, radius), (&at_height(&middle, frame.z), &after));
}

/// Writes the title above all objects.
fn titles(
    file: &mut DxfFile,
    drawing: &Drawing<'_>,
    (low, high): (&Vector3<f64>, &Vector3<f64>),
    operation: Option<usize>,
) {
    let cell = drawing.cell;
    let stands = operation.map_or("at home".into(), |k| format!("at {}", cell.operations[k].name));
    let lines = [
        format!("{} ({})", cell.name, drawing.name),
        crate::report::text::headline(cell),
        format!("robot {stands}; mm, z up; sweetspot {}", env!("CARGO_PKG_VERSION")),
        format!(
            "arrows: {}, enlarged {} times{}",
            drawing.lenses[0].reading_word(),
            rounded(drawing.exaggeration(0), 6),
            if drawing.lenses[0].is_signed() { "" } else { ", plus or minus" }
        ),
        "large circles: nodes that cannot be used; thaw the frozen layers to see the other entities"
            .to_string(),
    ];
    let lines: Vec<String> = lines.iter().flat_map(|line| broken(line, TITLE_WIDTH)).collect();
    for (k, line) in lines.iter().rev().enumerate() {
        let y = high.y + file.height * (5.0 + 1.7 * k as f64);
        file.text(TEXT, &Vector3::new(low.x, y, drawing.floor), line, (0.0, false));
    }
}
