//! Comparison of layouts node by node, and a sentence that says which layout is better.

use super::{Assessment, Comparison};
use crate::cell::Unit;
use crate::error_map::{NodeRecord, OperationMap};
use crate::safe_text::shown;

/// Relative difference up to which two values count as equal.
const EQUAL_SHARE: f64 = 0.005;

/// Node of an operation, with its values in two layouts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodePair {
    pub i: usize,
    pub j: usize,
    /// Position (x, y) of the node in the frame of the equipment, m.
    pub at: (f64, f64),
    /// Value of the node (m, rad, a share of failures or a cost) in the first layout; None for an unusable
    /// node.
    pub first: Option<f64>,
    /// Value of the node in the other layout; None for an unusable node.
    pub other: Option<f64>,
}

impl NodePair {
    /// Returns [`Self::other`] minus [`Self::first`]; negative if the other layout is better.
    ///
    /// Returns None if the node is unusable in either layout.
    pub fn difference(&self) -> Option<f64> {
        Some(self.other? - self.first?)
    }
}

/// Comparison of one operation in two layouts, node by node.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationDifference {
    pub operation: usize,
    pub pairs: Vec<NodePair>,
}

impl OperationDifference {
    /// Returns how many nodes have a smaller value in the other layout, and how many have a larger value
    /// there.
    ///
    /// Nodes that are unusable in either layout are ignored.
    pub fn better_and_worse(&self) -> (usize, usize) {
        let all = || self.pairs.iter().filter_map(NodePair::difference);
        (all().filter(|d| *d < 0.0).count(), all().filter(|d| *d > 0.0).count())
    }

    /// Returns the number of nodes usable only in the other layout, and the number of nodes usable only in
    /// the first layout.
    pub fn gained_and_lost(&self) -> (usize, usize) {
        let count = |gained: bool| {
            let one = |p: &&NodePair| p.other.is_some() == gained && p.first.is_some() != gained;
            self.pairs.iter().filter(one).count()
        };
        (count(true), count(false))
    }

    /// Returns the largest absolute difference over all nodes (m, rad, a share of failures or a cost). This
    /// value sets the colour scale of a picture.
    pub fn largest(&self) -> f64 {
        self.pairs.iter().filter_map(NodePair::difference).fold(0.0, |most, d| most.max(d.abs()))
    }
}

impl Comparison<'_> {
    /// Compares the layout in column `column` with the first layout, operation by operation and node by node.
    ///
    /// # Errors
    /// Returns a message if the two layouts have their nodes at different places on the surface.
    pub fn differences(&self, column: usize) -> Result<Vec<OperationDifference>, String> {
        let (first, other) = (&self.columns[0], &self.columns[column]);
        let maps = first.maps.iter().zip(&other.maps).enumerate();
        maps.map(|(k, (a, b))| {
            if first.cell.operations[k].place != other.cell.operations[k].place {
                return Err(format!(
                    "{}: the nodes of {} and {} are not at the same places on the surface",
                    shown(&first.cell.operations[k].name),
                    shown(&other.label),
                    shown(&first.label)
                ));
            }
            let pairs = a.nodes.iter().zip(&b.nodes).map(|(x, y)| pair(first, a, x, y));
            Ok(OperationDifference { operation: a.operation, pairs: pairs.collect() })
        })
        .collect()
    }

    /// Compares each later layout with the first layout, in words. One sentence per operation says which of
    /// the two layouts is better.
    pub fn in_words(&self) -> Vec<String> {
        let Some((first, others)) = self.columns.split_first() else { return Vec::new() };
        let all = others
            .iter()
            .flat_map(|other| (0..first.maps.len()).map(move |operation| sentence(first, other, operation)));
        all.collect()
    }
}

fn pair(first: &Assessment<'_>, map: &OperationMap, x: &NodeRecord, y: &NodeRecord) -> NodePair {
    let at = &first.layout.placements[first.cell.operations[map.operation].equipment];
    let place = at.pose().inverse().transform(&x.position);
    NodePair { i: x.i, j: x.j, at: (place.x, place.y), first: value(x), other: value(y) }
}

/// Returns the value that the search minimizes at a node; None if the node is not usable.
fn value(node: &NodeRecord) -> Option<f64> {
    node.usable_posture().map(|p| p.value)
}

fn sentence(first: &Assessment<'_>, other: &Assessment<'_>, k: usize) -> String {
    let operation = &first.cell.operations[k];
    let (a, b, name) = (shown(&first.label), shown(&other.label), shown(&operation.name));
    let (x, y) = match (first.maps[k].value, other.maps[k].value) {
        (Some(x), Some(y)) => (x, y),
        (Some(_), None) => return format!("{b} has no spot for {name}, but {a} has one"),
        (None, Some(_)) => return format!("{b} has a spot for {name}, but {a} has none"),
        (None, None) => return format!("neither {a} nor {b} has a spot for {name}"),
    };
    let unit = first.cell.unit();
    let figures = {
        let [x, y] = [x, y].map(|v| unit.from_si(v));
        format!("{y:.3} against {x:.3} {}", unit.word())
    };
    let what = match unit {
        Unit::Share => "the share of failures".to_string(),
        Unit::Cost => "the cost of its tolerances".to_string(),
        _ => shown(&operation.sense.name),
    };
    let (less, more) = (x.min(y), x.max(y));
    if more - less <= EQUAL_SHARE * more {
        return format!("{name}: {b} is as good as {a} in {what} ({figures})");
    }
    let verb = if y < x { "better" } else { "worse" };
    let by = match more / less {
        ratio if ratio < 1.1 => format!("{:.1} % ", 100.0 * (more - less) / x),
        ratio if ratio < 100.0 => format!("{ratio:.1} times "),
        // A ratio has no meaning if the value in its denominator is near zero.
        _ => String::new(),
    };
    format!("{name}: {b} is {by}{verb} than {a} in {what} ({figures})")
}
