//! The working envelope as a picture: section and plan side by side at one scale.

use super::view::escaped;
use crate::assess::Reachable;
use crate::reach::{EnvelopeExtent, EnvelopeSection};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rounded};
use std::fmt::Write;

/// Height of the panels and the space round them, px.
const PANEL: f64 = 460.0;
const LEFT: f64 = 66.0;
const GAP: f64 = 84.0;
const TOP: f64 = 92.0;
const BOTTOM: f64 = 74.0;

/// The same ground as equipment in the map, the arm as the robot there.
const GROUND: &str = "#dcebf7";
const LINE: &str = "#0969a8";
const ARM: &str = "#bc4c00";

/// One drawing: its bounds (m) and where they lie in the picture.
struct Panel {
    low: [f64; 2],
    high: [f64; 2],
    left: f64,
    scale: f64,
}

impl Panel {
    fn at(&self, [u, v]: [f64; 2]) -> (f64, f64) {
        (self.left + (u - self.low[0]) * self.scale, TOP + (self.high[1] - v) * self.scale)
    }

    fn width(&self) -> f64 {
        (self.high[0] - self.low[0]) * self.scale
    }

    fn height(&self) -> f64 {
        (self.high[1] - self.low[1]) * self.scale
    }
}

/// Section and first plan.
pub fn picture(e: &Reachable<'_>) -> String {
    let empty = EnvelopeSection::default();
    let (height, plan) = e.plans.first().map_or((0.0, &empty), |(z, plan)| (*z, plan));
    let (sin, cos) = e.azimuth.sin_cos();
    let arm: Vec<_> = e.arm.iter().map(|p| [p.x * cos + p.y * sin, p.z]).collect();
    let arm_above: Vec<_> = e.arm.iter().map(|p| [p.x, p.y]).collect();
    let bounds = [(&e.section, &arm), (plan, &arm_above)].map(|(region, arm)| bounds(region, arm));
    let tallest = bounds.iter().map(|(low, high)| high[1] - low[1]).fold(0.0, f64::max);
    let scale = PANEL / tallest;
    let [section, above] = bounds;
    let section = Panel { low: section.0, high: section.1, left: LEFT, scale };
    let left = LEFT + section.width() + GAP;
    let above = Panel { low: above.0, high: above.1, left, scale };
    let width = (left + above.width() + 24.0).max(760.0);
    let mut out = String::new();
    head(&mut out, e, (width, TOP + PANEL + BOTTOM));
    let azimuth = rounded(deg_from_rad(e.azimuth), 1);
    axes(&mut out, &section, &format!("section at azimuth {azimuth} deg"), ["r", "z"]);
    axes(&mut out, &above, &format!("plan at z = {} mm", rounded(mm_from_m(height), 1)), ["x", "y"]);
    shape(&mut out, &section, &e.section);
    shape(&mut out, &above, plan);
    base_axis(&mut out, &section);
    cut(&mut out, &above, e.azimuth);
    line_of_arm(&mut out, &section, &arm);
    line_of_arm(&mut out, &above, &arm_above);
    foot(&mut out, e);
    out.push_str("</svg>\n");
    out
}

/// What a panel shows, with a margin, from one line of its grid to another.
fn bounds(region: &EnvelopeSection, arm: &[[f64; 2]]) -> ([f64; 2], [f64; 2]) {
    let points = || region.points().chain(arm.iter().copied()).chain([[0.0, 0.0]]);
    let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
    for k in 0..2 {
        low[k] = points().map(|p| p[k]).fold(f64::MAX, f64::min);
        high[k] = points().map(|p| p[k]).fold(f64::MIN, f64::max);
    }
    let margin = 0.06 * (high[0] - low[0]).max(high[1] - low[1]).max(m_from_mm(100.0));
    (low.map(|v| v - margin), high.map(|v| v + margin))
}

fn head(out: &mut String, e: &Reachable<'_>, (width, height): (f64, f64)) {
    let title = escaped(&super::text::envelope_title(e));
    // Writing to a String cannot fail; the results here are dropped for that reason.
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" font-family=\"system-ui, sans-serif\" font-size=\"13\" fill=\"#1b1f24\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n<title>{title}</title>\n\
         <text x=\"24\" y=\"36\" font-size=\"17\" font-weight=\"600\">{title}</text>"
    );
}

/// Frame, grid and numbers in mm.
fn axes(out: &mut String, panel: &Panel, name: &str, words: [&str; 2]) {
    let (width, height) = (panel.width(), panel.height());
    let (left, right, bottom) = (panel.left, panel.left + width, TOP + height);
    let _ = writeln!(
        out,
        "<text x=\"{left:.1}\" y=\"{:.1}\" font-weight=\"600\">{}</text>",
        TOP - 14.0,
        escaped(name)
    );
    let spacing = spacing(panel.scale);
    for axis in 0..2 {
        let (low, high) = (panel.low[axis], panel.high[axis]);
        for k in (low / spacing).ceil() as i64..=(high / spacing).floor() as i64 {
            let value = k as f64 * spacing;
            let (x, y) = panel.at([value, value]);
            let number = rounded(mm_from_m(value), 3);
            let stroke = if k == 0 { "#8c959f" } else { "#e4e8ec" };
            let _ = match axis {
                0 => writeln!(
                    out,
                    "<path d=\"M{x:.1} {TOP:.1}V{bottom:.1}\" stroke=\"{stroke}\"/><text x=\"{x:.1}\" y=\"{:.1}\" \
                     text-anchor=\"middle\" fill=\"#57606a\">{number}</text>",
                    bottom + 18.0
                ),
                _ => writeln!(
                    out,
                    "<path d=\"M{left:.1} {y:.1}H{right:.1}\" stroke=\"{stroke}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                     text-anchor=\"end\" fill=\"#57606a\">{number}</text>",
                    left - 7.0,
                    y + 4.5
                ),
            };
        }
    }
    let _ = writeln!(
        out,
        "<rect x=\"{left:.1}\" y=\"{TOP:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" \
         stroke=\"#8c959f\"/><text x=\"{right:.1}\" y=\"{:.1}\" text-anchor=\"end\">{} / mm</text>\
         <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{} / mm</text>",
        bottom + 36.0,
        words[0],
        left - 7.0,
        TOP - 14.0,
        words[1]
    );
}

/// Between grid lines, m: at least 56 px.
fn spacing(scale: f64) -> f64 {
    let steps = [50.0, 100.0, 200.0, 250.0, 500.0, 1_000.0, 2_000.0, 5_000.0, 10_000.0].map(m_from_mm);
    steps.into_iter().find(|s| s * scale >= 56.0).unwrap_or(steps[8])
}

fn shape(out: &mut String, panel: &Panel, region: &EnvelopeSection) {
    let path: String =
        region.outlines.iter().map(|o| path(o.points.iter().map(|p| panel.at(*p)), "Z")).collect();
    if !path.is_empty() {
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"{GROUND}\" fill-opacity=\"0.75\" fill-rule=\"evenodd\" stroke=\"{LINE}\" \
             stroke-width=\"1.6\" stroke-linejoin=\"round\"/>"
        );
    }
}

/// Through points in px.
pub(super) fn path(points: impl Iterator<Item = (f64, f64)>, end: &str) -> String {
    let words: Vec<String> = points.map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
    format!("M{}{end}", words.join("L"))
}

/// The base axis, dash-dotted.
fn base_axis(out: &mut String, panel: &Panel) {
    let (x, _) = panel.at([0.0, 0.0]);
    let bottom = TOP + panel.height();
    let _ = writeln!(
        out,
        "<path d=\"M{x:.1} {TOP:.1}V{bottom:.1}\" stroke=\"#1b1f24\" stroke-dasharray=\"12 4 2 4\" fill=\"none\"/>"
    );
}

/// Where the section is cut, from edge to edge through the base axis.
fn cut(out: &mut String, panel: &Panel, azimuth: f64) {
    let (sin, cos) = azimuth.sin_cos();
    let room = |d: f64, k: usize| match d {
        d if d.abs() < 1e-9 => f64::INFINITY,
        d => (if d > 0.0 { panel.high[k] } else { panel.low[k] }) / d,
    };
    let [ahead, behind] = [1.0, -1.0].map(|s| room(s * cos, 0).min(room(s * sin, 1)));
    let ends = [(ahead, 1.0), (behind, -1.0)].map(|(r, s)| panel.at([s * r * cos, s * r * sin]));
    let _ = writeln!(
        out,
        "<path d=\"{}\" stroke=\"#1b1f24\" stroke-dasharray=\"12 4 2 4\" fill=\"none\"/>",
        path(ends.into_iter(), "")
    );
}

/// The arm in one posture: links and joints.
fn line_of_arm(out: &mut String, panel: &Panel, arm: &[[f64; 2]]) {
    let points: Vec<_> = arm.iter().map(|p| panel.at(*p)).collect();
    if points.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "<path d=\"{}\" stroke=\"{ARM}\" stroke-width=\"4\" stroke-linecap=\"round\" stroke-linejoin=\"round\" \
         fill=\"none\"/>",
        path(points.iter().copied(), "")
    );
    for (x, y) in &points {
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"#fde7d3\" stroke=\"{ARM}\" stroke-width=\"1.6\"/>"
        );
    }
}

fn foot(out: &mut String, e: &Reachable<'_>) {
    let said = match &e.size.extent {
        None => "nothing was found to be reachable with the tool held like this".to_string(),
        Some(EnvelopeExtent { radius, height, .. }) => {
            let mm = |m: f64| rounded(mm_from_m(m), 0);
            format!(
                "{:.3} m\u{b3}; {} to {} mm from the base axis, {} to {} mm high; joint limits kept, collisions not \
                 looked at",
                e.size.volume,
                mm(radius.0),
                mm(radius.1),
                mm(height.0),
                mm(height.1)
            )
        }
    };
    let y = TOP + PANEL + BOTTOM - 14.0;
    let _ = writeln!(out, "<text x=\"24\" y=\"{y:.1}\" fill=\"#57606a\">{}</text>", escaped(&said));
}
