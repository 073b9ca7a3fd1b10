//! Histogram of the error at a spot, with mean, percentiles and other figures.

use super::axes;

use super::axes::AxisScale;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry, SMALL};
use super::{WIDTH, words};
use crate::assess::ErrorDistribution;
use crate::cell::Cell;
use crate::units::percent_from_share;

const HEIGHT: f64 = 250.0;
/// Greatest marked value that the axis shows, as a multiple of the upper end of the histogram. Greater
/// values are named below the plot.
const AXIS_LIMIT: f64 = 1.7;

/// Marked value of the histogram: name, value in the unit of the chart, ink.
struct HistogramMark {
    name: &'static str,
    value: f64,
    ink: Ink,
}

/// Draws the samples of the error with mean, percentiles, requirement, signed sample and worst case.
pub fn histogram(cell: &Cell, d: &ErrorDistribution) -> String {
    let operation = &cell.operations[d.operation];
    let word = d.unit.word();
    let heading =
        format!("{}: distribution of the error in {} at the spot", operation.name, operation.sense.name);
    let mut canvas = ChartCanvas::new(&heading, &told(d));
    let marks = marks(d);
    let [low, high] = [d.samples.histogram.low, d.samples.histogram.high].map(|v| d.unit.from_si(v));
    let near: Vec<&HistogramMark> = marks.iter().filter(|m| m.value <= AXIS_LIMIT * high).collect();
    let ends = near.iter().map(|m| m.value).fold((low, high), |(l, h), v| (l.min(v), h.max(v)));
    let pad = 0.02 * (ends.1 - ends.0);
    let x = AxisScale::linear((ends.0 - pad).max(0.0), ends.1 + pad, (70.0, WIDTH - EDGE - 4.0));
    let rows = names(&near, &x, word);
    let top = canvas.y + 12.0 + 17.0 * rows.iter().map(|r| r.row + 1).max().unwrap_or(0) as f64;
    let share = |count: u32| percent_from_share(f64::from(count) / d.samples.samples.max(1) as f64);
    let most = d.samples.histogram.counts.iter().map(|c| share(*c)).fold(0.0, f64::max);
    let y = AxisScale::linear(0.0, most * 1.05, (top + 14.0 + HEIGHT, top + 14.0));
    axes::across(&mut canvas, &x, &y, &format!("size of the error / {word}"));
    axes::upwards(&mut canvas, &x, &y, "");
    bars(&mut canvas, d, &x, &y, &share);
    canvas.path(&format!("M{:.1} {:.1}H{:.1}", x.px.0, y.px.0, x.px.1), &Ink::Axis.line(1.0));
    for (mark, name) in near.iter().zip(&rows) {
        let (px, base) = (x.at(mark.value), top - 17.0 * name.row as f64);
        canvas.path(&format!("M{px:.1} {:.1}V{:.1}", base - 11.0, y.px.0), &mark.ink.line(1.8));
        canvas.label((name.x, base - 1.0), Anchor::Start, Ink::Text, &name.said);
    }
    canvas.y = y.px.0 + 40.0;
    for HistogramMark { name, value, .. } in marks.iter().filter(|m| m.value > AXIS_LIMIT * high) {
        canvas.paragraph(&format!(
            "far beyond the right edge of the picture: {name} {} {word}",
            words::figure(*value)
        ));
    }
    canvas.legend(&legend(d));
    canvas.finish()
}

fn marks(d: &ErrorDistribution) -> Vec<HistogramMark> {
    let mark = |name, si: f64, ink| HistogramMark { name, value: d.unit.from_si(si), ink };
    let mut marks = vec![
        mark("mean", d.samples.mean.value, Ink::Text),
        mark("p95", d.samples.p95.value, Ink::Green),
        mark("p99", d.samples.p99.value, Ink::Purple),
        mark("worst case", d.figures.worst, Ink::Orange),
    ];
    marks.extend(d.signed.map(|v| mark("signed sample", v, Ink::Sky)));
    marks.extend(d.limit.map(|v| mark("requirement", v, Ink::Vermilion)));
    marks.sort_by(|a, b| a.value.total_cmp(&b.value));
    marks
}

/// Position of the name of a mark: left end, and row above the plot.
struct Name {
    said: String,
    x: f64,
    row: usize,
}

fn names(marks: &[&HistogramMark], x: &AxisScale, word: &str) -> Vec<Name> {
    let placed = marks.iter().map(|m| {
        let said = format!("{} {} {word}", m.name, words::figure(m.value));
        let (px, wide) = (x.at(m.value), words::width(&said, SMALL));
        let left = if px + 5.0 + wide <= WIDTH - 4.0 { px + 5.0 } else { px - 5.0 - wide };
        (said, px, left, left + wide)
    });
    let placed: Vec<_> = placed.collect();
    let rows = rows(&placed.iter().map(|p| (p.1, p.2, p.3)).collect::<Vec<_>>());
    placed.into_iter().zip(rows).map(|((said, _, x, _), row)| Name { said, x, row }).collect()
}

/// Returns a row for each name, such that no name crosses a line or another name. Row 0 is the lowest row. A
/// mark consists of the x of its line, and the left and the right end of its name, px.
pub fn rows(marks: &[(f64, f64, f64)]) -> Vec<usize> {
    let mut rows = vec![0; marks.len()];
    let crosses =
        |other: usize, k: usize| marks[other].0 > marks[k].1 - 3.0 && marks[other].0 < marks[k].2 + 3.0;
    let touches =
        |k: usize, other: usize| marks[k].1 < marks[other].2 + 6.0 && marks[other].1 < marks[k].2 + 6.0;
    let pairs = || (0..marks.len()).flat_map(|k| (0..marks.len()).map(move |other| (k, other)));
    for _ in 0..marks.len() * marks.len() {
        for (k, other) in pairs().filter(|(k, other)| k != other) {
            // If each of two lines crosses the name of the other line, the left name moves up.
            let is_below = crosses(other, k) && (k < other || !crosses(k, other));
            if is_below && rows[k] <= rows[other] || rows[k] == rows[other] && k < other && touches(k, other)
            {
                rows[k] = rows[other] + 1;
            }
        }
    }
    rows
}

fn bars(
    canvas: &mut ChartCanvas,
    d: &ErrorDistribution,
    x: &AxisScale,
    y: &AxisScale,
    share: &dyn Fn(u32) -> f64,
) {
    let h = &d.samples.histogram;
    for (k, count) in h.counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let [from, to] = [k, k + 1].map(|k| h.low + h.width() * k as f64);
        let is_beyond = d.limit.is_some_and(|limit| (from + to) / 2.0 > limit);
        let fill = if is_beyond { Ink::Vermilion } else { Ink::Blue }.fill();
        let [left, right] = [from, to].map(|v| x.at(d.unit.from_si(v)));
        let top = y.at(share(*count));
        // Even a spread of zero gets a visible bar.
        let wide = (right - left).max(1.5);
        canvas.put(&format!(
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{wide:.2}\" height=\"{:.2}\" {fill} \
             fill-opacity=\"0.75\"/>",
            y.px.0 - top
        ));
    }
}

fn told(d: &ErrorDistribution) -> Vec<String> {
    let mut told = vec![format!(
        "{} samples, evaluated with the nonlinear model; vertical: share of the samples in each bin / %",
        d.samples.samples
    )];
    if let Some(success) = d.samples.success {
        told.push(format!(
            "within the requirement: {:.3} % of the samples ({:.3} to {:.3} % with 95 % confidence)",
            percent_from_share(success.value),
            percent_from_share(success.low.max(0.0)),
            percent_from_share(success.high.min(1.0))
        ));
    }
    told
}

fn legend(d: &ErrorDistribution) -> Vec<LegendEntry> {
    let block = |ink: Ink| format!("<path d=\"M-9 -6H9V6H-9Z\" {} fill-opacity=\"0.75\"/>", ink.fill());
    let entry = |ink, said: &str| LegendEntry { mark: block(ink), said: said.to_string() };
    match d.limit {
        Some(_) => vec![entry(Ink::Blue, "within the requirement"), entry(Ink::Vermilion, "beyond it")],
        None => vec![entry(Ink::Blue, "samples")],
    }
}
