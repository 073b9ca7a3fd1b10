//! Silhouettes: the outline and the sharp edges of a solid seen from one direction.

use crate::drawing::Mesh;
use crate::geometry::join_edges;
use crate::pose::Pose;
use nalgebra::{Vector2, Vector3};
use std::collections::BTreeMap;

/// From where a view looks: to the right, up, and towards the eye; world, right-handed.
pub type Eye = [Vector3<f64>; 3];

/// From above, and from the front: against y.
pub const ABOVE: Eye =
    [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];
pub const FRONT: Eye =
    [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 1.0), Vector3::new(0.0, -1.0, 0.0)];

/// Faces seen at less than this share of their area are seen edge-on.
const EDGE_ON: f64 = 1e-6;
/// Cosine of the angle between faces (60 degrees) from which the edge between them is drawn.
const SHARP: f64 = 0.5;

/// A solid in a view, m: right and up.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// Closed; filled by the nonzero rule they are what the solid covers.
    pub loops: Vec<Vec<Vector2<f64>>>,
    /// Sharp edges inside.
    pub edges: Vec<[Vector2<f64>; 2]>,
    /// Its middle, towards the eye: what is nearer is drawn later.
    pub depth: f64,
}

/// The outline of the faces that look at the eye: their edges without a neighbour that looks there, too.
pub fn silhouette(mesh: &Mesh, pose: &Pose, [right, up, eye]: &Eye) -> Silhouette {
    let placed: Vec<Vector3<f64>> = mesh.positions.iter().map(|p| pose.transform(p)).collect();
    let joined = joined(&mesh.positions);
    let flat = |i: usize| Vector2::new(placed[i].dot(right), placed[i].dot(up));
    // Directed edges of the faces seen, with the normals of these.
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

/// Of every corner the first one at the same place: a mesh has one for each of its normals.
fn joined(positions: &[Vector3<f64>]) -> Vec<usize> {
    let mut first: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let key = |p: &Vector3<f64>| [p.x, p.y, p.z].map(|v| (v + 0.0).to_bits());
    positions.iter().enumerate().map(|(k, p)| *first.entry(key(p)).or_insert(k)).collect()
}

/// Returns the closed rings of directed edges.
fn rings(edges: &[(usize, usize)]) -> impl Iterator<Item = Vec<usize>> {
    let lines = join_edges(edges, |_, free| free[0]);
    lines.into_iter().map(|line| line.corners).filter(|ring| ring.len() > 2)
}
