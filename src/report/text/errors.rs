//! Text of guessed tolerances and of the presets.

use super::fixed;
use super::table::TextTable;
use crate::files::shown;
use crate::pose_accuracy::ErrorPreset;
use crate::record::{BaseChoice, ErrorsDocument};
use std::fmt::Write;

/// Returns the presets with their half widths and sources. A preset is a set of guessed tolerances for a
/// class of arms.
pub fn presets(presets: &[ErrorPreset]) -> String {
    let mut table = TextTable::new(1);
    table.row(["preset", "joint zeros deg", "mm", "lengths mm", "twists deg"]);
    for p in presets {
        let numbers = [p.zero_deg, p.zero_mm, p.length_mm, p.twist_deg].map(|n| n.to_string());
        table.row([p.name.to_string()].into_iter().chain(numbers));
    }
    let mut out = String::from(
        "GUESSES for arms without measurements: half widths of the tolerances, each equal to 3 sigma of a normal distribution\n\n",
    );
    out.push_str(&table.render());
    out.push('\n');
    for p in presets {
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{}: {}\n  {}", p.name, p.class, p.source);
    }
    out
}

/// Returns the predicted accuracy, the test cube and the tolerances.
pub fn errors(document: &ErrorsDocument) -> String {
    let heading = match document.guess {
        true => document.source.clone(),
        false => format!("error set {}, unchanged from the robot file", shown(&document.origin_name)),
    };
    let mut out = format!("{}: {heading}\n\n", shown(&document.robot));
    out.push_str(&accuracy(document));
    out.push_str(&cube(document));
    out.push_str("\nTolerances\n");
    let mut table = TextTable::indented(1);
    table.row(["", "plus or minus", "unit", "distribution"]);
    for p in &document.parameters {
        table.row([p.name.clone(), fixed(p.plus_minus, 5), p.unit.clone(), p.distribution.clone()]);
    }
    out.push_str(&table.render());
    out
}

fn accuracy(document: &ErrorsDocument) -> String {
    let base = match document.base {
        BaseChoice::Fitted => "base frame fitted to each robot",
        BaseChoice::Nominal => "nominal base frame",
    };
    let mut out = format!("Predicted pose accuracy AP (ISO 9283), mm, {base}\n");
    let mut table = TextTable::indented(1);
    table.row(["", "median robot", "5 %", "95 %", "worst pose"]);
    let mut row = |name: &str, of: &crate::record::AccuracyQuantiles| {
        let numbers = [of.median_mm, of.p5_mm, of.p95_mm, of.worst_pose_mm].map(|mm| fixed(mm, 4));
        table.row([name.to_string()].into_iter().chain(numbers));
    };
    row("constant errors", &document.ap);
    if document.wanted_rp_mm.is_some() {
        row("with random errors", &document.ap_of_set);
    }
    out.push_str(&table.render());
    // Writing to a String cannot fail.
    if let Some(ap) = document.wanted_ap_mm {
        let _ = writeln!(
            out,
            "  the tolerances of {}, multiplied by {}, give an AP of {} mm for the median robot",
            shown(&document.origin_name),
            fixed(document.scale, 5),
            ap
        );
    }
    if let (Some(rp), Some(scatter)) = (document.wanted_rp_mm, &document.joint_scatter) {
        let scatter: Vec<_> = scatter.iter().map(|s| fixed(*s, 5)).collect();
        let _ = writeln!(
            out,
            "  a repeatability RP of {rp} mm corresponds to a scatter of the joints of {} (deg or mm, 1 sigma)",
            scatter.join(", ")
        );
    }
    out
}

fn cube(document: &ErrorsDocument) -> String {
    let cube = &document.cube;
    let [x, y, z] = cube.centre_mm.map(|mm| fixed(mm, 1));
    let size = if cube.is_standard { "" } else { ", smaller than every cube of the standard" };
    let spin = match cube.spin_deg {
        Some(spin) => format!("spin {} deg", fixed(spin, 1)),
        None => "spin dictated by the arm".into(),
    };
    let mut out = format!(
        "\nTest cube: edge {} mm{size}, centre x {x} y {y} z {z} mm in the base frame; tool elevation {} deg, \
         {spin}\n",
        fixed(cube.edge_mm, 0),
        fixed(cube.bend_deg, 1)
    );
    let mut table = TextTable::indented(1);
    table.row(["", "x", "y", "z mm", "AP mm"]);
    for (k, pose) in cube.poses.iter().enumerate() {
        let at = pose.position_mm.map(|mm| fixed(mm, 1));
        table.row([format!("P{}", k + 1)].into_iter().chain(at).chain([fixed(pose.ap_mm, 4)]));
    }
    out.push_str(&table.render());
    out
}
