//! Text of the results for the layout of the cell file under every reading and registration.

use super::table::TextTable;
use super::{amount, fixed, mm1, percent1};
use crate::assess::{ReadingRow, Readings};
use crate::cell::{ErrorSet, Registration};
use crate::files::shown;
use crate::kinematic_error::NEGLIGIBLE;
use std::fmt::Write;

/// Returns one table per operation, then the findings.
pub fn readings(r: &Readings<'_>) -> String {
    let mut out = String::new();
    for (operation, rows) in r.cell.operations.iter().zip(&r.operations) {
        let surface = shown(&r.cell.equipment[operation.equipment].name);
        let _ = writeln!(
            out,
            "{} on {surface}, in {}, {} model:",
            shown(&operation.name),
            operation.sense.name,
            r.cell.model.name()
        );
        out.push_str(&table(rows));
        let mut missing: Vec<&String> = rows.iter().filter_map(|r| r.choice.as_ref().err()).collect();
        missing.dedup();
        missing.iter().for_each(|why| {
            let _ = writeln!(out, "  {why}");
        });
        out.push('\n');
    }
    findings(r).iter().for_each(|finding| {
        let _ = writeln!(out, "{finding}");
    });
    out
}

fn table(rows: &[ReadingRow]) -> String {
    let mut table = TextTable::indented(3);
    table.row([
        "reading",
        "quantity",
        "registration",
        "node",
        "x, y, z mm",
        "value",
        "at signed spot",
        "ratio",
        "moved mm",
    ]);
    let none = || "-".to_string();
    for row in rows {
        let value = |v: f64| amount(row.unit, v);
        let choice = row.choice.as_ref().ok();
        let place = |c: &crate::assess::ReadingChoice| {
            let p = c.position;
            format!("{}, {}, {}", mm1(p.x), mm1(p.y), mm1(p.z))
        };
        table.row([
            row.reading.name().to_string(),
            row.quantity_name().to_string(),
            row.registration.name().to_string(),
            choice.map_or_else(none, |c| format!("({}, {})", c.node.0, c.node.1)),
            choice.map_or_else(none, place),
            choice.map_or_else(none, |c| value(c.value)),
            row.at_signed.map_or_else(none, value),
            row.ratio().map_or_else(none, |r| fixed(r, 3)),
            choice.and_then(|c| c.moved).map_or_else(none, mm1),
        ]);
    }
    table.render()
}

/// Returns sentences on the regret of the signed sample and on the effect of the registration.
pub fn findings(r: &Readings<'_>) -> Vec<String> {
    regret(r).into_iter().chain(registered(r)).collect()
}

/// Describes the regret of choosing the spot by the signed sample. The regret is the value of that spot under
/// another reading, divided by the least value under that reading.
fn regret(r: &Readings<'_>) -> Vec<String> {
    if matches!(r.cell.error_set(), ErrorSet::Tolerance(_)) {
        return vec![format!(
            "{} is a set of tolerances without a signed sample, so no spot can be chosen by a signed sample",
            shown(r.cell.error_set().name())
        )];
    }
    let Some((k, row, ratio)) = r.largest_regret() else { return Vec::new() };
    if ratio < 1.0 + 5e-4 {
        return vec![
            "the spot chosen by the signed sample is as good as the best spot under every other reading"
                .into(),
        ];
    }
    vec![format!(
        "choosing the spot by the signed sample gives at worst {} times the least possible value of the {} ({}, {})",
        fixed(ratio, 2),
        row.quantity_name(),
        shown(&r.cell.operations[k].name),
        match row.registration {
            Registration::None => "no registration".to_string(),
            other => format!("registration {}", other.name()),
        }
    )]
}

/// Describes how registration changes the worst case at the spot that is best without registration.
fn registered(r: &Readings<'_>) -> Vec<String> {
    let mut said = Vec::new();
    for (k, operation) in r.cell.operations.iter().enumerate() {
        let plain = r.worst_case(k, Registration::None).and_then(|row| row.choice.as_ref().ok());
        let Some(plain) = plain.filter(|c| c.value > NEGLIGIBLE) else { continue };
        let unit = operation.sense.unit;
        for (what, registration) in
            [("best-fitting the base", Registration::BestFit), ("teaching the surface", Registration::Taught)]
        {
            let Some(row) = r.worst_case(k, registration) else { continue };
            let Some(after) = row.at_unregistered else { continue };
            let change = after / plain.value - 1.0;
            said.push(format!(
                "{what} frame {} the worst case of {} at node ({}, {}) by {}, from {} to {} {}",
                if change > 0.0 { "raises" } else { "cuts" },
                shown(&operation.name),
                plain.node.0,
                plain.node.1,
                percent1(change.abs()),
                fixed(unit.from_si(plain.value), 4),
                fixed(unit.from_si(after), 4),
                unit.word()
            ));
        }
    }
    said
}
