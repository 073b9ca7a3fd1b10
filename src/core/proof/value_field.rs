//! Value fields: lower bounds of the value at a node, over the height of the node and its distance from the
//! base axis (radius).
//!
//! A search evaluates thousands of layouts, and in each layout most nodes cannot be the spot. A value field
//! excludes such a node without solving the inverse kinematics. The field is computed once per cell.
//!
//! Let the first axis be vertical and pass through the origin of the base frame. Let the value of the
//! operation stay unchanged if the error is rotated about the vertical. The bounds of this module then do not
//! depend on the angle of the first joint. Let `phi(q)` be such a lower bound of the value of the posture q.
//! Let `h(q)` be the height of the TCP, and `r(q)` its distance from the base axis. A posture at a node with
//! the height h and the radius r has a value of at least
//!
//! ```text
//! F(h, r) = min { phi(q) : h(q) = h, r(q) = r, q within the joint limits, tool elevation as requested }
//! ```
//!
//! The azimuth of the node and the spin of the tool do not appear in F. One function of two variables
//! therefore bounds the values at all nodes of all layouts. If the operation has a single height, F has one
//! variable.
//!
//! F is bounded from below by a function that is constant on each cell of a table. Boxes of joint coordinates
//! cover all postures of the operation ([`super::joint_box`]). The constraints of height, elevation and
//! radius contract each box. Second-order Taylor models of `h(q)` and `r(q)^2` give the ranges of height and
//! radius over the box. A box whose ranges are long is bisected, in the coordinate that contributes most to
//! them. The value in a box with short ranges is bounded by Lagrangian relaxation
//! ([`super::branch_and_bound`]). Each table cell that overlaps the ranges of a box then gets the least bound
//! of all such boxes. No posture reaches a table cell without boxes, so the bound of this cell is infinite.
//!
//! A box whose bound is much less than its value at the centre is bisected further, until the allowed number
//! of boxes is examined. The first boxes are bisected to a finer resolution, so that a simple arm gets a
//! sharp field. A coarse box lowers the bounds of the field, but they remain valid. The search therefore
//! finds the same spots with any field, bit for bit (`cargo test --test maths ranking::`).
//!
//! The postures at a node differ much in value. The field therefore also keeps one bound per configuration of
//! the arm, for example elbow up or down ([`ConfigurationFlags`]). The bound of a box counts for each
//! configuration that the ranges of its joint angles allow.
//!
//! The bound of a percentile assumes that its square is convex in the covariance ([`super::value_bound`]).
//! This assumption is tested, but not proven. A field of percentiles is therefore lowered by
//! [`PERCENTILE_MARGIN`].

use super::WhyNot;
use super::branch_and_bound::lowered;
use super::configuration_choice::ConfigurationChoice;
use super::joint_box::{ContractedBox, JointBox, widest};
use super::region::{ConstrainedQuantity, OperationRegion, chosen_elevations};
use super::task::Task;
use super::taylor_model::Taylor;
use crate::cell::{Quantity, Reading};
use crate::error_map::{ConfigurationFlags, PostureOrder, ValueField};
use crate::layout::Workcell;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// Least number of layout evaluations for which the computation of value fields saves time. Computing the
/// fields of a cell takes at most as long as two thousand evaluations.
pub const LAYOUTS_WORTH_A_FIELD: u64 = 4_000;
/// Largest number of boxes of joint coordinates that are examined per operation and range of heights.
const MAX_BOXES: usize = 300_000;
/// Resolution of a field that needs many boxes.
const COARSE: FieldResolution = FieldResolution { longest: 0.05, looseness: 0.05 };
/// Resolution of a field that needs few boxes.
const FINE: FieldResolution = FieldResolution { longest: 0.0125, looseness: 0.01 };
/// Number of boxes up to which boxes are bisected to the resolution [`FINE`].
const FINE_BOXES: usize = 4_000;
/// Length of a table cell as a share of the longest range of a box.
const CELL_SHARE: f64 = 0.5;
/// Share by which the bounds of percentiles are lowered.
const PERCENTILE_MARGIN: f64 = 2e-3;

/// Resolution to which boxes of joint coordinates are bisected.
struct FieldResolution {
    /// Longest range of height or radius of a box that is not bisected, as a share of the reach of the arm.
    longest: f64,
    /// A box is bisected further if its bound is less than the value at its centre by more than this share.
    looseness: f64,
}

/// Computes the value fields of a workcell, if they are not known yet. Later evaluations of its layouts then
/// visit fewer nodes. Their results stay the same, bit for bit.
///
/// Once `stop` is set, the function returns early and keeps no field.
pub fn rank_nodes(workcell: &Workcell, stop: &AtomicBool) {
    workcell.keep_value_fields(|| {
        let operations = 0..workcell.cell.operations.len();
        let fields = operations.map(|k| value_fields(workcell, k, stop).unwrap_or_default()).collect();
        (!stop.load(Ordering::Relaxed)).then_some(fields)
    });
}

/// Returns the reason why an operation has no value field; None if [`value_fields`] can compute its fields.
pub fn why_no_field(workcell: &Workcell, operation: usize) -> Option<&'static str> {
    regions(workcell, operation).iter().find_map(|region| prepared(workcell, region).err())
}

/// Returns the regions of an operation, one for each combination of listed heights of its equipment and its
/// carriers.
fn regions(workcell: &Workcell, operation: usize) -> Vec<OperationRegion> {
    OperationRegion::all(&workcell.cell, operation, workcell.inverse().fixed_elevation())
}

/// Computes the value fields of an operation. If the cell lists heights of the equipment under the
/// operation or of its carriers, there is one field per combination of heights. Otherwise there is a single
/// field.
///
/// Once `stop` is set, the function returns early. The fields must then not be used.
///
/// # Errors
/// Returns the reason if the operation has no value field.
pub fn value_fields(
    workcell: &Workcell,
    operation: usize,
    stop: &AtomicBool,
) -> Result<Vec<ValueField>, &'static str> {
    let regions = regions(workcell, operation);
    regions.iter().map(|region| prepared(workcell, region).map(|search| search.field(stop))).collect()
}

/// Prepares the computation of a field, or returns the reason why the region has none.
fn prepared<'a>(workcell: &'a Workcell, region: &OperationRegion) -> Result<FieldSearch<'a>, &'static str> {
    let operation = &workcell.cell.operations[region.operation];
    let order = workcell.posture_orders().nth(region.operation);
    match order {
        Some(PostureOrder::RankedNodes) => {
            return Err("the search already ranks the nodes of each layout by a lower bound of their error");
        }
        _ if operation.over.needs_every_node() => {
            return Err("it happens at every node, so no node can be left out");
        }
        _ => {}
    }
    let task = Task::new(workcell, region).map_err(WhyNot::in_words)?;
    if !task.starts_at_base_axis {
        return Err("the first joint does not rotate the arm about the z axis of the robot base");
    }
    let radius = region.radius.filter(|_| !task.needs_first_joint);
    let radius = radius.ok_or("its error depends on the direction of a node from the robot base")?;
    let evaluator = workcell.evaluator(region.operation);
    let is_percentile = evaluator.reading == Reading::Statistical
        && matches!(evaluator.quantity, Quantity::P95 | Quantity::P99);
    let kept = if is_percentile { 1.0 - PERCENTILE_MARGIN } else { 1.0 };
    let elevation = chosen_elevations(operation);
    let flags = ConfigurationChoice::new(workcell, region, radius).flags();
    let (reach, height) = (task.reach(), region.height);
    Ok(FieldSearch { elevation, reach, height, radius, kept, flags, task })
}

/// Search over boxes of joint coordinates for the value field of one region.
struct FieldSearch<'a> {
    task: Task<'a>,
    /// Range of the elevation that the operation asks of the tool axis, rad.
    elevation: (f64, f64),
    /// Range of the height of a node, m.
    height: (f64, f64),
    /// Range of the radius of a node, m.
    radius: (f64, f64),
    /// Upper bound of the distance of the TCP from the origin of the base frame, m.
    reach: f64,
    /// Factor, at most 1, by which every bound is multiplied before the field records it.
    kept: f64,
    flags: ConfigurationFlags,
}

/// Result of examining a box.
enum Examined {
    /// No posture in the box satisfies the constraints.
    Empty,
    /// Ranges of height and radius (m), lower bound of the value, and configurations as a bit mask.
    Bounded { height: (f64, f64), radius: (f64, f64), bound: f64, configurations: u32 },
    /// Box that must be bisected, and the coordinate in which it is bisected.
    Bisected(JointBox, usize),
}

impl FieldSearch<'_> {
    /// Computes the field. Once `stop` is set, the function ends early, and the field must not be used.
    fn field(&self, stop: &AtomicBool) -> ValueField {
        let step = CELL_SHARE * FINE.longest * self.reach;
        let mut field = ValueField::new(self.elevation, self.height, self.radius, step, self.flags.clone());
        let (mut round, mut count) = (vec![JointBox::whole(&self.task)], 0);
        while !round.is_empty() && !stop.load(Ordering::Relaxed) {
            count += round.len();
            let resolution = match count + 2 * round.len() {
                boxes if boxes <= FINE_BOXES => Some(&FINE),
                boxes if boxes <= MAX_BOXES => Some(&COARSE),
                _ => None,
            };
            let examined: Vec<Examined> =
                round.into_par_iter().map(|part| self.examined(part, resolution)).collect();
            round = Vec::new();
            for one in examined {
                match one {
                    Examined::Empty => {}
                    Examined::Bounded { height, radius, bound, configurations } => {
                        field.note(height, radius, bound, configurations);
                    }
                    Examined::Bisected(part, cut) => round.extend(part.halves(cut)),
                }
            }
        }
        field
    }

    /// Examines a box. The box is not bisected if there is no `resolution`.
    fn examined(&self, part: JointBox, resolution: Option<&FieldResolution>) -> Examined {
        let task = &self.task;
        let Some(contracted) = part.contracted(task) else { return Examined::Empty };
        let [height, squared] = [ConstrainedQuantity::Height, ConstrainedQuantity::RadiusSquared]
            .map(|of| contracted.model(task, of));
        let range = |model: &Taylor| {
            let spread = model.spread(&contracted.radii);
            (model.value - spread, model.value + spread)
        };
        let (low, high) = range(&height);
        let tall = (low.max(self.height.0), high.min(self.height.1));
        let wide = range(&squared);
        let wide = (wide.0.max(0.0).sqrt(), wide.1.max(0.0).sqrt());
        let lengths = [tall.1 - tall.0, wide.1 - wide.0];
        if resolution.is_some_and(|to| lengths[0].max(lengths[1]) > to.longest * self.reach) {
            let model = if lengths[0] > lengths[1] { height } else { squared };
            let ContractedBox { part, radii, .. } = contracted;
            let cut = widest(Some(&model), &radii, task.coordinates.count);
            return Examined::Bisected(part, cut);
        }
        let (part, value) = contracted.bounded(task);
        if resolution.is_some_and(|to| value - part.bound > to.looseness * value) {
            let cut = part.cut;
            return Examined::Bisected(part, cut);
        }
        let configurations =
            self.flags.among(|joint| task.coordinates.theta_range(joint, &part.low, &part.high));
        let bound = self.kept * lowered(part.bound);
        Examined::Bounded { height: tall, radius: wide, bound, configurations }
    }
}
