//! Part of a plane that a picture shows, with one scale for both axes.

use super::axes::AxisScale;
use crate::geometry::PlanePoint;

/// Rectangle of a plane (y up), and its position in a picture (px, y down).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneView {
    pub low: PlanePoint,
    pub high: PlanePoint,
    /// Scale, px per unit of the plane.
    pub scale: f64,
    pub left: f64,
    pub top: f64,
}

impl PlaneView {
    /// Returns a view that shows the rectangle as large as the given space (px) allows.
    pub fn fitted(
        (low, high): (PlanePoint, PlanePoint),
        (width, height): (f64, f64),
        (left, top): (f64, f64),
    ) -> Self {
        let scale = (width / (high.0 - low.0)).min(height / (high.1 - low.1));
        Self { low, high, scale, left, top }
    }

    /// Returns the position of a point in the picture, px.
    pub fn at(&self, p: &PlanePoint) -> (f64, f64) {
        (self.left + (p.0 - self.low.0) * self.scale, self.top + (self.high.1 - p.1) * self.scale)
    }

    pub fn width(&self) -> f64 {
        (self.high.0 - self.low.0) * self.scale
    }

    pub fn height(&self) -> f64 {
        (self.high.1 - self.low.1) * self.scale
    }

    pub fn right(&self) -> f64 {
        self.left + self.width()
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height()
    }

    /// Returns the horizontal and the vertical axis.
    pub fn scales(&self) -> (AxisScale, AxisScale) {
        (
            AxisScale::linear(self.low.0, self.high.0, (self.left, self.right())),
            AxisScale::linear(self.low.1, self.high.1, (self.bottom(), self.top)),
        )
    }
}

/// Returns a bounding rectangle enlarged by a margin on every side.
pub fn widened((low, high): (PlanePoint, PlanePoint), margin: f64) -> (PlanePoint, PlanePoint) {
    ((low.0 - margin, low.1 - margin), (high.0 + margin, high.1 + margin))
}

/// Returns the length of the longer side of a bounding rectangle.
pub fn longer_side((low, high): (PlanePoint, PlanePoint)) -> f64 {
    (high.0 - low.0).max(high.1 - low.1)
}
