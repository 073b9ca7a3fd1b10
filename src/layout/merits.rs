//! What a layout is worth besides its errors: clearance, distance from limits and singularities.

use super::{Evaluation, Workcell};
use crate::cell::Layout;
use crate::clearance::{Nearness, Placed};
use crate::error_map::Outcome;
use crate::motion::{Measures, measures};

/// Of an operation at its spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merit {
    /// Up to what was asked for.
    pub clearance: Nearness,
    pub measures: Measures,
}

/// The merits of every operation that has a spot; clearances up to `max` (m).
pub fn merits(workcell: &Workcell, layout: &Layout, evaluation: &Evaluation, max: f64) -> Vec<Option<Merit>> {
    let Workcell { cell, mapper, scene, .. } = workcell;
    let mut placed = Placed::default();
    scene.place(layout, &mut placed);
    let reach = cell.robot.reach();
    let merit = |(operation, outcome): (usize, &Outcome)| {
        let Outcome::Found(spot) = outcome else { return None };
        let joints = mapper.stance(operation, layout, spot)?.joints;
        let frames = mapper.frames(&joints);
        Some(Merit {
            clearance: scene.distance(&placed, &frames.links, Some(operation), max),
            measures: measures(mapper.chain(), &joints, reach),
        })
    };
    evaluation.outcomes.iter().enumerate().map(merit).collect()
}
