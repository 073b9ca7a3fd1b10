//! Local search around the members of the Pareto front or the shortlist.
//!
//! Each change affects one coordinate of a member, or two coordinates with listed values. A coordinate with
//! listed values takes each of these values. A coordinate with a range takes steps that become smaller. The
//! neighbours of new members are explored, too (Pareto local search: L. Paquete, M. Chiarandini, T. Stuetzle,
//! in Metaheuristics for Multiobjective Optimisation, 2004). If the budget suffices for every layout of the
//! space, the search evaluates all of them.

use super::problem::Problem;
use super::search_space::NeighbourChange;
use std::collections::BTreeSet;

/// Neighbour changes, in the order in which the search tries them.
///
/// Large changes find other layouts for the shortlist; small changes improve a member.
const CHANGES: [NeighbourChange; 7] = [
    NeighbourChange::List,
    NeighbourChange::Range(0.1),
    NeighbourChange::Range(0.051),
    NeighbourChange::Lists,
    NeighbourChange::Range(0.02),
    NeighbourChange::Range(0.01),
    NeighbourChange::Range(0.005),
];

/// Explores the neighbours of all members until the budget is used up or no neighbour is left.
pub fn run(problem: &Problem<'_>) {
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
