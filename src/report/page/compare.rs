//! Page that compares layouts side by side.

use super::content::{NOTHING, PageFigure, PageTable, Section};
use super::{assets, places, script_json, shell};
use crate::assess::{Assessment, Comparison};
use crate::cell::{Goal, Goals};
use crate::drawing::Drawing;
use crate::files::shown;
use crate::raster;
use crate::raster::Shot;
use crate::record::goals;
use crate::report::{chart, text};
use crate::units::rounded;
use serde::Serialize;

/// Facts about a layout from the search that found it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SearchFacts {
    pub gap_percent: Option<f64>,
    /// Clearance that the layout has according to search.json, mm. The clearance is the least distance
    /// between robot and other objects or between two floor spaces.
    pub clearance_mm: Option<f64>,
}

/// Values that fill the template of the comparison.
#[derive(Serialize)]
struct ComparePage<'a> {
    title: String,
    question: String,
    answer: String,
    sentences: Vec<String>,
    policy: String,
    style: &'a str,
    script: &'a str,
    /// Still picture of each layout.
    stills: Vec<PageFigure>,
    /// JSON for the viewers.
    drawings: String,
    sections: Vec<Section>,
    version: &'static str,
}

/// Returns the HTML of the comparison. Each column of the comparison has a drawing in `drawings`, and facts
/// from its search in `told`.
///
/// # Errors
/// Fails if there is no layout or a part cannot be rendered.
pub fn compare(
    comparison: &Comparison<'_>,
    drawings: &[Drawing<'_>],
    told: &[SearchFacts],
) -> Result<String, String> {
    let Some(first) = comparison.columns.first() else { return Err("there is nothing to compare".into()) };
    let (script, css) = (assets::viewer_js() + assets::COMPARE_JS, super::report::style());
    let style = css + assets::COMPARE_CSS;
    let mut stills = Vec::new();
    for (a, drawing) in comparison.columns.iter().zip(drawings) {
        let context = (0..a.maps.len()).find(|k| a.spot(*k).is_some());
        let shot = Shot { context, width: 900, height: 640, ..Shot::default() };
        let svg = raster::isometric(drawing, &shot)?;
        stills.push(PageFigure::new(shown(&drawing.name), "", svg));
    }
    let mut sections = differences(comparison);
    sections.push(side_by_side(comparison, told));
    sections.push(places::of_columns(&comparison.columns));
    let pictures = stills.iter_mut().chain(sections.iter_mut().flat_map(|s| &mut s.figures));
    pictures.enumerate().for_each(|(k, figure)| figure.svg = shell::scoped(&figure.svg, k));
    let names: Vec<String> = comparison.columns.iter().map(|c| shown(&c.label)).collect();
    let page = ComparePage {
        title: names.join(" and "),
        question: text::headline(first.cell),
        answer: answer(comparison),
        sentences: comparison.in_words(),
        policy: shell::policy(&script, &style),
        style: &style,
        script: &script,
        stills,
        drawings: script_json(&crate::report::json::drawings(drawings)),
        sections,
        version: env!("CARGO_PKG_VERSION"),
    };
    shell::rendered(assets::COMPARE_HTML, &page)
}

/// Returns the sentence that names the layout with the least objective.
fn answer(comparison: &Comparison<'_>) -> String {
    let told = |a: &Assessment<'_>| Some((a.objective()?, shown(&a.label), a.cell.unit().word()));
    let mut all: Vec<_> = comparison.columns.iter().filter_map(told).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    match &all[..] {
        [] => "None of these layouts is feasible".into(),
        [(value, name, unit)] => format!("Only {name} is feasible: {value:.3} {unit}"),
        [(value, name, unit), (next, other, _), ..] => {
            if *next - *value <= 1e-9 * next.abs() {
                return format!("{name} and {other} are equally good: {value:.3} {unit}");
            }
            format!("{name} is best with {value:.3} {unit}, then {other} with {next:.3} {unit}")
        }
    }
}

/// Returns the section on the differences from the first layout, node by node. All charts of the section
/// share one colour scale.
fn differences(comparison: &Comparison<'_>) -> Vec<Section> {
    let Some((first, others)) = comparison.columns.split_first() else { return Vec::new() };
    let text = format!(
        "Difference of every node from {}: blue where the other layout is better, orange where it is worse. Point at \
         a node to see both values.",
        shown(&first.label)
    );
    let mut section = Section::new("differences", "Node by node", vec![text]);
    let all: Vec<_> = (1..comparison.columns.len()).map(|k| comparison.differences(k)).collect();
    let most = all.iter().flatten().flatten().map(|d| d.largest()).fold(0.0, f64::max);
    for (other, found) in others.iter().zip(&all) {
        match found {
            Err(why) => section.text.push(format!("There is no map of differences: {}.", shown(why))),
            Ok(found) => section.figures.extend(found.iter().map(|d| {
                let names = (first.label.as_str(), other.label.as_str());
                let name = shown(&first.cell.operations[d.operation].name);
                let title = format!("{name}: {} against {}", shown(names.1), shown(names.0));
                PageFigure::new(title, "", chart::difference(first.cell, d, names, most))
            })),
        }
    }
    vec![section]
}

/// Returns the section with the comparison table that the terminal shows. Further rows show requirement,
/// clearance and gap to the proven bound.
fn side_by_side(comparison: &Comparison<'_>, told: &[SearchFacts]) -> Section {
    let text = vec![
        "Lengths are in mm and angles in degrees. Parentheses give the change from the first layout. Clearance is the \
         least distance between the robot at the spots and other objects, or between two floor spaces. The robot \
         includes the part that it holds. A clearance above 500 mm is shown as 500 mm."
            .to_string(),
    ];
    let mut section = Section::new("table", "In numbers", text);
    let table = text::comparison_table(comparison);
    let Some((head, rows)) = table.rows().split_first() else { return section };
    let mut rows = rows.to_vec();
    let mut row = |label: &str, cell: &dyn Fn(usize) -> String| {
        let cells = (0..comparison.columns.len()).map(cell);
        rows.push([label.to_string(), String::new()].into_iter().chain(cells).collect());
    };
    let requirement = |k: usize| match &comparison.columns[k] {
        a if (0..a.maps.len()).all(|o| a.requirement(o).is_none()) => "none".to_string(),
        a if a.meets_requirements() => "met".to_string(),
        _ => "MISSED".to_string(),
    };
    row("requirement", &requirement);
    let told = |k: usize| told.get(k).copied().unwrap_or_default();
    let clearance = |k: usize| {
        let value = told(k).clearance_mm.or_else(|| clearance(&comparison.columns[k]));
        value.map_or(NOTHING.to_string(), |v| format!("{:.1}", rounded(v, 1)))
    };
    row("clearance mm", &clearance);
    let gap = |k: usize| told(k).gap_percent.map_or(NOTHING.to_string(), text::gap);
    row("proven gap", &gap);
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let mut table = PageTable::new("", &head, rows);
    table.is_number = (0..head.len()).map(|k| k > 1).collect();
    section.tables.push(table);
    section
}

/// Returns the clearance of a layout as a search measures it, mm; None if the layout is not feasible.
fn clearance(a: &Assessment<'_>) -> Option<f64> {
    let all = a.workcell.goals(&a.layout, &a.evaluation, &Goals::of(&[Goal::Clearance])?)?;
    Some(goals::value(a.cell, Goal::Clearance, *all.first()?))
}
