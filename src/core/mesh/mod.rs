//! Triangle meshes of equipment and links. The module reads mesh files, writes STL files, and checks
//! whether a mesh bounds a solid.

mod obj;
mod solidity;
mod stl;
mod triangles;

pub use solidity::{Solidity, solidity};
pub use stl::to_stl;
pub use triangles::{MeshFault, Triangles, Vertices};

/// Returns the vertices (in m, duplicates merged) and the triangles of a Wavefront OBJ file.
///
/// The coordinates in the file are multiplied by `scale`, which converts them to m.
pub fn from_obj(text: &str, scale: f64) -> Result<(Vertices, Triangles), MeshFault> {
    obj::parse(text, scale).and_then(triangles::merged)
}

/// Returns the vertices (in m, duplicates merged) and the triangles of an STL file, binary or text.
///
/// The coordinates in the file are multiplied by `scale`, which converts them to m.
pub fn from_stl(bytes: &[u8], scale: f64) -> Result<(Vertices, Triangles), MeshFault> {
    stl::parse(bytes, scale).and_then(triangles::merged)
}
