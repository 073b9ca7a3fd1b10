//! One node of a map, and all nodes of an operation.

use super::numbers::{degrees, in_unit, joints, nine_digits, percent, position_mm};
use super::placement::ByName;
use crate::cell::{Cell, Unit};
use crate::error_map::{NodeRecord, NodeSign, OperationMap, PostureRecord};
use crate::kinematic_error::discrepancy;
use crate::reading::Figures;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

/// Error figures for several senses, each under the name of its sense.
pub type BySense = ByName<f64>;

/// One node of a map. Vectors are in the world frame, mm or degrees. A node without a posture has no errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapNode {
    /// Index of the node along x of the surface.
    pub i: usize,
    /// Index of the node along y of the surface.
    pub j: usize,
    /// Target position of the TCP.
    pub position_mm: [f64; 3],
    pub status: NodeSign,
    /// Reason why the node cannot be used; empty if the node is usable.
    pub reason: String,
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints_deg: Option<Vec<f64>>,
    /// Error of the TCP according to the model of the cell.
    pub error_mm: Option<[f64; 3]>,
    /// Error that the operation's sense measures; null if this sense measures an angle.
    pub error_sense_mm: Option<f64>,
    /// Error that the operation's sense measures; null if this sense measures a length.
    pub error_sense_deg: Option<f64>,
    /// Figure that the search minimizes, evaluated at this node, in the `unit` of the document.
    pub value: Option<f64>,
    /// Whether the robot touched the node to teach the surface frame. Such a node cannot be the spot.
    pub touched: Option<bool>,
    /// Rotation error of the TCP as a rotation vector.
    pub rotation_deg: Option<[f64; 3]>,
    pub linear_error_mm: Option<[f64; 3]>,
    pub nonlinear_error_mm: Option<[f64; 3]>,
    pub discrepancy_percent: Option<DiscrepancyEntry>,
    /// Length of the difference between linear and nonlinear error, in percent of the nonlinear error.
    pub linear_off_percent: Option<f64>,
    /// Length of the difference between second-order and nonlinear error, in percent of the nonlinear error.
    pub second_order_off_percent: Option<f64>,
    pub worst_mm: Option<BySense>,
    pub worst_linear_mm: Option<BySense>,
    pub rms_mm: Option<BySense>,
    pub mean_mm: Option<BySense>,
    pub p95_mm: Option<BySense>,
    pub p99_mm: Option<BySense>,
    pub worst_deg: Option<BySense>,
    pub rms_deg: Option<BySense>,
    pub mean_deg: Option<BySense>,
    pub p95_deg: Option<BySense>,
    pub p99_deg: Option<BySense>,
    /// Yield: share of arms whose error does not exceed the limit of the operation. The parameter errors of
    /// these arms are random, with distributions that follow from the error set.
    pub r#yield: Option<f64>,
}

/// Discrepancy between linear and nonlinear error in percent, as defined by eq. (9) of the seed paper. Fields
/// x, y and z compare the components; r compares the lengths of the two vectors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DiscrepancyEntry {
    pub x: Option<f64>,
    pub y: Option<f64>,
    pub z: Option<f64>,
    pub r: Option<f64>,
}

impl DiscrepancyEntry {
    fn new(p: &PostureRecord) -> Self {
        let d = discrepancy(&p.nonlinear, &p.linear);
        let [x, y, z, r] = [d.x, d.y, d.z, d.resultant].map(|v| v.map(nine_digits));
        Self { x, y, z, r }
    }
}

impl MapNode {
    pub fn new(cell: &Cell, map: &OperationMap, n: &NodeRecord) -> Self {
        let p = n.posture.as_ref();
        let own = &cell.operations[map.operation].sense;
        let in_sense = |unit| {
            let p = p.filter(|_| own.unit == unit)?;
            Some(in_unit(unit, p.figures[map.sense(&own.name)?].error))
        };
        let mm = |figure: fn(&Figures) -> f64| p.and_then(|p| by_sense(map, p, Unit::Length, figure));
        let deg = |figure: fn(&Figures) -> f64| p.and_then(|p| by_sense(map, p, Unit::Angle, figure));
        Self {
            i: n.i,
            j: n.j,
            position_mm: position_mm(&n.position),
            status: n.status.sign(),
            reason: n.status.reason(cell),
            joints_deg: p.map(|p| joints(cell, &p.joints)),
            error_mm: p.map(|p| position_mm(&p.error)),
            error_sense_mm: in_sense(Unit::Length),
            error_sense_deg: in_sense(Unit::Angle),
            value: p.map(|p| in_unit(cell.unit(), p.value)),
            touched: p.map(|p| p.touched),
            rotation_deg: p.map(|p| p.rotation.map(degrees).into()),
            linear_error_mm: p.map(|p| position_mm(&p.linear)),
            nonlinear_error_mm: p.map(|p| position_mm(&p.nonlinear)),
            discrepancy_percent: p.map(DiscrepancyEntry::new),
            linear_off_percent: p.map(|p| percent(p.linear_off)),
            second_order_off_percent: p.map(|p| percent(p.second_order_off)),
            worst_mm: mm(|f| f.worst),
            worst_linear_mm: mm(|f| f.worst_linear),
            rms_mm: mm(|f| f.rms),
            mean_mm: mm(|f| f.mean),
            p95_mm: mm(|f| f.p95),
            p99_mm: mm(|f| f.p99),
            worst_deg: deg(|f| f.worst),
            rms_deg: deg(|f| f.rms),
            mean_deg: deg(|f| f.mean),
            p95_deg: deg(|f| f.p95),
            p99_deg: deg(|f| f.p99),
            r#yield: p.and_then(|p| p.success).map(nine_digits),
        }
    }
}

/// Returns a figure of a posture for every reported sense whose unit is `unit`. Returns None if no sense has
/// this unit, or if the figure needs tolerances and the errors are not tolerances.
fn by_sense(
    map: &OperationMap,
    p: &PostureRecord,
    unit: Unit,
    figure: fn(&Figures) -> f64,
) -> Option<BySense> {
    let pairs = map.senses.iter().zip(&p.figures).filter(|(s, _)| s.unit == unit);
    let known = pairs.map(|(s, f)| (s, figure(f))).filter(|(_, si)| si.is_finite());
    let values: BySense = known.map(|(s, si)| (s.name.clone(), in_unit(unit, si))).collect();
    (!values.is_empty()).then_some(values)
}

/// Nodes of an operation. A map can have a million nodes, so each node is converted only when it is written.
#[derive(Debug, Clone)]
pub enum MapNodes<'a> {
    /// Nodes of a document that was read.
    Read(Vec<MapNode>),
    /// Nodes of a map in memory.
    OfMap(&'a Cell, &'a OperationMap),
}

impl MapNodes<'_> {
    /// Iterates over the nodes; the index along x of the surface runs fastest.
    pub fn iter(&self) -> Box<dyn Iterator<Item = Cow<'_, MapNode>> + '_> {
        match self {
            Self::Read(nodes) => Box::new(nodes.iter().map(Cow::Borrowed)),
            Self::OfMap(cell, map) => {
                Box::new(map.nodes.iter().map(|n| Cow::Owned(MapNode::new(cell, map, n))))
            }
        }
    }
}

impl Serialize for MapNodes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl<'de> Deserialize<'de> for MapNodes<'_> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(Self::Read)
    }
}
