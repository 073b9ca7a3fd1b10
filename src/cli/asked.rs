//! Loading of a cell with the settings of the command-line flags. These settings are validated together with
//! the cell file.

use super::arguments::{ErrorFlags, QuestionFlags};
use super::loading;
use super::packages::PackageFolders;
use super::{Exit, output};
use crate::cell::{Cell, ErrorSet, Interpretation, Quantity, Reading};
use crate::files::{Loaded, Setting, shown, toml_string};
use std::path::Path;

/// Loads a cell with the settings from the flags. Prints notes on the interpretation of the errors and on
/// ignored flags.
pub fn load(file: &Path, packages: &PackageFolders, flags: &QuestionFlags) -> Result<Loaded, Exit> {
    let settings = flags.settings();
    let loaded = loading::load_with(file, packages, &settings)?;
    say_notes(&loaded, &settings);
    Ok(loaded)
}

/// Loads a cell for the table of all readings; the reading that the cell file states is ignored.
pub fn load_for_readings(file: &Path, packages: &PackageFolders, flags: &ErrorFlags) -> Result<Loaded, Exit> {
    let mut settings = flags.settings();
    if let Some(sense) = &flags.sense {
        // The quantity `yield` would need a limit in the unit of this sense, and the cell file may have
        // no such limit.
        let (flag, p95) = (format!("--sense {sense}"), toml_string(Quantity::P95.name()));
        settings.push(Setting::of_flag(&flag, "quantity", p95));
    }
    let loaded = loading::load_with(file, packages, &settings)?;
    // The table also contains the worst-case reading, so the notes on that reading are printed.
    let magnitudes = Interpretation { reading: Reading::WorstCase, ..loaded.cell.interpretation() };
    loaded.cell.with_interpretation_per_operation(&magnitudes).iter().for_each(say_caveats);
    Ok(loaded)
}

/// Refuses `--set` for a command that writes layout files, because a layout file cannot state the overridden
/// keys.
pub fn refuse_sets(settings: &[Setting], command: &str) -> Result<(), Exit> {
    let Some(set) = settings.iter().find(|setting| setting.flag.is_none()) else { return Ok(()) };
    output::error(&format!(
        "`{command}` does not accept --set: it writes layout files, which cannot record the changes of --set"
    ));
    output::talk(&format!(
        "  help: write a cell file with the two lines `from = \"CELL.toml\"` and `{}`, or run sweetspot sweep",
        shown(&set.line())
    ));
    Err(Exit::BadInput)
}

/// Loads a cell for a search. Prints notes on the interpretation of the errors and on ignored flags.
///
/// Refuses `--set`. Also refuses `--sense` if a limit in the cell file has a different unit from the sense,
/// unless `--limit` replaces that limit.
pub fn load_for_search(file: &Path, packages: &PackageFolders, settings: &[Setting]) -> Result<Loaded, Exit> {
    refuse_sets(settings, "search")?;
    let loaded = loading::load_with(file, packages, settings)?;
    say_notes(&loaded, settings);
    let has_sense = settings.iter().filter_map(|s| s.flag.as_deref()).any(|flag| flag.starts_with("--sense"));
    if has_sense && let Ok(drawn) = loading::read_cell(file, packages) {
        refuse_lost_limits(&loaded.cell, &drawn.cell)?;
    }
    Ok(loaded)
}

/// Refuses the sense that a flag states if the limit of an operation in the cell file has a different unit.
///
/// `cell` has the sense of the flag; `drawn` is the cell file without flags. Without this refusal, the search
/// would write an invalid best.toml: the file would state the new sense and inherit the limit.
fn refuse_lost_limits(cell: &Cell, drawn: &Cell) -> Result<(), Exit> {
    let pairs = cell.operations.iter().zip(&drawn.operations);
    let Some((lost, _)) = pairs.into_iter().find(|(now, drawn)| now.limit.is_none() && drawn.limit.is_some())
    else {
        return Ok(());
    };
    let (name, word) = (shown(&lost.name), lost.sense.unit.word());
    output::error(&format!(
        "the limit of `{name}` does not apply to the sense {}, which is measured in {word}",
        lost.sense.name
    ));
    output::talk(&format!("  help: add --limit in {word}, or change sense and limit in the cell file"));
    Err(Exit::BadInput)
}

fn say_notes(loaded: &Loaded, settings: &[Setting]) {
    let cell = &loaded.cell;
    let states = |path: &str| settings.iter().any(|s| s.path == path);
    let chosen = states("errors") || states("registration");
    if chosen && loaded.follows_errors && cell.reading == Reading::WorstCase {
        let whose = match cell.error_set() {
            ErrorSet::Tolerance(_) => format!("{} is", shown(cell.error_set().name())),
            _ => "the error of the equipment is".to_string(),
        };
        output::talk(&format!(
            "note: {whose} a tolerance, so the reading is worst-case \
             (--reading statistical treats it as random)"
        ));
    }
    if states("quantity") && cell.reading != Reading::Statistical {
        output::talk("note: --quantity is ignored: it applies to the statistical reading only");
    }
    say_caveats(cell);
}

fn say_caveats(cell: &Cell) {
    for caveat in crate::record::caveats(cell) {
        output::talk(&format!("note: {caveat}"));
    }
}
