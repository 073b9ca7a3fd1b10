//! Evaluation settings of the page (sense, model and reading), with one workcell for each combination.

use crate::cell::{Cell, Interpretation, Model, Quantity, Reading};
use crate::cli::mutex::locked;
use crate::layout::Workcell;
use std::sync::{Arc, Mutex};

/// Largest number of workcells kept: about 27 senses times nine combinations of model and reading.
const MAX_WORKCELLS: usize = 300;

/// Evaluation settings of the page: sense, model and reading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EvaluationSettings {
    /// Name of the sense; None if each operation keeps its own sense.
    pub sense: Option<String>,
    pub model: Model,
    pub reading: Reading,
}

impl EvaluationSettings {
    /// Returns the evaluation settings of the cell file.
    pub fn of(cell: &Cell) -> Self {
        Self { sense: None, model: cell.model, reading: cell.reading }
    }

    /// Returns the [`Interpretation`] of the errors of `cell` under these settings.
    ///
    /// # Errors
    /// Fails if the cell has no sense of that name.
    fn interpretation(&self, cell: &Cell) -> Result<Interpretation, String> {
        let named = |word: &String| cell.sense(word).ok_or_else(|| format!("unknown sense `{word}`"));
        let sense = self.sense.as_ref().map(named).transpose()?;
        let (model, reading) = (self.model, self.reading);
        // If the cell file does not choose the statistical reading, this reading shows the 95th percentile.
        let becomes_random = reading == Reading::Statistical && cell.reading != Reading::Statistical;
        let quantity = if becomes_random { Quantity::P95 } else { cell.quantity };
        Ok(Interpretation { model, reading, quantity, sense, ..cell.interpretation() })
    }
}

/// Cache of the workcells for all evaluation settings used so far. The first entry has the settings of the
/// cell file.
pub struct Workcells {
    own: Arc<Workcell>,
    ready: Mutex<Vec<(EvaluationSettings, Arc<Workcell>)>>,
}

impl Workcells {
    /// Returns a cache that contains the workcell `own` of the cell file.
    pub fn new(own: Workcell) -> Self {
        let own = Arc::new(own.in_own_senses());
        Self { ready: Mutex::new(vec![(EvaluationSettings::of(&own.cell), own.clone())]), own }
    }

    /// Returns the workcell for the evaluation settings `question`.
    ///
    /// # Errors
    /// Fails with the reason if the cell cannot be evaluated with these settings.
    pub fn ask(&self, question: &EvaluationSettings) -> Result<Arc<Workcell>, String> {
        let mut ready = locked(&self.ready);
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
