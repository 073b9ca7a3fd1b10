//! Operations of a layout in search results and comparisons.

use super::map::{GuardEntry, MonteCarloEntry, StatusCounts};
use super::misplacement::RobustnessEntry;
use super::numbers::{in_unit, joints, nine_digits, position_mm};
use super::refined::RefinedEntry;
use crate::assess::Assessment;
use crate::cell::{NodeAggregation, Unit};
use crate::reading::Figures;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One operation of a layout: its spot and the errors at the spot. Positions are in the world frame, mm;
/// angles are in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpotEntry {
    pub name: String,
    pub equipment: String,
    pub sense: String,
    /// Description of the nodes at which the operation may happen.
    pub place: String,
    pub over: NodeAggregation,
    /// Value of the operation, in the unit of the objective.
    pub value: Option<f64>,
    /// Upper bound of the value at all misplacements within the placement tolerances. Null if the layout is
    /// not certified, or if no bound is known.
    pub worst: Option<f64>,
    /// Limit and margin; null if the operation has no limit or no spot.
    pub requirement: Option<RequirementEntry>,
    /// Indices of the spot's node along the x and y axes of the surface.
    pub node: Option<[usize; 2]>,
    pub position_mm: Option<[f64; 3]>,
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints_deg: Option<Vec<f64>>,
    /// Best spot between the nodes of the grid; null if the program computed no such spot.
    pub refined: Option<RefinedEntry>,
    /// Effect of misplacement on the operation; null if the effect was not computed.
    pub robustness: Option<RobustnessEntry>,
    pub error_mm: Option<[f64; 3]>,
    pub error_sense_mm: Option<f64>,
    pub error_sense_deg: Option<f64>,
    pub error_by_sense_mm: OptionBySense,
    pub worst_mm: OptionBySense,
    pub rms_mm: OptionBySense,
    pub p95_mm: OptionBySense,
    pub r#yield: Option<f64>,
    pub guard: GuardEntry,
    pub monte_carlo: Option<MonteCarloEntry>,
    pub counts: StatusCounts,
}

/// Error figures by sense; null if the operation has no spot. Worst case and statistics are null in the
/// signed reading if the errors of the sample compensate each other. The program assumes such compensation if
/// the error of a Denavit-Hartenberg length (r or l) exceeds the reach of the arm.
pub type OptionBySense = super::placement::ByName<Option<f64>>;

/// Limit of an operation and the margin to it, in the unit of the objective.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RequirementEntry {
    /// Largest allowed value of the operation. If the objective is a tolerance cost, this limit is the cost
    /// of the tightest tolerances. A value above this cost means that the error exceeds its limit even at the
    /// tightest tolerances.
    pub limit: f64,
    /// Limit minus the value of the operation; negative if the value exceeds the limit. If `worst` of
    /// `SpotEntry` is known, the margin is the limit minus `worst`, unless the objective is a tolerance cost.
    pub margin: f64,
    /// Whether the limit is met. An error limit counts as missed if the layout must withstand misplacements
    /// but `worst` of `SpotEntry` is null.
    pub met: bool,
}

impl SpotEntry {
    pub fn new(a: &Assessment<'_>, k: usize) -> Self {
        let map = &a.maps[k];
        let operation = &a.cell.operations[map.operation];
        let spot = a.spot(k);
        let unit = a.cell.unit();
        let figures = |figure: fn(&Figures) -> f64| {
            let lengths = map.senses.iter().filter(|s| s.unit == Unit::Length);
            let known = |f: &Figures| Some(figure(f)).filter(|si| si.is_finite());
            let value = |name: &str| a.figures(k, name).and_then(known).map(|si| in_unit(Unit::Length, si));
            lengths.map(|s| (s.name.clone(), value(&s.name))).collect::<OptionBySense>()
        };
        let own = a.figures(k, &operation.sense.name).map(|f| operation.sense.unit.from_si(f.error));
        let in_sense = |unit| own.filter(|_| operation.sense.unit == unit).map(nine_digits);
        let requirement = a.requirement(k).map(|r| RequirementEntry {
            limit: in_unit(unit, r.limit),
            margin: in_unit(unit, r.margin),
            met: r.is_met(),
        });
        Self {
            name: operation.name.clone(),
            equipment: a.cell.equipment[operation.equipment].name.clone(),
            sense: operation.sense.name.clone(),
            place: operation.place.in_words(),
            over: operation.over,
            value: map.value.map(|value| in_unit(unit, value)),
            worst: a.worst(k).map(|worst| in_unit(unit, worst)),
            requirement,
            node: spot.map(|(n, _)| [n.i, n.j]),
            position_mm: spot.map(|(n, _)| position_mm(&n.position)),
            joints_deg: spot.map(|(_, p)| joints(a.cell, &p.joints)),
            refined: RefinedEntry::new(a, k),
            robustness: RobustnessEntry::new(a, k),
            error_mm: spot.map(|(_, p)| position_mm(&p.error)),
            error_sense_mm: in_sense(Unit::Length),
            error_sense_deg: in_sense(Unit::Angle),
            error_by_sense_mm: figures(|f| f.error),
            worst_mm: figures(|f| f.worst),
            rms_mm: figures(|f| f.rms),
            p95_mm: figures(|f| f.p95),
            r#yield: spot.and_then(|(_, p)| p.success).map(nine_digits),
            guard: GuardEntry::new(a.cell, map),
            monte_carlo: MonteCarloEntry::new(a, k),
            counts: StatusCounts::new(map),
        }
    }

    /// Returns one entry per operation.
    pub fn all(a: &Assessment<'_>) -> Vec<Self> {
        (0..a.maps.len()).map(|k| Self::new(a, k)).collect()
    }
}
