//! `search` and `compare`.

use super::{stem, suggest, warn_of_distrust, warn_of_hopeless, workcell};
use crate::cell::{Cell, Goal, Goals, SearchSettings, Solver, shown};
use crate::cli::arguments::{CompareArguments, SearchArguments};
use crate::cli::output::path_word;
use crate::cli::overrides::overridden;
use crate::cli::{Exit, files, output, results};
use crate::compare::{Assessment, Comparison};
use crate::layout::Workcell;
use crate::report;
use crate::search::{self, Ended, Progress, SearchRecord, Watch};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// `sweetspot search`
pub fn search(a: &SearchArguments) -> Result<Exit, Exit> {
    let drawn = files::load(&a.cell, &a.packages)?;
    let limited: Vec<bool> = drawn.cell.operations.iter().map(|o| o.limit.is_some()).collect();
    let mut loaded = overridden(drawn, &a.overrides)?;
    refuse_lost_limits(&loaded.cell, &limited)?;
    let settings = &mut loaded.cell.search;
    settings.seed = a.seed.unwrap_or(settings.seed);
    settings.budget = a.budget.unwrap_or(settings.budget);
    settings.robust |= a.robust;
    refuse_nothing_to_withstand(&loaded.cell)?;
    let settings = &mut loaded.cell.search;
    let named = |name: &String| Solver::ALL.into_iter().find(|s| s.name() == name);
    take_kept(a, settings)?;
    settings.solver = a.solver.as_ref().and_then(named).unwrap_or(settings.solver);
    let workcell = workcell(loaded.cell, &a.cell)?;
    warn_of_hopeless(&workcell);
    // Before the work, not after it: an unwritable folder must not cost a search.
    let folder = files::new_folder(a.out.as_deref(), &stem(&a.cell))?;
    let clock = Instant::now();
    let record = run_search(&workcell, a.threads)?;
    let seconds = clock.elapsed().as_secs_f64();
    let [start, best] = [("start", &record.start), ("best", &record.best)]
        .map(|(label, candidate)| Assessment::new(label, &workcell, candidate.layout.clone()));
    // Else there is nothing to withstand and nothing to keep.
    let matters = workcell.cell.has_placement_tolerance() || limited.contains(&true);
    let columns = [start, if matters { best.misplaced() } else { best }];
    let comparison = Comparison { columns: columns.into() };
    let written =
        results::write_search(&folder, &a.cell, &workcell.cell, &loaded.sources, &record, &comparison)?;
    if a.json {
        let document = report::json::search(&workcell.cell, &record, &comparison, Some(seconds));
        output::data(&results::line(&document)?)?;
    } else {
        output::data(&answer(&workcell.cell, &record, &comparison, seconds))?;
    }
    written.tell();
    comparison.columns.last().into_iter().for_each(warn_of_distrust);
    if record.found() && !a.json {
        suggest(&format!("map {} --svg map.svg", path_word(&folder.join("best.toml"))));
    }
    Ok(match (record.ended, record.found()) {
        (Ended::Interrupted, _) => Exit::Interrupted,
        (_, true) => Exit::Done,
        (_, false) => Exit::AnswerIsNo,
    })
}

/// best.toml takes its limits from the cell file, where those of another unit would be a fault.
fn refuse_lost_limits(cell: &Cell, limited: &[bool]) -> Result<(), Exit> {
    let Some((lost, _)) = cell.operations.iter().zip(limited).find(|(o, had)| **had && o.limit.is_none())
    else {
        return Ok(());
    };
    let (name, word) = (shown(&lost.name), lost.sense.unit.word());
    output::error(&format!(
        "the limit of `{name}` is none of the sense {}, which is in {word}",
        lost.sense.name
    ));
    output::talk("  help: change sense and limit in a cell file, from = \"...\" cannot take a limit away");
    Err(Exit::BadInput)
}

/// Goals of a front and how many layouts are kept, as the command line says otherwise.
fn take_kept(a: &SearchArguments, settings: &mut SearchSettings) -> Result<(), Exit> {
    settings.keep = a.keep.map_or(settings.keep, |keep| keep as usize);
    let Some(named) = &a.pareto else { return Ok(()) };
    let named = named.iter().filter_map(|name| Goal::ALL.into_iter().find(|goal| goal.name() == name));
    let goals = Goals::of(&named.collect::<Vec<_>>()).filter(|goals| goals.count() > 1);
    settings.pareto = goals.ok_or_else(|| {
        output::error("--pareto must name two goals or more, each once");
        output::talk(&format!("  help: there are {}", Goal::ALL.map(Goal::name).join(", ")));
        Exit::BadInput
    })?;
    Ok(())
}

/// As the cell file is asked for `robust = true`.
fn refuse_nothing_to_withstand(cell: &Cell) -> Result<(), Exit> {
    if !cell.search.robust || cell.has_placement_tolerance() {
        return Ok(());
    }
    output::error("--robust, but everything is placed exactly");
    output::talk("  help: add placement_tolerance = { x_mm = 2, y_mm = 2 } to an equipment of the cell file");
    Err(Exit::BadInput)
}

fn run_search(workcell: &Workcell, threads: Option<u16>) -> Result<SearchRecord, Exit> {
    let stop = Arc::new(AtomicBool::new(false));
    let asked = stop.clone();
    // Without a handler Ctrl-C just ends the program, which leaves no half-written file either.
    let _ = ctrlc::set_handler(move || asked.store(true, Ordering::Relaxed));
    let unit = workcell.cell.unit();
    let bar = output::progress_bar(workcell.cell.search.budget);
    let progress = |p: Progress| {
        bar.set_position(p.evaluations);
        if let Some(best) = p.best {
            bar.set_message(format!("{:.4} {}", unit.from_si(best), unit.word()));
        }
    };
    let watch = Watch { progress: &progress, stop: &stop };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, usize::from)).build();
    let pool = pool.map_err(|e| {
        output::error(&format!("cannot start threads: {e}"));
        Exit::Io
    })?;
    let record = pool.install(|| search::search(workcell, &workcell.cell.search, &watch));
    bar.finish_and_clear();
    Ok(record)
}

fn answer(cell: &Cell, record: &SearchRecord, comparison: &Comparison<'_>, seconds: f64) -> String {
    let said = match (record.ended, record.found()) {
        (Ended::NothingToSearch, _) => "nothing to search: every placement is fixed".to_string(),
        (_, false) => "no feasible layout found; `best` is the nearest to one".to_string(),
        (_, true) => match comparison.change_percent(1, Assessment::objective) {
            Some(change) if change > -0.05 => "no better layout than the start was found".to_string(),
            Some(change) => {
                let word = report::text::value_word(cell);
                format!("the best layout has {:.1} % less {word} than the start", -change)
            }
            None => "the start layout is not feasible, the best one is".to_string(),
        },
    };
    format!(
        "{}\n\n{}\n{}{}{}{said}\n{} layouts evaluated, {} feasible, in {seconds:.2} s ({}, seed {})\n",
        report::text::headline(cell),
        report::text::comparison(comparison),
        comparison.columns.last().map(report::text::robustness).unwrap_or_default(),
        comparison.columns.last().map(report::text::goals_line).unwrap_or_default(),
        report::text::front(cell, record),
        record.evaluations,
        record.feasible,
        cell.search.solver.name(),
        cell.search.seed,
    )
}

/// `sweetspot compare`
pub fn compare(a: &CompareArguments) -> Result<Exit, Exit> {
    let mut cells = Vec::new();
    for path in &a.layouts {
        let file = if path.is_dir() { path.join("best.toml") } else { path.clone() };
        let label = if path.is_dir() { stem(path) } else { label_of(&file) };
        cells.push((
            label,
            workcell(overridden(files::load(&file, &a.packages)?, &a.overrides)?.cell, &file)?,
        ));
    }
    let columns = cells.iter().map(|(label, w)| Assessment::new(label, w, w.cell.start())).collect();
    let comparison = Comparison::new(columns).map_err(|why| {
        output::error(&why);
        Exit::BadInput
    })?;
    if a.json {
        output::data(&results::line(&report::json::compare(&comparison))?)?;
    } else {
        output::data(&report::text::comparison(&comparison))?;
        suggest("search CELL, or map CELL --svg map.svg for a picture of one of them");
    }
    Ok(Exit::Done)
}

/// Folders tell results apart better than their files, which are all best.toml.
fn label_of(file: &Path) -> String {
    match file.parent().and_then(Path::file_name) {
        Some(folder) if file.file_stem().is_some_and(|s| s == "best") => shown(&folder.to_string_lossy()),
        _ => stem(file),
    }
}
