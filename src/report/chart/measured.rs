//! Measured and predicted errors as arrows, in plan and from the side.

use super::axes;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry};
use super::plane_view::{PlaneView, longer_side, widened};
use super::{WIDTH, words};
use crate::drawing::round_numbers::{DIGITS, round_down};
use crate::files::shown;
use crate::geometry::{PlanePoint, bounding_box};
use crate::record::{ComparedFile, ComparedPosition};

/// Largest number of positions whose arrows are drawn.
const MAX_ARROWS: usize = 400;
/// Left edge of the panels, px.
const LEFT: f64 = 66.0;
/// Largest height of a panel, px.
const TALLEST: f64 = 600.0;
/// Length that at least 95 % of the arrows do not exceed, px. The other arrows may be longer, and are drawn
/// in full.
const LONG_ARROW: f64 = 40.0;
/// Margin round the positions, as a share of the longer side of their bounding rectangle.
const SURROUNDINGS: f64 = 0.08;
/// Size below which a predicted error has no direction, mm.
const NOTHING: f64 = 1e-9;

/// Planes of the panels: name, horizontal and vertical axis.
pub const PLANES: [(&str, usize, usize); 2] = [("from above", 0, 1), ("from the side", 0, 2)];

/// Function that returns the measured or the predicted error of a position, mm.
type ErrorOf = fn(&ComparedPosition) -> &[f64; 3];

/// Names of the axes with their units.
pub const AXIS_NAMES: [&str; 3] = ["x / mm", "y / mm", "z / mm"];

/// Draws the errors of one measurement file, measured and predicted, as arrows in the base frame of the
/// robot. All arrows are enlarged by one factor.
pub fn measured(file: &ComparedFile) -> String {
    let every = thinning(file.positions.len(), MAX_ARROWS);
    let drawn: Vec<_> = file.positions.iter().step_by(every).collect();
    let has_direction = drawn.iter().any(|p| size(&p.predicted_mm) > NOTHING);
    let heading = format!("{}: measured and predicted errors", shown(&file.file));
    let mut canvas = ChartCanvas::new(&heading, &told(every, has_direction));
    let views = PLANES.map(|(_, across, up)| view(&drawn, across, up, (WIDTH - EDGE - LEFT, TALLEST)));
    let px_per_mm = views.iter().map(|view| view.scale).fold(f64::MAX, f64::min);
    let enlarged = enlargement(&drawn, px_per_mm);
    draw_legend(&mut canvas, enlarged * px_per_mm, enlarged, has_direction);
    for ((name, across, up), mut view) in PLANES.into_iter().zip(views) {
        // Both panels have the same scale.
        view.scale = px_per_mm;
        (view.left, view.top) = (LEFT, canvas.y + 44.0);
        canvas.heading((LEFT, view.top - 22.0), name);
        let (x, y) = view.scales();
        axes::draw(&mut canvas, &x, &y, (AXIS_NAMES[across], AXIS_NAMES[up]));
        let kinds: [(ErrorOf, Ink); 2] =
            [(|p| &p.predicted_mm, Ink::Blue), (|p| &p.measured_mm, Ink::Vermilion)];
        for (error, ink) in kinds {
            let arrows = drawn.iter().filter(|p| size(error(p)) > NOTHING).map(|p| {
                let from = view.at(&(p.nominal_mm[across], p.nominal_mm[up]));
                let by = enlarged * px_per_mm;
                arrow(from, (error(p)[across] * by, -error(p)[up] * by))
            });
            canvas.path(&arrows.collect::<String>(), &ink.line(1.1));
        }
    }
    canvas.finish()
}

/// Returns the thinning `n`: every n-th position is drawn. This is the least thinning that draws at most
/// `most` of `count` positions.
pub fn thinning(count: usize, most: usize) -> usize {
    count.div_ceil(most).max(1)
}

/// Returns a view of the positions in a plane, as large as the space (px) allows.
pub fn view(drawn: &[&ComparedPosition], across: usize, up: usize, space: (f64, f64)) -> PlaneView {
    let points = drawn.iter().map(|p| (p.nominal_mm[across], p.nominal_mm[up]));
    let bounds: (PlanePoint, PlanePoint) = bounding_box(points).unwrap_or_default();
    let margin = (SURROUNDINGS * longer_side(bounds)).max(1.0);
    PlaneView::fitted(widened(bounds, margin), space, (LEFT, 0.0))
}

fn told(every: usize, has_direction: bool) -> Vec<String> {
    let mut told = vec![
        "base frame of the robot; base and reflectors are fitted with the nominal arm; the measured and \
        the predicted errors are shown without the part that this fit absorbs"
            .to_string(),
    ];
    if every > 1 {
        told.push(format!("one in {every} positions is drawn"));
    }
    if !has_direction {
        told.push("tolerances predict sizes without directions, so no predicted arrows are drawn".into());
    }
    told
}

fn size(v: &[f64; 3]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Returns the enlargement at which 95 % of the arrows are at most [`LONG_ARROW`] px long.
fn enlargement(drawn: &[&ComparedPosition], px_per_mm: f64) -> f64 {
    let mut sizes: Vec<f64> =
        drawn.iter().flat_map(|p| [size(&p.measured_mm), size(&p.predicted_mm)]).collect();
    sizes.sort_by(f64::total_cmp);
    let long = sizes.get((sizes.len() * 19 / 20).min(sizes.len().saturating_sub(1))).copied().unwrap_or(0.0);
    if long > NOTHING { round_down(LONG_ARROW / (long * px_per_mm), DIGITS) } else { 1.0 }
}

/// Draws the legend with a scale bar for an error of a round size, such as 0.5 mm. `stretch` is in px per mm
/// of error.
fn draw_legend(canvas: &mut ChartCanvas, stretch: f64, enlarged: f64, has_direction: bool) {
    let entry = |ink: Ink, said: &str| LegendEntry {
        mark: format!("<path d=\"{}\" {}/>", arrow((-11.0, 0.0), (22.0, 0.0)), ink.line(1.8)),
        said: said.to_string(),
    };
    let mut entries = vec![entry(Ink::Vermilion, "measured")];
    if has_direction {
        entries.push(entry(Ink::Blue, "predicted"));
    }
    canvas.legend(&entries);
    let bar = axes::step(40.0 / stretch.max(f64::MIN_POSITIVE), 1.0);
    let (x, y) = (EDGE, canvas.y + 22.0);
    let long = bar * stretch;
    canvas.path(&format!("M{x:.1} {:.1}v8m0 -4h{long:.1}m0 -4v8", y - 9.0), &Ink::Text.line(1.4));
    let said = format!(
        "error of {} mm; errors are enlarged {} times",
        words::number(bar, bar),
        words::number(enlarged, 1.0)
    );
    canvas.text((x + long + 8.0, y), Anchor::Start, Ink::Text, &said);
    canvas.y = y;
}

/// Returns the SVG path of an arrow with shaft and head.
fn arrow((x, y): (f64, f64), (dx, dy): (f64, f64)) -> String {
    let long = dx.hypot(dy).max(f64::MIN_POSITIVE);
    let head = 4.5_f64.min(long / 2.0) / long;
    let turned = |turn: f64| {
        let (sin, cos) = turn.sin_cos();
        (head * (cos * dx - sin * dy), head * (sin * dx + cos * dy))
    };
    let ((ax, ay), (bx, by)) = (turned(2.65), turned(-2.65));
    format!("M{x:.1} {y:.1}l{dx:.1} {dy:.1}l{ax:.1} {ay:.1}m{:.1} {:.1}l{bx:.1} {by:.1}", -ax, -ay)
}
