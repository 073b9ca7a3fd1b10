//! front.svg: the layouts of a front by two of their goals.

use super::goals;
use super::view::escaped;
use crate::cell::{Cell, Goal};
use crate::search::SearchRecord;
use crate::units::rounded;
use std::fmt::Write;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 440.0;
/// Left, top, right and bottom of the plot.
const PLOT: (f64, f64, f64, f64) = (90.0, 64.0, 610.0, 380.0);
const TICKS: f64 = 5.0;

/// One axis: a goal, its values in the unit of reports, and what they span.
struct Axis {
    goal: Goal,
    values: Vec<f64>,
    low: f64,
    high: f64,
}

impl Axis {
    fn new(cell: &Cell, record: &SearchRecord, goal: Goal) -> Self {
        let place = Goal::ALL.iter().position(|g| *g == goal).unwrap_or(0);
        let all = record.alternatives.iter().map(|a| goals::value(cell, goal, a.goals[place]));
        let values: Vec<f64> = all.collect();
        let (low, high) =
            values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        let pad = if high > low { (high - low) * 0.05 } else { low.abs().max(1.0) * 0.05 };
        Self { goal, values, low: low - pad, high: high + pad }
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Round numbers, about [`TICKS`] of them.
    fn ticks(&self) -> impl Iterator<Item = f64> + '_ {
        let apart = (self.high - self.low) / TICKS;
        let decade = 10f64.powf(apart.log10().floor());
        let step =
            [1.0, 2.0, 5.0, 10.0].map(|s| s * decade).into_iter().find(|s| *s >= apart).unwrap_or(apart);
        let first = (self.low / step).ceil() as i64;
        (first..).map(move |k| rounded(k as f64 * step, 9)).take_while(|v| *v <= self.high)
    }
}

/// The front by its error, up, and the first other goal, across; without the error by the first two goals.
/// None if there is nothing to draw.
pub fn picture(cell: &Cell, record: &SearchRecord) -> Option<String> {
    let asked: Vec<Goal> = cell.search.pareto.iter().collect();
    let up = *asked.iter().find(|g| **g == Goal::Error).or(asked.first())?;
    let across = *asked.iter().find(|g| **g != up)?;
    if record.alternatives.is_empty() {
        return None;
    }
    let (x, y) = (Axis::new(cell, record, across), Axis::new(cell, record, up));
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" \
         height=\"{HEIGHT}\" font-family=\"system-ui, sans-serif\" font-size=\"13\" fill=\"#1b1f24\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n\
         <text x=\"20\" y=\"28\" font-size=\"16\" font-weight=\"600\">{}: {}</text>",
        escaped(&cell.name),
        goals::in_words(&cell.search.pareto, record)
    );
    draw_axes(&mut out, cell, &x, &y);
    for (k, (a, b)) in x.values.iter().zip(&y.values).enumerate() {
        let ((px, py), number) = (at(x.share(*a), y.share(*b)), k + 1);
        let _ = writeln!(
            out,
            "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4\" fill=\"#0969da\"><title>layout {number}: {} {}, {} {}\
             </title></circle>\n<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\">{number}</text>",
            goals::head(cell, x.goal),
            rounded(*a, 4),
            goals::head(cell, y.goal),
            rounded(*b, 4),
            px + 7.0,
            py - 5.0
        );
    }
    out.push_str("</svg>\n");
    Some(out)
}

/// A point of the plot by its shares of the axes.
fn at(across: f64, up: f64) -> (f64, f64) {
    let (left, top, right, bottom) = PLOT;
    (left + across * (right - left), bottom - up * (bottom - top))
}

fn draw_axes(out: &mut String, cell: &Cell, x: &Axis, y: &Axis) {
    let (left, top, right, bottom) = PLOT;
    let _ = writeln!(
        out,
        "<path d=\"M{left} {top}V{bottom}H{right}\" fill=\"none\" stroke=\"#57606a\"/>\n\
         <text x=\"{right}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n<text x=\"{left}\" y=\"{:.1}\">{}</text>",
        bottom + 42.0,
        goals::head(cell, x.goal),
        top - 8.0,
        goals::head(cell, y.goal)
    );
    for value in x.ticks() {
        let (px, py) = at(x.share(value), 0.0);
        let _ = writeln!(
            out,
            "<text x=\"{px:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"11\">{}</text>",
            py + 18.0,
            value
        );
    }
    for value in y.ticks() {
        let (px, py) = at(0.0, y.share(value));
        let _ = writeln!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" font-size=\"11\">{}</text>",
            px - 6.0,
            py + 4.0,
            value
        );
    }
}
