//! Last phase of a search: among the layouts with nearly the least objective, the search selects a layout
//! with much room.
//!
//! The room is the largest distance by which any one piece may be displaced in every direction. At the layout
//! with the least objective, a piece often cannot be displaced at all. Layouts whose objective is larger by
//! at most the indifference are equally good to the user. CMA-ES maximizes the room among these layouts
//! ([`estimated_room`]). A pattern search then polls (evaluates) the neighbours of the layout with the most
//! room. A neighbour differs by one step of one coordinate. The result is the layout with the most clearance
//! among the layouts with nearly the most room.
//!
//! The phase is a pure function of cell, settings, best layout and bound, so a resumed search repeats it.

use super::cma_es::CmaEs;
use super::problem::Watch;
use super::search_space::{NeighbourChange, SearchSpace};
use super::workspace_pool::locked;
use crate::cell::{Goal, Goals, Layout, SearchSettings};
use crate::layout::{HeldLayout, HeldMemory, Workcell, Workspace, evaluate, evaluate_in};
use crate::region::{RegionEffort, RoomScale, can_move, estimated_room};
use argmin::core::{CostFunction, Error, Executor, IterState};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::borrow::Borrow;
use std::sync::Mutex;
use std::sync::atomic::Ordering;

type SettleState = IterState<Vec<f64>, (), (), (), (), f64>;

/// Largest number of evaluations of this phase, as a share of the budget of the search.
const SHARE: f64 = 0.25;
/// Runs of CMA-ES: first step as a share of the search range, and population as a multiple of the default.
const RUNS: [(f64, u32); 3] = [(0.01, 2); 3];
/// Largest number of generations of a run.
const GENERATIONS: u64 = 70;
/// First step size of the polls, as a share of the search range. Each later step size is half the previous
/// one.
const POLL: f64 = 1.0 / 256.0;
/// Number of step sizes of the polls. A poll with one step size is repeated while it finds more room.
const POLLS: i32 = 4;
/// Upper limit of an estimated room, m.
const WIDEST: f64 = 0.25;
/// Initial upper limit of an estimated room, m. This limit grows with the largest room found so far, up to
/// [`WIDEST`].
const FIRST_WIDEST: f64 = 0.02;
/// The estimate of a room stops early if the room is below this share of the largest room so far.
const POOR: f64 = 0.3;
/// A layout has nearly the most room if its room is at least this share of the largest room.
const NEARLY: f64 = 0.98;
/// Least cost of a layout whose objective is too large. The room of such a layout does not count.
const BEYOND: f64 = 1.0;
/// Least cost of a layout that is not feasible or misses a limit.
const UNUSABLE: f64 = 1e3;

/// Maximization of the room among layouts with nearly the least objective.
struct RoomProblem<'a> {
    workcell: &'a Workcell,
    space: &'a SearchSpace<'a>,
    watch: &'a Watch<'a>,
    /// Largest objective allowed, m, rad, a share or a cost.
    most: f64,
    state: Mutex<RoomState>,
}

/// Progress of the maximization of the room.
struct RoomState {
    left: u64,
    /// Usable points with their rooms (m), in the order of evaluation.
    rooms: Vec<(f64, Vec<f64>)>,
    /// Largest room so far, m.
    most: f64,
}

/// Returns a layout with nearly the most room among the usable layouts that this phase evaluates. Among
/// several such layouts, the function returns the layout with the most clearance.
///
/// A usable layout is feasible, is within every limit, and has nearly the least objective. Only the layouts
/// with the largest estimated rooms are compared accurately.
///
/// `best` is the point with the least objective, `least`. `bound` is the largest objective within the
/// optimality gap that the user requests: the proven lower bound times (1 + gap). The objective of a usable
/// layout must not exceed a limit. This limit is the smaller of `bound`, if given, and `least` times (1 +
/// indifference). If `bound` is less than `least`, the limit is `least`.
///
/// The result is None if the cell requests an ideal layout, which need only work at its nominal placements.
/// The result is also None if `settings` request a Pareto search, or if the indifference is 0 or less. The
/// result is also None if no piece has a range for x or y. The result is also None if no evaluated layout is
/// usable, or if the observer stops the search.
pub fn settled(
    workcell: &Workcell,
    space: &SearchSpace<'_>,
    settings: &SearchSettings,
    watch: &Watch<'_>,
    (best, least, bound): (&[f64], f64, Option<f64>),
) -> Option<Layout> {
    if workcell.cell.search.ideal
        || settings.indifference <= 0.0
        || !settings.pareto.is_empty()
        || !can_move(&workcell.cell)
    {
        return None;
    }
    let most = bound.unwrap_or(f64::INFINITY).min(least * (1.0 + settings.indifference)).max(least);
    let left = ((settings.budget as f64 * SHARE) as u64).min(RegionEffort::of(workcell).evaluations);
    let state = Mutex::new(RoomState { left, rooms: Vec::new(), most: 0.0 });
    let problem = RoomProblem { workcell, space, watch, most, state };
    problem.costs(&[&best.to_vec()]);
    for (run, (sigma, scale)) in RUNS.into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        rng.set_stream(u64::MAX - run as u64);
        let solver = CmaEs::new(problem.roomiest(best), sigma, scale, rng);
        let executor = Executor::<_, _, SettleState>::new(&problem, solver).timer(false);
        let _ended = executor.configure(|state| state.max_iters(GENERATIONS)).run().map(drop);
    }
    problem.poll(best);
    if watch.stop.load(Ordering::Relaxed) {
        return None;
    }
    problem.clearest()
}

impl RoomProblem<'_> {
    /// Returns the point with the most room so far, or `otherwise` if no point is usable.
    fn roomiest(&self, otherwise: &[f64]) -> Vec<f64> {
        let state = locked(&self.state);
        let most = state.rooms.iter().find(|(room, _)| *room == state.most);
        most.map_or(otherwise.to_vec(), |(_, point)| point.clone())
    }

    /// Polls the neighbours of the point with the most room, with each step size in turn. A poll is repeated
    /// until no neighbour has more room.
    fn poll(&self, otherwise: &[f64]) {
        for halvings in 0..POLLS {
            let step = POLL / f64::from(1 << halvings);
            loop {
                let before = locked(&self.state).most;
                let beside = self.space.neighbours(&self.roomiest(otherwise), NeighbourChange::Range(step));
                self.costs(&beside.iter().collect::<Vec<_>>());
                if locked(&self.state).most <= before {
                    break;
                }
            }
        }
    }

    /// Returns the layout with the most clearance among the layouts with nearly the most room; None if no
    /// point is usable.
    fn clearest(&self) -> Option<Layout> {
        let mut roomy = locked(&self.state).rooms.clone();
        roomy.sort_by(|a, b| b.0.total_cmp(&a.0));
        roomy.dedup_by(|a, b| self.space.layout(&a.1) == self.space.layout(&b.1));
        roomy.truncate(RegionEffort::of(self.workcell).compared);
        let accurate = |(_, point): &(f64, Vec<f64>)| {
            let scale = RoomScale { poor: 0.0, widest: WIDEST, is_rough: false };
            let room = self.room(point, &scale, &mut Default::default()).unwrap_or(0.0);
            (room, self.space.layout(point))
        };
        let rooms: Vec<(f64, Layout)> = roomy.par_iter().map(accurate).collect();
        let most = rooms.iter().map(|(room, _)| *room).fold(0.0, f64::max);
        let nearly = rooms.into_par_iter().filter(|(room, _)| *room >= NEARLY * most);
        let clearance = |(_, layout): (f64, Layout)| {
            let goals = Goals::of(&[Goal::Clearance]).unwrap_or_default();
            let values = self.workcell.goals(&layout, &evaluate(self.workcell, &layout), &goals);
            (values.and_then(|values| values.first().copied()).unwrap_or(0.0), layout)
        };
        let all: Vec<(f64, Layout)> = nearly.map(clearance).collect();
        let best = all.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best });
        best.map(|(_, layout)| layout)
    }

    /// Returns the costs of several points, and stores the usable points with their rooms.
    fn costs(&self, points: &[&Vec<f64>]) -> Vec<f64> {
        let mut state = locked(&self.state);
        if state.left < points.len() as u64 || self.watch.stop.load(Ordering::Relaxed) {
            state.left = 0;
            return vec![f64::NEG_INFINITY; points.len()];
        }
        state.left -= points.len() as u64;
        let scale = RoomScale {
            poor: POOR * state.most,
            widest: (3.0 * state.most).clamp(FIRST_WIDEST, WIDEST),
            is_rough: true,
        };
        let judge =
            |memory: &mut (Workspace, HeldMemory), point: &&Vec<f64>| self.room(point, &scale, memory);
        let rooms: Vec<Result<f64, f64>> = points.par_iter().map_init(Default::default, judge).collect();
        for (room, point) in rooms.iter().zip(points) {
            if let Ok(room) = room {
                state.most = state.most.max(*room);
                state.rooms.push((*room, (*point).clone()));
            }
        }
        rooms.into_iter().map(|room| room.map_or_else(|cost| cost, |room| -room)).collect()
    }

    /// Returns the room of a point, m.
    ///
    /// # Errors
    /// Returns a cost if the layout cannot be used, or if its objective is too large.
    fn room(
        &self,
        point: &[f64],
        scale: &RoomScale,
        (workspace, memory): &mut (Workspace, HeldMemory),
    ) -> Result<f64, f64> {
        let layout = self.space.layout(point);
        let evaluation = evaluate_in(self.workcell, &layout, workspace);
        let cost = evaluation.cost / self.workcell.weight();
        match evaluation.objective.filter(|_| evaluation.is_accepted()) {
            None => Err(UNUSABLE + cost),
            Some(objective) if objective > self.most => Err(BEYOND + cost),
            Some(_) => HeldLayout::holding(self.workcell, &layout, &evaluation)
                .map(|held| estimated_room(&held, scale, memory))
                .ok_or(UNUSABLE),
        }
    }
}

impl CostFunction for &RoomProblem<'_> {
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
