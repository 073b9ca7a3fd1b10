//! The global solvers with their restarts, and the local polish.

use super::cma_es::CmaEs;
use super::problem::Problem;
use super::search_space::NeighbourChange;
use crate::cell::{SearchSettings, Solver};
use argmin::core::{Executor, IterState, PopulationState};
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::{Particle, ParticleSwarm};
use argmin::solver::simulatedannealing::{SATempFunc, SimulatedAnnealing};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Initial step size of CMA-ES from the layout in the cell file, as a share of the search range.
const SIGMA_FROM_FILE: f64 = 0.15;
/// Initial step size of a global run of CMA-ES, as a share of the search range.
const SIGMA: f64 = 0.3;
/// Initial step size of a run of CMA-ES from the best layout so far, as a share of the search range.
const SIGMA_FROM_BEST: f64 = 0.1;
/// Smallest and largest number of successive restarts of CMA-ES that start from the best layout.
const FIRST_FROM_BEST: (usize, usize) = (1, 8);
/// Period of the restarts after these. The last restart of each period starts from the best layout, and the
/// other restarts start from random layouts.
const BEST_PERIOD: u64 = 4;
/// Period of the restarts of CMA-ES from random layouts. The first restart of each period is global, and the
/// other restarts are local (see [`random_restart`]).
const RANDOM_PERIOD: u64 = 3;
/// Number of particles of a swarm.
const PARTICLES: usize = 40;
/// Number of generations of one particle-swarm run, after which the swarm has usually converged.
const GENERATIONS: u64 = 80;
/// Number of evaluations of one annealing run.
const ANNEALING_EVALUATIONS: u64 = 4000;
/// First temperature of simulated annealing, as a cost in m.
const FIRST_TEMPERATURE: f64 = 1e-2;
/// Last temperature of simulated annealing, as a cost in m.
const LAST_TEMPERATURE: f64 = 1e-8;
/// Edge of the first simplex of the polish in the unit cube.
const SIMPLEX_EDGE: f64 = 0.01;
/// The polish has converged when the standard deviation of the costs at the simplex corners is below this
/// value, m.
const POLISH_TOLERANCE: f64 = 1e-10;

type IterationState = IterState<Vec<f64>, (), (), (), (), f64>;
type SwarmState = PopulationState<Particle<Vec<f64>, f64>, f64>;

/// Runs the global solver repeatedly, each time from another point, until the budget of the exploration is
/// used up.
///
/// The first run starts from the layout in the cell file, if the solver accepts a start point.
pub fn explore(problem: &Problem<'_>, settings: &SearchSettings, start: Vec<f64>) {
    loop {
        let run = problem.run();
        if run == 0 {
            // The layout in the file is the first candidate, so that the result is never worse than this
            // layout.
            problem.try_point(&start);
        }
        // Every run has its own random stream, so that one run does not change the random numbers of the next
        // run.
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        rng.set_stream(run);
        let random = |rng: &mut ChaCha8Rng| (0..problem.dimensions()).map(|_| rng.random()).collect();
        // Every other run of a Pareto search starts from the member of the front that is best for the
        // scalarization of this run.
        let known = if run % 2 == 1 { problem.best_for_scalarization() } else { None };
        let from = if run == 0 { start.clone() } else { known.unwrap_or_else(|| random(&mut rng)) };
        // The result of the solver is ignored, because the problem keeps the best layout.
        let _ended = match settings.solver {
            Solver::CmaEs => {
                let CmaEsStart { from, sigma, scale } = cma_es_start(problem, run, from, &mut rng);
                let solver = CmaEs::new(problem.separated(from), sigma, scale, rng);
                let solver = solver.with_tolerances(problem.space().tolerances());
                Executor::<_, _, IterationState>::new(problem, solver).timer(false).run().map(drop)
            }
            Solver::ParticleSwarm => {
                let bounds = (vec![0.0; from.len()], vec![1.0; from.len()]);
                let solver = ParticleSwarm::new(bounds, PARTICLES).with_rng_generator(rng);
                let executor = Executor::<_, _, SwarmState>::new(problem, solver).timer(false);
                executor.configure(|s| s.max_iters(GENERATIONS)).run().map(drop)
            }
            Solver::SimulatedAnnealing => {
                problem.anneal_with(rng.clone());
                let cooling = SATempFunc::Exponential(
                    (LAST_TEMPERATURE / FIRST_TEMPERATURE).powf(1.0 / ANNEALING_EVALUATIONS as f64),
                );
                SimulatedAnnealing::new_with_rng(FIRST_TEMPERATURE, rng).and_then(|solver| {
                    let solver = solver.with_temp_func(cooling);
                    let executor = Executor::<_, _, IterationState>::new(problem, solver).timer(false);
                    executor
                        .configure(|s| s.param(problem.separated(from)).max_iters(ANNEALING_EVALUATIONS))
                        .run()
                        .map(drop)
                })
            }
        };
        if !problem.begin_run() {
            break;
        }
    }
}

/// Start of one run of CMA-ES.
struct CmaEsStart {
    /// First mean, a point of the unit cube.
    from: Vec<f64>,
    /// Initial step size as a share of the search range.
    sigma: f64,
    /// Population as a multiple of the default.
    scale: u32,
}

/// Returns the start of a run of CMA-ES. `from` is the start of the run unless it starts from the best layout.
///
/// Run 0 stays near the layout in the cell file. In a search for one layout, the next runs start from the best
/// feasible layout (iterated local search: H. R. Lourenco, O. C. Martin, T. Stuetzle, in Handbook of
/// Metaheuristics, 2003). If there are listed values, such a run first changes one of them, because a
/// converged run cannot leave the value to which it has converged. Otherwise the run has twice the default
/// population, which finds better minima. When each other listed value has had a run, most later runs start
/// from random layouts, because the best layout may lie elsewhere.
fn cma_es_start(problem: &Problem<'_>, run: u64, from: Vec<f64>, rng: &mut ChaCha8Rng) -> CmaEsStart {
    let Some(again) = run.checked_sub(1) else {
        return CmaEsStart { from, sigma: SIGMA_FROM_FILE, scale: 1 };
    };
    if problem.is_scalarized() {
        // A run of a Pareto search is too short for a large population.
        return CmaEsStart { from, sigma: SIGMA, scale: 1 };
    }
    let Some(best) = problem.single_best() else { return random_restart(again, from, rng) };
    let mut others = problem.space().neighbours(&best, NeighbourChange::List);
    let first = others.len().clamp(FIRST_FROM_BEST.0, FIRST_FROM_BEST.1) as u64;
    let turn = match again.checked_sub(first) {
        None => again,
        Some(later) if later % BEST_PERIOD == BEST_PERIOD - 1 => first + later / BEST_PERIOD,
        Some(later) => return random_restart(later - later / BEST_PERIOD, from, rng),
    };
    match (turn as usize).checked_rem(others.len()) {
        Some(k) => CmaEsStart { from: others.swap_remove(k), sigma: SIGMA_FROM_BEST, scale: 1 },
        None => CmaEsStart { from: best, sigma: SIGMA_FROM_BEST, scale: 2 },
    }
}

/// Returns the start of restart number `again` of CMA-ES from the random point `from`.
///
/// The restart is global or local, as in BIPOP-CMA-ES (N. Hansen, "Benchmarking a BI-population CMA-ES on the
/// BBOB-2009 function testbed", GECCO 2009).
///
/// A global run has a large first step and finds wide minima of the cost. The populations of successive
/// global runs are 1, 2, 4 and 8 times the default, and then the cycle begins again.
///
/// A local run has the default population. The first step is [`SIGMA`] times a random factor from 0.01 to 1.
/// A run with a small first step can explore a small feasible region beside an obstacle.
fn random_restart(again: u64, from: Vec<f64>, rng: &mut ChaCha8Rng) -> CmaEsStart {
    match again % RANDOM_PERIOD {
        0 => CmaEsStart { from, sigma: SIGMA, scale: 1 << (again / RANDOM_PERIOD % 4) },
        _ => CmaEsStart { from, sigma: SIGMA * 10f64.powf(-2.0 * rng.random::<f64>()), scale: 1 },
    }
}

/// Improves the best point so far by the Nelder-Mead method.
pub fn polish(problem: &Problem<'_>) {
    if !problem.begin_polish() {
        return;
    }
    let best = problem.best_point();
    // The edges point inwards, so that no corner is mirrored back onto another corner.
    let corner = |k: usize| {
        let mut corner = best.clone();
        corner[k] += if corner[k].rem_euclid(2.0) < 0.5 { SIMPLEX_EDGE } else { -SIMPLEX_EDGE };
        corner
    };
    let simplex = std::iter::once(best.clone()).chain((0..best.len()).map(corner)).collect();
    let _ended = NelderMead::new(simplex).with_sd_tolerance(POLISH_TOLERANCE).and_then(|solver| {
        let executor = Executor::<_, _, IterationState>::new(problem, solver).timer(false);
        executor.configure(|s| s.max_iters(u64::MAX)).run().map(drop)
    });
}
