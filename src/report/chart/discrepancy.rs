//! Discrepancy between the linearized and the nonlinear model, node by node (Fig. 8 of the seed paper, from
//! which this project grew).

use super::WIDTH;
use super::axes;
use super::axes::AxisScale;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry};
use crate::assess::Assessment;
use crate::error_map::OperationMap;
use crate::kinematic_error::{Discrepancy, discrepancy as between};
use crate::svg_text::{PathEnd, path_data};

const PANEL: f64 = 260.0;
/// Span of the vertical axis, percent. Values beyond the span are drawn on its edge.
const AXIS_PERCENT: (f64, f64) = (1e-3, 1e2);
/// Largest number of nodes that are drawn in a panel.
const MAX_NODES: usize = 2000;

/// Curve of a panel: name, ink, and the function that returns its value in percent.
type Curve = (&'static str, Ink, fn(&Discrepancy) -> Option<f64>);
const CURVES: [Curve; 4] = [
    ("x", Ink::Blue, |d| d.x),
    ("y", Ink::Orange, |d| d.y),
    ("z", Ink::Green, |d| d.z),
    ("resultant", Ink::Text, |d| d.resultant),
];

/// Draws one panel per operation. A panel plots the discrepancy at each usable node, in percent. The nodes
/// follow each other in the order of the grid.
pub fn discrepancy(a: &Assessment<'_>) -> String {
    let heading = format!(
        "{}, errors {}: linear against nonlinear model",
        a.cell.robot.name,
        a.cell.error_set().name()
    );
    let under = [
        "discrepancy of the linearized model, eq. (9), at the usable nodes in the order of the grid"
            .to_string(),
        "values below 0.001 % are drawn on the lower edge".to_string(),
    ];
    let mut canvas = ChartCanvas::new(&heading, &under);
    canvas.legend(&CURVES.map(|(name, ink, _)| LegendEntry {
        mark: format!("<path d=\"M-12 0H12\" {}/>", ink.line(2.2)),
        said: name.to_string(),
    }));
    a.maps.iter().for_each(|map| panel(&mut canvas, a, map));
    canvas.finish()
}

fn panel(canvas: &mut ChartCanvas, a: &Assessment<'_>, map: &OperationMap) {
    let all: Vec<Discrepancy> = map.usable().map(|(_, _, p)| between(&p.nonlinear, &p.linear)).collect();
    let every = all.len().div_ceil(MAX_NODES).max(1);
    let top = canvas.y + 44.0;
    let y = AxisScale::log(AXIS_PERCENT.0, AXIS_PERCENT.1, (top + PANEL, top));
    let x = AxisScale::linear(0.0, (all.len() + 1) as f64, (66.0, WIDTH - EDGE));
    axes::upwards(canvas, &x, &y, &format!("{}: discrepancy / %", a.cell.operations[map.operation].name));
    for (_, ink, value) in CURVES {
        let points = all.iter().enumerate().step_by(every);
        let points = points.filter_map(|(k, d)| Some((x.at((k + 1) as f64), y.at(value(d)?))));
        canvas.path(&path_data(points, PathEnd::Open, 1), &ink.line(1.6));
    }
    let one = y.at(1.0);
    let dashed = format!("{} stroke-dasharray=\"6 3\"", Ink::Vermilion.line(1.6));
    canvas.path(&format!("M{:.1} {one:.1}H{:.1}", x.px.0, x.px.1), &dashed);
    canvas.label((x.px.1 - 4.0, one - 5.0), Anchor::End, Ink::Vermilion, "1 %");
    canvas.path(&format!("M{:.1} {top:.1}V{2:.1}H{1:.1}", x.px.0, x.px.1, y.px.0), &Ink::Axis.line(1.0));
    let thinned = if every > 1 { format!(", one in {every} drawn") } else { String::new() };
    let said = match all.len() {
        0 => "no usable node".to_string(),
        count => format!("{count} usable nodes{thinned}"),
    };
    canvas.text((x.px.1, y.px.0 + 20.0), Anchor::End, Ink::Faint, &said);
    canvas.y = y.px.0 + 24.0;
}
