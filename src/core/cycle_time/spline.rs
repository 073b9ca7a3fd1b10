//! Cubic spline through the joint vectors of a line.

use crate::cell::{JointVector, MAX_JOINTS};

/// Cubic spline through joint vectors, twice continuously differentiable, with not-a-knot ends.
///
/// The third derivative is continuous at the second and at the second-to-last vector. So the derivatives at
/// the ends need not be known (C. de Boor, A Practical Guide to Splines, 1978). Three vectors give a
/// parabola, and two vectors give a line.
pub(super) struct JointSpline {
    /// Parameter of every joint vector, increasing.
    at: Vec<f64>,
    values: Vec<JointVector>,
    /// Second derivative at every joint vector.
    second: Vec<JointVector>,
}

impl JointSpline {
    /// Returns the spline through `values` at the increasing parameters `at`. Both lists must have at least
    /// two entries.
    pub fn new(at: Vec<f64>, values: Vec<JointVector>) -> Self {
        let second = second_derivatives(&at, &values);
        Self { at, values, second }
    }

    /// Returns the parameter of the last joint vector.
    pub fn end(&self) -> f64 {
        self.at[self.at.len() - 1]
    }

    /// Returns the first and the second derivative at a parameter.
    pub fn derivatives(&self, s: f64) -> (JointVector, JointVector) {
        let k = self.at.partition_point(|at| *at <= s).clamp(1, self.at.len() - 1) - 1;
        let h = self.at[k + 1] - self.at[k];
        let (a, b) = ((self.at[k + 1] - s) / h, (s - self.at[k]) / h);
        let (mut first, mut second) = ([0.0; MAX_JOINTS], [0.0; MAX_JOINTS]);
        for j in 0..MAX_JOINTS {
            let (from, to) = (self.second[k][j], self.second[k + 1][j]);
            let chord = (self.values[k + 1][j] - self.values[k][j]) / h;
            first[j] = chord + h / 6.0 * ((3.0 * b * b - 1.0) * to - (3.0 * a * a - 1.0) * from);
            second[j] = a * from + b * to;
        }
        (first, second)
    }
}

/// Returns the second derivatives at the joint vectors. These derivatives solve a tridiagonal system of
/// equations.
fn second_derivatives(at: &[f64], values: &[JointVector]) -> Vec<JointVector> {
    let count = at.len();
    let mut second = vec![[0.0; MAX_JOINTS]; count];
    let h: Vec<f64> = at.windows(2).map(|ends| ends[1] - ends[0]).collect();
    let bend = |k: usize, j: usize| {
        let slope = |k: usize| (values[k + 1][j] - values[k][j]) / h[k];
        6.0 * (slope(k) - slope(k - 1))
    };
    if count == 3 {
        let of = |j: usize| bend(1, j) / (3.0 * (h[0] + h[1]));
        return vec![std::array::from_fn(of); 3];
    }
    if count < 3 {
        return second;
    }
    let inner = count - 2;
    // Row k of the system belongs to the joint vector k + 1.
    let (mut low, mut middle, mut high) = (vec![0.0; inner], vec![0.0; inner], vec![0.0; inner]);
    for k in 0..inner {
        (low[k], middle[k], high[k]) = (h[k], 2.0 * (h[k] + h[k + 1]), h[k + 1]);
    }
    // The second derivative at each end is extrapolated linearly from the two nearest joint vectors.
    let (first, last) = (h[0] / h[1], h[inner] / h[inner - 1]);
    middle[0] += h[0] * (1.0 + first);
    high[0] -= h[0] * first;
    middle[inner - 1] += h[inner] * (1.0 + last);
    low[inner - 1] -= h[inner] * last;
    let mut right: Vec<JointVector> = (1..=inner).map(|k| std::array::from_fn(|j| bend(k, j))).collect();
    for k in 1..inner {
        let factor = low[k] / middle[k - 1];
        middle[k] -= factor * high[k - 1];
        let before = right[k - 1];
        right[k].iter_mut().zip(before).for_each(|(value, before)| *value -= factor * before);
    }
    for k in (0..inner).rev() {
        for j in 0..MAX_JOINTS {
            let beyond = if k + 1 < inner { high[k] * second[k + 2][j] } else { 0.0 };
            second[k + 1][j] = (right[k][j] - beyond) / middle[k];
        }
    }
    let beyond = |near: &JointVector, far: &JointVector, ratio: f64| {
        std::array::from_fn(|j| (1.0 + ratio) * near[j] - ratio * far[j])
    };
    second[0] = beyond(&second[1], &second[2], first);
    second[count - 1] = beyond(&second[inner], &second[inner - 1], last);
    second
}
