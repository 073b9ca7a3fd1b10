//! Mesh files that cells and robots name.

use super::content::{FileContent, conversion, not_needed};
use super::fault::{Severity, shown};
use super::toml::document::Library;
use super::toml::tree::At;
use crate::cell::Shape;
use crate::mesh::{Solidity, Triangles, Vertices, from_obj, from_stl, solidity};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Returns whether the file name ends with `.obj` or `.stl`; records a fault if not.
pub fn is_mesh(name: &str, at: At, lib: &mut Library<'_>) -> bool {
    let lower = name.to_ascii_lowercase();
    let known = [".obj", ".stl"].iter().any(|end| lower.ends_with(end));
    if !known {
        let message = format!("`{}` is not an OBJ or STL file", shown(name));
        let is_step = [".step", ".stp"].iter().any(|end| lower.ends_with(end));
        let help = match lower.ends_with(".dae") || is_step {
            true => format!("convert it: {}", conversion(&shown(name))),
            false => "export the mesh as STL or Wavefront OBJ".into(),
        };
        lib.error(at, message, help);
    }
    known
}

/// Reads the mesh in the file at `path` and multiplies its coordinates by `scale`, which converts them to m.
///
/// `at` is the place where the file is named; faults point to this place.
pub fn load(path: &str, at: At, scale: &Vector3<f64>, pose: Pose, lib: &mut Library<'_>) -> Option<Shape> {
    let (mut vertices, mut triangles) = read_file(path, at, scale.amax(), lib)?;
    let even = scale / scale.amax();
    vertices.iter_mut().for_each(|v| v.component_mul_assign(&even));
    let kind = solidity(&vertices, &mut triangles);
    if let Some((message, help)) = kind.warning() {
        lib.fault(at, Severity::Warning, format!("mesh `{}` {message}", shown(path)), help);
    }
    let closed = kind != Solidity::Open;
    Some(Shape::Mesh { pose, vertices, triangles, closed })
}

/// Returns the vertices of a mesh file (multiplied by `scale`, duplicates merged) and its triangles.
fn read_file(path: &str, at: At, scale: f64, lib: &mut Library<'_>) -> Option<(Vertices, Triangles)> {
    let is_obj = path.to_ascii_lowercase().ends_with(".obj");
    let file = if is_obj { lib.text(path, Some(at))? } else { lib.file(path, Some(at))? };
    let wanted = if is_obj { FileContent::Obj } else { FileContent::Stl };
    if let Some(content) =
        FileContent::of(&lib.sources[file].bytes).filter(|content| content.is_shape() && *content != wanted)
    {
        let message = not_needed(path, content, wanted.in_words());
        lib.error(at, message, "give the file the extension of its format, .stl or .obj");
        return None;
    }
    let source = &lib.sources[file];
    match if is_obj { from_obj(source.text(), scale) } else { from_stl(&source.bytes, scale) } {
        Ok(mesh) => Some(mesh),
        Err((line, why)) => {
            let start = |line| source.text().split_inclusive('\n').take(line).map(str::len).sum();
            let (at, why) = match line.filter(|_| !source.text().is_empty()) {
                Some(line) => (At { file, offset: start(line) }, why),
                None => (at, format!("mesh `{}`: {why}", shown(path))),
            };
            let kind = if is_obj { "Wavefront OBJ" } else { "STL" };
            let help = format!("export the mesh again as {kind}, and check it in a mesh viewer");
            lib.error(at, why, help);
            None
        }
    }
}
