//! Section with the numbers of every node.

use super::content::{NOTHING, PageTable, Section, plain};
use super::places::mm;
use super::subject::Subject;
use crate::assess::Assessment;
use crate::cell::Unit;
use crate::error_map::{NodeRecord, OperationMap};
use crate::files::shown;
use crate::record::value_word;
use crate::units::{mm_from_m, percent_from_share, rounded};

/// Limit of the number of nodes of all operations together. Up to this limit, the tables list every node.
/// Above this limit, each table lists only the best nodes of its operation.
const MAX_ROWS: usize = 2000;
/// Number of nodes in a table that lists only its best nodes.
const BEST_ROWS: usize = 200;

/// Returns one table per operation of the recommended layout.
pub fn section(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let which = if subject.best.is_some() { "the best layout" } else { "the layout as drawn" };
    let text = vec![format!(
        "This section lists the nodes of {which}. Positions and errors are in world axes. Joints, all readings and the nodes of the other layouts are \
         in {}.",
        plain(&subject.manifest.csv)
    )];
    let mut section = Section::new("nodes", "Every node", text);
    let all: usize = a.maps.iter().map(|m| m.nodes.len()).sum();
    section.tables = a.maps.iter().map(|map| table(a, map, all > MAX_ROWS, &subject.manifest.csv)).collect();
    section
}

fn table(a: &Assessment<'_>, map: &OperationMap, is_long: bool, csv: &str) -> PageTable {
    let operation = &a.cell.operations[map.operation];
    let (unit, name) = (a.cell.unit(), shown(&operation.name));
    let value = format!("{} in {} {}", value_word(a.cell), shown(&operation.sense.name), told_unit(unit));
    let head = [
        "i",
        "j",
        "x mm",
        "y mm",
        "z mm",
        value.as_str(),
        "error x mm",
        "error y mm",
        "error z mm",
        "status",
    ];
    let mut nodes: Vec<&NodeRecord> = map.nodes.iter().collect();
    if is_long {
        let value = |n: &NodeRecord| n.usable_posture().map_or(f64::INFINITY, |p| p.value);
        nodes.sort_by(|a, b| value(a).total_cmp(&value(b)));
        nodes.truncate(BEST_ROWS);
    }
    let rows: Vec<_> = nodes.iter().map(|n| row(a, n)).collect();
    let table = PageTable::new(format!("{name}: {} nodes", map.nodes.len()), &head, rows).folded();
    match is_long {
        true => table.with_note(format!(
            "These are the best {BEST_ROWS} of {} nodes; all nodes are in {}.",
            map.nodes.len(),
            plain(csv)
        )),
        false => table,
    }
}

fn told_unit(unit: Unit) -> &'static str {
    if unit == Unit::Share { "%" } else { unit.word() }
}

fn row(a: &Assessment<'_>, node: &NodeRecord) -> Vec<String> {
    let mut row = vec![node.i.to_string(), node.j.to_string()];
    row.extend([0, 1, 2].map(|axis| mm(node.position[axis])));
    match node.usable_posture() {
        Some(p) => {
            let value = match a.cell.unit() {
                Unit::Share => percent_from_share(p.value),
                unit => unit.from_si(p.value),
            };
            row.push(format!("{:.4}", rounded(value, 4)));
            row.extend([0, 1, 2].map(|axis| format!("{:.4}", rounded(mm_from_m(p.error[axis]), 4))));
            row.push("usable".into());
        }
        None => {
            row.extend(std::iter::repeat_n(NOTHING.to_string(), 4));
            row.push(node.status.reason(a.cell));
        }
    }
    row
}
