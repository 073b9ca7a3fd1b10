//! Joint box: all joint coordinates with which the arm follows a target through its box, in one branch.
//!
//! Let J be the Jacobian of the tool task at the nominal posture, and `J + D` the one at another posture. Along a
//! straight path of the target at the velocity v, the joint rates are `q' = (J + D)^-1 v`. To first order they are
//! `a = J^-1 v`, and their deviation `e'` from this is
//!
//! ```text
//! e' = -J^-1 D (a + e').
//! ```
//!
//! Let the deviation be at most r in every component. Then D is known to first order up to r, and the right side
//! is bounded. If this bound is at most r, the path exists and keeps the assumption. This is Krawczyk's test (R.
//! Krawczyk, "Newton-Algorithmen zur Bestimmung von Nullstellen mit Fehlerschranken", Computing 4, 1969) for a
//! path. J + D is regular along it, so the arm stays in its branch.
//!
//! D is bounded by its first derivatives at the nominal posture, and by a bound of its second derivatives: every
//! derivative of a column is a product of unit axes and one lever arm.
//!
//! If the test fails, the target box is halved. The half boxes share the nominal target, so the posture there
//! must lie in both joint boxes; this shows that both follow the same branch.

use super::target_box::{BoxAxis, TargetBox};
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::reach::{MAX_ROWS, RotationRow, ToolTask};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix6, Vector3};
use std::f64::consts::TAU;

/// Factor by which the half widths grow from one trial to the next.
const GROWTH: f64 = 1.02;
/// Least half width that is tried, rad or m. It keeps rounding errors inside the box.
const LEAST_HALF: f64 = 1e-9;
/// Sine of the angle below which axes count as parallel: far above rounding, far below any tolerance.
const PARALLEL_SINE: f64 = 1e-12;
/// Largest number of trials to find half widths that pass the test.
const TRIALS: usize = 20;

/// Joint coordinates with which the arm follows a target through its box.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEnclosure {
    /// Half widths of the D-H coordinates about the nominal posture, rad or m; 0 for joints that do not move.
    pub half: JointVector,
    /// First derivative of the D-H coordinates with respect to each [`BoxAxis`] of the target box, times the half
    /// width of the target box along this axis, rad or m.
    pub first: [JointVector; BoxAxis::COUNT],
    /// Upper bounds of the deviation of the D-H coordinates from their linear expansion, rad or m.
    pub bend: JointVector,
    /// Upper bound of the angle by which the tool rotates relative to the surface, rad.
    pub tool_turn: f64,
}

/// One number per row of a tool task, or per coordinate.
type Rows = [f64; MAX_ROWS];

/// Square matrix: a list of rows or of columns, as its use states.
type Square = [Rows; MAX_ROWS];

/// Chain at its nominal posture, as the joint box needs it.
///
/// The coordinates y are displacements of the active joints. For successive revolute joints with parallel axes,
/// they are sums of the angles from the first of these joints on. Such a sum rotates one link and shifts the
/// links after it, so a planar arm decouples into independent links.
struct PosedChain<'a> {
    chain: &'a Chain,
    task: &'a ToolTask,
    axes: [Vector3<f64>; MAX_JOINTS],
    /// Motion of the TCP per unit of each D-H coordinate.
    moved: [Vector3<f64>; MAX_JOINTS],
    /// Matrix S of `theta = S y`, where theta are the displacements of the active joints.
    to_theta: Square,
    /// Rigid pieces of the arm: piece k leads from active joint k to the next one, and the last to the TCP.
    pieces: [Piece; MAX_ROWS],
}

/// Rigid piece of an arm between two active joints.
#[derive(Clone, Copy, Default)]
struct Piece {
    length: f64,
    /// Bit mask of the coordinates that rotate the piece.
    turning: u8,
    /// Whether the coordinate with the index of the piece lengthens it.
    slides: bool,
}

/// Reason why a posture has no joint box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoEnclosure {
    /// The posture is too near to a singular one for a target box of this size.
    NearlySingular,
    /// A joint may exceed its limit by up to `by` (rad or m).
    JointLimit { joint: usize, by: f64 },
}

impl JointEnclosure {
    /// Box of joints that do not move.
    pub const NONE: Self = Self {
        half: [0.0; MAX_JOINTS],
        first: [[0.0; MAX_JOINTS]; BoxAxis::COUNT],
        bend: [0.0; MAX_JOINTS],
        tool_turn: 0.0,
    };

    /// Returns the joint box of a posture with the actuator coordinates `joints` and the frames `frames`.
    ///
    /// The result holds for every nominal posture whose D-H coordinates are within `beyond` (rad or m) of the
    /// given one; `beyond` is 0 for a single posture.
    ///
    /// # Errors
    /// Returns the reason if there is no joint box, or if it exceeds the joint limits.
    pub fn new(
        chain: &Chain,
        task: &ToolTask,
        (joints, frames): (&JointVector, &Frames),
        target: &TargetBox,
        beyond: &JointVector,
    ) -> Result<Self, NoEnclosure> {
        let posed = PosedChain::new(chain, task, frames);
        let n = task.rows;
        let inverse = posed.inverse().ok_or(NoEnclosure::NearlySingular)?;
        let mut first = [[0.0; MAX_ROWS]; BoxAxis::COUNT];
        for (axis, first) in BoxAxis::ALL.into_iter().zip(&mut first) {
            let (half, rate) = (target.half(axis), posed.rate(axis));
            if half > 0.0 && rate != [0.0; MAX_ROWS] {
                *first = times(n, &inverse, &rate).map(|v| v * half);
            }
            if !first.iter().all(|v| v.is_finite()) {
                return Err(NoEnclosure::NearlySingular);
            }
        }
        // The linear part alone refuses most postures next to a limit.
        let linear = posed.enclosure(&first, &[0.0; MAX_ROWS], target);
        linear.check_limits(chain, joints)?;
        let mut around = [0.0; MAX_ROWS];
        let mut sum = 0.0;
        for (around, &joint) in around.iter_mut().zip(&task.active[..n]) {
            // A sum of angles changes by at most the sum of their changes.
            sum += beyond[joint];
            *around = sum;
        }
        let bend = posed.bend(&inverse, &first, &around).ok_or(NoEnclosure::NearlySingular)?;
        let found = posed.enclosure(&first, &bend, target);
        found.check_limits(chain, joints)?;
        Ok(found)
    }

    /// Returns half widths of the actuator coordinates about the nominal posture, rad or m.
    pub fn actuators(&self, chain: &Chain) -> JointVector {
        let mut half = [0.0; MAX_JOINTS];
        for theta in &self.first {
            let moved = actuators(chain, theta);
            half.iter_mut().zip(moved).for_each(|(half, by)| *half += by.abs());
        }
        // The signs of the deviations are not known, so all of them add up.
        let mut bend = self.bend;
        for i in 0..chain.axes() {
            bend[i] += (0..i).map(|j| chain.coupling[i][j].abs() * bend[j]).sum::<f64>();
        }
        half.iter_mut().zip(bend).for_each(|(half, by)| *half += by);
        half
    }

    /// Checks that all joints keep their limits; `joints` are the nominal actuator coordinates. A joint that can turn
    /// all the way round has no limit, and a passive joint is not checked.
    fn check_limits(&self, chain: &Chain, joints: &JointVector) -> Result<(), NoEnclosure> {
        let half = self.actuators(chain);
        for (joint, link) in chain.links.iter().enumerate() {
            let (low, high) = link.limits;
            let is_limited = low < high && (link.kind == JointKind::Prismatic || high - low < TAU);
            let by = (low - joints[joint] + half[joint]).max(joints[joint] + half[joint] - high);
            if is_limited && by > 0.0 {
                return Err(NoEnclosure::JointLimit { joint, by });
            }
        }
        Ok(())
    }

    /// Returns an upper bound of the change of the geometric Jacobian in the box: the Frobenius norm of the change,
    /// with lengths divided by `reach` (m).
    ///
    /// The columns are those of the actuators.
    pub fn jacobian_change(&self, chain: &Chain, task: &ToolTask, frames: &Frames, reach: f64) -> f64 {
        let posed = PosedChain::new(chain, task, frames);
        let total: f64 = self.half.iter().sum();
        let length: f64 = posed.pieces.iter().map(|piece| piece.length).sum::<f64>() + total;
        let mut squares = 0.0;
        for k in 0..chain.axes() {
            let (mut moved, mut turned) = (0.0, 0.0);
            for j in (0..chain.axes()).filter(|&j| posed.turns(j)) {
                let (low, high) = (j.min(k), j.max(k));
                if posed.turns(low) {
                    moved += self.half[j] * posed.axes[low].cross(&posed.moved[high]).norm();
                }
                if j < k && posed.turns(k) {
                    turned += self.half[j] * posed.axes[j].cross(&posed.axes[k]).norm();
                }
            }
            for j in (k + 1..chain.axes()).filter(|&j| !posed.turns(j) && posed.turns(k)) {
                moved += self.half[j] * posed.axes[k].cross(&posed.moved[j]).norm();
            }
            moved += total * total * length / 2.0;
            turned += total * total / 2.0;
            squares += (moved / reach).powi(2) + turned.powi(2);
        }
        // The coupling multiplies the columns.
        let coupling = &chain.coupling;
        let is_coupled = (0..chain.axes()).any(|i| (0..i).any(|j| coupling[i][j] != 0.0));
        let factor = coupling.iter().flatten().map(|c| c * c).sum::<f64>().sqrt();
        squares.sqrt() * if is_coupled { factor } else { 1.0 }
    }

    /// Returns an upper bound of the displacement of the points in a ball that moves with a frame, m.
    ///
    /// The ball has its centre at `centre` (base frame, m), and the joints from `first` to before `frame` move
    /// it. The frames are those of the nominal posture.
    pub fn displacement(
        &self,
        chain: &Chain,
        frames: &Frames,
        (centre, radius): (&Vector3<f64>, f64),
        (first, frame): (usize, usize),
    ) -> f64 {
        let (mut sum, mut turned) = (0.0, 0.0);
        for j in first..frame {
            let before = &frames.links[j];
            match chain.links[j].kind {
                JointKind::Revolute => {
                    let axis = before.rotation.column(2);
                    sum += self.half[j] * (axis.cross(&(centre - before.translation)).norm() + radius);
                    turned += self.half[j];
                }
                JointKind::Prismatic => sum += self.half[j],
            }
        }
        // The lever arms grow by at most the displacement itself.
        if turned < 0.5 { sum / (1.0 - turned) } else { f64::INFINITY }
    }
}

impl<'a> PosedChain<'a> {
    fn new(chain: &'a Chain, task: &'a ToolTask, frames: &Frames) -> Self {
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

    fn turns(&self, joint: usize) -> bool {
        self.chain.links[joint].kind == JointKind::Revolute
    }

    /// Returns the rows of a tool task for a motion of the TCP and a rotation of the tool.
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

    /// Returns the inverse of the Jacobian of the tool task with respect to the coordinates; None if the Jacobian
    /// is singular.
    fn inverse(&self) -> Option<Square> {
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

    /// Converts derivatives by the displacements of the active joints to derivatives by the coordinates: entry c of
    /// the result is the sum of `S_kc` times entry k.
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

    /// Returns the motion of the target per unit of one axis of its box.
    fn rate(&self, axis: BoxAxis) -> Rows {
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

    /// Returns the columns of `J^-1 dJ/dy_a` for each coordinate `y_a`, where J is the Jacobian with respect to the
    /// coordinates.
    fn derivatives(&self, inverse: &Square) -> [Square; MAX_ROWS] {
        let n = self.task.rows;
        let active = &self.task.active[..n];
        let mut all = [[[0.0; MAX_ROWS]; MAX_ROWS]; MAX_ROWS];
        for (a, &j) in active.iter().enumerate() {
            let mut by_theta = [[0.0; MAX_ROWS]; MAX_ROWS];
            for (column, &k) in by_theta.iter_mut().zip(active) {
                let (low, high) = (j.min(k), j.max(k));
                let none = Vector3::zeros();
                let moved = if self.turns(low) { self.axes[low].cross(&self.moved[high]) } else { none };
                let turns = j < k && self.turns(j) && self.turns(k);
                let turn = if turns { self.axes[j].cross(&self.axes[k]) } else { none };
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

    /// Returns an upper bound of the deviation of the coordinates from their linear expansion; None if the test
    /// fails.
    ///
    /// `first` are the linear displacements along each axis of the target box.
    fn bend(&self, inverse: &Square, first: &[Rows; BoxAxis::COUNT], around: &Rows) -> Option<Rows> {
        let n = self.task.rows;
        let derivatives = self.derivatives(inverse);
        let (mut linear, mut second) = ([0.0; MAX_ROWS], [0.0; MAX_ROWS]);
        // Sum over the axes of |J^-1 dJ|, column by column.
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
                // The displacement grows at most linearly along the path, so the integral over the path halves
                // the second-order term.
                return Some(std::array::from_fn(|k| second[k] / 2.0 + rest[k]));
            }
            if !needed.iter().all(|v| v.is_finite() && *v < 1.0) {
                return None;
            }
            half = needed.map(|v| (v * GROWTH).max(LEAST_HALF));
        }
        None
    }

    /// Returns an upper bound of the terms of third order in the rows of the task: `D q'` without the first
    /// derivatives of D, for displacements up to `wide` and rates up to `rates`.
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

    /// Returns the box for displacements of the coordinates.
    fn enclosure(&self, first: &[Rows; BoxAxis::COUNT], bend: &Rows, target: &TargetBox) -> JointEnclosure {
        let n = self.task.rows;
        let theta = |y: &Rows, sign: fn(f64) -> f64| {
            let mut all = [0.0; MAX_JOINTS];
            for (k, &joint) in self.task.active[..n].iter().enumerate() {
                all[joint] = (0..=k).map(|c| sign(self.to_theta[k][c]) * y[c]).sum();
            }
            all
        };
        let first = first.each_ref().map(|steps| theta(steps, |factor| factor));
        let bend = theta(bend, f64::abs);
        let half: JointVector =
            std::array::from_fn(|j| first.iter().map(|steps| steps[j].abs()).sum::<f64>() + bend[j]);
        // A tool whose orientation is not controlled as a whole can only rotate about the vertical with the
        // first joint, or, with a numeric solver, with every joint.
        let tool_turn = match (self.task.keeps_orientation, self.task.rotation[0].0) {
            (true, _) if self.task.radial => target.heading + target.yaw,
            (true, _) => 0.0,
            (false, RotationRow::Joints(_)) => half[0] + target.yaw,
            (false, RotationRow::Along(_)) => half.iter().sum::<f64>() + target.yaw,
        };
        JointEnclosure { half, first, bend, tool_turn }
    }
}

/// Returns the product of a square matrix and a column; only the first `n` rows and columns count.
fn times(n: usize, matrix: &Square, column: &Rows) -> Rows {
    let mut product = [0.0; MAX_ROWS];
    for r in 0..n {
        product[r] = (0..n).map(|c| matrix[r][c] * column[c]).sum();
    }
    product
}

/// Returns the changes of the actuator coordinates that belong to changes of the D-H coordinates, rad or m.
fn actuators(chain: &Chain, theta: &JointVector) -> JointVector {
    let mut q = *theta;
    for i in 0..chain.axes() {
        q[i] -= (0..i).map(|j| chain.coupling[i][j] * q[j]).sum::<f64>();
    }
    q
}
