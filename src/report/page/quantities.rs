//! Numbers with their units as the pages print them.

use crate::cell::Unit;
use crate::units::{percent_from_share, rounded};

/// Returns an SI value as text in `unit`, with the unit; a share is in percent.
pub fn quantity(unit: Unit, si: f64) -> String {
    told(unit, unit.from_si(si))
}

/// Returns the text of `value` with its unit. The value must already be in `unit`; a share is printed in
/// percent.
pub fn told(unit: Unit, value: f64) -> String {
    match unit {
        Unit::Share => format!("{:.4} %", rounded(percent_from_share(value), 4)),
        _ => format!("{:.3} {}", rounded(value, 3), unit.word()),
    }
}

/// Returns a lower bound with its unit. The number is rounded down, so the printed number is still a lower
/// bound.
pub fn down(unit: Unit, bound: f64) -> String {
    match unit {
        Unit::Share => format!("{:.4} %", (percent_from_share(bound) * 1e4).floor() / 1e4),
        _ => format!("{:.4} {}", (bound * 1e4).floor() / 1e4, unit.word()),
    }
}

/// Largest number of decimals that [`apart`] uses to make the texts of two values differ.
const MAX_DECIMALS: usize = 9;

/// Returns two different SI values as texts in `unit`. The number of decimals, at most [`MAX_DECIMALS`], is
/// so large that the texts differ.
pub fn apart(unit: Unit, a: f64, b: f64) -> [String; 2] {
    let with = |decimals: usize| {
        [a, b].map(|si| match unit {
            Unit::Share => format!("{:.decimals$} %", percent_from_share(si)),
            _ => format!("{:.decimals$} {}", unit.from_si(si), unit.word()),
        })
    };
    let least = if unit == Unit::Share { 4 } else { 3 };
    let first = (least..MAX_DECIMALS).map(with).find(|[a, b]| a != b);
    first.unwrap_or_else(|| with(MAX_DECIMALS))
}
