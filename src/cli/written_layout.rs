//! Check of the layout files that a search writes. Each file must describe exactly the layout and the cell of
//! the search.

use super::output::path_word;
use super::packages::PackageFolders;
use super::{Exit, cache, loading, output};
use crate::assess::Assessment;
use crate::cell::Cell;
use crate::files::shown;
use crate::layout::{Evaluation, Workcell, evaluate};
use crate::search::EvaluatedLayout;
use std::path::Path;

/// Refuses best.toml unless its map equals the map of the search bit for bit.
pub fn check_best(file: &Path, packages: &PackageFolders, best: &Assessment<'_>) -> Result<(), Exit> {
    let workcell = read_again(file, packages)?;
    let again = Assessment::new(&best.label, &workcell, workcell.cell.start());
    let is_same = again.layout == best.layout
        && is_same_evaluation(best.cell, &again.evaluation, &best.evaluation)
        && again.maps == best.maps;
    is_same.then_some(()).ok_or_else(|| refused(file, "it gives another error map"))
}

/// Refuses the file of an alternative layout unless its evaluation equals the evaluation in the search bit
/// for bit.
pub fn check_alternative(
    file: &Path,
    packages: &PackageFolders,
    cell: &Cell,
    alternative: &EvaluatedLayout,
) -> Result<(), Exit> {
    let workcell = read_again(file, packages)?;
    let layout = workcell.cell.start();
    let again = evaluate(&workcell, &layout);
    let is_same = layout == alternative.layout && is_same_evaluation(cell, &again, &alternative.evaluation);
    is_same.then_some(()).ok_or_else(|| refused(file, "it gives another error"))
}

/// Compares the evaluation `again` of a layout with the evaluation `searched` from the search for
/// `cell`.
///
/// A search that prices tolerances has the goal `cost` or the objective `tolerance-cost`. Such a search does
/// not compare the error at the present tolerances with the limits. The layout file does not state goals that
/// a flag chose. The evaluation of such a file may contain a penalty for a missed limit. The search did not
/// add this penalty. For a search that prices tolerances, the function therefore ignores
/// [`Evaluation::cost`], the objective plus penalties.
fn is_same_evaluation(cell: &Cell, again: &Evaluation, searched: &Evaluation) -> bool {
    let cost = if cell.search.prices_tolerances() { searched.cost } else { again.cost };
    Evaluation { cost, ..again.clone() } == *searched
}

/// Reads a layout file back.
fn read_again(file: &Path, packages: &PackageFolders) -> Result<Workcell, Exit> {
    let loaded = loading::read_cell(file, packages).map_err(|faults| {
        output::faults(&faults);
        refused(file, "it cannot be read back")
    })?;
    Workcell::remembering(loaded.cell, &mut cache::remember).map_err(|why| refused(file, &why))
}

/// Prints why a layout file cannot be kept, and removes it.
fn refused(file: &Path, why: &str) -> Exit {
    output::error(&format!("{} is not the layout that the search found: {}", path_word(file), shown(why)));
    output::talk(
        "  help: files in the folder changed during the search, or the disk is faulty: search again",
    );
    let _ = std::fs::remove_file(file);
    Exit::Io
}
