//! Covariances of all candidates of a plan after some of them are measured, kept up to date by low-rank
//! updates.

use super::plan_problem::PlanProblem;
use nalgebra::{DMatrix, Matrix3, Matrix3xX};

/// Covariances of the positions of all candidates once the chosen poses are measured.
///
/// A pose that is added or removed changes these covariances by a matrix of rank 3 (Sherman, Morrison and
/// Woodbury 1950).
pub struct PlanPosterior<'a> {
    problem: &'a PlanProblem,
    pub(super) chosen: Vec<usize>,
    /// Covariance of every candidate with each chosen pose before the measurement.
    columns: Vec<Vec<Matrix3<f64>>>,
    /// Covariance of the position of every candidate, without the independent error of the pose, m^2.
    variances: Vec<Matrix3<f64>>,
    /// Covariance of every candidate with the targets, m^2.
    crosses: Vec<Matrix3xX<f64>>,
    is_chosen: Vec<bool>,
    /// Sum of the variances of the targets, m^2.
    remaining: f64,
}

impl<'a> PlanPosterior<'a> {
    /// Returns the covariances once the poses `chosen` are measured; None if they are not finite.
    pub fn of(problem: &'a PlanProblem, chosen: &[usize]) -> Option<Self> {
        let count = problem.candidates();
        let unknowns = problem.targets.nrows();
        let mut posterior = Self {
            problem,
            chosen: Vec::new(),
            columns: Vec::new(),
            variances: (0..count).map(|i| problem.prior(i, i)).collect(),
            crosses: problem.slopes.iter().map(|s| s.columns(0, unknowns) * &problem.targets).collect(),
            is_chosen: vec![false; count],
            remaining: problem.targets.norm_squared(),
        };
        chosen.iter().try_for_each(|pose| posterior.add(*pose))?;
        Some(posterior)
    }

    /// Returns the sum of the variances of the targets, m^2.
    pub fn remaining(&self) -> f64 {
        self.remaining.max(0.0)
    }

    /// Returns the amount by which a measurement of a candidate reduces the variances of the targets, m^2.
    pub fn gain(&self, candidate: usize) -> f64 {
        let cross = &self.crosses[candidate];
        let measured = self.variances[candidate] + self.own_error();
        let Some(inverse) = measured.cholesky().map(|c| c.inverse()) else { return 0.0 };
        let squares = cross.column_iter().fold(Matrix3::zeros(), |sum, c| sum + c * c.transpose());
        inverse.component_mul(&squares).sum()
    }

    /// Returns the candidate that is not chosen yet and has the greatest gain; the first of several equal
    /// candidates.
    pub fn most_telling(&self) -> Option<usize> {
        self.most_telling_of(0..self.crosses.len())
    }

    /// Returns the candidate among `candidates` that is not chosen yet and has the greatest gain; the first
    /// of several equal candidates.
    pub fn most_telling_of(&self, candidates: impl Iterator<Item = usize>) -> Option<usize> {
        let free = candidates.filter(|&i| !self.is_chosen[i]).map(|i| (i, self.gain(i)));
        free.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(i, _)| i)
    }

    /// Adds a measurement of a candidate. Returns None if the covariances are not finite.
    pub fn add(&mut self, pose: usize) -> Option<()> {
        self.update(pose, &self.own_error())?;
        self.columns.push(self.prior_column(pose));
        self.chosen.push(pose);
        self.is_chosen[pose] = true;
        Some(())
    }

    /// Removes the measurement of a chosen pose. Returns None if the covariances are not finite.
    pub fn remove(&mut self, pose: usize) -> Option<()> {
        let place = self.chosen.iter().position(|chosen| *chosen == pose)?;
        self.update(pose, &-self.own_error())?;
        self.chosen.remove(place);
        self.columns.remove(place);
        self.is_chosen[pose] = false;
        Some(())
    }

    fn own_error(&self) -> Matrix3<f64> {
        Matrix3::identity() * self.problem.error.own.powi(2)
    }

    /// Returns the covariance of every candidate with the pose `pose`, before the measurement.
    fn prior_column(&self, pose: usize) -> Vec<Matrix3<f64>> {
        (0..self.crosses.len()).map(|i| self.problem.prior(i, pose)).collect()
    }

    /// Conditions the covariances on a measurement of a pose with an error of the given covariance. A
    /// negative covariance removes such a measurement.
    fn update(&mut self, pose: usize, error: &Matrix3<f64>) -> Option<()> {
        let column = self.column(pose)?;
        let inverse = (column[pose] + error).try_inverse()?;
        let toward = inverse * &self.crosses[pose];
        self.remaining -= self.crosses[pose].component_mul(&toward).sum();
        for ((block, variance), cross) in column.iter().zip(&mut self.variances).zip(&mut self.crosses) {
            *variance -= block * inverse * block.transpose();
            cross.gemm(-1.0, block, &toward, 1.0);
        }
        self.remaining.is_finite().then_some(())
    }

    /// Returns the covariance of every candidate with the pose `pose`, once the chosen poses are measured.
    fn column(&self, pose: usize) -> Option<Vec<Matrix3<f64>>> {
        let mut column = self.prior_column(pose);
        let count = self.chosen.len();
        if count == 0 {
            return Some(column);
        }
        let measured = DMatrix::from_fn(3 * count, 3 * count, |i, j| {
            let own = if i == j { self.problem.error.own.powi(2) } else { 0.0 };
            self.columns[j / 3][self.chosen[i / 3]][(i % 3, j % 3)] + own
        });
        let with_pose = DMatrix::from_fn(3 * count, 3, |i, j| column[self.chosen[i / 3]][(i % 3, j)]);
        let shares = measured.cholesky()?.solve(&with_pose);
        for (k, chosen) in self.columns.iter().enumerate() {
            let share: Matrix3<f64> = shares.fixed_view::<3, 3>(3 * k, 0).into_owned();
            column.iter_mut().zip(chosen).for_each(|(block, chosen)| *block -= chosen * share);
        }
        Some(column)
    }
}
