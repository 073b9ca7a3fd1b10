//! `map`: maps the error of every operation.

use super::{suggest, warn_of_distrust, workcell};
use crate::assess::Assessment;
use crate::cli::arguments::MapArguments;
use crate::cli::json_text;
use crate::cli::output::path_word;
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::results;
use crate::cli::results::{RunDescription, WrittenFolder};
use crate::cli::{Exit, asked, loading, output};
use crate::files::Loaded;
use crate::record::MapDocument;
use crate::report;

/// Runs `sweetspot map`.
pub fn map(a: &MapArguments) -> Result<Exit, Exit> {
    let Loaded { cell, sources, .. } = asked::load(&a.cell, &a.packages, &a.question)?;
    let workcell = workcell(cell, &a.cell)?;
    let assessment = Assessment::new("start", &workcell, workcell.cell.start());
    let document = MapDocument::new(&assessment);
    if let Some(path) = &a.svg {
        loading::write_whole(path, report::chart::error_map(&assessment).as_bytes())?;
    }
    let written = match &a.out {
        Some(folder) => {
            let folder = new_folder(Some(folder), "", Sharing::Alone)?;
            let files = vec![
                ("map.json", json_text::pretty(&document)?),
                ("map.csv", results::csv(&document)?),
                ("map.svg", report::chart::error_map(&assessment).into_bytes()),
                ("discrepancy.svg", report::chart::discrepancy(&assessment).into_bytes()),
            ];
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
        output::data(&format!("{headline}\n{}", report::text::maps(&assessment)))?;
    }
    if let Some(path) = &a.svg {
        output::talk(&format!("wrote {}", path_word(path)));
    }
    written.iter().for_each(WrittenFolder::tell);
    warn_of_distrust(&assessment);
    if !a.json {
        let movable = !workcell.cell.free().is_empty();
        let next = match (movable, &a.svg) {
            (true, _) => format!("search {}", path_word(&a.cell)),
            (false, None) => format!("map {} --svg map.svg", path_word(&a.cell)),
            (false, Some(_)) => format!("map {} --json", path_word(&a.cell)),
        };
        suggest(&next);
    }
    Ok(Exit::Done)
}
