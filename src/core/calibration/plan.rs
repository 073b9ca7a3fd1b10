//! Plans of measuring poses (optimal experimental design): the poses that reduce the uncertainty at a task
//! the most.
//!
//! The measured position of pose i is, to first order in the unknowns a (robot, base and reflector),
//!
//! ```text
//! y_i = J_i a + m(q_i) + e_i
//! ```
//!
//! The unknowns are normally distributed with their prior standard deviations. No model is complete, so the
//! misfit m, not the noise of the instrument, limits the accuracy. The misfit is a Gaussian process over the
//! joint space. Two poses near each other have nearly the same misfit, so the second of them adds little
//! information. The remaining errors e_i are independent.
//!
//! A plan minimizes the expected squared error of the predicted tool position, averaged over the postures of
//! the task (I-optimality). A plan that maximizes a determinant (D-optimality) would determine all unknowns
//! well, even those that the task does not need. After a calibration the base is registered anew. The
//! expected error therefore leaves out the part that a new base pose removes. This base pose best fits the
//! errors at all candidates for measuring poses.

use super::plan_posterior::PlanPosterior;
use super::plan_problem::PlanProblem;

/// Largest number of exchange passes.
const PASSES: usize = 4;
/// Relative improvement that an exchange must exceed, so that rounding cannot make the search cycle.
const BETTER: f64 = 1e-9;

impl PlanProblem {
    /// Returns the expected root mean square error of predicted positions at the task, m, without any
    /// measurement.
    pub fn before(&self) -> f64 {
        self.targets.norm()
    }

    /// Returns the expected root mean square error of predicted positions at the task, m, once the chosen
    /// candidates are measured. The result leaves out the errors at the task that the unknowns do not explain
    /// ([`super::UnmodelledError`]).
    pub fn after(&self, chosen: &[usize]) -> f64 {
        PlanPosterior::of(self, chosen).map_or(f64::INFINITY, |posterior| posterior.remaining().sqrt())
    }

    /// Chooses `count` candidates that leave a small expected error at the task. Returns their indices; the
    /// most informative candidate comes first.
    ///
    /// A greedy method first adds one candidate after another. Then at most `PASSES` passes exchange each
    /// pose for a better candidate if there is one (Fedorov 1972). `progress` receives the number of
    /// finished steps and the largest possible number of steps. Returns None if there are fewer than `count`
    /// candidates.
    pub fn best(&self, count: usize, progress: &mut dyn FnMut(usize, usize)) -> Option<Vec<usize>> {
        if count > self.candidates() {
            return None;
        }
        let steps = count * (PASSES + 1);
        let mut posterior = PlanPosterior::of(self, &[])?;
        for k in 0..count {
            posterior.add(posterior.most_telling()?)?;
            progress(k + 1, steps);
        }
        for pass in 0..PASSES {
            let mut exchanged = false;
            for (k, pose) in posterior.chosen.clone().into_iter().enumerate() {
                posterior.remove(pose)?;
                let best = posterior.most_telling()?;
                let is_better = posterior.gain(best) > posterior.gain(pose) * (1.0 + BETTER);
                exchanged |= is_better && best != pose;
                posterior.add(if is_better { best } else { pose })?;
                progress(count * (pass + 1) + k + 1, steps);
            }
            if !exchanged {
                break;
            }
        }
        progress(steps, steps);
        self.in_order(posterior.chosen)
    }

    /// Returns the chosen candidates in the order of a greedy choice among them.
    fn in_order(&self, mut chosen: Vec<usize>) -> Option<Vec<usize>> {
        let mut posterior = PlanPosterior::of(self, &[])?;
        chosen.sort_unstable();
        while let Some(next) = posterior.most_telling_of(chosen.iter().copied()) {
            chosen.retain(|pose| *pose != next);
            posterior.add(next)?;
        }
        Some(posterior.chosen)
    }
}
