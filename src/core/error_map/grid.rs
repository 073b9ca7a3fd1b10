//! The nodes of a work surface.

use crate::cell::{Operation, Place, Placement};
use nalgebra::Vector3;

/// Nodes of a work surface, in the frame of its equipment.
///
/// A grid with m by n divisions has (m + 1)(n + 1) nodes. The nodes are numbered row by row from the corner
/// of least x and y, so that x varies faster than y.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Numbers of divisions along x and y. A list of k nodes counts as one row, with k - 1 divisions along
    /// x and none along y.
    pub divisions: (usize, usize),
    /// Coordinates x of the columns, m. The field `ys` holds the coordinates y of the rows. For listed nodes,
    /// each of the two fields holds only the least and the greatest coordinate.
    xs: Vec<f64>,
    ys: Vec<f64>,
    /// Coordinates (x, y) of nodes listed one by one, m; empty for a grid of columns and rows.
    points: Vec<(f64, f64)>,
    /// Height of the TCP targets above the surface, m.
    standoff: f64,
}

impl Grid {
    /// Computes the nodes of an operation.
    pub fn new(operation: &Operation) -> Self {
        let standoff = operation.standoff;
        match &operation.place {
            Place::Grid { area, divisions } => {
                let line = |centre: f64, size: f64, n: usize| {
                    (0..=n).map(|k| centre - size / 2.0 + size * k as f64 / n as f64).collect()
                };
                let xs = line(area.centre.0, area.size.0, divisions.0);
                let ys = line(area.centre.1, area.size.1, divisions.1);
                Self { divisions: *divisions, xs, ys, points: Vec::new(), standoff }
            }
            Place::Points(points) => {
                let ends = |values: &dyn Fn(&(f64, f64)) -> f64| {
                    let all = points.iter().map(values);
                    let (low, high) = all.fold((f64::MAX, f64::MIN), |(lo, hi), v| (lo.min(v), hi.max(v)));
                    vec![low, high]
                };
                let (xs, ys) = (ends(&|p| p.0), ends(&|p| p.1));
                Self { divisions: (points.len().max(1) - 1, 0), xs, ys, points: points.clone(), standoff }
            }
        }
    }

    /// Returns the number of nodes.
    pub fn count(&self) -> usize {
        (self.divisions.0 + 1) * (self.divisions.1 + 1)
    }

    /// Returns the column and row (i, j) of the k-th node.
    pub fn index(&self, k: usize) -> (usize, usize) {
        (k % (self.divisions.0 + 1), k / (self.divisions.0 + 1))
    }

    /// Returns whether the nodes were listed one by one.
    pub fn is_listed(&self) -> bool {
        !self.points.is_empty()
    }

    /// Returns the ranges of x and y of the nodes in the frame of the equipment, m.
    pub fn extent(&self) -> [(f64, f64); 2] {
        [&self.xs, &self.ys].map(|line| (line[0], line[line.len() - 1]))
    }

    /// Returns x and y of a node in the frame of the equipment, m.
    pub fn local(&self, node: usize) -> (f64, f64) {
        let (i, j) = self.index(node);
        self.points.get(node).copied().unwrap_or_else(|| (self.xs[i], self.ys[j]))
    }

    /// Returns x and y of every node in the frame of the equipment, m.
    pub fn locals(&self) -> (Vec<f64>, Vec<f64>) {
        (0..self.count()).map(|k| self.local(k)).unzip()
    }

    /// Returns the height of the TCP targets above the surface, m.
    pub fn standoff(&self) -> f64 {
        self.standoff
    }

    /// Computes the TCP target over a point of a surface placed at `at`. The point is in the frame of the
    /// equipment, m.
    ///
    /// The target (m) is in the frame in which `at` is given.
    pub fn point(&self, at: &Placement, local: (f64, f64)) -> Vector3<f64> {
        self.headed_point(at, at.yaw.sin_cos(), local)
    }

    /// Computes the same target as [`Self::point`]. The pair `(sin, cos)` holds sine and cosine of the yaw of
    /// the surface.
    #[inline]
    pub fn headed_point(&self, at: &Placement, (sin, cos): (f64, f64), (x, y): (f64, f64)) -> Vector3<f64> {
        Vector3::new(at.x + cos * x - sin * y, at.y + sin * x + cos * y, at.z + self.standoff)
    }

    /// Computes the TCP target of one node of a surface placed at `at`.
    ///
    /// The target (m) is in the frame in which `at` is given.
    pub fn target(&self, at: &Placement, node: usize) -> Vector3<f64> {
        self.point(at, self.local(node))
    }

    /// Computes a lower and an upper bound, m, of all distances from the point `from` to the TCP targets.
    ///
    /// The surface is placed at `at`. The arguments `from` and `at` must be given in the same frame.
    pub fn distances(&self, at: &Placement, from: &Vector3<f64>) -> (f64, f64) {
        let (sin, cos) = at.yaw.sin_cos();
        let (dx, dy) = (from.x - at.x, from.y - at.y);
        let seen = [cos * dx + sin * dy, cos * dy - sin * dx];
        let up = from.z - at.z - self.standoff;
        let (mut near, mut far) = (up * up, up * up);
        for (line, v) in [&self.xs, &self.ys].into_iter().zip(seen) {
            let ends = [line[0], line[line.len() - 1]];
            let aside = v - v.clamp(ends[0], ends[1]);
            near += aside * aside;
            far += ends.map(|end| (v - end) * (v - end)).into_iter().fold(0.0, f64::max);
        }
        (near.sqrt(), far.sqrt())
    }

    /// Calls `each` with the index and the TCP target of every node of a surface placed at `at`.
    ///
    /// The targets (m) are in the frame in which `at` is given.
    #[inline]
    pub fn targets(&self, at: &Placement, mut each: impl FnMut(usize, Vector3<f64>)) {
        let (sin, cos) = at.yaw.sin_cos();
        let z = at.z + self.standoff;
        for (k, (x, y)) in self.points.iter().enumerate() {
            each(k, Vector3::new(at.x + cos * x - sin * y, at.y + sin * x + cos * y, z));
        }
        if !self.points.is_empty() {
            return;
        }
        let mut k = 0;
        for y in &self.ys {
            for x in &self.xs {
                each(k, Vector3::new(at.x + cos * x - sin * y, at.y + sin * x + cos * y, z));
                k += 1;
            }
        }
    }
}
