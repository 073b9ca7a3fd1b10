//! Solids seen from one side: what they cover of the picture.

use super::canvas::path;
use super::iso::Point;
use crate::drawing::Mesh;

/// A mesh with more triangles is drawn as the hull of its points.
const MOST: usize = 1500;

/// What a mesh covers, seen from one side: convex polygons, all turning one way; their union counts.
pub fn silhouette(mesh: &Mesh, seen: impl Fn(&nalgebra::Vector3<f64>) -> Point) -> Vec<Vec<Point>> {
    let points: Vec<Point> = mesh.positions.iter().map(seen).collect();
    if is_convex(mesh) || mesh.triangles.len() > MOST {
        return vec![hull(points)];
    }
    let corner = |k: u32| points[k as usize];
    let triangles = mesh.triangles.iter().map(|t| t.map(corner).to_vec());
    let turned = triangles.map(|mut t| {
        if turn(t[0], t[1], t[2]) < 0.0 {
            t.reverse();
        }
        t
    });
    turned.filter(|t| turn(t[0], t[1], t[2]) > 1e-12).collect()
}

/// Fill and outline of a union: the outline first and twice as wide, the fill over its inner half.
pub fn drawn(
    polygons: &[Vec<Point>],
    place: &impl Fn(&Point) -> (f64, f64),
    fill: &str,
    line: &str,
) -> String {
    let d: String = polygons.iter().map(|p| path(p.iter().map(place), "Z")).collect();
    if d.is_empty() {
        return String::new();
    }
    format!("<path d=\"{d}\" {line} stroke-linejoin=\"round\"/><path d=\"{d}\" {fill}/>")
}

/// Whether no corner lies before a face.
fn is_convex(mesh: &Mesh) -> bool {
    if mesh.triangles.len() > MOST {
        return false;
    }
    let size = mesh.extent().map_or(1.0, |(lo, hi)| (hi - lo).norm()).max(1e-9);
    mesh.triangles.iter().all(|t| {
        let [a, b, c] = t.map(|k| mesh.positions[k as usize]);
        let normal = (b - a).cross(&(c - a)).normalize();
        mesh.positions.iter().all(|p| normal.dot(&(p - a)) < 1e-6 * size)
    })
}

/// Twice the area of a triangle, above 0 if it turns to the left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0)
}

/// The convex hull, anticlockwise, by Andrew's monotone chains.
pub fn hull(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = &Point>| {
        let mut chain: Vec<Point> = Vec::new();
        for &p in points {
            while let [.., a, b] = chain[..] {
                if turn(a, b, p) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter());
    hull.extend(half(&mut points.iter().rev()));
    if hull.is_empty() { points } else { hull }
}
