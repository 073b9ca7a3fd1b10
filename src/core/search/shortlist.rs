//! Shortlist: the best layouts that really differ.

use super::pareto_front::differ;
use serde::{Deserialize, Serialize};

/// Least difference of a coordinate between two layouts that really differ.
///
/// It is a share of the range of the coordinate, or of the number of listed values.
pub const REALLY_DIFFERENT: f64 = 0.05;

/// Number of members per requested layout: a better layout may replace several at once.
const RESERVE_FACTOR: usize = 4;

/// Best layouts seen, each of which really differs from every better one.
///
/// A layout that a better neighbour has replaced does not return, even if that neighbour is replaced later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shortlist {
    keep: usize,
    /// Cost and point of the unit cube, best first.
    members: Vec<(f64, Vec<f64>)>,
}

impl Shortlist {
    /// Returns an empty shortlist of `keep` layouts.
    pub fn new(keep: usize) -> Self {
        Self { keep, members: Vec::new() }
    }

    /// Offers a layout to the shortlist.
    pub fn take(&mut self, point: &[f64], cost: f64) {
        // Among equals the first stays.
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

    /// Returns the points of the best layouts.
    pub fn best(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.members.iter().take(self.keep).map(|m| &m.1)
    }
}
