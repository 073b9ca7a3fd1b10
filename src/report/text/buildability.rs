//! Certificate and assumptions of a layout, as text.

use crate::assess::Assessment;
use crate::cell::Cell;
use crate::files::shown;

/// Returns a statement on whether a layout works at every misplacement. If the layout works, the statement
/// includes the upper bound of the value of each operation. The text is empty if the cell demands no
/// certificate.
pub fn certificate(a: &Assessment<'_>) -> String {
    if !a.workcell.certifies() {
        return String::new();
    }
    let unit = a.cell.unit();
    if a.certificate.as_ref().is_none_or(|certificate| !certificate.holds()) {
        return format!("{}: NOT certified to work everywhere within the placement tolerances\n", a.label);
    }
    let worst = a.cell.operations.iter().enumerate().map(|(k, operation)| match a.worst(k) {
        Some(worst) => {
            format!("{} at most {:.4} {}", shown(&operation.name), unit.from_si(worst), unit.word())
        }
        None => {
            let why = a.workcell.no_value_bound(k).map_or("", |why| why.in_words());
            format!("{} not bounded: {why}", shown(&operation.name))
        }
    });
    let worst: Vec<String> = worst.collect();
    format!(
        "{}: certified to work everywhere within the placement tolerances; worst values: {}\n",
        a.label,
        worst.join(", ")
    )
}

/// Returns the assumed values with the keys that change them; empty if nothing was assumed.
pub fn assumptions(cell: &Cell) -> String {
    if cell.assumed.is_empty() {
        return String::new();
    }
    let all: Vec<String> = cell.assumed.iter().map(|a| format!("{} = {}", a.key, a.value)).collect();
    format!("assumed, because the cell does not state these keys: {}\n", all.join("; "))
}

/// Returns a line of text on whether a feasible layout works at every misplacement. The text is empty if the
/// cell demands no certificate.
pub fn verdict(a: &Assessment<'_>) -> String {
    if !a.workcell.certifies() {
        return String::new();
    }
    match a.certificate.as_ref().is_some_and(|certificate| certificate.holds()) {
        true => {
            "certified: every operation works at every misplacement within the placement tolerances\n".into()
        }
        false => {
            "NOT certified: an operation may fail at some misplacement within the placement tolerances\n"
                .into()
        }
    }
}
