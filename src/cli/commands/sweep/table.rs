//! The table of a sweep, made from the files of its combinations.

use super::combination::CheckedSweep;
use crate::cli::commands::suggest;
use crate::cli::json_text::{line, pretty, sealed};
use crate::cli::output::path_word;
use crate::cli::results::hashed;
use crate::cli::sweep::{StoredRow, continuing, number, row};
use crate::cli::{Exit, loading, output};
use crate::record::{ManifestDocument, SweepMode, SweepRow, SweepTable};
use crate::report;

/// Writes the table to files and stdout.
pub fn gather(sweep: &CheckedSweep, as_json: bool) -> Result<Exit, Exit> {
    let document = written(sweep)?;
    let text = if as_json { line(&document)? } else { report::text::sweep(&document) };
    output::data(&text)?;
    let folder = path_word(&sweep.folder);
    output::talk(&format!(
        "wrote {folder}: table.csv, table.json, manifest.json and one file per combination"
    ));
    if sweep.plan.is_of_islands() {
        suggest(&continuing(&sweep.plan, &sweep.folder, "--resume"));
    } else if let Some(best) = document.best.filter(|_| !as_json) {
        let best = sweep.folder.join(number(best) + ".toml");
        suggest(&format!("map {} --svg map.svg", path_word(&best)));
    }
    let is_accepted = |row: &SweepRow| row.feasible && row.meets_limits();
    Ok(if document.rows.iter().any(is_accepted) { Exit::Done } else { Exit::AnswerIsNo })
}

/// Reads the rows of all combinations, and writes the files of the table.
pub fn written(sweep: &CheckedSweep) -> Result<SweepTable, Exit> {
    let whole = |k: usize| match row(&sweep.folder, k) {
        StoredRow::Whole(row) => Ok(*row),
        StoredRow::Missing | StoredRow::Damaged(_) => {
            output::error(&format!(
                "{}: the files of combination {k} have changed during this command",
                path_word(&sweep.folder)
            ));
            Err(Exit::Io)
        }
    };
    let rows = (0..sweep.plan.combinations).map(whole).collect::<Result<Vec<SweepRow>, Exit>>()?;
    let mode = if sweep.plan.search { SweepMode::Search } else { SweepMode::Map };
    let document = SweepTable::new(mode, rows);
    let csv = report::sweep::csv(&document).map_err(|why| {
        output::error(&format!("cannot write table.csv: {why}"));
        Exit::Io
    })?;
    write_table(sweep, vec![("table.csv", csv), ("table.json", pretty(&document)?)])?;
    Ok(document)
}

/// Writes the tables and then the manifest, so that a folder with a manifest is complete.
///
/// The manifest contains no command, so that a resumed sweep writes the same bytes.
fn write_table(sweep: &CheckedSweep, outputs: Vec<(&str, Vec<u8>)>) -> Result<(), Exit> {
    let write = |name: &str, bytes: &[u8]| loading::write_changed(&sweep.folder.join(name), bytes);
    outputs.iter().try_for_each(|(name, bytes)| write(name, bytes))?;
    let hashes = outputs.iter().map(|(name, bytes)| hashed(name, bytes)).collect();
    let manifest = ManifestDocument {
        plan: Some("plan.json".into()),
        ..ManifestDocument::new(sweep.plan.inputs.clone(), hashes)
    };
    write("manifest.json", &sealed(&manifest)?)
}
