//! Triangle meshes of equipment, from Wavefront OBJ.

use super::document::Library;
use super::fault::shown;
use super::model::Shape;
use super::reader::{Table, text};
use super::solid::read_pose;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Most triangles of one mesh.
const MAX_TRIANGLES: usize = 1_000_000;

/// Farthest believable coordinate, m.
const MAX_COORDINATE: f64 = 1e4;

/// Reads `mesh = { file, units, centre_mm, rpy_deg }`; `file` is relative to the naming file.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let pose = read_pose(t, "centre_mm", lib);
    let scale = t.choice("units", &["mm", "m", "inch"], |u| u, None, lib).map(|u| match u {
        "mm" => 1e-3,
        "inch" => 0.0254,
        _ => 1.0,
    });
    let node = t.need("file", lib)?;
    let name = text(node, "file", lib)?;
    if !name.to_ascii_lowercase().ends_with(".obj") {
        let message = format!("`{}` is not an OBJ file", shown(&name));
        lib.error(node.at, message, "export the mesh as Wavefront OBJ (triangles)");
        return None;
    }
    let path = lib.relative(&name, node.at)?;
    let file = lib.text(&path, Some(node.at))?;
    let parsed = parse_obj(&lib.sources[file].text, scale?);
    let (vertices, mut triangles) = match parsed {
        Ok(mesh) => mesh,
        Err(why) => {
            let help = "export it anew as triangles, and check it in a mesh viewer";
            lib.error(node.at, format!("mesh `{}`: {why}", shown(&path)), help);
            return None;
        }
    };
    let closed = is_closed(&triangles);
    if !closed {
        let message = format!("mesh `{}` is not a closed surface", shown(&path));
        let help = "its inside is not solid: a link wholly inside it would not be seen; close it";
        lib.fault(node.at, super::Severity::Warning, message, help);
    } else if signed_volume(&vertices, &triangles) < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Some(Shape::Mesh { pose: pose?, vertices, triangles, closed })
}

type Triangles = Vec<[u32; 3]>;

/// Vertices (scaled to m) and triangles of an OBJ text. Vertices at the same place become one.
fn parse_obj(text: &str, scale: f64) -> Result<(Vec<Vector3<f64>>, Triangles), String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) =
        tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials).map_err(|e| format!("{e}"))?;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for model in &models {
        let first = vertices.len() as u32;
        vertices.extend(model.mesh.positions.chunks_exact(3).map(|v| Vector3::new(v[0], v[1], v[2]) * scale));
        triangles
            .extend(model.mesh.indices.chunks_exact(3).map(|t| [first + t[0], first + t[1], first + t[2]]));
    }
    // A comparison that NaN fails, too.
    if let Some(i) = vertices.iter().position(|v: &Vector3<f64>| !v.iter().all(|c| c.abs() < MAX_COORDINATE))
    {
        return Err(format!("vertex {} is not a finite point of a workcell; is the unit right?", i + 1));
    }
    if triangles.len() > MAX_TRIANGLES {
        return Err(format!("{} triangles, at most {MAX_TRIANGLES} are taken: simplify it", triangles.len()));
    }
    let (vertices, mut triangles) = merged(vertices, triangles);
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    if triangles.is_empty() {
        return Err("no triangle in it".into());
    }
    Ok((vertices, triangles))
}

/// One vertex for all at the same place, in order of first use.
fn merged(vertices: Vec<Vector3<f64>>, triangles: Triangles) -> (Vec<Vector3<f64>>, Triangles) {
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
fn is_closed(triangles: &[[u32; 3]]) -> bool {
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
