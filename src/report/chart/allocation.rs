//! Chart of a tolerance allocation: every tolerance before and after.

use super::axes;
use super::axes::AxisScale;
use super::canvas::{Anchor, BODY, ChartCanvas, EDGE, Ink};
use super::{WIDTH, words};
use crate::record::{AllocatedEntry, AllocationDocument};
use crate::units::rounded;

const ROW: f64 = 24.0;
/// Largest number of tolerances that get a bar. The tolerances that change most get the bars.
const BARS: usize = 24;

/// Draws the scales of the tolerances as bars. Each bar begins at the scale 1, which stands for the present
/// tolerance. A bar extends to the left if the tolerance must be tighter, and to the right if it may be
/// looser.
pub fn allocation(d: &AllocationDocument) -> String {
    let mut canvas = ChartCanvas::new("Cheapest tolerances", &under(d));
    let mut bars: Vec<(&AllocatedEntry, f64)> =
        d.parameters.iter().filter_map(|p| Some((p, p.scale.filter(|scale| *scale > 0.0)?))).collect();
    if bars.is_empty() {
        return canvas.finish();
    }
    bars.sort_by(|a, b| b.1.ln().abs().total_cmp(&a.1.ln().abs()));
    bars.truncate(BARS);
    bars.sort_by(|a, b| a.1.total_cmp(&b.1));
    let wide = bars.iter().map(|(p, _)| words::width(&label(p), BODY)).fold(60.0, f64::max).min(270.0);
    let (least, most) =
        bars.iter().fold((0.5_f64, 2.0_f64), |(low, high), (_, scale)| (low.min(*scale), high.max(*scale)));
    let top = canvas.y + 6.0;
    let bottom = top + ROW * bars.len() as f64 + 4.0;
    let x = AxisScale::log(least, most, (EDGE + wide + 12.0, WIDTH - EDGE - 110.0));
    axes::across(
        &mut canvas,
        &x,
        &AxisScale::linear(0.0, 1.0, (bottom, top)),
        "tolerance / present tolerance",
    );
    for (k, (entry, scale)) in bars.iter().enumerate() {
        bar(&mut canvas, &x, (entry, *scale), top + ROW * k as f64, wide);
    }
    canvas.path(&format!("M{0:.1} {top:.1}V{bottom:.1}", x.at(1.0)), &Ink::Axis.line(1.0));
    canvas.y = bottom + 40.0;
    if d.parameters.len() > bars.len() {
        canvas.paragraph(&format!(
            "the {} tolerances with the smallest changes are not shown",
            d.parameters.len() - bars.len()
        ));
    }
    canvas.finish()
}

/// Returns the lines under the heading: the costs and the saving.
fn under(d: &AllocationDocument) -> Vec<String> {
    let Some(cost) = d.cost else {
        return vec!["even the tightest tolerances exceed a limit".into()];
    };
    let mut lines =
        vec![format!("cost {} now, {} with the cheapest tolerances", short(d.cost_before), short(cost))];
    lines.extend(d.uniform.map(|u| {
        format!(
            "uniform tightening costs {}; the cheapest tolerances save {} % of this cost",
            short(u.cost),
            rounded(u.saving_percent, 1)
        )
    }));
    lines
}

/// Returns the label of a bar: parameter, present tolerance and cheapest tolerance.
fn label(p: &AllocatedEntry) -> String {
    let after = p.after.map_or(String::new(), |after| format!(" \u{2192} {}", rounded(after, 4)));
    format!("{} \u{b1}{}{after} {}", p.parameter, rounded(p.before, 4), p.unit.word())
}

fn short(cost: f64) -> String {
    rounded(cost, 3).to_string()
}

fn bar(canvas: &mut ChartCanvas, x: &AxisScale, (p, scale): (&AllocatedEntry, f64), top: f64, wide: f64) {
    let (from, to) = (x.at(1.0), x.at(scale));
    let fill = if scale < 1.0 { Ink::Vermilion } else { Ink::Green }.fill();
    canvas.put(&format!(
        "<rect x=\"{:.2}\" y=\"{:.1}\" width=\"{:.2}\" height=\"{:.1}\" {fill}/>",
        from.min(to),
        top + 4.0,
        (to - from).abs(),
        ROW - 8.0
    ));
    let base = top + ROW / 2.0 + 4.5;
    canvas.text((EDGE + wide, base), Anchor::End, Ink::Text, &words::shortened(&label(p), BODY, wide));
    let cost = p.cost.map_or(String::new(), |cost| format!("cost {}", short(cost)));
    canvas.text((WIDTH - EDGE, base), Anchor::End, Ink::Faint, &cost);
}
