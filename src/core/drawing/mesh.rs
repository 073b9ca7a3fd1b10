//! Triangle meshes of solids, with normals for shading.

use crate::cell::{Extent, Shape};
use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Number of sides of a round solid. The normals of neighbouring sides differ by less than 25 degrees
/// ([`CREASE`]). The solid is therefore shaded without visible edges.
const SIDES: usize = 32;

/// Cosine of 25 degrees. The edge between two faces is drawn sharp if their normals differ by at least this
/// angle.
const CREASE: f64 = 0.906_307_787_036_65;

/// Triangle mesh with one normal per corner. Corners with equal position and normal are merged. Positions
/// are in m.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    pub positions: Vec<Vector3<f64>>,
    /// Unit normals, one per corner, that point out of the solid.
    pub normals: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Returns the surface of a solid in the frame of its carrier. The argument `floor` is the height of the
    /// floor in that frame. A solid of the kind [`Shape::Leg`] stands on the floor, so its lower end is at
    /// this height.
    pub fn of(shape: &Shape, floor: f64) -> Self {
        let (vertices, triangles) = match shape {
            Shape::Box { pose, size } => cuboid(pose, size),
            Shape::Sphere { centre, radius } => bar(centre, centre, *radius, true),
            Shape::Capsule { a, b, radius } => bar(a, b, *radius, true),
            Shape::Cylinder { a, b, radius } => bar(a, b, *radius, false),
            Shape::Leg { x, y, size, top } => {
                let middle = Vector3::new(*x, *y, (top + floor) / 2.0);
                let size = Vector3::new(size.0, size.1, (top - floor).max(0.0));
                cuboid(&Pose { translation: middle, ..Pose::IDENTITY }, &size)
            }
            Shape::Mesh { pose, vertices, triangles, .. } => {
                (vertices.iter().map(|v| pose.transform(v)).collect(), triangles.clone())
            }
        };
        Self::creased(&vertices, &triangles)
    }

    /// Returns a mesh with normals for shading. The angle between two faces decides whether their edge is
    /// smooth or sharp.
    ///
    /// Triangles without area are left out.
    pub fn creased(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Self {
        let corner = |i: u32| vertices[i as usize];
        let area = |[a, b, c]: &[u32; 3]| (corner(*b) - corner(*a)).cross(&(corner(*c) - corner(*a)));
        let faces: Vec<([u32; 3], Vector3<f64>, Vector3<f64>)> = triangles
            .iter()
            .map(|t| (*t, area(t)))
            .filter_map(|(t, area)| Some((t, area, area.try_normalize(1e-30)?)))
            .collect();
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); vertices.len()];
        for (f, (t, ..)) in faces.iter().enumerate() {
            t.iter().for_each(|&i| around[i as usize].push(f as u32));
        }
        let mut mesh = Self::default();
        // Corners that were created from each vertex so far.
        let mut made: Vec<Vec<u32>> = vec![Vec::new(); vertices.len()];
        for (t, _, flat) in &faces {
            let corners = t.map(|i| {
                let near = around[i as usize].iter().map(|&f| &faces[f as usize]);
                let soft = near.filter(|(_, _, other)| other.dot(flat) > CREASE);
                let sum: Vector3<f64> = soft.map(|(_, area, _)| *area).sum();
                let normal = sum.try_normalize(1e-30).unwrap_or(*flat);
                mesh.corner(&corner(i), &normal, &mut made[i as usize])
            });
            mesh.triangles.push(corners);
        }
        mesh
    }

    fn corner(&mut self, at: &Vector3<f64>, normal: &Vector3<f64>, made: &mut Vec<u32>) -> u32 {
        let same = |&&i: &&u32| (self.normals[i as usize] - normal).norm_squared() < 1e-12;
        if let Some(&i) = made.iter().find(same) {
            return i;
        }
        let i = self.positions.len() as u32;
        self.positions.push(*at);
        self.normals.push(*normal);
        made.push(i);
        i
    }

    /// Returns the mesh in another frame. `pose` is the pose of the present frame in the new frame.
    pub fn seen_from(&self, pose: &Pose) -> Self {
        Self {
            positions: self.positions.iter().map(|p| pose.transform(p)).collect(),
            normals: self.normals.iter().map(|n| pose.rotation * n).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// Returns the bounding box of the mesh, m; None if the mesh is empty.
    pub fn extent(&self) -> Option<Extent> {
        let point = self.positions.iter().map(|p| (*p, *p));
        point.reduce(|(lo, hi), (p, q)| (lo.inf(&p), hi.sup(&q)))
    }
}

type Surface = (Vec<Vector3<f64>>, Vec<[u32; 3]>);

fn cuboid(pose: &Pose, size: &Vector3<f64>) -> Surface {
    let corner = |k: usize| {
        let side = |bit: usize| if k >> bit & 1 == 1 { 0.5 } else { -0.5 };
        pose.transform(&Vector3::new(side(0), side(1), side(2)).component_mul(size))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    ((0..8).map(corner).collect(), halves.collect())
}

/// Returns a round bar from `a` to `b`, m. The ends are hemispheres if `round` is true; otherwise they are
/// flat.
fn bar(a: &Vector3<f64>, b: &Vector3<f64>, radius: f64, round: bool) -> Surface {
    let axis = (b - a).try_normalize(1e-12).unwrap_or_else(Vector3::z);
    let across = axis.cross(&axis.map(|c| if c.abs() == axis.amax() { 0.0 } else { 1.0 })).normalize();
    let turned = Matrix3::from_columns(&[across, axis.cross(&across), axis]);
    // The rings run from the end at `a` to the end at `b`. Each ring has a radius and a centre.
    let cap = if round { SIDES / 4 } else { 1 };
    let lift = |k: usize| if round { FRAC_PI_2 * k as f64 / cap as f64 } else { 0.0 };
    let mut rings: Vec<(f64, Vector3<f64>)> = Vec::new();
    for k in (0..cap).rev() {
        rings.push((radius * lift(k).cos(), a - axis * (radius * lift(k).sin())));
    }
    let ends = if round { radius } else { 0.0 };
    // The two hemispheres of a ball share one equator.
    let first = if round && a == b { 1 } else { 0 };
    for k in first..cap {
        rings.push((radius * lift(k).cos(), b + axis * (radius * lift(k).sin())));
    }
    let mut vertices = vec![a - axis * ends];
    for (r, centre) in &rings {
        let turn = |k: usize| (TAU * k as f64 / SIDES as f64 - PI).sin_cos();
        vertices.extend((0..SIDES).map(|k| {
            let (sin, cos) = turn(k);
            centre + turned * Vector3::new(r * cos, r * sin, 0.0)
        }));
    }
    vertices.push(b + axis * ends);
    (vertices, bar_triangles(rings.len()))
}

/// Returns the triangles of a bar with `rings` rings of [`SIDES`] corners.
///
/// The bar begins and ends with a single point. The order of the corners is first point, rings, last point.
fn bar_triangles(rings: usize) -> Vec<[u32; 3]> {
    let at = |ring: usize, k: usize| (1 + ring * SIDES + k % SIDES) as u32;
    let last = (1 + rings * SIDES) as u32;
    let mut triangles = Vec::new();
    for k in 0..SIDES {
        triangles.push([0, at(0, k + 1), at(0, k)]);
        for ring in 0..rings - 1 {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([last, at(rings - 1, k), at(rings - 1, k + 1)]);
    }
    triangles
}
