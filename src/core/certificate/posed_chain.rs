//! Chain at its nominal posture, and the test that the arm follows a target through the target box in one
//! branch.
//!
//! Let J be the Jacobian of the tool task at the nominal posture, and `J + D` the Jacobian at another
//! posture. Along a straight path of the target at the velocity v, the joint rates are `q' = (J + D)^-1 v`.
//! To first order, the rates are `a = J^-1 v`. The deviation `e'` of the rates from `a` is
//!
//! ```text
//! e' = -J^-1 D (a + e').
//! ```
//!
//! Assume that every component of the deviation is at most r. This assumption bounds D, and therefore the
//! right-hand side. If the bound of the right-hand side is at most r, the path exists and the assumption is
//! true. This is Krawczyk's test (R. Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit
//! Fehlerschranken", Computing 4, 1969) for a path. J + D is regular along the path, so the arm stays in its
//! branch.
//!
//! D is bounded by its first derivatives at the nominal posture and by a bound of its second derivatives.
//! Every derivative of a column is a product of unit axes and one lever arm.

use super::target_box::BoxAxis;
use crate::cell::{JointKind, MAX_JOINTS};
use crate::reach::{MAX_ROWS, RotationRow, ToolTask};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix6, Vector3};

/// Factor by which the half widths grow from one trial to the next.
const GROWTH: f64 = 1.02;
/// Least half width that is tried, rad or m. This value keeps rounding errors inside the enclosure.
const LEAST_HALF: f64 = 1e-9;
/// Axes count as parallel if the sine of their angle is below this value. The value is far above rounding
/// errors and far below any tolerance.
const PARALLEL_SINE: f64 = 1e-12;
/// Largest number of trials to find half widths that pass the test.
const TRIALS: usize = 20;

/// One number per row of a tool task, or per coordinate.
pub type Rows = [f64; MAX_ROWS];

/// Square matrix, stored as a list of rows or of columns; each use states which of the two.
pub type Square = [Rows; MAX_ROWS];

/// Chain at its nominal posture, prepared for a joint enclosure.
///
/// The coordinates y are displacements of the active joints. In a run of successive revolute joints with
/// parallel axes, the coordinate of a joint is a sum. This signed sum contains the joint angles from the
/// first joint of the run up to this joint. A change of one such sum alone rotates one link, and shifts the
/// later links without a rotation. So the links of a planar arm rotate independently.
pub struct PosedChain<'a> {
    pub chain: &'a Chain,
    pub task: &'a ToolTask,
    pub axes: [Vector3<f64>; MAX_JOINTS],
    /// Motion of the TCP per unit of each D-H coordinate.
    pub moved: [Vector3<f64>; MAX_JOINTS],
    /// Matrix S that converts the coordinates y to the displacements of the active joints: `theta = S y`.
    pub to_theta: Square,
    /// Rigid pieces of the arm. Piece k leads from active joint k to the next active joint, and the last
    /// piece leads to the TCP.
    pub pieces: [Piece; MAX_ROWS],
}

/// Rigid piece of an arm between two active joints.
#[derive(Clone, Copy, Default)]
pub struct Piece {
    pub length: f64,
    /// Bit mask of the coordinates that rotate the piece.
    pub turning: u8,
    /// Whether the piece begins at a prismatic joint, whose coordinate lengthens the piece.
    pub slides: bool,
}

impl<'a> PosedChain<'a> {
    /// Prepares a chain at the posture with the frames `frames`.
    pub fn new(chain: &'a Chain, task: &'a ToolTask, frames: &Frames) -> Self {
        let (mut axes, mut moved) = ([Vector3::zeros(); MAX_JOINTS], [Vector3::zeros(); MAX_JOINTS]);
        let tip = frames.tcp.translation;
        for (j, link) in chain.links.iter().enumerate() {
            let frame = &frames.links[j];
            axes[j] = frame.rotation.column(2).into_owned();
            moved[j] = match link.kind {
                JointKind::Revolute => axes[j].cross(&(tip - frame.translation)),
                JointKind::Prismatic => axes[j],
            };
        }
        let (to_theta, pieces) = ([[0.0; MAX_ROWS]; MAX_ROWS], Default::default());
        let mut posed = Self { chain, task, axes, moved, to_theta, pieces };
        posed.set_coordinates(frames);
        posed
    }

    /// Sets the coordinates and the rigid pieces.
    fn set_coordinates(&mut self, frames: &Frames) {
        let active = &self.task.active[..self.task.rows];
        let (mut sign, mut before, mut turning) = ([1.0; MAX_ROWS], None::<usize>, 0u8);
        for (k, &joint) in active.iter().enumerate() {
            if self.turns(joint) {
                let parallel =
                    |b: &usize| self.axes[active[*b]].cross(&self.axes[joint]).norm() < PARALLEL_SINE;
                if let Some(b) = before.filter(parallel) {
                    sign[k] = sign[b] * self.axes[active[b]].dot(&self.axes[joint]).signum();
                    self.to_theta[k][b] = -sign[k];
                    // The sum up to this joint replaces the sum up to the joint before it.
                    turning &= !(1 << b);
                }
                turning |= 1 << k;
                before = Some(k);
            }
            self.to_theta[k][k] = sign[k];
            let next = active.get(k + 1).map_or(frames.tcp.translation, |j| frames.links[*j].translation);
            let from = &frames.links[joint];
            self.pieces[k] =
                Piece { length: (next - from.translation).norm(), turning, slides: !self.turns(joint) };
        }
    }

    /// Returns whether a joint is revolute.
    pub fn turns(&self, joint: usize) -> bool {
        self.chain.links[joint].kind == JointKind::Revolute
    }

    /// Returns whether the first coordinate rotates the whole arm about its first axis.
    pub fn begins_with_rotation_of_arm(&self) -> bool {
        let is_alone = (1..self.task.rows).all(|k| self.to_theta[k][0] == 0.0);
        self.task.active[0] == 0 && self.turns(0) && is_alone
    }

    /// Returns the rows of a tool task for a motion of the TCP and a rotation of the tool. The function
    /// `joints` multiplies each joint rate by a given coefficient and returns the sum.
    fn rows(
        &self,
        moved: &Vector3<f64>,
        turn: &Vector3<f64>,
        joints: impl Fn(&[f64; MAX_JOINTS]) -> f64,
    ) -> Rows {
        let mut column = [moved.x, moved.y, moved.z, 0.0, 0.0, 0.0];
        for (k, (row, _)) in self.task.rotation.iter().enumerate().take(self.task.rows - 3) {
            column[3 + k] = match row {
                RotationRow::Along(e) => e.dot(turn),
                RotationRow::Joints(coefficients) => joints(coefficients),
            };
        }
        column
    }

    /// Returns the inverse of the Jacobian of the tool task with respect to the coordinates; None if the
    /// Jacobian is singular.
    pub fn inverse(&self) -> Option<Square> {
        let n = self.task.rows;
        let mut columns = [[0.0; MAX_ROWS]; MAX_ROWS];
        for (column, &joint) in columns.iter_mut().zip(&self.task.active[..n]) {
            let turn = if self.turns(joint) { self.axes[joint] } else { Vector3::zeros() };
            *column = self.rows(&self.moved[joint], &turn, |coefficients| coefficients[joint]);
        }
        let columns = self.by_coordinates(&columns);
        let mut jacobian = Matrix6::identity();
        (0..n).for_each(|c| (0..n).for_each(|r| jacobian[(r, c)] = columns[c][r]));
        let inverse = jacobian.try_inverse()?;
        Some(std::array::from_fn(|r| std::array::from_fn(|c| inverse[(r, c)])))
    }

    /// Converts derivatives with respect to the displacements of the active joints to derivatives with
    /// respect to the coordinates. Entry c of the result is the sum over k of `S_kc` times entry k. The
    /// matrix S is [`Self::to_theta`].
    fn by_coordinates(&self, columns: &Square) -> Square {
        let n = self.task.rows;
        let mut sums = [[0.0; MAX_ROWS]; MAX_ROWS];
        for (k, column) in columns[..n].iter().enumerate() {
            for c in (0..=k).filter(|c| self.to_theta[k][*c] != 0.0) {
                (0..n).for_each(|r| sums[c][r] += self.to_theta[k][c] * column[r]);
            }
        }
        sums
    }

    /// Returns the motion of the target per unit of one axis of the target box, in the rows of the tool task.
    pub fn rate(&self, axis: BoxAxis) -> Rows {
        let mut rate = [0.0; MAX_ROWS];
        match axis {
            BoxAxis::Position(k) => rate[k] = 1.0,
            BoxAxis::Heading => {
                let rows = self.task.rotation.iter().enumerate().take(self.task.rows - 3);
                rows.for_each(|(k, (_, by))| rate[3 + k] = *by);
            }
        }
        rate
    }

    /// Returns the columns of `J^-1 dJ/dy_a` for each coordinate `y_a`, where J is the Jacobian with respect
    /// to the coordinates.
    fn derivatives(&self, inverse: &Square) -> [Square; MAX_ROWS] {
        let n = self.task.rows;
        let active = &self.task.active[..n];
        let mut all = [[[0.0; MAX_ROWS]; MAX_ROWS]; MAX_ROWS];
        for (a, &j) in active.iter().enumerate() {
            let mut by_theta = [[0.0; MAX_ROWS]; MAX_ROWS];
            for (column, &k) in by_theta.iter_mut().zip(active) {
                let (moved, turn) = self.column_rate(k, j);
                *column = self.rows(&moved, &turn, |_| 0.0);
            }
            let by_coordinates = self.by_coordinates(&by_theta);
            for c in (0..=a).filter(|c| self.to_theta[a][*c] != 0.0) {
                let factor = self.to_theta[a][c];
                for b in 0..n {
                    (0..n).for_each(|r| all[c][b][r] += factor * by_coordinates[b][r]);
                }
            }
        }
        for matrix in &mut all[..n] {
            matrix[..n].iter_mut().for_each(|column| *column = times(n, inverse, column));
        }
        all
    }

    /// Returns the derivative of column `k` of the geometric Jacobian with respect to the D-H coordinate of
    /// joint `j`: the change of the motion of the TCP, and the change of the rotation.
    pub fn column_rate(&self, k: usize, j: usize) -> (Vector3<f64>, Vector3<f64>) {
        let (low, high) = (j.min(k), j.max(k));
        let none = Vector3::zeros();
        let moved = if self.turns(low) { self.axes[low].cross(&self.moved[high]) } else { none };
        let turns = j < k && self.turns(j) && self.turns(k);
        (moved, if turns { self.axes[j].cross(&self.axes[k]) } else { none })
    }

    /// Returns an upper bound of the deviation of the coordinates from their linear expansion; None if the
    /// test fails.
    ///
    /// `first` holds the first-order displacements of the coordinates along each axis of the target box. The
    /// result is also valid if the nominal posture is displaced by up to `around`.
    pub fn bend(&self, inverse: &Square, first: &[Rows; BoxAxis::COUNT], around: &Rows) -> Option<Rows> {
        let n = self.task.rows;
        let derivatives = self.derivatives(inverse);
        let (mut linear, mut second) = ([0.0; MAX_ROWS], [0.0; MAX_ROWS]);
        // Sum of |J^-1 dJ| over the axes of the target box, column by column.
        let mut along = [[0.0; MAX_ROWS]; MAX_ROWS];
        let moving = || first.iter().filter(|steps| steps.iter().any(|v| *v != 0.0));
        for steps in moving() {
            let mut by = [[0.0; MAX_ROWS]; MAX_ROWS];
            for (matrix, step) in derivatives[..n].iter().zip(steps) {
                for c in 0..n {
                    (0..n).for_each(|r| by[c][r] += matrix[c][r] * step);
                }
            }
            for other in moving() {
                for r in 0..n {
                    second[r] += (0..n).map(|c| by[c][r] * other[c]).sum::<f64>().abs();
                }
            }
            for c in 0..n {
                (0..n).for_each(|r| along[c][r] += by[c][r].abs());
            }
            (0..n).for_each(|r| linear[r] += steps[r].abs());
        }
        let mut half = second.map(|v| v.max(LEAST_HALF));
        for _ in 0..TRIALS {
            let total: Rows = std::array::from_fn(|k| linear[k] + half[k]);
            let wide: Rows = std::array::from_fn(|k| total[k] + around[k]);
            let third = self.third(&wide, &total);
            let mut rest = [0.0; MAX_ROWS];
            for r in 0..n {
                for c in 0..n {
                    let aside: f64 = (0..n).map(|j| derivatives[j][c][r].abs() * (half[j] + around[j])).sum();
                    rest[r] += along[c][r] * half[c] + aside * total[c] + inverse[r][c].abs() * third[c];
                }
            }
            let needed: Rows = std::array::from_fn(|k| second[k] + rest[k]);
            if (0..n).all(|k| needed[k] <= half[k]) {
                // The displacement grows at most linearly along the path, so the integral over the path
                // halves the second-order term.
                return Some(std::array::from_fn(|k| second[k] / 2.0 + rest[k]));
            }
            if !needed.iter().all(|v| v.is_finite() && *v < 1.0) {
                return None;
            }
            half = needed.map(|v| (v * GROWTH).max(LEAST_HALF));
        }
        None
    }

    /// Returns an upper bound of the third-order terms in the rows of the task. These terms are `D q'`
    /// without the part that the first derivatives of D cause. Here D is the change of the Jacobian, and q'
    /// are the rates. The displacements are at most `wide`, and the rates at most `rates`.
    fn third(&self, wide: &Rows, rates: &Rows) -> Rows {
        let n = self.task.rows;
        let turned = |by: &Rows, bits: u8| -> f64 {
            by.iter().enumerate().filter(|(k, _)| bits >> k & 1 == 1).map(|(_, v)| v).sum()
        };
        let piece = |(k, piece): (usize, &Piece)| {
            let (w, r) = (turned(wide, piece.turning), turned(rates, piece.turning));
            let slid = if piece.slides { w * w * rates[k] + 2.0 * w * r * wide[k] } else { 0.0 };
            piece.length * w * w * r + slid
        };
        let moved: f64 = self.pieces[..n].iter().enumerate().map(piece).sum();
        let tool = self.pieces[n - 1].turning;
        let spun = turned(wide, tool).powi(2) * turned(rates, tool);
        let mut rest = [moved / 2.0; MAX_ROWS];
        for (k, (row, _)) in self.task.rotation.iter().enumerate() {
            rest[3 + k] = if matches!(row, RotationRow::Along(_)) { spun / 2.0 } else { 0.0 };
        }
        rest
    }
}

/// Returns the product of a square matrix and a column; only the first `n` rows and columns count.
pub fn times(n: usize, matrix: &Square, column: &Rows) -> Rows {
    let mut product = [0.0; MAX_ROWS];
    for r in 0..n {
        product[r] = (0..n).map(|c| matrix[r][c] * column[c]).sum();
    }
    product
}
