//! The best layouts that really differ.

use super::front::differ;
use serde::{Deserialize, Serialize};

/// Two layouts really differ if a coordinate differs by more than this share of its range (of a list of
/// values: of their number).
pub const REALLY_DIFFERENT: f64 = 0.05;

/// So many times the layouts asked for are held: a better one may let go of several at once.
const SPARE: usize = 4;

/// The best layouts seen, each of which really differs from every better one. One that was let go for a
/// better one beside it does not come back when that goes, too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shortlist {
    keep: usize,
    /// Cost and point of the unit cube, best first.
    members: Vec<(f64, Vec<f64>)>,
}

impl Shortlist {
    pub fn new(keep: usize) -> Self {
        Self { keep, members: Vec::new() }
    }

    pub fn take(&mut self, point: &[f64], cost: f64) {
        // Of equals the first.
        let place = self.members.partition_point(|m| m.0 <= cost);
        let full = place >= SPARE * self.keep;
        if full || self.members[..place].iter().any(|m| !differ(&m.1, point, REALLY_DIFFERENT)) {
            return;
        }
        let mut later = self.members.split_off(place);
        later.retain(|m| differ(&m.1, point, REALLY_DIFFERENT));
        self.members.push((cost, point.to_vec()));
        self.members.append(&mut later);
        self.members.truncate(SPARE * self.keep);
    }

    /// The points of the best ones.
    pub fn best(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.members.iter().take(self.keep).map(|m| &m.1)
    }
}
