//! Operation of a cell, prepared for any layout: its nodes, its error evaluator and the points that teach its
//! frame.

use super::grid::Grid;
use crate::cell::{Cell, NodeAggregation, Operation, Registration};
use crate::reading::ErrorEvaluator;

/// Everything about one operation that does not depend on the layout.
pub struct OperationSetup {
    /// Index of the equipment that carries the surface.
    pub equipment: usize,
    pub grid: Grid,
    /// Rule that combines the values of the nodes.
    pub over: NodeAggregation,
    pub evaluator: ErrorEvaluator,
    /// Index of the operation that picks the part; None if this operation places no picked part.
    pub relative_to: Option<usize>,
    pub teach: TeachPoints,
}

/// The three points that the robot touches to teach the frame of the surface.
pub enum TeachPoints {
    /// The frame is not taught.
    None,
    /// Nodes to touch: each of the three points has a list of nodes in the order in which they are tried.
    Nodes([Vec<usize>; 3]),
    /// Points given by the user, frame of the equipment, m.
    Given([(f64, f64); 3]),
}

impl OperationSetup {
    /// Prepares one operation of a cell.
    pub fn new(cell: &Cell, operation: &Operation) -> Self {
        let grid = Grid::new(operation);
        let teach = match (cell.registration, operation.teach) {
            (Registration::Taught, Some(points)) => TeachPoints::Given(points),
            (Registration::Taught, None) => TeachPoints::Nodes(nodes_by_corner(&grid)),
            _ => TeachPoints::None,
        };
        Self {
            equipment: operation.equipment,
            over: operation.over,
            evaluator: ErrorEvaluator::new(cell, operation),
            relative_to: operation.relative_to,
            grid,
            teach,
        }
    }
}

/// Returns three lists of all nodes, each sorted by distance from one corner of the grid.
///
/// The corners are (least x, least y), (greatest x, least y) and (least x, greatest y).
fn nodes_by_corner(grid: &Grid) -> [Vec<usize>; 3] {
    let [(left, right), (low, high)] = grid.extent();
    [(left, low), (right, low), (left, high)].map(|corner| {
        let mut nodes: Vec<usize> = (0..grid.count()).collect();
        let distance = |k: &usize| (grid.local(*k).0 - corner.0).hypot(grid.local(*k).1 - corner.1);
        nodes.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
        nodes
    })
}
