//! Silhouettes: the outline and the sharp edges of a solid seen from one direction.

use super::mesh::Mesh;
use crate::geometry::join_edges;
use crate::pose::Pose;
use nalgebra::{Vector2, Vector3};
use std::collections::BTreeMap;

/// Axes of a view in the world frame: unit vectors to the right, up and towards the eye (right-handed).
pub type ViewAxes = [Vector3<f64>; 3];

/// View from above, in the direction -z.
pub const ABOVE: ViewAxes =
    [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];
/// View from the front, in the direction +y.
pub const FRONT: ViewAxes =
    [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0), Vector3::new(0.0, -1.0, 0.0)];

/// A face counts as edge-on if its projected area is at most this share of its true area.
const EDGE_ON: f64 = 1e-6;
/// Cosine of 60 degrees. An edge is drawn as sharp if the normals of its two faces differ by more than this
/// angle.
const SHARP: f64 = 0.5;

/// Outline of a solid in the plane of a view (right, up), m.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// Closed outlines. If the outlines are filled by the nonzero rule, the filled area is the projection of
    /// the solid.
    pub loops: Vec<Vec<Vector2<f64>>>,
    /// Sharp edges inside the outlines.
    pub edges: Vec<[Vector2<f64>; 2]>,
    /// Coordinate along the direction to the eye, averaged over all corners, m. Nearer solids are drawn
    /// later.
    pub depth: f64,
}

/// Returns the silhouette of a solid. The outline consists of the edges at which exactly one adjacent face is
/// turned towards the eye.
pub fn silhouette(mesh: &Mesh, pose: &Pose, [right, up, eye]: &ViewAxes) -> Silhouette {
    let placed: Vec<Vector3<f64>> = mesh.positions.iter().map(|p| pose.transform(p)).collect();
    let joined = joined(&mesh.positions);
    let flat = |i: usize| Vector2::new(placed[i].dot(right), placed[i].dot(up));
    // Directed edges of the visible faces, with their normals.
    let mut seen: BTreeMap<(usize, usize), Vector3<f64>> = BTreeMap::new();
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| joined[i as usize]);
        let area = (placed[b] - placed[a]).cross(&(placed[c] - placed[a]));
        if area.dot(eye) > EDGE_ON * area.norm() {
            seen.extend([(a, b), (b, c), (c, a)].map(|edge| (edge, area.normalize())));
        }
    }
    let back = |&(a, b): &(usize, usize)| seen.get(&(b, a));
    let sharp = seen.iter().filter(|((a, b), n)| a < b && back(&(*a, *b)).is_some_and(|o| o.dot(n) < SHARP));
    let edges = sharp.map(|((a, b), _)| [flat(*a), flat(*b)]).collect();
    let open: Vec<(usize, usize)> = seen.keys().filter(|edge| back(edge).is_none()).copied().collect();
    let loops = rings(&open).map(|ring| ring.into_iter().map(flat).collect()).collect();
    let sum: f64 = placed.iter().map(|p| p.dot(eye)).sum();
    Silhouette { loops, edges, depth: sum / placed.len().max(1) as f64 }
}

/// Returns, for every corner, the index of the first corner at the same place. A mesh keeps corners with
/// different normals separate, even at one place.
fn joined(positions: &[Vector3<f64>]) -> Vec<usize> {
    let mut first: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let key = |p: &Vector3<f64>| [p.x, p.y, p.z].map(|v| (v + 0.0).to_bits());
    positions.iter().enumerate().map(|(k, p)| *first.entry(key(p)).or_insert(k)).collect()
}

/// Joins directed edges and returns the closed rings.
fn rings(edges: &[(usize, usize)]) -> impl Iterator<Item = Vec<usize>> {
    let lines = join_edges(edges, |_, free| free[0]);
    lines.into_iter().map(|line| line.corners).filter(|ring| ring.len() > 2)
}
