//! State of the picture of error maps, shared by the map and its legend.

use super::canvas::ChartCanvas;
use super::labels::OccupiedBoxes;
use super::plane_view::PlaneView;
use crate::assess::Assessment;

/// Space round the drawing area, px.
pub(super) const MARGIN: f64 = 24.0;

/// Picture under construction.
pub(super) struct ErrorMapPicture<'a> {
    pub a: &'a Assessment<'a>,
    pub canvas: ChartCanvas,
    /// Part of the plan that the picture shows (world frame, m).
    pub view: PlaneView,
    pub width: f64,
    /// Boxes of the labels placed so far.
    pub taken: OccupiedBoxes,
}

/// Colour scale, arrow scale and thinning of the error maps, and the drawn outlines of the reach.
pub(super) struct MapScales {
    /// Ends of the colour scale in the unit of the objective.
    pub range: (f64, f64),
    /// Factor by which the errors are enlarged relative to the scale of the plan.
    pub enlarged: f64,
    /// Names of the operations that share each drawn outline of the reach.
    pub reach: Vec<String>,
    /// Thinning: every n-th node along each axis is drawn.
    pub every: usize,
}
