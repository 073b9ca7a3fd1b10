//! `search`: a job that can be stopped and resumed.

use super::{stem, suggest, warn_of_distrust, warn_of_hopeless, workcell};
use crate::assess::{Assessment, Comparison};
use crate::cli::arguments::SearchArguments;
use crate::cli::checkpoint;
use crate::cli::checkpoint::{CheckpointWriter, StoppedSearch};
use crate::cli::output::path_word;
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::progress::Reporter;
use crate::cli::search_request::SearchRequest;
use crate::cli::{Exit, json_text, output, results};
use crate::files::Loaded;
use crate::layout::Workcell;
use crate::proof::{Proof, ProofOptions, prove};
use crate::record::SearchResult;
use crate::report;
use crate::search;
use crate::search::{Moment, Progress, SearchEnd, SearchJob, SearchRecord, Watch};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs `sweetspot search`.
pub fn search(a: &SearchArguments) -> Result<Exit, Exit> {
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
    let pool = threads(now.threads)?;
    let proof = pool.install(|| proven(&workcell));
    let bound = proof.bound;
    let inputs = checkpoint::inputs(&sources);
    if let Some(kept) = kept {
        kept.check(&inputs, &workcell, bound)?;
    } else {
        warn_of_hopeless(&workcell);
    }
    // The folder is created first, so that a failure here wastes no search.
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
    let comparison = Comparison::of_search(&workcell, &record);
    let written = results::write_search(
        folder,
        file,
        &sources,
        (&record, &proof),
        &comparison,
        (!stopped).then_some(request),
    )?;
    if !stopped {
        keeper.remove()?;
    }
    output::data(&if now.json {
        json_text::line(&SearchResult::of_comparison(&record, &proof, &comparison).map(|r| r.timed(seconds)))?
    } else {
        answer(&workcell, (&record, &proof), &comparison, seconds)
    })?;
    written.tell();
    comparison.columns.last().into_iter().for_each(warn_of_distrust);
    if stopped {
        suggest(&format!("search --resume {}", path_word(folder)));
    } else if record.found() && !now.json {
        suggest(&format!("report {}", path_word(folder)));
    }
    let misses = comparison.columns.last().is_some_and(|best| !best.meets_requirements());
    Ok(exit(&record, misses))
}

/// Returns the exit code of a search. `misses` states that an operation of the best layout exceeds its limit.
fn exit(record: &SearchRecord, misses: bool) -> Exit {
    match (record.ended, record.found()) {
        (SearchEnd::Interrupted, _) => Exit::Interrupted,
        (SearchEnd::TimeLimit, _) => Exit::Limit,
        (_, true) if !misses => Exit::Done,
        _ => Exit::AnswerIsNo,
    }
}

/// Proves a lower bound of the objective of every layout of the cell.
fn proven(workcell: &Workcell) -> Proof {
    // Ctrl-C does not interrupt the proof, because a resumed search needs the same bound. The limit on its
    // number of boxes bounds its duration.
    let proof = prove(workcell, &ProofOptions::default(), &AtomicBool::new(false));
    let settings = &workcell.cell.search;
    match settings.gap {
        Some(_) if !settings.pareto.is_empty() => {
            output::talk("note: --gap is ignored: a Pareto search has no single bound");
        }
        Some(_) if proof.bound.is_none() => {
            output::talk(&format!("note: --gap is ignored: {}", proof.in_words(workcell)));
        }
        _ => {}
    }
    proof
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

/// Returns a flag that Ctrl-C or SIGTERM sets. A second signal ends the program at once; the last checkpoint
/// remains.
pub fn stop_at_signals() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = stop.clone();
    let _ = ctrlc::set_handler(move || {
        if asked.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(Exit::Interrupted as u8));
        }
    });
    stop
}

fn threads(count: Option<u16>) -> Result<rayon::ThreadPool, Exit> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.map_or(0, usize::from)).build();
    pool.map_err(|e| {
        output::error(&format!("cannot start threads: {e}"));
        Exit::Io
    })
}

fn answer(
    workcell: &Workcell,
    (record, proof): (&SearchRecord, &Proof),
    comparison: &Comparison<'_>,
    seconds: f64,
) -> String {
    let cell = &workcell.cell;
    let best = comparison.columns.last().map(|best| best.proven(proof));
    let (proof, gap) = best.unwrap_or_else(|| (proof.clone(), None));
    let said = match (record.ended, record.found()) {
        (SearchEnd::NothingToSearch, _) => "nothing to search: every placement is fixed".to_string(),
        (_, false) => "no feasible layout found; `best` is the closest to feasible".to_string(),
        (_, true) => match comparison.change_percent(1, Assessment::objective) {
            Some(change) if change > -0.05 => "no layout better than the start was found".to_string(),
            Some(change) => {
                let word = crate::record::objective_word(cell);
                format!("gain: the best layout has {:.1} % less {word} than the start", -change)
            }
            None => "the start layout is infeasible, the best layout is feasible".to_string(),
        },
    };
    let limits = match cell.operations.iter().any(|o| o.limit.is_some()) {
        true => "feasible and within every limit",
        false => "feasible",
    };
    let shown = comparison.columns.last();
    let of_best = |text: fn(&Assessment<'_>) -> String| shown.map(text).unwrap_or_default();
    [
        format!("{}\n", report::text::headline(cell)),
        of_best(report::text::answer),
        format!("\n{said}\n"),
        shown
            .map(Assessment::ending_tolerances)
            .unwrap_or_default()
            .iter()
            .map(|why| format!("  {why}\n"))
            .collect(),
        report::text::proven(workcell, gap, &proof),
        report::text::front(cell, record),
        format!("\n{}\n", report::text::side_by_side(comparison)),
        // The certificate of a layout makes the sampled misplacements superfluous.
        shown.filter(|best| best.certificate.is_none()).map(report::text::robustness).unwrap_or_default(),
        of_best(report::text::goals_line),
        report::text::assumptions(cell),
        format!(
            "{} layouts evaluated, {} {limits}, in {seconds:.2} s ({}, seed {}); {}\n",
            record.evaluations,
            record.feasible,
            cell.search.solver.name(),
            cell.search.seed,
            record.ended.in_words(),
        ),
    ]
    .concat()
}
