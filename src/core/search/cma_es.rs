//! CMA-ES as an argmin solver: the (mu/mu_w, lambda) evolution strategy with covariance matrix adaptation.
//!
//! Formulas and default parameters come from N. Hansen, "The CMA Evolution Strategy: A Tutorial",
//! arXiv:1604.00772. Equations, sections and Table 1 have the numbers of that tutorial.
//!
//! The steps depend on the rank of each cost in its generation, not on the costs themselves. So the jumps of
//! the cost at infeasible layouts do not disturb the method.

use argmin::core::{
    CostFunction, Error, IterState, KV, Problem, Solver, State, TerminationReason, TerminationStatus,
};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// A run has converged when its step size is below this share of the search range.
///
/// The local polish refines the result.
const TOL_X: f64 = 1e-5;
/// A run has converged when the best costs of the last generations agree within this relative difference.
const TOL_COST: f64 = 1e-5;
/// A run ends when the condition number of the covariance is above this value.
const MAX_CONDITION: f64 = 1e14;

/// One run of CMA-ES (covariance matrix adaptation evolution strategy) from one start point.
pub struct CmaEs {
    rng: ChaCha8Rng,
    /// Weights of the better half of a generation; their sum is 1.
    weights: DVector<f64>,
    /// Negative weights of the worse half of a generation, which shrink the covariance along bad steps.
    ///
    /// Source: eqs. (49)-(53) of N. Hansen, arXiv:1604.00772.
    worse: Vec<f64>,
    lambda: usize,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    /// Expected length of a standard normal vector.
    chi: f64,
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    path_sigma: DVector<f64>,
    path_c: DVector<f64>,
    /// Best cost of each generation so far.
    history: Vec<f64>,
    /// Convergence tolerances, as shares of the search ranges ([`Self::with_tolerances`]).
    tolerances: Vec<f64>,
    settled: bool,
}

impl CmaEs {
    /// Prepares a run from `mean` with the initial step size `sigma`.
    ///
    /// The parameters come from Table 1 of N. Hansen, arXiv:1604.00772. The population is `scale` times the
    /// population in that table.
    pub fn new(mean: Vec<f64>, sigma: f64, scale: u32, rng: ChaCha8Rng) -> Self {
        let n = mean.len() as f64;
        let lambda = (4 + (3.0 * n.ln()).floor() as usize) * scale as usize;
        let mu = lambda / 2;
        let raw = DVector::from_fn(lambda, |i, _| ((lambda as f64 + 1.0) / 2.0).ln() - (i as f64 + 1.0).ln());
        let better = raw.rows(0, mu);
        let weights = better / better.sum();
        let mu_eff = 1.0 / weights.norm_squared();
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = (2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff)).min(1.0 - c_1);
        let dimensions = mean.len();
        Self {
            rng,
            worse: negative(raw.rows(mu, lambda - mu).as_slice(), mu_eff, c_1, c_mu, n),
            weights,
            lambda,
            mu_eff,
            c_sigma,
            d_sigma: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            c_c: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            c_1,
            c_mu,
            chi: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            mean: DVector::from_vec(mean),
            sigma,
            covariance: DMatrix::identity(dimensions, dimensions),
            path_sigma: DVector::zeros(dimensions),
            path_c: DVector::zeros(dimensions),
            history: Vec::new(),
            tolerances: vec![0.0; dimensions],
            settled: false,
        }
    }

    /// Returns this run with a further stopping rule. The rule ends the run when the standard deviation of
    /// every coordinate is below its tolerance, as a share of the search range.
    pub fn with_tolerances(self, tolerances: Vec<f64>) -> Self {
        Self { tolerances, ..self }
    }

    /// Returns a standard normal vector (Box-Muller).
    fn normal(&mut self) -> DVector<f64> {
        let rng = &mut self.rng;
        DVector::from_fn(self.mean.len(), |_, _| {
            let (u, v): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
            (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
        })
    }

    /// Updates mean, step size and covariance matrix C by eqs. (41)-(47) of N. Hansen, arXiv:1604.00772.
    ///
    /// `steps` are the steps of one generation divided by the step size, best first. `whiten` is C^(-1/2).
    fn adapt(&mut self, steps: &[DVector<f64>], whiten: &DMatrix<f64>, generation: u64) {
        let n = self.mean.len() as f64;
        let zero = DVector::zeros(self.mean.len());
        let step = steps.iter().zip(self.weights.iter()).fold(zero, |sum, (y, w)| sum + y * *w);
        self.mean += &step * self.sigma;
        let gain = (self.c_sigma * (2.0 - self.c_sigma) * self.mu_eff).sqrt();
        self.path_sigma = &self.path_sigma * (1.0 - self.c_sigma) + whiten * &step * gain;
        let length = self.path_sigma.norm();
        let warmed = (1.0 - (1.0 - self.c_sigma).powf(2.0 * (generation as f64 + 1.0))).sqrt();
        let h = if length / warmed < (1.4 + 2.0 / (n + 1.0)) * self.chi { 1.0 } else { 0.0 };
        let gain = h * (self.c_c * (2.0 - self.c_c) * self.mu_eff).sqrt();
        self.path_c = &self.path_c * (1.0 - self.c_c) + &step * gain;
        let taken = self.c_1 + self.c_mu * (1.0 + self.worse.iter().sum::<f64>());
        let keep = 1.0 - taken + (1.0 - h) * self.c_1 * self.c_c * (2.0 - self.c_c);
        let mut covariance = &self.covariance * keep + &self.path_c * self.path_c.transpose() * self.c_1;
        for (y, w) in steps.iter().zip(self.weights.iter()) {
            covariance += y * y.transpose() * (self.c_mu * w);
        }
        for (y, w) in steps[self.weights.len()..].iter().zip(&self.worse) {
            // The step is scaled to the length of a typical step, so that no single bad step can spoil the
            // covariance.
            let length = (whiten * y).norm_squared().max(f64::MIN_POSITIVE);
            covariance += y * y.transpose() * (self.c_mu * w * n / length);
        }
        self.covariance = (&covariance + covariance.transpose()) / 2.0;
        // The exponent is bounded: one generation never increases the step size by more than a factor of e.
        self.sigma *= ((self.c_sigma / self.d_sigma) * (length / self.chi - 1.0)).min(1.0).exp();
    }

    /// Returns whether a stopping rule ends the run. The rules check the best costs, the step size, the
    /// standard deviations and the condition number of the covariance.
    ///
    /// Source of all rules but [`Self::with_tolerances`]: section B.3 of N. Hansen, arXiv:1604.00772.
    fn has_settled(&mut self, best: f64, eigenvalues: &DVector<f64>) -> bool {
        self.history.push(best);
        let span = 10 + (30.0 * self.mean.len() as f64 / self.lambda as f64).ceil() as usize;
        let recent = &self.history[self.history.len().saturating_sub(span)..];
        let (low, high) = recent.iter().fold((f64::MAX, f64::MIN), |(l, h), &c| (l.min(c), h.max(c)));
        let flat = recent.len() == span && high - low < TOL_COST * low.abs();
        let (least, most) = (eigenvalues.min(), eigenvalues.max());
        let small = self.sigma * most.sqrt() < TOL_X;
        let sound = least > 0.0 && most / least < MAX_CONDITION && self.sigma.is_finite() && self.sigma < 1e3;
        let variances = self.covariance.diagonal();
        let deviations = variances.iter().map(|v| self.sigma * v.sqrt());
        let fine = deviations.zip(&self.tolerances).all(|(deviation, enough)| deviation < *enough);
        flat || small || fine || !sound
    }
}

/// Returns the weights of the worse half, scaled so that the covariance matrix stays positive definite.
///
/// Source: eqs. (50)-(53) of N. Hansen, arXiv:1604.00772.
fn negative(raw: &[f64], mu_eff: f64, c_1: f64, c_mu: f64, n: f64) -> Vec<f64> {
    // With an odd population, rounding may make the middle weight positive.
    let raw: Vec<f64> = raw.iter().map(|w| w.min(0.0)).collect();
    let sum: f64 = raw.iter().sum();
    let effective = sum * sum / raw.iter().map(|w| w * w).sum::<f64>();
    let most =
        (1.0 + c_1 / c_mu).min(1.0 + 2.0 * effective / (mu_eff + 2.0)).min((1.0 - c_1 - c_mu) / (n * c_mu));
    // If the limit is not a positive number, there are no negative weights.
    let most = if most.is_finite() { most.max(0.0) } else { 0.0 };
    raw.iter().map(|w| -most * w / sum).collect()
}

impl<O> Solver<O, IterState<Vec<f64>, (), (), (), (), f64>> for CmaEs
where
    O: CostFunction<Param = Vec<f64>, Output = f64>,
{
    fn name(&self) -> &str {
        "CMA-ES"
    }

    fn next_iter(
        &mut self,
        problem: &mut Problem<O>,
        state: IterState<Vec<f64>, (), (), (), (), f64>,
    ) -> Result<(IterState<Vec<f64>, (), (), (), (), f64>, Option<KV>), Error> {
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(self.covariance.clone());
        let roots = eigenvalues.map(|v| v.max(1e-300).sqrt());
        let spread = &eigenvectors * DMatrix::from_diagonal(&roots);
        let whiten =
            &eigenvectors * DMatrix::from_diagonal(&roots.map(|r| 1.0 / r)) * eigenvectors.transpose();
        let steps: Vec<DVector<f64>> = (0..self.lambda).map(|_| &spread * self.normal()).collect();
        let points: Vec<Vec<f64>> =
            steps.iter().map(|y| (&self.mean + y * self.sigma).as_slice().to_vec()).collect();
        let costs = problem.bulk_cost(&points)?;
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        let best = order[0];
        let ranked: Vec<_> = order.iter().map(|&k| steps[k].clone()).collect();
        self.adapt(&ranked, &whiten, state.get_iter());
        self.settled = self.has_settled(costs[best], &eigenvalues);
        Ok((state.param(points[best].clone()).cost(costs[best]), None))
    }

    fn terminate(&mut self, _state: &IterState<Vec<f64>, (), (), (), (), f64>) -> TerminationStatus {
        if self.settled {
            TerminationStatus::Terminated(TerminationReason::SolverConverged)
        } else {
            TerminationStatus::NotTerminated
        }
    }
}
