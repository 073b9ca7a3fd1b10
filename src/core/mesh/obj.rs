//! Reader of the vertices and faces of Wavefront OBJ text.

use super::triangles::{BEYOND, MAX_TRIANGLES, MeshFault, Triangles, Vertices, is_beyond, too_many};
use crate::safe_text::shown;
use nalgebra::Vector3;

/// Returns the vertices (scaled to m) and the triangles of an OBJ text.
pub fn parse(text: &str, scale: f64) -> Result<(Vertices, Triangles), MeshFault> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let geometry = geometry_of(text)?;
    let mut rest = geometry.as_bytes();
    let loaded = tobj::load_obj_buf(&mut rest, &options, |_| Ok(Default::default()));
    let read = geometry.len() - rest.len();
    let (models, _) = loaded.map_err(|e| explained(e, &geometry, read))?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for model in &models {
        let first = vertices.len() as u32;
        vertices.extend(model.mesh.positions.chunks_exact(3).map(|v| Vector3::new(v[0], v[1], v[2]) * scale));
        triangles
            .extend(model.mesh.indices.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]));
    }
    let beyond = |c: f64| is_beyond(c * scale);
    if vertices.iter().any(|v: &Vector3<f64>| v.iter().any(|c| is_beyond(*c))) {
        return Err((line_with(&geometry, "v", |c| c.parse().is_ok_and(beyond)), BEYOND.into()));
    }
    Ok((vertices, triangles))
}

/// Returns only the vertices and faces of an OBJ text, line by line.
///
/// Everything else is dropped, because indices of textures and normals can make the OBJ reader overflow.
fn geometry_of(text: &str) -> Result<String, MeshFault> {
    let mut geometry = String::with_capacity(text.len());
    let (mut vertices, mut corners) = (0, 0);
    for line in text.lines() {
        let mut words = line.split_whitespace().take_while(|w| !w.starts_with('#'));
        let kind = words.next().filter(|w| ["v", "f"].contains(w));
        geometry.push_str(kind.unwrap_or(""));
        let used = words.take(match kind {
            Some("v") => 3,
            Some(_) => usize::MAX,
            None => 0,
        });
        for word in used {
            corners += usize::from(kind == Some("f"));
            let index = word.split('/').next().filter(|w| !w.is_empty());
            geometry.push(' ');
            geometry.push_str(index.unwrap_or("?"));
        }
        geometry.push('\n');
        vertices += usize::from(kind == Some("v"));
        // The number of vertices is checked before the reader allocates memory.
        if vertices.max(corners) > 3 * MAX_TRIANGLES {
            return Err((None, too_many()));
        }
    }
    Ok(geometry)
}

/// Returns a description of the error of the OBJ reader, with the line of the error.
///
/// The OBJ reader stops in the faulty line. The argument `read` is the number of bytes that the reader took
/// before it stopped. The last line of these bytes is the faulty line. The reader checks the vertices of
/// faces only at the end. This function therefore searches for the face with a bad vertex.
fn explained(e: tobj::LoadError, geometry: &str, read: usize) -> MeshFault {
    let last = geometry[..read].lines().count().checked_sub(1);
    match e {
        tobj::LoadError::PositionParseError => (last, "a vertex needs three numbers".into()),
        tobj::LoadError::FaceParseError => (last, "a face must refer to its vertices by integers".into()),
        tobj::LoadError::FaceVertexOutOfBounds => {
            let count = geometry.lines().filter(|l| l.starts_with('v')).count() as u64;
            let is_none = |i: i64| i == 0 || i.unsigned_abs() > count;
            let line = line_with(geometry, "f", |i| i.parse().is_ok_and(is_none));
            (
                line,
                format!(
                    "a face refers to a vertex that does not exist (number of vertices in the file: {count})"
                ),
            )
        }
        other => (None, shown(&other.to_string())),
    }
}

/// Returns the index of the first line that begins with `kind` and contains a faulty word. The function
/// `wrong` tests every word after the first word.
fn line_with(geometry: &str, kind: &str, wrong: impl Fn(&str) -> bool) -> Option<usize> {
    let has = |line: &str| line.starts_with(kind) && line.split(' ').skip(1).any(&wrong);
    geometry.lines().position(has)
}
