//! Feature edges of a body, which are drawn as lines: sharp edges, open edges and the outline.

use super::camera::Camera;
use super::scene::SceneBody;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Edge of a mesh: positions of the ends, indices of the corners at the ends, and properties of the adjacent
/// triangles.
struct FeatureEdge {
    ends: [Vector3<f64>; 2],
    corners: [u32; 2],
    faces_eye: bool,
    count: usize,
    is_outline: bool,
    is_sharp: bool,
}

/// Upper limit of the number of sharp edges. A body that reaches this limit is drawn without sharp edges.
/// Such a body is a scanned surface, on which nearly every edge is sharp.
const MAX_SHARP_EDGES: usize = 400;

/// Returns the feature edges of a body for a camera, as segments in the frame of its mesh, m.
pub fn of(body: &SceneBody, camera: &Camera) -> Vec<[Vector3<f64>; 2]> {
    let mesh = &body.mesh;
    let places = places(&mesh.positions);
    let mut index: HashMap<[u32; 2], usize> = HashMap::new();
    let mut sides: Vec<FeatureEdge> = Vec::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let faces_eye = (b - a).cross(&(c - a)).dot(&camera.to_eye(&a)) > 0.0;
        for (i, j) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            // Adjacent triangles run along their common edge in opposite directions.
            let (i, j) = if places[i as usize] < places[j as usize] { (i, j) } else { (j, i) };
            let key = [places[i as usize], places[j as usize]];
            let ends = [mesh.positions[i as usize], mesh.positions[j as usize]];
            let at = *index.entry(key).or_insert_with(|| {
                sides.push(FeatureEdge {
                    ends,
                    corners: [i, j],
                    faces_eye,
                    count: 0,
                    is_outline: false,
                    is_sharp: false,
                });
                sides.len() - 1
            });
            let side = &mut sides[at];
            side.count += 1;
            // An edge is sharp if the normals of its two faces differ at both ends.
            let differ = side.corners[0] != i && side.corners[1] != j;
            side.is_sharp |= differ && (faces_eye || side.faces_eye);
            side.is_outline |= side.faces_eye != faces_eye;
        }
    }
    // On a scanned surface, nearly every edge is sharp. An arrow is so thin that only its outline is drawn.
    let sharp = !body.is_sign && sides.iter().filter(|s| s.is_sharp).count() < MAX_SHARP_EDGES;
    let is_drawn = |s: &FeatureEdge| s.is_outline || s.count == 1 || s.is_sharp && sharp;
    sides.into_iter().filter(is_drawn).map(|s| s.ends).collect()
}

/// Returns a number for each corner of a mesh. Corners at equal positions, which may differ in their normals,
/// get the same number.
fn places(positions: &[Vector3<f64>]) -> Vec<u32> {
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let key = |p: &Vector3<f64>| [p.x, p.y, p.z].map(f64::to_bits);
    let mut number = |p: &Vector3<f64>| {
        let next = known.len() as u32;
        *known.entry(key(p)).or_insert(next)
    };
    positions.iter().map(&mut number).collect()
}
