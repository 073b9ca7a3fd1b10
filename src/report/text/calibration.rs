//! Text of a calibration.

use super::fixed;
use super::table::TextTable;
use crate::files::shown;
use crate::record::{AccuracyEntry, CalibrationDocument, OutlierRow};
use std::fmt::Write;

/// Returns the accuracy before and after the calibration, the parameters of the fit, and the rank.
///
/// The rank is the number of combinations of parameters that the data determine. The data reduce the standard
/// deviation of each such combination to less than half of the prior value.
pub fn calibration(document: &CalibrationDocument) -> String {
    let mut out = format!(
        "{}: calibrated with {} positions, residual {} mm per axis\n\nPosition error, mm\n",
        shown(&document.robot),
        document.sessions.iter().map(|s| s.poses).sum::<usize>(),
        fixed(document.residual_mm.unwrap_or(0.0), 3)
    );
    let mut accuracy = TextTable::indented(2);
    accuracy.row(["", "", "positions", "mean", "rms", "95 %", "max", "in 95 % ellipsoid"]);
    let mut rows = |file: &str,
                    poses: usize,
                    before: &AccuracyEntry,
                    after: &AccuracyEntry,
                    share: String| {
        let figures = |of: &AccuracyEntry| {
            [of.mean_mm, of.rms_mm, of.p95_mm, of.max_mm].into_iter().map(|mm| fixed(mm, 3))
        };
        accuracy.labelled(&shown(file), "nominal", [poses.to_string()].into_iter().chain(figures(before)));
        let after = [String::new()].into_iter().chain(figures(after)).chain([share]);
        accuracy.labelled("", "calibrated", after);
    };
    for s in &document.sessions {
        rows(&s.file, s.poses, &s.before, &s.after, String::new());
    }
    for t in &document.tests {
        let share = format!("{} %", fixed(t.coverage_95 * 100.0, 1));
        rows(&format!("test {}", t.file), t.poses, &t.before, &t.after, share);
    }
    out.push_str(&accuracy.render());
    let sessions = document.sessions.iter().map(|s| (&s.file, &s.outliers));
    for (file, outliers) in sessions.chain(document.tests.iter().map(|t| (&t.file, &t.outliers))) {
        out.push_str(&outlier_rows(file, outliers));
    }
    // Writing to a String cannot fail.
    let _ = match &document.held_out {
        Some(of) => writeln!(
            out,
            "\nCross-validation: each block of the joint space is predicted by a fit without this block. The error \
             has mean {} mm, rms {} mm, 95 % {} mm, max {} mm.",
            fixed(of.mean_mm, 3),
            fixed(of.rms_mm, 3),
            fixed(of.p95_mm, 3),
            fixed(of.max_mm, 3)
        ),
        None => writeln!(
            out,
            "\nCross-validation: not available, because without any block of positions some unknowns are not determined."
        ),
    };
    out.push_str("\nParameters\n");
    let mut parameters = TextTable::indented(1);
    parameters.row(["", "value", "unit", "sigma before", "sigma after", "identified"]);
    for p in &document.parameters {
        let identified = if p.identified { "yes" } else { "no" };
        parameters.row([
            p.name.clone(),
            fixed(p.value, 4),
            p.unit.clone(),
            p.prior.map_or(String::new(), |prior| fixed(prior, 4)),
            p.sigma.map_or(String::new(), |sigma| fixed(sigma, 4)),
            identified.into(),
        ]);
    }
    out.push_str(&parameters.render());
    let _ = writeln!(
        out,
        "\nRank {} of {}: the data reduce the standard deviation of this many parameter combinations to less \
         than half.",
        document.rank,
        document.parameters.len()
    );
    for direction in &document.unidentified {
        let _ = writeln!(out, "  not determined: {direction}");
    }
    if !document.harmonics.is_empty() {
        out.push_str("\nPeriodic errors of the joints, deg\n");
        let mut periodic = TextTable::indented(1);
        periodic.row(["", "orders", "rms over a revolution", "sigma, highest order"]);
        for h in &document.harmonics {
            let (rms, prior) = (fixed(h.rms_deg, 4), fixed(h.prior_deg, 5));
            periodic.row([shown(&h.joint), h.cos_deg.len().to_string(), rms, prior]);
        }
        out.push_str(&periodic.render());
    }
    if let Some(misfit) = &document.misfit {
        let joints: Vec<_> = misfit.joints.iter().map(|deviation| fixed(*deviation, 4)).collect();
        let _ = writeln!(
            out,
            "\nMisfit, standard deviations of the errors that the parameters do not explain: joints {} (deg or mm), \
             positions {} mm.",
            joints.join(", "),
            fixed(misfit.position_mm, 3)
        );
    }
    out
}

/// Largest number of outliers in the text.
const SHOWN_OUTLIERS: usize = 10;

/// Returns a line that names the outliers of a file; empty if there are none.
fn outlier_rows(file: &str, outliers: &[OutlierRow]) -> String {
    if outliers.is_empty() {
        return String::new();
    }
    let mut worst = outliers.to_vec();
    worst.sort_by(|a, b| b.distance_mm.total_cmp(&a.distance_mm));
    let rows =
        worst.iter().take(SHOWN_OUTLIERS).map(|o| format!("{} ({} mm)", o.row, fixed(o.distance_mm, 3)));
    let rows: Vec<_> = rows.collect();
    let dots = if worst.len() > SHOWN_OUTLIERS { ", ..." } else { "" };
    format!(
        "  outliers of {}, {} positions, by line of the file: {}{dots}\n",
        shown(file),
        outliers.len(),
        rows.join(", ")
    )
}

/// Returns the errors of a finished calibration, parameter by parameter. `source` names the file with the
/// result of this calibration.
pub fn stated_calibration(document: &CalibrationDocument, source: &str) -> String {
    let mut out = format!("{}: errors stated by {}\n\nParameters\n", shown(&document.robot), shown(source));
    let mut parameters = TextTable::indented(1);
    parameters.row(["", "value", "unit"]);
    for p in &document.parameters {
        parameters.row([p.name.clone(), fixed(p.value, 6), p.unit.clone()]);
    }
    out.push_str(&parameters.render());
    out.push_str("\nThe file states no standard deviations.\n");
    out
}
