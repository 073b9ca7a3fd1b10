//! The document of `compare --calibrated --json`.

use super::numbers::{nine_digits, percent};
use super::placement::{AttitudeEntry, ByName, PlacementEntry, attitudes, placements};
use super::spot::SpotEntry;
use super::words::{VALUE_WORDS, value_word};
use crate::assess::{Assessment, Remedies, Remedy};
use crate::cell::Unit;
use crate::units::rounded;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `compare --calibrated --json`.
pub const REMEDIES_SCHEMA: &str = "sweetspot/remedies/1";

/// Answer to the question whether to calibrate a measured robot, to move the equipment, or to do both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RemediesDocument {
    #[schemars(extend("const" = REMEDIES_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    /// Name of the figure by which the remedies are compared.
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    /// Unit of the values.
    pub unit: Unit,
    /// Seed of the two searches, one without calibration and one after calibration.
    pub seed: u64,
    /// Total number of layouts that the two searches evaluated.
    pub evaluations: u64,
    /// One entry for each remedy: as-drawn, calibrated, moved, both.
    pub remedies: Vec<RemedyEntry>,
    /// Advised remedies, each of which is sufficient without the others. Empty if no remedy gives a feasible
    /// layout within every limit.
    pub advised: Vec<Remedy>,
    /// Advice in words.
    pub advice: String,
}

/// One remedy with its layout. Positions are in the world frame, mm; angles are in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RemedyEntry {
    pub remedy: Remedy,
    pub feasible: bool,
    /// Objective in the unit of the document; null if the layout is not feasible.
    pub objective: Option<f64>,
    /// Reduction of the objective compared with the remedy `as-drawn` (layout as drawn, no calibration),
    /// percent.
    pub gain_percent: Option<f64>,
    /// Whether every operation stays within its limit; null if no operation has a limit.
    pub within_limits: Option<bool>,
    /// Reasons why the layout is not feasible.
    pub reasons: Vec<String>,
    pub layout: ByName<PlacementEntry>,
    pub base: PlacementEntry,
    pub attitudes: ByName<AttitudeEntry>,
    pub operations: Vec<SpotEntry>,
}

impl RemediesDocument {
    /// Makes the document; `can_move` states whether the cell has free coordinates.
    pub fn new(remedies: &Remedies<'_>, seed: u64, evaluations: u64, can_move: bool) -> Self {
        let cell = remedies.layout(Remedy::AsDrawn).cell;
        Self {
            schema: REMEDIES_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            quantity: value_word(cell).into(),
            unit: cell.unit(),
            seed,
            evaluations,
            remedies: remedies.all().map(|(remedy, a)| RemedyEntry::new(remedies, remedy, a)).collect(),
            advised: remedies.advised(),
            advice: advice(remedies, can_move),
        }
    }
}

impl RemedyEntry {
    fn new(remedies: &Remedies<'_>, remedy: Remedy, a: &Assessment<'_>) -> Self {
        Self {
            remedy,
            feasible: a.evaluation.objective.is_some(),
            objective: a.objective().map(nine_digits),
            gain_percent: remedies.gain(remedy).map(percent),
            within_limits: remedies.has_limits().then(|| remedies.suffices(remedy)),
            reasons: a.reasons(),
            layout: placements(a.cell, &a.layout),
            base: PlacementEntry::new(&a.layout.base),
            attitudes: attitudes(a.cell, &a.layout),
            operations: SpotEntry::all(a),
        }
    }
}

/// Returns the heading of the column of a remedy.
pub fn remedy_name(remedy: Remedy) -> &'static str {
    match remedy {
        Remedy::AsDrawn => "as it stands",
        Remedy::Calibrated => "calibrated",
        Remedy::Moved => "moved",
        Remedy::Both => "both",
    }
}

/// Returns the advice in words, with a last sentence if a remedy brings no improvement.
fn advice(remedies: &Remedies<'_>, can_move: bool) -> String {
    let unit = remedies.layout(Remedy::AsDrawn).cell.unit();
    let value = |remedy| match remedies.objective(remedy) {
        Some(value) => format!("{} {}", rounded(unit.from_si(value), 4), unit.word()),
        None => "no feasible layout".into(),
    };
    let drawn = value(Remedy::AsDrawn);
    let to = |remedy| format!("from {drawn} to {}", value(remedy));
    let said = match (&remedies.advised()[..], remedies.has_limits()) {
        ([], true) => "No remedy meets every limit: neither calibrating, nor moving, nor both.".to_string(),
        ([], false) => "No remedy gives a feasible layout.".into(),
        ([Remedy::AsDrawn, ..], true) => "The cell meets every limit as it stands.".into(),
        ([Remedy::AsDrawn, ..], false) => {
            "Neither calibrating nor moving lowers the error by 1 % or more.".into()
        }
        ([Remedy::Calibrated, Remedy::Moved, ..], _) => format!(
            "Calibrate or move: each alone meets every limit. Calibrating changes the error {}, and moving \
             changes the error to {}.",
            to(Remedy::Calibrated),
            value(Remedy::Moved)
        ),
        ([Remedy::Calibrated, ..], true) => {
            format!(
                "Calibrate: calibrating alone meets every limit, and changes the error {}.",
                to(Remedy::Calibrated)
            )
        }
        ([Remedy::Calibrated, ..], false) => {
            format!(
                "Calibrate: calibrating changes the error {}. Moving the equipment as well would lower the \
                 error by at most another 1 % of the error as drawn.",
                to(Remedy::Calibrated)
            )
        }
        ([Remedy::Moved, ..], true) => {
            format!(
                "Move the equipment: moving alone meets every limit, and changes the error {}.",
                to(Remedy::Moved)
            )
        }
        ([Remedy::Moved, ..], false) => format!(
            "Move the equipment: moving changes the error {}. Calibrating as well would lower the error by \
             at most another 1 % of the error as drawn.",
            to(Remedy::Moved)
        ),
        ([Remedy::Both, ..], _) => format!(
            "Do both: calibrating and moving together change the error {}; calibrating alone gives {}, \
             moving alone {}.",
            to(Remedy::Both),
            value(Remedy::Calibrated),
            value(Remedy::Moved)
        ),
    };
    let idle = match (remedies.helps(Remedy::Calibrated), remedies.helps(Remedy::Moved)) {
        (false, true) => " Calibrating alone brings no improvement.",
        (true, false) if !can_move => " Every placement is fixed, so nothing can be moved.",
        (true, false) => " Moving alone brings no improvement.",
        _ => "",
    };
    said + idle
}
