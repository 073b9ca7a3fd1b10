//! The document of `readings --json`.

use super::numbers::{in_unit, millimetres, nine_digits, position_mm};
use super::words::VALUE_WORDS;
use crate::assess::{ReadingRow, Readings};
use crate::cell::{Cell, Model, Operation, Reading, Registration, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the document of `readings --json`.
pub const READINGS_SCHEMA: &str = "sweetspot/readings/1";

/// Results for the layout of the cell file under every reading and registration. Positions are in the world
/// frame, mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReadingsDocument {
    #[schemars(extend("const" = READINGS_SCHEMA))]
    pub schema: String,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    pub model: Model,
    pub operations: Vec<OperationReadings>,
    /// Largest regret over all operations, readings and registrations. The regret of an entry in `readings`
    /// is its `at_signed_choice` divided by its `value`. Null if no regret is known, for example if the
    /// signed reading has no spot.
    pub largest_regret: Option<RegretEntry>,
    /// Findings in sentences.
    pub findings: Vec<String>,
}

/// Results of one operation under every reading and registration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OperationReadings {
    pub name: String,
    pub equipment: String,
    pub sense: String,
    /// Largest allowed error of the operation, in the unit of its sense.
    pub limit: Option<f64>,
    pub readings: Vec<ReadingEntry>,
}

/// Result of one operation under one reading and one registration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReadingEntry {
    pub reading: Reading,
    /// Name of the error figure that `reading` gives, such as "worst case".
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub registration: Registration,
    pub unit: Unit,
    /// Node with the least value; null if no node can be used.
    pub node: Option<[usize; 2]>,
    pub position_mm: Option<[f64; 3]>,
    pub value: Option<f64>,
    /// Value under `reading` and `registration`, at the posture that the signed reading chooses with the same
    /// registration.
    pub at_signed_choice: Option<f64>,
    /// Value under `reading` and `registration`, at the posture that `reading` chooses without registration.
    pub at_unregistered_choice: Option<f64>,
    /// Regret of the signed reading: `at_signed_choice` divided by `value`.
    pub ratio: Option<f64>,
    /// Distance between the best node under `reading` and the best node under the signed reading.
    pub moved_mm: Option<f64>,
    /// Reason why no node can be used.
    pub reason: Option<String>,
}

/// Largest regret (`ratio`), and the operation, reading and registration to which it belongs. A regret
/// compares the values at two spots: the choice of the signed reading, and the best spot under `reading`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegretEntry {
    pub operation: String,
    pub reading: Reading,
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub registration: Registration,
    /// Regret: value under `reading` at the spot of the signed reading, divided by the least value under
    /// `reading`.
    pub ratio: f64,
}

impl ReadingsDocument {
    /// Makes the document; `findings` are sentences.
    pub fn new(r: &Readings<'_>, findings: Vec<String>) -> Self {
        let cell = r.cell;
        let operations = cell.operations.iter().zip(&r.operations);
        Self {
            schema: READINGS_SCHEMA.into(),
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            model: cell.model,
            operations: operations.map(|(o, rows)| OperationReadings::new(cell, o, rows)).collect(),
            largest_regret: RegretEntry::new(r),
            findings,
        }
    }
}

impl OperationReadings {
    fn new(cell: &Cell, operation: &Operation, rows: &[ReadingRow]) -> Self {
        Self {
            name: operation.name.clone(),
            equipment: cell.equipment[operation.equipment].name.clone(),
            sense: operation.sense.name.clone(),
            limit: operation.limit.map(|l| in_unit(operation.sense.unit, l)),
            readings: rows.iter().map(ReadingEntry::new).collect(),
        }
    }
}

impl ReadingEntry {
    fn new(row: &ReadingRow) -> Self {
        let choice = row.choice.as_ref().ok();
        let value = |v: f64| in_unit(row.unit, v);
        Self {
            reading: row.reading,
            quantity: row.quantity_name().into(),
            registration: row.registration,
            unit: row.unit,
            node: choice.map(|c| [c.node.0, c.node.1]),
            position_mm: choice.map(|c| position_mm(&c.position)),
            value: choice.map(|c| value(c.value)),
            at_signed_choice: row.at_signed.map(value),
            at_unregistered_choice: row.at_unregistered.map(value),
            ratio: row.ratio().map(nine_digits),
            moved_mm: choice.and_then(|c| c.moved).map(millimetres),
            reason: row.choice.as_ref().err().cloned(),
        }
    }
}

impl RegretEntry {
    fn new(r: &Readings<'_>) -> Option<Self> {
        let (k, row, ratio) = r.largest_regret()?;
        Some(Self {
            operation: r.cell.operations[k].name.clone(),
            reading: row.reading,
            quantity: row.quantity_name().into(),
            registration: row.registration,
            ratio: nine_digits(ratio),
        })
    }
}
