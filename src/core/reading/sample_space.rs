//! Random draws of the parameters of all operations of a cell: one draw is one realization of the arm and the
//! equipment.
//!
//! Operations share the parameters of the robot, and the parameters of equipment that they have in common.
//! Each of these parameters has one value per draw, which all operations share.

use super::error_sources::{ErrorSource, ErrorSources};
use super::normal_quantile::normal_quantile;
use crate::cell::{Cell, Distribution, Spread};
use crate::low_discrepancy::richtmyer_steps;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Error parameters of a cell. One random draw gives one value to each of them.
pub struct SampleSpace {
    list: Vec<ErrorSource>,
    /// Independent normal factors of correlated parameters, as in [`ErrorSources::factors`].
    factors: Vec<Vec<(usize, f64)>>,
}

impl SampleSpace {
    /// Returns the parameters of all operations of a cell.
    pub fn of_cell(cell: &Cell) -> Self {
        let sources = cell.operations.iter().map(|operation| {
            let other = operation.relative_to.map(|k| cell.operations[k].equipment);
            ErrorSources::new(cell, operation.equipment, other)
        });
        Self::of(sources)
    }

    /// Returns the union of the parameters of several operations of one cell.
    ///
    /// The source lists of all operations begin with the same robot parameters. The factors refer only to
    /// these parameters, so the factors of one operation suffice.
    pub(super) fn of(operations: impl Iterator<Item = ErrorSources>) -> Self {
        let mut space = Self { list: Vec::new(), factors: Vec::new() };
        for sources in operations {
            for source in &sources.list {
                if space.place(source).is_none() {
                    space.list.push(*source);
                }
            }
            space.factors = sources.factors;
        }
        space
    }

    fn place(&self, source: &ErrorSource) -> Option<usize> {
        self.list.iter().position(|own| own.parameter == source.parameter)
    }

    /// Returns, for each source of an operation, the index of its value in a draw; sources that are not in
    /// the space are left out.
    pub(super) fn places(&self, sources: &ErrorSources) -> Vec<usize> {
        sources.list.iter().filter_map(|source| self.place(source)).collect()
    }
}

/// Stream of draws at the points of a randomly shifted Richtmyer sequence.
pub(super) struct SampleStream<'a> {
    space: &'a SampleSpace,
    /// Coordinate of the current point in the unit cube, and step of the sequence, for each dimension.
    at: Vec<(f64, f64)>,
    values: Vec<f64>,
}

impl<'a> SampleStream<'a> {
    /// Begins the stream of draws of one replicate. The random shift of the sequence depends only on `seed`
    /// and on `replicate`, the index of the replicate.
    pub fn new(space: &'a SampleSpace, seed: u64, replicate: usize) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(replicate as u64);
        let steps = richtmyer_steps().take(space.list.len() + space.factors.len());
        let at = steps.map(|step| (rng.random::<f64>(), step)).collect();
        Self { space, at, values: vec![0.0; space.list.len()] }
    }

    /// Returns the next draw: one value per parameter of the space.
    pub fn next(&mut self) -> &[f64] {
        for (at, step) in &mut self.at {
            *at = (*at + *step).fract();
        }
        let (own, factors) = self.at.split_at(self.space.list.len());
        for ((value, source), (u, _)) in self.values.iter_mut().zip(&self.space.list).zip(own) {
            *value = source.mean + source.spread.map_or(0.0, |spread| drawn(&spread, *u));
        }
        for (factor, (u, _)) in self.space.factors.iter().zip(factors) {
            let z = bounded_normal(*u);
            factor.iter().for_each(|&(k, v)| self.values[k] += v * z);
        }
        &self.values
    }
}

/// Returns the quantile of the distribution of a parameter at the probability `u`.
fn drawn(spread: &Spread, u: f64) -> f64 {
    match spread.distribution {
        Distribution::Normal => spread.deviation() * bounded_normal(u),
        Distribution::Uniform => spread.plus_minus * (2.0 * u - 1.0),
        Distribution::Triangular if u < 0.5 => spread.plus_minus * ((2.0 * u).sqrt() - 1.0),
        Distribution::Triangular => spread.plus_minus * (1.0 - (2.0 - 2.0 * u).sqrt()),
    }
}

/// Returns the standard normal quantile at the probability `u`, clamped away from 0 and 1 to keep it finite.
fn bounded_normal(u: f64) -> f64 {
    normal_quantile(u.clamp(1e-16, 1.0 - 1e-16))
}
