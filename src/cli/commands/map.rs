//! `map`: maps the error of every operation.

use super::{measured, suggest_with, warn_of_distrust, workcell};
use crate::assess::Assessment;
use crate::cli::arguments::MapArguments;
use crate::cli::json_text;
use crate::cli::output::path_word;
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::results;
use crate::cli::results::{RunDescription, WrittenFolder};
use crate::cli::{Exit, asked, loading, output};
use crate::files::Loaded;
use crate::record::{ComparedFile, MapDocument};
use crate::report;

/// Runs `sweetspot map`.
pub fn map(a: &MapArguments) -> Result<Exit, Exit> {
    let Loaded { cell, mut sources, .. } = asked::load(&a.cell, &a.packages, &a.question)?;
    let workcell = workcell(cell, &a.cell)?;
    let assessment = Assessment::new("start", &workcell, workcell.cell.start());
    let mut document = MapDocument::new(&assessment);
    document.measured = measured::compared(&a.measured, &workcell.cell)?;
    if let Some(path) = &a.svg {
        loading::write_output(path, report::chart::error_map(&assessment).as_bytes())?;
    }
    let written = match &a.out {
        Some(folder) => {
            let folder = new_folder(Some(folder), "", Sharing::Alone)?;
            let mut files = vec![
                ("map.json".into(), json_text::pretty(&document)?),
                ("map.csv".into(), results::csv(&document)?),
                ("map.svg".into(), report::chart::error_map(&assessment).into_bytes()),
                ("discrepancy.svg".into(), report::chart::discrepancy(&assessment).into_bytes()),
            ];
            files.extend(measured_files(&document.measured)?);
            sources.extend(measured::sources(&a.measured)?);
            Some(results::write(
                &folder,
                &workcell.cell,
                &sources,
                RunDescription::typed(a.question.settings()),
                files,
            )?)
        }
        None => None,
    };
    if a.json {
        json_text::print(&document)?;
    } else {
        let headline = report::text::headline(&workcell.cell);
        output::data(&format!(
            "{headline}\n{}{}",
            report::text::maps(&assessment),
            report::text::measured(&document.measured)
        ))?;
    }
    if let Some(path) = &a.svg {
        output::talk(&format!("wrote {}", path_word(path)));
    }
    written.iter().for_each(WrittenFolder::tell);
    warn_of_distrust(&assessment);
    if !a.json {
        let movable = !workcell.cell.free().is_empty();
        let next = match (movable, &a.svg) {
            _ if !document.measured.is_empty() => {
                format!("report {}{}", path_word(&a.cell), measured::words(&a.measured))
            }
            (true, _) => format!("search {}", path_word(&a.cell)),
            (false, None) => format!("map {} --svg map.svg", path_word(&a.cell)),
            (false, Some(_)) => format!("map {} --json", path_word(&a.cell)),
        };
        suggest_with(&next, &a.packages);
    }
    Ok(Exit::Done)
}

/// Returns the files to write: the table of measured positions, and the pictures of every compared table.
/// Returns an empty list if no table is compared.
fn measured_files(compared: &[ComparedFile]) -> Result<Vec<(String, Vec<u8>)>, Exit> {
    if compared.is_empty() {
        return Ok(Vec::new());
    }
    let table = report::measured::csv(compared).map_err(|why| {
        output::error(&format!("cannot write measured.csv: {why}"));
        Exit::Io
    })?;
    let mut files = vec![("measured.csv".to_string(), table)];
    for (k, file) in compared.iter().enumerate() {
        let number = if k == 0 { String::new() } else { format!("-{}", k + 1) };
        files.push((format!("measured{number}.svg"), report::chart::measured(file).into_bytes()));
        files.push((format!("residuals{number}.svg"), report::chart::residuals(file).into_bytes()));
    }
    Ok(files)
}
