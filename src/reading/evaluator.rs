//! What a posture is worth to an operation: one number for the search, every figure for the map.

use super::error_propagation::{ErrorPropagation, PreparedSample};
use super::error_sources::ErrorSources;
use super::figures::{Figures, PostureErrors};
use super::norm::NormDistribution;
use super::registration::BestFit;
use super::work_context::{PickReference, WorkContext, WorkFrame};
use super::worst_case::{WorstCase, by_model, farthest};
use super::zonotope::{Farthest, ZonotopeScratch};
use super::{Effects, MAX_SOURCES, SenseRows};
use crate::cell::{Cell, Model, Operation, Quantity, Reading, Registration, Sense};
use crate::kinematic_error::{Expansion, Perturbation, position_error};
use crate::pose::Displacement;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3, Vector6};

/// One operation's way to judge a posture.
#[derive(Debug, Clone)]
pub struct ErrorEvaluator {
    chain: Chain,
    pub sources: ErrorSources,
    best_fit: Option<BestFit>,
    pub sense: Sense,
    /// Senses in which every node is reported: the paper's and the operation's own.
    pub reported: Vec<Sense>,
    pub model: Model,
    pub reading: Reading,
    pub quantity: Quantity,
    pub limit: Option<f64>,
    /// The signed sample, by the model of the cell.
    signed_values: Vec<f64>,
    signed: PreparedSample,
    /// Whether nothing but the robot is wrong and nothing is taken off.
    alone: bool,
}

/// Memory kept from posture to posture.
pub struct EvaluatorScratch {
    expansion: Expansion,
    effects: Effects,
    columns: [Vector6<f64>; MAX_SOURCES],
    kurtosis: [f64; MAX_SOURCES],
    scratch: ZonotopeScratch,
}

impl EvaluatorScratch {
    pub fn expansion(&mut self) -> &mut Expansion {
        &mut self.expansion
    }

    /// The effects of the posture last prepared.
    pub fn effects(&self) -> &Effects {
        &self.effects
    }
}

impl ErrorEvaluator {
    pub fn new(cell: &Cell, operation: &Operation) -> Self {
        let chain = Chain::new(&cell.robot);
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
        let theory = ErrorPropagation { chain: &chain, sources: &sources, best_fit: best_fit.as_ref() };
        let signed = theory.sample(&signed_values, cell.model);
        let placed = [Some(operation.equipment), other];
        let still = placed.into_iter().flatten().all(|e| cell.equipment[e].errors.is_none());
        let alone = cell.registration == Registration::None && still && other.is_none();
        Self {
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
            signed,
            alone,
        }
    }

    pub fn memory(&self) -> EvaluatorScratch {
        EvaluatorScratch {
            expansion: self.sources.expansion(&self.chain),
            effects: Effects::default(),
            columns: [Vector6::zeros(); MAX_SOURCES],
            kurtosis: [0.0; MAX_SOURCES],
            scratch: ZonotopeScratch::default(),
        }
    }

    pub fn theory(&self) -> ErrorPropagation<'_> {
        ErrorPropagation { chain: &self.chain, sources: &self.sources, best_fit: self.best_fit.as_ref() }
    }

    /// Returns a pick at `frames`, with its effects as the evaluator of the placing operation sees them.
    pub fn pick_reference(&self, site: WorkFrame, frames: Frames) -> PickReference {
        let mut effects = Effects::default();
        let mut expansion = self.sources.expansion(&self.chain);
        self.theory().site_effects(&site, &frames, &mut expansion, self.takes_mean(), &mut effects);
        PickReference { site, frames, effects }
    }

    /// Whether second-order means count.
    pub fn takes_mean(&self) -> bool {
        self.model != Model::Linear
    }

    pub fn measure(&self, sense: &Sense, situation: &WorkContext, frames: &Frames) -> SenseRows {
        SenseRows::new(sense, frames, &situation.site.world, &situation.site.work.rotation)
    }

    /// What the search makes small: an error (m or rad), or a share of failures.
    pub fn value(&self, situation: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) -> f64 {
        match self.reading {
            Reading::Signed if self.alone && self.sense.is_of_position() => {
                let e = position_error(frames, self.signed.errors(), self.model);
                self.size_of_position(&e, &situation.site.world)
            }
            Reading::Signed => {
                let error = self.signed_error(situation, frames, memory);
                self.measure(&self.sense, situation, frames).size(&error)
            }
            Reading::WorstCase => {
                self.prepare(situation, frames, memory);
                self.worst(&self.sense, situation, frames, memory).by_model
            }
            Reading::Statistical => {
                self.prepare(situation, frames, memory);
                let norm = self.norm(&self.sense, situation, frames, memory);
                match self.quantity {
                    Quantity::Rms => norm.rms(),
                    Quantity::Mean => norm.mean(),
                    Quantity::P95 => norm.quantile(0.95),
                    Quantity::P99 => norm.quantile(0.99),
                    Quantity::Yield => 1.0 - self.limit.map_or(1.0, |limit| norm.cdf(limit)),
                }
            }
        }
    }

    /// The sample and the rows of the sense (world frame), where [`Self::value`] is the size of the position
    /// error of the TCP in them by the nonlinear model, whatever the situation.
    pub fn plain(&self) -> Option<(&Perturbation, Vec<Vector3<f64>>)> {
        let signed = self.reading == Reading::Signed && self.model == Model::Nonlinear;
        let is_plain = signed && self.alone && self.sense.is_of_position();
        let rows = || self.sense.rows().iter().map(|row| row.direction).collect();
        is_plain.then(|| (self.signed.errors(), rows()))
    }

    /// Rows of a plain sense on a position error of the base frame.
    fn size_of_position(&self, e: &Vector3<f64>, world: &Matrix3<f64>) -> f64 {
        let world = world.transpose() * e;
        self.sense.rows().iter().map(|row| row.direction.dot(&world).powi(2)).sum::<f64>().sqrt()
    }

    /// The error of the signed sample by the model of the cell.
    fn signed_error(
        &self,
        situation: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> Displacement {
        match self.model {
            Model::Linear => self.error_of(&self.signed_values, situation, frames, self.model, memory),
            model => self.theory().error(situation, frames, &self.signed, model),
        }
    }

    /// The error of a sample by a model, one value per source, base frame.
    pub fn error_of(
        &self,
        values: &[f64],
        situation: &WorkContext,
        frames: &Frames,
        model: Model,
        memory: &mut EvaluatorScratch,
    ) -> Displacement {
        let theory = self.theory();
        if model == Model::Linear {
            theory.effects(situation, frames, &mut memory.expansion, false, &mut memory.effects);
            return memory.effects.of_sample(values);
        }
        theory.error(situation, frames, &theory.sample(values, model), model)
    }

    /// Effects at a posture, for every sense at once.
    pub fn prepare(&self, situation: &WorkContext, frames: &Frames, memory: &mut EvaluatorScratch) {
        let mean = self.takes_mean();
        self.theory().effects(situation, frames, &mut memory.expansion, mean, &mut memory.effects);
    }

    /// The worst case in a sense; after [`Self::prepare`].
    pub fn worst(
        &self,
        sense: &Sense,
        situation: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> WorstCase {
        let measure = self.measure(sense, situation, frames);
        let n = self.sources.list.len();
        if self.model == Model::Linear {
            let (linear, corner) = self.linear_corner(&measure, memory);
            let exact = linear.upper <= linear.value;
            let linear = linear.upper.max(linear.value);
            return WorstCase { linear, exact, by_model: linear, corner };
        }
        let largest = self.largest(memory);
        let (linear, corner) = self.linear_corner(&measure, memory);
        let (theory, columns) = (self.theory(), &memory.columns[..n]);
        let mut values = [0.0; MAX_SOURCES];
        by_model(columns, &linear, self.quadratic(&memory.effects), &largest, corner, |signs| {
            self.corner(signs, &mut values);
            if self.alone && measure.is_of_position() {
                let errors = self.sources.perturbation(&self.chain, &values[..n]);
                return measure.size_of_position(&position_error(frames, &errors, self.model));
            }
            let sample = theory.sample(&values[..n], self.model);
            measure.size(&theory.error(situation, frames, &sample, self.model))
        })
    }

    /// The corners of the largest displacement of the TCP and of the largest turn.
    fn largest(&self, memory: &mut EvaluatorScratch) -> [[f64; MAX_SOURCES]; 2] {
        [false, true].map(|turns| {
            for (k, source) in self.sources.list.iter().enumerate() {
                let effect = &memory.effects.columns[k];
                let v = if turns { effect.rotation } else { effect.position } * source.plus_minus;
                memory.columns[k] = Vector6::new(v.x, v.y, v.z, 0.0, 0.0, 0.0);
            }
            let mut corner = [1.0; MAX_SOURCES];
            let n = self.sources.list.len();
            farthest(&memory.columns[..n], 3, &mut memory.scratch, &mut corner[..n]);
            corner
        })
    }

    /// The size of products of errors: what a typical turn of the box does to a typical displacement.
    fn quadratic(&self, effects: &Effects) -> f64 {
        let pairs = self.sources.list.iter().zip(&effects.columns);
        let (turn, shift) = pairs.fold((0.0, 0.0), |(turn, shift), (source, effect)| {
            let [w, d] =
                [effect.rotation, effect.position].map(|v| v.norm_squared() * source.plus_minus.powi(2));
            (turn + w, shift + d)
        });
        (turn * shift).sqrt()
    }

    /// The farthest corner by the linear model, one sign per source; after [`Self::prepare`].
    pub fn linear_corner(
        &self,
        measure: &SenseRows,
        memory: &mut EvaluatorScratch,
    ) -> (Farthest, [f64; MAX_SOURCES]) {
        for (k, source) in self.sources.list.iter().enumerate() {
            memory.columns[k] = measure.column(&(memory.effects.columns[k] * source.plus_minus));
        }
        let mut corner = [0.0; MAX_SOURCES];
        let n = self.sources.list.len();
        let found = farthest(&memory.columns[..n], measure.rows(), &mut memory.scratch, &mut corner[..n]);
        (found, corner)
    }

    /// Values of the sources at a corner of the box.
    pub fn corner(&self, signs: &[f64], values: &mut [f64]) {
        for ((value, source), sign) in values.iter_mut().zip(&self.sources.list).zip(signs) {
            *value = source.plus_minus * sign;
        }
    }

    /// The distribution of the error's size in a sense; after [`Self::prepare`].
    pub fn norm(
        &self,
        sense: &Sense,
        situation: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> NormDistribution {
        let measure = self.measure(sense, situation, frames);
        let mut n = 0;
        let EvaluatorScratch { effects, columns, kurtosis, .. } = memory;
        effects.independent(&self.sources, |effect, excess| {
            (columns[n], kurtosis[n]) = (measure.column(&effect), excess);
            n += 1;
        });
        NormDistribution::new(measure.rows(), &columns[..n], &kurtosis[..n], &measure.column(&effects.mean))
    }

    /// Everything about a posture, in every reported sense.
    pub fn judge(
        &self,
        situation: &WorkContext,
        frames: &Frames,
        memory: &mut EvaluatorScratch,
    ) -> PostureErrors {
        self.prepare(situation, frames, memory);
        let each = |sense: &Sense| self.worst(sense, situation, frames, memory);
        let worst: Vec<_> = self.reported.iter().map(each).collect();
        let each = |sense: &Sense| self.norm(sense, situation, frames, memory);
        let norms: Vec<_> = self.reported.iter().map(each).collect();
        let own = self.own();
        let success = self.limit.map(|limit| norms[own].cdf(limit));
        let mut values = [0.0; MAX_SOURCES];
        match self.reading {
            Reading::Signed => values[..self.signed_values.len()].copy_from_slice(&self.signed_values),
            _ => self.corner(&worst[own].corner, &mut values),
        }
        let values = &values[..self.sources.list.len()];
        let [nonlinear, linear, second_order] = [Model::Nonlinear, Model::Linear, Model::SecondOrder]
            .map(|model| self.error_of(values, situation, frames, model, memory));
        let error = match self.model {
            Model::Nonlinear => nonlinear,
            Model::Linear => linear,
            Model::SecondOrder => second_order,
        };
        let figures =
            self.reported.iter().zip(worst.iter().zip(&norms)).map(|(sense, (worst, norm))| Figures {
                error: self.measure(sense, situation, frames).size(&error),
                worst_linear: worst.linear,
                worst: worst.by_model,
                rms: norm.rms(),
                mean: norm.mean(),
                p95: norm.quantile(0.95),
                p99: norm.quantile(0.99),
            });
        let figures: Vec<Figures> = figures.collect();
        let value = match (self.reading, self.quantity) {
            (Reading::Signed, _) => self.value(situation, frames, memory),
            (Reading::Statistical, Quantity::Yield) => 1.0 - success.unwrap_or(1.0),
            (reading, quantity) => figures[own].in_reading(reading, quantity),
        };
        PostureErrors { value, error, nonlinear, linear, second_order, figures, success }
    }

    /// From now on postures are judged in the operation's own sense alone: several times faster.
    pub fn report_own_sense(&mut self) {
        self.reported = vec![self.sense.clone()];
    }

    /// Place of the operation's sense among the reported ones.
    pub fn own(&self) -> usize {
        self.reported.iter().position(|s| *s == self.sense).unwrap_or(0)
    }
}
