//! Coordinates of the boxes of the search: joint displacements, which are summed where revolute axes are
//! parallel.
//!
//! The coordinate of a joint is its displacement. For successive revolute joints with parallel axes, the
//! coordinate is the sum of the angles from the first of these joints to the joint itself. If such a sum
//! changes alone, one link rotates, and the links after it are shifted. A planar arm therefore decouples into
//! independent links, and the elevation of its tool is a coordinate. Let `y` be the coordinates and `theta`
//! the displacements of the joints from the middle of their limits. Then `theta = D y` with a constant matrix
//! D. Let C be the matrix of the joint coupling, and `q_0` the middle of the joint limits. The actuator
//! coordinates are `q = q_0 + C^-1 D y`. Each actuator coordinate lies between its limits.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::kinematic_error::{JointValues, Screws};
use crate::robot::Chain;
use std::f64::consts::PI;

/// Directions count as equal if their unit vectors differ by at most this value.
pub(super) const DIRECTION_ROUNDING: f64 = 1e-12;
/// Axes count as parallel if the sine of the angle between them is below this value. The value is far above
/// rounding errors, and far below any tolerance.
const PARALLEL_SINE: f64 = 1e-12;
/// Tolerance, rad or m, of the joint limits in the inverse kinematics.
///
/// The tolerance covers the errors of the inverse kinematics: 1e-12 in the cosine of an angle, and 1e-9 m in
/// a prismatic coordinate.
const LIMIT_TOLERANCE: f64 = 2e-6;

/// Matrix with one row and one column per joint. Unused rows and columns are zero.
pub(super) type JointMatrix = [[f64; MAX_JOINTS]; MAX_JOINTS];

/// Coordinates `y` of the boxes of the search, and their relation to joint displacements and actuators.
#[derive(Debug, Clone)]
pub(super) struct Coordinates {
    pub count: usize,
    /// Matrix D of `theta = D y`, where `y` are the coordinates and `theta` the joint displacements.
    pub to_theta: JointMatrix,
    /// Entries of D that are not zero, as triples (row, column, value), row by row.
    entries: Vec<(usize, usize, f64)>,
    /// Joint limits as triples (row, low, high): `low <= row . y <= high` for the coordinates `y`.
    pub limits: Vec<(JointValues, f64, f64)>,
    /// Least value of each coordinate in the box that holds all postures within the limits.
    pub low: JointValues,
    /// Greatest value of each coordinate in the box that holds all postures within the limits.
    pub high: JointValues,
    /// Bit mask, for each link k, of the coordinates that rotate the link. Link k comes after k joints.
    pub turning: [u8; MAX_JOINTS + 1],
    /// Sum of the absolute changes of all joint angles per unit of each coordinate.
    pub angles: JointValues,
    /// Joint angles (D-H, rad) in the middle of the joint limits.
    middle_angles: JointValues,
}

/// Returns the joint coordinates in the middle of the limits: the posture with zero joint displacement
/// `theta`.
pub(super) fn middle(chain: &Chain) -> JointVector {
    let mut q = [0.0; MAX_JOINTS];
    q.iter_mut().zip(&chain.links).for_each(|(q, link)| *q = (link.limits.0 + link.limits.1) / 2.0);
    q
}

impl Coordinates {
    /// Returns the coordinates of a chain.
    ///
    /// Joints marked in `held` do not influence the value, and remain in the middle of their limits.
    pub fn new(chain: &Chain, screws: &Screws, held: &[bool; MAX_JOINTS]) -> Self {
        let count = chain.axes();
        let (mut to_theta, mut turning) = ([[0.0; MAX_JOINTS]; MAX_JOINTS], [0; MAX_JOINTS + 1]);
        let revolute = |i: &usize| screws.kinds[*i] == JointKind::Revolute && !held[*i];
        let parallel = |i: usize, j: usize| screws.axes[i].cross(&screws.axes[j]).norm() < PARALLEL_SINE;
        // Sign of an angle relative to the first axis of its run of parallel axes.
        let mut sign = [1.0; MAX_JOINTS];
        for i in 0..count {
            if !revolute(&i) {
                to_theta[i][i] = 1.0;
                continue;
            }
            if let Some(before) = (0..i).rev().find(revolute).filter(|&b| parallel(b, i)) {
                sign[i] = sign[before] * screws.axes[before].dot(&screws.axes[i]).signum();
                to_theta[i][before] = -sign[i];
            }
            to_theta[i][i] = sign[i];
            let next = (i + 1..count).find(revolute).filter(|&next| parallel(i, next));
            (i + 1..=next.unwrap_or(count)).for_each(|link| turning[link] |= 1 << i);
        }
        let places = (0..count).flat_map(|i| (0..=i).map(move |k| (i, k)));
        let entries = places.map(|(i, k)| (i, k, to_theta[i][k])).filter(|entry| entry.2 != 0.0).collect();
        let mut angles = [0.0; MAX_JOINTS];
        for (k, sum) in angles.iter_mut().enumerate() {
            *sum = (0..count).filter(revolute).map(|i| to_theta[i][k].abs()).sum();
        }
        let posture = chain.posture(&middle(chain));
        let mut middle_angles = [0.0; MAX_JOINTS];
        for (k, angle) in middle_angles.iter_mut().enumerate() {
            *angle = posture.sin[k].atan2(posture.cos[k]);
        }
        let mut this = Self {
            count,
            to_theta,
            entries,
            limits: Vec::new(),
            low: [0.0; MAX_JOINTS],
            high: [0.0; MAX_JOINTS],
            turning,
            angles,
            middle_angles,
        };
        this.set_limits(chain, held);
        this
    }

    /// Sets the actuator limits as inequalities in the coordinates `y`, and a box that holds all allowed `y`.
    ///
    /// The actuator coordinates are `q = q_0 + G y` with `G = C^-1 D`. Here C is the joint coupling, D is
    /// `to_theta`, and `q_0` is the middle of the limits.
    fn set_limits(&mut self, chain: &Chain, held: &[bool; MAX_JOINTS]) {
        let mut half = [0.0; MAX_JOINTS];
        let mut rows = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        // Here y = D^-1 C q, so the angles of a run add up with their signs.
        let mut from_actuators = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        for i in 0..self.count {
            half[i] = if held[i] { 0.0 } else { half_range(chain, i) };
            let mut row = self.to_theta[i];
            let mut back = [0.0; MAX_JOINTS];
            for j in 0..=i {
                back[j] = chain.coupling[i][j];
                if j < i {
                    for k in 0..self.count {
                        row[k] -= chain.coupling[i][j] * rows[j][k];
                    }
                }
            }
            for k in (0..i).filter(|&k| self.to_theta[i][k] != 0.0) {
                for j in 0..self.count {
                    back[j] -= self.to_theta[i][k] * from_actuators[k][j];
                }
            }
            from_actuators[i] = back.map(|v| v / self.to_theta[i][i]);
            rows[i] = row;
            self.limits.push((row, -half[i], half[i]));
        }
        for (i, row) in from_actuators.iter().enumerate() {
            let reach: f64 = row.iter().zip(half).map(|(f, h)| f.abs() * h).sum();
            (self.low[i], self.high[i]) = (-reach, reach);
        }
    }

    /// Returns the range of the joint angle of a revolute joint (D-H, rad) over a box of coordinates.
    pub fn theta_range(&self, joint: usize, low: &JointValues, high: &JointValues) -> (f64, f64) {
        let products = |(d, (low, high)): (&f64, (&f64, &f64))| (d * low, d * high);
        let ends = self.to_theta[joint].iter().zip(low.iter().zip(high)).map(products);
        let middle = self.middle_angles[joint];
        ends.fold((middle, middle), |range, (a, b)| (range.0 + a.min(b), range.1 + a.max(b)))
    }

    /// Returns the joint displacements `theta = D y` at the coordinates `y`.
    pub fn theta(&self, y: &JointValues) -> JointValues {
        let mut theta = [0.0; MAX_JOINTS];
        for (theta, row) in theta.iter_mut().zip(&self.to_theta).take(self.count) {
            *theta = row.iter().zip(y).map(|(d, y)| d * y).sum();
        }
        theta
    }

    /// Returns the largest change of each joint displacement theta in a box with the half widths `radii`.
    pub fn theta_radii(&self, radii: &JointValues) -> JointValues {
        let mut most = [0.0; MAX_JOINTS];
        for (most, row) in most.iter_mut().zip(&self.to_theta).take(self.count) {
            *most = row.iter().zip(radii).map(|(d, r)| d.abs() * r).sum();
        }
        most
    }

    /// Returns the displacement of each actuator from the middle of its limits, for the coordinates `y`.
    pub fn actuators(&self, y: &JointValues) -> JointValues {
        let mut q = [0.0; MAX_JOINTS];
        for (q, (row, ..)) in q.iter_mut().zip(&self.limits) {
            *q = row.iter().zip(y).map(|(g, y)| g * y).sum();
        }
        q
    }

    /// Converts derivatives with respect to theta to derivatives with respect to y, where `theta = D y`.
    ///
    /// The gradient g becomes `D^T g`, and the Hessian H becomes `D^T H D`.
    pub fn derivatives(&self, gradient: &JointValues, hessian: &JointMatrix) -> (JointValues, JointMatrix) {
        let n = self.count;
        let (mut half, mut h) = ([[0.0; MAX_JOINTS]; MAX_JOINTS], [[0.0; MAX_JOINTS]; MAX_JOINTS]);
        for (i, k, d) in &self.entries {
            (0..n).for_each(|j| half[*k][j] += d * hessian[(*i).min(j)][(*i).max(j)]);
        }
        for (row, half) in h.iter_mut().zip(&half).take(n) {
            self.entries.iter().for_each(|(j, k, d)| row[*k] += d * half[*j]);
        }
        (self.gradient(gradient), h)
    }

    /// Converts the gradient g with respect to theta to the gradient `D^T g` with respect to y, where `theta =
    /// D y`.
    pub fn gradient(&self, gradient: &JointValues) -> JointValues {
        let mut g = [0.0; MAX_JOINTS];
        self.entries.iter().for_each(|(i, k, d)| g[*k] += d * gradient[*i]);
        g
    }
}

/// Returns half the range of an actuator, including the tolerance of the limits.
///
/// The result is at most half a turn if every posture repeats after one turn of the actuator.
fn half_range(chain: &Chain, joint: usize) -> f64 {
    let link = &chain.links[joint];
    let half = (link.limits.1 - link.limits.0) / 2.0 + LIMIT_TOLERANCE;
    let comes_back = |i: usize| {
        let factor = chain.coupling[i][joint];
        factor.fract() == 0.0 && (factor == 0.0 || chain.links[i].kind == JointKind::Revolute)
    };
    let turns = link.kind == JointKind::Revolute && (joint..chain.axes()).all(comes_back);
    if turns { half.min(PI) } else { half }
}
