//! Proof: a lower bound of the objective of every layout, by branch and bound with Taylor models.
//!
//! The problem is relaxed. Each operation chooses its spot independently, anywhere within the operation's
//! ranges of height, tool elevation and distance from the robot base ([`OperationRegion`]). Only the posture
//! remains unknown, so the least error is a minimum over joint coordinates within their limits. Collisions
//! with the surroundings and overlaps between pieces of equipment are ignored. The following conditions of a
//! feasible layout are kept:
//!
//! - The robot does not collide with itself (`self_collision`).
//! - The equipment of the operation does not overlap the robot base in plan, which limits the distance of a
//!   node from the base axis (`region`).
//! - The arm reaches the ends of approach and retract lines. For layouts that must withstand misplacements,
//!   it also reaches the misplaced spots (`surroundings`).
//! - All operations share one height of the robot base (`base_height`).
//!
//! The search divides the ranges of the joint coordinates into boxes. In many cases, these boxes need no
//! coordinate of the first or the last joint. The errors after the first joint act in directions that rotate
//! with this joint. If the axis of the first joint is vertical, the angle of this joint matters only for
//! senses that distinguish horizontal directions. Errors before the first joint may act in horizontal
//! directions. The bound replaces such errors by isotropic errors, or omits them. The last joint also needs
//! no coordinate if its axis is the tool axis and passes through the measured point. The bound then uses the
//! least contribution of the errors after this joint, over all rotations of the tool.
//!
//! In the following cases, among others, the first or the last joint needs a coordinate:
//!
//! - signed reading: an error moves the axis of the first joint, or acts after the last joint
//! - worst-case reading of an arm with at most six joints: an error moves the axis of the first joint
//! - statistical reading: an error that moves the axis of the first joint, or acts after the last joint, is
//!   correlated with other errors
//! - statistical reading with the mean as quantity: an error moves the axis of the first joint, or acts after
//!   the last joint
//!
//! Branch and bound over the remaining coordinates reduces the gap between the lower bound and the least
//! value found. The module has the following files:
//!
//! | file | content |
//! |---|---|
//! | `region` | the constraints of an operation in any layout |
//! | `coordinates` | the coordinates of the boxes, and the joint limits in these coordinates |
//! | `taylor_model` | second-order expansions with a bound of the remainder |
//! | `constrained_quantity` | value and derivatives of a constrained quantity |
//! | `nonlinear_error`, `linear_effects` | the error of a signed sample; weighted sums of linear effects |
//! | `value_bound`, `rigid_factors` | the lower bound of a value in any reading |
//! | `first_joint`, `last_joint` | joints without a coordinate, and errors whose directions they rotate |
//! | `base_rows` | the sense in the base frame |
//! | `task` | one operation, prepared for bounding |
//! | `planar_arm` | the plane in which a planar arm moves |
//! | `self_collision`, `surroundings` | boxes and spots that no feasible layout can use |
//! | `node_radii` | bounds over height, elevation and radius, for one node or every node |
//! | `base_height` | the height of the base that all operations share |
//! | `operation_bound`, `refusal` | the bound of one operation, and operations without a bound |
//! | `joint_box` | a box of joint coordinates, its contraction by the constraints, and the bound in the box |
//! | `value_field` | lower bounds over the height of a node and its distance from the base axis |
//! | `branch_and_bound`, `witness` | the search over boxes, and the search for postures in a box |
//!
//! The bound holds for the objective of [`crate::layout::evaluate`], which combines the values of the
//! operations. A weighted sum of values is at least the weighted sum of their bounds. A weighted maximum of
//! values is at least the largest weighted bound. If no bound is known for the value of an operation, 0 is
//! used as the bound of this value.

mod base_height;
mod base_rows;
mod branch_and_bound;
mod configuration_choice;
mod constrained_quantity;
mod coordinates;
mod first_joint;
mod joint_box;
mod last_joint;
mod linear_effects;
mod node_radii;
mod nonlinear_error;
mod operation_bound;
mod planar_arm;
mod refusal;
mod region;
mod rigid_factors;
mod self_collision;
mod surroundings;
mod task;
mod taylor_model;
mod value_bound;
mod value_field;
mod witness;

pub use planar_arm::Lean;
pub use region::OperationRegion;
pub use value_bound::tangent;
pub use value_field::{LAYOUTS_WORTH_A_FIELD, rank_nodes, value_fields, why_no_field};

use crate::cell::{JointVector, Quantity, Reading};
use crate::layout::{Workcell, combined};
use crate::safe_text::shown;
use base_height::least_of_shared_height;
use operation_bound::{NodesBounded, of_regions};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};

/// Limits on the effort of a proof.
#[derive(Debug, Clone, PartialEq)]
pub struct ProofOptions {
    /// Relative gap between the lower bound and the least value found. The proof of an operation ends when
    /// the gap is at most this number.
    pub gap: f64,
    /// Largest number of boxes of joint coordinates that are examined per operation.
    pub boxes: u64,
    /// Values of the operations in a known layout, if any. A box of joint coordinates is not bisected further
    /// once its lower bound is at least the known value times `1 - gap`.
    pub known: Option<Vec<f64>>,
}

impl Default for ProofOptions {
    fn default() -> Self {
        Self { gap: 2e-4, boxes: 100_000, known: None }
    }
}

/// Reason why an operation has no bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhyNot {
    /// No posture within the joint limits and without self-collision has the height and attitude of the
    /// operation beside the robot base. Therefore no layout is feasible.
    Infeasible,
    /// The operation places a part, and its error is relative to the error of the operation that picks the
    /// part.
    Relative,
    /// A [registration](crate::cell::Registration) removes part of the error.
    Registered,
    /// Signed errors of the equipment may cancel the errors of the robot.
    EquipmentErrors,
    /// The [sense](crate::cell::Sense) is stated in the axes of the tool.
    ToolAxes,
    /// The [sense](crate::cell::Sense) is stated in the axes of a surface that can rotate.
    SurfaceAxes,
    /// The [sense](crate::cell::Sense) is stated in the axes of the world, and the robot base can rotate.
    WorldAxes,
    /// The [sense](crate::cell::Sense) includes rotations. Rotations have a bound only with the linear model
    /// or in the statistical reading.
    Rotation,
    /// A parameter is not normally distributed, and the quantity is not the RMS.
    NotNormal,
    /// The sense has more than three rows (weighted components of the error).
    ManyRows,
    /// The value is a share of failures, which has no lower bound above 0.
    Share,
    /// The value is a cost of tolerances.
    Cost,
    /// The lower bound did not rise above 0 within the allowed number of boxes of joint coordinates.
    Boxes,
    /// The reading is worst-case, the model is not linear, and the errors have means other than 0.
    Mean,
    /// Monte Carlo samples show that the first-order value of the operation is wrong. The bound applies only
    /// to this first-order value.
    Refuted,
}

impl WhyNot {
    /// Returns the reason in words, as a clause about the operation.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Infeasible => {
                "no posture within the joint limits and without self-collision has the height and attitude of the operation beside the robot base"
            }
            Self::Relative => "its error is relative to the operation that picks the part",
            Self::Registered => "a registration removes part of its error",
            Self::EquipmentErrors => "the signed errors of the equipment may cancel the errors of the robot",
            Self::ToolAxes => "its sense is given in the axes of the tool",
            Self::SurfaceAxes => "its sense is given in the axes of a surface that can rotate",
            Self::WorldAxes => "its sense is given in the axes of the world, and the robot base can rotate",
            Self::Rotation => "its sense includes rotations, which have no bound in this model and reading",
            Self::NotNormal => "its parameters are not normally distributed",
            Self::ManyRows => "its sense has more than three components",
            Self::Share => "its value is a share of failures, which has no lower bound above 0",
            Self::Cost => "the cost of its tolerances has no known bound",
            Self::Boxes => {
                "branch and bound found no bound above 0 within the allowed number of boxes (ranges of the joints)"
            }
            Self::Mean => {
                "no bound is known for its nonlinear worst case, because its errors vary about measured means"
            }
            Self::Refuted => {
                "Monte Carlo samples show that its first-order value is wrong, and the bound applies only to that value"
            }
        }
    }
}

/// Proven lower bound of the value of one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationBound {
    /// Lower bound of the value at any spot in any layout, m or rad, or the reason why there is no bound.
    ///
    /// If the operations share a variable height of the base, the bound of an operation at every node is that
    /// of its best node alone. [`Proof::bound`] takes every node into account.
    pub value: Result<f64, WhyNot>,
    /// Number of boxes of joint coordinates that were examined.
    pub boxes: u64,
    /// Least value found, with the joint coordinates of the posture that gives this value.
    ///
    /// The posture stays within the joint limits. It also stays within the ranges that height, tool
    /// elevation and distance from the robot base cover over all layouts. Collisions with the surroundings
    /// are ignored.
    pub witness: Option<(f64, JointVector)>,
}

/// Part of the objective that a bound covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Covers {
    /// Every operation has a bound.
    Everything,
    /// Some operations have no bound and count as 0.
    Part,
    /// No operation has a bound.
    Nothing,
    /// An operation has no spot in any layout.
    Infeasible,
}

impl Covers {
    /// Returns the word for this variant as it appears in documents, for example `everything`.
    pub fn name(self) -> &'static str {
        match self {
            Covers::Everything => "everything",
            Covers::Part => "part",
            Covers::Nothing => "nothing",
            Covers::Infeasible => "infeasible",
        }
    }
}

/// Proven lower bound of the objective of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// Lower bound of the objective of every layout; None if no operation has a bound or no layout is
    /// feasible.
    pub bound: Option<f64>,
    pub operations: Vec<OperationBound>,
    pub covers: Covers,
    /// Whether the proof was stopped early. The bound then holds, but more work could raise it.
    pub interrupted: bool,
}

impl Proof {
    fn new(workcell: &Workcell, operations: Vec<OperationBound>, interrupted: bool) -> Self {
        let values: Vec<f64> = operations.iter().map(|bound| bound.value.unwrap_or(0.0)).collect();
        let sum = combined(&workcell.cell, &values);
        let proven = operations.iter().filter(|o| o.value.is_ok()).count();
        let covers = match proven {
            _ if operations.iter().any(|o| o.value == Err(WhyNot::Infeasible)) => Covers::Infeasible,
            0 => Covers::Nothing,
            all if all == operations.len() => Covers::Everything,
            _ => Covers::Part,
        };
        let bound = matches!(covers, Covers::Everything | Covers::Part).then_some(sum);
        Self { bound, operations, covers, interrupted }
    }

    /// Returns this proof without the bounds of the operations for which `is_refuted` returns true. The
    /// closure `is_refuted` receives the index of an operation. It returns true if Monte Carlo samples show
    /// that the first-order value of this operation is wrong.
    ///
    /// The bounds apply to first-order values, and say nothing about values computed from samples.
    pub fn without(&self, workcell: &Workcell, is_refuted: impl Fn(usize) -> bool) -> Self {
        let mut operations = self.operations.clone();
        let refuted = operations.iter_mut().enumerate().filter(|(k, o)| o.value.is_ok() && is_refuted(*k));
        let count = refuted.map(|(_, o)| o.value = Err(WhyNot::Refuted)).count();
        if count == 0 { self.clone() } else { Self::new(workcell, operations, self.interrupted) }
    }

    /// Returns the largest share by which another layout could still reduce `objective` (m or rad). Returns
    /// None if there is no bound, or if `objective` is 0.
    pub fn gap(&self, objective: f64) -> Option<f64> {
        self.bound.filter(|_| objective > 0.0).map(|bound| (1.0 - bound / objective).max(0.0))
    }

    /// Describes in words what the bound covers and what it assumes.
    pub fn in_words(&self, workcell: &Workcell) -> String {
        let missing: Vec<String> = self
            .operations
            .iter()
            .zip(&workcell.cell.operations)
            .filter_map(|(bound, operation)| {
                let why = bound.value.err()?.in_words();
                Some(format!("{}: {why}", shown(&operation.name)))
            })
            .collect();
        let spots = match base_height::is_shared(&workcell.cell) {
            true => "each operation at its best spot in any layout, all with one height of the robot base",
            false => "each operation alone at its best spot in any layout",
        };
        let mut relaxed = format!(
            "{spots}; it ignores collisions with the surroundings and overlaps between pieces of equipment"
        );
        let percentiles = [Quantity::P95, Quantity::P99].contains(&workcell.cell.quantity);
        if workcell.cell.reading == Reading::Statistical && percentiles {
            relaxed += "; it assumes that squares of percentiles are convex in the covariance, which is tested but not proven";
        }
        match self.covers {
            Covers::Everything => relaxed,
            Covers::Part => format!(
                "{relaxed}; the bound counts the values of these operations as 0: {}",
                missing.join("; ")
            ),
            Covers::Nothing => format!("no bound: {}", missing.join("; ")),
            Covers::Infeasible => format!("no layout is feasible: {}", missing.join("; ")),
        }
    }
}

/// Proves a lower bound of the objective of every layout of a cell.
///
/// The result is deterministic. Once `stop` is set, the proof ends after the current round of boxes. The
/// result then has the bound proven so far.
pub fn prove(workcell: &Workcell, options: &ProofOptions, stop: &AtomicBool) -> Proof {
    let shares_height = base_height::is_shared(&workcell.cell);
    let nodes = if shares_height { NodesBounded::One } else { NodesBounded::Every };
    let mut interrupted = false;
    let operations: Vec<OperationBound> = (0..workcell.cell.operations.len())
        .map(|k| {
            let known = options.known.as_ref().and_then(|values| values.get(k).copied());
            let regions = OperationRegion::beside_base(&workcell.cell, k, workcell);
            let (bound, stopped) = of_regions(workcell, &regions, nodes, known, options, stop);
            interrupted |= stopped;
            bound
        })
        .collect();
    let shared =
        shares_height.then(|| least_of_shared_height(workcell, &operations, options, stop)).flatten();
    interrupted |= shares_height && stop.load(Ordering::Relaxed);
    let alone = Proof::new(workcell, operations, interrupted);
    let bound = alone.bound.map(|bound| shared.map_or(bound, |shared| bound.max(shared)));
    Proof { bound, ..alone }
}
