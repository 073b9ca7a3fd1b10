//! The document of `robust --json`, and the effect of misplacement on each operation in other documents.

use super::numbers::{degrees, in_unit, millimetres, nine_digits};
use super::placement::{ByName, PlacementEntry, placements};
use super::refined::RefinedEntry;
use super::words::{VALUE_WORDS, value_word};
use crate::assess::Assessment;
use crate::cell::{Cell, Slot, Unit};
use crate::error_map::NodeSign;
use crate::layout::{Corner, Largest, Lost, MisplacementEnd, Robustness};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `robust --json`.
pub const ROBUST_SCHEMA: &str = "sweetspot/robust/1";

/// Effect of misplaced equipment on the layout of the cell file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobustDocument {
    #[schemars(extend("const" = ROBUST_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    /// Name of the figure that the search minimizes.
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub unit: Unit,
    pub feasible: bool,
    /// Whether every operation stays feasible and within its limit over the placement tolerances.
    pub holds: bool,
    pub reasons: Vec<String>,
    pub layout: ByName<PlacementEntry>,
    pub base: PlacementEntry,
    pub operations: Vec<MisplacedOperation>,
}

/// One operation of a layout whose equipment may be misplaced.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MisplacedOperation {
    pub name: String,
    pub equipment: String,
    pub sense: String,
    /// Largest allowed error of the operation, in the unit of its sense.
    pub limit: Option<f64>,
    pub refined: Option<RefinedEntry>,
    pub robustness: Option<RobustnessEntry>,
}

/// Effect of misplacement on one operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RobustnessEntry {
    /// Value of the operation without misplacement, in the unit of the objective.
    pub value: f64,
    /// Placement tolerances (half widths) of the robot base and of the equipment on which the operation
    /// depends. Empty if none of these placements has a tolerance.
    pub tolerance: MovesByName,
    /// Number of evaluated corners of the tolerance boxes. These boxes span the placement tolerances of the
    /// robot base and of all equipment, also of equipment that `tolerance` does not list.
    pub corners: usize,
    /// Evaluated corner of the tolerance boxes at which the operation has its greatest value. Null if
    /// `tolerance` is empty, or if the operation cannot be done at any corner.
    pub worst: Option<CornerEntry>,
    /// Evaluated corners of the tolerance boxes at which the operation cannot be done.
    pub lost: Vec<LostEntry>,
    /// Change of the value of the operation per mm or degree of each coordinate. The four coordinates of the
    /// equipment under the operation come first. The other coordinates with a placement tolerance (see
    /// `tolerance`) follow.
    pub gradient: Vec<SlopeEntry>,
    /// Largest multiple of the tolerances at which the operation stays feasible and within its limit. Null if
    /// no placement has a tolerance.
    pub largest_times_tolerance: Option<LargestEntry>,
    /// Largest distance by which the equipment under the operation may be displaced in every horizontal
    /// direction. A displacement is allowed if the operation stays feasible and within its limit.
    pub largest_in_plan_mm: LargestEntry,
    /// Largest angle by which the equipment under the operation may be rotated about the vertical in both
    /// directions. A rotation is allowed if the operation stays feasible and within its limit.
    pub largest_yaw_deg: LargestEntry,
    /// Whether the operation stays feasible and within its limit over the tolerances.
    pub holds: bool,
}

/// Misplacements by the name of the equipment, or of the robot base.
pub type MovesByName = ByName<MoveEntry>;

/// Misplacement of one piece of equipment or of the robot base, mm and degrees.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MoveEntry {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub x_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub y_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw_deg: Option<f64>,
}

/// Misplacement, and the value of the operation at this misplacement in the unit of the objective.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CornerEntry {
    pub moves: MovesByName,
    pub value: f64,
}

/// Misplacement at which the operation cannot be done, with the reason.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LostEntry {
    pub moves: MovesByName,
    pub status: NodeSign,
    pub reason: String,
}

/// Change of the value of an operation per mm or degree of one coordinate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SlopeEntry {
    /// Name of the equipment, or "robot base".
    pub of: String,
    /// Text that names the coordinate: `x_mm`, `y_mm`, `z_mm` or `yaw_deg`.
    pub number: String,
    /// Change of the value of the operation, in the unit of the objective, per mm or degree of the
    /// coordinate. Null if a small change of the coordinate puts the operation out of reach.
    pub value: Option<f64>,
    /// Unit of the coordinate.
    pub per: Unit,
}

/// Largest misplacement at which the operation stays feasible and within its limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LargestEntry {
    pub most: f64,
    /// Reason why a misplacement larger than `most` is not allowed; null if every checked misplacement is
    /// allowed.
    pub ended: Option<EndedEntry>,
}

/// Reason why no misplacement larger than `LargestEntry.most` is allowed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum EndedEntry {
    /// Misplacement at which the operation cannot be done. This misplacement is 0 if the operation cannot be
    /// done even without misplacement. Otherwise, this misplacement is larger than `LargestEntry.most`.
    Lost(LostEntry),
    /// Misplacement at which the value of the operation exceeds the limit. This misplacement is 0 if the
    /// value exceeds the limit even without misplacement. Otherwise, this misplacement is larger than
    /// `LargestEntry.most`.
    Limit(CornerEntry),
}

impl RobustDocument {
    pub fn new(a: &Assessment<'_>) -> Self {
        let operations = a.cell.operations.iter().enumerate().map(|(k, operation)| MisplacedOperation {
            name: operation.name.clone(),
            equipment: a.cell.equipment[operation.equipment].name.clone(),
            sense: operation.sense.name.clone(),
            limit: operation.limit.map(|limit| in_unit(operation.sense.unit, limit)),
            refined: RefinedEntry::new(a, k),
            robustness: RobustnessEntry::new(a, k),
        });
        Self {
            schema: ROBUST_SCHEMA.into(),
            cell: a.cell.name.clone(),
            robot: a.cell.robot.name.clone(),
            errors: a.cell.error_set().name().into(),
            quantity: value_word(a.cell).into(),
            unit: a.cell.unit(),
            feasible: a.evaluation.objective.is_some(),
            holds: a.is_robust(),
            reasons: a.reasons(),
            layout: placements(a.cell, &a.layout),
            base: PlacementEntry::new(&a.layout.base),
            operations: operations.collect(),
        }
    }
}

impl RobustnessEntry {
    /// Makes the entry; None for an operation without a spot, or if misplacement was not computed.
    pub fn new(a: &Assessment<'_>, k: usize) -> Option<Self> {
        let (cell, unit) = (a.cell, a.cell.unit());
        let r = a.robustness.get(k)?.as_ref()?;
        let Robustness { value, tolerance, corners, worst, lost, gradient, scale, shift, turn } = r;
        let slopes = gradient.iter().map(|(slot, slope)| {
            let (step, per) = match slot.is_angle() {
                true => (rad_from_deg(1.0), Unit::Angle),
                false => (m_from_mm(1.0), Unit::Length),
            };
            let value = slope.map(|slope| in_unit(unit, slope * step));
            SlopeEntry { of: body(cell, *slot), number: coordinate_name(*slot).into(), value, per }
        });
        Some(Self {
            value: in_unit(unit, *value),
            tolerance: moves(cell, tolerance),
            corners: *corners,
            worst: worst.as_ref().map(|worst| corner(cell, worst)),
            lost: lost.iter().map(|at| self::lost(cell, at)).collect(),
            gradient: slopes.collect(),
            largest_times_tolerance: scale.as_ref().map(|scale| largest(cell, scale, |s| s)),
            largest_in_plan_mm: largest(cell, shift, mm_from_m),
            largest_yaw_deg: largest(cell, turn, deg_from_rad),
            holds: r.holds(),
        })
    }
}

fn corner(cell: &Cell, corner: &Corner) -> CornerEntry {
    CornerEntry { moves: moves(cell, &corner.moves), value: in_unit(cell.unit(), corner.value) }
}

fn lost(cell: &Cell, lost: &Lost) -> LostEntry {
    let (status, reason) = (lost.status.sign(), lost.status.reason(cell));
    LostEntry { moves: moves(cell, &lost.moves), status, reason }
}

fn largest(cell: &Cell, largest: &Largest, shown: impl Fn(f64) -> f64) -> LargestEntry {
    let ended = largest.ended.as_ref().map(|ended| match ended {
        MisplacementEnd::Lost(at) => EndedEntry::Lost(lost(cell, at)),
        MisplacementEnd::Limit(at) => EndedEntry::Limit(corner(cell, at)),
    });
    LargestEntry { most: nine_digits(shown(largest.most)), ended }
}

fn moves(cell: &Cell, moves: &[(Slot, f64)]) -> MovesByName {
    let mut all = MovesByName::new();
    for (slot, by) in moves {
        let entry = all.entry(body(cell, *slot)).or_default();
        match slot {
            Slot::Base(axis) | Slot::Equipment(_, axis) => match axis {
                0 => entry.x_mm = Some(millimetres(*by)),
                1 => entry.y_mm = Some(millimetres(*by)),
                2 => entry.z_mm = Some(millimetres(*by)),
                _ => entry.yaw_deg = Some(degrees(*by)),
            },
            // A tool attitude is not part of a placement.
            Slot::Attitude(..) => {}
        }
    }
    all
}

/// Returns the name of the equipment to which a coordinate belongs, or "robot base".
fn body(cell: &Cell, slot: Slot) -> String {
    match slot {
        Slot::Equipment(k, _) => cell.equipment[k].name.clone(),
        _ => "robot base".into(),
    }
}

/// Returns the key of a coordinate in a cell file.
pub fn coordinate_name(slot: Slot) -> &'static str {
    match slot {
        Slot::Base(axis) | Slot::Equipment(_, axis) => ["x_mm", "y_mm", "z_mm", "yaw_deg"][axis],
        Slot::Attitude(_, angle) => ["bend_deg", "azimuth_deg", "spin_deg"][angle],
    }
}
