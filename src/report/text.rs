//! What a person reads in the terminal.

use crate::cell::{Cell, ErrorSet, Model, Quantity, Reading, Registration, Spread, Unit};
use crate::compare::{Assessment, Comparison};
use crate::error_map::{OperationMap, Status};
use crate::kinematic_error::{Discrepancy, discrepancy};
use crate::reading::{Estimate, Figures};
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rounded};
use std::fmt::Write;

/// Cell, robot, error set, model, reading and registration in one line.
pub fn headline(cell: &Cell) -> String {
    let reading = match cell.reading {
        Reading::Signed => String::new(),
        reading => format!(", {} reading", reading.name()),
    };
    let registration = match cell.registration {
        Registration::None => String::new(),
        Registration::BestFit => ", base frame best-fitted".into(),
        Registration::Taught => ", surface frames taught".into(),
    };
    format!(
        "{}: {}, errors {}, {} model{reading}{registration}",
        cell.name,
        cell.robot.name,
        cell.error_set().name(),
        cell.model.name()
    )
}

/// What must be said about how the errors are read; empty if nothing.
pub fn caveats(cell: &Cell) -> Vec<String> {
    let mut said = Vec::new();
    let signed = matches!(cell.error_set(), ErrorSet::Signed(_));
    if signed && cell.reading != Reading::Signed {
        said.push(format!(
            "{} is a signed sample: its magnitudes are read as plus-or-minus ({} sigma of a normal)",
            cell.error_set().name(),
            Spread::SIGMAS
        ));
    }
    let signs = |e: &crate::cell::Equipment| e.errors.is_some_and(|errors| errors.signed().is_none());
    let operated = cell.operations.iter().map(|o| &cell.equipment[o.equipment]);
    if cell.reading == Reading::Signed
        && cell.registration != Registration::Taught
        && operated.clone().any(signs)
    {
        said.push("tolerances of equipment have no signs: the signed reading leaves them out".into());
    }
    said
}

/// What the numbers of a map are: "error", "worst case", "p95" ...
pub fn value_word(cell: &Cell) -> &'static str {
    match (cell.reading, cell.quantity) {
        (Reading::Signed, _) => "error",
        (Reading::WorstCase, _) => "worst case",
        (Reading::Statistical, Quantity::Yield) => "share of failures",
        (Reading::Statistical, quantity) => quantity.name(),
    }
}

/// What can be the matter with a node, in words.
const STATUSES: [(&str, &str); 5] = [
    ("ok", "ok"),
    ("collision", "colliding"),
    ("joint-limit", "beyond a joint limit"),
    ("out-of-reach", "out of reach"),
    ("unjudged", "that cannot be judged"),
];

/// Rows of a side-by-side table: a group, a label, one cell per layout.
struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    fn row(&mut self, group: &str, label: &str, cells: impl Iterator<Item = String>) {
        let mut row = vec![group.to_string(), label.to_string()];
        row.extend(cells);
        self.rows.push(row);
    }

    /// Columns as wide as their widest cell; text left, numbers right.
    fn render(&self) -> String {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let cell_width = |row: &Vec<String>, k: usize| row.get(k).map_or(0, |c| c.chars().count());
        let widths: Vec<usize> =
            (0..columns).map(|k| self.rows.iter().map(|r| cell_width(r, k)).max().unwrap_or(0)).collect();
        let mut out = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for (k, cell) in row.iter().enumerate() {
                let width = widths[k];
                let _ =
                    if k < 2 { write!(line, "{cell:<width$}  ") } else { write!(line, "{cell:>width$}   ") };
            }
            let _ = writeln!(out, "{}", line.trim_end());
        }
        out
    }
}

/// Layouts side by side.
pub fn comparison(comparison: &Comparison<'_>) -> String {
    let mut table = Table { rows: Vec::new() };
    let columns = &comparison.columns;
    table.row("", "", columns.iter().map(|c| c.label.clone()));
    for name in comparison.equipment() {
        placement_rows(&mut table, name, columns);
    }
    if let Some(first) = columns.first() {
        for k in 0..first.cell.operations.len() {
            operation_rows(&mut table, k, comparison);
        }
    }
    let objective = |a: &Assessment<'_>| a.objective();
    let cells = (0..columns.len()).map(|c| with_change(comparison, c, &objective));
    table.row("objective", columns.first().map_or("", |c| c.cell.unit().word()), cells);
    let mut out = table.render();
    for column in columns.iter().filter(|c| c.evaluation.objective.is_none()) {
        let _ = write!(out, "\n{}", feasibility(column));
    }
    out
}

/// The objective of a layout, or line by line why it has none.
pub fn feasibility(a: &Assessment<'_>) -> String {
    match a.objective() {
        Some(objective) => {
            format!("{} layout: objective {objective:.4} {}\n", a.label, a.cell.unit().word())
        }
        None => format!("{} layout is not feasible:\n  {}\n", a.label, a.reasons().join("\n  ")),
    }
}

fn placement_rows(table: &mut Table, name: &str, columns: &[Assessment<'_>]) {
    let of = |a: &Assessment<'_>| {
        let k = a.cell.equipment.iter().position(|e| e.name == name)?;
        Some(a.layout.placements[k])
    };
    let cells = |f: fn(&crate::cell::Placement) -> String| {
        columns.iter().map(move |c| of(c).map_or("-".into(), |p| f(&p))).collect::<Vec<_>>()
    };
    table.row(name, "x, y mm", cells(|p| format!("{}, {}", mm(p.x), mm(p.y))).into_iter());
    table.row("", "z mm", cells(|p| mm(p.z)).into_iter());
    table.row("", "yaw deg", cells(|p| rounded(deg_from_rad(p.yaw), 4).to_string()).into_iter());
}

fn operation_rows(table: &mut Table, k: usize, comparison: &Comparison<'_>) {
    let columns = &comparison.columns;
    let operation = &columns[0].cell.operations[k];
    let spot = |a: &Assessment<'_>| match a.spot(k) {
        Some((n, _)) => format!("{}, {}, {}", mm1(n.position.x), mm1(n.position.y), mm1(n.position.z)),
        None => "none".into(),
    };
    table.row(&operation.name, "spot x, y, z mm", columns.iter().map(spot));
    let joints = |a: &Assessment<'_>| match a.spot(k) {
        Some((_, p)) => {
            let q = p.joints.iter().take(a.cell.robot.axes());
            q.map(|q| format!("{:.2}", rounded(deg_from_rad(*q), 2))).collect::<Vec<_>>().join(", ")
        }
        None => "-".into(),
    };
    table.row("", "joints deg", columns.iter().map(joints));
    let cell = columns[0].cell;
    let word = if cell.unit() == Unit::Share { "p95" } else { value_word(cell) };
    for sense in &columns[0].maps[k].senses {
        let asked = if *sense == operation.sense { " <- asked" } else { "" };
        let error = |a: &Assessment<'_>| a.error_at(k, &sense.name);
        let cells = (0..columns.len()).map(|c| with_change(comparison, c, &error));
        table.row("", &format!("{word} {} {}{asked}", sense.name, sense.unit.word()), cells);
    }
    if operation.limit.is_some() {
        let success = |a: &Assessment<'_>| a.spot(k).and_then(|(_, p)| p.success);
        table.row("", "yield", (0..columns.len()).map(|c| with_change(comparison, c, &success)));
    }
    for (status, words) in STATUSES {
        if status == "unjudged" && columns.iter().all(|c| c.maps[k].count(status) == 0) {
            continue;
        }
        table.row("", &format!("nodes {words}"), columns.iter().map(|c| c.maps[k].count(status).to_string()));
    }
}

/// A value and its change from the first column.
fn with_change(
    comparison: &Comparison<'_>,
    column: usize,
    value: &dyn Fn(&Assessment<'_>) -> Option<f64>,
) -> String {
    let Some(v) = value(&comparison.columns[column]) else { return "-".into() };
    match comparison.change_percent(column, value) {
        Some(change) => format!("{v:.4} ({change:+.1} %)"),
        None => format!("{v:.4}"),
    }
}

/// What the map says, operation by operation.
pub fn maps(a: &Assessment<'_>) -> String {
    let mut out = String::new();
    for map in &a.maps {
        let _ = writeln!(out, "{}", map_summary(a, map));
    }
    if a.evaluation.objective.is_none() {
        out.push_str(&feasibility(a));
    }
    out
}

fn map_summary(a: &Assessment<'_>, map: &OperationMap) -> String {
    let cell = a.cell;
    let operation = &cell.operations[map.operation];
    let surface = &cell.equipment[operation.equipment].name;
    let mut out =
        format!("{} on {surface}: {} of {} nodes ok", operation.name, map.count("ok"), map.nodes.len());
    for (status, words) in &STATUSES[1..] {
        if map.count(status) > 0 {
            let _ = write!(out, ", {} {words}", map.count(status));
        }
    }
    let (sense, unit) = (&operation.sense.name, cell.unit());
    match map.best_node().and_then(|n| Some((n, n.posture.as_ref()?))) {
        Some((node, p)) => {
            let (x, y, z) = (mm1(node.position.x), mm1(node.position.y), mm1(node.position.z));
            let (word, value) = (value_word(cell), unit.from_si(p.value));
            let _ = write!(out, "\n  least {word} in {sense}: {value:.6} {}", unit.word());
            let _ = write!(out, " at node ({}, {}), x {x} y {y} z {z} mm", node.i, node.j);
            if let Some(k) = map.sense(sense) {
                let _ = write!(out, "\n  there {}", risk(&p.figures[k], operation.sense.unit, p.success));
            }
            if let Some(said) = samples_summary(a, map.operation) {
                let _ = write!(out, "\n  {said}");
            }
        }
        None => out.push_str("\n  no usable node"),
    }
    if map.best.is_some() {
        let _ = write!(out, "\n  {}", discrepancy_summary(map));
        let _ = write!(out, "\n  {}", guard_summary(cell, map));
    }
    out
}

/// The same errors read in other ways.
fn risk(f: &Figures, unit: Unit, success: Option<f64>) -> String {
    let [error, worst, rms, p95, p99] =
        [f.error, f.worst, f.rms, f.p95, f.p99].map(|v| format!("{:.4}", unit.from_si(v)));
    let success = success.map_or(String::new(), |s| format!(", yield {s:.6}"));
    let unit = unit.word();
    format!("sample {error}, worst case {worst}, rms {rms}, p95 {p95}, p99 {p99} {unit}{success}")
}

/// The verdict of the samples on the first-order figures.
fn samples_summary(a: &Assessment<'_>, k: usize) -> Option<String> {
    let samples = a.samples[k].as_ref()?;
    let unit = a.cell.operations[k].sense.unit;
    let said = |e: &Estimate| {
        let [value, low, high] = [e.value, e.low, e.high].map(|v| unit.from_si(v));
        format!("{value:.4} ({low:.4} to {high:.4})")
    };
    let verdict = match a.first_order_holds(k)? {
        true => "the first-order figures hold",
        false => "the first-order figures do NOT hold: trust the samples",
    };
    Some(format!(
        "{} samples of the nonlinear model: rms {}, p95 {}, p99 {} {}; {verdict}",
        samples.samples,
        said(&samples.rms),
        said(&samples.p95),
        said(&samples.p99),
        unit.word()
    ))
}

/// Where the chosen model is not to be trusted.
fn guard_summary(cell: &Cell, map: &OperationMap) -> String {
    let percent = |share: f64| format!("{:.3} %", percent_from_share(share));
    let off = |model| map.off(model, cell.guard);
    let (linear, second) = (off(Model::Linear), off(Model::SecondOrder));
    let (_, above, all) = off(cell.model);
    let trust = match above {
        0 => format!("the {} model can be trusted at every node", cell.model.name()),
        _ => format!(
            "do NOT trust the {} model at {above} of {all} nodes (off by more than {})",
            cell.model.name(),
            percent(cell.guard)
        ),
    };
    format!(
        "off the nonlinear model at most: linear {}, second-order {}; {trust}",
        percent(linear.0),
        percent(second.0)
    )
}

/// The claim of section 4.3 (no discrepancy above 1 %), looked at node by node.
fn discrepancy_summary(map: &OperationMap) -> String {
    let usable = map.nodes.iter().filter(|n| n.status == Status::Ok).filter_map(|n| n.posture.as_ref());
    let all: Vec<Discrepancy> = usable.map(|p| discrepancy(&p.nonlinear, &p.linear)).collect();
    let of = |f: fn(&Discrepancy) -> Option<f64>| {
        let values: Vec<f64> = all.iter().filter_map(f).collect();
        let most = values.iter().copied().fold(0.0, f64::max);
        (most, values.iter().filter(|&&v| v > 1.0).count())
    };
    let said = |name: &str, (most, above): (f64, usize)| match above {
        0 => format!("{name} {most:.3} %"),
        n => format!("{name} {most:.3} % (above 1 % at {n} node{})", if n == 1 { "" } else { "s" }),
    };
    let parts = [
        said("resultant", of(|d| d.resultant)),
        said("x", of(|d| d.x)),
        said("y", of(|d| d.y)),
        said("z", of(|d| d.z)),
    ];
    format!("linear against nonlinear model, largest discrepancy: {}", parts.join(", "))
}

fn mm(m: f64) -> String {
    rounded(mm_from_m(m), 3).to_string()
}

fn mm1(m: f64) -> String {
    format!("{:.1}", rounded(mm_from_m(m), 1))
}
