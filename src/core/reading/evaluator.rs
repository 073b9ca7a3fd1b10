//! Error of an operation at a posture as one number, which the search minimizes.

use super::error_propagation::{ErrorPropagation, PreparedSample};
use super::error_sources::{ErrorSources, is_behind};
use super::flip_prediction::FlipPrediction;
use super::isotropic_tool::is_isotropic;
use super::norm::{ConditionalScratch, NormLaw};
use super::registration::BestFit;
use super::spin_bound::{SpinBound, SpinCovariance};
use super::spun_worst_case::SpunWorstCase;
use super::work_context::{PickReference, WorkContext, WorkFrame};
use super::zonotope::ZonotopeScratch;
use super::{Effects, MAX_SOURCES, SenseRows};
use crate::cell::{Cell, Distribution, Frame, Model, Operation, Quantity, Reading, Registration, Sense};
use crate::kinematic_error::{Expansion, Perturbation, TwoValuedWalk, position_error};
use crate::pose::Displacement;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3, Vector6};

/// Evaluator of the error of one operation. The operation defines the [`Sense`], and the cell defines the
/// error [`Model`] and the [`Reading`].
#[derive(Debug, Clone)]
pub struct ErrorEvaluator {
    pub(super) chain: Chain,
    pub sources: ErrorSources,
    best_fit: Option<BestFit>,
    pub sense: Sense,
    /// Senses reported at every node: x, y, z, xy and xyz ([`Sense::paper`]), and the sense of the operation.
    pub reported: Vec<Sense>,
    pub model: Model,
    pub reading: Reading,
    pub quantity: Quantity,
    /// Limit of the operation, m or rad; None without a limit.
    pub limit: Option<f64>,
    /// Values of the signed sample, one per source.
    pub(super) signed_values: Vec<f64>,
    pub(super) signed: PreparedSample,
    /// Means of the sources, and the sample with these values; None if all means are 0.
    pub(super) mean: Option<(Vec<f64>, PreparedSample)>,
    /// Whether only the robot has errors, and neither a registration nor a pick removes a part of these
    /// errors.
    pub(super) alone: bool,
    /// Equipment on which the robot works; None if a registration or a pick removes a part of the errors.
    untied: Option<usize>,
    /// Algorithm that bounds the value over all rotations of the tool by the last joint; None if no bound is
    /// known.
    pub(super) spin_bound: Option<SpinBound>,
    /// Whether the value is bit for bit the same after a rotation of the tool by the last joint.
    ignores_spin: bool,
    /// Whether the value is computed with the last joint at theta = 0. In that case, rotations of the tool by
    /// this joint do not change the distribution of the error.
    pub(super) takes_zero_spin: bool,
    /// Whether the errors of the signed sample compensate each other ([`Cell::errors_compensate`]). Such
    /// errors cancel only in the calibrated arm, so their magnitudes are not tolerances.
    pub(super) errors_compensate: bool,
}

/// Working memory of an [`ErrorEvaluator`], reused between postures.
pub struct EvaluatorScratch {
    pub(super) expansion: Expansion,
    pub(super) effects: Effects,
    /// Derivatives of the TCP position for the spin bound and the covariance of normal errors. None if the
    /// spin bound has no position factors ([`SpinBound::factors`]), or if there is no spin bound.
    pub(super) position: Option<Box<Expansion>>,
    pub(super) columns: [Vector6<f64>; MAX_SOURCES],
    distributions: [Distribution; MAX_SOURCES],
    pub(super) scratch: ZonotopeScratch,
    /// Predictor of how sign flips change the error at corners of the tolerance box. None for the linear
    /// model, and if a registration or a pick removes a part of the errors.
    pub(super) flips: Option<Box<FlipPrediction>>,
    /// Algorithm that computes the position error of the nonlinear model at corners of the tolerance box.
    /// None for another model, and if the errors are not tolerances. None also if the equipment has errors,
    /// or if a registration or a pick removes a part of the errors. None also if the algorithm does not
    /// support the error sources.
    pub(super) walk: Option<Box<TwoValuedWalk>>,
    conditional: ConditionalScratch,
    /// Lower bounds of the worst case after rotations of the tool, at the last posture for which they were
    /// prepared.
    pub(super) spun: SpunWorstCase,
    /// Covariance of normal errors as a function of the rotation of the tool, at the last posture for which
    /// it was computed.
    pub(super) covariance: SpinCovariance,
}

impl EvaluatorScratch {
    /// Returns the expansion of the TCP error at the last posture for which effects were computed.
    pub fn expansion(&mut self) -> &mut Expansion {
        &mut self.expansion
    }

    /// Returns the effects at the last posture for which they were computed.
    pub fn effects(&self) -> &Effects {
        &self.effects
    }
}

impl ErrorEvaluator {
    /// Prepares the evaluator of one operation of a cell.
    pub fn new(cell: &Cell, operation: &Operation) -> Self {
        let chain = Chain::new(&cell.robot).with_errors(cell.error_set()).carrying(&operation.held);
        let other = operation.relative_to.map(|k| cell.operations[k].equipment);
        let sources = ErrorSources::new(cell, operation.equipment, other);
        let mean = cell.model != Model::Linear;
        let fits = cell.registration == Registration::BestFit;
        let best_fit = fits.then(|| BestFit::new(&chain, &sources, mean));
        let mut reported = Sense::paper();
        if !reported.contains(&operation.sense) {
            reported.push(operation.sense.clone());
        }
        let signed_values = sources.signed();
        let propagation = ErrorPropagation { chain: &chain, sources: &sources, best_fit: best_fit.as_ref() };
        let signed = propagation.sample(&signed_values, cell.model);
        let means = sources.means().map(|values| {
            let sample = propagation.sample(&values, cell.model);
            (values, sample)
        });
        let placed = [Some(operation.equipment), other];
        let still = placed.into_iter().flatten().all(|e| cell.equipment[e].errors.is_none());
        let is_untied = cell.registration == Registration::None && other.is_none();
        let mut evaluator = Self {
            sense: operation.sense.clone(),
            reported,
            model: cell.model,
            reading: cell.reading,
            quantity: cell.quantity,
            limit: operation.limit,
            chain,
            sources,
            best_fit,
            signed_values,
            errors_compensate: cell.errors_compensate(),
            signed,
            mean: means,
            alone: is_untied && still,
            untied: is_untied.then_some(operation.equipment),
            spin_bound: None,
            ignores_spin: false,
            takes_zero_spin: false,
        };
        let is_behind = evaluator.sources.list.iter().any(|s| is_behind(s.parameter, cell.robot.axes()));
        let turns_with_tool =
            operation.sense.frame == Frame::Tool || operation.sense.point != Vector3::zeros();
        let may_ignore_spin = !turns_with_tool && other.is_none();
        evaluator.takes_zero_spin = may_ignore_spin && is_behind && evaluator.has_isotropic_tool();
        evaluator.ignores_spin = may_ignore_spin && !is_behind || evaluator.takes_zero_spin;
        // The effects at the pick rotate with the tool, so no bound is known for a picked part.
        evaluator.spin_bound = if other.is_none() { evaluator.spin_bound_of() } else { None };
        evaluator
    }

    /// Returns working memory for this evaluator.
    pub fn memory(&self) -> EvaluatorScratch {
        let rows = self.reported.iter().map(|sense| sense.rows().len());
        let components = rows.filter(|_| self.sources.has_bounded()).max().unwrap_or(0);
        let expansion = self.sources.expansion(&self.chain);
        let position = self.spin_bound.as_ref().and_then(SpinBound::factors);
        let flips = self.untied.filter(|_| self.model != Model::Linear);
        let flips = flips.map(|at| Box::new(FlipPrediction::new(&self.sources, &expansion, at)));
        let has_walk = self.alone && self.model == Model::Nonlinear && self.has_tolerances();
        let walk = if has_walk { self.sources.corner_walk(&self.chain) } else { None };
        EvaluatorScratch {
            expansion,
            walk: walk.map(Box::new),
            position: position.map(|factors| Box::new(factors.expansion(&self.chain))),
            flips,
            effects: Effects::default(),
            columns: [Vector6::zeros(); MAX_SOURCES],
            distributions: [Distribution::Normal; MAX_SOURCES],
            scratch: ZonotopeScratch::default(),
            conditional: ConditionalScratch::of_components(components),
            spun: SpunWorstCase::default(),
            covariance: SpinCovariance::default(),
        }
    }

    /// Returns whether [`Self::value`] is bit for bit the same after a rotation of the tool by the last
    /// joint.
    pub fn ignores_spin(&self) -> bool {
        self.ignores_spin
    }

    /// Returns the chain of the robot with the part that it holds at this operation.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// Returns the propagation of parameter errors for this operation.
    pub fn propagation(&self) -> ErrorPropagation<'_> {
        ErrorPropagation { chain: &self.chain, sources: &self.sources, best_fit: self.best_fit.as_ref() }
    }

    /// Computes the first-order effects of the error sources at the posture of a pick. Returns them with the
    /// work frame `site` and the link frames `frames` of this posture.
    pub fn pick_reference(&self, site: WorkFrame, frames: Frames) -> PickReference {
        let mut effects = Effects::default();
        let mut expansion = self.sources.expansion(&self.chain);
        self.propagation().effects_at(&site, &frames, &mut expansion, self.takes_mean(), &mut effects);
        PickReference { site, frames, effects }
    }

    /// Returns whether statistics include the mean error that second-order terms cause.
    pub fn takes_mean(&self) -> bool {
        self.model != Model::Linear
    }

    /// Returns the rows of a sense at a posture: the weighted directions along which the error is measured.
    pub fn measure(&self, sense: &Sense, context: &WorkContext, frames: &Frames) -> SenseRows {
        SenseRows::new(sense, frames, &context.site.world, &context.site.work.rotation)
    }

    /// Returns the figure that the search minimizes: an error (m or rad), or a share of failures.
    pub fn value(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        match self.reading {
            Reading::Signed if self.alone && self.sense.is_of_position() => {
                let e = position_error(frames, self.signed.errors(), self.model);
                self.size_of_position(&e, &context.site.world)
            }
            Reading::Signed => {
                let error = self.signed_error(context, frames, memory);
                self.measure(&self.sense, context, frames).size(&error)
            }
            Reading::WorstCase => {
                self.prepare_effects(context, frames, memory);
                self.worst(&self.sense, context, frames, memory).by_model
            }
            Reading::Statistical if self.takes_zero_spin => {
                let frames = self.chain.with_last_joint_at_zero(frames);
                self.statistical_value(context, &frames, memory)
            }
            Reading::Statistical => self.statistical_value(context, frames, memory),
        }
    }

    /// Returns whether rotations of the tool by the last joint leave the distribution of the TCP position
    /// error unchanged. The TCP displacement that errors after this joint cause must be isotropic about the
    /// tool axis.
    fn has_isotropic_tool(&self) -> bool {
        self.reading == Reading::Statistical
            && self.sense.rows().iter().all(|row| !row.turns)
            && self.chain.tool_spin().is_some()
            && is_isotropic(&self.sources, self.chain.axes(), &self.chain.tool_axis)
    }

    /// Returns the signed sample and the rows of the sense (world frame) in the plain case; otherwise None.
    ///
    /// In the plain case, the reading is signed, the model is nonlinear, and the sense measures the TCP
    /// position. Only the robot has errors, and neither a registration nor a pick removes a part of these
    /// errors. [`Self::value`] is then the root sum square of the nonlinear position error's components along
    /// these rows. The rotation [`WorkFrame::world`] is the only part of the [`WorkContext`] that affects
    /// this result.
    pub fn plain(&self) -> Option<(&Perturbation, Vec<Vector3<f64>>)> {
        let signed = self.reading == Reading::Signed && self.model == Model::Nonlinear;
        let is_plain = signed && self.alone && self.sense.is_of_position();
        let rows = || self.sense.rows().iter().map(|row| row.direction).collect();
        is_plain.then(|| (self.signed.errors(), rows()))
    }

    /// Returns the size of a position error (base frame) in the operation's sense, whose rows must be
    /// directions in the world frame.
    fn size_of_position(&self, e: &Vector3<f64>, world: &Matrix3<f64>) -> f64 {
        let world = world.transpose() * e;
        self.sense.rows().iter().map(|row| row.direction.dot(&world).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns the error of the signed sample by the model of the cell.
    fn signed_error(
        &self,
        context: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Displacement {
        match self.model {
            Model::Linear => self.error_of(&self.signed_values, context, frames, self.model, memory),
            model => self.propagation().error(context, frames, &self.signed, model),
        }
    }

    /// Returns the error of a sample according to a model, in the base frame; `values` holds one value per
    /// source.
    pub fn error_of(
        &self,
        values: &[f64],
        context: &WorkContext,
        frames: &Frames,
        model: Model,
        memory: &mut EvaluatorScratch,
    ) -> Displacement {
        let propagation = self.propagation();
        if model == Model::Linear {
            propagation.effects(context, frames, &mut memory.expansion, false, &mut memory.effects);
            return memory.effects.of_sample(values);
        }
        propagation.error(context, frames, &propagation.sample(values, model), model)
    }

    /// Computes the first-order effects and the mean error at a posture. The figures of every sense follow
    /// from these two results.
    pub fn prepare(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) {
        let mean = self.takes_mean();
        self.propagation().effects(context, frames, &mut memory.expansion, mean, &mut memory.effects);
        if let Some((values, sample)) = &self.mean {
            let error = match self.model {
                Model::Linear => memory.effects.of_sample(values),
                model => self.propagation().error(context, frames, sample, model),
            };
            memory.effects.mean = memory.effects.mean + error;
        }
    }

    /// Computes the first-order effects at a posture without the mean error.
    pub fn prepare_effects(&self, context: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) {
        self.propagation().effects(context, frames, &mut memory.expansion, false, &mut memory.effects);
    }

    /// Returns whether the sources vary about means that are not 0.
    pub fn has_mean(&self) -> bool {
        self.mean.is_some()
    }

    /// Returns the distribution of the size of the error in a [`Sense`]. Call [`Self::prepare`] first.
    pub fn norm<'m>(
        &self,
        sense: &Sense,
        context: &WorkContext,
        frames: &Frames,
        memory: &'m mut EvaluatorScratch,
    ) -> NormLaw<'m> {
        let measure = self.measure(sense, context, frames);
        let mut n = 0;
        let EvaluatorScratch { effects, columns, distributions, conditional, .. } = memory;
        effects.independent(&self.sources, |effect, distribution| {
            (columns[n], distributions[n]) = (measure.column(&effect), distribution);
            n += 1;
        });
        let mean = measure.column(&effects.mean);
        NormLaw::new(measure.rows(), &columns[..n], &distributions[..n], &mean, conditional)
    }

    /// Restricts the reported senses to the sense of the operation, which makes reports several times faster.
    pub fn report_own_sense(&mut self) {
        self.reported = vec![self.sense.clone()];
    }

    /// Returns the index of the operation's sense among the senses in [`ErrorEvaluator::reported`].
    pub fn own(&self) -> usize {
        self.reported.iter().position(|s| *s == self.sense).unwrap_or(0)
    }
}
