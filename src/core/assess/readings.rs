//! Comparison of readings (interpretations of the error set): results for the layout of the cell file under
//! every reading and registration.
//!
//! For each reading R, the comparison gives the spot that R chooses, and a regret. The signed spot is the
//! spot that the signed reading chooses. The regret is the value at the signed spot divided by the least
//! value, both under R.

use super::posture_context::no_spot;
use crate::cell::{
    About, Cell, Interpretation, NO_TOLERANCES, Operation, Quantity, Reading, Registration, Unit,
};
use crate::error_map::OperationMap;
use crate::kinematic_error::NEGLIGIBLE;
use crate::layout::Workcell;
use nalgebra::Vector3;

/// Best node of an operation under one reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadingChoice {
    pub node: (usize, usize),
    /// Position of the node in the world, m.
    pub position: Vector3<f64>,
    /// Value of the node under the reading: m, rad or a share of failures.
    pub value: f64,
    /// Distance from the spot of the signed reading, m; None if the signed reading has no spot.
    pub moved: Option<f64>,
}

/// Result of one operation under one reading and registration.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadingRow {
    pub reading: Reading,
    pub quantity: Quantity,
    pub registration: Registration,
    /// Best node, or the reason why no node can be used.
    pub choice: Result<ReadingChoice, String>,
    /// Value at the posture of the signed spot, under the reading and registration of this row. The signed
    /// spot is the best node under the signed reading with the same registration.
    pub at_signed: Option<f64>,
    /// Value at the posture of the unregistered spot, under the reading and registration of this row. The
    /// unregistered spot is the best node under the same reading without registration.
    pub at_unregistered: Option<f64>,
    pub unit: Unit,
}

impl ReadingRow {
    /// Returns the name of the value that a search minimizes under this reading.
    pub fn quantity_name(&self) -> &'static str {
        match self.reading {
            Reading::Signed => "error",
            Reading::WorstCase => "worst case",
            Reading::Statistical if self.quantity == Quantity::Yield => "share of failures",
            Reading::Statistical => self.quantity.name(),
        }
    }

    /// Returns the value of the best node under the reading of this row; None if no node can be used.
    pub fn value(&self) -> Option<f64> {
        self.choice.as_ref().ok().map(|c| c.value)
    }

    /// Returns the regret: [`Self::at_signed`] divided by the value of the best node ([`Self::value`]).
    /// Returns None if either value is missing, or if the value of the best node is negligible.
    pub fn ratio(&self) -> Option<f64> {
        let value = self.value().filter(|v| *v > NEGLIGIBLE)?;
        Some(self.at_signed? / value).filter(|r| r.is_finite())
    }
}

/// Results of all operations under all readings and registrations.
pub struct Readings<'a> {
    pub cell: &'a Cell,
    pub operations: Vec<Vec<ReadingRow>>,
}

impl<'a> Readings<'a> {
    /// Computes the spots of a cell under all readings and registrations.
    ///
    /// # Errors
    /// Returns the reason if the robot cannot be used.
    pub fn new(cell: &'a Cell) -> Result<Self, String> {
        let own = Workcell::new(cell.clone())?;
        let mut operations = vec![Vec::new(); cell.operations.len()];
        // Maps of each reading without registration; this case comes first in the loop.
        let mut unregistered: Vec<(Reading, Quantity, Maps)> = Vec::new();
        for registration in Registration::ALL {
            let mut signed: Option<Maps> = None;
            for interpretation in answerable(cell, registration) {
                let (reading, quantity) = (interpretation.reading, interpretation.quantity);
                if reading != Reading::Signed && cell.errors_compensate() {
                    let each = operations.iter_mut().zip(&cell.operations);
                    each.for_each(|(rows, operation)| rows.push(unanswered(&interpretation, operation)));
                    continue;
                }
                let workcell = own.interpreted_apart(&interpretation)?.in_own_senses();
                let maps = workcell.maps(&cell.start());
                let by_signed = if reading == Reading::Signed { Some(&maps) } else { signed.as_ref() };
                let same = |(r, q, _): &&(Reading, Quantity, Maps)| (*r, *q) == (reading, quantity);
                let plain = unregistered.iter().find(same).map(|(_, _, maps)| maps);
                for (k, rows) in operations.iter_mut().enumerate() {
                    let plain = if registration == Registration::None { Some(&maps) } else { plain };
                    rows.push(row(&workcell, &maps, by_signed, plain, k));
                }
                if registration == Registration::None {
                    unregistered.push((reading, quantity, maps.clone()));
                }
                if reading == Reading::Signed {
                    signed = Some(maps);
                }
            }
        }
        Ok(Self { cell, operations })
    }

    /// Returns whether any reading has a spot for any operation.
    pub fn found(&self) -> bool {
        self.operations.iter().flatten().any(|row| row.choice.is_ok())
    }

    /// Finds the row with the largest regret ([`ReadingRow::ratio`]). Returns the index of its operation, the
    /// row and the regret. Returns None if no row has a regret.
    pub fn largest_regret(&self) -> Option<(usize, &ReadingRow, f64)> {
        let all = self.operations.iter().enumerate().flat_map(|(k, rows)| rows.iter().map(move |r| (k, r)));
        let ratios = all.filter_map(|(k, row)| Some((k, row, row.ratio()?)));
        ratios.fold(None, |most, this| match most {
            Some((_, _, ratio)) if ratio >= this.2 => most,
            _ => Some(this),
        })
    }

    /// Returns the row of an operation under the worst-case reading and the given registration.
    pub fn worst_case(&self, operation: usize, registration: Registration) -> Option<&ReadingRow> {
        let wanted = |r: &&ReadingRow| r.reading == Reading::WorstCase && r.registration == registration;
        self.operations[operation].iter().find(wanted)
    }
}

/// Error maps of one workcell, one per operation.
type Maps = Vec<OperationMap>;

/// Returns every reading that the error set of a cell allows under a registration, the signed reading first.
fn answerable(cell: &Cell, registration: Registration) -> Vec<Interpretation> {
    let kinds = [
        (Reading::Signed, cell.quantity),
        (Reading::WorstCase, cell.quantity),
        (Reading::Statistical, Quantity::P95),
        (Reading::Statistical, Quantity::Yield),
    ];
    let read =
        |(reading, quantity)| Interpretation { reading, quantity, registration, ..cell.interpretation() };
    // Each operation has its own table, and no values of operations are added. So a cell whose senses have
    // different units can also be compared.
    let answers = |i: &Interpretation| cell.faults_of(i).iter().all(|f| matches!(f.about, About::Sense(_)));
    kinds.into_iter().map(read).filter(answers).collect()
}

/// Returns the result of operation `k` under the reading of the workcell; `maps` holds the maps under this
/// reading.
///
/// `signed` holds the maps of the signed reading, and `plain` the maps without registration.
fn row(
    workcell: &Workcell,
    maps: &Maps,
    signed: Option<&Maps>,
    plain: Option<&Maps>,
    k: usize,
) -> ReadingRow {
    let cell = &workcell.cell;
    let there = signed.and_then(|maps| maps[k].best_node());
    let best = maps[k].best_node().and_then(|n| Some((n, n.posture.as_ref()?)));
    let choice = best.map(|(node, posture)| ReadingChoice {
        node: (node.i, node.j),
        position: node.position,
        value: posture.value,
        moved: there.map(|t| (node.position - t.position).norm()),
    });
    ReadingRow {
        reading: cell.reading,
        quantity: cell.quantity,
        registration: cell.registration,
        choice: choice.ok_or_else(|| no_spot(cell, &maps[k])),
        at_signed: signed.and_then(|chosen| value_at_choice(workcell, maps, chosen, k)),
        at_unregistered: plain.and_then(|chosen| value_at_choice(workcell, maps, chosen, k)),
        unit: unit_of(cell.reading, cell.quantity, &cell.operations[k]),
    }
}

/// Returns a row without values. It stands for a reading that needs tolerances, if the errors are not
/// tolerances ([`Cell::errors_compensate`]).
fn unanswered(interpretation: &Interpretation, operation: &Operation) -> ReadingRow {
    let Interpretation { reading, quantity, registration, .. } = *interpretation;
    ReadingRow {
        reading,
        quantity,
        registration,
        choice: Err(NO_TOLERANCES.into()),
        at_signed: None,
        at_unregistered: None,
        unit: unit_of(reading, quantity, operation),
    }
}

/// Returns the unit of the values of an operation under a reading.
fn unit_of(reading: Reading, quantity: Quantity, operation: &Operation) -> Unit {
    match (reading, quantity) {
        (Reading::Statistical, Quantity::Yield) => Unit::Share,
        _ => operation.sense.unit,
    }
}

/// Returns the value of operation `k` under the reading of the workcell, at the posture of the best node in
/// `chosen`. `maps` holds the maps under the reading of the workcell.
fn value_at_choice(workcell: &Workcell, maps: &Maps, chosen: &Maps, k: usize) -> Option<f64> {
    let place = chosen[k].best?;
    let posture = chosen[k].nodes[place].posture.as_ref()?;
    let own = maps[k].nodes[place].posture.as_ref().filter(|own| own.branch == posture.branch);
    if let (Some(own), None) = (own, workcell.cell.operations[k].relative_to) {
        return Some(own.value);
    }
    let (situation, frames) = workcell.posed(&workcell.cell.start(), chosen, k, posture).ok()?;
    let evaluator = workcell.evaluator(k);
    Some(evaluator.value(&situation, &frames, &mut evaluator.memory()))
}
