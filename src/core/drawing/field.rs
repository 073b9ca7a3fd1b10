//! Error maps as plain data for pictures: the nodes and their errors under each model and reading.

use super::Detail;
use crate::assess::Assessment;
use crate::cell::{Cell, Interpretation, JointVector, Model, Quantity, Reading, Sense};
use crate::error_map::{NodeRecord, NodeSign, OperationMap, PostureRecord};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Error model and reading (interpretation of the errors) under which errors are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorView {
    pub model: Model,
    pub reading: Reading,
    /// Quantity of the statistical reading. If this is the yield, the 95th percentile is shown instead.
    pub quantity: Quantity,
}

impl ErrorView {
    /// Returns the error model, the reading and the quantity that the cell states.
    pub fn of(cell: &Cell) -> Self {
        Self { model: cell.model, reading: cell.reading, quantity: cell.quantity }
    }

    /// Returns the interpretation of the errors of a cell under this model and reading.
    pub fn interpretation(&self, cell: &Cell) -> Interpretation {
        let Self { model, reading, quantity } = *self;
        Interpretation { model, reading, quantity, ..cell.interpretation() }
    }

    /// Returns whether errors have a sign in this reading. Without a sign, a value v means an error from -v
    /// to +v.
    pub fn is_signed(&self) -> bool {
        self.reading == Reading::Signed
    }

    /// Returns the name of the value that this reading gives: signed sample, worst case, p95 and others.
    pub fn reading_word(&self) -> &'static str {
        match (self.reading, self.quantity) {
            (Reading::Signed, _) => "signed sample",
            (Reading::WorstCase, _) => "worst case",
            // A yield belongs to one sense and its limit. Other senses show the 95th percentile.
            (Reading::Statistical, Quantity::Yield) => Quantity::P95.name(),
            (Reading::Statistical, quantity) => quantity.name(),
        }
    }
}

/// Returns the combinations of model and reading under which a cell can be evaluated.
///
/// The first is the combination that the cell states. If errors compensate each other
/// ([`Cell::errors_compensate`]), their magnitudes cannot serve as tolerances. If a cell has such errors, all
/// combinations after the first have the signed reading.
pub fn lenses(cell: &Cell) -> Vec<ErrorView> {
    let own = ErrorView::of(cell);
    let quantity = if cell.reading == Reading::Statistical { cell.quantity } else { Quantity::P95 };
    let models = [own.model].into_iter().chain(Model::ALL.into_iter().filter(|m| *m != own.model));
    let readings = [own.reading].into_iter().chain(Reading::ALL.into_iter().filter(|r| *r != own.reading));
    let readings: Vec<Reading> = readings.collect();
    let all =
        models.flat_map(|model| readings.iter().map(move |&reading| ErrorView { model, reading, quantity }));
    let is_known = |lens: &ErrorView| lens.is_signed() || !cell.errors_compensate();
    let answers = |lens: &ErrorView| is_known(lens) && cell.faults_of(&lens.interpretation(cell)).is_empty();
    let mut lenses = vec![own];
    let is_other = |lens: &ErrorView| (lens.reading, lens.model) != (own.reading, own.model);
    lenses.extend(all.filter(is_other).filter(answers));
    lenses
}

/// Node of an error map in the form in which pictures show it.
#[derive(Debug, Clone, PartialEq)]
pub struct FieldNode {
    pub i: usize,
    pub j: usize,
    /// Position of the TCP at the node, in the world frame, m.
    pub position: Vector3<f64>,
    pub sign: NodeSign,
    /// Reason why the node cannot be used; empty if the node is usable.
    pub reason: String,
    pub joints: Option<JointVector>,
}

impl FieldNode {
    /// Returns whether the node is usable.
    pub fn is_ok(&self) -> bool {
        self.sign.is_usable()
    }
}

/// Errors of the nodes in [`Field::nodes`] under one model and reading.
///
/// The entry of a node without a usable posture is None.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewedErrors {
    /// Model and reading of these errors, as an index into [`super::Drawing::lenses`].
    pub lens: usize,
    /// Error vector of the TCP at each node, in the world frame, m.
    ///
    /// In the signed reading, the vector is the error of the signed sample. In the other readings, the vector
    /// is the error at one corner of the tolerance box. At this corner, the error component that matters to
    /// the operation (its sense) is largest.
    pub error: Vec<Option<Vector3<f64>>>,
    /// Values that the reading gives, m or rad: one list per sense (error component), with one entry per
    /// node.
    pub values: Vec<Vec<Option<f64>>>,
    /// Spot under this model and reading, as an index into [`Field::nodes`].
    ///
    /// This index is None if there is no spot, or if [`Field::nodes`] lacks the node of the spot.
    pub best: Option<usize>,
}

/// Error map of an operation.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Mapped operation, as an index into the operations of the cell.
    pub operation: usize,
    pub senses: Vec<Sense>,
    /// Sense of the operation, as an index into [`Self::senses`].
    pub sense: usize,
    /// Numbers of nodes in [`Self::nodes`] along the first and the second axis of the grid. Points that the
    /// cell file lists one by one count as one row along the first axis.
    pub size: (usize, usize),
    /// All mapped nodes, or a regular selection of them ([`Self::every`]).
    ///
    /// The nodes are stored row by row. The nodes of a row follow the first axis of the grid.
    pub nodes: Vec<FieldNode>,
    /// Spot of the operation, as an index into [`Self::nodes`].
    ///
    /// This index is None if there is no spot, or if [`Self::nodes`] lacks the node of the spot.
    pub best: Option<usize>,
    /// Value of the operation under the model and reading of the cell, in the unit of the objective (SI).
    pub value: Option<f64>,
    /// Position of the spot, in the world frame, m; None if there is no spot.
    ///
    /// The position is given even if [`Self::nodes`] lacks the node of the spot.
    pub spot: Option<Vector3<f64>>,
    /// Position of the refined spot, in the world frame, m; None if the spot was not refined.
    ///
    /// The refined spot may lie between the nodes.
    pub refined: Option<Vector3<f64>>,
    /// Stride between the nodes in [`Self::nodes`] along each axis.
    ///
    /// A stride of 1 keeps every mapped node. A stride of 2 keeps every second node along each axis, and so
    /// on.
    pub every: usize,
    pub takes: Vec<ViewedErrors>,
}

impl Field {
    /// Returns the indices of the usable nodes.
    pub fn usable(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().enumerate().filter(|(_, n)| n.is_ok()).map(|(k, _)| k)
    }

    /// Returns the least and the greatest value of the usable nodes, m or rad; None if no usable node has a
    /// value.
    ///
    /// The index `take` into [`Self::takes`] selects the model and the reading. The index `sense` into
    /// [`Self::senses`] selects the sense.
    pub fn range(&self, take: usize, sense: usize) -> Option<(f64, f64)> {
        let values = &self.takes.get(take)?.values[sense];
        let values = self.usable().filter_map(|k| values[k]).map(|v| (v, v));
        values.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
    }
}

/// Returns the error maps of a layout for pictures, with the model and reading of each entry of
/// [`Field::takes`].
///
/// The maps are computed under the model and reading of the cell. If [`Detail::lenses`] is true, the maps are
/// also computed under the other combinations that [`lenses`] returns.
pub(super) fn fields(a: &Assessment<'_>, detail: &Detail) -> Result<(Vec<ErrorView>, Vec<Field>), String> {
    let lenses = if detail.lenses { lenses(a.cell) } else { vec![ErrorView::of(a.cell)] };
    let mut fields: Vec<Field> = (0..a.maps.len()).map(|k| field(a, k, detail)).collect();
    fields.iter_mut().zip(&a.maps).for_each(|(f, map)| f.takes.push(take(f, map, 0, a.cell)));
    let others: Vec<_> = lenses
        .par_iter()
        .enumerate()
        .skip(1)
        .map(|(l, lens)| {
            let workcell = a.workcell.interpreted(&lens.interpretation(a.cell))?;
            let maps = workcell.maps(&a.layout);
            Ok(fields.iter().zip(&maps).map(|(f, map)| take(f, map, l, &workcell.cell)).collect::<Vec<_>>())
        })
        .collect::<Result<_, String>>()?;
    for takes in others {
        fields.iter_mut().zip(takes).for_each(|(f, take)| f.takes.push(take));
    }
    Ok((lenses, fields))
}

fn field(a: &Assessment<'_>, k: usize, detail: &Detail) -> Field {
    let map = &a.maps[k];
    let operation = &a.cell.operations[map.operation];
    let (m, n) = operation.place.divisions();
    let (size, count) = ((m + 1, n + 1), (m + 1) * (n + 1));
    let mut every = 1;
    while count.div_ceil(every * every) > detail.nodes {
        every += 1;
    }
    let kept = |n: &&NodeRecord| is_kept(n, every);
    let node = |n: &NodeRecord| FieldNode {
        i: n.i,
        j: n.j,
        position: n.position,
        sign: n.status.sign(),
        reason: n.status.reason(a.cell),
        joints: n.posture.as_ref().map(|p| p.joints),
    };
    let nodes: Vec<FieldNode> = map.nodes.iter().filter(kept).map(node).collect();
    Field {
        operation: map.operation,
        sense: map.sense(&operation.sense.name).unwrap_or_default(),
        senses: map.senses.clone(),
        size: (size.0.div_ceil(every), size.1.div_ceil(every)),
        value: map.value,
        best: map.best_node().and_then(|best| nodes.iter().position(|n| (n.i, n.j) == (best.i, best.j))),
        nodes,
        spot: map.best_node().map(|best| best.position),
        refined: a.refined[k].as_ref().map(|r| r.position),
        every,
        takes: Vec::new(),
    }
}

fn is_kept(n: &NodeRecord, every: usize) -> bool {
    n.i.is_multiple_of(every) && n.j.is_multiple_of(every)
}

fn take(field: &Field, map: &OperationMap, lens: usize, cell: &Cell) -> ViewedErrors {
    let kept: Vec<&NodeRecord> = map.nodes.iter().filter(|n| is_kept(n, field.every)).collect();
    let values = (0..field.senses.len()).map(|s| {
        let value = |p: &PostureRecord| p.figures[s].in_reading(cell.reading, cell.quantity);
        kept.iter().map(|n| n.usable_posture().map(value)).collect()
    });
    let best = map.best_node().and_then(|best| kept.iter().position(|n| (n.i, n.j) == (best.i, best.j)));
    ViewedErrors {
        lens,
        error: kept.iter().map(|n| n.usable_posture().map(|p| p.error)).collect(),
        values: values.collect(),
        best,
    }
}
