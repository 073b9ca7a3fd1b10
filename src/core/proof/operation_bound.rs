//! Lower bound of the value of one operation.

use super::branch_and_bound;
use super::node_radii::least_of_all_nodes;
use super::region::OperationRegion;
use super::task::Task;
use super::{OperationBound, ProofOptions, WhyNot};
use crate::cell::JointVector;
use crate::layout::Workcell;
use std::sync::atomic::AtomicBool;

/// Nodes that the bound of an operation at every node takes into account.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NodesBounded {
    /// The bound is that of the best node alone. It takes less time.
    One,
    Every,
}

/// Returns a lower bound of the value of one operation over several regions. The bound is the least of the
/// bounds over the single regions.
///
/// The second result states whether the proof was interrupted.
pub(super) fn of_regions(
    workcell: &Workcell,
    regions: &[OperationRegion],
    nodes: NodesBounded,
    known: Option<f64>,
    options: &ProofOptions,
    stop: &AtomicBool,
) -> (OperationBound, bool) {
    let (mut all, mut interrupted) =
        (OperationBound { value: Err(WhyNot::Infeasible), boxes: 0, witness: None }, false);
    // Least bound of the regions in which no placement lets the arm reach every node.
    let mut out_of_reach: Option<f64> = None;
    let mut bounds: Vec<(&OperationRegion, OperationBound)> = Vec::with_capacity(regions.len());
    for region in regions {
        let best = bounds.iter().filter_map(|(_, b)| b.witness.map(|w| w.0)).chain(known).reduce(f64::min);
        let (one, stopped) = of_operation(workcell, region, best, options, stop);
        interrupted |= stopped;
        bounds.push((region, one));
    }
    // The bound of every node in the first region excludes most of the other regions.
    bounds.sort_by(|a, b| a.1.value.unwrap_or(0.0).total_cmp(&b.1.value.unwrap_or(0.0)));
    for (region, mut one) in bounds {
        if let (NodesBounded::Every, Ok(start)) = (nodes, one.value) {
            // A bound above the bound of another region is of no use.
            let enough = all.value.ok().into_iter().chain(known).fold(f64::INFINITY, f64::min);
            let raised = least_of_all_nodes(workcell, region, (start, enough), options, stop);
            let (bound, boxes) = raised.unwrap_or((start, 0));
            one.boxes += boxes;
            one.value = if bound.is_finite() { Ok(bound) } else { Err(WhyNot::Infeasible) };
            out_of_reach =
                out_of_reach.into_iter().chain(bound.is_infinite().then_some(start)).reduce(f64::min);
        }
        all.boxes += one.boxes;
        let by_value = |a: &(f64, JointVector), b: &(f64, JointVector)| a.0.total_cmp(&b.0);
        all.witness = all.witness.into_iter().chain(one.witness).min_by(by_value);
        all.value = match (all.value, one.value) {
            (Ok(a), Ok(b)) => Ok(a.min(b)),
            // A region without a posture does not lower the bound. If a region has no bound, the operation
            // has no bound.
            (a, Err(WhyNot::Infeasible)) => a,
            (Err(WhyNot::Infeasible), b) => b,
            (Err(why), _) | (_, Err(why)) => Err(why),
        };
    }
    if let (Err(WhyNot::Infeasible), Some(bound)) = (all.value, out_of_reach) {
        all.value = Ok(bound);
    }
    (all, interrupted)
}

/// Returns a lower bound of the value of one operation over a region. `known` is the least value known so
/// far, if any.
///
/// The second result states whether the proof was interrupted.
fn of_operation(
    workcell: &Workcell,
    region: &OperationRegion,
    known: Option<f64>,
    options: &ProofOptions,
    stop: &AtomicBool,
) -> (OperationBound, bool) {
    let none = |why| OperationBound { value: Err(why), boxes: 0, witness: None };
    let task = match Task::new(workcell, region) {
        Ok(task) => task,
        Err(why) => return (none(why), false),
    };
    let known = known.unwrap_or(f64::INFINITY);
    let Some(found) = branch_and_bound::least(&task, known, options.gap, options.boxes, stop) else {
        return (none(WhyNot::Infeasible), false);
    };
    // An error that can vanish has the bound 0, which is exact.
    let closed = found.best.is_some_and(|(value, _)| value < branch_and_bound::VANISHES);
    let value = if found.bound > 0.0 || closed { Ok(found.bound) } else { Err(WhyNot::Boxes) };
    (OperationBound { value, boxes: found.boxes, witness: found.best }, found.interrupted)
}
