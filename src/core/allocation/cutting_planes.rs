//! Cutting planes: solves the relaxed problem with only the cuts that bind.

use super::cone_cut::ConeCut;
use super::cone_program::{COARSE, FINE, ScaleDomain, solve};
use super::dual_ascent::{PricedScales, priced_scales};
use super::lagrangian::least_priced;
use super::linear_figure::{FigureScratch, LinearFigure};
use crate::cell::ToleranceCost;

/// Largest number of cone programs for one relaxation.
const MAX_ROUNDS: usize = 60;
/// A coarse solution adds a cut if it violates a limit by more than this share of the limit.
const COARSE_VIOLATION: f64 = 1e-3;
/// A solution counts as meeting a limit if it violates the limit by less than this share of the limit.
const VIOLATION: f64 = 1e-9;
/// The solution of the dual ascent is final if its relative duality gap is at most this value. Otherwise cone
/// programs solve the relaxed problem.
const ASCENT_GAP: f64 = 1e-9;
/// Largest number of requirements that add a cut in one round.
const MAX_NEW_CUTS: usize = 12;

/// Cuts found so far, which hold for every set of tolerances that meets the requirements.
#[derive(Default)]
pub struct CutPool {
    /// Constraint of every cut, with the index of its requirement.
    pub cuts: Vec<(usize, ConeCut)>,
    /// Number of cone programs solved.
    pub programs: usize,
}

/// Solution of the relaxed problem, in which grades may be mixed.
#[derive(Debug, Clone)]
pub struct RelaxedSolution {
    /// Scales within the domains that meet every requirement up to the accuracy of the solver.
    pub scales: Vec<f64>,
    /// Lower bound of the cost of all scales in the domains that meet every requirement.
    pub bound: f64,
    /// Price of every scale: the derivative of the constraint terms of the Lagrangian with respect to this
    /// scale. The derivative is taken at the solution.
    pub prices: Vec<f64>,
    /// Shadow price of the limit of every requirement: the cost saved per relative increase of the limit.
    pub shadow: Vec<f64>,
}

impl CutPool {
    /// Solves the relaxed problem; `figures` are scaled so that every limit is 1.
    ///
    /// Returns None if the solver fails. The tightest scales of the domains must meet every requirement.
    pub fn relaxed(
        &mut self,
        costs: &[ToleranceCost],
        domains: &[ScaleDomain],
        figures: &[LinearFigure],
        scratch: &mut FigureScratch,
    ) -> Option<RelaxedSolution> {
        let start: Vec<f64> = costs.iter().zip(domains).map(|(c, d)| d.ends(c).1).collect();
        let largest = figures.iter().map(|f| f.value(&start, scratch)).fold(0.0, f64::max);
        if largest <= 1.0 {
            let bound = costs.iter().zip(domains).map(|(c, d)| least_priced(c, d, 0.0).1).sum();
            let (prices, shadow) = (vec![0.0; costs.len()], vec![0.0; figures.len()]);
            return Some(RelaxedSolution { scales: start, bound, prices, shadow });
        }
        let is_continuous = domains.iter().all(|domain| matches!(domain, ScaleDomain::Range(..)));
        let ascended = match self.cuts.is_empty() && is_continuous {
            true => priced_scales(costs, figures, ASCENT_GAP, scratch),
            false => None,
        };
        let knows_cuts = ascended.is_some();
        if let Some(found) = ascended {
            if found.gap() <= ASCENT_GAP {
                let PricedScales { scales, lower_bound: bound, prices, shadow_prices: shadow, .. } = found;
                return Some(RelaxedSolution { scales, bound, prices, shadow });
            }
            self.cuts = found.cuts;
        } else if self.cuts.is_empty() {
            let shrunk: Vec<f64> = start.iter().map(|u| u / largest).collect();
            self.separate(figures, &shrunk, 0.9, scratch);
        }
        let mut best: Option<RelaxedSolution> = None;
        // Dual ascent already gives the cuts that bind. Without dual ascent, coarse solutions find most of
        // these cuts, and fine solutions find the rest.
        let has_many_cuts = figures.iter().any(LinearFigure::has_many_cuts);
        let (mut tolerance, mut violation) = match has_many_cuts && !knows_cuts {
            true => (COARSE, COARSE_VIOLATION),
            false => (FINE, VIOLATION),
        };
        for _ in 0..MAX_ROUNDS {
            let cuts: Vec<&ConeCut> = self.cuts.iter().map(|(_, cut)| cut).collect();
            self.programs += 1;
            let Some(solution) = solve(costs, domains, &cuts, tolerance) else { break };
            let mut found = self.bounded(costs, domains, figures.len(), &solution.duals);
            found.scales = solution.scales;
            for ((u, cost), domain) in found.scales.iter_mut().zip(costs).zip(domains) {
                let (low, high) = domain.ends(cost);
                *u = u.clamp(low, high);
            }
            let is_closed = !self.separate(figures, &found.scales, 1.0 + violation, scratch);
            best = Some(found);
            match (is_closed, tolerance == FINE) {
                (true, true) => break,
                (true, false) => (tolerance, violation) = (FINE, VIOLATION),
                (false, _) => {}
            }
        }
        best
    }

    /// Adds new cuts for the requirements with the largest figures above `threshold`. At most `MAX_NEW_CUTS`
    /// requirements add a cut. Returns whether a cut was added.
    fn separate(
        &mut self,
        figures: &[LinearFigure],
        scales: &[f64],
        threshold: f64,
        scratch: &mut FigureScratch,
    ) -> bool {
        let mut found: Vec<(f64, usize, ConeCut)> = Vec::new();
        for (i, figure) in figures.iter().enumerate() {
            let (value, cut) = figure.cut(scales, scratch);
            if value > threshold && !self.cuts.iter().any(|(own, known)| *own == i && known.is_same(&cut)) {
                found.push((value, i, cut));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let is_new = !found.is_empty();
        self.cuts.extend(found.into_iter().take(MAX_NEW_CUTS).map(|(_, i, cut)| (i, cut)));
        is_new
    }

    /// Returns the lower bound of the cost that the dual vectors of the cuts prove, with the prices of the
    /// scales. The list `scales` of the result is empty.
    fn bounded(
        &self,
        costs: &[ToleranceCost],
        domains: &[ScaleDomain],
        requirements: usize,
        duals: &[Vec<f64>],
    ) -> RelaxedSolution {
        let (mut prices, mut limit) = (vec![0.0; costs.len()], 0.0);
        let mut shadow = vec![0.0; requirements];
        for ((requirement, cut), dual) in self.cuts.iter().zip(duals) {
            shadow[*requirement] += cut.add_inequality(dual, &mut prices, &mut limit);
        }
        let parts =
            costs.iter().zip(domains).zip(&prices).map(|((c, d), price)| least_priced(c, d, *price).1);
        let bound = parts.sum::<f64>() - limit;
        RelaxedSolution { scales: Vec::new(), bound, prices, shadow }
    }
}

impl ScaleDomain {
    /// Returns the domain that a cost model permits.
    pub fn of(cost: &ToleranceCost) -> Self {
        match cost.grades().len() {
            0 => Self::Range(cost.range.0, cost.range.1),
            grades => Self::Grades((0..grades).collect()),
        }
    }

    /// Returns the least and the greatest scale of the domain.
    pub fn ends(&self, cost: &ToleranceCost) -> (f64, f64) {
        match self {
            Self::Range(low, high) => (*low, *high),
            Self::Grades(allowed) => {
                let scale =
                    |g: Option<&usize>| g.and_then(|&g| cost.grades().get(g)).map_or(1.0, |g| g.scale);
                (scale(allowed.first()), scale(allowed.last()))
            }
        }
    }
}

/// Divides all scales once by the largest figure if this figure exceeds its limit of 1. The limited accuracy
/// of the solver causes such a violation.
///
/// No scale falls below its range, and fixed errors do not change. A figure can therefore still exceed its
/// limit of 1.
pub fn keep_limits(
    costs: &[ToleranceCost],
    figures: &[LinearFigure],
    scales: &mut [f64],
    scratch: &mut FigureScratch,
) {
    let largest = figures.iter().map(|f| f.value(scales, scratch)).fold(0.0, f64::max);
    if largest > 1.0 {
        for (u, cost) in scales.iter_mut().zip(costs) {
            *u = (*u / largest).max(cost.range.0);
        }
    }
}
