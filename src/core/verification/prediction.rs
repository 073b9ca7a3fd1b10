//! Prediction of measured position errors from the errors of the robot of a cell.

use crate::cell::{Cell, ErrorSet, Model, Reading};
use crate::kinematic_error::{Expansion, Perturbation, pose_error, position_error};
use crate::pose::Displacement;
use crate::reading::{Effects, ErrorSources};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Errors of the robot of a cell, as the cell interprets them: a mean, and random deviations from it.
///
/// A signed sample (errors with known signs) is a mean without deviations. Tolerances are random deviations
/// about 0, as in the statistical reading. Measured errors have both a mean and random deviations.
pub struct PredictedErrors {
    chain: Chain,
    model: Model,
    sources: ErrorSources,
    /// Mean of every error source (a robot parameter), m or rad. Elastic sources are in rad/m or rad/(N m),
    /// and periodic factors have no unit.
    means: Vec<f64>,
    may_vary: bool,
    has_deviations: bool,
    counts_deviations: bool,
}

impl PredictedErrors {
    /// Returns the errors of the robot of a cell, without the errors of the equipment.
    pub fn new(cell: &Cell) -> Self {
        let sources = ErrorSources::of_robot(cell);
        let is_signed = cell.reading == Reading::Signed;
        let means = if is_signed { Some(sources.signed()) } else { sources.means() };
        let is_measured = matches!(cell.error_set(), ErrorSet::Measured(_));
        Self {
            chain: Chain::new(&cell.robot).with_errors(cell.error_set()),
            model: cell.model,
            means: means.unwrap_or_else(|| vec![0.0; sources.list.len()]),
            sources,
            may_vary: is_measured,
            has_deviations: is_measured || !is_signed,
            counts_deviations: !is_signed,
        }
    }

    /// Returns the nominal chain of the robot with its tool.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Returns whether the parameters have random deviations. If so, the prediction contains 95 % ellipsoids
    /// of the positions.
    pub fn has_deviations(&self) -> bool {
        self.has_deviations
    }

    /// Returns whether the deviations of the parameters may change from pose to pose, as the misfit of a
    /// calibration does.
    pub fn may_vary(&self) -> bool {
        self.may_vary
    }

    /// Returns whether the predicted size of an error includes the random deviations of the parameters. In
    /// the signed reading, the size includes no random deviations.
    pub fn counts_deviations(&self) -> bool {
        self.counts_deviations
    }

    /// Returns the errors as displacements of a reflector. `reflector` is its position in the frame of the
    /// mechanical interface, m.
    pub(super) fn at_reflector(&self, reflector: &Vector3<f64>) -> ReflectorErrors<'_> {
        let mut chain = self.chain.clone();
        chain.tool.translation = *reflector;
        ReflectorErrors {
            errors: self,
            means: self.sources.perturbation(&chain, &self.means),
            expansion: self.sources.expansion(&chain),
            effects: Effects::default(),
            chain,
        }
    }
}

/// Errors of the robot at one reflector.
pub(super) struct ReflectorErrors<'a> {
    errors: &'a PredictedErrors,
    /// Chain whose TCP is the reflector.
    chain: Chain,
    means: Perturbation,
    expansion: Expansion,
    effects: Effects,
}

impl ReflectorErrors<'_> {
    /// Returns the frames of the chain at joint coordinates `q` (rad or m).
    pub fn frames(&self, q: &crate::cell::JointVector) -> Frames {
        self.chain.frames(&self.chain.posture(q))
    }

    /// Returns the position error of the reflector that the mean errors cause, m, base frame.
    pub fn mean(&self, frames: &Frames) -> Vector3<f64> {
        position_error(frames, &self.means, self.errors.model)
    }

    /// Returns the displacement that the mean errors cause at the reflector, base frame.
    pub fn mean_displacement(&self, frames: &Frames) -> Displacement {
        pose_error(frames, &self.means, self.errors.model)
    }

    /// Returns displacements of the reflector, m, base frame: one for each independent random factor, at one
    /// standard deviation. A factor is one parameter, or one combination of correlated parameters.
    pub fn deviations(&mut self, frames: &Frames) -> Vec<Vector3<f64>> {
        self.expansion.set(frames);
        self.effects.set(&self.errors.sources, &self.expansion, false);
        let mut all = Vec::new();
        self.effects.independent(&self.errors.sources, |moved, _| all.push(moved.position));
        all
    }
}
