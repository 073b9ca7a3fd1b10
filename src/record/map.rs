//! The document of `map --json`.

use super::buildability::{AssumedEntry, CertifiedEntry};
use super::cell_yield::CellYieldEntry;
use super::cycle_time::CycleTimeEntry;
use super::estimate::EstimateEntry;
use super::measured::ComparedFile;
use super::node::{MapNode, MapNodes};
use super::numbers::{degrees, in_unit, joints, nine_digits, percent};
use super::placement::{ByName, PlacementEntry, placements};
use super::refined::RefinedEntry;
use super::words::{VALUE_WORDS, caveats, value_word};
use crate::assess::Assessment;
use crate::cell::{Cell, JointKind, Model, NodeAggregation, Reading, Registration, Sense, Unit};
use crate::error_map::{Extrapolation, NodeSign, OperationMap};
use crate::motion::Transfer;
use crate::reading::MonteCarlo;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `map --json`.
pub const MAP_SCHEMA: &str = "sweetspot/map/1";

/// Error map of one layout: every node of every operation. Positions are in the world frame, mm; angles are
/// in degrees.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapDocument<'a> {
    #[schemars(extend("const" = MAP_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Names and units of the joints, in the order of `joints_deg`.
    pub joints: Vec<JointEntry>,
    /// Whether the layout can be used: nothing overlaps, every operation has a spot and no motion is blocked.
    pub feasible: bool,
    /// Objective if it is a length; null otherwise.
    pub objective_mm: Option<f64>,
    /// Objective of the layout, in `unit`; null if the layout is not feasible.
    pub objective: Option<f64>,
    pub unit: Unit,
    /// Caveats on the interpretation of the errors.
    pub notes: Vec<String>,
    /// Pairs of objects whose floor spaces overlap, or are nearer to each other than the clearance that the
    /// cell requires.
    pub overlaps: Vec<String>,
    /// Overall yield: share of sampled arms that stay within the limits of all operations. The entry also
    /// states the yield of each operation alone. Present if the reading is statistical, every operation has a
    /// spot, and at least one operation has a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell_yield: Option<CellYieldEntry>,
    /// Values that the cell file leaves out and that were assumed.
    pub assumed: Vec<AssumedEntry>,
    /// Whether the layout certainly works at every misplacement within its placement tolerances: true, or the
    /// reason why not. Null if no placement has a tolerance, or if `ideal` in the table `[search]` is true.
    pub certified: Option<CertifiedEntry>,
    /// Reasons why the layout is not feasible.
    pub reasons: Vec<String>,
    /// Motions between consecutive operations; empty if an overlap, a missing spot or a blocked motion
    /// prevents these motions. Left out if the cell does not check motions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transfers: Option<Vec<TransferEntry>>,
    /// Cycle time of the layout; left out if the layout is not feasible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time: Option<CycleTimeEntry>,
    /// Placements by the name of the equipment. Obstacles are left out, because a layout does not place them.
    pub layout: ByName<PlacementEntry>,
    pub operations: Vec<OperationMapEntry<'a>>,
    /// Comparison of measured positions with the predicted errors, one entry for each file. Left out
    /// without `--measured`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measured: Vec<ComparedFile>,
}

/// One joint of the robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointEntry {
    pub name: String,
    pub unit: Unit,
}

/// Sense: the error component that matters to an operation, with its unit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SenseEntry {
    pub name: String,
    pub unit: Unit,
}

impl SenseEntry {
    pub fn new(sense: &Sense) -> Self {
        Self { name: sense.name.clone(), unit: sense.unit }
    }
}

/// Error map of one operation.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationMapEntry<'a> {
    pub name: String,
    pub equipment: String,
    /// Name of the sense that the operation states.
    pub sense: String,
    /// Senses in which the errors of every node are reported.
    pub senses: Vec<SenseEntry>,
    pub model: Model,
    /// Name of the error set.
    pub errors: String,
    pub reading: Reading,
    /// Name of the figure that the search minimizes.
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub registration: Registration,
    /// Largest allowed error of the operation, in the unit of its sense.
    pub limit: Option<f64>,
    /// Limit minus the value of the operation; negative if the value exceeds the limit. If `worst` is known,
    /// the margin is the limit minus `worst`, unless the objective is a tolerance cost. Null if the operation
    /// has no limit or no value, or if the quantity is the yield.
    pub margin: Option<f64>,
    pub over: NodeAggregation,
    /// Value of the operation: the values of its nodes, combined by the rule that the field `over` states.
    /// The rule `best` gives the value of the best node.
    pub value: Option<f64>,
    /// Upper bound of the value at all misplacements within the placement tolerances. Null if the layout is
    /// not certified, or if no bound is known.
    pub worst: Option<f64>,
    pub counts: StatusCounts,
    pub guard: GuardEntry,
    /// Usable nodes at which a joint is outside the range of the measured postures; left out if there
    /// are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extrapolated: Option<ExtrapolatedEntry>,
    /// Monte Carlo check of the spot; null unless the reading is statistical.
    pub monte_carlo: Option<MonteCarloEntry>,
    #[schemars(with = "Vec<MapNode>")]
    pub nodes: MapNodes<'a>,
    /// Spot: the usable node with the least value; null if no node is usable. For an operation that happens
    /// at every node, the spot is the node with the greatest value. For such an operation, the spot is null
    /// if any node is unusable.
    pub best: Option<MapNode>,
    /// Best spot between the nodes of the grid; null if the program computed no such spot.
    pub refined: Option<RefinedEntry>,
}

impl<'a> MapDocument<'a> {
    pub fn new(a: &'a Assessment<'_>) -> Self {
        let cell = a.cell;
        let unit = |kind| if kind == JointKind::Revolute { Unit::Angle } else { Unit::Length };
        let joints = cell.robot.joints.iter();
        Self {
            schema: MAP_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            joints: joints.map(|j| JointEntry { name: j.name.clone(), unit: unit(j.kind) }).collect(),
            feasible: a.evaluation.objective.is_some(),
            objective_mm: a.objective_mm().map(nine_digits),
            objective: a.objective().map(nine_digits),
            unit: cell.unit(),
            notes: caveats(cell),
            overlaps: a.evaluation.overlaps.iter().map(|o| o.in_words(cell)).collect(),
            cell_yield: CellYieldEntry::new(a),
            assumed: AssumedEntry::all(cell),
            certified: CertifiedEntry::new(a),
            reasons: a.reasons(),
            transfers: cell.transfer.is_some().then(|| transfers(a)),
            cycle_time: CycleTimeEntry::new(a),
            layout: placements(cell, &a.layout),
            operations: a.maps.iter().map(|m| OperationMapEntry::new(a, m)).collect(),
            measured: Vec::new(),
        }
    }
}

impl<'a> OperationMapEntry<'a> {
    fn new(a: &'a Assessment<'_>, map: &'a OperationMap) -> Self {
        let cell = a.cell;
        let operation = &cell.operations[map.operation];
        Self {
            name: operation.name.clone(),
            equipment: cell.equipment[operation.equipment].name.clone(),
            sense: operation.sense.name.clone(),
            senses: map.senses.iter().map(SenseEntry::new).collect(),
            model: cell.model,
            errors: cell.error_set().name().into(),
            reading: cell.reading,
            quantity: value_word(cell).into(),
            registration: cell.registration,
            limit: operation.limit.map(|l| in_unit(operation.sense.unit, l)),
            margin: a.requirement(map.operation).map(|r| in_unit(cell.unit(), r.margin)),
            over: operation.over,
            value: map.value.map(|v| in_unit(cell.unit(), v)),
            worst: a.worst(map.operation).map(|worst| nine_digits(cell.unit().from_si(worst))),
            counts: StatusCounts::new(map),
            guard: GuardEntry::new(cell, map),
            extrapolated: ExtrapolatedEntry::new(cell, map),
            monte_carlo: MonteCarloEntry::new(a, map.operation),
            nodes: MapNodes::OfMap(cell, map),
            best: map.best_node().map(|n| MapNode::new(cell, map, n)),
            refined: RefinedEntry::new(a, map.operation),
        }
    }
}

/// Numbers of nodes by status. Each of the last three fields is left out if no node has the status that the
/// field counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct StatusCounts {
    pub ok: usize,
    pub out_of_reach: usize,
    pub joint_limit: usize,
    pub collision: usize,
    pub attitude: usize,
    pub not_converged: usize,
    pub unjudged: usize,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub singular: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub retract: Option<usize>,
}

impl StatusCounts {
    pub fn new(map: &OperationMap) -> Self {
        let asked = |sign| Some(map.count(sign)).filter(|count| *count > 0);
        Self {
            ok: map.count(NodeSign::Usable),
            out_of_reach: map.count(NodeSign::OutOfReach),
            joint_limit: map.count(NodeSign::JointLimit),
            collision: map.count(NodeSign::Collision),
            attitude: map.count(NodeSign::Attitude),
            not_converged: map.count(NodeSign::NotConverged),
            unjudged: map.count(NodeSign::Unjudged),
            singular: asked(NodeSign::Singular),
            approach: asked(NodeSign::ApproachBlocked),
            retract: asked(NodeSign::RetractBlocked),
        }
    }
}

/// Check of the approximate error models against the nonlinear model over the usable nodes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GuardEntry {
    pub threshold_percent: f64,
    pub linear: ModelGuardEntry,
    pub second_order: ModelGuardEntry,
    /// Whether the discrepancy of the chosen error model is within the threshold at every usable node.
    pub trusted: bool,
}

/// Usable nodes at which a joint is outside the range that the measurements for the calibration cover.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExtrapolatedEntry {
    /// Number of usable nodes at which a joint is outside its measured range.
    pub nodes: usize,
    /// Names of the joints that are outside their measured range at one or more usable nodes.
    pub joints: Vec<String>,
    /// Whether a joint is outside its measured range at the spot.
    pub spot: bool,
}

impl ExtrapolatedEntry {
    fn new(cell: &Cell, map: &OperationMap) -> Option<Self> {
        let found = Extrapolation::of(cell, map)?;
        let name = |joint: &usize| cell.robot.joints[*joint].name.clone();
        Some(Self {
            nodes: found.nodes,
            joints: found.joints.iter().map(name).collect(),
            spot: found.has_spot,
        })
    }
}

/// Discrepancy between one error model and the nonlinear model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelGuardEntry {
    pub most_percent: f64,
    /// Number of usable nodes at which the discrepancy of the model exceeds the threshold.
    pub nodes_above: usize,
}

impl GuardEntry {
    pub fn new(cell: &Cell, map: &OperationMap) -> Self {
        let guard = |model: Model| {
            let (most, nodes_above, _) = map.off(model, cell.guard);
            ModelGuardEntry { most_percent: percent(most), nodes_above }
        };
        Self {
            threshold_percent: percent(cell.guard),
            linear: guard(Model::Linear),
            second_order: guard(Model::SecondOrder),
            trusted: map.off(cell.model, cell.guard).1 == 0,
        }
    }
}

/// Monte Carlo check of the first-order figures at a spot. The samples use the nonlinear model. RMS, mean and
/// percentiles are in the unit of the sense.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MonteCarloEntry {
    pub samples: usize,
    pub unit: Unit,
    pub rms: EstimateEntry,
    pub mean: EstimateEntry,
    pub p95: EstimateEntry,
    pub p99: EstimateEntry,
    /// Share of samples within the limit; null if the operation has no limit.
    pub r#yield: Option<EstimateEntry>,
    pub share_above_first_order_p95: EstimateEntry,
    /// Whether the samples confirm the first-order figures. If the samples contradict the first-order
    /// figures, the figures of the samples replace them. The value and the margin of the operation then also
    /// come from the samples. However, the value remains a first-order figure if the search is robust, or if
    /// the value combines several nodes.
    pub first_order_holds: Option<bool>,
}

impl MonteCarloEntry {
    /// Makes the entry; None unless the reading is statistical and the operation has a spot.
    pub fn new(a: &Assessment<'_>, operation: usize) -> Option<Self> {
        let unit = a.cell.operations[operation].sense.unit;
        Some(Self::of(a.samples[operation].as_ref()?, unit, a.first_order_holds(operation)))
    }

    /// Makes the entry of an operation whose sense has the unit `unit`.
    pub fn of(samples: &MonteCarlo, unit: Unit, first_order_holds: Option<bool>) -> Self {
        let MonteCarlo { samples, rms, mean, p95, p99, above, success, .. } = samples;
        Self {
            samples: *samples,
            unit,
            rms: EstimateEntry::new(rms, unit),
            mean: EstimateEntry::new(mean, unit),
            p95: EstimateEntry::new(p95, unit),
            p99: EstimateEntry::new(p99, unit),
            r#yield: success.as_ref().map(|s| EstimateEntry::new(s, Unit::Share)),
            share_above_first_order_p95: EstimateEntry::new(above, Unit::Share),
            first_order_holds,
        }
    }
}

/// Collision-free joint motion from one operation to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TransferEntry {
    pub from: String,
    pub to: String,
    pub way: String,
    /// Sum over all straight moves of the motion, degrees. Each move contributes the travel of the joint that
    /// travels farthest in this move. The sum is a measure of the transfer time.
    pub travel_deg: f64,
    /// Joint vectors along the motion, which is a straight line in joint space from each vector to the next.
    pub joints_deg: Vec<Vec<f64>>,
}

/// Returns the motions between consecutive operations; empty if an overlap, a missing spot or a blocked
/// motion prevents these motions.
fn transfers(a: &Assessment<'_>) -> Vec<TransferEntry> {
    let name = |k: usize| a.cell.operations[k].name.clone();
    let entry = |t: &Transfer| TransferEntry {
        from: name(t.from),
        to: name(t.to),
        way: t.way.in_words().to_string(),
        travel_deg: degrees(t.travel),
        joints_deg: t.path.iter().map(|q| joints(a.cell, q)).collect(),
    };
    a.evaluation.transfers.iter().map(entry).collect()
}
