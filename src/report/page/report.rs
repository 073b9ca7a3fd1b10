//! The report page.

use super::content::{PageFigure, Section};
use super::subject::Subject;
use super::verdict::verdict;
use super::{assets, assumptions, figures, measured, nodes, places, readings, script_json, shell};
use crate::cell::Cell;
use crate::drawing::Drawing;
use crate::files::shown;
use crate::record::VerdictDocument;
use crate::report::chart;
use crate::report::text::headline;
use serde::Serialize;

/// HTML page of a report with its verdict.
pub struct Report {
    pub html: String,
    pub verdict: VerdictDocument,
}

/// Values that fill the template of the report.
#[derive(Serialize)]
struct ReportPage<'a> {
    title: String,
    question: String,
    policy: String,
    style: &'a str,
    script: &'a str,
    verdict: &'a VerdictDocument,
    still: Vec<PageFigure>,
    /// JSON for the viewer.
    drawings: String,
    sections: Vec<Section>,
    version: &'static str,
}

/// Returns the report. `drawings` has one entry per layout; the first layout is the layout of the cell file.
///
/// # Errors
/// Fails if a part cannot be rendered.
pub fn report(subject: &Subject<'_>, drawings: &[Drawing<'_>]) -> Result<Report, String> {
    let verdict = verdict(subject);
    let (script, style) = (assets::viewer_js() + assets::REPORT_JS, style());
    let mut sections = sections(subject, drawings);
    let mut still = figures::still(subject.shown(), drawings)?;
    let pictures = still.iter_mut().chain(sections.iter_mut().flat_map(|s| &mut s.figures));
    pictures.enumerate().for_each(|(k, figure)| figure.svg = shell::scoped(&figure.svg, k));
    let page = ReportPage {
        title: shown(&subject.cell().name),
        question: question(subject.cell()),
        policy: shell::policy(&script, &style),
        style: &style,
        script: &script,
        verdict: &verdict,
        still,
        drawings: script_json(&crate::report::json::drawings(drawings)),
        sections,
        version: env!("CARGO_PKG_VERSION"),
    };
    let html = shell::rendered(assets::REPORT_HTML, &page)?;
    Ok(Report { html, verdict })
}

/// Returns the sections below the verdict. `drawings` has one entry per layout; the first layout is the
/// layout of the cell file.
pub fn sections(subject: &Subject<'_>, drawings: &[Drawing<'_>]) -> Vec<Section> {
    let mut sections = figures::sections(subject, drawings);
    let measured = measured::section(subject);
    if !measured.is_empty() {
        sections.insert(1.min(sections.len()), measured);
    }
    sections.push(places::section(subject));
    sections.push(places::joints(subject));
    sections.push(readings::section(subject));
    sections.push(nodes::section(subject));
    sections.push(assumptions::section(subject));
    sections.push(assumptions::manifest(subject));
    sections
}

/// Returns robot, error set, model, reading and registration in words. The name of the cell is left out,
/// because the heading of the page contains this name.
fn question(cell: &Cell) -> String {
    let line = headline(cell);
    line.strip_prefix(&format!("{}: ", cell.name)).map(str::to_string).unwrap_or(line)
}

/// Returns the style of the report. Charts have a dark background on a dark screen, but never on paper.
pub fn style() -> String {
    let dark = chart::dark_rules(".plate");
    format!("{}\n@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n", assets::REPORT_CSS)
}
