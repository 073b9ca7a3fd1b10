//! `budget` and `explain`: one posture.

use super::{suggest, workcell};
use crate::assess::{Account, At, Explanation, NoStance, Stance};
use crate::cell::{Cell, JointKind, JointVector, MAX_JOINTS};
use crate::cli::arguments::{BudgetArguments, ExplainArguments, Overrides};
use crate::cli::output::{path_word, word};
use crate::cli::overrides;
use crate::cli::overrides::overridden;
use crate::cli::{Exit, cache, loading, output, results};
use crate::files::shown;
use crate::layout::Workcell;
use crate::record::{BudgetDocument, ExplanationDocument};
use crate::report;
use crate::units::{m_from_mm, rad_from_deg};

/// `sweetspot budget`
pub fn budget(a: &BudgetArguments) -> Result<Exit, Exit> {
    let loaded = overridden(loading::load(&a.cell, &a.packages)?, &a.overrides)?;
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
        accounts.push(Account::new(Stance::at(&workcell, &layout, &maps, k, a.at).map_err(refused)?));
    }
    if a.json {
        output::data(&results::line(&BudgetDocument::new(cell, &accounts))?)?;
    } else {
        let budgets: Vec<String> = accounts.iter().map(report::text::budget).collect();
        output::data(&format!("{}\n{}", report::text::headline(cell), budgets.join("\n")))?;
        let first = accounts.first().map(|account| &cell.operations[account.stance.operation].name);
        let same = asked_again(first.map(String::as_str), a.at, &a.overrides);
        suggest(&format!("explain {}{same}", path_word(&a.cell)));
    }
    Ok(Exit::Done)
}

/// `sweetspot explain`
pub fn explain(a: &ExplainArguments) -> Result<Exit, Exit> {
    let loaded = overridden(loading::load(&a.cell, &a.packages)?, &a.overrides)?;
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
        let stance = Stance::of_joints(&cell, ready.as_ref().map_err(String::as_str), k, joints);
        let stance = stance.map_err(|why| {
            output::error(&why);
            output::talk("  help: choose another registration, or another layout");
            Exit::BadInput
        })?;
        return told(a, &Explanation::new(stance));
    }
    let workcell = workcell(loaded.cell, &a.cell)?;
    let layout = workcell.cell.start();
    let maps = workcell.maps(&layout);
    told(a, &Explanation::new(Stance::at(&workcell, &layout, &maps, k, a.at).map_err(refused)?))
}

fn told(a: &ExplainArguments, explanation: &Explanation<'_>) -> Result<Exit, Exit> {
    let cell = explanation.stance.cell;
    for (row, joint) in explanation.rows.iter().zip(&cell.robot.joints) {
        if !row.allowed {
            output::talk(&format!("note: joint {} is beyond its limits", shown(&joint.name)));
        }
    }
    if !explanation.trusted() {
        let model = cell.model.name();
        output::talk(&format!("warning: do NOT trust the {model} model at this posture"));
    }
    if a.json {
        output::data(&results::line(&ExplanationDocument::new(explanation))?)?;
        return Ok(Exit::Done);
    }
    let text = report::text::explanation(explanation);
    output::data(&format!("{}\n{text}", report::text::headline(cell)))?;
    let name = &cell.operations[explanation.stance.operation].name;
    let file = path_word(&a.cell);
    match &a.joints {
        Some(joints) => {
            let joints: Vec<String> = joints.iter().map(f64::to_string).collect();
            let asked = overrides::again(&a.overrides);
            let name = word(name);
            let same = format!("--operation {name} --joints={}{asked}", joints.join(","));
            suggest(&format!("explain {file} {same} --json"));
        }
        None => suggest(&format!("budget {file}{}", asked_again(Some(name), a.at, &a.overrides))),
    }
    Ok(Exit::Done)
}

/// The operation that was named, or the only one; a node is one of an operation's own.
fn one_operation(cell: &Cell, name: Option<&str>, at: At) -> Result<Option<usize>, Exit> {
    match (name, at) {
        (Some(name), _) => overrides::operation(cell, name).map(Some),
        (None, _) if cell.operations.len() == 1 => Ok(Some(0)),
        (None, At::Best) => Ok(None),
        (None, At::Node(..)) => {
            let names: Vec<String> = cell.operations.iter().map(|o| shown(&o.name)).collect();
            output::error("--at names a node of one operation, and the cell has several");
            output::talk(&format!("  help: add --operation with one of: {}", names.join(", ")));
            Err(Exit::BadInput)
        }
    }
}

/// Which operations are not explained.
fn say_others(cell: &Cell) {
    let names: Vec<String> = cell.operations.iter().map(|o| shown(&o.name)).collect();
    if let [first, others @ ..] = &names[..] {
        output::talk(&format!("note: this is {first}; with --operation also: {}", others.join(", ")));
    }
}

fn refused(why: NoStance) -> Exit {
    match why {
        NoStance::Outside(why) => {
            output::error(&why);
            Exit::BadInput
        }
        NoStance::Unusable(why) => {
            output::error(&why);
            Exit::AnswerIsNo
        }
    }
}

/// Joints as given, in degrees or mm, in SI.
fn joints(cell: &Cell, given: &[f64]) -> Result<JointVector, Exit> {
    if given.len() != cell.robot.axes() {
        let (has, axes) = (given.len(), cell.robot.axes());
        output::error(&format!("--joints has {has} numbers, the robot has {axes} joints"));
        return Err(Exit::BadInput);
    }
    let mut joints = [0.0; MAX_JOINTS];
    for ((q, joint), given) in joints.iter_mut().zip(&cell.robot.joints).zip(given) {
        *q = if joint.kind == JointKind::Revolute { rad_from_deg(*given) } else { m_from_mm(*given) };
    }
    Ok(joints)
}

/// The same question, for another command.
fn asked_again(operation: Option<&str>, at: At, asked: &Overrides) -> String {
    let operation = operation.map_or(String::new(), |name| format!(" --operation {}", word(name)));
    let at = match at {
        At::Best => String::new(),
        At::Node(i, j) => format!(" --at {i},{j}"),
    };
    operation + &at + &overrides::again(asked)
}
