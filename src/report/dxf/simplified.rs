//! Meshes with fewer triangles for CAD programs, which draw thousands of single faces slowly.

use crate::drawing::Mesh;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Greatest number of triangles of a part.
const MAX_TRIANGLES: usize = 1200;
/// Number of grid cells along the longest side of a part at the first attempt.
const CELLS: f64 = 64.0;

/// Returns the corners and triangles of a mesh with at most `MAX_TRIANGLES` triangles.
///
/// A finer mesh is simplified by vertex clustering (J. Rossignac and P. Borrel, Modeling in Computer Graphics
/// (1993) 455-465). The corners in one cell of a grid become their mean, and triangles that collapse are left
/// out.
pub fn simplified(mesh: &Mesh) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let mut cells = CELLS;
    let mut found = (mesh.positions.clone(), mesh.triangles.clone());
    while found.1.len() > MAX_TRIANGLES && cells >= 1.0 {
        found = clustered(mesh, cells);
        cells *= 0.8;
    }
    found
}

fn clustered(mesh: &Mesh, cells: f64) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let Some((low, high)) = mesh.extent() else { return (Vec::new(), Vec::new()) };
    let side = (high - low).amax().max(f64::MIN_POSITIVE) / cells;
    let mut numbers: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    let mut sums: Vec<(Vector3<f64>, f64)> = Vec::new();
    let number = |p: &Vector3<f64>| {
        let key = ((p - low) / side).map(|v| v.floor() as i64);
        let number = *numbers.entry([key.x, key.y, key.z]).or_insert_with(|| {
            sums.push((Vector3::zeros(), 0.0));
            sums.len() as u32 - 1
        });
        let (sum, count) = &mut sums[number as usize];
        *sum += p;
        *count += 1.0;
        number
    };
    let numbered: Vec<u32> = mesh.positions.iter().map(number).collect();
    let kept = mesh.triangles.iter().map(|t| t.map(|i| numbered[i as usize]));
    let mut triangles: Vec<[u32; 3]> = kept.filter(|[a, b, c]| a != b && b != c && a != c).collect();
    let sorted = |t: &[u32; 3]| {
        let mut t = *t;
        t.sort_unstable();
        t
    };
    triangles.sort_by_key(sorted);
    triangles.dedup_by_key(|t| sorted(t));
    (sums.into_iter().map(|(sum, count)| sum / count).collect(), triangles)
}
