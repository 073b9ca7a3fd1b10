//! The spots under every reading, and the number of nodes of each kind (usable, out of reach, ...).

use super::content::{PageTable, Section};
use super::places::titled;
use super::subject::Subject;
use crate::assess::Assessment;
use crate::cell::{ErrorSet, Sense};
use crate::error_map::NodeSign;
use crate::files::shown;
use crate::reading::Figures;
use crate::units::rounded;

/// Returns the section on the spots under every reading.
pub fn section(subject: &Subject<'_>) -> Section {
    let text = vec![
        "The table shows the spots under every reading: the signed sample, the worst case of the tolerance box, and \
         statistics over arms built to the tolerances. The sense of the operation itself is marked as own."
            .to_string(),
    ];
    let mut section = Section::new("readings", "The spots under every reading", text);
    section.tables = subject.tables(|a| vec![figures(a), counts(a)]);
    section
}

/// Functions that return the error figures of a table row, one per column.
const COLUMNS: [fn(&Figures) -> f64; 6] =
    [|f| f.error, |f| f.worst, |f| f.rms, |f| f.mean, |f| f.p95, |f| f.p99];

fn figures(a: &Assessment<'_>) -> PageTable {
    let sample = match a.cell.error_set() {
        ErrorSet::Signed(_) | ErrorSet::Measured(_) => "signed sample",
        ErrorSet::Tolerance(_) => "worst corner",
    };
    let mut rows = Vec::new();
    for (k, map) in a.maps.iter().enumerate() {
        let operation = &a.cell.operations[map.operation];
        for sense in &map.senses {
            let Some(f) = a.figures(k, &sense.name) else { continue };
            let asked = if sense.name == operation.sense.name { "own" } else { "" };
            let mut row =
                vec![shown(&operation.name), shown(&sense.name), asked.into(), sense.unit.word().into()];
            row.extend(COLUMNS.iter().enumerate().map(|(column, figure)| {
                // Column 0 shows the error of the sample itself.
                if column > 0 && a.cell.errors_compensate() { "–".into() } else { number(sense, figure(f)) }
            }));
            rows.push(row);
        }
    }
    let head = ["operation", "sense", "", "unit", sample, "worst case", "rms", "mean", "p95", "p99"];
    let note = match a.cell.errors_compensate() {
        true => "The errors of the sample compensate each other in one calibrated arm. As \
        tolerances, they would exceed the length of the arm, so neither a worst case nor statistics exist."
            .into(),
        false => spread(a),
    };
    PageTable::new(titled(a, "errors at the spots"), &head, rows).with_note(note)
}

fn number(sense: &Sense, si: f64) -> String {
    format!("{:.4}", rounded(sense.unit.from_si(si), 4))
}

/// Returns the note that states whether Monte Carlo samples confirm the first-order figures.
fn spread(a: &Assessment<'_>) -> String {
    let said = (0..a.maps.len()).filter_map(|k| {
        let samples = a.samples[k].as_ref()?;
        let (name, unit) = (shown(&a.cell.operations[k].name), a.cell.operations[k].sense.unit);
        let holds = match a.first_order_holds(k)? {
            true => "the first-order figures hold",
            false => "the first-order figures do NOT hold: the figures of the samples are shown",
        };
        let [p95, low, high] = [samples.p95.value, samples.p95.low, samples.p95.high].map(|v| unit.from_si(v));
        Some(format!(
            "{name}: {} samples of the nonlinear model give p95 {p95:.4} {} ({low:.4} to {high:.4}): {holds}.",
            samples.samples,
            unit.word()
        ))
    });
    said.collect::<Vec<_>>().join(" ")
}

fn counts(a: &Assessment<'_>) -> PageTable {
    let occurs = |sign: &NodeSign| a.maps.iter().any(|m| m.count(*sign) > 0);
    let signs: Vec<NodeSign> = NodeSign::ALL.into_iter().filter(occurs).collect();
    let mut head = vec!["operation", "nodes"];
    head.extend(signs.iter().map(|sign| sign.label()));
    let row = |map: &crate::error_map::OperationMap| {
        let mut row = vec![shown(&a.cell.operations[map.operation].name), map.nodes.len().to_string()];
        row.extend(signs.iter().map(|sign| map.count(*sign).to_string()));
        row
    };
    PageTable::new(titled(a, "nodes"), &head, a.maps.iter().map(row).collect())
}
