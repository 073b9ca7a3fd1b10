//! `readings`: compares every reading and registration side by side.

use super::{suggest_with, unsolved, workcell};
use crate::assess::Readings;
use crate::cli::arguments::ReadingsArguments;
use crate::cli::json_text;
use crate::cli::output::path_word;
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::results;
use crate::cli::results::{RunDescription, WrittenFolder};
use crate::cli::{Exit, asked, output};
use crate::record::ReadingsDocument;
use crate::report;

/// Runs `sweetspot readings`.
pub fn readings(a: &ReadingsArguments) -> Result<Exit, Exit> {
    let loaded = asked::load_for_readings(&a.cell, &a.packages, &a.errors)?;
    let cell = &loaded.cell;
    workcell(cell.clone(), &a.cell)?;
    // The folder is created first, so that a failure here wastes no computation.
    let folder = match &a.out {
        Some(folder) => Some(new_folder(Some(folder), "", Sharing::Alone)?),
        None => None,
    };
    let readings = Readings::new(cell).map_err(|why| unsolved(&cell.robot.name, &a.cell, &why))?;
    let document = ReadingsDocument::new(&readings, report::text::findings(&readings));
    let written = match &folder {
        Some(folder) => {
            let table = report::csv::readings(&document).map_err(|why| {
                output::error(&format!("cannot write readings.csv: {why}"));
                Exit::Io
            })?;
            let outputs = vec![("readings.json", json_text::pretty(&document)?), ("readings.csv", table)];
            Some(results::write(
                folder,
                cell,
                &loaded.sources,
                RunDescription::typed(a.errors.settings()),
                outputs,
            )?)
        }
        None => None,
    };
    if a.json {
        json_text::print(&document)?;
    } else {
        let title = report::text::question(cell);
        output::data(&format!("{title}\n\n{}", report::text::readings(&readings)))?;
    }
    written.iter().for_each(WrittenFolder::tell);
    if !a.json && readings.found() {
        suggest_with(&format!("budget {} --reading worst-case", path_word(&a.cell)), &a.packages);
    }
    Ok(if readings.found() { Exit::Done } else { Exit::AnswerIsNo })
}
