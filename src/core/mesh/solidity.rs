//! Solidity of a mesh: whether its triangles bound a solid.

use super::triangles::Triangles;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Answer to the question whether a surface bounds a solid: a solid, or one of two faults of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solidity {
    Solid,
    /// The surface encloses this many cavities. A cavity is a closed shell inside another shell, with normals
    /// that point into the cavity.
    Hollow(usize),
    /// The surface has a hole, an edge that more than two triangles share, or neighbouring triangles of
    /// opposite orientation.
    Open,
}

impl Solidity {
    /// Returns the fault of the surface and its consequence, in words; None for a solid.
    pub fn warning(self) -> Option<(String, &'static str)> {
        match self {
            Self::Solid => None,
            Self::Hollow(1) => Some(("encloses a cavity".into(), HOLLOW)),
            Self::Hollow(n) => Some((format!("encloses {n} cavities"), HOLLOW)),
            Self::Open => Some(("is not a closed surface".into(), OPEN)),
        }
    }
}

const HOLLOW: &str =
    "an object wholly inside a cavity is not detected as a collision: remove the inner walls";
const OPEN: &str = "close the holes: an object wholly inside an open mesh is not detected as a collision";

/// Returns whether the surface bounds a solid.
///
/// The function also orients the triangles of a closed surface, so that the normals point out of the solid.
/// If the enclosed volume is negative, all triangles are reversed. Afterwards, every shell with inward
/// normals is reversed, unless the shell is a cavity ([`Solidity::Hollow`]).
pub fn solidity(vertices: &[Vector3<f64>], triangles: &mut Triangles) -> Solidity {
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

/// Returns, for every triangle, the number of its shell. A shell is a set of triangles connected by
/// vertices.
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

/// Returns the representative vertex of a shell (union-find with path halving).
fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        let above = parent[parent[vertex as usize] as usize];
        parent[vertex as usize] = above;
        vertex = above;
    }
    vertex
}

/// Returns whether the surface is closed and consistently oriented.
///
/// In such a surface, every edge is used once in each direction.
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

/// Returns the volume inside a closed surface. The volume is negative if the normals of the surface point
/// inwards.
fn signed_volume(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> f64 {
    let v = |i: u32| &vertices[i as usize];
    triangles.iter().map(|&[a, b, c]| v(a).dot(&v(b).cross(v(c))) / 6.0).sum()
}
