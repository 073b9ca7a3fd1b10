//! Effect of misplaced equipment on an operation: the change of its value with every coordinate, and the
//! allowed misplacement.

use super::axes;

use super::axes::AxisScale;
use super::canvas::{Anchor, BODY, ChartCanvas, EDGE, Ink};
use super::{WIDTH, words};
use crate::cell::{Cell, Slot, Unit};
use crate::layout::{Largest, MisplacementEnd, Robustness};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, percent_from_share, rad_from_deg};

const ROW: f64 = 24.0;

/// Draws the change of the value of an operation for 1 mm or 1 degree of each coordinate.
pub fn misplacement(cell: &Cell, operation: usize, r: &Robustness) -> String {
    let (unit, word) = (cell.unit(), cell.unit().word());
    let heading = format!("{}: sensitivity to misplacement", cell.operations[operation].name);
    let mut canvas = ChartCanvas::new(&heading, &told(cell, operation, r));
    let rows: Vec<(String, Option<f64>)> =
        r.gradient.iter().map(|(slot, slope)| row(cell, *slot, *slope)).collect();
    if rows.is_empty() {
        return canvas.finish();
    }
    let values = || rows.iter().filter_map(|r| r.1).map(|v| unit.from_si(v));
    let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
    let pad = if high > low { 0.16 * (high - low) } else { 1e-3 };
    let wide = rows.iter().map(|r| words::width(&r.0, BODY)).fold(60.0, f64::max).min(260.0);
    let top = canvas.y + 6.0;
    let bottom = top + ROW * rows.len() as f64 + 4.0;
    let left = if low < 0.0 { low - pad } else { 0.0 };
    let right = if high > 0.0 { high + pad } else { 0.0 };
    let x = AxisScale::linear(left, right, (EDGE + wide + 14.0, WIDTH - EDGE - 16.0));
    let y = AxisScale::linear(0.0, 1.0, (bottom, top));
    let axis = format!("change of the value for +1 mm or +1 deg / {word}");
    axes::across(&mut canvas, &x, &y, &axis);
    for (k, (name, slope)) in rows.iter().enumerate() {
        let value = slope.map(|v| unit.from_si(v));
        bar(&mut canvas, &x, (name, value), top + ROW * k as f64, wide);
    }
    canvas.path(&format!("M{0:.1} {top:.1}V{bottom:.1}", x.at(0.0)), &Ink::Axis.line(1.2));
    canvas.y = bottom + 42.0;
    canvas.finish()
}

/// Returns a label such as "worktable yaw +1 deg", and the change of the value (SI) for this step.
fn row(cell: &Cell, slot: Slot, slope: Option<f64>) -> (String, Option<f64>) {
    let (whose, axis) = match slot {
        Slot::Equipment(k, axis) => (cell.equipment[k].name.as_str(), axis),
        Slot::Base(axis) => ("robot base", axis),
        Slot::Attitude(k, _) => (cell.operations[k].name.as_str(), 3),
    };
    let (word, one) = if slot.is_angle() { ("deg", rad_from_deg(1.0)) } else { ("mm", m_from_mm(1.0)) };
    let whose = words::shortened(whose, BODY, 170.0);
    (format!("{whose} {} +1 {word}", ["x", "y", "z", "yaw"][axis]), slope.map(|s| s * one))
}

fn bar(canvas: &mut ChartCanvas, x: &AxisScale, (name, value): (&str, Option<f64>), top: f64, wide: f64) {
    let base = top + ROW / 2.0 + 4.5;
    canvas.text((EDGE + wide, base), Anchor::End, Ink::Text, &words::shortened(name, BODY, wide));
    let zero = x.at(0.0);
    let Some(value) = value else {
        canvas.label((zero + 7.0, base), Anchor::Start, Ink::Faint, "at the limit of the reach");
        return;
    };
    let to = x.at(value);
    // An increase is bad and a decrease is good. The two cases have different colours.
    let fill = if value > 0.0 { Ink::Vermilion } else { Ink::Blue }.fill();
    canvas.put(&format!(
        "<rect x=\"{:.2}\" y=\"{:.1}\" width=\"{:.2}\" height=\"{:.1}\" {fill}/>",
        zero.min(to),
        top + 4.0,
        (to - zero).abs(),
        ROW - 8.0
    ));
    let said = format!("{}{}", if value > 0.0 { "+" } else { "" }, words::figure(value));
    let (at, anchor) = if value < 0.0 { (to - 6.0, Anchor::End) } else { (to + 6.0, Anchor::Start) };
    canvas.label((at, base), anchor, Ink::Text, &said);
}

fn told(cell: &Cell, operation: usize, r: &Robustness) -> Vec<String> {
    let amount = |si: f64| match cell.unit() {
        Unit::Share => format!("{} %", words::figure(percent_from_share(si))),
        unit => format!("{} {}", words::figure(unit.from_si(si)), unit.word()),
    };
    let worst = match (&r.worst, r.lost.len()) {
        (_, lost) if lost > 0 => {
            format!("; NOT feasible at {lost} of {} corners of the placement tolerances", r.corners)
        }
        (Some(worst), _) => {
            format!("; {} at the worst corner of the placement tolerances", amount(worst.value))
        }
        (None, _) => "; no placement tolerance is given".to_string(),
    };
    let on = &cell.equipment[cell.operations[operation].equipment].name;
    let shift = most(&r.shift, &|v| format!("{} mm in plan", words::figure(mm_from_m(v))));
    let turn = most(&r.turn, &|v| format!("{} deg in yaw", words::figure(deg_from_rad(v))));
    let mut told = vec![format!("{} without misplacement{worst}", amount(r.value))];
    told.push(format!("{on} may be misplaced by at most {shift}, or {turn}"));
    if let Some(scale) = &r.scale {
        let times = most(scale, &|v| format!("{} times the placement tolerances", words::figure(v)));
        told.push(format!("all pieces misplaced together: at most {times}"));
    }
    told
}

fn most(largest: &Largest, said: &dyn Fn(f64) -> String) -> String {
    let ended = match &largest.ended {
        None => " (the largest value tried)",
        Some(MisplacementEnd::Limit(_)) => " (beyond that, the operation exceeds its limit)",
        Some(MisplacementEnd::Lost(_)) => " (beyond that, the operation is not feasible)",
    };
    said(largest.most) + ended
}
