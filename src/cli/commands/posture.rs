//! `budget` and `explain`: the errors of one posture.

use super::{suggest_with, workcell};
use crate::assess::{BudgetReport, Explanation, NoPosture, NodeChoice, PostureContext};
use crate::cell::{Cell, JointKind, JointVector, MAX_JOINTS};
use crate::cli::arguments::{BudgetArguments, ExplainArguments, QuestionFlags};
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, asked, cache, json_text, lookup, output};
use crate::files::shown;
use crate::layout::Workcell;
use crate::record::{BudgetDocument, ExplanationDocument};
use crate::report;
use crate::units::{m_from_mm, rad_from_deg};

/// Runs `sweetspot budget`.
pub fn budget(a: &BudgetArguments) -> Result<Exit, Exit> {
    let loaded = asked::load(&a.cell, &a.packages, &a.question)?;
    let workcell = workcell(loaded.cell, &a.cell)?;
    let cell = &workcell.cell;
    let operations = match one_operation(cell, a.operation.as_deref(), a.at)? {
        Some(one) => vec![one],
        None => (0..cell.operations.len()).collect(),
    };
    let layout = cell.start();
    let maps = workcell.maps(&layout);
    let mut accounts = Vec::new();
    for k in operations {
        accounts.push(BudgetReport::new(
            PostureContext::at(&workcell, &layout, &maps, k, a.at).map_err(refused)?,
        ));
    }
    if a.json {
        json_text::print(&BudgetDocument::new(cell, &accounts))?;
    } else {
        let budgets: Vec<String> = accounts.iter().map(report::text::budget).collect();
        output::data(&format!("{}\n{}", report::text::headline(cell), budgets.join("\n")))?;
        let first = accounts.first().map(|account| &cell.operations[account.context.operation].name);
        let same = asked_again(first.map(String::as_str), a.at, &a.question);
        suggest_with(&format!("explain {}{same}", path_word(&a.cell)), &a.packages);
    }
    Ok(Exit::Done)
}

/// Runs `sweetspot explain`.
pub fn explain(a: &ExplainArguments) -> Result<Exit, Exit> {
    let loaded = asked::load(&a.cell, &a.packages, &a.question)?;
    let k = match one_operation(&loaded.cell, a.operation.as_deref(), a.at)? {
        Some(k) => k,
        None => {
            say_others(&loaded.cell);
            0
        }
    };
    if let Some(given) = &a.joints {
        let cell = loaded.cell;
        let joints = joints(&cell, given)?;
        let ready = Workcell::remembering(cell.clone(), &mut cache::remember);
        let context = PostureContext::of_joints(&cell, ready.as_ref().map_err(String::as_str), k, joints);
        let context = context.map_err(|why| {
            output::error(&why);
            output::talk("  help: choose another registration or another layout");
            Exit::BadInput
        })?;
        return told(a, &Explanation::new(context));
    }
    let workcell = workcell(loaded.cell, &a.cell)?;
    let layout = workcell.cell.start();
    let maps = workcell.maps(&layout);
    told(a, &Explanation::new(PostureContext::at(&workcell, &layout, &maps, k, a.at).map_err(refused)?))
}

fn told(a: &ExplainArguments, explanation: &Explanation<'_>) -> Result<Exit, Exit> {
    let cell = explanation.context.cell;
    for (row, joint) in explanation.rows.iter().zip(&cell.robot.joints) {
        if !row.allowed {
            output::talk(&format!("note: joint {} is outside its limits", shown(&joint.name)));
        }
    }
    if !explanation.trusted() {
        let model = cell.model.name();
        output::talk(&format!("warning: the {model} model cannot be trusted at this posture"));
    }
    if a.json {
        json_text::print(&ExplanationDocument::new(explanation))?;
        return Ok(Exit::Done);
    }
    let text = report::text::explanation(explanation);
    output::data(&format!("{}\n{text}", report::text::headline(cell)))?;
    let name = &cell.operations[explanation.context.operation].name;
    let file = path_word(&a.cell);
    match &a.joints {
        Some(joints) => {
            let joints: Vec<String> = joints.iter().map(f64::to_string).collect();
            let asked = a.question.words();
            let name = word(name);
            let same = format!("--operation {name} --joints={}{asked}", joints.join(","));
            suggest_with(&format!("explain {file} {same} --json"), &a.packages);
        }
        None => {
            let same = asked_again(Some(name), a.at, &a.question);
            suggest_with(&format!("budget {file}{same}"), &a.packages);
        }
    }
    Ok(Exit::Done)
}

/// Returns the operation with the given name, or the only operation.
///
/// Without a name, returns None if the cell has several operations. A node given by its indices is then
/// refused, because every operation has its own grid.
fn one_operation(cell: &Cell, name: Option<&str>, at: NodeChoice) -> Result<Option<usize>, Exit> {
    match (name, at) {
        (Some(name), _) => lookup::operation(cell, name).map(Some),
        (None, _) if cell.operations.len() == 1 => Ok(Some(0)),
        (None, NodeChoice::Best) => Ok(None),
        (None, NodeChoice::Node(..)) => {
            let names: Vec<String> = cell.operations.iter().map(|o| shown(&o.name)).collect();
            output::error("--at is ambiguous: the cell has several operations");
            output::talk(&format!("  help: add --operation and one of: {}", names.join(", ")));
            Err(Exit::BadInput)
        }
    }
}

/// Prints the names of the operations that are not explained.
fn say_others(cell: &Cell) {
    let names: Vec<String> = cell.operations.iter().map(|o| shown(&o.name)).collect();
    if let [first, others @ ..] = &names[..] {
        output::talk(&format!(
            "note: showing {first}; choose another with --operation: {}",
            others.join(", ")
        ));
    }
}

fn refused(why: NoPosture) -> Exit {
    match why {
        NoPosture::Outside(why) => {
            output::error(&why);
            Exit::BadInput
        }
        NoPosture::Unusable(why) => {
            output::error(&why);
            Exit::AnswerIsNo
        }
    }
}

/// Converts joint values from degrees or mm to SI.
fn joints(cell: &Cell, given: &[f64]) -> Result<JointVector, Exit> {
    if given.len() != cell.robot.axes() {
        let (has, axes) = (given.len(), cell.robot.axes());
        output::error(&format!("--joints has {has} values, but the robot has {axes} joints"));
        return Err(Exit::BadInput);
    }
    let mut joints = [0.0; MAX_JOINTS];
    for ((q, joint), given) in joints.iter_mut().zip(&cell.robot.joints).zip(given) {
        *q = if joint.kind == JointKind::Revolute { rad_from_deg(*given) } else { m_from_mm(*given) };
    }
    Ok(joints)
}

/// Returns operation, node and flags as arguments for another command.
fn asked_again(operation: Option<&str>, at: NodeChoice, flags: &QuestionFlags) -> String {
    let operation = operation.map_or(String::new(), |name| format!(" --operation {}", word(name)));
    let at = match at {
        NodeChoice::Best => String::new(),
        NodeChoice::Node(i, j) => format!(" --at {i},{j}"),
    };
    operation + &at + &flags.words()
}
