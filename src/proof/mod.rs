//! The proof: what no layout of the search space can beat.
//!
//! Relaxed are collisions and overlaps, and that operations share one layout: each chooses its spot
//! alone, anywhere its height, its elevation and its distance from the base allow ([`Region`]). All that
//! is left is a posture, so that the least error is a minimum over joint coordinates inside their limits.
//! Errors behind a vertical first axis turn with it: it drops out unless the sense or an error before it
//! knows directions. Branch and bound over the other joints closes the rest:
//!
//! | file | what |
//! |---|---|
//! | `region` | what an operation must keep in any layout |
//! | `screws` | the chain, nominal and with errors, as axes about a reference posture |
//! | `coordinates` | what is cut into boxes, and the joint limits in it |
//! | `taylor` | expansions with a bound of the rest |
//! | `difference`, `columns` | the error of a sample; the sum of linear effects |
//! | `worth` | a reading, from below |
//! | `task` | one operation, put together |
//! | `branch`, `witness` | boxes, and postures in them |
//!
//! The bound holds of [`crate::layout::evaluate`]: a weighted sum has at least the sum of the bounds, a
//! weighted maximum the largest of them. An operation that has no bound counts as 0, which none is below.

mod branch;
mod columns;
mod coordinates;
mod difference;
mod region;
mod screws;
mod task;
mod taylor;
mod witness;
mod worth;

pub use region::Region;
pub use worth::tangent;

use crate::cell::{JointVector, Quantity, Reading};

use crate::files::shown;
use crate::layout::{Workcell, combined};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;
use task::Task;

/// How hard to try.
#[derive(Debug, Clone, PartialEq)]
pub struct ProofOptions {
    /// The bound may be below the least value by this share.
    pub gap: f64,
    /// Boxes for every operation.
    pub boxes: u64,
    /// Values that the operations have in some layout, best first known: boxes above need not be looked
    /// at. None if nothing is known.
    pub known: Option<Vec<f64>>,
}

impl Default for ProofOptions {
    fn default() -> Self {
        Self { gap: 2e-4, boxes: 100_000, known: None }
    }
}

/// Why an operation has no bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WhyNot {
    /// No posture inside the joint limits has the height and the attitude: no layout is feasible.
    Infeasible,
    Relative,
    Registered,
    EquipmentErrors,
    ToolAxes,
    SurfaceAxes,
    WorldAxes,
    Rotation,
    NotNormal,
    ManyRows,
    Share,
    /// Nothing above zero within the boxes allowed.
    Boxes,
}

impl WhyNot {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Infeasible => "no posture within the joint limits has its height and attitude",
            Self::Relative => "it depends on where the part was picked",
            Self::Registered => "what the cell has measured itself is taken off its error",
            Self::EquipmentErrors => "the signed errors of the equipment may cancel those of the robot",
            Self::ToolAxes => "its sense is in axes of the tool",
            Self::SurfaceAxes => "its sense is in axes of a surface that can be turned",
            Self::WorldAxes => "its sense is in axes of the world and the robot base can be turned",
            Self::Rotation => "its sense has rotations, which are bounded in the linear model alone",
            Self::NotNormal => "its parameters are not normal",
            Self::ManyRows => "its sense has more than three rows",
            Self::Share => "a share of failures has no bound but 0",
            Self::Boxes => "no bound above 0 was found within the boxes allowed",
        }
    }
}

/// What is proven of one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationBound {
    /// No spot in any layout has less (m or rad).
    pub value: Result<f64, WhyNot>,
    /// Boxes looked at.
    pub boxes: u64,
    /// The least value found of a posture of the relaxed problem, and its joint coordinates.
    pub witness: Option<(f64, JointVector)>,
}

/// What of the objective a bound covers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Covers {
    Everything,
    /// Some operations count as 0.
    Part,
    Nothing,
    /// An operation has no spot in any layout.
    Infeasible,
}

impl Covers {
    /// The word in documents.
    pub fn name(self) -> &'static str {
        match self {
            Covers::Everything => "everything",
            Covers::Part => "part",
            Covers::Nothing => "nothing",
            Covers::Infeasible => "infeasible",
        }
    }
}

/// What is proven of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// No layout has a smaller objective; None if nothing is known, or if no layout is feasible.
    pub bound: Option<f64>,
    pub operations: Vec<OperationBound>,
    pub covers: Covers,
    /// Somebody asked to stop: the bound holds, but more work could raise it.
    pub interrupted: bool,
}

impl Proof {
    /// How much better a layout could be than one of this objective, as a share of it.
    pub fn gap(&self, objective: f64) -> Option<f64> {
        self.bound.filter(|_| objective > 0.0).map(|bound| (1.0 - bound / objective).max(0.0))
    }

    /// What the bound covers, for people.
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
        let mut relaxed =
            "each operation alone at the best spot of any layout, collisions and overlaps left out"
                .to_string();
        let percentiles = [Quantity::P95, Quantity::P99].contains(&workcell.cell.quantity);
        if workcell.cell.reading == Reading::Statistical && percentiles {
            relaxed +=
                "; that squares of percentiles are convex in the covariance is assumed: tried, not proven";
        }
        match self.covers {
            Covers::Everything => relaxed,
            Covers::Part => format!("{relaxed}; counted as 0: {}", missing.join("; ")),
            Covers::Nothing => format!("no bound: {}", missing.join("; ")),
            Covers::Infeasible => format!("no layout is feasible: {}", missing.join("; ")),
        }
    }
}

/// A lower bound of the objective of every layout of a cell. Deterministic; stops between rounds of
/// boxes once `stop` is set, with what is proven by then.
pub fn prove(workcell: &Workcell, options: &ProofOptions, stop: &AtomicBool) -> Proof {
    let mut interrupted = false;
    let operations: Vec<OperationBound> = (0..workcell.cell.operations.len())
        .map(|k| {
            let known = options.known.as_ref().and_then(|values| values.get(k).copied());
            let regions = Region::all(&workcell.cell, k, workcell.inverse().fixed_elevation());
            let (bound, stopped) = of_regions(workcell, &regions, known, options, stop);
            interrupted |= stopped;
            bound
        })
        .collect();
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
    Proof { bound, operations, covers, interrupted }
}

/// One operation over several regions: the least of them.
fn of_regions(
    workcell: &Workcell,
    regions: &[Region],
    known: Option<f64>,
    options: &ProofOptions,
    stop: &AtomicBool,
) -> (OperationBound, bool) {
    let (mut all, mut interrupted) =
        (OperationBound { value: Err(WhyNot::Infeasible), boxes: 0, witness: None }, false);
    for region in regions {
        let best = all.witness.map(|w| w.0).into_iter().chain(known).reduce(f64::min);
        let (one, stopped) = of_operation(workcell, region, best, options, stop);
        interrupted |= stopped;
        all.boxes += one.boxes;
        let by_value = |a: &(f64, JointVector), b: &(f64, JointVector)| a.0.total_cmp(&b.0);
        all.witness = all.witness.into_iter().chain(one.witness).min_by(by_value);
        all.value = match (all.value, one.value) {
            (Ok(a), Ok(b)) => Ok(a.min(b)),
            // A region without a posture takes nothing from the others; one without a bound takes all.
            (a, Err(WhyNot::Infeasible)) => a,
            (Err(WhyNot::Infeasible), b) => b,
            (Err(why), _) | (_, Err(why)) => Err(why),
        };
    }
    (all, interrupted)
}

/// One operation over a region; `known`: a value that it has in some layout.
fn of_operation(
    workcell: &Workcell,
    region: &Region,
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
    let Some(found) = branch::least(&task, known, options.gap, options.boxes, stop) else {
        return (none(WhyNot::Infeasible), false);
    };
    // An error that can be nothing has the bound 0, and that is all there is to know.
    let closed = found.best.is_some_and(|(value, _)| value < branch::VANISHES);
    let value = if found.bound > 0.0 || closed { Ok(found.bound) } else { Err(WhyNot::Boxes) };
    (OperationBound { value, boxes: found.boxes, witness: found.best }, found.interrupted)
}
