//! The optimization problem as argmin sees it, and what was best so far.

use super::space::Space;
use crate::cell::Layout;
use crate::layout::{Workcell, Workspace, evaluate_in, separated};
use argmin::core::{CostFunction, Error};
use argmin::solver::simulatedannealing::Anneal;
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::borrow::Borrow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// How far a search is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    pub evaluations: u64,
    pub budget: u64,
    /// Objective of the best feasible layout, m.
    pub best: Option<f64>,
}

/// Who follows a search from outside: told now and then, and able to stop it.
pub struct Watch<'a> {
    pub progress: &'a (dyn Fn(Progress) + Sync),
    pub stop: &'a AtomicBool,
}

/// What the problem remembers.
#[derive(Debug, Clone, Default)]
pub struct Record {
    pub evaluations: u64,
    pub feasible: u64,
    /// The point with the least cost.
    pub point: Vec<f64>,
    pub trace: Vec<(u64, f64)>,
    cost: Option<f64>,
}

/// Cost of a point of the unit cube, with a budget. When that is used up every further point costs
/// minus infinity: the best there can be, at which every argmin solver stops. (An error would, too,
/// but argmin's Nelder-Mead panics at one.) The record keeps what was found.
pub struct Problem<'a> {
    workcell: &'a Workcell,
    space: &'a Space<'a>,
    watch: &'a Watch<'a>,
    budget: u64,
    allowed: u64,
    record: Mutex<Record>,
    /// Random stream of [`Anneal`], which argmin calls without one.
    annealing: Mutex<ChaCha8Rng>,
}

impl<'a> Problem<'a> {
    pub fn new(workcell: &'a Workcell, space: &'a Space<'a>, budget: u64, watch: &'a Watch<'a>) -> Self {
        let record = Mutex::new(Record { point: space.start(), ..Record::default() });
        let annealing = Mutex::new(ChaCha8Rng::seed_from_u64(0));
        Self { workcell, space, watch, budget, allowed: budget, record, annealing }
    }

    /// Sets up to how many evaluations may be made in all.
    pub fn allow(&mut self, evaluations: u64) {
        self.allowed = evaluations;
    }

    /// Sets the random stream of simulated annealing.
    pub fn anneal_with(&self, rng: ChaCha8Rng) {
        *locked(&self.annealing) = rng;
    }

    pub fn interrupted(&self) -> bool {
        self.watch.stop.load(Ordering::Relaxed)
    }

    /// Evaluations still allowed.
    pub fn left(&self) -> u64 {
        if self.interrupted() { 0 } else { self.allowed.saturating_sub(locked(&self.record).evaluations) }
    }

    pub fn dimensions(&self) -> usize {
        self.space.dimensions()
    }

    /// Evaluates one point for the record.
    pub fn try_point(&self, point: &Vec<f64>) {
        self.costs(&[point]);
    }

    /// The nearest point without overlaps, or the point itself if none is found.
    pub fn separated(&self, point: Vec<f64>) -> Vec<f64> {
        match separated(self.workcell, &self.space.layout(&point)) {
            Some(layout) => self.space.point(&layout),
            None => point,
        }
    }

    pub fn best_point(&self) -> Vec<f64> {
        locked(&self.record).point.clone()
    }

    pub fn into_record(self) -> Record {
        self.record.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Costs of several points, in their order, and the record brought up to date in that order.
    fn costs(&self, points: &[&Vec<f64>]) -> Vec<f64> {
        let count = self.left().min(points.len() as u64) as usize;
        if count == 0 {
            return vec![f64::NEG_INFINITY; points.len()];
        }
        let layouts: Vec<Layout> = points[..count].iter().map(|p| self.space.layout(p)).collect();
        let evaluate = |workspace: &mut Workspace, layout: &Layout| {
            let e = evaluate_in(self.workcell, layout, workspace);
            (e.cost, e.objective.is_some())
        };
        let values: Vec<(f64, bool)> = match &layouts[..] {
            [one] => vec![evaluate(&mut Workspace::default(), one)],
            many => many.par_iter().with_min_len(2).map_init(Workspace::default, evaluate).collect(),
        };
        let mut record = locked(&self.record);
        for (point, (cost, feasible)) in points.iter().zip(&values) {
            record.note(point, *cost, *feasible);
        }
        let best = record.trace.last().map(|t| t.1);
        (self.watch.progress)(Progress { evaluations: record.evaluations, budget: self.budget, best });
        // Solvers see the cost of unit weights: their tolerances are lengths.
        let weight = self.workcell.weight();
        let mut costs: Vec<f64> = values.into_iter().map(|v| v.0 / weight).collect();
        costs.resize(points.len(), f64::NEG_INFINITY);
        costs
    }
}

impl Record {
    fn note(&mut self, point: &[f64], cost: f64, feasible: bool) {
        self.evaluations += 1;
        self.feasible += u64::from(feasible);
        if self.cost.is_none_or(|best| cost < best) {
            self.cost = Some(cost);
            self.point = point.to_vec();
            if feasible {
                self.trace.push((self.evaluations, cost));
            }
        }
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
