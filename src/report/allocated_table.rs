//! TOML tables with the allocated tolerances, for the robot file and the cell file.

use super::error_table::{number, table};
use crate::assess::CellAllocation;
use crate::cell::{Distribution, ErrorSet, FrameErrors, Registration, Spread};
use crate::files::toml_string;
use crate::record::AllocationDocument;
use std::fmt::Write;

/// Returns the error set of the robot and the errors of the equipment, with the tolerances multiplied by
/// `scales`.
pub fn tables(problem: &CellAllocation<'_>, scales: &[f64], document: &AllocationDocument) -> String {
    let cell = problem.scaled_cell(scales);
    let cost = document.cost.unwrap_or(0.0);
    let source = format!(
        "sweetspot allocate: the cheapest tolerances by the {} reading; their cost is {} (before the allocation: {}); scaled from the error set {}",
        document.reading.name(),
        cost,
        document.cost_before,
        document.errors
    );
    let mut out = String::new();
    // Writing to a String cannot fail.
    match cell.error_set() {
        ErrorSet::Tolerance(tolerance) => {
            let is_correlated =
                |k: usize| tolerance.covariance.as_ref().is_some_and(|c| c.parameters.contains(&k));
            let own = tolerance.spreads.iter().enumerate();
            let none = |spread: &Spread| Spread { plus_minus: 0.0, ..*spread };
            let own: Vec<Spread> =
                own.map(|(k, spread)| if is_correlated(k) { none(spread) } else { *spread }).collect();
            let _ = write!(out, "{}", table(&cell.robot, "allocated", &source, &own));
            if tolerance.covariance.is_some() {
                let _ = writeln!(out, "# Copy the covariance of [errors.{}] unchanged.", tolerance.name);
            }
        }
        set => {
            let _ = writeln!(
                out,
                "# The errors of the robot are measured and do not change: [errors.{}]",
                set.name()
            );
        }
    }
    for equipment in cell.equipment.iter().filter(|_| cell.registration != Registration::Taught) {
        if let Some(FrameErrors::Tolerance(spreads)) = &equipment.errors {
            let list = |part: &[Spread], is_angle: bool| {
                part.iter().map(|s| number(s, is_angle)).collect::<Vec<_>>().join(", ")
            };
            let words: Vec<String> =
                spreads.iter().map(|s| format!("\"{}\"", s.distribution.name())).collect();
            let normal = spreads.iter().find(|s| s.distribution == Distribution::Normal);
            let _ = write!(
                out,
                "\n# Cell file\n[equipment.{}.errors]\nkind = \"tolerance\"\nposition_mm = [{}]\n\
                 rotation_deg = [{}]\ndistribution = [{}]\nsigmas = {}\n",
                toml_string(&equipment.name),
                list(&spreads[..3], false),
                list(&spreads[3..], true),
                words.join(", "),
                normal.map_or(Spread::SIGMAS, |s| s.sigmas)
            );
        }
    }
    out
}
