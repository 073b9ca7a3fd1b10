//! Text of the corrections of a programme.

use super::fixed;
use super::table::TextTable;
use crate::cell::Unit;
use crate::files::shown;
use crate::record::{CorrectionDocument, CorrectionEntry, CorrectionState};
use crate::report::correction::target;
use std::fmt::Write;

/// Returns joint commands, pose commands, and the remaining error at every target.
pub fn correction(document: &CorrectionDocument) -> String {
    let mut out = String::new();
    let known: Vec<&CorrectionEntry> = document.targets.iter().filter(|t| t.joints.is_some()).collect();
    let number = |value: Option<f64>, digits| value.map_or(String::new(), |v| fixed(v, digits));
    let mut joints = TextTable::indented(2);
    let names = document.driven().enumerate().map(|(k, (_, joint))| match joint.unit {
        Unit::Length => format!("q{} mm", k + 1),
        _ => format!("q{} deg", k + 1),
    });
    joints.labelled("", "target", names);
    let mut poses = TextTable::indented(2);
    poses.row(["", "target", "x", "y", "z", "rx", "ry", "rz"]);
    let mut errors = TextTable::indented(2);
    errors.row(["", "target", "before mm", "deg", "remains mm", "deg", "random rms mm", "deg", "state"]);
    for entry in &known {
        let (operation, target) = (shown(&entry.operation), shown(&target(entry)));
        let all = entry.joints.iter().flat_map(|q| document.driven().map(|(i, _)| q[i]));
        joints.labelled(&operation, &target, all.map(|q| fixed(q, 4)));
        if let Some(command) = &entry.command {
            let pose = command.position_mm.iter().chain(&command.rpy_deg);
            poses.labelled(&operation, &target, pose.map(|v| fixed(*v, 4)));
        }
        let figures = [
            number(entry.before_mm, 4),
            number(entry.before_deg, 4),
            number(entry.rest_mm, 4),
            number(entry.rest_deg, 4),
            number(entry.random_mm, 4),
            number(entry.random_deg, 4),
            entry.state.name().to_string(),
        ];
        errors.labelled(&operation, &target, figures.into_iter());
    }
    if !known.is_empty() {
        out.push_str("Joint commands\n");
        out.push_str(&joints.render());
        out.push_str("\nPose commands for the controller, base frame, mm and deg (Rz Ry Rx)\n");
        out.push_str(&poses.render());
        out.push_str("\nErrors of the TCP without correction, and with it\n");
        out.push_str(&errors.render());
    }
    let refused = document.targets.iter().filter(|t| t.state != CorrectionState::Corrected);
    for entry in refused {
        let reason = entry.reason.as_deref().unwrap_or("unknown");
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{} {}: {}", shown(&entry.operation), shown(&target(entry)), shown(reason));
    }
    out
}
