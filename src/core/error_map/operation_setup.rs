//! Operation of a cell, prepared for any layout: its nodes, its error evaluator and the points that teach its
//! frame.

use super::candidate::Certainty;
use super::grid::Grid;
use crate::allocation::{DEFAULT_YIELD, FigureScratch, NodeFigure, OperationPricing, TolerancePricing};
use crate::cell::{Cell, NodeAggregation, Operation, Registration};
use crate::reading::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::robot::Frames;
use std::sync::Arc;

/// Data of one operation that do not depend on the layout.
pub struct OperationSetup {
    /// Index of the equipment that carries the surface.
    pub equipment: usize,
    pub grid: Grid,
    /// Rule that combines the values of the nodes.
    pub over: NodeAggregation,
    pub evaluator: ErrorEvaluator,
    /// Cost of the tolerances with which the operation stays within its limit; None if the search ignores
    /// this cost.
    pub pricing: Option<OperationPricing>,
    /// Whether the value of a node is the cost of [`Self::pricing`] instead of an error.
    pub is_priced: bool,
    /// Index of the operation that picks the part; None if this operation places no picked part.
    pub relative_to: Option<usize>,
    pub teach: TeachPoints,
}

/// Three points that the robot touches to teach the frame of the surface.
pub enum TeachPoints {
    /// The frame is not taught.
    None,
    /// Nodes to touch. Each of the three points has a list of nodes, in the order in which the nodes are
    /// tried.
    Nodes([Vec<usize>; 3]),
    /// Points given by the user, in the frame of the equipment, m.
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
            pricing: None,
            is_priced: false,
            relative_to: operation.relative_to,
            grid,
            teach,
        }
    }
}

/// Working memory for the value of a posture.
pub struct ValueScratch {
    pub evaluator: EvaluatorScratch,
    pub figure: FigureScratch,
}

impl OperationSetup {
    /// Prepares the cost of the tolerances. `is_priced` states whether this cost is the value of a node.
    pub fn price(&mut self, tolerances: &Arc<TolerancePricing>, operation: &Operation, is_priced: bool) {
        self.pricing = OperationPricing::new(tolerances.clone(), operation, &self.evaluator);
        self.is_priced = is_priced && self.pricing.is_some();
    }

    /// Returns the pricing of the operation if the values of nodes are costs; otherwise None.
    fn prices(&self) -> Option<&OperationPricing> {
        self.pricing.as_ref().filter(|_| self.is_priced)
    }

    /// Returns the figure that the search minimizes: an error (m or rad), a share of failures, or a cost of
    /// tolerances.
    pub fn value(&self, context: &WorkContext, frames: &Frames, memory: &mut ValueScratch) -> f64 {
        match self.prices() {
            None => self.evaluator.value(context, frames, &mut memory.evaluator),
            Some(pricing) => {
                let node = self.figure(context, frames);
                pricing.price(&node, &mut memory.evaluator, &mut memory.figure)
            }
        }
    }

    /// Returns the value, or a lower bound that is sharper than a bound of the kind `certainty`. The returned
    /// [`Certainty`] is the kind of the returned number. A bound above `enough` (m or rad) need not be
    /// sharpened further.
    pub fn sharpened(
        &self,
        certainty: Certainty,
        context: &WorkContext,
        frames: &Frames,
        enough: f64,
        memory: &mut ValueScratch,
    ) -> (f64, Certainty) {
        let searches = !self.is_priced && self.evaluator.has_sharp_worst_bound();
        match certainty {
            Certainty::RoughBound if self.is_priced || searches => {
                (self.bound(Certainty::Bound, context, frames, memory), Certainty::Bound)
            }
            Certainty::Bound if searches => {
                let scratch = &mut memory.evaluator;
                let (worst, is_value) = self.evaluator.searched_worst(context, frames, enough, scratch);
                (worst, if is_value { Certainty::Value } else { Certainty::SharpBound })
            }
            _ => (self.value(context, frames, memory), Certainty::Value),
        }
    }

    /// Returns whether [`Self::bound`] takes much less time than [`Self::value`].
    pub fn has_bounds(&self) -> bool {
        self.is_priced || self.evaluator.has_worst_bounds()
    }

    /// Returns whether [`Self::bound`] with [`Certainty::Bound`] may be less than [`Self::value`].
    pub fn has_sharp_bound(&self) -> bool {
        self.is_priced || self.evaluator.has_sharp_worst_bound()
    }

    /// Returns a lower bound of [`Self::value`], or the value itself if no bound is known. `certainty`
    /// selects the cheap bound or the sharper bound.
    pub fn bound(
        &self,
        certainty: Certainty,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut ValueScratch,
    ) -> f64 {
        let Some(pricing) = self.prices() else {
            let (evaluator, scratch) = (&self.evaluator, &mut memory.evaluator);
            return match certainty {
                Certainty::RoughBound if self.has_bounds() => evaluator.rough_worst(context, frames, scratch),
                Certainty::Bound if self.has_bounds() => evaluator.corner_worst(context, frames, scratch),
                _ => evaluator.value(context, frames, scratch),
            };
        };
        let (node, ValueScratch { evaluator, figure }) = (self.figure(context, frames), memory);
        match certainty {
            Certainty::RoughBound => pricing.rough_bound(&node, evaluator, figure),
            _ => pricing.bound(&node, evaluator, figure),
        }
    }

    /// Returns the data from which the error of the operation at a posture is computed.
    pub fn figure<'a>(&'a self, context: &'a WorkContext, frames: &'a Frames) -> NodeFigure<'a> {
        NodeFigure { evaluator: &self.evaluator, context, frames, share: DEFAULT_YIELD }
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
