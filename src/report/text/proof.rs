//! The proven lower bound of the objective.

use crate::files::shown;
use crate::layout::Workcell;
use crate::proof::Proof;
use crate::units::percent_from_share;
use std::fmt::Write;

/// Gap, as a share of the bound, above which a bound says nothing about the best layout found.
const USELESS: f64 = 10.0;

/// Difference of two gaps, as a share of the bound, up to which the gaps count as equal.
const SAME: f64 = 1e-6;

/// Returns the lower bound, the gap from it to the best layout found, and the operations that the bound
/// covers. `least` is the least objective found, which may be below that of the best layout.
pub fn proven(workcell: &Workcell, gap: Option<f64>, least: Option<f64>, proof: &Proof) -> String {
    let (cell, covers) = (&workcell.cell, proof.in_words(workcell));
    let Some(bound) = proof.bound else { return format!("{covers}\n") };
    let unit = cell.unit();
    // The bound is rounded down, so that the printed number is also a proven bound.
    let down = |v: f64| format!("{:.4} {}", (unit.from_si(v) * 1e4).floor() / 1e4, unit.word());
    let mut out =
        format!("proven lower bound: no layout in these ranges has an objective below {}", down(bound));
    match gap {
        Some(gap) if gap > USELESS => {
            out.push_str("; this bound is too low to judge the best layout found");
        }
        Some(gap) => {
            let gap = super::gap(percent_from_share(gap));
            let _ = write!(out, "; the best layout found is {gap} above this bound");
        }
        None => {}
    }
    out.push('\n');
    let of_least = least.filter(|_| bound > 0.0).map(|least| least / bound - 1.0);
    if let (Some(gap), Some(of_least)) = (gap, of_least)
        && gap <= USELESS
        && of_least < gap - SAME
    {
        let of_least = super::gap(percent_from_share(of_least));
        let _ = writeln!(
            out,
            "  the least objective found is {of_least} above this bound; among nearly equal layouts, the \
             search chose one with more room"
        );
    }
    let _ = writeln!(out, "  the bound covers {covers}");
    if workcell.certifies() {
        out.push_str(
            "  the bound holds for layouts that work at every misplacement within the placement tolerances\n",
        );
    }
    for (bound, operation) in proof.operations.iter().zip(&cell.operations) {
        if let Ok(value) = bound.value {
            let limit = operation.limit.filter(|limit| *limit < value);
            let never = limit.map_or("", |_| "; no layout in these ranges meets its limit");
            let _ = writeln!(out, "  {}: at least {}{never}", shown(&operation.name), down(value));
        }
    }
    out
}
