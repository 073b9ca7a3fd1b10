//! Search with one seed, which can be stopped and resumed.

use super::outcome::SearchOutcome;
use super::session::{proven, threads};
use crate::cli::Exit;
use crate::cli::arguments::SearchArguments;
use crate::cli::checkpoint;
use crate::cli::checkpoint::{CheckpointWriter, StoppedSearch};
use crate::cli::commands::{stem, suggest, warn_of_hopeless, workcell};
use crate::cli::output::path_word;
use crate::cli::output_folder::{Sharing, new_folder, require_new};
use crate::cli::progress::Reporter;
use crate::cli::results::RunDescription;
use crate::cli::search_request::SearchRequest;
use crate::cli::signals::stop_at_signals;
use crate::files::Loaded;
use crate::layout::Workcell;
use crate::search;
use crate::search::{Moment, Progress, SearchEnd, SearchJob, SearchRecord, Watch};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs `sweetspot search` without islands.
pub fn search_once(a: &SearchArguments) -> Result<Exit, Exit> {
    match &a.resume {
        Some(folder) => {
            let kept = StoppedSearch::read(folder, a)?;
            run(&kept.request, a, Some(&kept))
        }
        None => run(&SearchRequest::new(a)?, a, None),
    }
}

/// Runs the search of a request, or resumes the stopped search `kept`. The current command line `now`
/// states threads, time limit and output.
fn run(request: &SearchRequest, now: &SearchArguments, kept: Option<&StoppedSearch>) -> Result<Exit, Exit> {
    let file = &request.cell;
    let Loaded { cell, sources, .. } = request.load()?;
    let workcell = workcell(cell, file)?;
    if kept.is_none() {
        require_new(now.out.as_deref(), Sharing::Alone)?;
    }
    let pool = threads(now.threads)?;
    let proof = pool.install(|| proven(&workcell));
    let bound = proof.bound;
    let inputs = checkpoint::inputs(&sources);
    if let Some(kept) = kept {
        kept.check(&inputs, &workcell, bound)?;
    } else {
        warn_of_hopeless(&workcell);
    }
    // The folder is created before the search, so that a failure here wastes no search.
    let new;
    let folder = match kept {
        Some(kept) => &kept.folder,
        None => {
            new = new_folder(now.out.as_deref(), &stem(file), Sharing::Alone)?;
            &new
        }
    };
    let clock = Instant::now();
    let keeper = CheckpointWriter::new(folder, request, inputs, now.checkpoint);
    let record = pool.install(|| run_search(&workcell, bound, now, &keeper, kept))?;
    let seconds = clock.elapsed().as_secs_f64();
    let stopped = matches!(record.ended, SearchEnd::Interrupted | SearchEnd::TimeLimit);
    let outcome = SearchOutcome::new(&workcell, &record, &proof, Vec::new());
    let (command, settings) = (request.command.clone(), request.settings.clone());
    let run = (!stopped).then_some(RunDescription { command, settings });
    let written = outcome.write(folder, file, &sources, run)?;
    if !stopped {
        keeper.remove()?;
    }
    outcome.tell(&written, seconds, now.json)?;
    if stopped {
        suggest(&format!("search --resume {}", path_word(folder)));
    } else {
        outcome.suggest_report(folder, now.json);
    }
    Ok(outcome.exit())
}

fn run_search(
    workcell: &Workcell,
    bound: Option<f64>,
    now: &SearchArguments,
    keeper: &CheckpointWriter,
    kept: Option<&StoppedSearch>,
) -> Result<SearchRecord, Exit> {
    let stop = stop_at_signals();
    let reporter =
        Reporter::new(now.progress.as_deref(), workcell, bound, kept.map_or(0, StoppedSearch::evaluations));
    let (late, clock) = (AtomicBool::new(false), Instant::now());
    let progress = |p: Progress| {
        reporter.tell(p);
        let over = now.rules.time.is_some_and(|limit| clock.elapsed().as_secs_f64() >= limit);
        if over && !stop.swap(true, Ordering::Relaxed) {
            late.store(true, Ordering::Relaxed);
        }
    };
    let keep = |state: &search::Checkpoint, moment: Moment| {
        if !keeper.keep(state, moment) {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let (watch, from) = (Watch { progress: &progress, stop: &stop }, kept.map(StoppedSearch::state));
    let job = SearchJob { bound, from, keep: &keep };
    let mut record = search::search_job(workcell, &workcell.cell.search, &watch, &job);
    reporter.finish();
    keeper.verdict(&record)?;
    if late.into_inner() && record.ended == SearchEnd::Interrupted {
        record.ended = SearchEnd::TimeLimit;
    }
    Ok(record)
}
