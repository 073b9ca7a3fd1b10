//! Choose: the placement of every movable equipment and the operation spots, by argmin solvers.
//!
//! The free coordinates of all placements make a point of the unit cube ([`Space`]); the cost of a
//! point is that of [`crate::layout::evaluate`]. A global solver with restarts takes most of the
//! budget, a Nelder-Mead polish from the best layout the rest. The solvers propose, `evaluate`
//! decides: the problem keeps the best feasible layout it has ever seen, whatever a solver thinks
//! its best is. Same cell, seed and budget give the same bytes for any number of threads.
//!
//! Asked for more than one goal, every run of the global solver makes another mixture of them small, and
//! every feasible layout is offered to a front of those that no other dominates. Asked to keep more than
//! the best, it offers them to a list of the best that really differ. Both are part of the record, so that
//! a checkpoint has them; at the end, for a quarter of the budget with the polish, what lies beside their
//! members is polled.

#[doc(hidden)] // open for tests/it
pub mod aim;
mod cma_es;
mod front;
mod ledger;
mod poll;
mod problem;
mod record;
mod shortlist;
mod solvers;
mod space;
mod stopping;

pub use front::DIFFERENT;
pub use ledger::{Checkpoint, Unfit};
pub use problem::{Keep, Moment, Progress, Watch};
pub use shortlist::REALLY_DIFFERENT;
pub use space::Space;
pub use stopping::{Ended, Stopping};

use crate::cell::{Goals, Layout, SearchSettings};
use crate::layout::{Evaluation, Workcell, evaluate};
use ledger::Ledger;
use problem::Problem;
use record::Record;

/// One layout with its worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    pub layout: Layout,
    pub evaluation: Evaluation,
}

/// A layout that is told beside the best one.
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    pub candidate: Candidate,
    /// One per [`crate::cell::Goal::ALL`]: m, rad, m2 or shares.
    pub goals: Vec<f64>,
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
    /// The bound that was given, m.
    pub bound: Option<f64>,
    pub ended: Ended,
    /// The front, from the least of its first goal up; or the best layouts that really differ, best
    /// first. Empty if neither was asked.
    pub alternatives: Vec<Alternative>,
}

impl SearchRecord {
    /// Whether a feasible layout was found. That there is none is a normal outcome.
    pub fn found(&self) -> bool {
        self.best.evaluation.objective.is_some()
    }

    /// By which share of the bound the best layout lies above it.
    pub fn gap(&self) -> Option<f64> {
        let best = self.best.evaluation.objective?;
        self.bound.filter(|b| *b > 0.0).map(|bound| best / bound - 1.0)
    }
}

/// A search as a job: what is known of the answer, where to go on, and who keeps checkpoints.
pub struct Job<'a> {
    /// Proven lower bound of the objective, m.
    pub bound: Option<f64>,
    /// Where an interrupted search stood; [`Checkpoint::check`] says whether it fits.
    pub from: Option<&'a Checkpoint>,
    pub keep: Keep<'a>,
}

/// Searches the layout of a cell.
pub fn search(workcell: &Workcell, settings: &SearchSettings, watch: &Watch<'_>) -> SearchRecord {
    search_job(workcell, settings, watch, &Job { bound: None, from: None, keep: &|_, _| () })
}

/// Searches the layout of a cell, from a checkpoint if there is one: it ends in the same bits as a
/// search with the same settings that was never interrupted.
pub fn search_job(
    workcell: &Workcell,
    settings: &SearchSettings,
    watch: &Watch<'_>,
    job: &Job<'_>,
) -> SearchRecord {
    let space = Space::new(&workcell.cell);
    let start = candidate(workcell, workcell.cell.start());
    let bound = job.bound;
    if space.dimensions() == 0 {
        let feasible = u64::from(start.evaluation.objective.is_some());
        let (best, ended, trace) = (start.clone(), Ended::NothingToSearch, Vec::new());
        let asked = settings.keep > 0 || !settings.pareto.is_empty();
        let all = asked.then(|| alternative(workcell, start.layout.clone())).flatten();
        let alternatives = all.into_iter().collect();
        return SearchRecord { start, best, evaluations: 1, feasible, trace, bound, ended, alternatives };
    }
    let stopping = Stopping::new(settings, bound);
    let ledger = match job.from {
        Some(checkpoint) => Ledger::resumed(checkpoint, stopping),
        None => Ledger::new(space.start(), stopping),
    };
    (job.keep)(ledger.checkpoint(), Moment::Begun);
    let problem = Problem::new(workcell, &space, ledger, watch, job.keep);
    solvers::explore(&problem, settings, space.start());
    solvers::polish(&problem);
    if problem.begin_poll() {
        poll::poll(&problem);
    }
    let stopped = problem.interrupted();
    let ledger = problem.into_ledger();
    if stopped {
        (job.keep)(ledger.checkpoint(), Moment::Stopped);
    }
    let ended = if stopped { Ended::Interrupted } else { ledger.ended() };
    let alternatives = alternatives(workcell, &space, &ledger.record, settings.keep);
    let mut record = ledger.record;
    let mut best = candidate(workcell, space.layout(&record.point));
    // Drawn finer than the search rounds, it can still be the better one.
    if start.evaluation.cost < best.evaluation.cost {
        best = start.clone();
        record.trace.extend(best.evaluation.objective.map(|e| (record.evaluations, e)));
    }
    let Record { evaluations, feasible, trace, .. } = record;
    SearchRecord { start, best, evaluations, feasible, trace, bound, ended, alternatives }
}

fn candidate(workcell: &Workcell, layout: Layout) -> Candidate {
    Candidate { evaluation: evaluate(workcell, &layout), layout }
}

fn alternative(workcell: &Workcell, layout: Layout) -> Option<Alternative> {
    let candidate = candidate(workcell, layout);
    let goals = workcell.goals(&candidate.layout, &candidate.evaluation, &Goals::all())?;
    Some(Alternative { candidate, goals })
}

/// What the record has kept beside the best.
fn alternatives(workcell: &Workcell, space: &Space<'_>, record: &Record, keep: usize) -> Vec<Alternative> {
    let most = if keep > 0 { keep } else { usize::MAX };
    let front = record.front.iter().flat_map(|front| front.spread(most)).map(|member| &member.point);
    let shortlist = record.shortlist.iter().flat_map(|shortlist| shortlist.best());
    let points: Vec<&Vec<f64>> = front.chain(shortlist).collect();
    points.into_iter().filter_map(|point| alternative(workcell, space.layout(point))).collect()
}
