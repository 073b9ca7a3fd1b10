//! Triangle meshes of equipment and links: reading them, and whether they bound a solid.

mod obj;
mod stl;

use super::fault::{Severity, shown};
use super::toml::document::Library;
use super::toml::reader::Table;
use super::toml::tree::At;
use super::toml::value::text;
use crate::cell::Shape;

use crate::pose::Pose;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Most triangles of one mesh.
pub const MAX_TRIANGLES: usize = 200_000;

/// What a unit of a mesh file may be.
pub const UNITS: [&str; 3] = ["mm", "m", "inch"];

/// Farthest believable coordinate, m.
const MAX_COORDINATE: f64 = 1e4;

pub const BEYOND: &str = "a vertex that is no finite point of a workcell; is the unit right?";

pub type Vertices = Vec<Vector3<f64>>;
pub type Triangles = Vec<[u32; 3]>;

/// What is wrong with a mesh, and in which line of its file (from 0).
pub type Wrong = (Option<usize>, String);

/// Whether a coordinate (m) is none of a workcell.
pub fn is_beyond(coordinate: f64) -> bool {
    coordinate.is_nan() || coordinate.abs() >= MAX_COORDINATE
}

pub fn too_many() -> String {
    format!("more than {MAX_TRIANGLES} triangles: simplify it, a coarse mesh collides much faster")
}

/// Reads `mesh = { file, units, centre_mm, rpy_deg }`; `file` is relative to the naming file.
pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Shape> {
    let pose = t.pose("centre_mm", lib);
    let scale = t.choice("units", &UNITS, |u| u, None, lib).map(|u| match u {
        "mm" => 1e-3,
        "inch" => 0.0254,
        _ => 1.0,
    });
    let node = t.need("file", "add file = \"NAME.stl\" or \"NAME.obj\"")?;
    let name = text(node, "file", lib)?;
    is_mesh(&name, node.at, lib).then_some(())?;
    let path = lib.relative(&name, node.at)?;
    load(&path, node.at, &Vector3::repeat(scale?), pose?, lib)
}

/// Whether the name is that of a mesh that can be read; a fault if not.
pub fn is_mesh(name: &str, at: At, lib: &mut Library<'_>) -> bool {
    let lower = name.to_ascii_lowercase();
    let known = [".obj", ".stl"].iter().any(|end| lower.ends_with(end));
    if !known {
        let message = format!("`{}` is no OBJ or STL file", shown(name));
        lib.error(at, message, "export the mesh as STL or Wavefront OBJ");
    }
    known
}

/// The mesh in the file at `path`, named at `at`, its coordinates times `scale` in m.
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

/// The vertices of a mesh file (in m, each place once) and its triangles.
fn read_file(path: &str, at: At, scale: f64, lib: &mut Library<'_>) -> Option<(Vertices, Triangles)> {
    let is_obj = path.to_ascii_lowercase().ends_with(".obj");
    let file = if is_obj { lib.text(path, Some(at))? } else { lib.file(path, Some(at))? };
    let source = &lib.sources[file];
    let raw = if is_obj { obj::parse(source.text(), scale) } else { stl::parse(&source.bytes, scale) };
    match raw.and_then(|(vertices, triangles)| merged(vertices, triangles)) {
        Ok(mesh) => Some(mesh),
        Err((line, why)) => {
            let start = |line| source.text().split_inclusive('\n').take(line).map(str::len).sum();
            let (at, why) = match line.filter(|_| !source.text().is_empty()) {
                Some(line) => (At { file, offset: start(line) }, why),
                None => (at, format!("mesh `{}`: {why}", shown(path))),
            };
            let kind = if is_obj { "Wavefront OBJ" } else { "STL" };
            let help = format!("export the mesh anew as {kind}, and look at it in a mesh viewer");
            lib.error(at, why, help);
            None
        }
    }
}

/// One vertex for all at the same place, in order of first use; triangles without area by their
/// corners are left out.
fn merged(vertices: Vertices, mut triangles: Triangles) -> Result<(Vertices, Triangles), Wrong> {
    // Adding 0 makes -0 and 0 the same bits.
    let bits = |i: u32| vertices[i as usize].map(|c| (c + 0.0).to_bits()).data.0[0];
    // Sorted and not hashed: a map of all places takes more memory than everything else.
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
        0 => Err((None, "no triangle in it".into())),
        n if n > MAX_TRIANGLES => Err((None, too_many())),
        _ => Ok((kept, triangles)),
    }
}

/// Whether a surface bounds a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Solidity {
    Solid,
    /// Closed shells lie in others with their outside inwards: hollows.
    Hollow(usize),
    /// There are holes, edges of three triangles, or sides that do not agree.
    Open,
}

impl Solidity {
    fn warning(self) -> Option<(String, &'static str)> {
        match self {
            Self::Solid => None,
            Self::Hollow(1) => Some(("has a hollow inside".into(), HOLLOW)),
            Self::Hollow(n) => Some((format!("has {n} hollows inside"), HOLLOW)),
            Self::Open => Some(("is not a closed surface".into(), OPEN)),
        }
    }
}

const HOLLOW: &str = "what lies wholly in a hollow touches nothing: remove its inner walls to make it solid";
const OPEN: &str = "its inside is not solid, a link wholly inside would not be seen: close its holes";

/// Whether the surface is that of a solid; it, and shells that lie in no other, are turned outside
/// outwards.
fn solidity(vertices: &[Vector3<f64>], triangles: &mut Triangles) -> Solidity {
    if !is_closed(triangles) {
        return Solidity::Open;
    }
    if signed_volume(vertices, triangles) < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let shell_of = shells(vertices.len(), triangles);
    let count = shell_of.iter().max().map_or(0, |last| last + 1);
    let mut volumes = vec![0.0; count];
    let none = Vector3::repeat(f64::INFINITY);
    let mut bounds = vec![(none, -none); count];
    for (t, &shell) in triangles.iter().zip(&shell_of) {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        volumes[shell] += signed_volume(vertices, std::slice::from_ref(t));
        let (low, high) = bounds[shell];
        bounds[shell] = (low.inf(&a.inf(&b).inf(&c)), high.sup(&a.sup(&b).sup(&c)));
    }
    let holds = |(low, high): &(Vector3<f64>, Vector3<f64>), shell: usize| {
        let (l, h) = bounds[shell];
        (0..3).all(|k| low[k] < l[k] && h[k] < high[k])
    };
    let inner = |shell: usize| bounds.iter().any(|outer| holds(outer, shell));
    let hollows: Vec<bool> = (0..count).map(|k| volumes[k] < 0.0 && inner(k)).collect();
    for (t, &shell) in triangles.iter_mut().zip(&shell_of) {
        if volumes[shell] < 0.0 && !hollows[shell] {
            t.swap(1, 2);
        }
    }
    match hollows.iter().filter(|h| **h).count() {
        0 => Solidity::Solid,
        n => Solidity::Hollow(n),
    }
}

/// For every triangle the number of its shell: triangles that hang together by vertices.
fn shells(vertices: usize, triangles: &Triangles) -> Vec<usize> {
    let mut parent: Vec<u32> = (0..vertices as u32).collect();
    for t in triangles {
        for pair in t.windows(2) {
            let (a, b) = (root(&mut parent, pair[0]), root(&mut parent, pair[1]));
            parent[a as usize] = b;
        }
    }
    let mut numbers = HashMap::new();
    let number = |t: &[u32; 3]| {
        let next = numbers.len();
        *numbers.entry(root(&mut parent, t[0])).or_insert(next)
    };
    triangles.iter().map(number).collect()
}

/// The vertex that stands for all of a shell; the way there is halved as it is walked.
fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        let above = parent[parent[vertex as usize] as usize];
        parent[vertex as usize] = above;
        vertex = above;
    }
    vertex
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

/// Volume inside a closed surface, negative if its outside is inwards.
fn signed_volume(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> f64 {
    let v = |i: u32| &vertices[i as usize];
    triangles.iter().map(|&[a, b, c]| v(a).dot(&v(b).cross(v(c))) / 6.0).sum()
}
