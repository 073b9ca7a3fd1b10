//! Infeasible requirements: the excess of a figure over its limit at the tightest tolerances, and the causes
//! of this excess. Each cause is the lower bound of a scale.

use super::linear_figure::FigureScratch;
use super::problem::ToleranceProblem;

/// Relative excess up to which the tightest tolerances count as meeting a limit.
const ROUNDING: f64 = 1e-12;

/// Requirement whose figure exceeds its limit even at the tightest tolerances.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceShortfall {
    pub requirement: usize,
    /// Limit of the requirement.
    pub limit: f64,
    /// Least possible figure: the figure at the tightest tolerances.
    pub least: f64,
    /// Lower bounds of scales, one for each parameter whose error makes [`Self::least`] larger. The bound
    /// with the least value of [`BoundInTheWay::without`] comes first.
    pub bounds: Vec<BoundInTheWay>,
}

/// Lower bound of the scale of one parameter. This bound contributes to the excess of a figure over its
/// limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundInTheWay {
    pub parameter: usize,
    /// Figure if the parameter [`Self::parameter`] had no error and all other tolerances were at their
    /// tightest.
    pub without: f64,
}

/// Returns the requirements whose figures exceed their limits even at the tightest tolerances.
pub fn shortfalls(problem: &ToleranceProblem, scratch: &mut FigureScratch) -> Vec<ToleranceShortfall> {
    let mut tightest: Vec<f64> = problem.costs.iter().map(|cost| cost.range.0).collect();
    let mut found = Vec::new();
    for (requirement, r) in problem.requirements.iter().enumerate() {
        let least = r.figure.value(&tightest, scratch);
        if least <= r.limit * (1.0 + ROUNDING) {
            continue;
        }
        let mut bounds = Vec::new();
        for parameter in 0..tightest.len() {
            let own = std::mem::take(&mut tightest[parameter]);
            let without = r.figure.value(&tightest, scratch);
            tightest[parameter] = own;
            if without < least {
                bounds.push(BoundInTheWay { parameter, without });
            }
        }
        bounds.sort_by(|a, b| a.without.total_cmp(&b.without));
        found.push(ToleranceShortfall { requirement, limit: r.limit, least, bounds });
    }
    found
}
