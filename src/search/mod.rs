//! Choose: the placement of every movable equipment and the operation spots, by argmin solvers.
//!
//! The free coordinates of all placements make a point of the unit cube ([`Space`]); the cost of a
//! point is that of [`crate::layout::evaluate`]. A global solver with restarts takes most of the
//! budget, a Nelder-Mead polish from the best layout the rest. The solvers propose, `evaluate`
//! decides: the problem keeps the best feasible layout it has ever seen, whatever a solver thinks
//! its best is. Same cell, seed and budget give the same bytes for any number of threads.

pub mod bound;
mod cma_es;
mod problem;
mod solvers;
mod space;

pub use problem::{Progress, Watch};
pub use space::Space;

use crate::cell::{Layout, SearchSettings};
use crate::layout::{Evaluation, Workcell, evaluate};
use problem::{Problem, Record};

/// Share of the budget kept for the polish.
const POLISH_SHARE: f64 = 0.1;

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// Every evaluation of the budget was used, or the polish had nothing left to gain.
    Done,
    /// Somebody asked to stop.
    Interrupted,
    /// No placement has a range.
    NothingToSearch,
}

/// One layout with its worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    pub layout: Layout,
    pub evaluation: Evaluation,
}

/// The result of a search.
#[derive(Debug, Clone)]
pub struct SearchRecord {
    pub start: Candidate,
    /// The best layout: feasible, or the nearest to feasible if none was.
    pub best: Candidate,
    pub evaluations: u64,
    /// How many of the evaluated layouts were feasible.
    pub feasible: u64,
    /// Evaluations and objective (m) at each improvement of the best feasible layout.
    pub trace: Vec<(u64, f64)>,
    pub ended: Ended,
}

impl SearchRecord {
    /// Whether a feasible layout was found. That there is none is a normal outcome.
    pub fn found(&self) -> bool {
        self.best.evaluation.objective.is_some()
    }
}

/// Searches the layout of a cell.
pub fn search(workcell: &Workcell, settings: &SearchSettings, watch: &Watch<'_>) -> SearchRecord {
    let space = Space::new(&workcell.cell);
    let start = candidate(workcell, workcell.cell.start());
    if space.dimensions() == 0 {
        let feasible = u64::from(start.evaluation.objective.is_some());
        let (best, ended) = (start.clone(), Ended::NothingToSearch);
        return SearchRecord { start, best, evaluations: 1, feasible, trace: Vec::new(), ended };
    }
    let mut problem = Problem::new(workcell, &space, settings.budget, watch);
    let polish = (settings.budget as f64 * POLISH_SHARE) as u64;
    problem.allow(settings.budget - polish);
    // The layout as drawn is the first candidate, so that no answer is worse.
    problem.try_point(&space.start());
    solvers::explore(&problem, settings, space.start());
    problem.allow(settings.budget);
    solvers::polish(&problem);
    let ended = if problem.interrupted() { Ended::Interrupted } else { Ended::Done };
    let mut record = problem.into_record();
    let mut best = candidate(workcell, space.layout(&record.point));
    // Drawn finer than the search rounds, it can still be the better one.
    if start.evaluation.cost < best.evaluation.cost {
        best = start.clone();
        record.trace.extend(best.evaluation.objective.map(|e| (record.evaluations, e)));
    }
    let Record { evaluations, feasible, trace, .. } = record;
    SearchRecord { start, best, evaluations, feasible, trace, ended }
}

fn candidate(workcell: &Workcell, layout: Layout) -> Candidate {
    Candidate { evaluation: evaluate(workcell, &layout), layout }
}
