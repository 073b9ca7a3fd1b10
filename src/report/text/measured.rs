//! Text of the comparison of measured positions with the predicted errors of a cell.

use super::table::TextTable;
use super::{fixed, percent1};
use crate::files::shown;
use crate::record::{AccuracyEntry, ComparedFile, RepeatsEntry};
use crate::verification::CYCLES_OF_STANDARD;
use std::fmt::Write;

/// Largest number of repeated postures in the text.
const SHOWN_POSTURES: usize = 10;

/// Returns one table for each file, with rank correlation, coverage, spots and repeats.
pub fn measured(files: &[ComparedFile]) -> String {
    files.iter().map(|file| format!("\n{}", one_file(file))).collect()
}

fn one_file(file: &ComparedFile) -> String {
    let mut out = format!(
        "{}: measured against predicted errors of {} positions, mm\n",
        shown(&file.file),
        file.positions.len()
    );
    let mut table = TextTable::indented(1);
    table.row(["", "mean", "rms", "95 %", "max"]);
    let mut row = |name: &str, of: &AccuracyEntry| {
        let figures = [of.mean_mm, of.rms_mm, of.p95_mm, of.max_mm].map(|mm| fixed(mm, 3));
        table.row([name.to_string()].into_iter().chain(figures));
    };
    row("measured", &file.measured);
    row(if file.predicted_rms { "predicted, rms" } else { "predicted" }, &file.predicted);
    row("measured minus predicted", &file.residual);
    out.push_str(&table.render());
    for line in measured_findings(file) {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "  {line}");
    }
    if let Some(repeats) = &file.repeats {
        out.push_str(&postures(repeats));
    }
    out
}

/// Returns the findings of a file in sentences: ranks, coverage, the spot with the least predicted error, and
/// repeats.
pub fn measured_findings(file: &ComparedFile) -> Vec<String> {
    let spots = &file.spots;
    let number = |r: Option<f64>| r.map_or("undefined (all predictions are equal)".into(), |r| fixed(r, 3));
    let has_spots = spots.count < file.positions.len();
    let of_spots = match has_spots {
        true => format!(", over {} spots {}", spots.count, number(spots.rank_correlation)),
        false => String::new(),
    };
    let best = &spots.predicted_best;
    let what = if has_spots { "spot" } else { "position" };
    let mut said = vec![
        format!(
            "Rank correlation (Spearman) of the sizes of predicted and measured errors: {}{of_spots}",
            number(file.rank_correlation)
        ),
        match file.coverage_95 {
            Some(share) => {
                let varying = file.coverage_95_varying.map_or(String::new(), |share| {
                    format!(
                        " if the random errors are constant, {} if they change from pose to pose, as the misfit of a \
                         calibration does",
                        percent1(share)
                    )
                });
                format!("Inside the predicted 95 % ellipsoids: {} of the positions{varying}", percent1(share))
            }
            None => "Coverage is not defined, because signed errors predict no ellipsoids".into(),
        },
        format!(
            "The {what} with the least predicted error, x {} y {} z {} from the base, has a measured error \
             of {} mm; mean of all {}, least {}, greatest {} mm",
            fixed(best.position_mm[0], 0),
            fixed(best.position_mm[1], 0),
            fixed(best.position_mm[2], 0),
            fixed(best.measured_mm, 3),
            fixed(spots.mean_mm, 3),
            fixed(spots.least_mm, 3),
            fixed(spots.greatest_mm, 3)
        ),
    ];
    if let Some(repeats) = &file.repeats {
        let note = match repeats.enough_visits {
            true => String::new(),
            false => format!(
                "; the standard demands {CYCLES_OF_STANDARD} visits, but some postures have only {}",
                repeats.least_visits
            ),
        };
        said.push(format!(
            "ISO 9283 over {} repeated postures: pose accuracy AP at most {} mm, pose repeatability RP at most {} mm{note}",
            repeats.postures.len(),
            fixed(repeats.largest_ap_mm, 3),
            fixed(repeats.largest_rp_mm, 3)
        ));
    }
    said
}

fn postures(repeats: &RepeatsEntry) -> String {
    let mut table = TextTable::indented(0);
    table.row(["first row", "visits", "x", "y", "z", "AP", "RP"]);
    for p in repeats.postures.iter().take(SHOWN_POSTURES) {
        let position = p.position_mm.map(|mm| fixed(mm, 1));
        let figures = [fixed(p.ap_mm, 3), fixed(p.rp_mm, 3)];
        table.row([p.row.to_string(), p.visits.to_string()].into_iter().chain(position).chain(figures));
    }
    let left = repeats.postures.len().saturating_sub(SHOWN_POSTURES);
    let more = if left > 0 { format!("  {left} more postures are in --json\n") } else { String::new() };
    table.render() + &more
}
