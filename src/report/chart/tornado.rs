//! Tornado chart of the error budget of a spot: which parameter to tighten first.

use super::axes;

use super::axes::AxisScale;
use super::canvas::{Anchor, BODY, ChartCanvas, EDGE, Ink};
use super::{WIDTH, words};
use crate::assess::BudgetReport;
use crate::cell::Reading;
use crate::reading::Share;
use crate::record::{ParameterUnit, parameter_names as names};
use crate::units::{percent_from_share, rounded};

/// Largest number of parameters that get a bar each; all other parameters share one bar.
const BARS: usize = 16;
const ROW: f64 = 24.0;

/// Draws the share of each parameter in the worst case or in the variance, with the largest share first. Text
/// beside the longest bars states how much the error figure decreases if the tolerance of the parameter is
/// halved.
pub fn tornado(a: &BudgetReport<'_>) -> String {
    let cell = a.context.cell;
    let of = share_of(a);
    let what = if a.context.evaluator.reading == Reading::Statistical { "variance" } else { "worst case" };
    let name = &cell.operations[a.context.operation].name;
    let shares: Vec<&Share> = a.budget.shares.iter().filter(|s| of(s).abs() > 1e-6).collect();
    let mut canvas = ChartCanvas::new(
        &format!("{name}: share of the {what} in {}", a.context.evaluator.sense.name),
        &under(a, shares.len()),
    );
    if shares.is_empty() {
        return canvas.finish();
    }
    let mut rows: Vec<(String, f64, String)> = shares.iter().take(BARS).map(|s| row(a, s, of(s))).collect();
    if shares.len() > BARS {
        let rest: f64 = shares[BARS..].iter().map(|s| of(s)).sum();
        rows.push((format!("{} others", shares.len() - BARS), rest, String::new()));
    }
    let wide = rows.iter().map(|r| words::width(&r.0, BODY)).fold(60.0, f64::max).min(250.0);
    let most = rows.iter().map(|r| r.1).fold(0.0, f64::max);
    let least = rows.iter().map(|r| r.1).fold(0.0, f64::min);
    let top = canvas.y + 6.0;
    let bottom = top + ROW * rows.len() as f64 + 4.0;
    let said = rows.iter().map(|r| words::width(&r.2, BODY)).fold(0.0, f64::max).min(230.0);
    let right = WIDTH - EDGE - 62.0 - said;
    let x =
        AxisScale::linear(percent_from_share(least), percent_from_share(most), (EDGE + wide + 12.0, right));
    let y = AxisScale::linear(0.0, 1.0, (bottom, top));
    axes::across(&mut canvas, &x, &y, &format!("share of the {what} / %"));
    for (k, row) in rows.iter().enumerate() {
        bar(&mut canvas, &x, row, top + ROW * k as f64, wide);
    }
    canvas.path(&format!("M{0:.1} {top:.1}V{bottom:.1}", x.at(0.0)), &Ink::Axis.line(1.0));
    canvas.y = bottom + 40.0;
    gains(a).iter().for_each(|said| canvas.paragraph(said));
    canvas.finish()
}

/// Returns the function that picks the share to draw. Under the statistical reading, this is the share of the
/// variance. Under any other reading, this is the share of the worst case.
fn share_of(a: &BudgetReport<'_>) -> fn(&Share) -> f64 {
    match a.context.evaluator.reading {
        Reading::Statistical => |s| s.of_variance,
        _ => |s| s.of_worst,
    }
}

fn under(a: &BudgetReport<'_>, count: usize) -> Vec<String> {
    let unit = a.unit();
    let word = unit.word();
    if count == 0 {
        return vec!["no parameter has an effect here".to_string()];
    }
    vec![format!(
        "{count} parameters have an effect; the total is {} {word}; the shares are first-order",
        words::figure(unit.from_si(a.figure))
    )]
}

/// Returns the label of a bar (parameter and tolerance), its share, and the gain of halving the tolerance as
/// text.
fn row(a: &BudgetReport<'_>, share: &Share, part: f64) -> (String, f64, String) {
    let cell = a.context.cell;
    let unit = ParameterUnit::new(cell, share.parameter);
    let tolerance = rounded(unit.from_si(share.plus_minus), 4);
    let name = format!("{} \u{b1}{tolerance} {}", names::parameter(cell, share.parameter), unit.word());
    let alone = a.tighter.iter().find(|t| t.parameters[..] == [share.parameter]);
    let gain = alone.map(|t| format!("if halved: \u{2212}{}", percent(a.cut(t)))).unwrap_or_default();
    (name, part, gain)
}

fn percent(share: f64) -> String {
    format!("{:.1} %", rounded(percent_from_share(share), 1))
}

fn bar(
    canvas: &mut ChartCanvas,
    x: &AxisScale,
    (name, part, gain): &(String, f64, String),
    top: f64,
    wide: f64,
) {
    let (from, to) = (x.at(0.0), x.at(percent_from_share(*part)));
    let (left, length) = (from.min(to), (to - from).abs());
    let is_rest = name.ends_with(" others") && gain.is_empty();
    let fill = if is_rest { Ink::Axis } else { Ink::Blue }.fill();
    canvas.put(&format!(
        "<rect x=\"{left:.2}\" y=\"{:.1}\" width=\"{length:.2}\" height=\"{:.1}\" {fill}/>",
        top + 4.0,
        ROW - 8.0
    ));
    let base = top + ROW / 2.0 + 4.5;
    let name = words::shortened(name, BODY, wide);
    canvas.text((EDGE + wide, base), Anchor::End, Ink::Text, &name);
    canvas.text((from.max(to) + 7.0, base), Anchor::Start, Ink::Text, &percent(*part));
    canvas.text((WIDTH - EDGE, base), Anchor::End, Ink::Faint, gain);
}

/// Returns the line on the gain of halving several tolerances together, if the report states that gain.
fn gains(a: &BudgetReport<'_>) -> Vec<String> {
    let Some(all) = a.tighter.iter().find(|t| t.parameters.len() > 1) else { return Vec::new() };
    let (unit, cell) = (a.unit(), a.context.cell);
    let names: Vec<String> = all.parameters.iter().map(|p| names::parameter(cell, *p)).collect();
    let [from, to] = [a.figure, all.figure].map(|v| words::figure(unit.from_si(v)));
    vec![format!(
        "halving the tolerances of {} together: from {from} to {to} {} (\u{2212}{})",
        names.join(", "),
        unit.word(),
        percent(a.cut(all))
    )]
}
