//! How good the best layout can be at all.

use super::percent1;
use crate::files::shown;
use crate::layout::Workcell;
use crate::proof::Proof;
use crate::search::SearchRecord;
use std::fmt::Write;

/// The bound, how far the best layout lies above it, and what it covers.
pub fn proven(workcell: &Workcell, record: &SearchRecord, proof: &Proof) -> String {
    let (cell, covers) = (&workcell.cell, proof.in_words(workcell));
    let Some(bound) = proof.bound else { return format!("{covers}\n") };
    let unit = cell.unit();
    // Rounded down: what is printed is proven, too.
    let down = |v: f64| format!("{:.4} {}", (unit.from_si(v) * 1e4).floor() / 1e4, unit.word());
    let mut out = format!("proven: no layout of these ranges has less than {}", down(bound));
    if let Some(gap) = record.gap() {
        let gap = gap.max(0.0);
        let gap = if gap < 1e-3 { format!("{:.3} %", 100.0 * gap) } else { percent1(gap) };
        let _ = write!(out, "; the best found lies {gap} above that");
    }
    let _ = writeln!(out, "\n  bounded is {covers}");
    for (bound, operation) in proof.operations.iter().zip(&cell.operations) {
        if let Ok(value) = bound.value {
            let limit = operation.limit.filter(|limit| *limit < value);
            let never = limit.map_or("", |_| "; no layout of these ranges keeps its limit");
            let _ = writeln!(out, "  {}: at least {}{never}", shown(&operation.name), down(value));
        }
    }
    out
}
