//! Lower bound of the value of a posture over rotations of the tool by the last joint.
//!
//! The last joint rotates the tool about its axis and does not move the TCP. The errors dl, dalpha and dbeta
//! of the last link and all errors of the tool are after this joint. Only the effects of these errors rotate
//! with the tool. The effects of all other errors do not change, unless an error is elastic. If the rotation
//! may change an elastic error, no bound is known.
//!
//! - Signed sample: the errors after the joint displace the TCP by at most r, and the errors before the joint
//!   move the displaced TCP rigidly. So the values after any two rotations differ by at most 2 r.
//! - Worst case: the linear error at a corner with a large error is a lower bound (`spun_worst_case`).
//! - Normal parameters: after a rotation by q, an effect of an error after the joint is c0 + c1 cos q + c2
//!   sin q. So the entries of the covariance are trigonometric polynomials of degree 2. If the mean of an
//!   error is set to 0, no figure increases (T. W. Anderson, Proc. Amer. Math. Soc. 6 (1955) 170-176);
//!   [`CentredBound`] uses this fact.

use super::error_sources::is_behind;
use super::norm::{CentredBound, CovarianceEntries};
use super::position_factors::PositionFactors;
use super::{Effects, ErrorSources, SenseRows};
use crate::cell::{Frame, Quantity, Sense};
use crate::kinematic_error::{Expansion, FrameError, Perturbation};
use crate::pose::Displacement;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3, Vector6};

/// Algorithm that bounds the value of an operation over all rotations of the tool by the last joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum SpinBound {
    /// Bound for a signed sample: the values after any two rotations differ by at most this length, m.
    Signed(f64),
    /// Bound for normal parameters.
    Normal(NormalBound),
    /// Bound for a worst case (`spun_worst_case`).
    WorstCase,
}

/// Lower bound of a figure of the error if all parameters are normal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NormalBound {
    /// Whether a rotation of the tool leaves the effect of each independent random factor unchanged.
    stays: Vec<bool>,
    pub figure: CentredBound,
    /// Factors of the position error. None if the sense also measures rotations, if the equipment has errors,
    /// or if an error is elastic. None also if a registration or a pick removes a part of the errors.
    pub factors: Option<PositionFactors>,
}

/// Entries of the covariance of an error after a rotation of the tool by q: a polynomial in cos q and sin q.
#[derive(Default)]
pub struct SpinCovariance {
    /// Coefficients of 1, cos q, sin q, cos^2 q, cos q sin q and sin^2 q.
    terms: [CovarianceEntries; 6],
    /// Whether any random effect rotates with the tool.
    rotates: bool,
}

impl SpinBound {
    /// Returns the factors from which the bound of a position error is computed. Returns None for a bound
    /// that is computed without such factors.
    pub fn factors(&self) -> Option<&PositionFactors> {
        match self {
            Self::Normal(bound) => bound.factors.as_ref(),
            Self::Signed(_) | Self::WorstCase => None,
        }
    }

    /// Returns the bound for the position error of a signed sample. The sense must measure only positions,
    /// along directions in world axes.
    pub fn of_sample(chain: &Chain, errors: &Perturbation, sense: &Sense) -> Self {
        let rows = sense.rows().iter().map(|row| row.direction);
        let gram = rows.fold(Matrix3::zeros(), |sum: Matrix3<f64>, d: Vector3<f64>| sum + d * d.transpose());
        let largest = gram.symmetric_eigenvalues().max().max(0.0).sqrt();
        Self::Signed(2.0 * largest * displacement_behind(chain, errors))
    }

    /// Returns the bound of a quantity of random errors in a sense; None if no bound is known.
    ///
    /// `is_alone` is true if only the robot has errors, and neither a registration nor a pick removes a part
    /// of these errors.
    pub fn of_statistics(
        chain: &Chain,
        sources: &ErrorSources,
        sense: &Sense,
        quantity: Quantity,
        is_alone: bool,
    ) -> Option<Self> {
        if sources.has_bounded() || sense.frame == Frame::Tool || sense.point != Vector3::zeros() {
            return None;
        }
        let figure = CentredBound::new(quantity, sense.rows().len())?;
        let stays = |source: &usize| !is_behind(sources.list[*source].parameter, chain.axes());
        let factors = sources.independent();
        let stays = factors.iter().map(|f| f.iter().all(|(source, _)| stays(source))).collect();
        let is_plain = is_alone && sense.rows().iter().all(|row| !row.turns);
        let factors = if is_plain { PositionFactors::new(chain, sources) } else { None };
        Some(Self::Normal(NormalBound { stays, figure, factors }))
    }
}

impl NormalBound {
    /// Returns the covariance of the position error as a function of the rotation of the tool about `axis`
    /// (base frame), from the factors of the position error.
    ///
    /// `expansion` must be the result of [`PositionFactors::expansion`].
    pub fn covariance_of_position(
        factors: &PositionFactors,
        frames: &Frames,
        expansion: &mut Expansion,
        measure: &SenseRows,
        axis: &Vector3<f64>,
    ) -> SpinCovariance {
        let rows = measure.position_rows();
        let c = rows * factors.covariance(frames, expansion) * rows.transpose();
        let mut covariance = SpinCovariance::default();
        covariance.terms[0] = [c.m11, c.m22, c.m33, c.m12, c.m13, c.m23];
        for effect in factors.rotating(expansion) {
            let along = axis * axis.dot(&effect);
            let each = [along, effect - along, axis.cross(&effect)];
            covariance.add_rotating(each.map(|v| <[f64; 3]>::from(rows * v)));
        }
        covariance
    }

    /// Returns the covariance of the error as a function of the rotation of the tool about `axis` (base
    /// frame).
    ///
    /// `effects` are the effects before the rotation.
    pub fn covariance(
        &self,
        effects: &Effects,
        sources: &ErrorSources,
        measure: &SenseRows,
        axis: &Vector3<f64>,
    ) -> SpinCovariance {
        let (mut covariance, mut stays) = (SpinCovariance::default(), self.stays.iter());
        effects.independent(sources, |effect, _| match stays.next() {
            Some(true) => covariance.add(&first_three(measure.column(&effect))),
            _ => covariance.add_rotating(rotating_parts(&effect, axis, measure).map(first_three)),
        });
        covariance
    }
}

impl SpinCovariance {
    /// Adds a random effect that does not rotate with the tool.
    fn add(&mut self, effect: &[f64; 3]) {
        add_product(&mut self.terms[0], effect, effect);
    }

    /// Adds a random effect that rotates with the tool. The argument holds the constant part of the effect
    /// and the coefficients of cos q and sin q.
    fn add_rotating(&mut self, [still, cos, sin]: [[f64; 3]; 3]) {
        self.rotates = true;
        let [one, of_cos, of_sin, of_cos2, of_both, of_sin2] = &mut self.terms;
        add_product(one, &still, &still);
        for (term, factor) in [(of_cos, &cos), (of_sin, &sin)] {
            add_product(term, &still, factor);
            add_product(term, factor, &still);
        }
        add_product(of_cos2, &cos, &cos);
        add_product(of_both, &cos, &sin);
        add_product(of_both, &sin, &cos);
        add_product(of_sin2, &sin, &sin);
    }

    /// Returns whether the covariance depends on the rotation of the tool.
    pub fn rotates(&self) -> bool {
        self.rotates
    }

    /// Returns the covariance after a rotation with the given cosine and sine.
    pub fn at(&self, (cos, sin): (f64, f64)) -> CovarianceEntries {
        if !self.rotates {
            return self.terms[0];
        }
        let powers = [1.0, cos, sin, cos * cos, cos * sin, sin * sin];
        std::array::from_fn(|k| powers.iter().zip(&self.terms).map(|(power, term)| power * term[k]).sum())
    }
}

/// Returns the components of an effect that rotates with the tool about `axis`: the constant part, and the
/// coefficients of cos q and sin q.
pub(super) fn rotating_parts(
    effect: &Displacement,
    axis: &Vector3<f64>,
    measure: &SenseRows,
) -> [Vector6<f64>; 3] {
    let Displacement { position, rotation } = effect;
    let along = |v: &Vector3<f64>| axis * axis.dot(v);
    let still = Displacement { position: along(position), rotation: along(rotation) };
    let of_sin = Displacement { position: axis.cross(position), rotation: axis.cross(rotation) };
    [still, *effect - still, of_sin].map(|part| measure.column(&part))
}

/// Adds the symmetric part of the outer product of two vectors to `sum`.
fn add_product(sum: &mut CovarianceEntries, a: &[f64; 3], b: &[f64; 3]) {
    for (entry, (i, j)) in sum.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
        *entry += a[i] * b[j];
    }
}

/// Returns the first three components of a column.
fn first_three(column: Vector6<f64>) -> [f64; 3] {
    [column[0], column[1], column[2]]
}

/// Returns an upper bound of the displacement of the TCP, m, that errors after the last joint cause.
fn displacement_behind(chain: &Chain, errors: &Perturbation) -> f64 {
    let lever = chain.tool.translation.norm();
    let mut moved = 0.0;
    if let Some(FrameError { slides, turns }) = &errors.tool {
        turns.iter().for_each(|turn| moved += turn.angle.abs() * moved);
        moved += Vector3::from(*slides).norm();
    }
    if let Some(last) = errors.links().last() {
        [last.dbeta, last.dalpha].iter().for_each(|turn| moved += turn.angle.abs() * (lever + moved));
        moved += last.dl.abs();
    }
    moved
}
