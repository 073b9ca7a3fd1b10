//! Contour tracing: outlines of the areas with equal values in a grid of cells.

use crate::geometry::{join_edges, simplified_line};
use nalgebra::Vector2;
use std::collections::BTreeMap;

/// Corner of grid cells: column and row.
type GridPoint = [i32; 2];

/// Returns, for each value, the closed outlines of all areas that have this value, as corners of grid
/// cells.
///
/// Outlines that enclose less than `least_area` are left out. The other outlines are simplified within
/// `tolerance`, in cells.
pub fn outlines(
    values: &[u32],
    width: usize,
    least_area: f64,
    tolerance: f64,
) -> BTreeMap<u32, Vec<Vec<GridPoint>>> {
    let sides = sides(values, width);
    let loops = sides.into_iter().map(|(value, sides)| {
        let large = rings(&sides).into_iter().filter(|ring| area(ring).abs() >= least_area);
        (value, large.map(|ring| simplified(&ring, tolerance)).filter(|r| r.len() > 2).collect())
    });
    loops.filter(|(_, rings): &(u32, Vec<_>)| !rings.is_empty()).collect()
}

/// Returns, for each value, the boundary sides of the cells that have this value.
///
/// A boundary side borders on a cell of another value or on the outside of the grid. It is directed so that
/// the cell with this value is on the right of the side in the picture.
fn sides(values: &[u32], width: usize) -> BTreeMap<u32, Vec<(GridPoint, GridPoint)>> {
    let height = values.len() / width.max(1);
    let at = |x: i32, y: i32| {
        let inside = (0..width as i32).contains(&x) && (0..height as i32).contains(&y);
        inside.then(|| values[y as usize * width + x as usize])
    };
    let mut sides: BTreeMap<u32, Vec<(GridPoint, GridPoint)>> = BTreeMap::new();
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

/// Joins directed sides into closed rings. Where two areas of equal value meet only in a corner, their
/// rings remain separate.
fn rings(sides: &[(GridPoint, GridPoint)]) -> Vec<Vec<GridPoint>> {
    let way = |k: usize| {
        let (a, b) = sides[k];
        [b[0] - a[0], b[1] - a[1]]
    };
    let sharpest = |last: usize, free: &[usize]| {
        let turn = |k: &usize| way(last)[0] * way(*k)[1] - way(last)[1] * way(*k)[0];
        free.iter().copied().max_by_key(turn).unwrap_or(free[0])
    };
    join_edges(sides, sharpest).into_iter().map(|line| line.corners).collect()
}

/// Returns the area that a ring encloses. The sign depends on the direction of the ring.
fn area(ring: &[GridPoint]) -> f64 {
    let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
    pairs.map(|(a, b)| f64::from(a[0]) * f64::from(b[1]) - f64::from(a[1]) * f64::from(b[0])).sum::<f64>()
        / 2.0
}

/// Returns a ring with fewer points (Douglas and Peucker 1973).
///
/// The ring is first split at its leftmost point and at the point farthest from this point. If several points
/// are leftmost, the uppermost of these points is used, because it is always a corner.
fn simplified(ring: &[GridPoint], tolerance: f64) -> Vec<GridPoint> {
    let Some(start) = (0..ring.len()).min_by_key(|k| ring[*k]) else { return Vec::new() };
    let ring: Vec<GridPoint> = ring[start..].iter().chain(&ring[..=start]).copied().collect();
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

fn thinned(line: &[GridPoint], tolerance: f64) -> Vec<GridPoint> {
    let places: Vec<Vector2<f64>> = line.iter().map(|p| Vector2::from(p.map(f64::from))).collect();
    simplified_line(&places, tolerance).into_iter().map(|k| line[k]).collect()
}

/// Returns the SVG path data of closed rings, with integer coordinates.
pub fn path(rings: &[Vec<GridPoint>]) -> String {
    use std::fmt::Write;
    let mut d = String::new();
    for ring in rings {
        let mut last: Option<GridPoint> = None;
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
