//! Discrete grades: branch and bound over the relaxation, which permits mixtures of grades.
//!
//! A branch is a subproblem that permits only some of the grades of each parameter. The lower bound of a
//! branch is the Lagrangian bound of its relaxation. A grade is discarded if the bound with this grade alone
//! exceeds the best known cost (reduced-cost fixing). The scales of a relaxation, rounded to the next tighter
//! grades, meet the requirements. The rounded scales are then improved by loosening single grades.

use super::cone_program::ScaleDomain;
use super::cutting_planes::{CutPool, RelaxedSolution, keep_limits};
use super::lagrangian::least_priced;
use super::linear_figure::{FigureScratch, LinearFigure};
use crate::cell::ToleranceCost;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Largest number of branches; the lower bound is valid even if the search ends at this number.
const MAX_BRANCHES: usize = 4000;
/// Relative gap at which a branch is closed (not split further). The gap is between the lower bound of the
/// branch and the best known cost.
const CLOSED: f64 = 1e-9;
/// Largest violation of a limit, as a share of the limit, that rounding may cause. Grades with at most this
/// violation still meet the limit.
const ROUNDING: f64 = 1e-9;

/// Branch of the search: the scales that it permits, and the solution of its relaxation.
struct GradeBranch {
    domains: Vec<ScaleDomain>,
    relaxed: RelaxedSolution,
}

impl PartialEq for GradeBranch {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for GradeBranch {}

impl PartialOrd for GradeBranch {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for GradeBranch {
    /// Compares branches so that the heap returns the branch with the least bound first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.relaxed.bound.total_cmp(&self.relaxed.bound)
    }
}

/// Search for the cheapest choice of grades.
struct GradeSearch<'a> {
    costs: &'a [ToleranceCost],
    figures: &'a [LinearFigure],
    pool: &'a mut CutPool,
    scratch: &'a mut FigureScratch,
    /// Cheapest known scales without a mixture of grades, with their cost.
    best: Option<(Vec<f64>, f64)>,
}

/// Returns the cheapest scales and a lower bound of the cost. A parameter with grades has the scale of one
/// of its grades.
///
/// `relaxed` is the solution with mixtures of all grades. Returns None if the solver fails.
pub fn choose_grades(
    costs: &[ToleranceCost],
    figures: &[LinearFigure],
    relaxed: RelaxedSolution,
    pool: &mut CutPool,
    scratch: &mut FigureScratch,
) -> Option<(Vec<f64>, f64)> {
    let mut search = GradeSearch { costs, figures, pool, scratch, best: None };
    search.consider(&costs.iter().map(|cost| cost.range.0).collect::<Vec<_>>());
    let domains: Vec<ScaleDomain> = costs.iter().map(ScaleDomain::of).collect();
    let mut heap = BinaryHeap::new();
    search.offer(GradeBranch { domains, relaxed }, &mut heap);
    let mut left = f64::INFINITY;
    for _ in 0..MAX_BRANCHES {
        left = heap.peek().map_or(f64::INFINITY, |branch: &GradeBranch| branch.relaxed.bound);
        let Some(branch) = heap.pop().filter(|b| search.is_open(b.relaxed.bound)) else {
            left = f64::INFINITY;
            break;
        };
        for domains in search.split(branch) {
            if let Some(relaxed) = search.pool.relaxed(costs, &domains, figures, search.scratch)
                && search.is_permitted(&domains)
            {
                search.offer(GradeBranch { domains, relaxed }, &mut heap);
            }
        }
    }
    search.best.map(|(scales, cost)| (scales, cost.min(left)))
}

impl GradeSearch<'_> {
    /// Returns whether a branch with the lower bound `bound` may hold a better choice than the best known
    /// choice.
    fn is_open(&self, bound: f64) -> bool {
        self.best.as_ref().is_none_or(|(_, cost)| bound < cost * (1.0 - CLOSED))
    }

    /// Returns whether the tightest grades of a branch meet the requirements.
    fn is_permitted(&mut self, domains: &[ScaleDomain]) -> bool {
        let tightest: Vec<f64> = self.costs.iter().zip(domains).map(|(c, d)| d.ends(c).0).collect();
        self.keeps(&tightest)
    }

    fn keeps(&mut self, scales: &[f64]) -> bool {
        self.figures.iter().all(|f| f.value(scales, self.scratch) <= 1.0 + ROUNDING)
    }

    /// Rounds the relaxed scales of a branch to a choice of grades, and keeps the branch if it is open.
    /// Grades that cannot lead to a lower cost are discarded.
    fn offer(&mut self, mut branch: GradeBranch, heap: &mut BinaryHeap<GradeBranch>) {
        let pairs = self.costs.iter().zip(&branch.domains).zip(&branch.relaxed.scales);
        let rounded: Vec<f64> = pairs.map(|((cost, domain), u)| tighter(cost, domain, *u)).collect();
        self.consider(&rounded);
        if !self.is_open(branch.relaxed.bound) {
            return;
        }
        if let Some((_, best)) = &self.best {
            let slack = best - branch.relaxed.bound;
            for ((cost, domain), price) in
                self.costs.iter().zip(&mut branch.domains).zip(&branch.relaxed.prices)
            {
                let (_, least) = least_priced(cost, domain, *price);
                if let ScaleDomain::Grades(allowed) = domain {
                    let alone = |g: usize| cost.grades()[g].cost + price * cost.grades()[g].scale - least;
                    allowed.retain(|&g| alone(g) <= slack);
                }
            }
        }
        let is_empty = |domain: &ScaleDomain| matches!(domain, ScaleDomain::Grades(a) if a.is_empty());
        if !branch.domains.iter().any(is_empty) {
            heap.push(branch);
        }
    }

    /// Splits a branch at the parameter whose relaxed scale is farthest from both neighbouring grades. The
    /// distance is weighted by the difference of the costs of these grades.
    ///
    /// If no parameter has two grades left, the function optimizes the continuous scales and returns no
    /// branches.
    fn split(&mut self, branch: GradeBranch) -> Vec<Vec<ScaleDomain>> {
        let GradeBranch { domains, relaxed } = branch;
        let mut widest: Option<(f64, usize, usize)> = None;
        for (k, (cost, domain)) in self.costs.iter().zip(&domains).enumerate() {
            let ScaleDomain::Grades(allowed) = domain else { continue };
            if allowed.len() < 2 {
                continue;
            }
            let u = relaxed.scales[k];
            let below = allowed.iter().rposition(|&g| cost.grades()[g].scale <= u * (1.0 + CLOSED));
            let below = below.unwrap_or(0).min(allowed.len() - 2);
            let [a, b] = [below, below + 1].map(|place| &cost.grades()[allowed[place]]);
            let share = ((u - a.scale) / (b.scale - a.scale)).clamp(0.0, 1.0);
            let lost = share * (a.cost - b.cost).min(f64::MAX) * (1.0 - share) + f64::EPSILON;
            if widest.is_none_or(|(most, ..)| lost > most) {
                widest = Some((lost, k, below));
            }
        }
        let Some((_, k, below)) = widest else {
            self.finish(&domains);
            return Vec::new();
        };
        let ScaleDomain::Grades(allowed) = &domains[k] else { return Vec::new() };
        let (tight, loose) = allowed.split_at(below + 1);
        let with = |part: &[usize]| {
            let mut own = domains.clone();
            own[k] = ScaleDomain::Grades(part.to_vec());
            own
        };
        vec![with(loose), with(tight)]
    }

    /// Optimizes the continuous scales of a branch in which each parameter with grades has only one grade
    /// left.
    fn finish(&mut self, domains: &[ScaleDomain]) {
        if let Some(relaxed) = self.pool.relaxed(self.costs, domains, self.figures, self.scratch) {
            self.consider(&relaxed.scales);
        }
    }

    /// Loosens single grades of a choice, and records the result if it costs less than the best choice. A
    /// choice is ignored if it exceeds a limit even after its continuous scales are reduced.
    fn consider(&mut self, scales: &[f64]) {
        let mut scales: Vec<f64> = self.costs.iter().zip(scales).map(|(c, u)| c.ordered(*u)).collect();
        if !self.keeps(&scales) {
            let is_continuous = self.costs.iter().all(|cost| cost.grades().is_empty());
            if !is_continuous {
                self.shrink_continuous(&mut scales);
            }
            if !self.keeps(&scales) {
                return;
            }
        }
        while self.loosen(&mut scales) {}
        let cost: f64 = self.costs.iter().zip(&scales).map(|(c, u)| c.cost(*u)).sum();
        if self.best.as_ref().is_none_or(|(_, best)| cost < *best) {
            self.best = Some((scales, cost));
        }
    }

    /// Reduces the continuous scales to remove a violation that the limited accuracy of the solver causes.
    fn shrink_continuous(&mut self, scales: &mut [f64]) {
        let grades: Vec<(usize, f64)> = (0..scales.len())
            .filter(|&k| !self.costs[k].grades().is_empty())
            .map(|k| (k, scales[k]))
            .collect();
        for _ in 0..3 {
            keep_limits(self.costs, self.figures, scales, self.scratch);
            grades.iter().for_each(|&(k, u)| scales[k] = u);
        }
    }

    /// Loosens the one grade that saves most and meets the requirements. Returns false if there is no such
    /// grade.
    fn loosen(&mut self, scales: &mut [f64]) -> bool {
        let mut steps: Vec<(f64, usize, f64)> = Vec::new();
        for (k, cost) in self.costs.iter().enumerate() {
            if let Some(next) = cost.grade(scales[k]).and_then(|g| cost.grades().get(g + 1)) {
                steps.push((cost.cost(scales[k]) - next.cost, k, next.scale));
            }
        }
        steps.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, k, scale) in steps {
            let before = std::mem::replace(&mut scales[k], scale);
            if self.keeps(scales) {
                return true;
            }
            scales[k] = before;
        }
        false
    }
}

/// Returns the loosest scale in a domain that is at most `u`. If all scales are greater, returns the
/// tightest one.
fn tighter(cost: &ToleranceCost, domain: &ScaleDomain, u: f64) -> f64 {
    match domain {
        ScaleDomain::Range(low, high) => u.clamp(*low, *high),
        ScaleDomain::Grades(allowed) => {
            let scales = allowed.iter().filter_map(|&g| cost.grades().get(g)).map(|g| g.scale);
            let below = scales.rev().find(|scale| *scale <= u * (1.0 + CLOSED));
            below.unwrap_or_else(|| domain.ends(cost).0)
        }
    }
}
