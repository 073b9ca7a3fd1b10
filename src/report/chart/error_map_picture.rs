//! State of the picture of error maps, shared by the map and its legend.

use super::canvas::ChartCanvas;
use super::labels::Taken;
use super::plane_view::PlaneView;
use crate::assess::Assessment;

/// Space round the drawing area, px.
pub(super) const MARGIN: f64 = 24.0;

/// Picture under construction.
pub(super) struct ErrorMapPicture<'a> {
    pub a: &'a Assessment<'a>,
    pub canvas: ChartCanvas,
    /// View of the world plan, m.
    pub view: PlaneView,
    pub width: f64,
    /// Places of the labels so far.
    pub taken: Taken,
}

/// Scales of the map, and what thins it.
pub(super) struct MapScales {
    /// Ends of the colour scale in the unit of the cell.
    pub range: (f64, f64),
    /// Length of an arrow over that of its error.
    pub enlarged: f64,
    /// Operations of each line of the reach.
    pub reach: Vec<String>,
    /// Nodes mapped for one that is drawn, along each axis.
    pub every: usize,
}
