//! Areas of one value in a grid to outlines.

use nalgebra::Vector2;
use std::collections::{BTreeMap, HashMap};

type Point = [i32; 2];

/// Outlines of all areas of each value, in the order of the values: corners of the grid, closed, around what
/// they hold. Small areas are left out, and no outline is off by more than `tolerance`.
pub fn outlines(
    values: &[u32],
    width: usize,
    least_area: f64,
    tolerance: f64,
) -> BTreeMap<u32, Vec<Vec<Point>>> {
    let sides = sides(values, width);
    let loops = sides.into_iter().map(|(value, sides)| {
        let large = rings(&sides).into_iter().filter(|ring| area(ring).abs() >= least_area);
        (value, large.map(|ring| simplified(&ring, tolerance)).filter(|r| r.len() > 2).collect())
    });
    loops.filter(|(_, rings): &(u32, Vec<_>)| !rings.is_empty()).collect()
}

/// Of every value the sides between it and others, from corner to corner, itself to the right.
fn sides(values: &[u32], width: usize) -> BTreeMap<u32, Vec<(Point, Point)>> {
    let height = values.len() / width.max(1);
    let at = |x: i32, y: i32| {
        let inside = (0..width as i32).contains(&x) && (0..height as i32).contains(&y);
        inside.then(|| values[y as usize * width + x as usize])
    };
    let mut sides: BTreeMap<u32, Vec<(Point, Point)>> = BTreeMap::new();
    for (k, value) in values.iter().enumerate() {
        let (x, y) = ((k % width) as i32, (k / width) as i32);
        let around = [
            ((x, y - 1), [x, y], [x + 1, y]),
            ((x + 1, y), [x + 1, y], [x + 1, y + 1]),
            ((x, y + 1), [x + 1, y + 1], [x, y + 1]),
            ((x - 1, y), [x, y + 1], [x, y]),
        ];
        for ((nx, ny), from, to) in around {
            if at(nx, ny) != Some(*value) {
                sides.entry(*value).or_default().push((from, to));
            }
        }
    }
    sides
}

/// Sides joined to rings; where two areas meet in a corner each keeps to its own.
fn rings(sides: &[(Point, Point)]) -> Vec<Vec<Point>> {
    let mut from: HashMap<Point, Vec<usize>> = HashMap::new();
    sides.iter().enumerate().for_each(|(k, (a, _))| from.entry(*a).or_default().push(k));
    let mut used = vec![false; sides.len()];
    let mut rings = Vec::new();
    for first in 0..sides.len() {
        if used[first] {
            continue;
        }
        let (mut ring, mut k) = (Vec::new(), first);
        while !used[k] {
            used[k] = true;
            let (a, b) = sides[k];
            ring.push(a);
            let way = [b[0] - a[0], b[1] - a[1]];
            let turn = |n: usize| {
                let next = [sides[n].1[0] - b[0], sides[n].1[1] - b[1]];
                way[0] * next[1] - way[1] * next[0]
            };
            let free = from.get(&b).into_iter().flatten().copied().filter(|n| !used[*n]);
            match free.max_by_key(|n| turn(*n)) {
                Some(next) => k = next,
                None => break,
            }
        }
        rings.push(ring);
    }
    rings
}

/// That a ring holds, with a sign.
fn area(ring: &[Point]) -> f64 {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    pairs.map(|(a, b)| f64::from(a[0]) * f64::from(b[1]) - f64::from(a[1]) * f64::from(b[0])).sum::<f64>()
        / 2.0
}

/// Fewer points (Douglas and Peucker 1973), a ring cut in two at its least point, which is a corner of it, and
/// where it is farthest from that.
fn simplified(ring: &[Point], tolerance: f64) -> Vec<Point> {
    let Some(start) = (0..ring.len()).min_by_key(|k| ring[*k]) else { return Vec::new() };
    let ring: Vec<Point> = ring[start..].iter().chain(&ring[..=start]).copied().collect();
    let away = |k: &usize| {
        let (p, q) = (ring[*k], ring[0]);
        i64::from(p[0] - q[0]).pow(2) + i64::from(p[1] - q[1]).pow(2)
    };
    let far = (0..ring.len()).max_by_key(away).unwrap_or(0);
    let mut kept = thinned(&ring[..=far], tolerance);
    kept.pop();
    kept.extend(thinned(&ring[far..], tolerance));
    kept.pop();
    kept
}

fn thinned(line: &[Point], tolerance: f64) -> Vec<Point> {
    let mut keep = vec![false; line.len()];
    let mut parts = vec![(0, line.len().saturating_sub(1))];
    while let Some((first, last)) = parts.pop() {
        keep[first] = true;
        keep[last] = true;
        let place = |k: usize| Vector2::new(f64::from(line[k][0]), f64::from(line[k][1]));
        let (a, b) = (place(first), place(last));
        let along = b - a;
        let off = |k: usize| {
            let from = place(k) - a;
            let share = (from.dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
            (from - along * share).norm()
        };
        let far = (first + 1..last).map(|k| (k, off(k))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = far.filter(|(_, off)| *off > tolerance) {
            parts.extend([(first, k), (k, last)]);
        }
    }
    line.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

/// Path data of rings, in whole numbers.
pub fn path(rings: &[Vec<Point>]) -> String {
    use std::fmt::Write;
    let mut d = String::new();
    for ring in rings {
        let mut last: Option<Point> = None;
        for p in ring {
            let (letter, x, y) = match last {
                None => ('M', p[0], p[1]),
                Some(q) => ('l', p[0] - q[0], p[1] - q[1]),
            };
            // Writing to a String cannot fail.
            let _ = write!(d, "{letter}{x} {y}");
            last = Some(*p);
        }
        d.push('z');
    }
    d
}
