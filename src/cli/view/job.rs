//! Search in its own thread, started from the layout on the page.

use crate::cell::{Cell, Layout};
use crate::cli::cache;
use crate::cli::mutex::locked;
use crate::layout::{Workcell, evaluate};
use crate::report::json::LiveSearch;
use crate::search;
use crate::search::{Progress, SearchEnd, Watch};
use crate::units::percent_from_share;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

/// State of a search that its thread shares with the pages.
struct SearchState {
    progress: Progress,
    /// Objective of the start layout, mm, degrees or a share.
    start: Option<f64>,
    found: Option<Result<LiveResult, String>>,
    seconds: f64,
}

/// Result of a search from the page.
#[derive(Clone)]
pub struct LiveResult {
    /// Best layout; None if no feasible layout was found.
    pub layout: Option<Layout>,
    objective: Option<f64>,
    ended: SearchEnd,
}

/// Thread of a search that is running or has ended.
pub struct SearchThread {
    board: Arc<Mutex<SearchState>>,
    stop: Arc<AtomicBool>,
    thread: JoinHandle<()>,
    cell: Cell,
    clock: Instant,
}

impl SearchThread {
    /// Starts a search.
    ///
    /// # Errors
    /// Fails with the reason if no thread can be started.
    pub fn start(cell: Cell) -> Result<Self, String> {
        let progress = Progress { evaluations: 0, budget: cell.search.budget, feasible: 0, best: None };
        let board = Arc::new(Mutex::new(SearchState { progress, start: None, found: None, seconds: 0.0 }));
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

    /// Returns whether the search is still running.
    pub fn is_running(&self) -> bool {
        !self.thread.is_finished() && locked(&self.board).found.is_none()
    }

    /// Asks the search to stop.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Returns the best layout; None while the search runs, or if no feasible layout was found.
    pub fn best(&self) -> Option<Layout> {
        locked(&self.board).found.clone()?.ok()?.layout
    }

    /// Returns progress and result for the page, lengths in mm and angles in degrees.
    pub fn record(&self) -> LiveSearch {
        let running = self.is_running();
        let SearchState { progress, start, found, seconds } = &*locked(&self.board);
        let unit = self.cell.unit();
        let best = match found {
            Some(Ok(found)) => found.objective,
            _ => progress.best.map(|b| unit.from_si(b)),
        };
        let gain = start.zip(best).filter(|(s, _)| *s > 0.0).map(|(s, b)| percent_from_share((s - b) / s));
        let (ended, fault) = match found {
            Some(Ok(found)) => (Some(found.ended.in_words()), None),
            Some(Err(why)) => (None, Some(why.clone())),
            None if running => (None, None),
            None => (None, Some("the search failed".into())),
        };
        LiveSearch {
            running,
            evaluations: progress.evaluations,
            budget: progress.budget,
            feasible: progress.feasible,
            seed: self.cell.search.seed,
            start: *start,
            best,
            gain_percent: gain,
            unit,
            seconds: if running { self.clock.elapsed().as_secs_f64() } else { *seconds },
            ended,
            fault,
            acceptable: matches!(found, Some(Ok(LiveResult { layout: Some(_), .. }))),
        }
    }
}

fn run(cell: Cell, board: &Mutex<SearchState>, stop: &AtomicBool) -> Result<LiveResult, String> {
    // One core is left free for the page.
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
    Ok(LiveResult { layout, objective, ended: record.ended })
}
