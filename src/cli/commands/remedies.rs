//! `compare --calibrated`: answers whether to calibrate a measured robot, to move the equipment, or to do
//! both.

use super::{suggest_with, workcell};
use crate::assess::{Assessment, Remedies};
use crate::cell::{Cell, Interpretation, Reading, SearchSettings};
use crate::cli::arguments::{CompareArguments, RemedySearchFlags};
use crate::cli::output::path_word;
use crate::cli::progress::Reporter;
use crate::cli::signals::stop_at_signals;
use crate::cli::{Exit, asked, json_text, output};
use crate::files::{Loaded, shown};
use crate::layout::Workcell;
use crate::record::RemediesDocument;
use crate::report;
use crate::search::{Progress, SearchEnd, SearchRecord, Watch, search};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs `sweetspot compare --calibrated`.
pub fn remedies(a: &CompareArguments) -> Result<Exit, Exit> {
    let [file] = &a.layouts[..] else {
        output::error("--calibrated compares variants of one cell");
        output::talk("  help: give one cell file");
        return Err(Exit::BadInput);
    };
    let Loaded { cell, .. } = asked::load(file, &a.packages, &a.question)?;
    let cell = random(cell, file)?;
    let Some(compensated) = cell.compensated() else {
        let name = shown(cell.error_set().name());
        output::error(&format!("{}: the errors `{name}` of the robot are not measured", path_word(file)));
        output::talk(
            "  help: run `sweetspot calibrate ROBOT DATA --toml`, put the printed table into a copy of the \
            robot file, and choose its error set with --errors",
        );
        return Err(Exit::BadInput);
    };
    let settings = settings(&cell, &a.search);
    let (wrong, right) = (workcell(cell, file)?, workcell(compensated, file)?);
    let stop = stop_at_signals();
    let found = [&wrong, &right].map(|workcell| searched(workcell, &settings, a.search.time, &stop));
    if stop.load(Ordering::Relaxed) {
        return Ok(Exit::Interrupted);
    }
    let [moved, both] = &found;
    let drawn = |workcell| Assessment::new("as drawn", workcell, wrong.cell.start());
    let best = |workcell, found: &SearchRecord| Assessment::new("best", workcell, found.best.layout.clone());
    let remedies = Remedies::new([drawn(&wrong), drawn(&right), best(&wrong, moved), best(&right, both)]);
    let evaluations = found.iter().map(|record| record.evaluations).sum();
    let can_move = !wrong.cell.free().is_empty();
    let document = RemediesDocument::new(&remedies, settings.seed, evaluations, can_move);
    if found.iter().any(|record| record.ended == SearchEnd::Interrupted) {
        output::talk("note: a search was stopped by --time; a longer search may find a better layout");
    }
    if a.json {
        json_text::print(&document)?;
    } else {
        output::data(&report::text::remedies(&document))?;
        let next = if can_move { "search" } else { "correct" };
        suggest_with(&format!("{next} {}{}", path_word(file), a.question.words()), &a.packages);
    }
    Ok(if document.advised.is_empty() { Exit::AnswerIsNo } else { Exit::Done })
}

/// Returns the cell with the statistical reading instead of the signed reading, because the errors of a
/// calibrated arm are random.
fn random(cell: Cell, file: &Path) -> Result<Cell, Exit> {
    if cell.reading != Reading::Signed {
        return Ok(cell);
    }
    let question = Interpretation { reading: Reading::Statistical, ..cell.interpretation() };
    let asked = cell.with_interpretation(&question).map_err(|faults| {
        faults.iter().for_each(|fault| {
            output::error(&format!("{}: {}", path_word(file), fault.message));
            output::talk(&format!("  help: {}", fault.help));
        });
        Exit::BadInput
    })?;
    output::talk(&format!(
        "note: the errors are interpreted as random ({}), because the signs of the errors of a calibrated arm are not \
         known",
        asked.quantity.name()
    ));
    Ok(asked)
}

fn settings(cell: &Cell, flags: &RemedySearchFlags) -> SearchSettings {
    let own = cell.search;
    SearchSettings { seed: flags.seed.unwrap_or(own.seed), budget: flags.budget.unwrap_or(own.budget), ..own }
}

/// Searches for the best layout, for at most `limit` seconds. None means no time limit.
fn searched(
    workcell: &Workcell,
    settings: &SearchSettings,
    limit: Option<f64>,
    stop: &AtomicBool,
) -> SearchRecord {
    let reporter = Reporter::new(None, workcell, None, 0);
    let (clock, ends) = (Instant::now(), AtomicBool::new(stop.load(Ordering::Relaxed)));
    let progress = |p: Progress| {
        reporter.tell(p);
        let is_late = limit.is_some_and(|limit| clock.elapsed().as_secs_f64() >= limit);
        if is_late || stop.load(Ordering::Relaxed) {
            ends.store(true, Ordering::Relaxed);
        }
    };
    let record = search(workcell, settings, &Watch { progress: &progress, stop: &ends });
    reporter.finish();
    record
}
