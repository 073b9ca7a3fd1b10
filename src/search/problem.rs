//! The optimization problem as argmin sees it, and what was best so far.

use super::aim::Aim;
use super::ledger::{Checkpoint, Ledger, Phase};
use super::record::{Answer, Record};
use super::space::Space;
use super::stopping::{Ended, Stopping};
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

/// Decimals of a loss (m, rad, m2 or shares) that count: what lies below is rounding, and a layout that is
/// better by that alone is not.
const LOSS_DIGITS: i32 = 9;

/// How far a search is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    pub evaluations: u64,
    pub budget: u64,
    /// How many of the evaluated layouts were feasible.
    pub feasible: u64,
    /// Objective of the best feasible layout, m.
    pub best: Option<f64>,
}

/// Who follows a search from outside: told now and then, and able to stop it.
pub struct Watch<'a> {
    pub progress: &'a (dyn Fn(Progress) + Sync),
    pub stop: &'a AtomicBool,
}

/// When the state of a search is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moment {
    /// Before the first evaluation.
    Begun,
    /// After every question of a solver.
    Going,
    /// At the end of a search that was told to stop.
    Stopped,
}

/// Told the state of the search, so that it can be kept.
pub type Keep<'a> = &'a (dyn Fn(&Checkpoint, Moment) + Sync);

/// Cost of a point of the unit cube, with a budget. When that is used up every further point costs
/// minus infinity: the best there can be, at which every argmin solver stops. (An error would, too,
/// but argmin's Nelder-Mead panics at one.) The record keeps what was found.
pub struct Problem<'a> {
    workcell: &'a Workcell,
    space: &'a Space<'a>,
    watch: &'a Watch<'a>,
    keep: Keep<'a>,
    budget: u64,
    goals: Goals,
    ledger: Mutex<Ledger>,
    /// What the run under way makes small; None: the error.
    aim: Mutex<Option<Aim>>,
    /// Memory of the threads, kept from call to call.
    workspaces: Mutex<Vec<Workspace>>,
    /// Random stream of [`Anneal`], which argmin calls without one.
    annealing: Mutex<ChaCha8Rng>,
}

impl<'a> Problem<'a> {
    pub fn new(
        workcell: &'a Workcell,
        space: &'a Space<'a>,
        ledger: Ledger,
        watch: &'a Watch<'a>,
        keep: Keep<'a>,
    ) -> Self {
        let Stopping { budget, pareto: goals, .. } = *ledger.checkpoint().stopping();
        let aim = Mutex::new(ledger.aim());
        let annealing = Mutex::new(ChaCha8Rng::seed_from_u64(0));
        let (ledger, workspaces) = (Mutex::new(ledger), Mutex::default());
        Self { workcell, space, watch, keep, budget, goals, ledger, aim, workspaces, annealing }
    }

    /// Sets the random stream of simulated annealing.
    pub fn anneal_with(&self, rng: ChaCha8Rng) {
        *locked(&self.annealing) = rng;
    }

    /// Evaluations still allowed in the run under way.
    pub fn left(&self) -> u64 {
        self.left_of(&locked(&self.ledger))
    }

    fn left_of(&self, ledger: &Ledger) -> u64 {
        // What is in the journal costs nothing, and without it the record would fall back.
        let stopped = self.interrupted() && !ledger.knows();
        let left = ledger.until.saturating_sub(ledger.record.evaluations);
        if stopped || ledger.met().is_some() { 0 } else { left }
    }

    pub fn interrupted(&self) -> bool {
        self.watch.stop.load(Ordering::Relaxed)
    }

    pub fn run(&self) -> u64 {
        locked(&self.ledger).run()
    }

    /// Begins the next run; says whether there is one.
    pub fn begin_run(&self) -> bool {
        let mut ledger = locked(&self.ledger);
        let over = ledger.record.evaluations >= ledger.checkpoint().stopping().exploration();
        let goes_on = !self.interrupted() && !over && ledger.met().is_none();
        if goes_on {
            ledger.begin_run();
            *locked(&self.aim) = ledger.aim();
        }
        goes_on
    }

    /// Begins the polish; says whether there is one.
    pub fn begin_polish(&self) -> bool {
        let mut ledger = locked(&self.ledger);
        let goes_on = !matches!(ledger.met(), Some(Ended::Gap | Ended::Diverged));
        if goes_on {
            ledger.begin_polish();
            *locked(&self.aim) = None;
        }
        goes_on
    }

    /// Begins to ask round the layouts that are kept besides the best; says whether there are any.
    pub fn begin_poll(&self) -> bool {
        let mut ledger = locked(&self.ledger);
        let goes_on = ledger.phase == Phase::Polish && ledger.checkpoint().stopping().keeps_more();
        if goes_on {
            ledger.begin_poll();
        }
        goes_on
    }

    /// The points of the layouts that are kept besides the best.
    pub fn kept_points(&self) -> Vec<Vec<f64>> {
        let ledger = locked(&self.ledger);
        let front = ledger.record.front.iter().flat_map(|front| front.members()).map(|m| &m.point);
        let shortlist = ledger.record.shortlist.iter().flat_map(|shortlist| shortlist.best());
        front.chain(shortlist).cloned().collect()
    }

    pub fn space(&self) -> &Space<'a> {
        self.space
    }

    pub fn dimensions(&self) -> usize {
        self.space.dimensions()
    }

    /// Evaluates one point for the record.
    pub fn try_point(&self, point: &Vec<f64>) {
        self.costs(&[point]);
    }

    pub fn try_points(&self, points: &[Vec<f64>]) {
        self.costs(&points.iter().collect::<Vec<_>>());
    }

    /// The nearest point without overlaps, or the point itself if none is found.
    pub fn separated(&self, point: Vec<f64>) -> Vec<f64> {
        match separated(self.workcell, &self.space.layout(&point)) {
            Some(layout) => self.space.point(&layout),
            None => point,
        }
    }

    pub fn best_point(&self) -> Vec<f64> {
        locked(&self.ledger).record.point.clone()
    }

    /// Whether the run under way makes something else small than the error.
    pub fn aims(&self) -> bool {
        locked(&self.aim).is_some()
    }

    /// The member of the front that is best for the aim of the run under way, as the run began.
    pub fn best_for_aim(&self) -> Option<Vec<f64>> {
        let (ledger, aim) = (locked(&self.ledger), locked(&self.aim));
        let (front, aim) = (ledger.checkpoint().front()?, aim.as_ref()?);
        let costs = front.members().iter().map(|m| (aim.cost(&m.losses), m));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, m)| m.point.clone())
    }

    pub fn into_ledger(self) -> Ledger {
        self.ledger.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Costs of several points, in their order, and the record brought up to date in that order.
    fn costs(&self, points: &[&Vec<f64>]) -> Vec<f64> {
        // Solvers ask one question at a time, so nobody waits for this lock.
        let mut ledger = locked(&self.ledger);
        let count = self.left_of(&ledger).min(points.len() as u64) as usize;
        if count == 0 {
            return vec![f64::NEG_INFINITY; points.len()];
        }
        let mut answers = ledger.recall(count);
        answers.extend(self.evaluated(&points[answers.len()..count]));
        ledger.note(self.space, points.iter().copied(), &answers);
        let Record { evaluations, feasible, .. } = ledger.record;
        let best = ledger.record.best();
        (self.watch.progress)(Progress { evaluations, budget: self.budget, feasible, best });
        (self.keep)(ledger.checkpoint(), Moment::Going);
        // Solvers see the cost of unit weights: their tolerances are lengths.
        let weight = self.workcell.weight();
        let aim = locked(&self.aim);
        let cost = |a: &Answer| match &*aim {
            Some(aim) if !a.losses.is_empty() => aim.cost(&a.losses),
            _ => a.cost / weight,
        };
        let mut costs: Vec<f64> = answers.iter().map(cost).collect();
        costs.resize(points.len(), f64::NEG_INFINITY);
        costs
    }

    /// Evaluates points, on as many threads as there are.
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

/// Memory of a thread while it evaluates.
struct Lease<'a> {
    free: &'a Mutex<Vec<Workspace>>,
    workspace: Workspace,
}

impl<'a> Lease<'a> {
    fn new(free: &'a Mutex<Vec<Workspace>>) -> Self {
        let workspace = locked(free).pop().unwrap_or_default();
        Self { free, workspace }
    }
}

impl Drop for Lease<'_> {
    fn drop(&mut self) {
        locked(self.free).push(std::mem::take(&mut self.workspace));
    }
}

/// A thread that panicked while it held the lock cannot have left half a record: take it.
fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
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

    /// Moves about a third of the coordinates, all of them at times, by steps of many sizes.
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
