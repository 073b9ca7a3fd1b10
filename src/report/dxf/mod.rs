//! CAD drawing: DXF of release 2000 in mm, z up, with one layer for each kind of object.

mod file;
#[doc(hidden)] // open for tests/it
pub mod text;

use crate::cell::Role;
use crate::drawing::floor_corners;
use crate::drawing::{Component, Drawing, Field, Mesh, PartKind};
use crate::pose::Pose;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use file::{DxfFile, Layer};
use nalgebra::Vector3;
use std::collections::HashMap;

const ROBOT: &str = "ROBOT";
const EQUIPMENT: &str = "EQUIPMENT";
const ENVELOPE: &str = "ENVELOPE";
const REGION: &str = "REGION";
const SPOT: &str = "SPOT";
const DIMENSIONS: &str = "DIMENSIONS";
const TEXT: &str = "TEXT";

/// Layers with their colours. Every colour has a contrast ratio of at least 3 on a white background and on
/// AutoCAD's black one. Colour 7 is black on white and white on black.
const LAYERS: [Layer; 16] = [
    (ROBOT, 32),
    (ENVELOPE, 134),
    (EQUIPMENT, 8),
    ("OBSTACLES", 252),
    ("FENCE", 252),
    ("KEEP_OUT", 1),
    ("NODES_OK", 94),
    ("NODES_OUT", 1),
    ("ARROWS_X", 12),
    ("ARROWS_Y", 94),
    ("ARROWS_Z", 150),
    ("ARROWS_R", 7),
    (REGION, 30),
    (SPOT, 6),
    (DIMENSIONS, 7),
    (TEXT, 7),
];

/// Least cosine of the angle between the normals of two coplanar faces. The edge between such faces is not
/// drawn.
const PLANE: f64 = 1.0 - 1e-9;
/// Text height as a share of the longer side of the cell, and the least text height, m.
const HEIGHT: (f64, f64) = (1.0 / 90.0, 0.015);
/// Length of the axes at the frame of a piece of equipment, m.
const AXIS: f64 = 0.1;

/// Returns the drawing with the robot at the spot of an operation, or at home. The drawing shows the errors
/// under the model and the reading of the cell.
pub fn dxf(drawing: &Drawing<'_>, operation: Option<usize>) -> Vec<u8> {
    let (low, high) = drawing.extent();
    let side = (high - low).x.max((high - low).y);
    let mut file = DxfFile::new((side * HEIGHT.0).max(HEIGHT.1));
    for (part, pose) in drawing.posed(operation, drawing.movement.frames(operation)) {
        solid(&mut file, layer_of(part.kind), &part.mesh, &pose);
    }
    outlines(&mut file, drawing);
    for ring in drawing.envelopes.iter().flat_map(|rings| rings.at_work.iter().chain(&rings.around)) {
        file.ring(ENVELOPE, ring);
    }
    for ring in drawing.regions.iter().flat_map(|region| &region.rings) {
        file.ring(REGION, ring);
    }
    for k in 0..drawing.fields.len() {
        nodes(&mut file, &drawing.fields[k]);
        arrows(&mut file, drawing, k);
        spot(&mut file, drawing, &drawing.fields[k]);
    }
    dimensions(&mut file, drawing, &low);
    titles(&mut file, drawing, &high, operation);
    file.bytes(&used(drawing))
}

/// Returns the layers to write. The layers of obstacles, fence, keep-out spaces and regions are left out if they
/// would be empty.
fn used(drawing: &Drawing<'_>) -> Vec<Layer> {
    let has = |kind: PartKind| drawing.parts.iter().any(|p| p.kind == kind);
    let idle = |name: &str| match name {
        "OBSTACLES" => !has(PartKind::Obstacle),
        "FENCE" => !has(PartKind::Fence),
        "KEEP_OUT" => !has(PartKind::KeepOut),
        REGION => drawing.regions.is_empty(),
        _ => false,
    };
    LAYERS.into_iter().filter(|(name, _)| !idle(name)).collect()
}

fn layer_of(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Robot | PartKind::Tool | PartKind::HeldPart => ROBOT,
        PartKind::Equipment => EQUIPMENT,
        PartKind::Obstacle => "OBSTACLES",
        PartKind::Fence => "FENCE",
        PartKind::KeepOut => "KEEP_OUT",
    }
}

/// Writes the triangles of a part. Edges between coplanar faces are invisible.
fn solid(file: &mut DxfFile, layer: &str, mesh: &Mesh, pose: &Pose) {
    let placed: Vec<Vector3<f64>> = mesh.positions.iter().map(|p| pose.transform(p)).collect();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| placed[i as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
    };
    let edge = |t: &[u32; 3], k: usize| {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        (a.min(b), a.max(b))
    };
    let mut beside: HashMap<(u32, u32), Vec<Vector3<f64>>> = HashMap::new();
    for t in &mesh.triangles {
        (0..3).for_each(|k| beside.entry(edge(t, k)).or_default().push(normal(t)));
    }
    for t in &mesh.triangles {
        let hidden = [0, 1, 2].map(|k| matches!(&beside[&edge(t, k)][..], [a, b] if a.dot(b) > PLANE));
        file.face(layer, &t.map(|i| placed[i as usize]), hidden);
    }
}

/// Writes floor spaces in plan, and the frame of every piece of equipment.
fn outlines(file: &mut DxfFile, drawing: &Drawing<'_>) {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    file.outline(ROBOT, &floor_corners(&cell.robot.footprint, &layout.base), drawing.floor);
    for (equipment, at) in cell.equipment.iter().zip(&layout.placements) {
        let layer = if equipment.role == Role::Equipment { EQUIPMENT } else { "OBSTACLES" };
        file.outline(layer, &floor_corners(&equipment.footprint, at), drawing.floor);
        let (pose, height) = (at.pose(), file.height);
        for axis in [Vector3::x(), Vector3::y()] {
            file.line(layer, &pose.translation, &pose.transform(&(axis * AXIS)));
        }
        let beside = pose.translation + Vector3::new(0.5 * height, 0.5 * height, 0.0);
        file.text(TEXT, &beside, &equipment.name, (0.0, false));
    }
    let below = Vector3::new(layout.base.x, layout.base.y - 2.0 * file.height, drawing.floor);
    file.text(TEXT, &below, &cell.robot.name, (0.0, true));
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

fn spot(file: &mut DxfFile, drawing: &Drawing<'_>, field: &Field) {
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
    let beside = at + Vector3::new(1.6 * radius, 0.4 * radius, 0.0);
    let position = at.map(|v| rounded(mm_from_m(v), 1));
    let said = format!("{}{value} at {}, {}, {}", operation.name, position.x, position.y, position.z);
    file.text(SPOT, &beside, &said, (0.0, false));
}

/// Writes the dimensions along x and y from the robot base to the frame of every piece of equipment. The
/// dimensions stand below and left of all objects.
fn dimensions(file: &mut DxfFile, drawing: &Drawing<'_>, low: &Vector3<f64>) {
    let base = Vector3::new(drawing.base.translation.x, drawing.base.translation.y, drawing.floor);
    let all = drawing.cell.equipment.iter().zip(&drawing.layout.placements);
    for (k, (equipment, at)) in all.filter(|(e, _)| e.role == Role::Equipment).enumerate() {
        let to = Vector3::new(at.x, at.y, drawing.floor);
        let away = file.height * (5.0 + 3.0 * k as f64);
        let corner = low - Vector3::new(away, away, 0.0);
        file.dimension(DIMENSIONS, [&base, &to], &corner, false);
        file.dimension(DIMENSIONS, [&base, &to], &corner, true);
        let said = format!(
            "{}: {} above the base, yaw {} deg",
            equipment.name,
            rounded(mm_from_m(at.z - drawing.base.translation.z), 1),
            rounded(deg_from_rad(at.yaw), 3)
        );
        let beside = Vector3::new(base.x.max(to.x) + 2.0 * file.height, corner.y, drawing.floor);
        file.text(DIMENSIONS, &beside, &said, (0.0, false));
    }
}

/// Writes the title above all objects.
fn titles(file: &mut DxfFile, drawing: &Drawing<'_>, high: &Vector3<f64>, operation: Option<usize>) {
    let cell = drawing.cell;
    let stands = operation.map_or("at home".into(), |k| format!("at {}", cell.operations[k].name));
    let lines = [
        format!("{} ({})", cell.name, drawing.name),
        crate::report::text::headline(cell),
        format!("robot {stands}; mm, z up; sweetspot {}", env!("CARGO_PKG_VERSION")),
        format!(
            "arrows: {}, {} times enlarged{}",
            drawing.lenses[0].reading_word(),
            rounded(drawing.exaggeration(0), 6),
            if drawing.lenses[0].is_signed() { "" } else { ", plus or minus" }
        ),
        "large circles: nodes that cannot be used".to_string(),
    ];
    let left = drawing.extent().0.x;
    for (k, line) in lines.iter().rev().enumerate() {
        let y = high.y + file.height * (5.0 + 1.7 * k as f64);
        file.text(TEXT, &Vector3::new(left, y, drawing.floor), line, (0.0, false));
    }
}
