//! `compare`: compares layouts side by side.

use super::remedies::remedies;
use super::{refuse_other_pages, stem, suggest_with, within_size, workcell};
use crate::assess::{Assessment, Comparison};
use crate::cli::arguments::CompareArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, asked, json_text, loading, output, results_folder};
use crate::drawing::Drawing;
use crate::files::shown;
use crate::layout::Workcell;
use crate::record::{ComparisonDocument, SearchResult};
use crate::report;
use crate::report::page::SearchFacts;
use std::path::{Path, PathBuf};

/// Runs `sweetspot compare`.
pub fn compare(a: &CompareArguments) -> Result<Exit, Exit> {
    if a.calibrated {
        return remedies(a);
    }
    a.out.as_deref().map_or(Ok(()), refuse_other_pages)?;
    let mut cells = Vec::new();
    for path in &a.layouts {
        let file = if path.is_dir() { results_folder::best_of(path)? } else { path.clone() };
        let label = if path.is_dir() { stem(path) } else { label_of(&file) };
        cells.push((label, workcell(asked::load(&file, &a.packages, &a.question)?.cell, &file)?));
    }
    name_apart(&mut cells, &a.layouts);
    let columns = cells.iter().map(|(label, w)| Assessment::new(label, w, w.cell.start())).collect();
    let comparison = Comparison::new(columns).map_err(|why| {
        output::error(&why);
        Exit::BadInput
    })?;
    if let Some(out) = &a.out {
        let html = page(&comparison, &a.layouts)?;
        loading::write_output(out, html.as_bytes())?;
        output::talk(&format!("wrote {} ({} kB)", path_word(out), html.len().div_ceil(1 << 10)));
    }
    if a.json {
        json_text::print(&ComparisonDocument::new(&comparison))?;
    } else {
        output::data(&report::text::comparison(&comparison))?;
        for sentence in comparison.in_words() {
            output::data(&format!("{sentence}\n"))?;
        }
        if a.out.is_none() {
            let all: Vec<_> = a.layouts.iter().map(|p| path_word(p)).collect();
            suggest_with(&format!("compare {} -o compare.html", all.join(" ")), &a.packages);
            return Ok(Exit::Done);
        }
        let last = a.layouts.last().map_or("CELL".into(), |p| path_word(p));
        suggest_with(&format!("report {last}"), &a.packages);
    }
    Ok(Exit::Done)
}

/// Renders the page with as much detail as its size limit allows.
fn page(comparison: &Comparison<'_>, paths: &[PathBuf]) -> Result<String, Exit> {
    let told: Vec<SearchFacts> = paths.iter().map(|p| told(p)).collect();
    within_size(|detail| {
        let drawings =
            comparison.columns.iter().map(|a| Drawing::new(a, detail)).collect::<Result<Vec<_>, _>>()?;
        report::page::compare(comparison, &drawings, &told)
    })
}

/// Reads from search.json the gap between the best layout and the proven bound, and the clearance of the best
/// layout. Both are None if search.json does not state them.
fn told(folder: &Path) -> SearchFacts {
    let text = std::fs::read(folder.join("search.json")).unwrap_or_default();
    let found: Option<SearchResult> = serde_json::from_slice(&text).ok();
    SearchFacts {
        gap_percent: found.as_ref().and_then(|found| found.gap_percent),
        clearance_mm: found.and_then(|found| found.goals).map(|goals| goals.clearance_mm),
    }
}

/// Distinguishes layouts of the same name by the differing parts of their paths.
fn name_apart(cells: &mut [(String, Workcell)], paths: &[PathBuf]) {
    let labels: Vec<String> = cells.iter().map(|(label, _)| label.clone()).collect();
    let is_twin = |label: &String| labels.iter().filter(|l| *l == label).count() > 1;
    let twins: Vec<&PathBuf> = labels.iter().zip(paths).filter(|(l, _)| is_twin(l)).map(|(_, p)| p).collect();
    let Some(first) = twins.first() else { return };
    let parents = first.ancestors().skip(1);
    let common = parents.into_iter().find(|folder| twins.iter().all(|p| p.starts_with(folder)));
    for ((label, _), path) in cells.iter_mut().zip(paths).filter(|((label, _), _)| is_twin(label)) {
        let own = common.and_then(|common| path.strip_prefix(common).ok()).unwrap_or(path);
        *label = shown(&own.to_string_lossy());
    }
}

/// Returns the label of a layout: the file stem, or the folder name for a best.toml.
fn label_of(file: &Path) -> String {
    match file.parent().and_then(Path::file_name) {
        Some(folder) if file.file_stem().is_some_and(|s| s == "best") => shown(&folder.to_string_lossy()),
        _ => stem(file),
    }
}
