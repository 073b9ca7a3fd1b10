//! One function per command: read, ask the library, print, suggest the next.

use super::arguments::{CheckArguments, CompareArguments, MapArguments, SearchArguments};
use super::output::path_word;
use super::overrides::overridden;
use super::results::{self, Written};
use super::{Exit, files, output};
use crate::cell::{Cell, Coordinate, Fault, Loaded, Solver, shown};
use crate::compare::{Assessment, Comparison};
use crate::layout::{Workcell, evaluate};
use crate::report;
use crate::search::{self, Ended, Progress, SearchRecord, Watch};
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// What to do about a robot without inverse kinematics.
const UNSOLVED: &str = "this version solves arms with a base yaw and three parallel axes";

/// `sweetspot check`
pub fn check(a: &CheckArguments) -> Result<Exit, Exit> {
    if a.json {
        let (exit, faults) = match files::read_cell(&a.cell) {
            Ok(loaded) => match Workcell::new(loaded.cell) {
                Ok(_) => (Exit::Done, loaded.warnings),
                Err(why) => {
                    let fault = Fault::of_file(&path_word(&a.cell), why, UNSOLVED);
                    (Exit::BadInput, [loaded.warnings, vec![fault]].concat())
                }
            },
            Err(faults) => (files::exit_of(&faults), faults),
        };
        let valid = exit == Exit::Done;
        output::data(&format!(
            "{}\n",
            json!({ "schema": "sweetspot/check/1", "valid": valid, "faults": faults })
        ))?;
        return Ok(exit);
    }
    let loaded = files::load(&a.cell)?;
    let warnings = loaded.warnings.len();
    let workcell = workcell(loaded.cell, &a.cell)?;
    let cell = &workcell.cell;
    let free = cell.equipment.iter().flat_map(|e| &e.placement).filter(|c| is_free(c)).count();
    let nodes: usize = cell.operations.iter().map(|o| o.nodes()).sum();
    output::data(&format!(
        "{}\n{} axes, {} equipment and obstacles, {} operations on {nodes} nodes, {free} search variables\n{}valid{}\n",
        report::text::headline(cell),
        cell.robot.axes(),
        cell.equipment.len(),
        cell.operations.len(),
        report::text::feasibility(&Assessment::new("start", &workcell, cell.start())),
        if warnings == 0 { String::new() } else { format!(", {warnings} warning(s)") },
    ))?;
    warn_of_hopeless(&workcell);
    let next = if free > 0 { "search" } else { "map" };
    suggest(&format!("{next} {}", path_word(&a.cell)));
    Ok(Exit::Done)
}

/// `sweetspot map`
pub fn map(a: &MapArguments) -> Result<Exit, Exit> {
    let Loaded { cell, sources, .. } = overridden(files::load(&a.cell)?, &a.overrides)?;
    let workcell = workcell(cell, &a.cell)?;
    let assessment = Assessment::new("start", &workcell, workcell.cell.start());
    let document = report::json::map(&assessment);
    if let Some(path) = &a.svg {
        files::write_whole(path, report::svg::plan(&assessment).as_bytes())?;
    }
    let written = match &a.out {
        Some(folder) => {
            let folder = files::new_folder(Some(folder), "")?;
            let files = vec![
                ("map.json", results::pretty(&document)?),
                ("map.csv", results::csv(&assessment)?),
                ("map.svg", report::svg::plan(&assessment).into_bytes()),
                ("discrepancy.svg", report::fig8::chart(&assessment).into_bytes()),
            ];
            Some(results::write(&folder, &workcell.cell, &sources, files)?)
        }
        None => None,
    };
    if a.json {
        output::data(&results::line(&document)?)?;
    } else {
        let headline = report::text::headline(&workcell.cell);
        output::data(&format!("{headline}\n{}", report::text::maps(&assessment)))?;
    }
    if let Some(path) = &a.svg {
        output::talk(&format!("wrote {}", path_word(path)));
    }
    written.iter().for_each(Written::tell);
    if !a.json {
        let movable = workcell.cell.equipment.iter().any(|e| e.placement.iter().any(is_free));
        let next = match (movable, &a.svg) {
            (true, _) => format!("search {}", path_word(&a.cell)),
            (false, None) => format!("map {} --svg map.svg", path_word(&a.cell)),
            (false, Some(_)) => format!("map {} --json", path_word(&a.cell)),
        };
        suggest(&next);
    }
    Ok(Exit::Done)
}

/// `sweetspot search`
pub fn search(a: &SearchArguments) -> Result<Exit, Exit> {
    let mut loaded = overridden(files::load(&a.cell)?, &a.overrides)?;
    let settings = &mut loaded.cell.search;
    settings.seed = a.seed.unwrap_or(settings.seed);
    settings.budget = a.budget.unwrap_or(settings.budget);
    let named = |name: &String| Solver::ALL.into_iter().find(|s| s.name() == name);
    settings.solver = a.solver.as_ref().and_then(named).unwrap_or(settings.solver);
    let workcell = workcell(loaded.cell, &a.cell)?;
    warn_of_hopeless(&workcell);
    // Before the work, not after it: an unwritable folder must not cost a search.
    let folder = files::new_folder(a.out.as_deref(), &stem(&a.cell))?;
    let clock = Instant::now();
    let record = run_search(&workcell, a.threads)?;
    let seconds = clock.elapsed().as_secs_f64();
    let columns = [("start", &record.start), ("best", &record.best)]
        .map(|(label, candidate)| Assessment::new(label, &workcell, candidate.layout.clone()));
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
    if record.found() && !a.json {
        suggest(&format!("map {} --svg map.svg", path_word(&folder.join("best.toml"))));
    }
    Ok(match (record.ended, record.found()) {
        (Ended::Interrupted, _) => Exit::Interrupted,
        (_, true) => Exit::Done,
        (_, false) => Exit::AnswerIsNo,
    })
}

/// Says which overlaps no search can cure: nothing that takes part can move.
fn warn_of_hopeless(workcell: &Workcell) {
    let moves = |k: usize| workcell.cell.equipment[k].placement.iter().any(is_free);
    let overlaps = evaluate(workcell, &workcell.cell.start()).overlaps;
    for overlap in
        overlaps.iter().filter(|o| !(0..workcell.cell.equipment.len()).any(|k| o.concerns(k) && moves(k)))
    {
        let what = overlap.in_words(&workcell.cell);
        output::talk(&format!("warning: {what}, and none of the two can move: no layout is feasible"));
    }
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
        "{}\n\n{}\n{said}\n{} layouts evaluated, {} feasible, in {seconds:.2} s ({}, seed {})\n",
        report::text::headline(cell),
        report::text::comparison(comparison),
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
        cells.push((label, workcell(overridden(files::load(&file)?, &a.overrides)?.cell, &file)?));
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

fn workcell(cell: Cell, file: &Path) -> Result<Workcell, Exit> {
    let name = cell.robot.name.clone();
    Workcell::new(cell).map_err(|why| {
        let file = path_word(file);
        output::error(&format!("{file}: no inverse kinematics for the robot `{name}`: {why}"));
        output::talk(&format!("  help: {UNSOLVED}"));
        Exit::BadInput
    })
}

fn is_free(coordinate: &Coordinate) -> bool {
    matches!(coordinate, Coordinate::Range { .. })
}

fn suggest(command: &str) {
    output::talk(&format!("next: sweetspot {command}"));
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or("cell".into(), |s| shown(&s.to_string_lossy()))
}
