//! Pareto front of layouts in the plane of two goals.

use super::axes;

use super::axes::AxisScale;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, SMALL};
use super::labels::OccupiedBoxes;
use super::{WIDTH, words};
use crate::cell::{Cell, Goal};
use crate::record::goals;
use crate::search::SearchRecord;
use crate::units::rounded;

const HEIGHT: f64 = 330.0;

/// Draws the Pareto front. The vertical axis shows the error, and the horizontal axis shows the first other
/// goal. If the error is not a goal, the vertical axis shows the first goal, and the horizontal axis shows
/// the second goal. Returns None if the search had fewer than two goals or the front is empty.
pub fn pareto(cell: &Cell, record: &SearchRecord) -> Option<String> {
    let asked: Vec<Goal> = cell.search.pareto.iter().collect();
    let up = *asked.iter().find(|g| **g == Goal::Error).or(asked.first())?;
    let across = *asked.iter().find(|g| **g != up)?;
    if record.alternatives.is_empty() {
        return None;
    }
    let heading = format!("{}: {}", cell.name, goals::in_words(&cell.search.pareto, record));
    let others = asked.len() > 2;
    let under =
        others.then(|| "a layout that looks worse here is better in a goal that is not drawn".to_string());
    let mut canvas = ChartCanvas::new(&heading, under.as_slice());
    let top = canvas.y + 26.0;
    let [xs, ys] = [across, up].map(|goal| values(cell, record, goal));
    let x = scale(&xs, (78.0, WIDTH - EDGE - 20.0));
    let y = scale(&ys, (top + HEIGHT, top));
    axes::draw(&mut canvas, &x, &y, (&name(cell, across), &name(cell, up)));
    let mut taken = OccupiedBoxes::default();
    let at: Vec<_> = xs.iter().zip(&ys).map(|(a, b)| (x.at(*a), y.at(*b))).collect();
    at.iter().for_each(|(px, py)| taken.keep([px - 4.0, py - 4.0, px + 4.0, py + 4.0]));
    for (k, (px, py)) in at.iter().enumerate() {
        let number = (k + 1).to_string();
        let (fill, [a, b]) = (Ink::Blue.fill(), [rounded(xs[k], 4), rounded(ys[k], 4)]);
        canvas.put(&format!(
            "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4.5\" {fill}><title>layout {number}: {} {a}, {} {b}</title>\
             </circle>",
            goals::head(cell, across),
            goals::head(cell, up),
        ));
        let wide = words::width(&number, SMALL);
        let places = [(6.0, -6.0), (6.0, 13.0), (-6.0 - wide, -6.0), (-6.0 - wide, 13.0)];
        let free = places.into_iter().map(|(dx, dy)| (px + dx, py + dy));
        let free = free.into_iter().find(|(l, base)| taken.take([*l, base - 10.0, l + wide, *base]));
        if let Some((left, base)) = free {
            canvas.label((left, base), Anchor::Start, Ink::Text, &number);
        }
    }
    Some(canvas.finish())
}

fn values(cell: &Cell, record: &SearchRecord, goal: Goal) -> Vec<f64> {
    let place = Goal::ALL.iter().position(|g| *g == goal).unwrap_or(0);
    record.alternatives.iter().map(|a| goals::value(cell, goal, a.goals[place])).collect()
}

fn name(cell: &Cell, goal: Goal) -> String {
    let wish = if goal.is_gain() { "more is better" } else { "less is better" };
    format!("{} ({wish})", goals::head(cell, goal))
}

fn scale(values: &[f64], px: (f64, f64)) -> AxisScale {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    let pad = if high > low { (high - low) * 0.06 } else { low.abs().max(1.0) * 0.05 };
    AxisScale::linear(low - pad, high + pad, px)
}
