//! Iso-lines of a field on a grid with holes, and areas where the field is at least a given level.
//!
//! A grid cell with values at all four corners consists of four triangles round its centre. The value at the
//! centre is the mean of the four corners (the bilinear value). A grid cell with values at three corners is
//! one triangle; a grid cell with fewer values is a hole. The field is linear in a triangle. A level
//! therefore crosses a triangle in one straight line. If only two opposite corners are above a level, the
//! centre value decides whether their areas are connected.

use crate::geometry::{PlanePoint, join_edges};

/// Field on a grid, as triangles.
pub struct IsoSurface {
    points: Vec<PlanePoint>,
    values: Vec<f64>,
    cells: Vec<GridCell>,
}

/// Grid cell: its row, its corners in cyclic order, and its centre if it has four corners.
struct GridCell {
    row: usize,
    corners: Vec<usize>,
    middle: Option<usize>,
}

impl IsoSurface {
    /// Makes the surface. `size` is the number of nodes along both axes. The nodes are in the order of the
    /// grid; the index along the first axis runs fastest.
    pub fn new(size: (usize, usize), points: &[PlanePoint], values: &[Option<f64>]) -> Self {
        let (m, n) = size;
        let mut surface = Self {
            points: points.to_vec(),
            values: values.iter().map(|v| v.unwrap_or(0.0)).collect(),
            cells: Vec::new(),
        };
        if points.len() != m * n || values.len() != m * n {
            return surface;
        }
        for row in 0..n.saturating_sub(1) {
            for i in 0..m.saturating_sub(1) {
                let first = row * m + i;
                let corners = [first, first + 1, first + m + 1, first + m];
                let corners: Vec<usize> = corners.into_iter().filter(|k| values[*k].is_some()).collect();
                surface.add(row, corners);
            }
        }
        surface
    }

    fn add(&mut self, row: usize, corners: Vec<usize>) {
        if corners.len() < 3 {
            return;
        }
        let middle = (corners.len() == 4).then(|| {
            let sum = |f: &dyn Fn(usize) -> f64| corners.iter().map(|&k| f(k)).sum::<f64>() / 4.0;
            let (x, y, v) =
                (sum(&|k| self.points[k].0), sum(&|k| self.points[k].1), sum(&|k| self.values[k]));
            self.points.push((x, y));
            self.values.push(v);
            self.points.len() - 1
        });
        self.cells.push(GridCell { row, corners, middle });
    }

    /// Returns whether a node is a corner of a triangle.
    pub fn covers(&self, node: usize) -> bool {
        self.cells.iter().any(|cell| cell.corners.contains(&node))
    }

    /// Returns the least and the greatest value; None without a triangle.
    pub fn range(&self) -> Option<(f64, f64)> {
        let values = self.cells.iter().flat_map(|c| &c.corners).map(|&k| (self.values[k], self.values[k]));
        values.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
    }

    /// Returns the area where the field is at least `level`, as polygons of equal orientation that do not
    /// overlap.
    pub fn above(&self, level: f64) -> Vec<Vec<PlanePoint>> {
        let mut polygons: Vec<Vec<PlanePoint>> = Vec::new();
        // Whole cells of one row are drawn as one polygon.
        let mut before: Option<&GridCell> = None;
        for cell in &self.cells {
            let is_whole = cell.middle.is_some() && cell.corners.iter().all(|&k| self.values[k] >= level);
            let joins = before.is_some_and(|b| b.row == cell.row && b.corners[1] == cell.corners[0]);
            match polygons.last_mut().filter(|_| is_whole && joins) {
                Some(last) => {
                    (last[1], last[2]) = (self.points[cell.corners[1]], self.points[cell.corners[2]])
                }
                None if is_whole => polygons.push(cell.corners.iter().map(|&k| self.points[k]).collect()),
                None => {
                    let parts = triangles(cell).into_iter().map(|t| self.part_above(&t, level));
                    polygons.extend(parts.filter(|p| p.len() > 2));
                }
            }
            before = is_whole.then_some(cell);
        }
        polygons
    }

    fn part_above(&self, triangle: &[usize; 3], level: f64) -> Vec<PlanePoint> {
        let mut part = Vec::new();
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            if self.values[a] >= level {
                part.push(self.points[a]);
            }
            if (self.values[a] >= level) != (self.values[b] >= level) {
                part.push(self.crossing(a.min(b), a.max(b), level));
            }
        }
        part
    }

    /// Returns the point at which the field equals `level` on the edge between two nodes.
    fn crossing(&self, a: usize, b: usize, level: f64) -> PlanePoint {
        let t = (level - self.values[a]) / (self.values[b] - self.values[a]);
        let ((ax, ay), (bx, by)) = (self.points[a], self.points[b]);
        (ax + t * (bx - ax), ay + t * (by - ay))
    }

    /// Returns the lines along which the field equals `level`; a closed line repeats its first point.
    pub fn lines(&self, level: f64) -> Vec<Vec<PlanePoint>> {
        let is_in = |k: usize| self.values[k] >= level;
        // A level crosses two edges of a triangle or none. Each segment runs from the edge that leaves the
        // area above the level to the edge that enters it. All triangles have the same orientation, so
        // neighbouring segments join head to tail.
        let segment = |t: [usize; 3]| {
            let edges = [0, 1, 2].map(|k| (t[k], t[(k + 1) % 3]));
            let cut = |leaves: bool| {
                let edge = edges.into_iter().find(|(a, b)| is_in(*a) == leaves && is_in(*b) != leaves);
                edge.map(|(a, b)| (a.min(b), a.max(b)))
            };
            Some((cut(true)?, cut(false)?))
        };
        let segments: Vec<_> = self.cells.iter().flat_map(triangles).filter_map(segment).collect();
        let joined = join_edges(&segments, |_, free| free[0]);
        let crossings = joined.into_iter().map(|line| {
            let first = line.is_closed.then(|| line.corners.first().copied()).flatten();
            let edges = line.corners.into_iter().chain(first);
            edges.map(|(a, b)| self.crossing(a, b, level)).collect()
        });
        crossings.collect()
    }
}

fn triangles(cell: &GridCell) -> Vec<[usize; 3]> {
    let c = &cell.corners;
    match cell.middle {
        Some(middle) => (0..4).map(|k| [c[k], c[(k + 1) % 4], middle]).collect(),
        None => vec![[c[0], c[1], c[2]]],
    }
}
