//! Blocks of robot, equipment and obstacles: each block is one object that a CAD program moves as a whole.

use super::file::DxfFile;
use super::labels::{Labels, at_height};
use super::layers::{FACES, TEXT, layer_of};
use super::simplified::simplified;
use crate::cell::{Placement, Rectangle, Role};
use crate::drawing::silhouette::{ABOVE, silhouette};
use crate::drawing::{Drawing, DrawnPart, Mesh, PartKind, floor_corners};
use crate::geometry::{PlanePoint, bounding_box};
use crate::pose::Pose;
use nalgebra::{Vector2, Vector3};
use std::collections::HashMap;

/// Least cosine of the angle between the normals of two coplanar faces. The edge between such faces is not
/// drawn.
const PLANE: f64 = 1.0 - 1e-9;
/// Length of the axes at the frame of an object, m.
const AXIS: f64 = 0.1;

/// Object of the cell that becomes a block.
struct CadPiece<'d> {
    name: &'d str,
    layer: &'static str,
    at: Placement,
    footprint: Rectangle,
    parts: Vec<(&'d DrawnPart, Pose)>,
}

/// Writes a block for every object, and an INSERT entity that places the block. Returns the number of faces.
///
/// The block of a robot, equipment or obstacle contains outline in plan, floor space, frame, name and faces.
/// A name without a free place goes to the text column instead. The blocks of the fence and of the keep-out
/// spaces contain only outlines and faces.
pub fn write(
    file: &mut DxfFile,
    drawing: &Drawing<'_>,
    operation: Option<usize>,
    labels: &mut Labels,
) -> usize {
    let all: Vec<(&DrawnPart, Pose)> = drawing.posed(operation, drawing.movement.frames(operation)).collect();
    let mut faces = 0;
    for piece in pieces(drawing, &all) {
        faces += block(file, drawing, &piece, labels);
    }
    for kind in [PartKind::Fence, PartKind::KeepOut] {
        let parts: Vec<_> = all.iter().filter(|(part, _)| part.kind == kind).copied().collect();
        if !parts.is_empty() {
            let name = block_of(file, kind.name(), layer_of(kind), &parts, &mut faces);
            file.insert(layer_of(kind), &name, &Vector3::zeros(), 0.0);
        }
    }
    faces
}

/// Writes the block of a fence or of the keep-out spaces. The origin of the block is the origin of the world.
fn block_of(
    file: &mut DxfFile,
    name: &str,
    layer: &str,
    parts: &[(&DrawnPart, Pose)],
    faces: &mut usize,
) -> String {
    file.block(name, |file| {
        for (part, pose) in parts {
            outline(file, layer, &part.mesh, pose);
            *faces += solid(file, &part.mesh, pose);
        }
    })
}

/// Returns the robot with its tool and the parts that it holds, then the equipment and the obstacles.
fn pieces<'d>(drawing: &'d Drawing<'_>, all: &[(&'d DrawnPart, Pose)]) -> Vec<CadPiece<'d>> {
    let (cell, layout) = (drawing.cell, &drawing.layout);
    let of = |keep: &dyn Fn(&DrawnPart) -> bool| all.iter().filter(|(part, _)| keep(part)).copied().collect();
    let carried = [PartKind::Robot, PartKind::Tool, PartKind::HeldPart];
    let robot = CadPiece {
        name: &cell.robot.name,
        layer: layer_of(PartKind::Robot),
        at: layout.base,
        footprint: cell.robot.footprint,
        parts: of(&|part| carried.contains(&part.kind)),
    };
    let stands = cell.equipment.iter().zip(&layout.placements).enumerate().map(|(k, (e, at))| CadPiece {
        name: &e.name,
        layer: layer_of(if e.role == Role::Equipment { PartKind::Equipment } else { PartKind::Obstacle }),
        at: *at,
        footprint: e.footprint,
        parts: of(&|part| part.equipment == Some(k)),
    });
    std::iter::once(robot).chain(stands).collect()
}

/// Writes a piece as a block whose origin is the frame of the piece. Returns the number of faces. A name
/// without a free place goes to the text column, with a line to the frame of the piece.
fn block(file: &mut DxfFile, drawing: &Drawing<'_>, piece: &CadPiece<'_>, labels: &mut Labels) -> usize {
    let frame = piece.at.pose();
    let own = frame.inverse();
    let said = crate::files::shown(piece.name);
    let standing = floor_corners(&piece.footprint, &piece.at).into_iter();
    let place = labels.beside(&said, bounding_box(standing).unwrap_or_default());
    let mut faces = 0;
    let name = file.block(piece.name, |file| {
        for (part, pose) in &piece.parts {
            let pose = own * *pose;
            outline(file, piece.layer, &part.mesh, &pose);
            faces += solid(file, &part.mesh, &pose);
        }
        let still = Placement { x: 0.0, y: 0.0, z: 0.0, yaw: 0.0 };
        file.outline(piece.layer, &floor_corners(&piece.footprint, &still), drawing.floor - piece.at.z);
        for axis in [Vector3::x(), Vector3::y()] {
            file.line(piece.layer, &Vector3::zeros(), &(axis * AXIS));
        }
        if let Some(at) = place {
            // The text rotates with the block, so it is rotated back.
            file.text(TEXT, &own.transform(&at_height(&at, piece.at.z)), &said, (-piece.at.yaw, false));
        }
    });
    file.insert(piece.layer, &name, &frame.translation, piece.at.yaw);
    let (low, high) = extent(piece);
    [low, high].iter().for_each(|(x, y)| file.include(&Vector3::new(*x, *y, drawing.floor)));
    if place.is_none() {
        let at = at_height(&labels.next_line(), drawing.floor);
        file.line(TEXT, &frame.translation, &at);
        file.text(TEXT, &at, &said, (0.0, false));
    }
    faces
}

/// Returns the bounding box of a piece in plan, world frame, m.
fn extent(piece: &CadPiece<'_>) -> (PlanePoint, PlanePoint) {
    let corners = floor_corners(&piece.footprint, &piece.at).into_iter();
    let points = piece
        .parts
        .iter()
        .flat_map(|(part, pose)| part.mesh.positions.iter().map(|p| pose.transform(p)).map(|p| (p.x, p.y)));
    bounding_box(corners.chain(points)).unwrap_or_default()
}

/// Writes the outline of a part in plan. The outline is at the height of the highest point of the part, so
/// that faces do not cover it.
fn outline(file: &mut DxfFile, layer: &str, mesh: &Mesh, pose: &Pose) {
    let heights = mesh.positions.iter().map(|p| pose.transform(p).z);
    let top = heights.fold(f64::MIN, f64::max);
    let seen = silhouette(mesh, pose, &ABOVE);
    let flat = |p: &Vector2<f64>| (p.x, p.y);
    for ring in seen.loops.iter().filter(|ring| ring.len() > 2) {
        let points: Vec<PlanePoint> = ring.iter().map(flat).collect();
        file.outline(layer, &points, top);
    }
    for [a, b] in &seen.edges {
        file.line(layer, &at_height(a, top), &at_height(b, top));
    }
}

/// Writes the triangles of a part and returns their number. Edges between coplanar faces are invisible.
fn solid(file: &mut DxfFile, mesh: &Mesh, pose: &Pose) -> usize {
    let (corners, triangles) = simplified(mesh);
    let placed: Vec<Vector3<f64>> = corners.iter().map(|p| pose.transform(p)).collect();
    let normal = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| placed[i as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
    };
    let edge = |t: &[u32; 3], k: usize| {
        let (a, b) = (t[k], t[(k + 1) % 3]);
        (a.min(b), a.max(b))
    };
    let mut beside: HashMap<(u32, u32), Vec<Vector3<f64>>> = HashMap::new();
    for t in &triangles {
        (0..3).for_each(|k| beside.entry(edge(t, k)).or_default().push(normal(t)));
    }
    for t in &triangles {
        let hidden = [0, 1, 2].map(|k| matches!(&beside[&edge(t, k)][..], [a, b] if a.dot(b) > PLANE));
        file.face(FACES, &t.map(|i| placed[i as usize]), hidden);
    }
    triangles.len()
}
