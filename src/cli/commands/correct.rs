//! `correct`: finds the joint and pose commands with which a robot with known errors lands on its targets.

use super::measurements::text;
use super::{suggest_with, workcell};
use crate::assess::{CorrectedTarget, NodeChoice, OperationCorrector, StatedTarget};
use crate::cell::{Cell, ErrorSet};
use crate::cli::arguments::{CorrectArguments, TargetFrame};
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, asked, json_text, lookup, output, results_folder};
use crate::error_map::OperationMap;
use crate::files::{shown, targets};
use crate::layout::Workcell;
use crate::pose::Pose;
use crate::record::{CorrectionDocument, CorrectionEntry, CorrectionState};
use crate::report;
use crate::units::{m_from_mm, rad_from_deg};
use nalgebra::Vector3;
use std::path::Path;

/// Runs `sweetspot correct`.
pub fn correct(a: &CorrectArguments) -> Result<Exit, Exit> {
    let file = if a.of.is_dir() { results_folder::best_of(&a.of)? } else { a.of.clone() };
    let loaded = asked::load(&file, &a.packages, &a.question)?;
    let operation = a.operation.as_deref().map(|name| lookup::operation(&loaded.cell, name)).transpose()?;
    let workcell = workcell(loaded.cell, &file)?;
    let cell = &workcell.cell;
    let targets = match &a.targets {
        Some(path) => of_table(a, path, &workcell, operation.unwrap_or(0))?,
        None => of_maps(a, &workcell, operation)?,
    };
    let document = CorrectionDocument::new(cell, targets);
    if a.json {
        json_text::print(&document)?;
    } else if a.csv {
        let bytes = report::correction::csv(&document).map_err(|why| {
            output::error(&format!("cannot write the CSV: {why}"));
            Exit::Io
        })?;
        output::data(&String::from_utf8_lossy(&bytes))?;
    } else {
        output::data(&format!("{}\n{}", report::text::headline(cell), report::text::correction(&document)))?;
    }
    say_picks(cell);
    let all = document.targets.iter().all(|target| target.state == CorrectionState::Corrected);
    if !a.json && !a.csv {
        let name = a.operation.as_ref().map_or(String::new(), |name| format!(" --operation {}", word(name)));
        let nodes = if a.nodes { " --nodes" } else { "" };
        let table =
            a.targets.as_ref().map_or(String::new(), |path| format!(" --targets {}", path_word(path)));
        let (of, flags) = (path_word(&a.of), a.question.words());
        suggest_with(&format!("correct {of}{name}{nodes}{table}{flags} --csv"), &a.packages);
    }
    Ok(if all { Exit::Done } else { Exit::AnswerIsNo })
}

/// Prints a note on each operation that is relative to a pick operation, because the pick is not corrected.
fn say_picks(cell: &Cell) {
    for operation in cell.operations.iter().filter(|operation| operation.relative_to.is_some()) {
        let name = shown(&operation.name);
        output::talk(&format!(
            "note: the correction of {name} does not include its pick operation: correct the pick, too"
        ));
    }
}

/// Returns the corrector of the errors of an operation. Refuses a set of tolerances, because the signs of its
/// errors are unknown. Also refuses errors that are all 0.
fn corrector<'w>(workcell: &'w Workcell, operation: usize) -> Result<OperationCorrector<'w>, Exit> {
    OperationCorrector::new(workcell, operation).ok_or_else(|| {
        let cell = &workcell.cell;
        let set = cell.error_set();
        let name = shown(set.name());
        output::error(&match set {
            ErrorSet::Tolerance(_) => format!(
                "the error set `{name}` is a tolerance: it does not state the signs of the errors of this \
                 robot, so nothing can be corrected"
            ),
            _ => format!("the errors of the set `{name}` are 0: there is nothing to correct"),
        });
        let signed = cell.robot.errors.iter().filter(|set| matches!(set, ErrorSet::Signed(_)));
        let signed: Vec<_> = signed.map(|set| shown(set.name())).collect();
        let choose = match signed.is_empty() {
            true => String::new(),
            false => format!("choose a signed set with --errors ({}), or ", signed.join(", ")),
        };
        output::talk(&format!("  help: {choose}measure the robot: sweetspot calibrate ROBOT DATA --toml"));
        Exit::BadInput
    })
}

/// Corrects the spots of the operations, or all their usable nodes.
fn of_maps(
    a: &CorrectArguments,
    workcell: &Workcell,
    operation: Option<usize>,
) -> Result<Vec<CorrectionEntry>, Exit> {
    let cell = &workcell.cell;
    let operations = operation.map_or_else(|| (0..cell.operations.len()).collect(), |k| vec![k]);
    let correctors = operations.iter().map(|k| corrector(workcell, *k)).collect::<Result<Vec<_>, _>>()?;
    let maps = workcell.maps(&cell.start());
    let mut entries = Vec::new();
    for (k, corrector) in operations.into_iter().zip(&correctors) {
        let map = &maps[k];
        if a.nodes || cell.operations[k].over.needs_every_node() {
            let usable = map.usable().map(|(_, node, _)| (node.i, node.j, node.position));
            entries.extend(usable.map(|(i, j, position)| {
                let found = corrector.node(&maps, NodeChoice::Node(i, j));
                CorrectionEntry::new(cell, k, (None, Some((i, j))), Some(position), &found)
            }));
        } else {
            entries.push(spot(cell, k, map, &corrector.node(&maps, NodeChoice::Best)));
        }
    }
    if entries.is_empty() {
        output::error("no node can be used, so there is nothing to correct");
        output::talk("  help: sweetspot map shows why");
        return Err(Exit::AnswerIsNo);
    }
    Ok(entries)
}

fn spot(
    cell: &Cell,
    operation: usize,
    map: &OperationMap,
    found: &Result<CorrectedTarget, String>,
) -> CorrectionEntry {
    let node = map.best_node();
    let indices = node.map(|node| (node.i, node.j));
    CorrectionEntry::new(cell, operation, (None, indices), node.map(|node| node.position), found)
}

/// Corrects the targets of a table with the attitude and the surface of an operation.
fn of_table(
    a: &CorrectArguments,
    path: &Path,
    workcell: &Workcell,
    operation: usize,
) -> Result<Vec<CorrectionEntry>, Exit> {
    let cell = &workcell.cell;
    let rows = targets::read(&path_word(path), &text(path)?).map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })?;
    let corrector = corrector(workcell, operation)?;
    if a.operation.is_none() && cell.operations.len() > 1 {
        let name = shown(&cell.operations[operation].name);
        output::talk(&format!(
            "note: attitude and surface come from the operation {name}; choose another with --operation"
        ));
    }
    output::talk("note: collisions are not checked for the targets of a table");
    let context = corrector.context().map_err(|why| {
        output::error(&why);
        Exit::BadInput
    })?;
    let layout = cell.start();
    let (base, surface) =
        (layout.base.pose(), layout.placements[cell.operations[operation].equipment].pose());
    let to_base = match a.frame {
        TargetFrame::World => base.inverse(),
        TargetFrame::Surface => base.inverse() * surface,
        TargetFrame::Base => Pose::identity(),
    };
    let entries = rows.into_iter().map(|row| {
        let vector = |values: [f64; 3], convert: fn(f64) -> f64| Vector3::from(values.map(convert));
        let position = vector(row.position_mm, m_from_mm);
        let angles = row.rotation_deg.map(|angles| vector(angles, rad_from_deg));
        let pose = Pose::from_translation_rpy(position, angles.unwrap_or_default());
        let Pose { rotation, translation } = to_base * pose;
        let stated =
            StatedTarget { name: row.name, position: translation, rotation: angles.map(|_| rotation) };
        let found = corrector.target(&stated, &context);
        let world = base.transform(&translation);
        CorrectionEntry::new(cell, operation, (Some(stated.name), None), Some(world), &found)
    });
    Ok(entries.collect())
}
