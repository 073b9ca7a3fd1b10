//! The layout as drawn under every reading and every registration: what each would choose, and what
//! it costs to have chosen by the signed sample.

use super::stance::no_spot;
use crate::cell::{About, Cell, Quantity, Reading, Registration, Unit};
use crate::error_map::OperationMap;
use crate::layout::Workcell;
use nalgebra::Vector3;

/// The best node of an operation under one reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    pub node: (usize, usize),
    /// World, m.
    pub position: Vector3<f64>,
    /// m, rad or a share of failures.
    pub value: f64,
    /// From the spot of the signed reading, m; None if there is none.
    pub moved: Option<f64>,
}

/// One operation under one reading and registration.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub reading: Reading,
    pub quantity: Quantity,
    pub registration: Registration,
    /// The best node, or why there is none.
    pub choice: Result<Choice, String>,
    /// The value here of the posture that the signed reading chooses under this registration.
    pub at_signed: Option<f64>,
    pub unit: Unit,
}

impl Row {
    /// What the reading makes small.
    pub fn quantity_name(&self) -> &'static str {
        match self.reading {
            Reading::Signed => "error",
            Reading::WorstCase => "worst case",
            Reading::Statistical => self.quantity.name(),
        }
    }

    pub fn value(&self) -> Option<f64> {
        self.choice.as_ref().ok().map(|c| c.value)
    }

    /// How many times the least value the signed choice has.
    pub fn ratio(&self) -> Option<f64> {
        let value = self.value().filter(|v| *v > 0.0)?;
        Some(self.at_signed? / value).filter(|r| r.is_finite())
    }
}

/// All rows, one list per operation.
pub struct Readings<'a> {
    pub cell: &'a Cell,
    pub operations: Vec<Vec<Row>>,
}

impl<'a> Readings<'a> {
    /// # Errors
    /// Why the robot cannot be used.
    pub fn new(cell: &'a Cell) -> Result<Self, String> {
        let mut operations = vec![Vec::new(); cell.operations.len()];
        for registration in Registration::ALL {
            let mut signed = None;
            for variant in variants(cell, registration) {
                let reading = variant.reading;
                let workcell = Workcell::new(variant)?;
                let maps = workcell.maps(&cell.start());
                for (k, rows) in operations.iter_mut().enumerate() {
                    rows.push(row(&workcell, &maps, signed.as_deref().unwrap_or(&[]), k));
                }
                if reading == Reading::Signed {
                    // Of itself the signed choice costs nothing.
                    for rows in &mut operations {
                        if let Some(row) = rows.last_mut() {
                            row.at_signed = row.value();
                            row.choice.iter_mut().for_each(|c| c.moved = Some(0.0));
                        }
                    }
                    signed = Some(maps);
                }
            }
        }
        Ok(Self { cell, operations })
    }

    /// Whether any reading has a spot for any operation.
    pub fn found(&self) -> bool {
        self.operations.iter().flatten().any(|row| row.choice.is_ok())
    }

    /// The row with the largest regret, and its operation.
    pub fn largest_regret(&self) -> Option<(usize, &Row, f64)> {
        let all = self.operations.iter().enumerate().flat_map(|(k, rows)| rows.iter().map(move |r| (k, r)));
        let ratios = all.filter_map(|(k, row)| Some((k, row, row.ratio()?)));
        ratios.fold(None, |most, this| match most {
            Some((_, _, ratio)) if ratio >= this.2 => most,
            _ => Some(this),
        })
    }

    /// The least worst case of an operation under a registration, m or rad.
    pub fn worst_case(&self, operation: usize, registration: Registration) -> Option<f64> {
        let wanted = |r: &&Row| r.reading == Reading::WorstCase && r.registration == registration;
        self.operations[operation].iter().find(wanted)?.value()
    }
}

/// The cell in every reading that has an answer, the signed one first.
fn variants(cell: &Cell, registration: Registration) -> Vec<Cell> {
    let kinds = [
        (Reading::Signed, cell.quantity),
        (Reading::WorstCase, cell.quantity),
        (Reading::Statistical, Quantity::P95),
        (Reading::Statistical, Quantity::Yield),
    ];
    let read = |(reading, quantity)| Cell { reading, quantity, registration, ..cell.clone() };
    // Nothing is added up here: senses of two units are none of its faults.
    let answers = |c: &Cell| c.question_faults().iter().all(|f| matches!(f.about, About::Sense(_)));
    kinds.into_iter().map(read).filter(answers).collect()
}

/// One operation under the reading of the workcell; `signed` are the maps of the signed one.
fn row(workcell: &Workcell, maps: &[OperationMap], signed: &[OperationMap], k: usize) -> Row {
    let cell = &workcell.cell;
    let there = signed.get(k).and_then(OperationMap::best_node);
    let best = maps[k].best_node().and_then(|n| Some((n, n.posture.as_ref()?)));
    let choice = best.map(|(node, posture)| Choice {
        node: (node.i, node.j),
        position: node.position,
        value: posture.value,
        moved: there.map(|t| (node.position - t.position).norm()),
    });
    let at_signed = || {
        let posture = there?.posture.as_ref()?;
        let (situation, frames) = workcell.posed(&cell.start(), signed, k, posture).ok()?;
        let gauge = workcell.gauge(k);
        Some(gauge.value(&situation, &frames, &mut gauge.memory()))
    };
    let share = cell.reading == Reading::Statistical && cell.quantity == Quantity::Yield;
    Row {
        reading: cell.reading,
        quantity: cell.quantity,
        registration: cell.registration,
        choice: choice.ok_or_else(|| no_spot(cell, &maps[k])),
        at_signed: at_signed(),
        unit: if share { Unit::Share } else { cell.operations[k].sense.unit },
    }
}
