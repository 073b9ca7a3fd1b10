//! Lower bound of the value of an operation over rotations of the tool about its axis.

use super::error_sources::is_behind;
use super::spin_bound::SpinBound;
use super::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::cell::{Frame, Model, Parameter, Reading};
use crate::robot::Frames;
use nalgebra::Vector3;

/// Largest relative rounding error of a computed value.
const ROUNDING: f64 = 1e-7;

impl ErrorEvaluator {
    /// Returns whether [`Self::least_over_spins`] can compute a lower bound. If not, that function returns 0.
    pub fn has_spin_bound(&self) -> bool {
        self.spin_bound.is_some()
    }

    /// Returns whether [`Self::least_over_spins`] takes as much computing time as [`Self::value`].
    pub fn has_dear_spin_bound(&self) -> bool {
        matches!(self.spin_bound, Some(SpinBound::Signed(_)))
    }

    /// Returns whether the reading is statistical and [`Self::value`] is the same after every rotation by the
    /// last joint. A single evaluation of the value then takes less computing time than the lower bounds for
    /// all rotations.
    pub fn has_one_value_over_spins(&self) -> bool {
        self.ignores_spin() && self.reading == Reading::Statistical
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
            None => 0.0,
            Some(SpinBound::Signed(apart)) => {
                (self.value(context, frames, memory) * (1.0 - ROUNDING) - apart).max(0.0)
            }
            Some(SpinBound::WorstCase) => self.rough_worst(context, frames, spins.len() > 1, memory),
            Some(SpinBound::Normal(bound)) => {
                let EvaluatorScratch { expansion, effects, position, .. } = memory;
                let measure = self.measure(&self.sense, context, frames);
                let axis = frames.tcp.rotation * self.chain.tool_axis;
                if let (Some(factors), Some(expansion)) =
                    (self.spin_bound.as_ref().and_then(SpinBound::factors), position)
                {
                    return bound.least_of_position(factors, frames, expansion, &measure, &axis, spins);
                }
                self.propagation().effects(context, frames, expansion, false, effects);
                bound.least(effects, &self.sources, &measure, &axis, spins)
            }
        }
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
