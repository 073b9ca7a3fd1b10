//! Text of the remedies for the measured errors of a robot, side by side.

use super::fixed;
use super::table::TextTable;
use crate::files::shown;
use crate::record::{RemediesDocument, RemedyEntry, remedy_name};

/// Returns one column for each remedy, and the advice.
pub fn remedies(document: &RemediesDocument) -> String {
    let columns = &document.remedies;
    let number = |value: Option<f64>| value.map_or("-".into(), |value| fixed(value, 4));
    let mut table = TextTable::new(2);
    table.labelled("", "", columns.iter().map(|c| remedy_name(c.remedy).to_string()));
    let row = |table: &mut TextTable, group: &str, label: &str, of: &dyn Fn(&RemedyEntry) -> String| {
        table.labelled(group, label, columns.iter().map(of));
    };
    let moved: Vec<_> = columns.iter().flat_map(|c| c.layout.keys()).collect();
    let mut names: Vec<&String> = Vec::new();
    moved.into_iter().for_each(|name| {
        if !names.contains(&name) {
            names.push(name)
        }
    });
    for name in names {
        let is_fixed =
            columns.iter().all(|c| c.layout.get(name) == columns.first().and_then(|f| f.layout.get(name)));
        if is_fixed {
            continue;
        }
        row(&mut table, &shown(name), "x, y, z mm", &|c| {
            c.layout
                .get(name)
                .map_or("-".into(), |at| [at.x_mm, at.y_mm, at.z_mm].map(|mm| fixed(mm, 0)).join(", "))
        });
        row(&mut table, "", "yaw deg", &|c| c.layout.get(name).map_or("-".into(), |at| fixed(at.yaw_deg, 1)));
    }
    if columns.iter().any(|c| Some(c.base) != columns.first().map(|f| f.base)) {
        row(&mut table, "robot base", "x, y, z mm", &|c| {
            [c.base.x_mm, c.base.y_mm, c.base.z_mm].map(|mm| fixed(mm, 0)).join(", ")
        });
        row(&mut table, "", "yaw deg", &|c| fixed(c.base.yaw_deg, 1));
    }
    let (word, unit) = (&document.quantity, document.unit.word());
    let count = columns.first().map_or(0, |c| c.operations.len());
    for k in 0..count {
        let operation = |c: &RemedyEntry| c.operations.get(k).cloned();
        let name = columns.first().and_then(operation).map_or(String::new(), |o| shown(&o.name));
        let label = format!("{word} at its best spot {unit}");
        row(&mut table, &name, label.trim_end(), &|c| number(operation(c).and_then(|o| o.value)));
        if columns.iter().any(|c| operation(c).is_some_and(|o| o.requirement.is_some())) {
            row(&mut table, "", "limit", &|c| match operation(c).and_then(|o| o.requirement) {
                Some(r) => format!("{} {}", fixed(r.limit, 4), if r.met { "met" } else { "MISSED" }),
                None => "-".into(),
            });
        }
    }
    row(&mut table, "total", &format!("objective {unit}"), &|c| number(c.objective));
    row(&mut table, "", "reduction %", &|c| c.gain_percent.map_or("-".into(), |gain| fixed(gain, 1)));
    let mut out = format!(
        "{}: {}, errors {}: calibrate, move, or both\n\n{}",
        shown(&document.cell),
        shown(&document.robot),
        shown(&document.errors),
        table.render()
    );
    for column in columns.iter().filter(|c| !c.feasible) {
        out += &format!("{}: not feasible: {}\n", remedy_name(column.remedy), column.reasons.join("; "));
    }
    out + &format!(
        "\n{}\n{} layouts evaluated, seed {}\n",
        document.advice, document.evaluations, document.seed
    )
}
