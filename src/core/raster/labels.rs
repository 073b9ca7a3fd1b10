//! Labels: names and values, placed so that they cover few nodes and other labels.

use super::font;
use super::ink::{PixelImage, distance};
use super::scene::{Label, LabelSide};
use super::{FittedScene, Shot};
use crate::raster::camera::PictureFrame;
use crate::safe_text::shown;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Label with its place in the picture, px.
pub struct PlacedLabel {
    pub text: String,
    /// Left end of the baseline of the text, px.
    pub at: Vector2<f64>,
    /// Leader line from a spot to its label, px; None for a label without such a line.
    pub leader: Option<[Vector2<f64>; 2]>,
    low: Vector2<f64>,
    high: Vector2<f64>,
}

/// Draws the labels and their leader lines into a picture of pixels.
pub fn write(sheet: &mut PixelImage, stage: &FittedScene, shot: &Shot) {
    let (unit, palette) = (shot.capital(), &stage.palette);
    let all = placed(stage, shot);
    for leader in all.iter().filter_map(|l| l.leader) {
        sheet.line(&leader, 0.34 * unit, palette.paper);
        sheet.line(&leader, 0.16 * unit, palette.spot);
    }
    for label in &all {
        let colour = if label.leader.is_some() { palette.spot } else { palette.text };
        sheet.rimmed(&label.text, label.at, unit, colour, palette.paper);
    }
}

/// Returns all labels with their places in the picture. Labels of spots are placed first, so that they get
/// the better places.
pub fn placed(stage: &FittedScene, shot: &Shot) -> Vec<PlacedLabel> {
    let place = |p: &nalgebra::Vector3<f64>| stage.camera.seen(p).at.coords;
    let mut taken: Vec<Vector2<f64>> = stage.scene.nodes.iter().map(|n| place(&n.at)).collect();
    let round = stage.scene.bodies.iter().filter(|b| b.is_lit && !b.is_sign && b.mesh.positions.len() > 40);
    taken.extend(round.flat_map(|b| b.mesh.positions.iter().step_by(23).map(place)));
    let mut all: Vec<PlacedLabel> = Vec::new();
    let (spots, names): (Vec<&Label>, Vec<&Label>) =
        stage.scene.labels.iter().partition(|l| l.side == LabelSide::Spot);
    for label in spots.into_iter().chain(names) {
        let choices = choices(label, stage, shot);
        let cost = |p: &PlacedLabel| cost(p, &all, &taken, &shot.frame());
        let best = choices.into_iter().map(|p| (cost(&p), p)).min_by(|a, b| a.0.total_cmp(&b.0));
        all.extend(best.map(|(_, p)| p));
    }
    all
}

/// Returns the possible places of a label. If several places have the least cost, the first of these places
/// is used.
fn choices(label: &Label, stage: &FittedScene, shot: &Shot) -> Vec<PlacedLabel> {
    let unit = shot.capital();
    let text: String = shown(&label.text);
    let half = font::width(&text, unit) / 2.0;
    let top = label.points.iter().map(|p| p.z).fold(f64::MIN, f64::max);
    let upper = label.points.iter().filter(|p| p.z > top - 0.05).map(|p| stage.camera.seen(p).at.coords);
    let mut upper: Vec<Vector2<f64>> = upper.collect();
    upper.sort_by(|a, b| a.y.total_cmp(&b.y));
    let (Some(first), Some(last)) = (upper.first().copied(), upper.last().copied()) else {
        return Vec::new();
    };
    let placed = |centre: Vector2<f64>, leader: Option<[Vector2<f64>; 2]>| PlacedLabel {
        text: text.clone(),
        at: Vector2::new(centre.x - half, centre.y + unit / 2.0),
        leader,
        low: centre - Vector2::new(half + 0.5 * unit, unit),
        high: centre + Vector2::new(half + 0.5 * unit, unit),
    };
    match label.side {
        LabelSide::Above => {
            let mean = upper.iter().sum::<Vector2<f64>>() / upper.len() as f64;
            let steps = (0..5).map(|k| Vector2::new(mean.x, first.y - (1.3 + 1.6 * f64::from(k)) * unit));
            steps.map(|c| placed(c, None)).collect()
        }
        LabelSide::Below => {
            let next = upper.iter().rev().nth(1).copied().unwrap_or(last);
            let middle = (last + next) / 2.0;
            let steps = (0..6).map(|k| middle + Vector2::new(0.0, (3.2 + 1.6 * f64::from(k)) * unit));
            steps.map(|c| placed(c, None)).collect()
        }
        LabelSide::Spot => {
            let around = (0..64).map(|k| {
                let (sin, cos) = (TAU * (f64::from(k % 16) + 0.5) / 16.0).sin_cos();
                let far = (6.0 + 5.0 * f64::from(k / 16)) * unit;
                let centre = first + Vector2::new(cos * (far + half), -sin * far);
                let end = if cos.abs() < 0.5 {
                    centre + Vector2::new(0.0, 1.1 * unit * sin.signum())
                } else {
                    centre - Vector2::new((half + 0.5 * unit) * cos.signum(), 0.0)
                };
                placed(centre, Some([first + (end - first).normalize() * 1.2 * unit, end]))
            });
            around.collect()
        }
    }
}

/// Returns the cost of the place `p` of a label.
///
/// The cost grows with the number of points (`taken`) and of labels (`all`) that the label would cover. It
/// also grows with the distance by which the label would stick out of `frame`. A leader line adds a cost
/// for its length, and for every point of `taken` close to the line.
fn cost(p: &PlacedLabel, all: &[PlacedLabel], taken: &[Vector2<f64>], frame: &PictureFrame) -> f64 {
    let inside = |q: &&Vector2<f64>| (0..2).all(|k| p.low[k] < q[k] && q[k] < p.high[k]);
    let nodes = taken.iter().filter(inside).count() as f64;
    let meets = |o: &&PlacedLabel| (0..2).all(|k| p.low[k] < o.high[k] && o.low[k] < p.high[k]);
    let labels = all.iter().filter(meets).count() as f64;
    let out = (frame.left - p.low.x).max(p.high.x - frame.left - frame.width).max(0.0)
        + (frame.top - p.low.y).max(p.high.y - frame.top - frame.height).max(0.0);
    let long = p.leader.map_or(p.low.y - p.at.y, |[a, b]| (b - a).norm());
    let crossed =
        p.leader.map_or(0, |[a, b]| taken.iter().filter(|q| distance(**q, a, b) < p.high.y - p.at.y).count());
    nodes * 30.0 + crossed as f64 * 25.0 + labels * 900.0 + out * 10.0 + long * 0.25
}
