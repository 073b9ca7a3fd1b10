//! A search from the layout on the page, in a thread of its own.

use super::locked;
use crate::cell::{Cell, Layout};
use crate::cli::cache;
use crate::layout::{Workcell, evaluate};
use crate::search;
use crate::search::{Ended, Progress, Watch};
use crate::units::percent_from_share;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

/// How far a search is, and what it has found.
struct Board {
    progress: Progress,
    /// Objective of the layout it started from, mm, degrees or a share.
    start: Option<f64>,
    found: Option<Result<Found, String>>,
    seconds: f64,
}

#[derive(Clone)]
pub struct Found {
    /// None if the best layout is not feasible.
    pub layout: Option<Layout>,
    objective: Option<f64>,
    ended: Ended,
}

/// A search under way or ended.
pub struct Job {
    board: Arc<Mutex<Board>>,
    stop: Arc<AtomicBool>,
    thread: JoinHandle<()>,
    cell: Cell,
    clock: Instant,
}

impl Job {
    /// # Errors
    /// That no thread could be started.
    pub fn start(cell: Cell) -> Result<Self, String> {
        let progress = Progress { evaluations: 0, budget: cell.search.budget, feasible: 0, best: None };
        let board = Arc::new(Mutex::new(Board { progress, start: None, found: None, seconds: 0.0 }));
        let stop = Arc::new(AtomicBool::new(false));
        let (clock, asked) = (Instant::now(), (cell.clone(), board.clone(), stop.clone()));
        let run = move || {
            let (cell, board, stop) = asked;
            let found = run(cell, &board, &stop);
            let mut board = locked(&board);
            (board.found, board.seconds) = (Some(found), clock.elapsed().as_secs_f64());
        };
        let thread = std::thread::Builder::new().name("search".into()).spawn(run);
        let thread = thread.map_err(|e| format!("cannot start a thread: {e}"))?;
        Ok(Self { board, stop, thread, cell, clock })
    }

    pub fn is_running(&self) -> bool {
        !self.thread.is_finished() && locked(&self.board).found.is_none()
    }

    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The best layout, once there is one.
    pub fn best(&self) -> Option<Layout> {
        locked(&self.board).found.clone()?.ok()?.layout
    }

    /// For the page: lengths in mm, angles in degrees.
    pub fn document(&self) -> Value {
        let running = self.is_running();
        let Board { progress, start, found, seconds } = &*locked(&self.board);
        let unit = self.cell.unit();
        let best = match found {
            Some(Ok(found)) => found.objective,
            _ => progress.best.map(|b| unit.from_si(b)),
        };
        let gain = start.zip(best).filter(|(s, _)| *s > 0.0).map(|(s, b)| percent_from_share((s - b) / s));
        let (ended, fault) = match found {
            Some(Ok(found)) => (Some(found.ended.in_words()), None),
            Some(Err(why)) => (None, Some(why.as_str())),
            None if running => (None, None),
            None => (None, Some("the search came to no end")),
        };
        json!({
            "running": running,
            "evaluations": progress.evaluations,
            "budget": progress.budget,
            "feasible": progress.feasible,
            "seed": self.cell.search.seed,
            "start": start,
            "best": best,
            "gain_percent": gain,
            "unit": unit.word(),
            "seconds": if running { self.clock.elapsed().as_secs_f64() } else { *seconds },
            "ended": ended,
            "fault": fault,
            "acceptable": matches!(found, Some(Ok(Found { layout: Some(_), .. }))),
        })
    }
}

fn run(cell: Cell, board: &Mutex<Board>, stop: &AtomicBool) -> Result<Found, String> {
    // A core is left to the page.
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let threads = rayon::ThreadPoolBuilder::new().num_threads(cores.saturating_sub(1).max(1)).build();
    let threads = threads.map_err(|e| format!("cannot start threads: {e}"))?;
    let workcell = Workcell::remembering(cell, &mut cache::remember)?;
    let (cell, unit) = (&workcell.cell, workcell.cell.unit());
    let start = evaluate(&workcell, &cell.start()).objective;
    locked(board).start = start.map(|v| unit.from_si(v));
    let progress = |p: Progress| locked(board).progress = p;
    let watch = Watch { progress: &progress, stop };
    let record = threads.install(|| search::search(&workcell, &cell.search, &watch));
    let objective = record.best.evaluation.objective.map(|v| unit.from_si(v));
    let layout = record.found().then(|| record.best.layout.clone());
    locked(board).progress.evaluations = record.evaluations;
    Ok(Found { layout, objective, ended: record.ended })
}
