//! Remedies for the measured errors of a robot: calibrate it, move the equipment, or both.

use super::{Assessment, Requirement};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Remedy for the measured errors of the robot of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Remedy {
    /// No remedy: the layout as drawn, with all errors present.
    AsDrawn,
    /// The controller compensates the identified errors; the layout is as drawn.
    Calibrated,
    /// The layout is the best of a search; no error is compensated.
    Moved,
    /// The controller compensates the identified errors, and the layout is the best of a search with the
    /// remaining errors.
    Both,
}

impl Remedy {
    /// All remedies, in ascending order of the work that they require.
    pub const ALL: [Remedy; 4] = [Remedy::AsDrawn, Remedy::Calibrated, Remedy::Moved, Remedy::Both];
}

/// Least gain that counts, as a share of the error of the layout as drawn.
const NO_GAIN: f64 = 0.01;

/// Comparison of the four remedies in [`Remedy`], each with its layout.
pub struct Remedies<'a> {
    /// One layout for each remedy, in the order of [`Remedy::ALL`].
    columns: [Assessment<'a>; 4],
}

impl<'a> Remedies<'a> {
    /// Compares the remedies. `columns` holds the layout of every remedy, in the order of [`Remedy::ALL`].
    pub fn new(columns: [Assessment<'a>; 4]) -> Self {
        Self { columns }
    }

    /// Returns every remedy with its layout.
    pub fn all(&self) -> impl Iterator<Item = (Remedy, &Assessment<'a>)> {
        Remedy::ALL.into_iter().zip(&self.columns)
    }

    /// Returns the layout of a remedy.
    pub fn layout(&self, remedy: Remedy) -> &Assessment<'a> {
        let [drawn, calibrated, moved, both] = &self.columns;
        match remedy {
            Remedy::AsDrawn => drawn,
            Remedy::Calibrated => calibrated,
            Remedy::Moved => moved,
            Remedy::Both => both,
        }
    }

    /// Returns the objective of a remedy: a value in m or rad, a share, or a cost. Returns None if its
    /// layout is not feasible.
    pub fn objective(&self, remedy: Remedy) -> Option<f64> {
        self.layout(remedy).evaluation.objective
    }

    /// Returns the relative reduction of the objective by a remedy, compared with the layout as drawn.
    /// Returns None if either layout is infeasible, or if the objective as drawn is 0.
    pub fn gain(&self, remedy: Remedy) -> Option<f64> {
        let drawn = self.objective(Remedy::AsDrawn).filter(|drawn| *drawn > 0.0)?;
        Some(1.0 - self.objective(remedy)? / drawn)
    }

    /// Returns whether the objective is an error and at least one operation has a limit. Any other objective
    /// (share of failures or cost of tolerances) already depends on the limits.
    pub fn has_limits(&self) -> bool {
        let [drawn, ..] = &self.columns;
        drawn.cell.unit().is_error() && drawn.cell.operations.iter().any(|o| o.limit.is_some())
    }

    /// Returns whether a remedy gives a feasible layout within every limit.
    pub fn suffices(&self, remedy: Remedy) -> bool {
        let a = self.layout(remedy);
        let is_met = |k: usize| a.requirement(k).is_none_or(Requirement::is_met);
        self.objective(remedy).is_some() && (0..a.maps.len()).all(is_met)
    }

    /// Returns the advised remedies, each of which suffices alone; empty if no remedy suffices.
    ///
    /// A remedy takes no step, one step (calibration or a new layout) or both steps. If there are limits, the
    /// function finds the least number of steps with which a remedy suffices. It returns all sufficient
    /// remedies with this number of steps. If there are no limits, a remedy qualifies if its error is near
    /// the least error. The largest allowed difference is 1 % of the error as drawn. Only the qualifying
    /// remedy with the least work is advised.
    pub fn advised(&self) -> Vec<Remedy> {
        let steps = [&[Remedy::AsDrawn][..], &[Remedy::Calibrated, Remedy::Moved], &[Remedy::Both]];
        if self.has_limits() {
            let enough =
                steps.map(|step| step.iter().copied().filter(|r| self.suffices(*r)).collect::<Vec<_>>());
            return enough.into_iter().find(|step| !step.is_empty()).unwrap_or_default();
        }
        let feasible = || Remedy::ALL.into_iter().filter_map(|r| Some((r, self.objective(r)?)));
        let Some(least) = feasible().map(|(_, value)| value).reduce(f64::min) else { return Vec::new() };
        let slack = NO_GAIN * self.objective(Remedy::AsDrawn).unwrap_or(least);
        feasible().find(|(_, value)| *value <= least + slack).map(|(remedy, _)| remedy).into_iter().collect()
    }

    /// Returns whether a remedy reduces the error of the layout as drawn by more than 1 %, or makes an
    /// infeasible layout feasible.
    pub fn helps(&self, remedy: Remedy) -> bool {
        match (self.objective(Remedy::AsDrawn), self.objective(remedy)) {
            (Some(drawn), Some(value)) => value < drawn * (1.0 - NO_GAIN),
            (None, Some(_)) => true,
            (_, None) => false,
        }
    }
}
