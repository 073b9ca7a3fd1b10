//! `compare`.

use super::{stem, suggest, workcell};
use crate::cell::shown;
use crate::cli::arguments::CompareArguments;
use crate::cli::output::path_word;
use crate::cli::overrides::overridden;
use crate::cli::{Exit, files, output, results};
use crate::compare::{Assessment, Comparison};
use crate::layout::Workcell;
use crate::report;
use std::path::{Path, PathBuf};

/// `sweetspot compare`
pub fn compare(a: &CompareArguments) -> Result<Exit, Exit> {
    let mut cells = Vec::new();
    for path in &a.layouts {
        let file = if path.is_dir() { best_of(path)? } else { path.clone() };
        let label = if path.is_dir() { stem(path) } else { label_of(&file) };
        cells.push((
            label,
            workcell(overridden(files::load(&file, &a.packages)?, &a.overrides)?.cell, &file)?,
        ));
    }
    name_apart(&mut cells, &a.layouts);
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

/// Layouts of one name are told apart by their paths.
fn name_apart(cells: &mut [(String, Workcell)], paths: &[PathBuf]) {
    let labels: Vec<String> = cells.iter().map(|(label, _)| label.clone()).collect();
    for ((label, _), path) in cells.iter_mut().zip(paths) {
        if labels.iter().filter(|l| *l == label).count() > 1 {
            *label = shown(&path.to_string_lossy());
        }
    }
}

/// The best layout of the search that wrote a folder.
fn best_of(folder: &Path) -> Result<PathBuf, Exit> {
    let best = folder.join("best.toml");
    if best.is_file() || !folder.join("search.json").is_file() {
        return Ok(best);
    }
    let word = path_word(folder);
    output::error(&format!("the search in {word} found no feasible layout: there is none to compare"));
    output::talk(&format!("  help: sweetspot report {word} -o report.html tells what was in the way"));
    Err(Exit::BadInput)
}

/// Folders tell results apart better than their files, which are all best.toml.
fn label_of(file: &Path) -> String {
    match file.parent().and_then(Path::file_name) {
        Some(folder) if file.file_stem().is_some_and(|s| s == "best") => shown(&folder.to_string_lossy()),
        _ => stem(file),
    }
}
