//! `check`: validates a cell and everything it refers to.

use super::{UNSOLVED, suggest_with, warn_of_hopeless, workcell};
use crate::assess::Feasibility;
use crate::cell::{Cell, Operation};
use crate::cli::arguments::CheckArguments;
use crate::cli::imported_robot::{ImportQuery, import, is_importable};
use crate::cli::output::path_word;
use crate::cli::{Exit, cache, json_text, loading, output};
use crate::error_map::PostureOrder;
use crate::files::{Fault, shown};
use crate::layout::Workcell;
use crate::proof;
use crate::reach::Inverse;
use crate::record::{CHECK_SCHEMA, CheckDocument, OperationOrderEntry, OwnPairEntry, UrdfEntry};
use crate::report;
use crate::robot::Chain;

/// Runs `sweetspot check`.
pub fn check(a: &CheckArguments) -> Result<Exit, Exit> {
    if is_importable(&a.cell) {
        return check_robot(a);
    }
    if a.json {
        let (mut pairs, mut operations, mut urdf) = (Vec::new(), Vec::new(), None);
        let (exit, faults) = match loading::read_cell(&a.cell, &a.packages) {
            Ok(loaded) => {
                urdf = UrdfEntry::new(&loaded.cell.robot);
                match Workcell::remembering(loaded.cell, &mut cache::remember) {
                    Ok(workcell) => {
                        pairs = OwnPairEntry::all(&workcell);
                        operations = OperationOrderEntry::all(&workcell);
                        (Exit::Done, loaded.warnings)
                    }
                    Err(why) => {
                        let fault = Fault::of_file(&path_word(&a.cell), why, UNSOLVED);
                        (Exit::BadInput, [loaded.warnings, vec![fault]].concat())
                    }
                }
            }
            Err(faults) => (loading::exit_of(&faults), faults),
        };
        let valid = exit == Exit::Done;
        let schema = CHECK_SCHEMA.into();
        let document = CheckDocument { schema, valid, faults, self_collision: pairs, operations, urdf };
        json_text::print(&document)?;
        return Ok(exit);
    }
    let loaded = loading::load(&a.cell, &a.packages)?;
    let warnings = loaded.warnings.len();
    output::import_warnings(&loaded.warnings);
    // The D-H rows are printed even if no inverse kinematics solves the robot, because the rows show the
    // reason.
    output::data(&report::text::derived(&loaded.cell.robot))?;
    let workcell = workcell(loaded.cell, &a.cell)?;
    let cell = &workcell.cell;
    let free = cell.free().len();
    let judged = Feasibility::new(&workcell, &cell.start());
    let nodes: usize = cell.operations.iter().map(|o| o.nodes()).sum();
    output::data(&format!(
        "{}\n{}, {}, {} on {nodes} nodes, {}\n{}\n{}{}\n{}valid{}\n",
        report::text::headline(cell),
        counted(cell.robot.axes(), "axis", "axes"),
        counted(cell.equipment.len(), "piece of equipment or obstacle", "pieces of equipment and obstacles"),
        counted(cell.operations.len(), "operation", "operations"),
        counted(free, "search variable", "search variables"),
        error_sets(cell),
        report::text::self_collision_pairs(&workcell),
        posture_orders(&workcell),
        report::text::verdict("start", cell.unit(), judged.evaluation.objective, &judged.reasons),
        if warnings == 0 { String::new() } else { format!(", {}", counted(warnings, "warning", "warnings")) },
    ))?;
    warn_of_hopeless(&workcell);
    let next = if free > 0 { "search" } else { "map" };
    suggest_with(&format!("{next} {}", path_word(&a.cell)), &a.packages);
    Ok(Exit::Done)
}

/// Checks a URDF or xacro file, which describes a robot and not a cell.
fn check_robot(a: &CheckArguments) -> Result<Exit, Exit> {
    let imported = import(ImportQuery::new(&a.cell, &a.packages))?;
    let robot = &imported.loaded.robot;
    if a.json {
        let (schema, faults, urdf) = (CHECK_SCHEMA.into(), imported.warnings.clone(), UrdfEntry::new(robot));
        let empty = (Vec::new(), Vec::new());
        let document =
            CheckDocument { schema, valid: true, faults, self_collision: empty.0, operations: empty.1, urdf };
        json_text::print(&document)?;
        return Ok(Exit::Done);
    }
    imported.tell();
    let family = Inverse::new(&Chain::new(robot)).family();
    output::data(&format!(
        "{}{}, {}\ninverse kinematics: {family}\na robot, not a cell: valid\n",
        report::text::derived(robot),
        shown(&robot.name),
        counted(robot.axes(), "axis", "axes"),
    ))?;
    suggest_with(&format!("init {}", path_word(&a.cell)), &a.packages);
    Ok(Exit::Done)
}

/// Returns a line with the number of error sets, and the name, kind and reading of the chosen set.
fn error_sets(cell: &Cell) -> String {
    let kind = report::text::kind_of(cell.error_set());
    let sets = counted(cell.robot.errors.len(), "error set", "error sets");
    format!(
        "{sets}; chosen: {} ({kind}) with the reading {}",
        shown(cell.error_set().name()),
        cell.reading.name()
    )
}

/// Returns a line about the inverse kinematics, and a line per operation about the nodes and postures that a
/// search judges.
fn posture_orders(workcell: &Workcell) -> String {
    let operations = workcell.cell.operations.iter().zip(workcell.posture_orders()).enumerate();
    let line = |(k, (o, order)): (usize, (&Operation, PostureOrder))| {
        let (name, order_in_words) = (shown(&o.name), order.in_words());
        match proof::why_no_field(workcell, k) {
            None => format!(
                "\n{name}: a search first excludes nodes by a value field (a table of lower bounds), then {order_in_words}"
            ),
            Some(_) if order == PostureOrder::RankedNodes => {
                format!("\n{name}: a search {order_in_words}")
            }
            Some(why) => format!(
                "\n{name}: a search {order_in_words}; it uses no value field (a table of lower bounds), because {why}"
            ),
        }
    };
    let family = format!("\ninverse kinematics: {}", workcell.inverse().family());
    std::iter::once(family).chain(operations.map(line)).collect()
}

/// Returns a count with its noun in singular or plural.
fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}
