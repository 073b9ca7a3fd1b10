//! Lower bound of the value of an operation over rotations of the tool about its axis.

use super::error_sources::is_behind;
use super::norm::CentredBound;
use super::spin_bound::{NormalBound, SpinBound, SpinCovariance};
use super::spun_worst_case::SpunWorstCase;
use super::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::cell::{Frame, Model, Parameter, Reading};
use crate::robot::Frames;
use nalgebra::Vector3;

/// Largest relative rounding error of a computed value.
const ROUNDING: f64 = 1e-7;

/// Lower bounds of the value at one posture, as a function of the rotation of the tool about its axis.
pub enum BoundsOverSpins<'m> {
    /// Bounds of a worst case.
    WorstCase(&'m SpunWorstCase),
    /// Bounds for normal parameters: a figure of the error, and the covariance of the error.
    Normal(&'m CentredBound, &'m SpinCovariance),
}

impl BoundsOverSpins<'_> {
    /// Returns the lower bound after a rotation with the given cosine and sine.
    pub fn at(&self, spin: (f64, f64)) -> f64 {
        match self {
            Self::WorstCase(bounds) => bounds.at(spin),
            Self::Normal(figure, covariance) => figure.of(&covariance.at(spin)),
        }
    }

    /// Returns the least lower bound over several rotations, each given by cosine and sine.
    fn least(&self, spins: &[(f64, f64)]) -> f64 {
        let rotates = match self {
            Self::WorstCase(bounds) => bounds.rotates(),
            Self::Normal(_, covariance) => covariance.rotates(),
        };
        let spins = if rotates { spins } else { &spins[..spins.len().min(1)] };
        spins.iter().map(|spin| self.at(*spin)).fold(f64::INFINITY, f64::min)
    }
}

impl ErrorEvaluator {
    /// Returns whether [`Self::least_over_spins`] can compute a lower bound. If not, that function returns 0.
    pub fn has_spin_bound(&self) -> bool {
        self.spin_bound.is_some()
    }

    /// Returns whether [`Self::value`] is the same after every rotation by the last joint, and takes less
    /// computing time than the lower bounds for all rotations. The result is false for a worst case.
    pub fn has_one_value_over_spins(&self) -> bool {
        self.ignores_spin() && self.reading != Reading::WorstCase
    }

    /// Returns a lower bound of [`Self::value`] that holds after a rotation of the tool by any angle in
    /// `spins`. Returns 0 if no bound is known.
    ///
    /// The last joint rotates the tool about its axis. `spins` holds cosine and sine of each angle.
    pub fn least_over_spins(
        &self,
        context: &WorkContext,
        frames: &Frames,
        spins: &[(f64, f64)],
        memory: &mut EvaluatorScratch,
    ) -> f64 {
        match &self.spin_bound {
            Some(SpinBound::Signed(apart)) => {
                (self.value(context, frames, memory) * (1.0 - ROUNDING) - apart).max(0.0)
            }
            _ => self.bounds_over_spins(context, frames, memory).map_or(0.0, |bounds| bounds.least(spins)),
        }
    }

    /// Returns the lower bounds of [`Self::value`] as a function of the rotation of the tool about its axis.
    /// Returns None if no bounds are known, or if the reading is signed.
    pub fn bounds_over_spins<'m>(
        &'m self,
        context: &WorkContext,
        frames: &Frames,
        memory: &'m mut EvaluatorScratch,
    ) -> Option<BoundsOverSpins<'m>> {
        let bound = match self.spin_bound.as_ref()? {
            SpinBound::Signed(_) => return None,
            SpinBound::WorstCase => {
                return Some(BoundsOverSpins::WorstCase(self.spun_worst_case(context, frames, memory)));
            }
            SpinBound::Normal(bound) => bound,
        };
        let EvaluatorScratch { expansion, effects, position, covariance, .. } = memory;
        let measure = self.measure(&self.sense, context, frames);
        let axis = frames.tcp.rotation * self.chain.tool_axis;
        *covariance = match (&bound.factors, position) {
            (Some(factors), Some(expansion)) => {
                NormalBound::covariance_of_position(factors, frames, expansion, &measure, &axis)
            }
            _ => {
                self.propagation().effects(context, frames, expansion, false, effects);
                bound.covariance(effects, &self.sources, &measure, &axis)
            }
        };
        Some(BoundsOverSpins::Normal(&bound.figure, covariance))
    }

    /// Returns the algorithm by which this evaluator bounds the value over rotations of the tool. Returns
    /// None if no bound is known.
    pub(super) fn spin_bound_of(&self) -> Option<SpinBound> {
        // A rotation of the last joint may change an elastic deflection that acts before this joint.
        let changes = |p: Parameter| p.is_elastic() && is_behind(p, self.chain.axes());
        if self.sources.list.iter().any(|source| changes(source.parameter)) {
            return None;
        }
        match self.reading {
            Reading::Signed if self.alone && self.sense.is_of_position() => {
                let bound = SpinBound::of_sample(&self.chain, self.signed.errors(), &self.sense);
                let is_rigid = self.model != Model::SecondOrder || bound == SpinBound::Signed(0.0);
                is_rigid.then_some(bound)
            }
            Reading::Statistical => {
                SpinBound::of_statistics(&self.chain, &self.sources, &self.sense, self.quantity, self.alone)
            }
            // The bound needs rows that do not rotate with the tool. Rows in tool axes and a measured point
            // beside the TCP rotate with the tool, and a mean error may rotate with it.
            Reading::WorstCase => {
                let turns = self.sense.frame == Frame::Tool || self.sense.point != Vector3::zeros();
                (!turns && self.mean.is_none()).then_some(SpinBound::WorstCase)
            }
            Reading::Signed => None,
        }
    }
}
