//! Two layouts node by node, and in words which is better.

use super::{Assessment, Comparison};
use crate::cell::Unit;
use crate::error_map::{NodeRecord, OperationMap, Status};
use crate::files::shown;

/// Values nearer than this share are called equal.
const EQUAL: f64 = 0.005;

/// One node of an operation in two layouts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodePair {
    pub i: usize,
    pub j: usize,
    /// In the frame of the equipment, m.
    pub at: (f64, f64),
    /// What the reading makes small (m, rad or a share) in the first and in the other layout; None where
    /// the node cannot be used.
    pub first: Option<f64>,
    pub other: Option<f64>,
}

impl NodePair {
    /// Other less first: negative where the other layout is better.
    pub fn difference(&self) -> Option<f64> {
        Some(self.other? - self.first?)
    }
}

/// An operation in two layouts.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    pub operation: usize,
    pub pairs: Vec<NodePair>,
}

impl Difference {
    /// Nodes that both can use: how many are better and worse in the other layout.
    pub fn better_and_worse(&self) -> (usize, usize) {
        let all = || self.pairs.iter().filter_map(NodePair::difference);
        (all().filter(|d| *d < 0.0).count(), all().filter(|d| *d > 0.0).count())
    }

    /// Nodes that only the other layout can use, and that only the first can.
    pub fn gained_and_lost(&self) -> (usize, usize) {
        let count = |gained: bool| {
            let one = |p: &&NodePair| p.other.is_some() == gained && p.first.is_some() != gained;
            self.pairs.iter().filter(one).count()
        };
        (count(true), count(false))
    }

    /// The largest size of a difference: the scale of a picture.
    pub fn largest(&self) -> f64 {
        self.pairs.iter().filter_map(NodePair::difference).fold(0.0, |most, d| most.max(d.abs()))
    }
}

impl Comparison<'_> {
    /// Every operation of a column against the first column, node by node.
    ///
    /// # Errors
    /// Why the nodes are not the same places of the surface.
    pub fn differences(&self, column: usize) -> Result<Vec<Difference>, String> {
        let (first, other) = (&self.columns[0], &self.columns[column]);
        let maps = first.maps.iter().zip(&other.maps).enumerate();
        maps.map(|(k, (a, b))| {
            if first.cell.operations[k].place != other.cell.operations[k].place {
                return Err(format!(
                    "{}: the nodes lie at other places of the surface in {} than in {}",
                    shown(&first.cell.operations[k].name),
                    shown(&other.label),
                    shown(&first.label)
                ));
            }
            let pairs = a.nodes.iter().zip(&b.nodes).map(|(x, y)| pair(first, a, x, y));
            Ok(Difference { operation: a.operation, pairs: pairs.collect() })
        })
        .collect()
    }

    /// Which layout is better in what, a sentence for each operation of each column but the first.
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

/// Of a node that can be used.
fn value(node: &NodeRecord) -> Option<f64> {
    node.posture.as_ref().filter(|_| node.status == Status::Ok).map(|p| p.value)
}

fn sentence(first: &Assessment<'_>, other: &Assessment<'_>, k: usize) -> String {
    let operation = &first.cell.operations[k];
    let (a, b, name) = (shown(&first.label), shown(&other.label), shown(&operation.name));
    let (x, y) = match (first.maps[k].value, other.maps[k].value) {
        (Some(x), Some(y)) => (x, y),
        (Some(_), None) => return format!("{b} has no spot for {name}, {a} has one"),
        (None, Some(_)) => return format!("{b} has a spot for {name}, {a} has none"),
        (None, None) => return format!("neither {a} nor {b} has a spot for {name}"),
    };
    let unit = first.cell.unit();
    let figures = {
        let [x, y] = [x, y].map(|v| unit.from_si(v));
        format!("{y:.3} against {x:.3} {}", unit.word())
    };
    let what = match unit {
        Unit::Share => "share of failures".to_string(),
        _ => shown(&operation.sense.name),
    };
    let (less, more) = (x.min(y), x.max(y));
    if more - less <= EQUAL * more {
        return format!("{name}: {b} is as good as {a} in {what} ({figures})");
    }
    let verb = if y < x { "better" } else { "worse" };
    let by = match more / less {
        ratio if ratio < 1.1 => format!("{:.1} % ", 100.0 * (more - less) / x),
        ratio if ratio < 100.0 => format!("{ratio:.1} times "),
        // Of next to nothing there is no sensible multiple.
        _ => String::new(),
    };
    format!("{name}: {b} is {by}{verb} than {a} in {what} ({figures})")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

    use super::*;
    use crate::layout::Workcell;

    fn workcell() -> Workcell {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/cells/");
        let mut read = |path: &str| std::fs::read(format!("{folder}{path}")).map_err(|e| e.to_string());
        Workcell::new(crate::files::load("hitachi_paper.toml", &mut read).unwrap().cell).unwrap()
    }

    #[test]
    fn nodes_are_paired_by_their_place_on_the_surface() {
        let workcell = workcell();
        let (start, mut moved) = (workcell.cell.start(), workcell.cell.start());
        moved.placements[0].y += 0.15;
        moved.placements[0].yaw += 0.2;
        let column = |name: &str, layout| Assessment::new(name, &workcell, layout);
        let comparison = Comparison::new(vec![column("A", start), column("B", moved.clone())]).unwrap();
        let difference = &comparison.differences(1).unwrap()[0];
        assert_eq!(difference.pairs.len(), 99);
        let other = &comparison.columns[1];
        for (pair, node) in difference.pairs.iter().zip(&other.maps[0].nodes) {
            let at = nalgebra::Vector3::new(pair.at.0, pair.at.1, 0.0);
            let there = moved.placements[0].pose().transform(&at);
            assert!((there - node.position).xy().norm() < 1e-12);
        }
        let (better, worse) = difference.better_and_worse();
        let (gained, lost) = difference.gained_and_lost();
        let both = difference.pairs.iter().filter(|p| p.difference().is_some()).count();
        assert!(better + worse <= both && both > 20);
        // Usable in the other: those of both, and those gained.
        assert_eq!(both + gained, other.maps[0].count("ok"));
        assert_eq!(both + lost, comparison.columns[0].maps[0].count("ok"));
    }

    #[test]
    fn words_say_how_many_times_better() {
        let workcell = workcell();
        let column = |name: &str, value: Option<f64>| {
            let mut a = Assessment::new(name, &workcell, workcell.cell.start());
            a.maps[0].value = value;
            a
        };
        let say = |x: Option<f64>, y: Option<f64>| {
            let columns = vec![column("A", x), column("B", y)];
            Comparison::new(columns).unwrap().in_words().remove(0)
        };
        let name = &workcell.cell.operations[0].name;
        let sense = &workcell.cell.operations[0].sense.name;
        let said = say(Some(0.0036), Some(0.002));
        assert_eq!(said, format!("{name}: B is 1.8 times better than A in {sense} (2.000 against 3.600 mm)"));
        assert!(say(Some(0.002), Some(0.005)).contains("2.5 times worse"));
        assert!(say(Some(0.002), Some(0.00206)).contains("3.0 % worse"));
        assert!(say(Some(0.002), Some(0.002_004)).contains("as good as"));
        assert!(say(Some(0.002), None).contains("B has no spot"));
        assert!(say(None, None).contains("neither A nor B"));
    }
}
