//! The nodes of a work surface.

use crate::cell::{Operation, Placement, Rectangle};
use nalgebra::Vector3;

/// (m + 1)(n + 1) nodes over a surface, in the frame of its equipment. Node (i, j) runs over x,
/// then y, from the low corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    pub divisions: (usize, usize),
    /// Local x of the columns and y of the rows, m.
    xs: Vec<f64>,
    ys: Vec<f64>,
    standoff: f64,
}

impl Grid {
    pub fn new(surface: &Rectangle, operation: &Operation) -> Self {
        let line = |centre: f64, size: f64, n: usize| {
            (0..=n).map(|k| centre - size / 2.0 + size * k as f64 / n as f64).collect()
        };
        let (m, n) = operation.grid;
        Self {
            divisions: (m, n),
            xs: line(surface.centre.0, surface.size.0, m),
            ys: line(surface.centre.1, surface.size.1, n),
            standoff: operation.standoff,
        }
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        self.xs.len() * self.ys.len()
    }

    /// Index (i, j) of the k-th node.
    pub fn index(&self, k: usize) -> (usize, usize) {
        (k % self.xs.len(), k / self.xs.len())
    }

    /// Local x and y of every node, m.
    pub fn locals(&self) -> (Vec<f64>, Vec<f64>) {
        (0..self.count()).map(|k| self.index(k)).map(|(i, j)| (self.xs[i], self.ys[j])).unzip()
    }

    /// How far the targets are above the surface, m.
    pub fn standoff(&self) -> f64 {
        self.standoff
    }

    /// The TCP target over a point of the surface (frame of the equipment, m).
    pub fn point(&self, at: &Placement, (x, y): (f64, f64)) -> Vector3<f64> {
        let (sin, cos) = at.yaw.sin_cos();
        Vector3::new(at.x + cos * x - sin * y, at.y + sin * x + cos * y, at.z + self.standoff)
    }

    /// The TCP target of one node.
    pub fn target(&self, at: &Placement, node: usize) -> Vector3<f64> {
        let (i, j) = self.index(node);
        self.point(at, (self.xs[i], self.ys[j]))
    }

    /// Least and greatest distance of the points over the placed surface from a point (m); the nodes lie
    /// between.
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

    /// Calls `each` with the number and the TCP target of every node, for a surface placed at `at`
    /// in the frame wanted.
    #[inline]
    pub fn targets(&self, at: &Placement, mut each: impl FnMut(usize, Vector3<f64>)) {
        let (sin, cos) = at.yaw.sin_cos();
        let z = at.z + self.standoff;
        let mut k = 0;
        for y in &self.ys {
            for x in &self.xs {
                each(k, Vector3::new(at.x + cos * x - sin * y, at.y + sin * x + cos * y, z));
                k += 1;
            }
        }
    }
}
