//! `allocate`: finds the cheapest tolerances with which every operation stays within its limit.

use super::{suggest_with, workcell};
use crate::assess::{AllocatedNodes, CellAllocation, NoAllocation, NodeChoice};
use crate::cell::{Cell, Interpretation, Reading};
use crate::cli::arguments::AllocateArguments;
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, asked, json_text, loading, lookup, output, results_folder};
use crate::record::{AllocationDocument, AllocationStatus};
use crate::report;

/// Runs `sweetspot allocate`.
pub fn allocate(a: &AllocateArguments) -> Result<Exit, Exit> {
    let file = if a.of.is_dir() { results_folder::best_of(&a.of)? } else { a.of.clone() };
    let loaded = asked::load(&file, &a.packages, &a.question)?;
    let workcell = workcell(toleranced(loaded.cell, a)?, &file)?;
    let cell = &workcell.cell;
    let only = a.operation.as_deref().map(|name| lookup::operation(cell, name)).transpose()?;
    let nodes = match a.at {
        _ if a.nodes => AllocatedNodes::Usable,
        _ if a.cheapest => AllocatedNodes::Cheapest,
        NodeChoice::Best => AllocatedNodes::Spots,
        NodeChoice::Node(i, j) => AllocatedNodes::Node(i, j),
    };
    let layout = cell.start();
    let maps = workcell.maps(&layout);
    let problem = CellAllocation::new(&workcell, &layout, &maps, (only, nodes), a.share);
    let problem = problem.map_err(refused)?;
    let found = match problem.solve() {
        Ok(found) => Ok(found),
        Err(NoAllocation::Infeasible(shortfalls)) => Err(shortfalls),
        Err(why) => return Err(refused(why)),
    };
    let document = AllocationDocument::new(&problem, found.as_ref().map_err(Vec::as_slice));
    if let Some(path) = &a.svg {
        loading::write_output(path, report::chart::allocation(&document).as_bytes())?;
        output::talk(&format!("wrote {}", path_word(path)));
    }
    if a.json {
        json_text::print(&document)?;
    } else if let (true, Ok(found)) = (a.toml, &found) {
        let scales = &found.found.allocation.scales;
        output::data(&report::allocated_table::tables(&problem, scales, &document))?;
    } else {
        output::data(&format!("{}\n{}", report::text::headline(cell), report::text::allocation(&document)))?;
    }
    let is_kept = document.status == AllocationStatus::Cheapest;
    if !a.json {
        suggest_with(&next(a, is_kept), &a.packages);
    }
    Ok(if is_kept { Exit::Done } else { Exit::AnswerIsNo })
}

/// Returns the cell with its errors read as tolerances. The worst-case reading replaces the signed
/// reading.
fn toleranced(cell: Cell, a: &AllocateArguments) -> Result<Cell, Exit> {
    if cell.reading != Reading::Signed {
        return Ok(cell);
    }
    if a.question.reading.is_some() {
        output::error("a signed sample has no tolerances to allocate");
        output::talk("  help: add --reading worst-case or --reading statistical");
        return Err(Exit::BadInput);
    }
    output::talk(
        "note: the errors are interpreted as worst-case tolerances (--reading statistical interprets them as random)",
    );
    let interpretation = Interpretation { reading: Reading::WorstCase, ..cell.interpretation() };
    cell.with_interpretation(&interpretation).map_err(|faults| {
        for fault in faults {
            output::error(&fault.message);
            output::talk(&format!("  help: {}", fault.help));
        }
        Exit::BadInput
    })
}

/// Prints why there is no allocation, and returns the exit code.
fn refused(why: NoAllocation) -> Exit {
    match why {
        NoAllocation::Question { why, help } => {
            output::error(&format!("nothing to allocate: {why}"));
            output::talk(&format!("  help: {help}"));
            Exit::BadInput
        }
        NoAllocation::Unusable(why) => {
            output::error(&why);
            Exit::AnswerIsNo
        }
        NoAllocation::NotSolved | NoAllocation::Infeasible(_) => {
            output::error("the optimization of the tolerances (a cone program) has failed");
            output::talk("  help: narrow `scale_range` in the entries of `cost` in the error set");
            Exit::AnswerIsNo
        }
    }
}

/// Returns the command to run next.
fn next(a: &AllocateArguments, is_kept: bool) -> String {
    let of = path_word(&a.of);
    let operation = a.operation.as_ref().map_or(String::new(), |name| format!(" --operation {}", word(name)));
    let at = match a.at {
        NodeChoice::Best => String::new(),
        NodeChoice::Node(i, j) => format!(" --at {i},{j}"),
    };
    let nodes = match (a.nodes, a.cheapest) {
        (true, _) => " --nodes",
        (_, true) => " --cheapest",
        _ => "",
    };
    let flags = a.question.words();
    match (is_kept, a.toml) {
        (true, false) => format!("allocate {of}{operation}{at}{nodes}{flags} --toml"),
        (true, true) => {
            let file = if a.of.is_dir() { path_word(&a.of.join("best.toml")) } else { of };
            format!("check {file}, with these tables in copies of this file and of the files that it names")
        }
        (false, _) => format!("budget {of}{operation}{at}{flags}"),
    }
}
