//! What every drawing shares: world plan to picture, safe text.

use crate::assess::Assessment;
use crate::cell::{Placement, Rectangle};

/// Longer side of the drawing area and the space round it, in px.
const SIDE: f64 = 820.0;
pub const MARGIN: f64 = 24.0;
/// However narrow the cell, heading and legend need their width.
const LEAST: f64 = 740.0;
/// Round everything, m.
const ROUND: f64 = 0.25;

/// World plan (m) to picture (px), y upwards.
pub struct View {
    low: (f64, f64),
    high: (f64, f64),
    pub scale: f64,
    /// Where the drawing begins below the heading, px.
    pub top: f64,
}

impl View {
    pub fn of(a: &Assessment<'_>) -> Self {
        let mut points: Vec<(f64, f64)> = corners(&a.cell.robot.footprint, &a.layout.base).to_vec();
        for (equipment, at) in a.cell.equipment.iter().zip(&a.layout.placements) {
            points.extend(corners(&equipment.footprint, at));
        }
        points.extend(a.cell.fence.iter().flat_map(|f| &f.corners));
        points.extend(a.cell.keep_out.iter().flat_map(|k| [(k.min.x, k.min.y), (k.max.x, k.max.y)]));
        let fold = |pick: fn(&(f64, f64)) -> f64, start: f64, f: fn(f64, f64) -> f64| {
            points.iter().map(pick).fold(start, f)
        };
        let low = (fold(|p| p.0, f64::MAX, f64::min) - ROUND, fold(|p| p.1, f64::MAX, f64::min) - ROUND);
        let high = (fold(|p| p.0, f64::MIN, f64::max) + ROUND, fold(|p| p.1, f64::MIN, f64::max) + ROUND);
        Self { low, high, scale: SIDE / (high.0 - low.0).max(high.1 - low.1), top: 0.0 }
    }

    pub fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        (MARGIN + (x - self.low.0) * self.scale, self.top + (self.high.1 - y) * self.scale)
    }

    /// The drawing without heading and legend: left, top, width, height.
    pub fn frame(&self) -> (f64, f64, f64, f64) {
        let (left, top) = self.at((self.low.0, self.high.1));
        (left, top, (self.high.0 - self.low.0) * self.scale, (self.high.1 - self.low.1) * self.scale)
    }

    /// Of the whole picture.
    pub fn width(&self) -> f64 {
        ((self.high.0 - self.low.0) * self.scale + 2.0 * MARGIN).max(LEAST)
    }
}

/// Corners of a placed rectangle in the world plan, m, counterclockwise.
pub fn corners(rectangle: &Rectangle, at: &Placement) -> [(f64, f64); 4] {
    let (sin, cos) = at.yaw.sin_cos();
    [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)].map(|(u, v)| {
        let (x, y) = (rectangle.centre.0 + u * rectangle.size.0, rectangle.centre.1 + v * rectangle.size.1);
        (at.x + cos * x - sin * y, at.y + sin * x + cos * y)
    })
}

/// Text made safe for markup; what XML has no place for is shown as unknown.
pub fn escaped(text: &str) -> String {
    let is_bad =
        |c: char| c.is_control() && !matches!(c, '\t' | '\n' | '\r') || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.replace(is_bad, "\u{fffd}")
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace('\'', "&#39;")
}
