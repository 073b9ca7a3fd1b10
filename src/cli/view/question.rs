//! The question that the page asks of the layout: sense, model, reading; one workcell for each.

use crate::cell::{Cell, Interpretation, Model, Quantity, Reading};
use crate::layout::Workcell;
use std::sync::{Arc, Mutex};

/// Most workcells kept: a page can ask in about 27 senses under nine lenses.
const MAX_WORKCELLS: usize = 300;

/// Question that the page asks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PageQuestion {
    /// Sense by its name; None: each operation in its own.
    pub sense: Option<String>,
    pub model: Model,
    pub reading: Reading,
}

impl PageQuestion {
    /// Returns the question that the cell file asks.
    pub fn of(cell: &Cell) -> Self {
        Self { sense: None, model: cell.model, reading: cell.reading }
    }

    /// Returns the interpretation of the errors of a cell that this question asks for.
    ///
    /// # Errors
    /// That the cell has no such sense.
    fn interpretation(&self, cell: &Cell) -> Result<Interpretation, String> {
        let named = |word: &String| cell.sense(word).ok_or_else(|| format!("unknown sense `{word}`"));
        let sense = self.sense.as_ref().map(named).transpose()?;
        let (model, reading) = (self.model, self.reading);
        // A drawing shows the 95th percentile where the cell states no quantity.
        let becomes_random = reading == Reading::Statistical && cell.reading != Reading::Statistical;
        let quantity = if becomes_random { Quantity::P95 } else { cell.quantity };
        Ok(Interpretation { model, reading, quantity, sense, ..cell.interpretation() })
    }
}

/// Workcells made ready for every question asked so far, that of the cell file first.
pub struct Workcells {
    own: Arc<Workcell>,
    ready: Mutex<Vec<(PageQuestion, Arc<Workcell>)>>,
}

impl Workcells {
    /// Keeps the workcell of the question that the cell file asks.
    pub fn new(own: Workcell) -> Self {
        let own = Arc::new(own.in_own_senses());
        Self { ready: Mutex::new(vec![(PageQuestion::of(&own.cell), own.clone())]), own }
    }

    /// Returns the workcell of a question.
    ///
    /// # Errors
    /// Why the question has no answer.
    pub fn ask(&self, question: &PageQuestion) -> Result<Arc<Workcell>, String> {
        let mut ready = super::locked(&self.ready);
        if let Some((_, workcell)) = ready.iter().find(|(known, _)| known == question) {
            return Ok(workcell.clone());
        }
        let workcell = self.own.interpreted(&question.interpretation(&self.own.cell)?)?;
        let workcell = Arc::new(workcell.in_own_senses());
        if ready.len() >= MAX_WORKCELLS {
            ready.remove(1);
        }
        ready.push((question.clone(), workcell.clone()));
        Ok(workcell)
    }
}
