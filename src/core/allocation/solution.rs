//! Solution of a tolerance allocation problem.

use super::cone_program::ScaleDomain;
use super::cutting_planes::{CutPool, RelaxedSolution, keep_limits};
use super::grade_choice::choose_grades;
use super::linear_figure::{FigureScratch, LinearFigure};
use super::problem::ToleranceProblem;
use super::shortfall::{ToleranceShortfall, shortfalls};

/// Cheapest set of tolerances.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceAllocation {
    /// Scale of every tolerance.
    pub scales: Vec<f64>,
    /// Cost of these tolerances.
    pub cost: f64,
    /// Lower bound of the cost of any set of tolerances that meets the requirements.
    pub lower_bound: f64,
    /// Figure of every requirement at these scales.
    pub values: Vec<f64>,
    /// Shadow price of every requirement: the decrease of the cost per unit increase of its limit. If a cost
    /// model has grades, the shadow prices belong to a relaxed problem that permits mixtures of grades.
    pub shadow_prices: Vec<f64>,
    /// Number of cone programs solved.
    pub programs: usize,
}

impl ToleranceAllocation {
    /// Returns the duality gap `cost / lower bound - 1`, at least 0.
    pub fn gap(&self) -> f64 {
        if self.lower_bound > 0.0 { (self.cost / self.lower_bound - 1.0).max(0.0) } else { 0.0 }
    }
}

/// Reason why there is no allocation.
#[derive(Debug, Clone, PartialEq)]
pub enum AllocationFailure {
    /// Requirements whose figures exceed their limits even at the tightest tolerances.
    Infeasible(Vec<ToleranceShortfall>),
    /// The solver of the cone programs failed.
    NotSolved,
}

/// Finds the cheapest tolerances that meet all requirements.
///
/// # Errors
///
/// Returns [`AllocationFailure::Infeasible`] if a figure exceeds its limit even at the tightest tolerances.
/// Returns [`AllocationFailure::NotSolved`] if the solver fails.
pub fn allocate(problem: &ToleranceProblem) -> Result<ToleranceAllocation, AllocationFailure> {
    let mut scratch = FigureScratch::default();
    let ToleranceProblem { costs, requirements } = problem;
    let exceeded = shortfalls(problem, &mut scratch);
    if !exceeded.is_empty() {
        return Err(AllocationFailure::Infeasible(exceeded));
    }
    let figures: Vec<LinearFigure> = requirements.iter().map(|r| r.figure.scaled(1.0 / r.limit)).collect();
    let domains: Vec<ScaleDomain> = costs.iter().map(ScaleDomain::of).collect();
    let mut pool = CutPool::default();
    let relaxed = pool.relaxed(costs, &domains, &figures, &mut scratch);
    let relaxed = relaxed.ok_or(AllocationFailure::NotSolved)?;
    let has_grades = costs.iter().any(|cost| !cost.grades().is_empty());
    let RelaxedSolution { mut scales, bound, shadow, .. } = match has_grades {
        false => relaxed,
        true => {
            let chosen = choose_grades(costs, &figures, relaxed.clone(), &mut pool, &mut scratch);
            let (scales, bound) = chosen.ok_or(AllocationFailure::NotSolved)?;
            RelaxedSolution { scales, bound, ..relaxed }
        }
    };
    if !has_grades {
        keep_limits(costs, &figures, &mut scales, &mut scratch);
    }
    let cost: f64 = costs.iter().zip(&scales).map(|(cost, u)| cost.cost(*u)).sum();
    let values = requirements.iter().map(|r| r.figure.value(&scales, &mut scratch)).collect();
    let shadow_prices = shadow.iter().zip(requirements).map(|(s, r)| s / r.limit).collect();
    Ok(ToleranceAllocation {
        cost,
        lower_bound: bound.min(cost),
        values,
        shadow_prices,
        programs: pool.programs,
        scales,
    })
}
