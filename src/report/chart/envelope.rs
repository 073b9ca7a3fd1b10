//! Picture of a working envelope: section and plan side by side at one scale.

use super::axes;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink};
use super::plane_view::{PlaneView, longer_side, widened};
use crate::assess::Reachable;
use crate::geometry::{PlanePoint, bounding_box};
use crate::reach::{EnvelopeExtent, EnvelopeSection};
use crate::report::text::envelope_title;
use crate::svg_text::{PathEnd, path_data};
use crate::units::{deg_from_rad, mm_from_m, rounded};

/// Height of the panels, px.
const PANEL_HEIGHT: f64 = 460.0;
/// Space on the left of a panel for the numbers of its axis, px.
const PANEL_LEFT: f64 = 66.0;
const MIN_WIDTH: f64 = 760.0;

/// Dashes of the lines that show the base axis and the section plane.
const DASH_DOT: &str = "stroke-dasharray=\"12 4 2 4\"";

/// Panel with a section of the envelope; coordinates are in mm.
struct Panel {
    name: String,
    axes: (&'static str, &'static str),
    region: Vec<Vec<PlanePoint>>,
    arm: Vec<PlanePoint>,
    bounds: (PlanePoint, PlanePoint),
}

impl Panel {
    fn new(
        name: String,
        axes: (&'static str, &'static str),
        region: &EnvelopeSection,
        arm: Vec<PlanePoint>,
    ) -> Self {
        let point = |p: &[f64; 2]| (mm_from_m(p[0]), mm_from_m(p[1]));
        let region: Vec<Vec<PlanePoint>> =
            region.outlines.iter().map(|o| o.points.iter().map(point).collect()).collect();
        let all = region.iter().flatten().chain(&arm).copied().chain([(0.0, 0.0)]);
        let bounds = bounding_box(all).unwrap_or_default();
        let bounds = widened(bounds, 0.06 * longer_side(bounds).max(100.0));
        Self { name, axes, region, arm, bounds }
    }

    fn size(&self) -> (f64, f64) {
        let (low, high) = self.bounds;
        (high.0 - low.0, high.1 - low.1)
    }
}

/// Draws the vertical section and the first horizontal section of a working envelope.
pub fn envelope(e: &Reachable<'_>) -> String {
    let empty = EnvelopeSection::default();
    let (height, plan) = e.plans.first().map_or((0.0, &empty), |(z, plan)| (*z, plan));
    let (sin, cos) = e.azimuth.sin_cos();
    let arm = |along: &dyn Fn(&nalgebra::Vector3<f64>) -> (f64, f64)| {
        e.arm.iter().map(along).map(|(u, v)| (mm_from_m(u), mm_from_m(v))).collect()
    };
    let azimuth = rounded(deg_from_rad(e.azimuth), 1);
    let section = Panel::new(
        format!("section at azimuth {azimuth} deg"),
        ("r / mm", "z / mm"),
        &e.section,
        arm(&|p| (p.x * cos + p.y * sin, p.z)),
    );
    let plan = Panel::new(
        format!("plan at z = {} mm", rounded(mm_from_m(height), 1)),
        ("x / mm", "y / mm"),
        plan,
        arm(&|p| (p.x, p.y)),
    );
    let scale = PANEL_HEIGHT / section.size().1.max(plan.size().1);
    let widths = [&section, &plan].map(|panel| panel.size().0 * scale);
    let width = (2.0 * PANEL_LEFT + widths[0] + widths[1] + 2.0 * EDGE).max(MIN_WIDTH);
    let mut canvas = ChartCanvas::wide(&envelope_title(e), &[size_in_words(e)], width);
    let top = canvas.y + 42.0;
    let view =
        |panel: &Panel, left: f64| PlaneView { low: panel.bounds.0, high: panel.bounds.1, scale, left, top };
    let left = view(&section, PANEL_LEFT);
    let right = view(&plan, left.right() + EDGE + PANEL_LEFT);
    draw_panel(&mut canvas, &section, &left);
    let (x, _) = left.at(&(0.0, 0.0));
    let base_axis = format!("M{x:.1} {:.1}V{:.1}", left.top, left.bottom());
    canvas.path(&base_axis, &format!("{} {DASH_DOT}", Ink::Text.line(1.0)));
    draw_panel(&mut canvas, &plan, &right);
    canvas.path(&cut(&right, e.azimuth), &format!("{} {DASH_DOT}", Ink::Text.line(1.0)));
    for (panel, view) in [(&section, &left), (&plan, &right)] {
        draw_arm(&mut canvas, panel, view);
    }
    canvas.finish()
}

/// Draws the axes and the region of a panel.
fn draw_panel(canvas: &mut ChartCanvas, panel: &Panel, view: &PlaneView) {
    let (x, y) = view.scales();
    canvas.heading((view.left, view.top - 26.0), &panel.name);
    axes::draw(canvas, &x, &y, (panel.axes.0, ""));
    canvas.text((view.left - PANEL_LEFT + EDGE, view.top - 10.0), Anchor::Start, Ink::Text, panel.axes.1);
    let ring = |o: &Vec<PlanePoint>| path_data(o.iter().map(|p| view.at(p)), PathEnd::Closed, 1);
    let d: String = panel.region.iter().map(ring).collect();
    canvas.path(&d, &format!("{} fill-opacity=\"0.16\" fill-rule=\"evenodd\"", Ink::Sky.fill()));
    canvas.path(&d, &Ink::Blue.line(1.6));
}

/// Returns the trace of the section plane in the plan: a line through the base axis from edge to edge.
fn cut(view: &PlaneView, azimuth: f64) -> String {
    let (sin, cos) = azimuth.sin_cos();
    let room = |d: f64, low: f64, high: f64| match d {
        d if d.abs() < 1e-9 => f64::INFINITY,
        d => (if d > 0.0 { high } else { low }) / d,
    };
    let (low, high) = (view.low, view.high);
    let end = |s: f64| {
        let r = room(s * cos, low.0, high.0).min(room(s * sin, low.1, high.1));
        view.at(&(s * r * cos, s * r * sin))
    };
    path_data([end(1.0), end(-1.0)].into_iter(), PathEnd::Open, 1)
}

/// Draws the arm in one posture: links and joints.
fn draw_arm(canvas: &mut ChartCanvas, panel: &Panel, view: &PlaneView) {
    let points: Vec<(f64, f64)> = panel.arm.iter().map(|p| view.at(p)).collect();
    let line = Ink::Vermilion.line(4.0);
    canvas.path(
        &path_data(points.iter().copied(), PathEnd::Open, 1),
        &format!("{line} stroke-linecap=\"round\" stroke-linejoin=\"round\""),
    );
    for (x, y) in points {
        for paint in [Ink::Paper.fill(), Ink::Vermilion.line(1.6)] {
            canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" {paint}/>"));
        }
    }
}

fn size_in_words(e: &Reachable<'_>) -> String {
    match &e.size.extent {
        None => "no point was found that the arm can reach with the tool in this orientation".to_string(),
        Some(EnvelopeExtent { radius, height, .. }) => {
            let mm = |m: f64| rounded(mm_from_m(m), 0);
            format!(
                "{:.3} m\u{b3}; {} to {} mm from the base axis, {} to {} mm high; within the joint limits, \
                 collisions not checked",
                e.size.volume,
                mm(radius.0),
                mm(radius.1),
                mm(height.0),
                mm(height.1)
            )
        }
    }
}
