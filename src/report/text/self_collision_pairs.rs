//! Self-collision: which solids of the robot are checked against each other.

use crate::clearance::{Allowed, SelfCollisionPair};
use crate::files::shown;
use crate::layout::Workcell;

/// Returns one line: the number of checked pairs of solids, and the pairs that may touch. Pairs on the same
/// link or on neighbouring links are counted but not named.
pub fn self_collision_pairs(workcell: &Workcell) -> String {
    let pairs = workcell.self_collision_pairs();
    if pairs.is_empty() {
        return "self-collision: not checked".into();
    }
    let count = |why: Option<Allowed>| pairs.iter().filter(|p| p.allowed == why).count();
    let name = |pair: &SelfCollisionPair| {
        let [a, b] = [pair.a, pair.b].map(|id| shown(&id.in_words(&workcell.cell)));
        format!("{a} - {b}")
    };
    let mut may = vec![
        format!("{} between neighbouring links", count(Some(Allowed::Neighbours))),
        format!("{} of the same link", count(Some(Allowed::SameLink))),
    ];
    for why in [Allowed::Given, Allowed::AlwaysTouch] {
        may.extend(
            pairs
                .iter()
                .filter(|p| p.allowed == Some(why))
                .map(|p| format!("{} ({})", name(p), why.in_words())),
        );
    }
    format!("self-collision: {} pairs of solids checked; may touch: {}", count(None), may.join(", "))
}
