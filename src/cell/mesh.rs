//! Triangle meshes of equipment, from Wavefront OBJ.

use super::document::Library;
use super::fault::{Severity, shown};
use super::reader::Table;
use super::shape::Shape;
use super::tree::At;
use super::value::text;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Most triangles of one mesh.
const MAX_TRIANGLES: usize = 1_000_000;

/// Farthest believable coordinate, m.
const MAX_COORDINATE: f64 = 1e4;

/// Reads `mesh = { file, units, centre_mm, rpy_deg }`; `file` is relative to the naming file.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let pose = t.pose("centre_mm", lib);
    let scale = t.choice("units", &["mm", "m", "inch"], |u| u, None, lib).map(|u| match u {
        "mm" => 1e-3,
        "inch" => 0.0254,
        _ => 1.0,
    });
    let node = t.need("file", "add file = \"NAME.obj\"")?;
    let name = text(node, "file", lib)?;
    if !name.to_ascii_lowercase().ends_with(".obj") {
        let message = format!("`{}` is not an OBJ file", shown(&name));
        lib.error(node.at, message, "export the mesh as Wavefront OBJ");
        return None;
    }
    let path = lib.relative(&name, node.at)?;
    let file = lib.text(&path, Some(node.at))?;
    let (vertices, mut triangles) = match parse_obj(&lib.sources[file].text, scale?) {
        Ok(mesh) => mesh,
        Err((line, why)) => {
            let start = |line| lib.sources[file].text.split_inclusive('\n').take(line).map(str::len).sum();
            let (at, why) = match line {
                Some(line) => (At { file, offset: start(line) }, why),
                None => (node.at, format!("mesh `{}`: {why}", shown(&path))),
            };
            let help = "export the mesh anew as Wavefront OBJ, and look at it in a mesh viewer";
            lib.error(at, why, help);
            return None;
        }
    };
    let closed = is_closed(&triangles);
    if !closed {
        let message = format!("mesh `{}` is not a closed surface", shown(&path));
        let help = "its inside is not solid, a link wholly inside would not be seen: close its holes";
        lib.fault(node.at, Severity::Warning, message, help);
    } else if signed_volume(&vertices, &triangles) < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Some(Shape::Mesh { pose: pose?, vertices, triangles, closed })
}

type Vertices = Vec<Vector3<f64>>;
type Triangles = Vec<[u32; 3]>;

/// What is wrong with a mesh, and in which line of its file (from 0).
type Wrong = (Option<usize>, String);

/// Vertices (scaled to m) and triangles of an OBJ text. Vertices at the same place become one.
fn parse_obj(text: &str, scale: f64) -> Result<(Vertices, Triangles), Wrong> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let geometry = geometry_of(text);
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
    let beyond = |c: f64| c.is_nan() || c.abs() >= MAX_COORDINATE;
    if vertices.iter().any(|v: &Vector3<f64>| v.iter().any(|c| beyond(*c))) {
        let line = line_with(&geometry, "v", |c| c.parse().is_ok_and(|c: f64| beyond(c * scale)));
        return Err((line, "a vertex that is no finite point of a workcell; is the unit right?".into()));
    }
    if triangles.len() > MAX_TRIANGLES {
        let why = format!("{} triangles, at most {MAX_TRIANGLES} are taken: simplify it", triangles.len());
        return Err((None, why));
    }
    let (vertices, mut triangles) = merged(vertices, triangles);
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    if triangles.is_empty() {
        return Err((None, "no triangle in it".into()));
    }
    Ok((vertices, triangles))
}

/// The vertices and faces of an OBJ text, line by line: nothing else of it is used, and indices of
/// texture and normals can make the reader overflow.
fn geometry_of(text: &str) -> String {
    let mut geometry = String::with_capacity(text.len());
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
            let index = word.split('/').next().filter(|w| !w.is_empty());
            geometry.push(' ');
            geometry.push_str(index.unwrap_or("?"));
        }
        geometry.push('\n');
    }
    geometry
}

/// The reader's error in words, and its line: the last one `read`, but faces are followed at the end.
fn explained(e: tobj::LoadError, geometry: &str, read: usize) -> Wrong {
    let last = geometry[..read].lines().count().checked_sub(1);
    match e {
        tobj::LoadError::PositionParseError => (last, "a vertex needs three numbers".into()),
        tobj::LoadError::FaceParseError => (last, "a face needs the whole numbers of its vertices".into()),
        tobj::LoadError::FaceVertexOutOfBounds => {
            let count = geometry.lines().filter(|l| l.starts_with('v')).count() as u64;
            let is_none = |i: i64| i == 0 || i.unsigned_abs() > count;
            let line = line_with(geometry, "f", |i| i.parse().is_ok_and(is_none));
            (line, format!("a face with a vertex that is not there (the file has {count})"))
        }
        other => (None, shown(&other.to_string())),
    }
}

/// The first line of a kind of which a word after the first is `wrong`.
fn line_with(geometry: &str, kind: &str, wrong: impl Fn(&str) -> bool) -> Option<usize> {
    let has = |line: &str| line.starts_with(kind) && line.split(' ').skip(1).any(&wrong);
    geometry.lines().position(has)
}

/// One vertex for all at the same place, in order of first use.
fn merged(vertices: Vertices, triangles: Triangles) -> (Vertices, Triangles) {
    let mut known: HashMap<[u64; 3], u32> = HashMap::new();
    let mut kept = Vec::new();
    let index: Vec<u32> = vertices
        .iter()
        .map(|v| {
            // Adding 0 makes -0 and 0 the same bits.
            let key = [(v.x + 0.0).to_bits(), (v.y + 0.0).to_bits(), (v.z + 0.0).to_bits()];
            *known.entry(key).or_insert_with(|| {
                kept.push(*v);
                (kept.len() - 1) as u32
            })
        })
        .collect();
    let renamed = triangles.into_iter().map(|t| t.map(|i| index[i as usize])).collect();
    (kept, renamed)
}

/// Whether every edge is used once in each direction: a closed, consistently oriented surface.
fn is_closed(triangles: &Triangles) -> bool {
    let mut balance: HashMap<(u32, u32), (i32, i32)> = HashMap::new();
    for &[a, b, c] in triangles {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            let edge = balance.entry((i.min(j), i.max(j))).or_default();
            if i < j { edge.0 += 1 } else { edge.1 += 1 }
        }
    }
    balance.values().all(|&(forth, back)| forth == 1 && back == 1)
}

fn signed_volume(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> f64 {
    let v = |i: u32| &vertices[i as usize];
    triangles.iter().map(|&[a, b, c]| v(a).dot(&v(b).cross(v(c))) / 6.0).sum()
}
