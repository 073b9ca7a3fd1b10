//! Plane faces with holes as ACIS bodies: the geometry of the REGION entity.
//!
//! DXF of release 2000 embeds ACIS data as text (SAT, Standard ACIS Text). The records follow version 700 of
//! the SAT format, which Autodesk products expect in a DXF file of this release. A body refers to its lump,
//! shell, face, loops, coedges, edges, vertices, curves and points by the numbers of their records.

use crate::files::polygon::{crossing_edges, rings_meet};
use crate::geometry::{PlanePoint, polygon_area};
use crate::units::{mm_from_m, rounded};
use nalgebra::Vector2;
use std::fmt::Display;

/// Header of the body. The date is fixed, so that equal drawings give equal files.
const HEADER: [&str; 3] =
    ["700 0 1 0", "@9 sweetspot @12 ACIS 32.0 NT @24 Thu Jan 01 00:00:00 2026", "1 1e-06 1e-10"];
const END: &str = "End-of-ACIS-data";
/// Number of the record of the face.
const FACE: usize = 3;
/// Number of the record of the plane of the face.
const PLANE: usize = 4;
/// Number of the record of the first loop of the face.
const FIRST_LOOP: usize = 5;
/// Number of records of each corner of a loop: coedge, edge, vertex, curve and point.
const PER_CORNER: usize = 5;

/// Connected horizontal face that may have holes, world frame, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarFace {
    /// Outer loop, anticlockwise, followed by the holes, clockwise.
    loops: Vec<Vec<Vector2<f64>>>,
}

/// Returns the faces of a region; a point (m) is inside if it lies in an odd number of rings.
///
/// A face is left out if its loops cross or touch, because ACIS refuses such a face.
pub fn planar_faces(rings: &[Vec<PlanePoint>]) -> Vec<PlanarFace> {
    let loops: Vec<Vec<Vector2<f64>>> = rings.iter().filter_map(|ring| corners(ring)).collect();
    let around = |k: usize| -> Vec<usize> {
        (0..loops.len()).filter(|&j| j != k && surrounds(&loops[j], &loops[k][0])).collect()
    };
    let around: Vec<Vec<usize>> = (0..loops.len()).map(around).collect();
    let faces = (0..loops.len()).filter(|&k| around[k].len().is_multiple_of(2)).map(|k| {
        let is_hole = |j: usize| around[j].len() == around[k].len() + 1 && around[j].contains(&k);
        let holes = (0..loops.len()).filter(|&j| is_hole(j)).map(|j| oriented(&loops[j], false));
        PlanarFace { loops: std::iter::once(oriented(&loops[k], true)).chain(holes).collect() }
    });
    faces.filter(PlanarFace::is_valid).collect()
}

/// Returns the corners of a ring (m) in mm without repeated points; None if the corners enclose no area.
fn corners(ring: &[PlanePoint]) -> Option<Vec<Vector2<f64>>> {
    let in_mm = |p: &PlanePoint| Vector2::new(rounded(mm_from_m(p.0), 6), rounded(mm_from_m(p.1), 6));
    let mut corners: Vec<Vector2<f64>> = ring.iter().map(in_mm).collect();
    corners.dedup();
    while corners.len() > 1 && corners.first() == corners.last() {
        corners.pop();
    }
    (corners.len() > 2 && area(&corners) != 0.0).then_some(corners)
}

fn area(corners: &[Vector2<f64>]) -> f64 {
    polygon_area(&corners.iter().map(|p| (p.x, p.y)).collect::<Vec<_>>())
}

/// Returns the ring with its corners anticlockwise if `anticlockwise` is true, otherwise clockwise.
fn oriented(ring: &[Vector2<f64>], anticlockwise: bool) -> Vec<Vector2<f64>> {
    let mut ring = ring.to_vec();
    if (area(&ring) > 0.0) != anticlockwise {
        ring.reverse();
    }
    ring
}

/// Returns whether a point lies in a ring: a ray from the point along +x crosses the ring an odd number of
/// times.
fn surrounds(ring: &[Vector2<f64>], p: &Vector2<f64>) -> bool {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let is_crossed = |(a, b): &(&Vector2<f64>, &Vector2<f64>)| {
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    edges.filter(is_crossed).count() % 2 == 1
}

impl PlanarFace {
    fn is_valid(&self) -> bool {
        let pairs =
            self.loops.iter().enumerate().flat_map(|(k, a)| self.loops[k + 1..].iter().map(move |b| (a, b)));
        self.loops.iter().all(|ring| crossing_edges(ring).is_none())
            && !pairs.into_iter().any(|(a, b)| rings_meet(a, b))
    }

    /// Returns the scrambled lines of the ACIS text of the face at the height `z`, mm.
    pub fn acis_text(&self, z: f64) -> Vec<String> {
        let mut lines: Vec<String> = HEADER.map(String::from).into();
        lines.push("body $-1 -1 $-1 $1 $-1 $-1 #".into());
        lines.push("lump $-1 -1 $-1 $-1 $2 $0 #".into());
        lines.push(format!("shell $-1 -1 $-1 $-1 $-1 ${FACE} $-1 $1 #"));
        lines.push(format!("face $-1 -1 $-1 $-1 ${FIRST_LOOP} $2 $-1 ${PLANE} forward double out #"));
        lines.push(format!("plane-surface $-1 -1 $-1 0 0 {} 0 0 1 1 0 0 forward_v I I I I #", number(z)));
        let mut first = FIRST_LOOP;
        for (k, ring) in self.loops.iter().enumerate() {
            let after = first + 1 + PER_CORNER * ring.len();
            let next = if k + 1 < self.loops.len() { format!("${after}") } else { "$-1".into() };
            lines.push(format!("loop $-1 -1 $-1 {next} ${} ${FACE} #", first + 1));
            loop_records(ring, z, first, &mut lines);
            first = after;
        }
        lines.push(END.into());
        lines.iter().map(|line| scrambled(line)).collect()
    }
}

/// Appends the records of the coedges, edges, vertices, curves and points of a loop. The record of the loop
/// itself has the number `own`.
fn loop_records(ring: &[Vector2<f64>], z: f64, own: usize, lines: &mut Vec<String>) {
    let n = ring.len();
    let [coedge, edge, vertex, curve, point] = [0, 1, 2, 3, 4].map(|kind| own + 1 + kind * n);
    let (next, previous) = (|k: usize| (k + 1) % n, |k: usize| (k + n - 1) % n);
    let along = |k: usize| ring[next(k)] - ring[k];
    for k in 0..n {
        let (after, before) = (coedge + next(k), coedge + previous(k));
        lines.push(format!("coedge $-1 -1 $-1 ${after} ${before} $-1 ${} forward ${own} $-1 #", edge + k));
    }
    for k in 0..n {
        let (start, end, length) = (vertex + k, vertex + next(k), number(along(k).norm()));
        let (of, on) = (coedge + k, curve + k);
        lines.push(format!("edge $-1 -1 $-1 ${start} 0 ${end} {length} ${of} ${on} forward @7 unknown #"));
    }
    for k in 0..n {
        lines.push(format!("vertex $-1 -1 $-1 ${} ${} #", edge + k, point + k));
    }
    for (k, p) in ring.iter().enumerate() {
        let (at, to) = (place(p, z), along(k).normalize());
        lines.push(format!("straight-curve $-1 -1 $-1 {at} {} {} 0 I I #", number(to.x), number(to.y)));
    }
    for p in ring {
        lines.push(format!("point $-1 -1 $-1 {} #", place(p, z)));
    }
}

fn place(p: &Vector2<f64>, z: f64) -> impl Display {
    format!("{} {} {}", number(p.x), number(p.y), number(z))
}

/// Returns the shortest decimal number that is read as the same value, without a sign before zero.
fn number(value: f64) -> String {
    format!("{}", value + 0.0)
}

/// Returns a line of ACIS text as DXF holds it: each character code c above 32 becomes 159 - c.
///
/// A space follows each resulting caret, because a caret alone begins a control character in DXF.
fn scrambled(line: &str) -> String {
    let each = |c: char| match c {
        ' '..='~' if c != ' ' => char::from(159 - c as u8),
        other => other,
    };
    line.chars().map(each).collect::<String>().replace('^', "^ ")
}
