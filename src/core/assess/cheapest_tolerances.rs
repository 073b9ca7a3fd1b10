//! Solution of the tolerance allocation of a cell. The error model of the cell judges the tolerances. In the
//! statistical reading, Monte Carlo samples check the result.

use super::allocation::{CellAllocation, NoAllocation};
use super::sampled_allocation::SampledRequirement;
use crate::allocation::{AllocationFailure, JudgedAllocation, LinearFigure, ToleranceJudge, allocate_judged};
use crate::cell::{Parameter, ToleranceCost};
use crate::layout::Workcell;

/// Largest number of allocations. After each allocation, Monte Carlo samples may correct the limits.
const MAX_SAMPLED_ROUNDS: usize = 4;

/// Cheapest tolerances of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CheapestTolerances {
    pub found: JudgedAllocation,
    /// Monte Carlo checks; empty unless the reading is statistical.
    pub sampled: Vec<SampledRequirement>,
    /// Number of repeated allocations. An allocation is repeated if Monte Carlo samples do not confirm an
    /// error figure, and the sampled error exceeds the limit.
    pub sampled_rounds: usize,
}

impl CellAllocation<'_> {
    /// Finds the cheapest tolerances.
    ///
    /// # Errors
    /// Returns the reason if there are no such tolerances.
    pub fn solve(&self) -> Result<CheapestTolerances, NoAllocation> {
        let costs: Vec<ToleranceCost> = self.parameters.iter().map(|p| p.cost.clone()).collect();
        let mut limits: Vec<f64> = self.requirements.iter().map(|r| r.limit).collect();
        for round in 0..MAX_SAMPLED_ROUNDS {
            let mut judge = CellJudge { problem: self, scales: Vec::new(), scaled: None, values: Vec::new() };
            let found = allocate_judged(&costs, &limits, &mut judge);
            let found = found.map_err(|why| match why {
                AllocationFailure::Infeasible(shortfalls) => NoAllocation::Infeasible(shortfalls),
                AllocationFailure::NotSolved => NoAllocation::NotSolved,
            })?;
            let sampled = self.sampled(&found)?;
            let mut is_kept = true;
            for check in sampled.iter().filter(|check| !check.confirmed) {
                let (k, value) = (check.requirement, check.figure.value);
                if value > self.requirements[k].limit {
                    limits[k] *= self.requirements[k].limit / value;
                    is_kept = false;
                }
            }
            if is_kept || round + 1 == MAX_SAMPLED_ROUNDS {
                return Ok(CheapestTolerances { found, sampled, sampled_rounds: round });
            }
        }
        Err(NoAllocation::NotSolved)
    }
}

/// Implementation of [`ToleranceJudge`] that computes the figures with the error model of the cell.
struct CellJudge<'p, 'a> {
    problem: &'p CellAllocation<'a>,
    /// Scales that were judged last. `scaled` is the workcell at these scales, and `values` are the figures
    /// at these scales.
    scales: Vec<f64>,
    scaled: Option<Workcell>,
    values: Vec<f64>,
}

impl ToleranceJudge for CellJudge<'_, '_> {
    fn values(&mut self, scales: &[f64]) -> Option<Vec<f64>> {
        let scaled = self.problem.scaled(scales).ok()?;
        self.values = self.problem.figures(&scaled).ok()?;
        self.scales = scales.to_vec();
        self.scaled = Some(scaled);
        Some(self.values.clone())
    }

    fn linear(&mut self, which: &[usize]) -> Option<Vec<LinearFigure>> {
        let free: Vec<Parameter> = self.problem.parameters.iter().map(|p| p.parameter).collect();
        let linear = self.problem.visit(self.scaled.as_ref()?, which.iter().copied(), |k, figure| {
            figure.linear(&free, &self.scales, self.values[k], &mut figure.evaluator.memory())
        });
        linear.ok()
    }

    fn is_bounded_by_linear(&self) -> bool {
        let workcell = self.problem.workcell;
        let first = self.problem.visit(workcell, std::iter::once(0), |_, figure| figure.is_convex());
        first.is_ok_and(|convex| convex == [true])
    }
}
