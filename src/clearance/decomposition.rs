//! Meshes of links as convex parts that hold them.
//!
//! Every triangle belongs to one part, and a part is the hull of its whole triangles. Whatever the
//! division, the parts together hold the whole surface; where a part bridges a hollow, it collides
//! though the mesh would not: conservative, never smaller. So a division that was kept somewhere
//! can be used as it comes, if it has one part for each triangle.

use nalgebra::Vector3;
use parry3d::math as pm;
use parry3d::query::PointQuery;
use parry3d::shape::{ConvexPolyhedron, RoundShape, SharedShape};

/// Most parts of a mesh: each is asked against every solid.
const MAX_PARTS: usize = 16;

/// Parts are cut as long as a cut takes away more than this share of the volume of the whole hull.
const WORTH: f64 = 0.01;

/// Most points from which the volume of a hull is estimated.
const MAX_POINTS: usize = 400;

/// Gives the bytes that were kept for a key, or those that the function makes. What comes back is
/// checked here, so that it may come from anywhere.
pub type Remember<'a> = dyn FnMut(&[u8], &dyn Fn() -> Vec<u8>) -> Vec<u8> + 'a;

/// A convex solid that holds the points of a part.
pub(super) struct Hull {
    /// None: parry makes no hull of them.
    solid: Option<ConvexPolyhedron>,
    /// How far the farthest of the points lies outside, m.
    slack: f64,
    /// Farthest point from the origin, m.
    reach: f64,
    /// A point of the mesh.
    pub(super) inside: pm::Vector,
}

impl Hull {
    /// All within `by` (m) of the points: a shape, what it was before it was rounded, and by how much.
    pub(super) fn swollen(&self, by: f64) -> (SharedShape, Option<(SharedShape, f64)>) {
        let by = by + self.slack;
        match &self.solid {
            None => (SharedShape::ball(self.reach + by), None),
            Some(solid) if by == 0.0 => (SharedShape::new(solid.clone()), None),
            Some(solid) => {
                let round = RoundShape { inner_shape: solid.clone(), border_radius: by };
                (SharedShape::new(round), Some((SharedShape::new(solid.clone()), by)))
            }
        }
    }
}

/// The convex parts of a mesh.
pub(super) fn hulls(
    vertices: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    remember: &mut Remember<'_>,
) -> Vec<Hull> {
    let compute = || division(vertices, triangles);
    let mut part_of = remember(&key(vertices, triangles), &compute);
    let sound = part_of.len() == triangles.len() && part_of.iter().all(|&p| usize::from(p) < MAX_PARTS);
    if !sound {
        part_of = compute();
    }
    let points = |part: usize| -> Vec<pm::Vector> {
        let own = triangles.iter().zip(&part_of).filter(|(_, p)| usize::from(**p) == part);
        let mut used: Vec<u32> = own.flat_map(|(t, _)| *t).collect();
        used.sort_unstable();
        used.dedup();
        used.iter().map(|&i| vector(&vertices[i as usize])).collect()
    };
    (0..MAX_PARTS).map(points).filter(|p| !p.is_empty()).map(|p| hull(&p)).collect()
}

/// The closed mesh as one convex solid, if it is one: exact, solid, and much faster than triangles.
pub(super) fn convex(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<SharedShape> {
    /// With more the search for the farthest point takes longer than the triangles.
    const MAX_VERTICES: usize = 200;
    /// The share of its volume by which a mesh may differ from its hull: rounding of a file.
    const ROUNDING: f64 = 1e-9;
    if vertices.len() > MAX_VERTICES {
        return None;
    }
    let points: Vec<_> = vertices.iter().map(vector).collect();
    let solid = polyhedron(&points)?;
    let at = |i: u32| &vertices[i as usize];
    let volume: f64 = triangles.iter().map(|&[a, b, c]| at(a).dot(&at(b).cross(at(c))) / 6.0).sum();
    let same = (volume_of(&solid) - volume).abs() <= ROUNDING * volume && slack(&solid, &points) == 0.0;
    same.then(|| SharedShape::new(solid))
}

/// The part of every triangle. The part that wastes most is cut at the best of nine planes.
fn division(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Vec<u8> {
    let centre = |t: u32| triangles[t as usize].iter().map(|&i| vertices[i as usize]).sum::<Vector3<f64>>();
    let volume = |part: &[u32]| {
        let step = (3 * part.len()).div_ceil(MAX_POINTS).max(1);
        let corners = part.iter().flat_map(|&t| triangles[t as usize]).step_by(step);
        let points: Vec<_> = corners.map(|i| vector(&vertices[i as usize])).collect();
        // Hulls of long thin sets may fail or turn inside out: then the box.
        let most = box_volume(&points);
        let hull = polyhedron(&points).map(|solid| volume_of(&solid));
        hull.filter(|v| (0.0..=most).contains(v)).unwrap_or(most)
    };
    let cut = |part: &[u32]| {
        let whole = volume(part);
        let halves = |axis: usize, quarter: usize| {
            let mut sorted = part.to_vec();
            sorted.sort_by(|&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
            let second = sorted.split_off(part.len() * quarter / 4);
            (whole - volume(&sorted) - volume(&second), sorted, second)
        };
        (0..9)
            .map(|k| halves(k / 3, k % 3 + 1))
            .filter(|(_, a, b)| !a.is_empty() && !b.is_empty())
            .max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let everything: Vec<u32> = (0..triangles.len() as u32).collect();
    let worth = WORTH * volume(&everything);
    let mut parts = vec![(cut(&everything), everything)];
    while parts.len() < MAX_PARTS {
        let gain = |k: usize| parts[k].0.as_ref().map_or(0.0, |c| c.0);
        let best = (0..parts.len()).max_by(|&a, &b| gain(a).total_cmp(&gain(b)).then(b.cmp(&a)));
        let Some(best) = best.filter(|&k| gain(k) > worth) else { break };
        let Some((_, first, second)) = parts.swap_remove(best).0 else { break };
        parts.extend([first, second].map(|half| (cut(&half), half)));
    }
    let mut part_of = vec![0; triangles.len()];
    for (k, (_, part)) in parts.iter().enumerate() {
        part.iter().for_each(|&t| part_of[t as usize] = k as u8);
    }
    part_of
}

/// Everything that a division depends on.
fn key(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut key = b"sweetspot division 1\n".to_vec();
    key.extend(vertices.iter().flat_map(|v| [v.x, v.y, v.z]).flat_map(f64::to_le_bytes));
    key.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
    key
}

/// The hull of points, or the box round them if they span none.
fn hull(points: &[pm::Vector]) -> Hull {
    let inside = points[0];
    let reach = points.iter().map(|p| p.length()).fold(0.0, f64::max);
    let solid = polyhedron(points).or_else(|| {
        let (low, high) = box_round(points);
        let (low, high) = (low - pm::Vector::splat(FLAT), high + pm::Vector::splat(FLAT));
        let side = |k: usize, i: usize| if k >> i & 1 == 1 { high[i] } else { low[i] };
        let corners: Vec<_> = (0..8).map(|k| pm::Vector::new(side(k, 0), side(k, 1), side(k, 2))).collect();
        polyhedron(&corners)
    });
    let slack = solid.as_ref().map_or(0.0, |solid| slack(solid, points));
    Hull { solid, slack, reach, inside }
}

fn box_round(points: &[pm::Vector]) -> (pm::Vector, pm::Vector) {
    let start = (pm::Vector::splat(f64::INFINITY), pm::Vector::splat(f64::NEG_INFINITY));
    points.iter().fold(start, |(low, high), p| (low.min(*p), high.max(*p)))
}

fn box_volume(points: &[pm::Vector]) -> f64 {
    let (low, high) = box_round(points);
    (high - low).element_product()
}

/// Half the thickness of the box round a flat part, m.
const FLAT: f64 = 1e-6;

/// None if the points span no volume that counts.
fn polyhedron(points: &[pm::Vector]) -> Option<ConvexPolyhedron> {
    // Its hull checks itself by assertions: a mesh of a user must not end the program.
    let made = std::panic::catch_unwind(|| ConvexPolyhedron::from_convex_hull(points));
    made.ok().flatten()
}

/// How far the farthest of the points lies outside, m.
fn slack(solid: &ConvexPolyhedron, points: &[pm::Vector]) -> f64 {
    let outside = points.iter().map(|p| solid.distance_to_local_point(*p, true));
    let most = outside.fold(0.0, f64::max);
    // Vertices are at distance 0 up to rounding.
    if most < 1e-12 { 0.0 } else { most }
}

fn volume_of(solid: &ConvexPolyhedron) -> f64 {
    let (points, triangles) = solid.to_trimesh();
    let at = |i: u32| points[i as usize];
    triangles.iter().map(|&[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

fn vector(v: &Vector3<f64>) -> pm::Vector {
    pm::Vector::new(v.x, v.y, v.z)
}
