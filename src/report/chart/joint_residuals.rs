//! Residuals of a calibration over the coordinate of every joint: a trend shows on which joint the residuals
//! depend.

use super::axes::{self, AxisScale};
use super::canvas::{ChartCanvas, EDGE, Ink, LegendEntry};
use super::{WIDTH, words};
use crate::calibration::{FittedSession, MeasuringSession};
use crate::cell::{JointKind, Robot};
use crate::files::shown;
use crate::units::{deg_from_rad, mm_from_m};

/// Largest number of dots in a panel.
const MAX_DOTS: usize = 2000;
/// Number of ranges of a joint coordinate, each with a median.
const BINS: usize = 24;
/// Least number of positions from which a median is drawn.
const MIN_POSITIONS: usize = 5;
const LEFT: f64 = 56.0;
const GAP: f64 = 70.0;
const HEIGHT: f64 = 150.0;
/// Inks of the dots, one for each table of measured positions. After the last ink, the first ink follows
/// again.
const INKS: [Ink; 5] = [Ink::Blue, Ink::Orange, Ink::Green, Ink::Purple, Ink::Vermilion];

/// Dot of a panel for one measured position.
struct JointDot {
    /// Joint coordinate, degrees or mm.
    coordinate: f64,
    /// Distance of the measured position from the prediction, mm.
    distance: f64,
    /// Index of the table of measured positions.
    table: usize,
}

/// Draws one plot per joint: the distances of measured positions from their predictions, against the
/// coordinate of the joint.
///
/// A line joins the median distances in equally wide ranges of the coordinate.
pub fn joint_residuals(robot: &Robot, sessions: &[MeasuringSession], fitted: &[FittedSession]) -> String {
    let count: usize = sessions.iter().map(|session| session.measured.len()).sum();
    let every = count.div_ceil(MAX_DOTS).max(1);
    let heading = format!("{}: residuals of the calibration", shown(&robot.name));
    let mut under = vec![
        "distance of measured from predicted positions; line: medians over equally wide ranges of the coordinate"
            .to_string(),
    ];
    if every > 1 {
        under.push(format!("one in every {every} positions is drawn"));
    }
    let mut canvas = ChartCanvas::new(&heading, &under);
    let distances = fitted.iter().flat_map(|session| &session.distances);
    let most = mm_from_m(distances.copied().fold(0.0, f64::max));
    let wide = (WIDTH - EDGE - LEFT - GAP) / 2.0;
    let mut top = canvas.y + 44.0;
    for (joint, row) in robot.joints.iter().enumerate() {
        let left = LEFT + if joint % 2 == 0 { 0.0 } else { wide + GAP };
        let (of_file, word, unit) = match row.kind {
            JointKind::Revolute => (deg_from_rad as fn(f64) -> f64, "angle", "deg"),
            JointKind::Prismatic => (mm_from_m as fn(f64) -> f64, "travel", "mm"),
        };
        let dots = dots(sessions, fitted, |joints| of_file(joints[joint]));
        let ends = dots.iter().map(|dot| dot.coordinate);
        let (low, high) = ends.fold((f64::MAX, f64::MIN), |(l, h), q| (l.min(q), h.max(q)));
        let x = AxisScale::linear(low, high, (left, left + wide));
        let y = AxisScale::linear(0.0, most, (top + HEIGHT, top));
        canvas.heading((left, top - 12.0), &words::shortened(&shown(&row.name), 13.0, wide));
        axes::draw(&mut canvas, &x, &y, (&format!("{word} / {unit}, distance / mm"), ""));
        for dot in dots.iter().step_by(every) {
            let (px, py) = (x.at(dot.coordinate), y.at(dot.distance));
            let fill = INKS[dot.table % INKS.len()].fill();
            canvas.put(&format!("<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"1.6\" {fill}/>"));
        }
        let line = medians(&dots, low, high).into_iter().enumerate().map(|(k, (q, distance))| {
            format!("{}{:.1} {:.1}", if k == 0 { 'M' } else { 'L' }, x.at(q), y.at(distance))
        });
        canvas.path(&line.collect::<String>(), &Ink::Text.line(1.6));
        if joint % 2 == 1 {
            top += HEIGHT + 84.0;
        }
    }
    let tables = sessions.iter().enumerate().map(|(k, session)| LegendEntry {
        mark: format!("<circle cx=\"0\" cy=\"0\" r=\"4\" {}/>", INKS[k % INKS.len()].fill()),
        said: shown(&session.name),
    });
    canvas.legend(&tables.collect::<Vec<_>>());
    canvas.finish()
}

fn dots(
    sessions: &[MeasuringSession],
    fitted: &[FittedSession],
    coordinate: impl Fn(&[f64]) -> f64,
) -> Vec<JointDot> {
    let tables = sessions.iter().zip(fitted).enumerate();
    let dots = tables.flat_map(|(table, (session, fitted))| {
        let pairs = session.measured.iter().zip(&fitted.distances);
        pairs.map(move |(measured, distance)| (table, measured.joints, *distance))
    });
    dots.map(|(table, joints, distance)| JointDot {
        coordinate: coordinate(&joints),
        distance: mm_from_m(distance),
        table,
    })
    .collect()
}

/// Returns the middle of each range of the coordinate, and the median distance in this range. All ranges are
/// equally wide. Ranges with fewer than `MIN_POSITIONS` positions are left out.
fn medians(dots: &[JointDot], low: f64, high: f64) -> Vec<(f64, f64)> {
    let width = (high - low) / BINS as f64;
    let median = |bin: usize| {
        let begin = low + bin as f64 * width;
        let members = dots.iter().filter(|dot| (begin..=begin + width).contains(&dot.coordinate));
        let mut distances: Vec<f64> = members.map(|dot| dot.distance).collect();
        distances.sort_by(f64::total_cmp);
        (distances.len() >= MIN_POSITIONS).then(|| (begin + width / 2.0, distances[distances.len() / 2]))
    };
    (0..BINS).filter_map(median).collect()
}
