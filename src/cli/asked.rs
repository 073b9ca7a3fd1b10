//! A cell as the command line asks for it: its file with the settings of the flags, validated together.

use super::arguments::{ErrorFlags, QuestionFlags, SearchArguments};
use super::loading;
use super::packages::Packages;
use super::{Exit, output};
use crate::cell::{Cell, ErrorSet, Interpretation, Quantity, Reading};
use crate::files::{Loaded, Setting, shown, toml_string};
use crate::report;
use std::path::Path;

/// Loads a cell under the flags of a question, and prints the notes that belong to it.
pub fn load(file: &Path, packages: &Packages, flags: &QuestionFlags) -> Result<Loaded, Exit> {
    let loaded = loading::load_with(file, packages, &flags.settings())?;
    say_notes(&loaded, flags);
    Ok(loaded)
}

/// Loads a cell for the table of all readings, for which its own reading does not matter.
pub fn load_for_readings(file: &Path, packages: &Packages, flags: &ErrorFlags) -> Result<Loaded, Exit> {
    let mut settings = flags.settings();
    if let Some(sense) = &flags.sense {
        // A yield would need a limit in the unit of this sense.
        let (flag, p95) = (format!("--sense {sense}"), toml_string(Quantity::P95.name()));
        settings.push(Setting::of_flag(&flag, "quantity", p95));
    }
    let loaded = loading::load_with(file, packages, &settings)?;
    // The table reads the errors as magnitudes, too.
    let magnitudes = Interpretation { reading: Reading::WorstCase, ..loaded.cell.interpretation() };
    loaded.cell.asked_apart(&magnitudes).iter().for_each(say_caveats);
    Ok(loaded)
}

/// Refuses `--set` for a command that writes cell files, which could not state these keys.
pub fn refuse_sets(flags: &QuestionFlags, command: &str) -> Result<(), Exit> {
    let Some(set) = flags.errors.sets.first() else { return Ok(()) };
    output::error(&format!("`{command}` does not take --set: the layout files it writes could not state the key"));
    output::talk(&format!(
        "  help: write a cell file with the lines from = \"CELL.toml\" and {}, or run sweetspot sweep",
        shown(&set.line())
    ));
    Err(Exit::BadInput)
}

/// Loads a cell as a search asks for it.
pub fn load_for_search(a: &SearchArguments, file: &Path) -> Result<Loaded, Exit> {
    refuse_sets(&a.question, "search")?;
    let loaded = loading::load_with(file, &a.packages, &a.settings())?;
    say_notes(&loaded, &a.question);
    if a.question.errors.sense.is_some() {
        refuse_lost_limits(a, file, &loaded.cell)?;
    }
    Ok(loaded)
}

/// Refuses a sense in whose unit the cell file has no limit: best.toml takes its limits from that file, where
/// one in another unit would be an error.
fn refuse_lost_limits(a: &SearchArguments, file: &Path, cell: &Cell) -> Result<(), Exit> {
    let Ok(drawn) = loading::read_cell(file, &a.packages) else { return Ok(()) };
    let pairs = cell.operations.iter().zip(&drawn.cell.operations);
    let Some((lost, _)) = pairs.into_iter().find(|(now, drawn)| now.limit.is_none() && drawn.limit.is_some())
    else {
        return Ok(());
    };
    let (name, word) = (shown(&lost.name), lost.sense.unit.word());
    output::error(&format!(
        "the limit of `{name}` does not apply to the sense {}, which is in {word}",
        lost.sense.name
    ));
    output::talk(&format!("  help: add --limit in {word}, or change sense and limit in the cell file"));
    Err(Exit::BadInput)
}

fn say_notes(loaded: &Loaded, flags: &QuestionFlags) {
    let cell = &loaded.cell;
    let chosen = flags.errors.chooses_errors() || flags.registration.is_some();
    if chosen && loaded.follows_errors && cell.reading == Reading::WorstCase {
        let whose = match cell.error_set() {
            ErrorSet::Tolerance(_) => format!("{} is", shown(cell.error_set().name())),
            ErrorSet::Signed(_) => "the errors of the equipment are".to_string(),
        };
        output::talk(&format!(
            "note: {whose} a tolerance: read as worst-case (use --reading statistical for random variables)"
        ));
    }
    if flags.quantity.is_some() && cell.reading != Reading::Statistical {
        output::talk("note: --quantity is ignored: it applies to the statistical reading only");
    }
    say_caveats(cell);
}

fn say_caveats(cell: &Cell) {
    for caveat in report::text::caveats(cell) {
        output::talk(&format!("note: {caveat}"));
    }
}
