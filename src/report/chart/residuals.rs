//! Map of the residuals: measured minus predicted errors at their positions, in colours.

use super::WIDTH;
use super::axes;
use super::canvas::{ChartCanvas, EDGE};
use super::colour_scale::ColourScale;
use super::measured::{AXIS_NAMES, PLANES, thinning, view};
use crate::files::shown;
use crate::record::ComparedFile;

/// Largest number of dots in a panel.
const MAX_DOTS: usize = 2500;
/// Left edge of the panels, px.
const LEFT: f64 = 66.0;
/// Width of the space for the colour bar, px.
const BAR: f64 = 92.0;
/// Largest height of a panel, px.
const TALLEST: f64 = 520.0;

/// Draws the measured positions of one file, in plan and from the side. The colour of a position shows its
/// residual: the length of the difference between measured and predicted error. Positions are in the base
/// frame of the robot.
pub fn residuals(file: &ComparedFile) -> String {
    let every = thinning(file.positions.len(), MAX_DOTS);
    let mut drawn: Vec<_> = file.positions.iter().step_by(every).collect();
    // Large residuals are drawn last, so that no large residual is hidden.
    drawn.sort_by(|a, b| a.residual_mm.total_cmp(&b.residual_mm));
    let heading = format!("{}: residuals of the prediction", shown(&file.file));
    let mut told = vec![
        "colour: size of the difference between measured and predicted error; positions in the base frame of the robot"
            .to_string(),
    ];
    if every > 1 {
        told.push(format!("one in {every} positions is drawn"));
    }
    let mut canvas = ChartCanvas::new(&heading, &told);
    let views = PLANES.map(|(_, across, up)| view(&drawn, across, up, (WIDTH - EDGE - LEFT - BAR, TALLEST)));
    let px_per_mm = views.iter().map(|view| view.scale).fold(f64::MAX, f64::min);
    let most = file.positions.iter().map(|p| p.residual_mm).fold(0.0, f64::max);
    let colours = ColourScale::new(0.0, most);
    let mut is_first = true;
    for ((name, across, up), mut view) in PLANES.into_iter().zip(views) {
        view.scale = px_per_mm;
        (view.left, view.top) = (LEFT, canvas.y + 44.0);
        canvas.heading((LEFT, view.top - 22.0), name);
        let (x, y) = view.scales();
        axes::draw(&mut canvas, &x, &y, (AXIS_NAMES[across], AXIS_NAMES[up]));
        for p in &drawn {
            let (x, y) = view.at(&(p.nominal_mm[across], p.nominal_mm[up]));
            let fill = colours.colour(p.residual_mm);
            canvas.put(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{fill}\"/>"));
        }
        if is_first {
            let place = (WIDTH - EDGE - BAR + 30.0, view.top + 16.0);
            colours.draw_bar(&mut canvas, "mm", place, view.height().clamp(80.0, 260.0) - 16.0);
        }
        is_first = false;
    }
    canvas.finish()
}
