//! Monte Carlo check of an allocation: samples of the nonlinear model are drawn at the allocated tolerances.

use super::SAMPLES;
use super::allocation::{CellAllocation, NoAllocation};
use crate::allocation::{JudgedAllocation, NodeFigure};
use crate::cell::{Quantity, Reading};
use crate::reading::{Estimate, MonteCarlo, SampleSpace, SampledPosture};

/// Largest number of requirements that Monte Carlo samples check. The requirements nearest to their limits
/// are checked.
const MAX_SAMPLED: usize = 4;
/// Monte Carlo check of one requirement at the allocated tolerances.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledRequirement {
    pub requirement: usize,
    /// Figure of the requirement, estimated from samples of the nonlinear model, m or rad.
    pub figure: Estimate,
    /// Whether the samples confirm the first-order figure.
    pub confirmed: bool,
}

impl CellAllocation<'_> {
    /// Uses Monte Carlo samples of the nonlinear model to check the requirements nearest to their limits.
    pub(super) fn sampled(&self, found: &JudgedAllocation) -> Result<Vec<SampledRequirement>, NoAllocation> {
        let cell = &self.workcell.cell;
        if cell.reading != Reading::Statistical {
            return Ok(Vec::new());
        }
        let used = |k: usize| found.judged[k] / self.requirements[k].limit;
        let mut order: Vec<usize> = (0..self.requirements.len()).collect();
        order.sort_by(|&a, &b| used(b).total_cmp(&used(a)).then(a.cmp(&b)));
        order.truncate(MAX_SAMPLED);
        let scaled = self.scaled(&found.allocation.scales)?;
        let space = SampleSpace::of_cell(&scaled.cell);
        self.visit(&scaled, order.into_iter(), |requirement, figure| {
            let value = found.judged[requirement];
            let NodeFigure { evaluator, context, frames, .. } = *figure;
            let posture = SampledPosture { evaluator, context, frames, p95: value };
            let samples = posture.monte_carlo(&space, SAMPLES, cell.search.seed);
            self.check(requirement, value, &samples)
        })
    }

    /// Compares a first-order figure with samples. If the quantity is the yield, the function compares the
    /// share of samples within the limit with the demanded yield.
    fn check(&self, requirement: usize, value: f64, samples: &MonteCarlo) -> SampledRequirement {
        let figure = match self.workcell.cell.quantity {
            Quantity::Rms => samples.rms,
            Quantity::Mean => samples.mean,
            Quantity::P95 => samples.p95,
            Quantity::P99 => samples.p99,
            Quantity::Yield => {
                let confirmed = samples.success.is_none_or(|success| success.high >= self.share);
                let value = samples.histogram.quantile(self.share);
                let figure = Estimate { value, low: value, high: value };
                return SampledRequirement { requirement, figure, confirmed };
            }
        };
        SampledRequirement { requirement, figure, confirmed: figure.agrees(value) }
    }
}
