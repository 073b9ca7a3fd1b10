//! The paper's Fig. 8: discrepancy between the linearized and the nonlinear model, node by node.

use crate::compare::Assessment;
use crate::error_map::{OperationMap, Status};
use crate::kinematic_error::{Discrepancy, discrepancy};
use std::fmt::Write;

const WIDTH: f64 = 860.0;
const PANEL: f64 = 300.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 56.0;
/// Decades of percent that are shown.
const LOW: f64 = -3.0;
const HIGH: f64 = 2.0;

/// What is drawn: name, colour (Okabe and Ito, safe for colour-blind readers), value.
type Curve = (&'static str, &'static str, fn(&Discrepancy) -> Option<f64>);
const CURVES: [Curve; 4] = [
    ("x", "#0072b2", |d| d.x),
    ("y", "#e69f00", |d| d.y),
    ("z", "#009e73", |d| d.z),
    ("resultant", "#1b1f24", |d| d.resultant),
];

/// One panel per operation, usable nodes from left to right, logarithmic percent.
pub fn chart(a: &Assessment<'_>) -> String {
    let height = TOP + (PANEL + 50.0) * a.maps.len() as f64;
    let mut out = String::new();
    // Writing to a String cannot fail; the results below are dropped for that reason.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"system-ui, sans-serif\" font-size=\"13\" fill=\"#1b1f24\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         <text x=\"{LEFT}\" y=\"26\" font-size=\"16\" font-weight=\"600\">{}</text>",
        super::view::escaped(&format!("{}: {}", a.cell.robot.name, a.cell.error_set().name()))
    );
    for (k, map) in a.maps.iter().enumerate() {
        panel(&mut out, a, map, TOP + (PANEL + 50.0) * k as f64);
    }
    out.push_str("</svg>\n");
    out
}

fn panel(out: &mut String, a: &Assessment<'_>, map: &OperationMap, top: f64) {
    let usable = map.nodes.iter().filter(|n| n.status == Status::Ok);
    let all: Vec<Discrepancy> =
        usable.filter_map(|n| n.posture.as_ref()).map(|p| discrepancy(&p.nonlinear, &p.linear)).collect();
    let right = WIDTH - 24.0;
    let x = |k: usize| LEFT + (right - LEFT) * (k as f64 + 0.5) / all.len().max(1) as f64;
    let y = |percent: f64| {
        let decade = percent.max(1e-12).log10().clamp(LOW, HIGH);
        top + PANEL * (HIGH - decade) / (HIGH - LOW)
    };
    for decade in LOW as i32..=HIGH as i32 {
        let (at, one) = (y(10f64.powi(decade)), decade == 0);
        let (stroke, width) = if one { ("#cf222e", 1.4) } else { ("#d8dee4", 1.0) };
        let _ = writeln!(
            out,
            "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{} %</text>",
            LEFT - 8.0,
            at + 4.5,
            10f64.powi(decade)
        );
    }
    for (k, (name, colour, value)) in CURVES.iter().enumerate() {
        let points = all.iter().enumerate().filter_map(|(k, d)| Some((x(k), y(value(d)?))));
        let path: Vec<String> = points.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let legend = LEFT + 110.0 * k as f64;
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/>\
             <path d=\"M{legend} {1:.1}h22\" stroke=\"{colour}\" stroke-width=\"2.4\"/>\
             <text x=\"{2:.1}\" y=\"{3:.1}\">{name}</text>",
            path.join(" "),
            top - 13.0,
            legend + 28.0,
            top - 8.5
        );
    }
    let operation = super::view::escaped(&a.cell.operations[map.operation].name);
    let _ = writeln!(
        out,
        "<text x=\"{LEFT}\" y=\"{:.1}\">{operation}: the {} usable nodes in the order of the grid; discrepancy of \
         the linearized model, eq. (9)</text>",
        top + PANEL + 22.0,
        all.len()
    );
}
