//! The legend of the map picture: colour scale, signs, scale bar.

use super::view::{LEGEND, MARGIN, View, escaped};
use crate::compare::Assessment;
use std::fmt::Write;

/// Least and greatest colour: viridis (M. Bigot, S. van der Walt and N. Smith; CC0) at equal steps,
/// even in lightness and safe for colour-blind readers.
const COLOURS: [(f64, f64, f64); 6] = [
    (68.0, 1.0, 84.0),
    (65.0, 68.0, 135.0),
    (42.0, 120.0, 142.0),
    (34.0, 168.0, 132.0),
    (122.0, 209.0, 81.0),
    (253.0, 231.0, 37.0),
];

/// How far the arm reaches: a thin line.
pub(super) const ENVELOPE_STYLE: &str = "stroke=\"#0969a8\" stroke-width=\"1.2\" stroke-dasharray=\"7 3\"";

pub(super) fn draw_legend(
    out: &mut String,
    a: &Assessment<'_>,
    view: &View,
    range: (f64, f64),
    enlarged: f64,
) {
    let (_, height) = view.size();
    let top = height - LEGEND - 2.0;
    for k in 0..60 {
        let fill = colour(f64::from(k) / 59.0);
        let _ = writeln!(
            out,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"4.2\" height=\"12\" fill=\"{fill}\"/>",
            MARGIN + 4.0 * f64::from(k),
            top + 18.0
        );
    }
    let mut senses: Vec<_> = a.cell.operations.iter().map(|o| o.sense.name.as_str()).collect();
    senses.dedup();
    let unit = a.cell.unit().word();
    let mut text = |x: f64, y: f64, what: &str| {
        let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(what));
    };
    text(MARGIN, top + 10.0, &format!("{} in {}", super::text::value_word(a.cell), senses.join(", ")));
    text(MARGIN, top + 46.0, &format!("{:.2} {unit}", range.0));
    text(MARGIN + 190.0, top + 46.0, &format!("{:.2} {unit}", range.1));
    text(MARGIN, top + 68.0, &format!("arrows: error in x and y, {enlarged} times enlarged"));
    text(MARGIN + 330.0, top + 10.0, "out of reach");
    text(MARGIN + 330.0, top + 30.0, "joint limit, attitude");
    text(MARGIN + 330.0, top + 50.0, "collides, or no way in");
    text(MARGIN + 330.0, top + 70.0, "spot chosen");
    text(MARGIN + 330.0, top + 90.0, "reach at this height");
    let x = MARGIN + 315.0;
    let _ = writeln!(
        out,
        "<circle cx=\"{x}\" cy=\"{0:.1}\" r=\"4.6\" fill=\"none\" stroke=\"#6e7781\"/>\
         <circle cx=\"{x}\" cy=\"{1:.1}\" r=\"4.6\" fill=\"none\" stroke=\"#6e7781\" stroke-dasharray=\"2 1.6\"/>\
         <path d=\"M{2:.1} {3:.1}l7 7m0 -7l-7 7\" stroke=\"#cf222e\" stroke-width=\"1.5\" fill=\"none\"/>\
         <circle cx=\"{x}\" cy=\"{4:.1}\" r=\"7\" fill=\"none\" stroke=\"#bf3989\" stroke-width=\"2.4\"/>\
         <path d=\"M{5:.1} {6:.1}h20\" {ENVELOPE_STYLE}/>",
        top + 6.0,
        top + 26.0,
        x - 3.5,
        top + 42.0,
        top + 66.0,
        x - 10.0,
        top + 86.0
    );
    draw_scale_bar(out, view, top);
}

/// Half a metre, and the directions of the world axes.
fn draw_scale_bar(out: &mut String, view: &View, top: f64) {
    let (x, y, length) = (MARGIN + 520.0, top + 70.0, 0.5 * view.scale);
    let _ = writeln!(
        out,
        "<path d=\"M{x:.1} {0:.1}v8m0 -4h{length:.1}m0 -4v8\" stroke=\"#1b1f24\" fill=\"none\"/>\
         <text x=\"{1:.1}\" y=\"{0:.1}\" text-anchor=\"middle\">500 mm</text>\
         <path d=\"M{x:.1} {2:.1}h26m-5 -3l5 3l-5 3M{x:.1} {2:.1}v-26m-3 5l3 -5l3 5\" stroke=\"#1b1f24\" fill=\"none\"/>\
         <text x=\"{3:.1}\" y=\"{4:.1}\">x</text><text x=\"{5:.1}\" y=\"{6:.1}\">y</text>",
        y - 4.0,
        x + length / 2.0,
        top + 34.0,
        x + 30.0,
        top + 38.0,
        x - 3.0,
        top + 4.0
    );
}

/// A colour of the scale, 0 to 1, as markup says it.
pub(super) fn colour(t: f64) -> String {
    let [r, g, b] = rgb(t).map(|c| c.round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A colour of the scale, 0 to 1: red, green and blue (sRGB), 0 to 255.
pub(super) fn rgb(t: f64) -> [f64; 3] {
    let t = t.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let k = (t.floor() as usize).min(COLOURS.len() - 2);
    let (a, b, f) = (COLOURS[k], COLOURS[k + 1], t - k as f64);
    let mix = |a: f64, b: f64| a + (b - a) * f;
    [mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2)]
}
