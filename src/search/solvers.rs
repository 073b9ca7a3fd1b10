//! The solvers with their restarts, and the local polish.

use super::cma_es::CmaEs;
use super::problem::Problem;
use crate::cell::{SearchSettings, Solver};
use argmin::core::{Executor, IterState, PopulationState};
use argmin::solver::neldermead::NelderMead;
use argmin::solver::particleswarm::{Particle, ParticleSwarm};
use argmin::solver::simulatedannealing::{SATempFunc, SimulatedAnnealing};
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// First steps of CMA-ES, in units of the search range: from the layout as drawn, and from anywhere.
const SIGMA_DRAWN: f64 = 0.15;
const SIGMA: f64 = 0.3;
/// Of so many restarts one is global; the others, which are shorter, are local.
const LOCAL: u64 = 3;
/// Particles of a swarm, and the generations after which it has settled.
const PARTICLES: usize = 40;
const GENERATIONS: u64 = 80;
/// Evaluations of one annealing, and the temperatures (m of error) at its ends.
const ANNEALING: u64 = 4000;
const HOT: f64 = 1e-2;
const COLD: f64 = 1e-8;
/// Edge of the first simplex of the polish in the unit cube, and the spread of costs (m) at which
/// it has nothing left to gain.
const SIMPLEX: f64 = 0.01;
const SETTLED: f64 = 1e-10;

type Point = IterState<Vec<f64>, (), (), (), (), f64>;
type Swarm = PopulationState<Particle<Vec<f64>, f64>, f64>;

/// Runs the global solver, again and again from other points, until the budget allowed is used up.
/// The first run starts from the layout as drawn, where the solver has a start.
pub fn explore(problem: &Problem<'_>, settings: &SearchSettings, start: Vec<f64>) {
    loop {
        let run = problem.run();
        if run == 0 {
            // The layout as drawn is the first candidate, so that no answer is worse.
            problem.try_point(&start);
        }
        // A random stream for every run: what one run draws does not shift the next.
        let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
        rng.set_stream(run);
        let random = |rng: &mut ChaCha8Rng| (0..problem.dimensions()).map(|_| rng.random()).collect();
        // Every other run for a front goes on from what is best for its aim so far.
        let known = if run % 2 == 1 { problem.best_for_aim() } else { None };
        let from = if run == 0 { start.clone() } else { known.unwrap_or_else(|| random(&mut rng)) };
        let from = problem.separated(from);
        // However a solver ends, the problem has kept the best.
        let _ended = match settings.solver {
            Solver::CmaEs => {
                // A run for a front is too short for a large population.
                let number = if problem.aims() { run.min(1) } else { run };
                let (sigma, scale) = restart(number, &mut rng);
                let solver = CmaEs::new(from, sigma, scale, rng);
                Executor::<_, _, Point>::new(problem, solver).timer(false).run().map(drop)
            }
            Solver::ParticleSwarm => {
                let bounds = (vec![0.0; from.len()], vec![1.0; from.len()]);
                let solver = ParticleSwarm::new(bounds, PARTICLES).with_rng_generator(rng);
                let executor = Executor::<_, _, Swarm>::new(problem, solver).timer(false);
                executor.configure(|s| s.max_iters(GENERATIONS)).run().map(drop)
            }
            Solver::SimulatedAnnealing => {
                problem.anneal_with(rng.clone());
                let cooling = SATempFunc::Exponential((COLD / HOT).powf(1.0 / ANNEALING as f64));
                SimulatedAnnealing::new_with_rng(HOT, rng).and_then(|solver| {
                    let solver = solver.with_temp_func(cooling);
                    let executor = Executor::<_, _, Point>::new(problem, solver).timer(false);
                    executor.configure(|s| s.param(from).max_iters(ANNEALING)).run().map(drop)
                })
            }
        };
        if !problem.begin_run() {
            break;
        }
    }
}

/// First step and population (in default ones) of a run of CMA-ES. Near the layout as drawn to begin
/// with, for somebody has thought about it; then anywhere in two ways, as in BIPOP-CMA-ES (N. Hansen,
/// "Benchmarking a BI-population CMA-ES on the BBOB-2009 function testbed", GECCO 2009). Long steps and a
/// population that doubles up to eight times see the large valleys; a short first step stays on its own
/// side of what is in the way, where a small island of feasible layouts can be the best.
fn restart(run: u64, rng: &mut ChaCha8Rng) -> (f64, u32) {
    match run.checked_sub(1) {
        None => (SIGMA_DRAWN, 1),
        Some(again) if again % LOCAL == 0 => (SIGMA, 1 << (again / LOCAL % 4)),
        Some(_) => (SIGMA * 10f64.powf(-2.0 * rng.random::<f64>()), 1),
    }
}

/// Nelder-Mead from the best point so far.
pub fn polish(problem: &Problem<'_>) {
    if !problem.begin_polish() {
        return;
    }
    let best = problem.best_point();
    // Edges point inwards, so that no corner is folded back onto another.
    let corner = |k: usize| {
        let mut corner = best.clone();
        corner[k] += if corner[k].rem_euclid(2.0) < 0.5 { SIMPLEX } else { -SIMPLEX };
        corner
    };
    let simplex = std::iter::once(best.clone()).chain((0..best.len()).map(corner)).collect();
    let _ended = NelderMead::new(simplex).with_sd_tolerance(SETTLED).and_then(|solver| {
        let executor = Executor::<_, _, Point>::new(problem, solver).timer(false);
        executor.configure(|s| s.max_iters(u64::MAX)).run().map(drop)
    });
}
