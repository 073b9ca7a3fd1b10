//! The error maps as they are drawn: every node under every model and reading.

use super::Detail;
use crate::assess::Assessment;
use crate::cell::{Cell, Interpretation, JointVector, Model, Quantity, Reading, Sense};
use crate::error_map::{NodeRecord, NodeSign, OperationMap, PostureRecord};
use nalgebra::Vector3;

/// A model and a reading under which errors are seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lens {
    pub model: Model,
    pub reading: Reading,
    /// Of the statistical reading.
    pub quantity: Quantity,
}

impl Lens {
    /// As the cell asks.
    pub fn of(cell: &Cell) -> Self {
        Self { model: cell.model, reading: cell.reading, quantity: cell.quantity }
    }

    /// Returns how the errors of a cell are interpreted under this lens.
    pub fn interpretation(&self, cell: &Cell) -> Interpretation {
        let Self { model, reading, quantity } = *self;
        Interpretation { model, reading, quantity, ..cell.interpretation() }
    }

    /// Whether errors have a sign under it; else they are plus or minus.
    pub fn is_signed(&self) -> bool {
        self.reading == Reading::Signed
    }

    /// What is read: signed sample, worst case, p95.
    pub fn reading_word(&self) -> &'static str {
        match (self.reading, self.quantity) {
            (Reading::Signed, _) => "signed sample",
            (Reading::WorstCase, _) => "worst case",
            // Of a yield, which belongs to one sense and its limit, the 95th percentile.
            (Reading::Statistical, Quantity::Yield) => Quantity::P95.name(),
            (Reading::Statistical, quantity) => quantity.name(),
        }
    }
}

/// The lenses under which a cell has an answer, its own first.
pub fn lenses(cell: &Cell) -> Vec<Lens> {
    let own = Lens::of(cell);
    let quantity = if cell.reading == Reading::Statistical { cell.quantity } else { Quantity::P95 };
    let models = [own.model].into_iter().chain(Model::ALL.into_iter().filter(|m| *m != own.model));
    let readings = [own.reading].into_iter().chain(Reading::ALL.into_iter().filter(|r| *r != own.reading));
    let readings: Vec<Reading> = readings.collect();
    let all = models.flat_map(|model| readings.iter().map(move |&reading| Lens { model, reading, quantity }));
    let answers = |lens: &Lens| cell.faults_of(&lens.interpretation(cell)).is_empty();
    let mut lenses = vec![own];
    let is_other = |lens: &Lens| (lens.reading, lens.model) != (own.reading, own.model);
    lenses.extend(all.filter(is_other).filter(answers));
    lenses
}

/// A node of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub i: usize,
    pub j: usize,
    /// TCP, world, m.
    pub position: Vector3<f64>,
    pub sign: NodeSign,
    /// Why it cannot be used, in words; empty if it can.
    pub reason: String,
    pub joints: Option<JointVector>,
}

impl Node {
    pub fn is_ok(&self) -> bool {
        self.sign.is_usable()
    }
}

/// The nodes under one lens; nothing where a node has no posture or the lens no answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Take {
    /// Index into [`super::Drawing::lenses`].
    pub lens: usize,
    /// World, m: of the signed sample, or of the corner of the tolerance box that is worst in the sense of
    /// the operation.
    pub error: Vec<Option<Vector3<f64>>>,
    /// One list per sense, m or rad: what the reading says.
    pub values: Vec<Vec<Option<f64>>>,
    /// The spot under this lens, index into [`Field::nodes`].
    pub best: Option<usize>,
}

/// The map of an operation.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Index into the operations of the cell.
    pub operation: usize,
    pub senses: Vec<Sense>,
    /// The operation's own among them.
    pub sense: usize,
    /// Nodes along the first and the second axis of the grid; of points all along the first.
    pub size: (usize, usize),
    /// Row by row along the first axis.
    pub nodes: Vec<Node>,
    /// The spot of the operation, index into [`Self::nodes`].
    pub best: Option<usize>,
    /// Where that is, also if the node is not kept; world, m.
    pub spot: Option<Vector3<f64>>,
    /// The spot between the nodes, world, m.
    pub refined: Option<Vector3<f64>>,
    /// So many nodes were mapped for one that is kept, along each axis.
    pub every: usize,
    pub takes: Vec<Take>,
}

impl Field {
    /// Indices of the nodes that can be used.
    pub fn usable(&self) -> impl Iterator<Item = usize> {
        self.nodes.iter().enumerate().filter(|(_, n)| n.is_ok()).map(|(k, _)| k)
    }

    /// Least and greatest value in a sense under a lens over the usable nodes, m or rad.
    pub fn range(&self, take: usize, sense: usize) -> Option<(f64, f64)> {
        let values = &self.takes.get(take)?.values[sense];
        let values = self.usable().filter_map(|k| values[k]).map(|v| (v, v));
        values.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b)))
    }
}

/// The maps of a layout under the lenses wanted.
pub(super) fn fields(a: &Assessment<'_>, detail: &Detail) -> Result<(Vec<Lens>, Vec<Field>), String> {
    let lenses = if detail.lenses { lenses(a.cell) } else { vec![Lens::of(a.cell)] };
    let mut fields: Vec<Field> = (0..a.maps.len()).map(|k| field(a, k, detail)).collect();
    for (l, lens) in lenses.iter().enumerate() {
        if l == 0 {
            fields.iter_mut().zip(&a.maps).for_each(|(f, map)| f.takes.push(take(f, map, l, a.cell)));
            continue;
        }
        let workcell = a.workcell.interpreted(&lens.interpretation(a.cell))?;
        let maps = workcell.maps(&a.layout);
        fields.iter_mut().zip(&maps).for_each(|(f, map)| f.takes.push(take(f, map, l, &workcell.cell)));
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
    let node = |n: &NodeRecord| Node {
        i: n.i,
        j: n.j,
        position: n.position,
        sign: n.status.sign(),
        reason: n.status.reason(a.cell),
        joints: n.posture.as_ref().map(|p| p.joints),
    };
    let nodes: Vec<Node> = map.nodes.iter().filter(kept).map(node).collect();
    Field {
        operation: map.operation,
        sense: map.sense(&operation.sense.name).unwrap_or_default(),
        senses: map.senses.clone(),
        size: (size.0.div_ceil(every), size.1.div_ceil(every)),
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

fn take(field: &Field, map: &OperationMap, lens: usize, cell: &Cell) -> Take {
    let kept: Vec<&NodeRecord> = map.nodes.iter().filter(|n| is_kept(n, field.every)).collect();
    let values = (0..field.senses.len()).map(|s| {
        let value = |p: &PostureRecord| p.figures[s].in_reading(cell.reading, cell.quantity);
        kept.iter().map(|n| n.usable_posture().map(value)).collect()
    });
    let best = map.best_node().and_then(|best| kept.iter().position(|n| (n.i, n.j) == (best.i, best.j)));
    Take {
        lens,
        error: kept.iter().map(|n| n.usable_posture().map(|p| p.error)).collect(),
        values: values.collect(),
        best,
    }
}
