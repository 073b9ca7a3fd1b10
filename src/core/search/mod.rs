//! Search for the best layout: solvers of the crate argmin choose placements and attitudes.
//!
//! The free coordinates of all placements and attitudes form a point of the unit cube ([`SearchSpace`]). The
//! cost of a point is the cost of [`crate::layout::evaluate`], which includes a penalty for infeasible
//! layouts. A global solver with restarts (CMA-ES by default) uses most of the budget. A Nelder-Mead polish
//! of the best layout uses the remaining evaluations. The search keeps the best feasible layout of all
//! evaluated points, even if the solver reports another layout. Equal cells, seeds and budgets give the same
//! bytes for any number of threads.
//!
//! A Pareto search minimizes a scalarization: one number computed from all its goals. Every start or restart
//! of the global solver minimizes a different scalarization. A Pareto search offers every feasible layout to
//! a Pareto front. A search that keeps several layouts offers every feasible layout to a shortlist: the best
//! layouts that differ clearly from each other. Every checkpoint contains the front or the shortlist. At the
//! end a local search explores the neighbours of the layouts in the front or shortlist. Polish and local
//! search together use a quarter of the budget.
//!
//! A search without Pareto goals ends with a further phase. This phase selects a layout with much room among
//! the layouts with nearly the least objective. The [room](crate::region::estimated_room) is the largest
//! distance by which any one piece may be displaced in every direction. The evaluations of this phase do not
//! count towards the budget. Their number is at most a quarter of the budget.
//!
//! Searches that differ only in their seeds ([`Island`]) can be merged into one result.

mod cma_es;
mod islands;
mod journal;
mod local_search;
mod pareto_front;
mod problem;
mod record;
#[doc(hidden)] // public for tests/maths
pub mod scalarization;
mod search_space;
mod settle;
mod shortlist;
mod solvers;
mod stopping;
mod workspace_pool;

pub use islands::{Island, IslandLayout, best_island, merged};
pub use journal::{Checkpoint, Unfit};
pub use pareto_front::DIFFERENT;
pub use problem::{Keep, Moment, Progress, Watch};
pub use search_space::SearchSpace;
pub use shortlist::REALLY_DIFFERENT;
pub use stopping::{SearchEnd, Stopping};

use crate::cell::{Goals, Layout, SearchSettings};
use crate::layout::{Evaluation, Workcell, evaluate};
use crate::proof;
use journal::SearchJournal;
use problem::Problem;
use record::Record;
use std::sync::atomic::Ordering;

/// Layout with its evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedLayout {
    pub layout: Layout,
    pub evaluation: Evaluation,
}

/// Layout reported in addition to the best layout.
#[derive(Debug, Clone, PartialEq)]
pub struct Alternative {
    pub candidate: EvaluatedLayout,
    /// Value of each goal in the order of [`crate::cell::Goal::ALL`]: m, rad, m^2, s, a share or a cost.
    pub goals: Vec<f64>,
}

/// Result of a search.
#[derive(Debug, Clone)]
pub struct SearchRecord {
    pub start: EvaluatedLayout,
    /// Best feasible layout; if none was found, the layout that comes nearest to being feasible.
    ///
    /// Among the layouts with nearly the least objective, the search chooses a layout whose pieces can be
    /// displaced far in every direction.
    pub best: EvaluatedLayout,
    /// Least objective found (m, rad, a share or a cost). None if no layout is feasible and within every
    /// limit.
    pub least: Option<f64>,
    pub evaluations: u64,
    /// Number of evaluated layouts that were feasible and within every limit.
    pub feasible: u64,
    /// Number of evaluations and objective (m, rad, a share or a cost) at each improvement of the best
    /// feasible layout.
    pub trace: Vec<(u64, f64)>,
    /// Lower bound of the objective (m or rad); None if no bound was given.
    pub bound: Option<f64>,
    pub ended: SearchEnd,
    /// Layouts of the Pareto front or of the shortlist. A front is sorted by the first goal. A shortlist
    /// begins with the best layout.
    ///
    /// The list is empty if neither a front nor a shortlist was requested.
    pub alternatives: Vec<Alternative>,
}

impl SearchRecord {
    /// Returns whether a feasible layout was found. A search may end normally without a feasible layout.
    pub fn found(&self) -> bool {
        self.best.evaluation.objective.is_some()
    }

    /// Returns the relative gap between the objective of the best layout and the lower bound: `objective /
    /// bound - 1`. Returns None if there is no feasible layout or no positive bound.
    pub fn gap(&self) -> Option<f64> {
        let best = self.best.evaluation.objective?;
        self.bound.filter(|b| *b > 0.0).map(|bound| best / bound - 1.0)
    }
}

/// Options of a search: a known bound, a checkpoint to resume from, and a receiver of checkpoints.
pub struct SearchJob<'a> {
    /// Proven lower bound of the objective, m or rad.
    pub bound: Option<f64>,
    /// Checkpoint from which the search continues. [`Checkpoint::check`] must have accepted it.
    pub from: Option<&'a Checkpoint>,
    /// Function that receives the state of the search.
    pub keep: Keep<'a>,
}

/// Searches for the best layout of a cell.
pub fn search(workcell: &Workcell, settings: &SearchSettings, watch: &Watch<'_>) -> SearchRecord {
    search_job(workcell, settings, watch, &SearchJob { bound: None, from: None, keep: &|_, _| () })
}

/// Searches for the best layout of a cell, resuming from a checkpoint if there is one.
///
/// A resumed search gives bit for bit the same result as an uninterrupted search with the same settings.
pub fn search_job(
    workcell: &Workcell,
    settings: &SearchSettings,
    watch: &Watch<'_>,
    job: &SearchJob<'_>,
) -> SearchRecord {
    let space = SearchSpace::new(&workcell.cell);
    let start = candidate(workcell, workcell.cell.start());
    let bound = job.bound;
    if space.dimensions() == 0 {
        let least = start.evaluation.objective.filter(|_| start.evaluation.is_accepted());
        let (best, ended, trace) = (start.clone(), SearchEnd::NothingToSearch, Vec::new());
        let asked = settings.keep > 0 || !settings.pareto.is_empty();
        let all = asked.then(|| alternative(workcell, start.layout.clone())).flatten();
        let alternatives = all.into_iter().collect();
        return SearchRecord {
            start,
            best,
            least,
            evaluations: 1,
            feasible: u64::from(least.is_some()),
            trace,
            bound,
            ended,
            alternatives,
        };
    }
    let stopping = Stopping::new(settings, bound);
    let journal = match job.from {
        Some(checkpoint) => SearchJournal::resumed(checkpoint, stopping),
        None => SearchJournal::new(space.start(), stopping),
    };
    (job.keep)(journal.checkpoint(), Moment::Begun);
    if settings.budget >= proof::LAYOUTS_WORTH_A_FIELD {
        proof::rank_nodes(workcell, watch.stop);
    }
    let problem = Problem::new(workcell, &space, journal, watch, job.keep);
    solvers::explore(&problem, settings, space.start());
    solvers::polish(&problem);
    if problem.begin_local_search() {
        local_search::run(&problem);
    }
    let stopped = problem.interrupted();
    let journal = problem.into_journal();
    if stopped {
        (job.keep)(journal.checkpoint(), Moment::Stopped);
    }
    let mut ended = if stopped { SearchEnd::Interrupted } else { journal.ended() };
    let mut alternatives = alternatives(workcell, &space, &journal.record, settings.keep);
    let mut record = journal.record.clone();
    let mut best = candidate(workcell, space.layout(&record.point));
    // The search rounds coordinates, so the unrounded layout in the file may be better. Layouts to build
    // must have rounded coordinates.
    if workcell.cell.search.ideal && start.evaluation.cost < best.evaluation.cost {
        best = start.clone();
        record.trace.extend(best.evaluation.objective.map(|e| (record.evaluations, e)));
    }
    let least = best.evaluation.objective.filter(|_| best.evaluation.is_accepted());
    if let Some(least) = least.filter(|_| !stopped) {
        // A layout that is chosen for its greater room must still be within the optimality gap that the user
        // requests.
        let gap =
            settings.gap.zip(bound).map(|(gap, bound)| bound * (1.0 + gap)).filter(|most| least <= *most);
        let found = (&space.point(&best.layout)[..], least, gap);
        if let Some(settled) = settle::settled(workcell, &space, settings, watch, found) {
            let at = alternatives.iter().position(|a| a.candidate.layout == best.layout);
            best = candidate(workcell, settled);
            // The best layout must remain in the shortlist.
            if let Some(at) = at {
                alternatives.splice(at..=at, alternative(workcell, best.layout.clone()));
            }
        } else if watch.stop.load(Ordering::Relaxed) {
            // A search that is stopped while it looks for room has not ended.
            (job.keep)(journal.checkpoint(), Moment::Stopped);
            ended = SearchEnd::Interrupted;
        }
    }
    let Record { evaluations, feasible, trace, .. } = record;
    SearchRecord { start, best, least, evaluations, feasible, trace, bound, ended, alternatives }
}

fn candidate(workcell: &Workcell, layout: Layout) -> EvaluatedLayout {
    EvaluatedLayout { evaluation: evaluate(workcell, &layout), layout }
}

fn alternative(workcell: &Workcell, layout: Layout) -> Option<Alternative> {
    let candidate = candidate(workcell, layout);
    let goals = workcell.goals(&candidate.layout, &candidate.evaluation, &Goals::all())?;
    Some(Alternative { candidate, goals })
}

/// Returns the layouts of the Pareto front or of the shortlist in the record. If `keep` is not 0, at most
/// `keep` members of the front are returned.
fn alternatives(
    workcell: &Workcell,
    space: &SearchSpace<'_>,
    record: &Record,
    keep: usize,
) -> Vec<Alternative> {
    let most = if keep > 0 { keep } else { usize::MAX };
    let front = record.front.iter().flat_map(|front| front.spread(most)).map(|member| &member.point);
    let shortlist = record.shortlist.iter().flat_map(|shortlist| shortlist.best());
    let points: Vec<&Vec<f64>> = front.chain(shortlist).collect();
    points.into_iter().filter_map(|point| alternative(workcell, space.layout(point))).collect()
}
