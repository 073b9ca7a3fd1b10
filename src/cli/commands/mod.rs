//! One function per command. Each function reads the input, calls the library, prints the result and suggests
//! the next command.

mod allocate;
mod assumed;
mod calibrate;
mod check;
mod correct;
mod errors;
mod export;
mod figures;
mod init;
mod init_own;
mod layouts;
mod manual;
mod map;
mod measured;
mod measurements;
mod measuring_plan;
mod posture;
mod readings;
mod remedies;
mod report;
mod robots;
mod robust;
mod schema;
mod search;
mod stated;
mod sweep;
#[cfg(feature = "view")]
mod view;
#[cfg(not(feature = "view"))]
#[path = "without_view.rs"]
mod view;

pub use allocate::allocate;
pub use calibrate::calibrate;
pub use check::check;
pub use correct::correct;
pub use errors::errors;
pub use export::export;
pub use figures::figures;
pub use init::init;
pub use layouts::compare;
pub use manual::{completions, man};
pub use map::map;
pub use posture::{budget, explain};
pub use readings::readings;
pub use report::report;
pub use robots::{envelope, robot, robots};
pub use robust::robust;
pub use schema::schema;
pub use search::search;
pub use sweep::sweep;
pub use view::view;

use crate::assess::Assessment;
use crate::cell::{Cell, Coordinate};
use crate::clearance::Party;
use crate::cli::output::path_word;
use crate::cli::packages::PackageFolders;
use crate::cli::{Exit, cache, output};
use crate::drawing::Detail;
use crate::files::shown;
use crate::layout::{Workcell, evaluate};
use crate::report::page::sized;
use crate::report::text;
use std::path::Path;

/// Remedy for a tool orientation that the kinematics of the robot does not allow.
const UNSOLVED: &str = "relax the orientation of the tool, or use another robot: see `sweetspot robots`";

/// Warns of every overlap that no search can remove, because a search can move neither body.
fn warn_of_hopeless(workcell: &Workcell) {
    let cell = &workcell.cell;
    let moves = |k: usize| {
        let under = (0..cell.equipment.len()).filter(|&under| cell.rides_on(k, under));
        under.flat_map(|k| &cell.equipment[k].placement).any(Coordinate::is_free)
    };
    let base_moves = cell.base.iter().any(Coordinate::is_free);
    let overlaps = evaluate(workcell, &workcell.cell.start()).overlaps;
    for overlap in overlaps.iter().filter(|o| !(0..cell.equipment.len()).any(|k| o.concerns(k) && moves(k))) {
        if base_moves && overlap.b == Party::RobotBase {
            continue;
        }
        let what = overlap.in_words(&workcell.cell);
        output::talk(&format!("warning: {what}, and neither can move: no layout is feasible"));
    }
}

/// Warns of every operation for whose map the chosen error model is unreliable.
fn warn_of_distrust(assessment: &Assessment<'_>) {
    for map in &assessment.maps {
        let name = shown(&assessment.cell.operations[map.operation].name);
        let doubts = [text::distrust(assessment.cell, map), text::extrapolation(assessment.cell, map)];
        for said in doubts.into_iter().flatten() {
            output::talk(&format!("warning: {name}: {said}"));
        }
    }
}

/// Warns if the layout of an exported file is infeasible or misses a limit.
fn warn_of_infeasible(assessment: &Assessment<'_>) {
    if assessment.evaluation.objective.is_none() {
        let reasons = assessment.reasons();
        output::talk(&format!(
            "warning: the layout is not feasible; do not build it: {}",
            reasons.join("; ")
        ));
    } else if !assessment.meets_requirements() {
        output::talk("warning: the layout does not meet every limit; `sweetspot report` states which");
    }
}

fn workcell(cell: Cell, file: &Path) -> Result<Workcell, Exit> {
    let name = cell.robot.name.clone();
    Workcell::remembering(cell, &mut cache::remember).map_err(|why| unsolved(&name, file, &why))
}

fn unsolved(robot: &str, file: &Path, why: &str) -> Exit {
    let file = path_word(file);
    output::error(&format!("{file}: the robot `{}` does not suit this task: {why}", shown(robot)));
    output::talk(&format!("  help: {UNSOLVED}"));
    Exit::BadInput
}

/// Refuses a file name without .html or .htm, so that a mistyped name does not overwrite a cell file.
fn refuse_other_pages(out: &Path) -> Result<(), Exit> {
    let is_page =
        out.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if is_page {
        return Ok(());
    }
    output::error(&format!("{}: the name of an HTML page must end in .html or .htm", path_word(out)));
    Err(Exit::BadInput)
}

/// Renders a page with as much detail as its size limit allows. Prints which details were left out.
fn within_size(page: impl FnMut(&Detail) -> Result<String, String>) -> Result<String, Exit> {
    let page = sized(page).map_err(|why| {
        output::error(&format!("cannot render the page: {why}"));
        Exit::Io
    })?;
    page.note.iter().for_each(|note| output::talk(note));
    Ok(page.html)
}

/// Suggests the next command, with the `--package` options of `packages`.
fn suggest_with(command: &str, packages: &PackageFolders) {
    suggest(&format!("{command}{}", packages.words()));
}

fn suggest(command: &str) {
    output::talk(&format!("next: sweetspot {command}"));
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or("cell".into(), |s| shown(&s.to_string_lossy()))
}
