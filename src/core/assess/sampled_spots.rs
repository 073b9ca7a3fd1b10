//! Monte Carlo check of the spots of a layout, and the overall yield.
//!
//! The overall yield is the share of samples that stay within the limits of all operations together.

use crate::cell::{Layout, Reading};
use crate::error_map::{OperationMap, PostureRecord};
use crate::layout::{Evaluation, Workcell, combined};
use crate::reading::{Estimate, MonteCarlo, SampleSpace, SampledPosture, WorkContext, joint_monte_carlo};
use crate::robot::Frames;

/// Number of Monte Carlo samples that are drawn at a spot.
pub const SAMPLES: usize = 1 << 16;

/// Estimates at the spots of a layout, all from the same samples.
pub struct SampledSpots {
    pub samples: Vec<Option<MonteCarlo>>,
    pub cell_yield: Option<Estimate>,
}

impl SampledSpots {
    /// Draws samples of the errors at the spots of all operations; there are no estimates unless the reading
    /// is statistical.
    pub fn new(workcell: &Workcell, layout: &Layout, maps: &[OperationMap]) -> Self {
        let cell = &workcell.cell;
        let mut samples = vec![None; maps.len()];
        if cell.reading != Reading::Statistical {
            return Self { samples, cell_yield: None };
        }
        let posed: Vec<(usize, WorkContext, Frames, f64)> = (0..maps.len())
            .filter_map(|k| {
                let posture = maps[k].best_node()?.posture.as_ref()?;
                let (context, frames) = workcell.posed(layout, maps, k, posture).ok()?;
                Some((k, context, frames, posture.figures[workcell.evaluator(k).own()].p95))
            })
            .collect();
        let postures: Vec<SampledPosture<'_>> = posed
            .iter()
            .map(|(k, context, frames, p95)| SampledPosture {
                evaluator: workcell.evaluator(*k),
                context,
                frames,
                p95: *p95,
            })
            .collect();
        let space = SampleSpace::of_cell(cell);
        let joint = joint_monte_carlo(&space, &postures, SAMPLES, cell.search.seed);
        for ((k, ..), of) in posed.iter().zip(joint.operations) {
            samples[*k] = Some(of);
        }
        let is_whole = samples.iter().all(Option::is_some);
        Self { samples, cell_yield: joint.together.filter(|_| is_whole) }
    }
}

/// Compares the figures of each spot with samples. If the samples do not confirm the figures of a spot, the
/// estimates from the samples replace these figures.
///
/// Returns for each operation whether the samples confirm the figures; None without samples.
///
/// Samples are drawn at one node only. So the value of a map stays a first-order value if the operation
/// happens at every node. Samples ignore placement tolerances. So the value of every map stays a first-order
/// value if the search is robust.
pub fn take_over(
    workcell: &Workcell,
    samples: &[Option<MonteCarlo>],
    maps: &mut [OperationMap],
    evaluation: &mut Evaluation,
) -> Vec<Option<bool>> {
    let confirmed = samples.iter().zip(maps.iter_mut()).enumerate().map(|(k, (samples, map))| {
        let (samples, best) = (samples.as_ref()?, map.best?);
        let posture = map.nodes[best].posture.as_mut()?;
        let (evaluator, PostureRecord { figures, success, value, .. }) = (workcell.evaluator(k), posture);
        let figures = &mut figures[evaluator.own()];
        let is_confirmed = samples.check(evaluator.quantity, figures, success, value);
        let over_nodes = workcell.cell.operations[k].over.needs_every_node();
        if !is_confirmed && !over_nodes && !workcell.cell.search.robust {
            map.value = Some(*value);
        }
        Some(is_confirmed)
    });
    let confirmed: Vec<Option<bool>> = confirmed.collect();
    if confirmed.contains(&Some(false)) && evaluation.objective.is_some() {
        let values: Option<Vec<f64>> = maps.iter().map(|map| map.value).collect();
        evaluation.objective = values.map(|values| combined(&workcell.cell, &values));
    }
    confirmed
}
