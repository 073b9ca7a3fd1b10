//! Numbers with their units as the pages print them.

use crate::cell::Unit;
use crate::units::{percent_from_share, rounded};

/// Returns an SI value as text in `unit`, with the unit; a share is in percent.
pub fn quantity(unit: Unit, si: f64) -> String {
    told(unit, unit.from_si(si))
}

/// Returns a value that is already in `unit` as text with the unit; a share is in percent.
pub fn told(unit: Unit, value: f64) -> String {
    match unit {
        Unit::Share => format!("{:.4} %", rounded(percent_from_share(value), 4)),
        _ => format!("{:.3} {}", rounded(value, 3), unit.word()),
    }
}

/// Returns a bound with its unit, rounded down, so that the printed number is a proven bound, too.
pub fn down(unit: Unit, bound: f64) -> String {
    match unit {
        Unit::Share => format!("{:.4} %", (percent_from_share(bound) * 1e4).floor() / 1e4),
        _ => format!("{:.4} {}", (bound * 1e4).floor() / 1e4, unit.word()),
    }
}

/// Returns a percentage rounded up, so that the printed gap is never too small.
pub fn up(percent: f64) -> f64 {
    let digits = if percent < 0.1 { 1e4 } else { 1e1 };
    (percent * digits).ceil() / digits
}
