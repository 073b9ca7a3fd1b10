//! What lies beside the layouts that a search keeps besides the best one.
//!
//! From every member of the front, or of the shortlist, one coordinate at a time is changed: a list through
//! all of its values, a range by steps that become finer; then two lists at a time. New members are asked
//! in their turn (Pareto local search: L. Paquete, M. Chiarandini, T. Stuetzle, in Metaheuristics for
//! Multiobjective Optimisation, 2004). A space of so few layouts that all can be asked is asked whole.

use super::problem::Problem;
use std::collections::BTreeSet;

/// What is changed at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Change {
    /// One list.
    List,
    /// Two lists.
    Lists,
    /// One range, by this share of it.
    Range(f64),
}

/// Far, just another layout of the shortlist, and near, to improve on a member.
const CHANGES: [Change; 7] = [
    Change::List,
    Change::Range(0.1),
    Change::Range(0.051),
    Change::Lists,
    Change::Range(0.02),
    Change::Range(0.01),
    Change::Range(0.005),
];

/// Asks until the budget allowed is used up or nothing is left to ask.
pub fn poll(problem: &Problem<'_>) {
    if let Some(all) = problem.space().every_point(problem.left()) {
        problem.try_points(&all);
        return;
    }
    let bits = |point: &Vec<f64>| point.iter().map(|u| u.to_bits()).collect::<Vec<_>>();
    let mut asked = BTreeSet::new();
    for change in CHANGES {
        let mut polled = BTreeSet::new();
        while problem.left() > 0
            && let Some(point) = problem.kept_points().into_iter().find(|p| !polled.contains(&bits(p)))
        {
            let mut beside = problem.space().neighbours(&point, change);
            beside.retain(|p| asked.insert(bits(p)));
            problem.try_points(&beside);
            polled.insert(bits(&point));
        }
    }
}
