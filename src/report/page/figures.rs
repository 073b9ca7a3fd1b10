//! Sections with pictures.

use super::allocated;
use super::content::{PageFigure, PageTable, Section};
use super::cycle;
use super::places::titled;
use super::quantities::{down, quantity};
use super::subject::{Subject, si};
use crate::assess::{Assessment, BudgetReport, ErrorDistribution, NodeChoice, PostureContext};
use crate::cell::{Goal, Model, NO_TOLERANCES, Reading};
use crate::drawing::Drawing;
use crate::files::shown;
use crate::raster;
use crate::raster::Shot;
use crate::reading::Share;
use crate::record::{AlternativeEntry, ParameterUnit, SearchResult, goals, parameter_names as names};
use crate::report::chart;
use crate::report::chart::ConvergenceHistory;
use crate::report::text;
use crate::search;
use crate::search::{EvaluatedLayout, SearchEnd, SearchRecord};
use crate::units::{percent_from_share, rounded};

/// Returns the sections with pictures in the order of the page. Empty sections are left out. `drawings` has
/// one entry per layout of [`Subject::layouts`].
pub fn sections(subject: &Subject<'_>, drawings: &[Drawing<'_>]) -> Vec<Section> {
    let all = [
        map(subject, drawings),
        envelopes(subject, drawings),
        budget(subject),
        allocated::section(subject),
        discrepancies(subject),
        distributions(subject),
        convergence(subject),
        cycle::section(subject),
        pareto(subject),
        misplacement(subject),
    ];
    all.into_iter().filter(|section| !section.is_empty()).collect()
}

/// Returns the still picture for print and for browsers without WebGL. The picture shows the recommended
/// layout, the last of `drawings`.
///
/// # Errors
/// Fails if the picture cannot be drawn.
pub fn still(a: &Assessment<'_>, drawings: &[Drawing<'_>]) -> Result<Vec<PageFigure>, String> {
    let Some(drawing) = drawings.last() else { return Ok(Vec::new()) };
    let context = (0..a.maps.len()).find(|k| a.spot(*k).is_some());
    let svg = raster::isometric(drawing, &Shot { context, width: 1200, height: 800, ..Shot::default() })?;
    let caption = "Arrows show the errors, enlarged by the factor in the legend. The legend explains the symbols of \
                   unusable nodes. The large ring marks the chosen spot.";
    Ok(vec![PageFigure::new(titled(a, "the cell"), caption, svg)])
}

fn map(subject: &Subject<'_>, drawings: &[Drawing<'_>]) -> Section {
    let text = "The maps show the error over every work surface in the sense and reading of the cell, with iso-lines. All \
                maps share one colour scale.";
    let mut section = Section::new("map", "Error map", vec![text.into()]);
    section.hint = "Point at a node to see its value, or the reason why it cannot be used.";
    let ranges = drawings.iter().flat_map(|d| &d.fields).filter_map(|field| field.range(0, field.sense));
    let Some(range) = ranges.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b))) else { return section };
    // The recommended layout comes first.
    for (a, drawing) in subject.layouts().zip(drawings).collect::<Vec<_>>().into_iter().rev() {
        for (k, field) in drawing.fields.iter().enumerate() {
            let caption = match field.every {
                1 => String::new(),
                every => format!("Along each axis, one in {every} nodes is drawn."),
            };
            let title = titled(a, &shown(&a.cell.operations[field.operation].name));
            section.figures.push(PageFigure::new(
                title,
                caption,
                chart::heat_map(drawing, k, 0, field.sense, range),
            ));
        }
    }
    section
}

fn envelopes(subject: &Subject<'_>, drawings: &[Drawing<'_>]) -> Section {
    let (a, Some(drawing)) = (subject.shown(), drawings.last()) else {
        return Section::new("envelope", "Working envelope", Vec::new());
    };
    let text = "The envelope is the region in which the arm can hold its tool in the orientation of the operation, within \
                the joint limits. It is drawn from above at the height of the operation, and from the side.";
    let mut section = Section::new("envelope", "Working envelope", vec![text.into()]);
    for (k, operation) in a.cell.operations.iter().enumerate() {
        let name = shown(&operation.name);
        let figure = |what: &str, svg| PageFigure::new(titled(a, &format!("{name}, {what}")), "", svg);
        section.figures.push(figure("from above", chart::layout_plan(a, drawing, k)));
        section.figures.push(figure("from the side", chart::layout_section(a, drawing, k)));
    }
    section
}

/// Largest number of parameters in the budget table of a spot.
const MAX_PARAMETERS_SHOWN: usize = 12;

fn budget(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = match a.cell.errors_compensate() && a.cell.reading == Reading::Signed {
        true => "The budget lists the contribution of every parameter to the error at the spot.",
        false => {
            "The budget lists the contribution of every parameter to the error at the spot. Tighten the tolerances of the first parameters \
             first. The shares of the worst case add up to 100 %, and so do the shares of the variance."
        }
    };
    let mut section = Section::new("budget", "Error budget", vec![text.into()]);
    for k in 0..a.maps.len() {
        let Ok(context) = PostureContext::at(a.workcell, &a.layout, &a.maps, k, NodeChoice::Best) else {
            continue;
        };
        let account = BudgetReport::new(context);
        let title = titled(a, &shown(&a.cell.operations[k].name));
        if account.worst.is_some() {
            section.figures.push(PageFigure::new(title, "", chart::tornado(&account)));
        }
        section.tables.push(budget_table(a, k, &account).folded());
    }
    section
}

fn budget_table(a: &Assessment<'_>, k: usize, account: &BudgetReport<'_>) -> PageTable {
    let unit = account.context.evaluator.sense.unit;
    let row = |share: &Share| {
        let own = ParameterUnit::new(a.cell, share.parameter);
        let percent = |share: f64| match account.worst {
            Some(_) => format!("{:.1}", rounded(percent_from_share(share), 1)),
            None => "–".into(),
        };
        vec![
            names::parameter(a.cell, share.parameter),
            format!("{} {}", rounded(own.from_si(share.plus_minus), 6), own.word()),
            format!("{:.4}", rounded(unit.from_si(share.alone), 4)),
            percent(share.of_worst),
            percent(share.of_variance),
        ]
    };
    let rows: Vec<_> = account.budget.shares.iter().take(MAX_PARAMETERS_SHOWN).map(row).collect();
    let alone = format!("alone {}", unit.word());
    let head = ["parameter", "plus or minus", &alone, "share of worst case %", "share of variance %"];
    let left = account.budget.shares.len().saturating_sub(MAX_PARAMETERS_SHOWN);
    let more = if left > 0 { format!("{left} more parameters contribute less. ") } else { String::new() };
    let unknown = || match account.worst {
        Some(_) => String::new(),
        None => format!("There are no shares: {NO_TOLERANCES}."),
    };
    let cut = account.tighter.first().map_or_else(unknown, |t| {
        let name = names::parameter(a.cell, t.parameters[0]);
        let percent = rounded(percent_from_share(account.cut(t)), 1);
        let unit = account.unit();
        format!(
            "Halving the tolerance of {name} lowers the combined effect of all parameters from {} to {} ({percent:.1} % \
             less).",
            quantity(unit, account.figure),
            quantity(unit, t.figure)
        )
    });
    let name = shown(&a.cell.operations[k].name);
    PageTable::new(titled(a, &format!("{name} in numbers")), &head, rows).with_note(more + &cut)
}

/// Returns the section on the linearized model. The section is empty if [`rests_on_linearized`] returns false
/// for the recommended layout.
fn discrepancies(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "The chart shows how far the linearized error model deviates from the nonlinear model, \
                node by node. The seed paper claims less than 1 % (its Fig. 8).";
    let mut section = Section::new("discrepancy", "Linearized and nonlinear model", vec![text.into()]);
    if rests_on_linearized(a) {
        section.figures.push(PageFigure::new(titled(a, "discrepancy"), "", chart::discrepancy(a)));
    }
    section
}

/// Returns whether numbers of a layout may depend on the linearized model. This is true if the cell chooses
/// the linear or the second-order model. Under a worst-case or statistical reading, it is also true if the
/// discrepancy exceeds the guard at a usable node.
fn rests_on_linearized(a: &Assessment<'_>) -> bool {
    let differs = || a.maps.iter().any(|map| map.off(Model::Linear, a.cell.guard).1 > 0);
    a.cell.model != Model::Nonlinear || (a.cell.reading != Reading::Signed && differs())
}

/// Returns the section on the error distribution of arms that are built within the tolerances.
fn distributions(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "A Monte Carlo simulation samples arms whose errors have the distributions of the tolerances. The nonlinear model gives the \
                error of each arm; the chart shows the distribution of these errors at the spot.";
    let mut section = Section::new("distribution", "Distribution at the spots", vec![text.into()]);
    for k in 0..a.maps.len() {
        let name = shown(&a.cell.operations[k].name);
        match ErrorDistribution::at_spot(a, k) {
            Ok(d) => {
                section.figures.push(PageFigure::new(titled(a, &name), "", chart::histogram(a.cell, &d)))
            }
            Err(why) => section.text.push(format!("{name}: {why}.")),
        }
    }
    section
}

/// Returns the section on the convergence of the search.
fn convergence(subject: &Subject<'_>) -> Section {
    let mut section = Section::new("convergence", "How the search converged", Vec::new());
    let Some(found) = &subject.found else { return section };
    let unit = subject.cell().unit();
    section.text.push(format!(
        "{} layouts were evaluated; {} of them are feasible and within every limit. {}",
        found.evaluations,
        found.feasible,
        bound_in_words(found, subject)
    ));
    let row = |(n, value): &(u64, f64)| vec![n.to_string(), format!("{:.6}", rounded(*value, 6))];
    // The table has only the first and the last improvements; the chart shows all improvements.
    let skipped = found.trace.len().saturating_sub(MAX_IMPROVEMENTS);
    let kept = found.trace.iter().enumerate().filter(|(k, _)| *k == 0 || *k > skipped);
    let rows: Vec<_> = kept.map(|(_, improvement)| row(improvement)).collect();
    if !rows.is_empty() {
        let trace: Vec<(u64, f64)> = found.trace.iter().map(|(n, value)| (*n, si(unit, *value))).collect();
        let (start, bound) = (subject.start.evaluation.objective, found.bound.map(|b| si(unit, b)));
        let course = ConvergenceHistory { trace: &trace, evaluations: found.evaluations, start, bound, unit };
        section.figures.push(PageFigure::new("Convergence", "", chart::convergence(&course)));
        section.tables.push(
            PageTable::new("Improvements", &["evaluations", &format!("best so far {}", unit.word())], rows)
                .with_note(match skipped {
                    0 => String::new(),
                    _ => format!("The table leaves out {skipped} improvements directly after the first. search.json contains all improvements."),
                })
                .folded(),
        );
    }
    section
}

/// Largest number of rows in the table of improvements.
const MAX_IMPROVEMENTS: usize = 12;

fn bound_in_words(found: &SearchResult, subject: &Subject<'_>) -> String {
    let unit = subject.cell().unit();
    match found.bound {
        Some(bound) => {
            format!(
                "It is proven that no layout within the ranges has an objective below {}.",
                down(unit, bound)
            )
        }
        None => "There is no proven bound.".into(),
    }
}

/// Returns the section on the kept layouts: a Pareto front or a shortlist.
fn pareto(subject: &Subject<'_>) -> Section {
    let mut section = Section::new("front", "Other layouts", Vec::new());
    let Some(found) = &subject.found else { return section };
    let all: Vec<&AlternativeEntry> = found.front.iter().flatten().collect();
    if all.is_empty() {
        return section;
    }
    section.text.push(match &found.pareto {
        Some(goals) => format!(
            "Pareto front: none of these layouts is better than another in all of {}.",
            goals.iter().map(|g| g.name()).collect::<Vec<_>>().join(", ")
        ),
        None => {
            "These are the best layouts that clearly differ from each other. Each is a cell file in the folder of the search.".into()
        }
    });
    let heads: Vec<String> =
        subject.cell().measured_goals().map(|goal| goals::head(subject.cell(), goal)).collect();
    let head: Vec<&str> = ["file"].into_iter().chain(heads.iter().map(String::as_str)).collect();
    let row = |a: &&AlternativeEntry| {
        let told = |goal| format!("{:.4}", rounded(a.goals.get(goal), 4));
        std::iter::once(shown(&a.file)).chain(subject.cell().measured_goals().map(told)).collect()
    };
    section.tables.push(PageTable::new("", &head, all.iter().map(row).collect()));
    let picture = chart::pareto(subject.cell(), &record(subject, found));
    section.figures.extend(
        picture.map(|svg| PageFigure::new("Front", "Numbers refer to the layout files in the table.", svg)),
    );
    section
}

/// Returns a search record with the data that the picture of the front needs.
fn record(subject: &Subject<'_>, found: &SearchResult) -> SearchRecord {
    let cell = subject.cell();
    let candidate =
        |a: &Assessment<'_>| EvaluatedLayout { layout: a.layout.clone(), evaluation: a.evaluation.clone() };
    let of = |a: &AlternativeEntry| {
        let goals = Goal::ALL.map(|goal| goals::si(cell, goal, a.goals.get(goal))).to_vec();
        search::Alternative { candidate: candidate(subject.shown()), goals }
    };
    SearchRecord {
        start: candidate(&subject.start),
        best: candidate(subject.shown()),
        least: None,
        evaluations: found.evaluations,
        feasible: found.feasible,
        trace: Vec::new(),
        bound: None,
        ended: SearchEnd::Done,
        alternatives: found.front.iter().flatten().map(of).collect(),
    }
}

/// Returns the section on misplaced equipment.
fn misplacement(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "The error of each operation changes if equipment does not stand exactly at its placement. \
                The spot and the posture branch do not change.";
    let mut section = Section::new("misplacement", "Sensitivity to misplacement", vec![text.into()]);
    let rows = (0..a.maps.len()).flat_map(|k| {
        let Some(Some(r)) = a.robustness.get(k) else { return Vec::new() };
        let title = titled(a, &shown(&a.cell.operations[k].name));
        section.figures.push(PageFigure::new(title, "", chart::misplacement(a.cell, k, r)));
        let name = shown(&a.cell.operations[k].name);
        text::robust_lines(a.cell, k, r).into_iter().map(|line| vec![name.clone(), line]).collect()
    });
    let rows: Vec<_> = rows.collect();
    if !rows.is_empty() {
        section.tables.push(PageTable::new(titled(a, "misplacement"), &["operation", "effect"], rows));
    }
    section
}
