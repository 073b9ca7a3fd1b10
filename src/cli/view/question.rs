//! What is asked of the layout on the page: sense, model, reading; one workcell for each.

use crate::cell::{Cell, Model, Quantity, Reading};
use crate::cli::cache;
use crate::layout::Workcell;
use std::sync::{Arc, Mutex};

/// Workcells kept at most: a page can ask in some 27 senses under nine lenses.
const MOST: usize = 300;

/// As the page asks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// None: each operation in its own sense.
    pub sense: Option<String>,
    pub model: Model,
    pub reading: Reading,
}

impl Question {
    /// As the cell asks.
    pub fn of(cell: &Cell) -> Self {
        Self { sense: None, model: cell.model, reading: cell.reading }
    }

    /// The cell asked so.
    ///
    /// # Errors
    /// Why that has no answer.
    fn asked_of(&self, cell: &Cell) -> Result<Cell, String> {
        let mut cell = cell.clone();
        if let Some(word) = &self.sense {
            let sense = cell.sense(word).ok_or("there is no such sense")?;
            for operation in &mut cell.operations {
                // A limit of the other unit says nothing here.
                operation.limit = operation.limit.filter(|_| operation.sense.unit == sense.unit);
                operation.sense = sense.clone();
            }
        }
        if self.reading == Reading::Statistical && cell.reading != Reading::Statistical {
            // As a drawing shows it.
            cell.quantity = Quantity::P95;
        }
        (cell.model, cell.reading) = (self.model, self.reading);
        match cell.question_faults().first() {
            Some(fault) => Err(format!("{}; {}", fault.message, fault.help)),
            None => Ok(cell),
        }
    }
}

/// The cell made ready for every question asked so far.
pub struct Workcells {
    cell: Cell,
    ready: Mutex<Vec<(Question, Arc<Workcell>)>>,
}

impl Workcells {
    pub fn new(own: Workcell) -> Self {
        let cell = own.cell.clone();
        Self { ready: Mutex::new(vec![(Question::of(&cell), Arc::new(own.in_own_senses()))]), cell }
    }

    /// # Errors
    /// Why the question has no answer.
    pub fn ask(&self, question: &Question) -> Result<Arc<Workcell>, String> {
        let mut ready = super::locked(&self.ready);
        if let Some((_, workcell)) = ready.iter().find(|(q, _)| q == question) {
            return Ok(workcell.clone());
        }
        let cell = question.asked_of(&self.cell)?;
        let same_sense = ready.iter().find(|(q, _)| q.sense == question.sense);
        let workcell = match same_sense {
            // It shares the solids.
            Some((_, w)) => w.read_otherwise(cell.model, cell.reading, cell.quantity),
            None => Workcell::remembering(cell, &mut cache::remember),
        };
        let workcell = Arc::new(workcell?.in_own_senses());
        if ready.len() >= MOST {
            ready.remove(1);
        }
        ready.push((question.clone(), workcell.clone()));
        Ok(workcell)
    }
}
