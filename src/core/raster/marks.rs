//! Error maps in the scene: nodes, glyphs of unusable nodes, arrows and spots.

use super::Shot;
use super::palette::{Colour, Palette, scale as colour_of};
use super::scale::{ErrorScale, best, value};
use super::scene::{Label, LabelSide, NodeMark, RasterScene, SceneBody, SceneLine};
use crate::drawing::{Arrow, Drawing, Field, FieldNode, GlyphRing, Mesh, node_glyph};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Number of corners of the ring round a spot.
const RING_CORNERS: usize = 48;

/// Adds the error maps of a drawing to the scene.
pub fn add(
    scene: &mut RasterScene,
    drawing: &Drawing<'_>,
    shot: &Shot,
    palette: &Palette,
    scale: &ErrorScale,
) {
    for (k, field) in drawing.fields.iter().enumerate() {
        if shot.operation.is_some_and(|o| o != field.operation) {
            continue;
        }
        let radius = field.radius();
        for (n, node) in field.nodes.iter().enumerate() {
            let usable = value(field, shot, n).filter(|_| node.is_ok());
            let colour = usable.map(|v| colour_of(scale.share(v)));
            let said = usable.map_or(node.reason.clone(), |v| scale.said(v));
            match colour {
                Some(colour) => scene.bodies.push(disc(node, 0.32 * radius, colour, scene.size)),
                None => add_glyph(scene, node, &field.circle(n), radius, palette),
            }
            let title = format!("({}, {}): {said}", node.i, node.j);
            scene.nodes.push(NodeMark { at: node.position, colour, title });
        }
        for arrow in shot.show.arrows(drawing, k, shot.take) {
            let colour = value(field, shot, arrow.node).map_or(palette.ring, |v| colour_of(scale.share(v)));
            let lift = 0.0009 * scene.size;
            // Arrows are wider than in a CAD file, so that they can be seen from afar.
            let long = (arrow.tip - arrow.tail).norm();
            let wide = Arrow { head: (1.9 * arrow.head).min(0.018 * scene.size).min(0.5 * long), ..arrow };
            scene.bodies.push(SceneBody {
                lift,
                is_lit: false,
                is_sign: true,
                ..SceneBody::solid(wide.mesh(), colour, 1.0)
            });
            scene.arrows.push((arrow, colour));
        }
        add_spot(scene, drawing, field, shot, palette, scale);
    }
}

/// Adds the horizontal glyph of an unusable node, centred on the node.
fn add_glyph(
    scene: &mut RasterScene,
    node: &FieldNode,
    circle: &[Vector3<f64>],
    radius: f64,
    palette: &Palette,
) {
    let Some(glyph) = node_glyph(node.sign) else { return };
    let (lift, colour) = (0.004 * scene.size, palette.of_tone(glyph.tone));
    let line = |points: Vec<Vector3<f64>>, closed: bool, dashed: bool| SceneLine {
        points,
        closed,
        dashed,
        colour,
        width: 1.4,
        lift,
    };
    match glyph.ring {
        GlyphRing::None => {}
        GlyphRing::Full => scene.lines.push(line(circle.to_vec(), true, false)),
        GlyphRing::Dashed => scene.lines.push(line(circle.to_vec(), true, true)),
    }
    let (right, down) = (scene.right, scene.right.cross(&Vector3::z()));
    let place = |(x, y): &(f64, f64)| node.position + (right * *x + down * *y) * radius;
    let strokes = glyph.strokes.iter().map(|stroke| line(stroke.iter().map(place).collect(), false, false));
    scene.lines.extend(strokes);
}

/// Returns a horizontal dot at a node, with the radius `radius` (m). The shift of the dot towards the eye is
/// a fixed share of `size`, the size of the scene (m).
fn disc(node: &FieldNode, radius: f64, colour: Colour, size: f64) -> SceneBody {
    const SIDES: u32 = 12;
    let rim = (0..SIDES).map(|k| {
        let (sin, cos) = (TAU * f64::from(k) / f64::from(SIDES)).sin_cos();
        node.position + Vector3::new(radius * cos, radius * sin, 0.0)
    });
    let positions: Vec<_> = std::iter::once(node.position).chain(rim).collect();
    let normals = vec![Vector3::z(); positions.len()];
    let triangles = (0..SIDES).map(|k| [0, 1 + k, 1 + (k + 1) % SIDES]).collect();
    let mesh = Mesh { positions, normals, triangles };
    SceneBody {
        is_lit: false,
        is_sign: true,
        has_edges: false,
        lift: 0.003 * size,
        ..SceneBody::solid(mesh, colour, 1.0)
    }
}

fn add_spot(
    scene: &mut RasterScene,
    drawing: &Drawing<'_>,
    field: &Field,
    shot: &Shot,
    palette: &Palette,
    scale: &ErrorScale,
) {
    let Some(node) = best(field, shot) else { return };
    let at = field.nodes[node].position;
    let radius = 1.9 * field.radius();
    let ring = (0..RING_CORNERS).map(|k| {
        let (sin, cos) = (TAU * k as f64 / RING_CORNERS as f64).sin_cos();
        at + Vector3::new(radius * cos, radius * sin, 0.0)
    });
    let (points, lift) = (ring.collect(), 0.02 * scene.size);
    let (closed, dashed, colour) = (true, false, palette.spot);
    scene.lines.push(SceneLine { points, closed, dashed, colour, width: 3.2, lift });
    let said = value(field, shot, node).map_or(String::new(), |v| format!(": {}", scale.said(v)));
    let name = &drawing.cell.operations[field.operation].name;
    scene.labels.push(Label { text: format!("{name}{said}"), points: vec![at], side: LabelSide::Spot });
}
