//! Shortlist: the best layouts that differ from each other by more than [`REALLY_DIFFERENT`].

use super::pareto_front::differ;
use serde::{Deserialize, Serialize};

/// Any two layouts of a shortlist differ by more than this value in at least one coordinate.
///
/// The difference of a coordinate is a share of its range. For a coordinate with listed values, the share is
/// the difference of the list indices divided by the number of values.
pub const REALLY_DIFFERENT: f64 = 0.05;

/// Number of stored layouts per requested layout.
///
/// More layouts are stored than requested, because one better layout may replace several.
const RESERVE_FACTOR: usize = 4;

/// Best layouts seen, each of which differs from every better layout by more than [`REALLY_DIFFERENT`].
///
/// A layout that was replaced by a similar, better layout does not return. This holds even if the better
/// layout is itself replaced later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shortlist {
    keep: usize,
    /// Cost of each stored layout and its point of the unit cube, best first.
    members: Vec<(f64, Vec<f64>)>,
}

impl Shortlist {
    /// Returns an empty shortlist of `keep` layouts.
    pub fn new(keep: usize) -> Self {
        Self { keep, members: Vec::new() }
    }

    /// Adds a layout, unless the shortlist has a similar layout of at most the same cost.
    ///
    /// The new layout replaces all similar layouts of greater cost. If the shortlist is too long, the layout
    /// of greatest cost is dropped.
    pub fn take(&mut self, point: &[f64], cost: f64) {
        // If two layouts have equal costs, the first of them is kept.
        let place = self.members.partition_point(|m| m.0 <= cost);
        let full = place >= RESERVE_FACTOR * self.keep;
        if full || self.members[..place].iter().any(|m| !differ(&m.1, point, REALLY_DIFFERENT)) {
            return;
        }
        let mut later = self.members.split_off(place);
        later.retain(|m| differ(&m.1, point, REALLY_DIFFERENT));
        self.members.push((cost, point.to_vec()));
        self.members.append(&mut later);
        self.members.truncate(RESERVE_FACTOR * self.keep);
    }

    /// Returns the best layouts as points of the unit cube, best first, at most as many as were requested.
    pub fn best(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.members.iter().take(self.keep).map(|m| &m.1)
    }
}
