//! The sections with pictures: what each shows, section by section.

use super::content::{Figure, NOTHING, Section, Table};
use super::places::titled;
use super::subject::{Alternative, Found, Subject};
use super::verdict::{down, quantity};
use crate::cell::{Goal, shown};
use crate::compare::{Account, Asked, Assessment, At, Reachable, Stance};
use crate::reading::Share;
use crate::report::{envelope, fig8, goals, names, svg, text};
use crate::units::{percent_from_share, rounded};

/// All of them in the order of the page; those with nothing to show are left out.
pub fn sections(subject: &Subject<'_>) -> Vec<Section> {
    let all = [
        map(subject),
        envelopes(subject),
        budget(subject),
        discrepancies(subject),
        convergence(subject),
        pareto(subject),
        misplacement(subject),
    ];
    all.into_iter().filter(|section| !section.is_empty()).collect()
}

/// The picture that stands in for the 3-D view: in print, and without WebGL.
pub fn still(a: &Assessment<'_>) -> Figure {
    Figure::new(
        titled(a, "plan"),
        "World plan, x to the right; the ring marks the chosen spot.",
        svg::plan(a),
    )
}

fn map(subject: &Subject<'_>) -> Section {
    let text = "Every node of the work surfaces: colour and arrow tell the error there, rings the nodes that \
                cannot be reached, crosses those that collide. Point at a node for its value or its reason.";
    let mut section = Section::new("map", "Error map", vec![text.into()]);
    let caption = "Nodes coloured by their error, arrows enlarged as said in the legend.";
    section.figures =
        subject.layouts().map(|a| Figure::new(titled(a, "error map"), caption, svg::plan(a))).collect();
    section
}

/// Operations of one height and attitude share a picture.
fn envelopes(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "Where the arm can hold its tool as the operation asks, joint limits kept: a section through the \
                base axis and a plan at the height of the operation, in the frame of the robot base.";
    let mut section = Section::new("envelope", "Working envelope", vec![text.into()]);
    for (k, operation) in a.cell.operations.iter().enumerate() {
        let (at, base) = (&a.layout.placements[operation.equipment], &a.layout.base);
        let asked = Asked {
            operation: Some(operation),
            attitude: a.layout.attitudes[k].clone(),
            yaw: at.yaw - base.yaw,
            heights: vec![at.z + operation.standoff - base.z],
            step: None,
        };
        let reachable = Reachable::new(&a.cell.robot, a.workcell.inverse(), asked, &|_, _| ());
        let title = titled(a, &format!("envelope at the height of {}", shown(&operation.name)));
        section.figures.push(Figure::new(title, "", envelope::picture(&reachable)));
    }
    section
}

/// Parameters told of each spot.
const TOLD: usize = 12;

fn budget(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "Which parameter of the arm adds how much at the spot: the first lines are the ones to tighten. \
                Shares of the worst case and of the variance add up to 100 % each.";
    let mut section = Section::new("budget", "Error budget", vec![text.into()]);
    section.tables = (0..a.maps.len()).filter_map(|k| budget_table(a, k)).collect();
    section
}

fn budget_table(a: &Assessment<'_>, k: usize) -> Option<Table> {
    let account = Account::new(Stance::at(a.workcell, &a.layout, &a.maps, k, At::Best).ok()?);
    let unit = account.stance.gauge.sense.unit;
    let row = |share: &Share| {
        let own = names::unit(a.cell, share.parameter);
        let percent = |share: f64| format!("{:.1}", rounded(percent_from_share(share), 1));
        vec![
            names::parameter(a.cell, share.parameter),
            format!("{} {}", rounded(own.from_si(share.plus_minus), 6), own.word()),
            format!("{:.4}", rounded(unit.from_si(share.alone), 4)),
            percent(share.of_worst),
            percent(share.of_variance),
        ]
    };
    let rows: Vec<_> = account.budget.shares.iter().take(TOLD).map(row).collect();
    let alone = format!("alone {}", unit.word());
    let head = ["parameter", "plus or minus", &alone, "of worst case %", "of variance %"];
    let left = account.budget.shares.len().saturating_sub(TOLD);
    let more = if left > 0 { format!("and {left} parameters more with less. ") } else { String::new() };
    let cut = account.tighter.first().map_or(String::new(), |t| {
        let name = names::parameter(a.cell, t.parameters[0]);
        let percent = rounded(percent_from_share(account.cut(t)), 1);
        let unit = account.unit();
        format!(
            "Half the tolerance of {name} takes {percent:.1} % off: from {} to {}.",
            quantity(unit, account.figure),
            quantity(unit, t.figure)
        )
    });
    let name = shown(&a.cell.operations[k].name);
    Some(Table::new(titled(a, &name), &head, rows).with_note(more + &cut))
}

fn discrepancies(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "How far the linear model of the error is from the nonlinear one, node by node: the claim of the \
                seed paper is less than 1 % (its Fig. 8).";
    let mut section = Section::new("discrepancy", "Linear against nonlinear model", vec![text.into()]);
    section.figures.push(Figure::new(titled(a, "discrepancy"), "", fig8::chart(a)));
    section
}

/// How the search came to its answer.
fn convergence(subject: &Subject<'_>) -> Section {
    let mut section = Section::new("convergence", "How the search converged", Vec::new());
    let Some(found) = &subject.found else { return section };
    let unit = subject.cell().unit();
    section.text.push(format!(
        "{} layouts were evaluated, {} of them feasible. {}",
        found.evaluations,
        found.feasible,
        bound_in_words(found, subject)
    ));
    let row = |(n, value): &(u64, f64)| vec![n.to_string(), format!("{:.6}", rounded(*value, 6))];
    let rows: Vec<_> = found.trace.iter().map(row).collect();
    if !rows.is_empty() {
        section.tables.push(
            Table::new("Improvements", &["evaluations", &format!("best so far {}", unit.word())], rows)
                .folded(),
        );
    }
    section
}

fn bound_in_words(found: &Found, subject: &Subject<'_>) -> String {
    let unit = subject.cell().unit();
    match found.bound {
        Some(bound) => format!("It is proven that none of them has less than {}.", down(unit, bound)),
        None => "There is no proven bound.".into(),
    }
}

/// The layouts beside the best.
fn pareto(subject: &Subject<'_>) -> Section {
    let mut section = Section::new("front", "Other layouts", Vec::new());
    let Some(found) = &subject.found else { return section };
    let all: Vec<&Alternative> = found.front.iter().flatten().collect();
    if all.is_empty() {
        return section;
    }
    section.text.push(match &found.pareto {
        Some(goals) => format!(
            "None of these layouts is better than another in all of {}: choosing one is choosing what to give up.",
            goals.iter().map(|g| shown(g)).collect::<Vec<_>>().join(", ")
        ),
        None => "The best layouts that really differ. Each is a cell file in the folder of the search.".into(),
    });
    let heads: Vec<String> = Goal::ALL.into_iter().map(|goal| goals::head(subject.cell(), goal)).collect();
    let head: Vec<&str> = ["file"].into_iter().chain(heads.iter().map(String::as_str)).collect();
    let row = |a: &&Alternative| {
        let value = |goal: Goal| a.goals.get(goals::key(goal)).and_then(|v| v.as_f64());
        let told = |goal| value(goal).map_or(NOTHING.into(), |v| format!("{:.4}", rounded(v, 4)));
        std::iter::once(shown(&a.file)).chain(Goal::ALL.map(told)).collect()
    };
    section.tables.push(Table::new("", &head, all.iter().map(row).collect()));
    section
}

/// What misplaced equipment does to the spots.
fn misplacement(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "How much each operation suffers if things do not stand exactly where they are drawn, the spot and \
                the posture of the arm kept.";
    let mut section = Section::new("misplacement", "Sensitivity to misplacement", vec![text.into()]);
    let rows = (0..a.maps.len()).flat_map(|k| {
        let Some(Some(r)) = a.robustness.get(k) else { return Vec::new() };
        let name = shown(&a.cell.operations[k].name);
        text::robust_lines(a.cell, k, r).into_iter().map(|line| vec![name.clone(), line]).collect()
    });
    let rows: Vec<_> = rows.collect();
    if !rows.is_empty() {
        section.tables.push(Table::new(titled(a, "misplaced"), &["operation", "what it does"], rows));
    }
    section
}
