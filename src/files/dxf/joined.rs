//! Closed outlines from open lines whose ends meet.

use super::entities::{PathVertex, PlanPath};
use nalgebra::Vector2;
use std::collections::HashMap;

/// Two ends count as one point if their distance is at most this value, m.
pub const JOINT: f64 = 1e-5;

/// Open path, with the line of the file at which it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenPath {
    pub vertices: Vec<PathVertex>,
    pub line: usize,
}

/// Returns the closed outlines that open paths form, and the paths that belong to no outline.
///
/// A joint is a point at which paths end. A chain of paths is an outline if exactly two ends meet at each
/// joint of the chain. The line number of an outline is the line of the file where its first path begins.
pub fn joined(paths: Vec<OpenPath>) -> (Vec<(PlanPath, usize)>, Vec<OpenPath>) {
    let ends = ends(&paths);
    let mut at_joint: HashMap<usize, Vec<usize>> = HashMap::new();
    for (k, [start, end]) in ends.iter().enumerate() {
        at_joint.entry(*start).or_default().push(k);
        at_joint.entry(*end).or_default().push(k);
    }
    let mut used = vec![false; paths.len()];
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    for first in 0..paths.len() {
        if used[first] {
            continue;
        }
        let [start, mut joint] = ends[first];
        let mut chain = vec![(first, false)];
        used[first] = true;
        while joint != start {
            let meeting = &at_joint[&joint];
            let next = meeting.iter().find(|k| !used[**k]).copied();
            let Some(next) = next.filter(|_| meeting.len() == 2) else { break };
            used[next] = true;
            let is_reversed = ends[next][1] == joint;
            joint = ends[next][usize::from(!is_reversed)];
            chain.push((next, is_reversed));
        }
        if joint == start && at_joint[&start].len() == 2 {
            let vertices = chain.iter().flat_map(|(k, back)| pieces(&paths[*k].vertices, *back)).collect();
            closed.push((PlanPath { vertices, is_closed: true }, paths[first].line));
        } else {
            open.extend(chain.iter().map(|(k, _)| paths[*k].clone()));
        }
    }
    (closed, open)
}

/// Position of a joint, m, and its number.
type NumberedJoint = (Vector2<f64>, usize);

/// Returns the numbers of the joints at both ends of every path. Ends that count as one point have the same
/// number.
fn ends(paths: &[OpenPath]) -> Vec<[usize; 2]> {
    let mut joints: HashMap<(i64, i64), Vec<NumberedJoint>> = HashMap::new();
    let mut count = 0;
    let mut joint = |p: Vector2<f64>| {
        let cell = ((p.x / JOINT).floor() as i64, (p.y / JOINT).floor() as i64);
        let near = (-1..=1).flat_map(|i| (-1..=1).map(move |j| (cell.0 + i, cell.1 + j)));
        let known = near.filter_map(|cell| joints.get(&cell)).flatten();
        if let Some((_, number)) = known.into_iter().find(|(q, _)| (p - q).norm() <= JOINT) {
            return *number;
        }
        count += 1;
        joints.entry(cell).or_default().push((p, count));
        count
    };
    let mut both = |path: &OpenPath| {
        let at = |v: Option<&PathVertex>| v.map_or_else(Vector2::zeros, |v| v.at);
        [joint(at(path.vertices.first())), joint(at(path.vertices.last()))]
    };
    paths.iter().map(&mut both).collect()
}

/// Returns the vertices of a path without the last vertex. If `is_reversed` is true, the path runs
/// backwards and its arcs change from anticlockwise to clockwise or vice versa.
fn pieces(vertices: &[PathVertex], is_reversed: bool) -> Vec<PathVertex> {
    let segments = vertices.windows(2);
    if is_reversed {
        return segments.rev().map(|v| PathVertex { at: v[1].at, bulge: -v[0].bulge }).collect();
    }
    segments.map(|v| v[0]).collect()
}
