//! The optimization problem for argmin, with the record of the best layouts.

use super::journal::{Checkpoint, Phase, SearchJournal};
use super::record::{Answer, Record};
use super::scalarization::Scalarization;
use super::search_space::SearchSpace;
use super::stopping::{SearchEnd, Stopping};
use super::workspace_pool::{Lease, locked};
use crate::cell::Goals;
use crate::layout::{Workcell, Workspace, evaluate_in, separated};
use crate::units::rounded;
use argmin::core::{CostFunction, Error};
use argmin::solver::simulatedannealing::Anneal;
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::borrow::Borrow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of decimals to which a loss (m, rad, m2 or share) is rounded. Smaller differences are rounding
/// errors.
pub const LOSS_DIGITS: i32 = 9;

/// Progress of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    pub evaluations: u64,
    pub budget: u64,
    /// Number of evaluated layouts that were feasible and within every limit.
    pub feasible: u64,
    /// Objective of the best feasible layout, m, rad, a share or a cost.
    pub best: Option<f64>,
}

/// Observer of a search: receives progress and can stop it.
pub struct Watch<'a> {
    pub progress: &'a (dyn Fn(Progress) + Sync),
    pub stop: &'a AtomicBool,
}

/// Moment of a search at which the state of the search is reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// The search has not yet evaluated a layout.
    Begun,
    /// The search has finished a batch of evaluations.
    Going,
    /// The search has ended early, because the observer stopped it.
    Stopped,
}

/// Function that receives the checkpoints of a search.
pub type Keep<'a> = &'a (dyn Fn(&Checkpoint, Moment) + Sync);

/// Cost function on the unit cube, with a budget of evaluations.
///
/// Once the budget is used up, every point costs minus infinity, which stops every argmin solver. The
/// function does not return an error instead, because the Nelder-Mead solver of argmin panics on an error.
/// The record keeps the best layouts.
pub struct Problem<'a> {
    workcell: &'a Workcell,
    space: &'a SearchSpace<'a>,
    watch: &'a Watch<'a>,
    keep: Keep<'a>,
    budget: u64,
    goals: Goals,
    journal: Mutex<SearchJournal>,
    /// Scalarization that the current run minimizes; None if the current phase minimizes the cost of the
    /// layout.
    scalarization: Mutex<Option<Scalarization>>,
    /// Working memory of the threads, reused between calls.
    workspaces: Mutex<Vec<Workspace>>,
    /// Random number generator for [`Anneal`], because argmin passes none to it.
    annealing: Mutex<ChaCha8Rng>,
}

impl<'a> Problem<'a> {
    /// Prepares the problem of a cell.
    pub fn new(
        workcell: &'a Workcell,
        space: &'a SearchSpace<'a>,
        journal: SearchJournal,
        watch: &'a Watch<'a>,
        keep: Keep<'a>,
    ) -> Self {
        let Stopping { budget, pareto: goals, .. } = *journal.checkpoint().stopping();
        let scalarization = Mutex::new(journal.scalarization());
        let annealing = Mutex::new(ChaCha8Rng::seed_from_u64(0));
        let (journal, workspaces) = (Mutex::new(journal), Mutex::default());
        Self { workcell, space, watch, keep, budget, goals, journal, scalarization, workspaces, annealing }
    }

    /// Sets the random number generator of simulated annealing.
    pub fn anneal_with(&self, rng: ChaCha8Rng) {
        *locked(&self.annealing) = rng;
    }

    /// Returns the number of evaluations still allowed in the current run.
    pub fn left(&self) -> u64 {
        self.left_of(&locked(&self.journal))
    }

    fn left_of(&self, journal: &SearchJournal) -> u64 {
        // Results in the journal cost nothing. Even an interrupted search uses all of these results, so that
        // its record is complete.
        let stopped = self.interrupted() && !journal.knows();
        let left = journal.until.saturating_sub(journal.record.evaluations);
        if stopped || journal.met().is_some() { 0 } else { left }
    }

    /// Returns whether the observer has stopped the search.
    pub fn interrupted(&self) -> bool {
        self.watch.stop.load(Ordering::Relaxed)
    }

    /// Returns the number of the current run.
    pub fn run(&self) -> u64 {
        locked(&self.journal).run()
    }

    /// Begins the next run if a further run is allowed; returns whether the run began.
    pub fn begin_run(&self) -> bool {
        let mut journal = locked(&self.journal);
        let over = journal.record.evaluations >= journal.checkpoint().stopping().exploration();
        let goes_on = !self.interrupted() && !over && journal.met().is_none();
        if goes_on {
            journal.begin_run();
            *locked(&self.scalarization) = journal.scalarization();
        }
        goes_on
    }

    /// Begins the polish if the stopping rules allow it; returns whether the polish began.
    pub fn begin_polish(&self) -> bool {
        let mut journal = locked(&self.journal);
        let goes_on = !matches!(journal.met(), Some(SearchEnd::Gap | SearchEnd::Diverged));
        if goes_on {
            journal.begin_polish();
            *locked(&self.scalarization) = None;
        }
        goes_on
    }

    /// Begins the local search around the kept layouts if the search keeps several layouts; returns whether
    /// the local search began.
    pub fn begin_local_search(&self) -> bool {
        let mut journal = locked(&self.journal);
        let goes_on = journal.phase == Phase::Polish && journal.checkpoint().stopping().keeps_more();
        if goes_on {
            journal.begin_local_search();
        }
        goes_on
    }

    /// Returns the points of the layouts that the front or the shortlist keeps.
    pub fn kept_points(&self) -> Vec<Vec<f64>> {
        let journal = locked(&self.journal);
        let front = journal.record.front.iter().flat_map(|front| front.members()).map(|m| &m.point);
        let shortlist = journal.record.shortlist.iter().flat_map(|shortlist| shortlist.best());
        front.chain(shortlist).cloned().collect()
    }

    /// Returns the search space.
    pub fn space(&self) -> &SearchSpace<'a> {
        self.space
    }

    /// Returns the number of variables.
    pub fn dimensions(&self) -> usize {
        self.space.dimensions()
    }

    /// Evaluates one point and adds the result to the record.
    pub fn try_point(&self, point: &Vec<f64>) {
        self.costs(&[point]);
    }

    /// Evaluates several points and adds the results to the record.
    pub fn try_points(&self, points: &[Vec<f64>]) {
        self.costs(&points.iter().collect::<Vec<_>>());
    }

    /// Returns the point of a nearby layout without overlapping floor spaces, or `point` if no such layout is
    /// found.
    pub fn separated(&self, point: Vec<f64>) -> Vec<f64> {
        match separated(self.workcell, &self.space.layout(&point)) {
            Some(layout) => self.space.point(&layout),
            None => point,
        }
    }

    /// Returns the point with the least cost so far.
    pub fn best_point(&self) -> Vec<f64> {
        locked(&self.journal).record.point.clone()
    }

    /// Returns the standard point of the best layout so far, if this layout is feasible and within every
    /// limit. Returns None also if the search keeps several layouts, which should differ from the best.
    pub fn single_best(&self) -> Option<Vec<f64>> {
        let journal = locked(&self.journal);
        let is_single = journal.record.feasible > 0 && !journal.checkpoint().stopping().keeps_more();
        is_single.then(|| self.space.settled(&journal.record.point))
    }

    /// Returns whether the current run minimizes a scalarization instead of the cost of the layout.
    pub fn is_scalarized(&self) -> bool {
        locked(&self.scalarization).is_some()
    }

    /// Returns the point of the front that has the least cost for the scalarization of the current run.
    ///
    /// The candidates are the members of the front at the start of the run. Returns None if there are none,
    /// or if the current run minimizes no scalarization.
    pub fn best_for_scalarization(&self) -> Option<Vec<f64>> {
        let (journal, scalarization) = (locked(&self.journal), locked(&self.scalarization));
        let (front, scalarization) = (journal.checkpoint().front()?, scalarization.as_ref()?);
        let costs = front.members().iter().map(|m| (scalarization.cost(&m.losses), m));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, m)| m.point.clone())
    }

    /// Ends the problem and returns its journal.
    pub fn into_journal(self) -> SearchJournal {
        self.journal.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Returns the costs of several points, and adds the results to the record in the order of the points.
    fn costs(&self, points: &[&Vec<f64>]) -> Vec<f64> {
        // Solvers request one batch of costs at a time, so no thread waits for this lock.
        let mut journal = locked(&self.journal);
        let count = self.left_of(&journal).min(points.len() as u64) as usize;
        if count == 0 {
            return vec![f64::NEG_INFINITY; points.len()];
        }
        let mut answers = journal.recall(count);
        answers.extend(self.evaluated(&points[answers.len()..count]));
        journal.note(self.space, points.iter().copied(), &answers);
        let Record { evaluations, feasible, .. } = journal.record;
        let best = journal.record.best();
        (self.watch.progress)(Progress { evaluations, budget: self.budget, feasible, best });
        (self.keep)(journal.checkpoint(), Moment::Going);
        // Solvers receive the cost divided by the weight of the objective, because their tolerances are
        // lengths.
        let weight = self.workcell.weight();
        let scalarization = locked(&self.scalarization);
        let cost = |a: &Answer| match &*scalarization {
            Some(scalarization) if !a.losses.is_empty() => scalarization.cost(&a.losses),
            _ => a.cost / weight,
        };
        let mut costs: Vec<f64> = answers.iter().map(cost).collect();
        costs.resize(points.len(), f64::NEG_INFINITY);
        costs
    }

    /// Evaluates points in parallel.
    fn evaluated(&self, points: &[&Vec<f64>]) -> Vec<Answer> {
        let evaluate = |lease: &mut Lease<'_>, point: &&Vec<f64>| {
            let layout = self.space.layout(point);
            let e = evaluate_in(self.workcell, &layout, &mut lease.workspace);
            let goals = Some(&self.goals).filter(|goals| !goals.is_empty());
            let values = goals.and_then(|goals| self.workcell.goals(&layout, &e, goals));
            let losses = self.goals.iter().zip(values.unwrap_or_default());
            let losses = losses.map(|(g, v)| rounded(g.loss(v), LOSS_DIGITS)).collect();
            Answer { cost: e.cost, feasible: e.is_accepted(), losses }
        };
        let lease = || Lease::new(&self.workspaces);
        match points {
            [one] => vec![evaluate(&mut lease(), one)],
            many => many.par_iter().with_min_len(2).map_init(lease, evaluate).collect(),
        }
    }
}

impl CostFunction for &Problem<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, Error> {
        Ok(self.costs(&[point])[0])
    }

    fn bulk_cost<P>(&self, points: &[P]) -> Result<Vec<f64>, Error>
    where
        P: Borrow<Vec<f64>> + argmin::core::SyncAlias,
        f64: argmin::core::SendAlias,
        Self: argmin::core::SyncAlias,
    {
        let points: Vec<&Vec<f64>> = points.iter().map(|p| p.borrow()).collect();
        Ok(self.costs(&points))
    }
}

impl Anneal for &Problem<'_> {
    type Param = Vec<f64>;
    type Output = Vec<f64>;
    type Float = f64;

    /// Returns a random neighbour of a point: randomly selected coordinates are changed by random steps.
    ///
    /// The largest possible step is also random, and is drawn once per call.
    fn anneal(&self, point: &Vec<f64>, _temperature: f64) -> Result<Vec<f64>, Error> {
        let mut rng = locked(&self.annealing);
        let size = 0.5 * 10f64.powf(-4.0 * rng.random::<f64>());
        let share = 0.2 + 0.8 * rng.random::<f64>().powi(2);
        let mut moved: Vec<f64> = point.clone();
        for u in &mut moved {
            if rng.random::<f64>() < share {
                *u = (*u + size * (2.0 * rng.random::<f64>() - 1.0)).clamp(0.0, 1.0);
            }
        }
        Ok(moved)
    }
}
