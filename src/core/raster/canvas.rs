//! Depth buffer: triangles and lines are drawn into samples, and each sample keeps the nearest surface.

use super::camera::ScreenPoint;
use nalgebra::{Point2, Vector2};

/// Number of grid steps per sample in x and in y.
///
/// Corners of triangles are rounded to grid points. Integer arithmetic then decides exactly which triangle
/// covers a sample.
const PARTS: f64 = 256.0;
const PART: i64 = 256;
/// Largest absolute coordinate of a corner, in samples. Triangles with a corner beyond this coordinate are
/// not drawn.
const FARTHEST: f64 = 1e5;

/// Grid of samples, row by row from the top left. Each sample holds a painted value, such as a colour, and
/// the nearness of the surface nearest to the eye.
pub struct DepthBuffer<T> {
    pub width: usize,
    pub height: usize,
    pub near: Vec<f32>,
    pub value: Vec<T>,
}

impl<T: Copy> DepthBuffer<T> {
    /// Returns an empty buffer whose samples all have the painted value `value`.
    pub fn new(width: usize, height: usize, value: T) -> Self {
        Self { width, height, near: vec![f32::MIN; width * height], value: vec![value; width * height] }
    }

    /// Paints the samples at which a triangle is nearer to the eye than all surfaces drawn so far.
    ///
    /// For each such sample, `paint` receives the painted value of the sample and the barycentric coordinates
    /// of the sample in the triangle. A sample on the common edge of two neighbouring triangles is painted by
    /// only one of them. If `solid` is false, the triangle does not hide what is drawn later.
    pub fn fill(&mut self, corners: &[ScreenPoint; 3], solid: bool, mut paint: impl FnMut(&mut T, [f32; 3])) {
        let is_drawn = |c: &ScreenPoint| c.near.is_finite() && c.at.coords.iter().all(|v| v.abs() < FARTHEST);
        if !corners.iter().all(is_drawn) {
            return;
        }
        let p = corners.map(|c| [(c.at.x * PARTS).round() as i64, (c.at.y * PARTS).round() as i64]);
        let area = cross(p[0], p[1], p[2]);
        if area == 0 {
            return;
        }
        let sign = area.signum();
        let edges = [
            TriangleEdge::new(p[1], p[2], sign),
            TriangleEdge::new(p[2], p[0], sign),
            TriangleEdge::new(p[0], p[1], sign),
        ];
        let (lows, highs) = (least(&p, 0), least(&p, 1));
        let (columns, rows) = (range(lows, self.width), range(highs, self.height));
        let full = (area * sign) as f32;
        let near = corners.map(|c| c.near as f32);
        for row in rows {
            let mut inside = edges.each_ref().map(|e| e.at(columns.start as i64, row as i64));
            for column in columns.clone() {
                if inside.iter().zip(&edges).all(|(v, e)| *v >= e.least) {
                    let share = inside.map(|v| v as f32 / full);
                    let here = near[0] * share[0] + near[1] * share[1] + near[2] * share[2];
                    let k = row * self.width + column;
                    if here > self.near[k] {
                        paint(&mut self.value[k], share);
                        if solid {
                            self.near[k] = here;
                        }
                    }
                }
                inside.iter_mut().zip(&edges).for_each(|(v, e)| *v += e.step);
            }
        }
    }

    /// Paints a line from `a` to `b`, except where a surface drawn so far hides the line. `width` is in
    /// samples.
    pub fn stroke(&mut self, a: &ScreenPoint, b: &ScreenPoint, width: f64, mut paint: impl FnMut(&mut T)) {
        let along = (b.at - a.at).try_normalize(1e-9).unwrap_or_else(Vector2::x);
        let (side, end) = (Vector2::new(-along.y, along.x) * (width / 2.0), along * (width / 4.0));
        let corner = |s: &ScreenPoint, off: Vector2<f64>| ScreenPoint {
            at: Point2::from(s.at.coords + off),
            near: s.near,
        };
        let quad =
            [corner(a, -end - side), corner(b, end - side), corner(b, end + side), corner(a, -end + side)];
        self.fill(&[quad[0], quad[1], quad[2]], true, |v, _| paint(v));
        self.fill(&[quad[0], quad[2], quad[3]], true, |v, _| paint(v));
    }
}

/// Returns twice the signed area of the triangle `a`, `b`, `c`, in squared units of the grid of [`PARTS`].
fn cross(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

fn least(p: &[[i64; 2]; 3], axis: usize) -> (i64, i64) {
    let all = p.map(|p| p[axis]);
    (all.into_iter().fold(i64::MAX, i64::min), all.into_iter().fold(i64::MIN, i64::max))
}

/// Returns a range of indices that includes all samples with centres from `low` to `high` (units of the grid
/// of [`PARTS`]).
///
/// All indices are below `count`.
fn range((low, high): (i64, i64), count: usize) -> std::ops::Range<usize> {
    let first = (low - PART / 2).div_euclid(PART).max(0);
    let last = (high - PART / 2).div_euclid(PART) + 1;
    first as usize..last.clamp(first, count.max(first as usize) as i64) as usize
}

/// Edge function of a side of a triangle. It is zero on the side and positive inside the triangle.
struct TriangleEdge {
    from: [i64; 2],
    along: [i64; 2],
    /// Change of the edge function from a sample to its right neighbour.
    step: i64,
    /// Least value of the edge function at samples that the triangle covers.
    ///
    /// The value is 0 if the triangle covers the samples on the edge; otherwise it is 1. If two
    /// neighbouring triangles share an edge, `least` is 0 in one of them and 1 in the other.
    least: i64,
}

impl TriangleEdge {
    fn new(a: [i64; 2], b: [i64; 2], sign: i64) -> Self {
        let along = [(b[0] - a[0]) * sign, (b[1] - a[1]) * sign];
        let owns = along[1] < 0 || along[1] == 0 && along[0] > 0;
        Self { from: a, along, step: -along[1] * PART, least: if owns { 0 } else { 1 } }
    }

    fn at(&self, column: i64, row: i64) -> i64 {
        let (x, y) = (column * PART + PART / 2, row * PART + PART / 2);
        self.along[0] * (y - self.from[1]) - self.along[1] * (x - self.from[0])
    }
}
