//! Vertices and triangles as mesh files give them.

use nalgebra::Vector3;

/// Largest number of triangles of one mesh.
pub const MAX_TRIANGLES: usize = 200_000;

/// Upper limit of the absolute value of each vertex coordinate, m. Every workcell is far smaller than
/// this limit.
const MAX_COORDINATE: f64 = 1e4;

/// Message for a vertex that is not finite or is too far away.
pub const BEYOND: &str =
    "a coordinate of a vertex is not finite, or is too large for a workcell; is the unit right?";

/// Vertices of a mesh, m.
pub type Vertices = Vec<Vector3<f64>>;
/// Triangles of a mesh, each as the indices of its three vertices.
pub type Triangles = Vec<[u32; 3]>;

/// Fault of a mesh file: its line (counted from 0) if known, and a description.
pub type MeshFault = (Option<usize>, String);

/// Returns whether a coordinate (m) is NaN or too large for a workcell.
pub fn is_beyond(coordinate: f64) -> bool {
    coordinate.is_nan() || coordinate.abs() >= MAX_COORDINATE
}

/// Returns the message for a mesh with too many triangles.
pub fn too_many() -> String {
    format!(
        "more than {MAX_TRIANGLES} triangles: simplify the mesh, which also makes collision checks much faster"
    )
}

/// Merges vertices at the same place, and keeps the order in which each place first occurs.
///
/// Triangles with two equal corners are left out.
pub fn merged((vertices, mut triangles): (Vertices, Triangles)) -> Result<(Vertices, Triangles), MeshFault> {
    // The addition of 0 gives -0 and 0 the same bits.
    let bits = |i: u32| vertices[i as usize].map(|c| (c + 0.0).to_bits()).data.0[0];
    // Sorting saves memory. A hash map of all places would use more memory than everything else.
    let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (bits(i), i));
    let mut first = vec![0; vertices.len()];
    for alike in order.chunk_by(|&i, &k| bits(i) == bits(k)) {
        alike.iter().for_each(|&i| first[i as usize] = alike[0]);
    }
    let (mut kept, mut index) = (Vec::new(), vec![0; vertices.len()]);
    for (i, vertex) in vertices.iter().enumerate() {
        if first[i] == i as u32 {
            index[i] = kept.len() as u32;
            kept.push(*vertex);
        }
        index[i] = index[first[i] as usize];
    }
    triangles.iter_mut().for_each(|t| *t = t.map(|i| index[i as usize]));
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    match triangles.len() {
        0 => Err((None, "the file has no triangles".into())),
        n if n > MAX_TRIANGLES => Err((None, too_many())),
        _ => Ok((kept, triangles)),
    }
}
