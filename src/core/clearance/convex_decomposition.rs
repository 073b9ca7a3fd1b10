//! Convex decomposition of link meshes: convex parts whose union contains the mesh.
//!
//! Every triangle belongs to one part, and a part is the convex hull of its triangles. So the parts contain
//! the whole surface, however the triangles are divided among them. A cached assignment of triangles to parts
//! is therefore safe if it names one part for each triangle.
//!
//! The decomposition is conservative: a part that bridges a hollow may collide where the mesh does not.

use nalgebra::Vector3;
use parry3d::math as pm;
use parry3d::query::PointQuery;
use parry3d::shape::{ConvexPolyhedron, RoundShape, SharedShape};

/// Largest number of parts of a mesh. This number is limited because each part is checked against every
/// solid.
const MAX_PARTS: usize = 16;

/// Least reduction of the total volume of the hulls, as a share of the volume of the mesh's hull. A cut of
/// one part into two must achieve this reduction.
const MIN_GAIN: f64 = 0.01;

/// Largest number of points from which the volume of a hull is estimated.
const MAX_POINTS: usize = 400;

/// Cache function: returns the bytes stored for a key, or the bytes that the given function computes.
///
/// The bytes may come from any storage, because this module validates them.
pub type Remember<'a> = dyn FnMut(&[u8], &dyn Fn() -> Vec<u8>) -> Vec<u8> + 'a;

/// Convex solid that contains the points of one part of a mesh.
pub(super) struct Hull {
    /// Convex hull of the points of the part, or their bounding box if they span no volume.
    ///
    /// The field is None if parry3d can compute neither.
    solid: Option<ConvexPolyhedron>,
    /// Largest distance, m, by which a point of the part lies outside the hull.
    slack: f64,
    /// Distance from the origin of the mesh frame to the farthest point of the part, m.
    reach: f64,
    /// First point of the part; it represents the hull in tests whether one solid lies inside another.
    pub(super) inside: pm::Vector,
}

impl Hull {
    /// Returns the hull enlarged by `by` (m), and how it was enlarged.
    ///
    /// The second value is the shape before its rounding and the radius (m) of the rounding. The second value
    /// is None if the returned shape has no rounding.
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

/// Returns the convex parts of a mesh.
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

/// Returns a closed mesh as one convex solid, or None if it is not convex or has too many vertices.
///
/// The solid equals the mesh, and checking the solid is much faster than checking the triangles.
pub(super) fn convex(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Option<SharedShape> {
    /// Number of vertices above which a check of the convex solid costs more than a check of the triangles.
    const MAX_VERTICES: usize = 200;
    /// Largest relative difference in volume between a convex mesh and its hull, due to rounded coordinates.
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

/// Returns, for every triangle, the index of the part to which it belongs.
///
/// The function repeatedly cuts one part into two. It makes the cut that reduces the total volume of the
/// hulls the most. Nine cuts of each part are tried, three for each axis. For each axis, the triangles of the
/// part are sorted along the axis. The sorted list is cut after one, two or three quarters.
fn division(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Vec<u8> {
    let centre = |t: u32| triangles[t as usize].iter().map(|&i| vertices[i as usize]).sum::<Vector3<f64>>();
    let volume = |part: &[u32]| {
        let step = (3 * part.len()).div_ceil(MAX_POINTS).max(1);
        let corners = part.iter().flat_map(|&t| triangles[t as usize]).step_by(step);
        let points: Vec<_> = corners.map(|i| vector(&vertices[i as usize])).collect();
        // The computed hull of a long thin set of points may be missing or inverted. In that case, the volume
        // of the bounding box is used.
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
    let least = MIN_GAIN * volume(&everything);
    let mut parts = vec![(cut(&everything), everything)];
    while parts.len() < MAX_PARTS {
        let gain = |k: usize| parts[k].0.as_ref().map_or(0.0, |c| c.0);
        let best = (0..parts.len()).max_by(|&a, &b| gain(a).total_cmp(&gain(b)).then(b.cmp(&a)));
        let Some(best) = best.filter(|&k| gain(k) > least) else { break };
        let Some((_, first, second)) = parts.swap_remove(best).0 else { break };
        parts.extend([first, second].map(|half| (cut(&half), half)));
    }
    let mut part_of = vec![0; triangles.len()];
    for (k, (_, part)) in parts.iter().enumerate() {
        part.iter().for_each(|&t| part_of[t as usize] = k as u8);
    }
    part_of
}

/// Returns the cache key: everything that the result of [`division`] depends on.
fn key(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Vec<u8> {
    let mut key = b"sweetspot division 1\n".to_vec();
    key.extend(vertices.iter().flat_map(|v| [v.x, v.y, v.z]).flat_map(f64::to_le_bytes));
    key.extend(triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
    key
}

/// Returns the hull of points, or their bounding box if they span no volume.
fn hull(points: &[pm::Vector]) -> Hull {
    let inside = points[0];
    let reach = points.iter().map(|p| p.length()).fold(0.0, f64::max);
    let solid = polyhedron(points).or_else(|| {
        let (low, high) = box_round(points);
        let (low, high) = (low - pm::Vector::splat(FLAT_HALF), high + pm::Vector::splat(FLAT_HALF));
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

/// Half the thickness of the bounding box of a flat part, m.
const FLAT_HALF: f64 = 1e-6;

/// Returns the convex hull of points; None if they span no significant volume.
fn polyhedron(points: &[pm::Vector]) -> Option<ConvexPolyhedron> {
    // parry3d panics if its hull fails an assertion. The mesh of a user must not abort the program.
    let made = std::panic::catch_unwind(|| ConvexPolyhedron::from_convex_hull(points));
    made.ok().flatten()
}

/// Returns the largest distance, m, by which any of the points lies outside the hull.
fn slack(solid: &ConvexPolyhedron, points: &[pm::Vector]) -> f64 {
    let outside = points.iter().map(|p| solid.distance_to_local_point(*p, true));
    let most = outside.fold(0.0, f64::max);
    // Vertices of the hull are at distance 0, up to rounding.
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
