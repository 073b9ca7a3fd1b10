//! Convergence of a search: best objective against evaluations, and the proven lower bound.

use super::axes;

use super::axes::AxisScale;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry};
use super::{WIDTH, words};
use crate::cell::Unit;
use crate::search::SearchRecord;
use crate::svg_text::{PathEnd, path_data};
use crate::units::percent_from_share;

const HEIGHT: f64 = 300.0;
/// The axis is logarithmic if the ratio of the greatest to the least objective is above this value.
const LOGARITHMIC_SPAN: f64 = 30.0;

/// Convergence history of a search. Objectives are in m or rad, or are costs or shares of failures.
pub struct ConvergenceHistory<'a> {
    /// Number of evaluations and objective at each improvement.
    pub trace: &'a [(u64, f64)],
    pub evaluations: u64,
    /// Objective of the layout before the search; None if that layout is not feasible.
    pub start: Option<f64>,
    /// Proven lower bound of the objective.
    pub bound: Option<f64>,
    pub unit: Unit,
}

impl<'a> ConvergenceHistory<'a> {
    pub fn of(record: &'a SearchRecord, unit: Unit) -> Self {
        let start = record.start.evaluation.objective;
        let SearchRecord { trace, evaluations, bound, .. } = record;
        Self { trace, evaluations: *evaluations, start, bound: *bound, unit }
    }

    fn best(&self) -> Option<f64> {
        self.trace.last().map(|t| t.1)
    }
}

/// Draws the best objective so far against the evaluations.
pub fn convergence(course: &ConvergenceHistory<'_>) -> String {
    let (unit, word) = (course.unit, course.unit.word());
    let mut canvas = ChartCanvas::new("Convergence of the search", &told(course));
    let values = course.trace.iter().map(|t| t.1).chain(course.start).chain(course.bound);
    let values: Vec<f64> = values.map(|v| unit.from_si(v)).collect();
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    if course.trace.is_empty() || low > high {
        return canvas.finish();
    }
    let top = canvas.y + 26.0;
    let span = (top + HEIGHT, top);
    let y = if low > 0.0 && high > LOGARITHMIC_SPAN * low {
        AxisScale::log(low * 0.8, high * 1.25, span)
    } else {
        let pad = if high > low { 0.08 * (high - low) } else { 0.1 * high.abs() };
        AxisScale::linear(low - pad, high + pad, span)
    };
    let x = AxisScale::log(1.0, (course.evaluations as f64).max(10.0), (70.0, WIDTH - EDGE));
    gap(&mut canvas, course, &x, &y);
    axes::draw(&mut canvas, &x, &y, ("layouts evaluated", &format!("best objective / {word}")));
    let at = |(evaluations, value): (f64, f64)| (x.at(evaluations), y.at(unit.from_si(value)));
    let points: Vec<_> = steps(course).into_iter().map(at).collect();
    canvas.path(&path_data(points.iter().copied(), PathEnd::Open, 1), &Ink::Blue.line(2.2));
    marks(&mut canvas, course, &x, &y);
    canvas.legend(&legend(course));
    canvas.finish()
}

/// Returns the corners of the step line, which is horizontal until the next improvement.
fn steps(course: &ConvergenceHistory<'_>) -> Vec<(f64, f64)> {
    let mut corners: Vec<(f64, f64)> = Vec::new();
    for &(evaluations, value) in course.trace {
        if let Some(&(_, before)) = corners.last() {
            corners.push((evaluations as f64, before));
        }
        corners.push((evaluations as f64, value));
    }
    corners.extend(course.best().map(|best| (course.evaluations as f64, best)));
    corners
}

/// Draws the gap between the lower bound and the best objective. A better layout can only have an objective
/// in this range.
fn gap(canvas: &mut ChartCanvas, course: &ConvergenceHistory<'_>, x: &AxisScale, y: &AxisScale) {
    let (Some(best), Some(bound)) = (course.best(), course.bound) else { return };
    let (best, bound) = (y.at(course.unit.from_si(best)), y.at(course.unit.from_si(bound)));
    let (left, right) = x.px;
    canvas.path(
        &format!("M{left:.1} {best:.1}H{right:.1}V{bound:.1}H{left:.1}Z"),
        &format!("{} fill-opacity=\"0.14\"", Ink::Green.fill()),
    );
    canvas.path(&format!("M{left:.1} {bound:.1}H{right:.1}"), &dashed());
}

fn dashed() -> String {
    format!("{} stroke-dasharray=\"7 4\"", Ink::Green.line(2.0))
}

/// Marks the objective before the search and the best objective, with their values.
fn marks(canvas: &mut ChartCanvas, course: &ConvergenceHistory<'_>, x: &AxisScale, y: &AxisScale) {
    let unit = course.unit;
    let said = |si: f64| format!("{} {}", words::figure(unit.from_si(si)), unit.word());
    if let Some(start) = course.start {
        let (px, py) = (x.at(1.0), y.at(unit.from_si(start)));
        let fill = Ink::Orange.fill();
        canvas.put(&format!("<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"5\" {fill}/>"));
        canvas.label((px + 10.0, py - 8.0), Anchor::Start, Ink::Text, &format!("start {}", said(start)));
    }
    if let Some(best) = course.best() {
        let (px, py) = (x.px.1, y.at(unit.from_si(best)));
        let fill = Ink::Blue.fill();
        canvas.put(&format!("<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"5\" {fill}/>"));
        // The curve comes from above, so the label goes below the point, unless the line of the lower bound
        // is there.
        let bound = course.bound.map_or(y.px.0, |b| y.at(unit.from_si(b)));
        let away = if bound - py > 22.0 { 17.0 } else { -8.0 };
        canvas.label((px - 10.0, py + away), Anchor::End, Ink::Text, &format!("best {}", said(best)));
    }
    if let (Some(best), Some(bound)) = (course.best(), course.bound) {
        let (upper, lower) = (y.at(unit.from_si(best)), y.at(unit.from_si(bound)));
        // The label goes below its line, unless the plot ends there and there is space above the line.
        let below = if y.px.0 - lower > 20.0 || lower - upper < 34.0 { 15.0 } else { -6.0 };
        let at = (x.px.0 + 8.0, lower + below);
        canvas.label(at, Anchor::Start, Ink::Text, &format!("bound {}", said(bound)));
    }
}

fn told(course: &ConvergenceHistory<'_>) -> Vec<String> {
    let (unit, count) = (course.unit, course.evaluations);
    let Some(best) = course.best() else {
        return vec![format!("no feasible layout among {count} evaluated")];
    };
    let said = |si: f64| format!("{} {}", words::figure(unit.from_si(si)), unit.word());
    let gain = course
        .start
        .filter(|start| *start > 0.0)
        .map(|start| format!(", {:.1} % less than the start layout", percent_from_share(1.0 - best / start)));
    let mut told =
        vec![format!("best objective {} after {count} layouts{}", said(best), gain.unwrap_or_default())];
    told.push(match course.bound {
        Some(bound) if bound > 0.0 => {
            let gap = percent_from_share(best / bound - 1.0);
            let digits = if gap < 0.1 { 4 } else { 2 };
            format!(
                "proven: no layout has an objective below {}; the least found is {gap:.digits$} % above \
                 this bound",
                said(bound)
            )
        }
        _ => "no bound was proven, so it is not known how much better a layout could be".to_string(),
    });
    told
}

fn legend(course: &ConvergenceHistory<'_>) -> Vec<LegendEntry> {
    let dot = |ink: Ink| format!("<circle r=\"5\" {}/>", ink.fill());
    let line = |paint: &str| format!("<path d=\"M-12 0H12\" {paint}/>");
    let ground = format!("<path d=\"M-12 -6H12V6H-12Z\" {} fill-opacity=\"0.14\"/>", Ink::Green.fill());
    let entry = |mark: String, said: &str| LegendEntry { mark, said: said.to_string() };
    let mut entries = vec![entry(line(&Ink::Blue.line(2.2)), "best so far")];
    entries.extend(course.start.map(|_| entry(dot(Ink::Orange), "layout as drawn")));
    if course.bound.is_some() {
        entries.push(entry(line(&dashed()), "proven bound"));
        entries.push(entry(ground, "gap: objectives that the bound does not rule out"));
    }
    entries
}
