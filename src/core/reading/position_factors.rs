//! Covariance of the TCP position error to first order, from independent random factors of the robot alone.
//!
//! The covariance is a sum of outer products, one per factor. Consider three sources that displace one frame
//! along its three axes with equal standard deviations. Together they add the same variance in every
//! direction and need no outer products.

use super::error_sources::{ErrorSources, is_behind};
use crate::cell::{PER_FRAME, PER_LINK, Parameter};
use crate::kinematic_error::Expansion;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// Independent random factors. Each factor is a list of the motions that it causes: index, and size at one
/// standard deviation.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PositionFactors {
    /// Factors whose effect does not change when the last joint rotates the tool.
    staying: Vec<Vec<(usize, f64)>>,
    /// Factors whose effect rotates with the tool.
    rotating: Vec<Vec<(usize, f64)>>,
    /// Variance in every direction, m^2, that sets of three other factors add. Each set displaces one frame
    /// along its three axes with equal standard deviations.
    everywhere: f64,
    /// Parameters (indices) whose motions the factors need.
    parameters: Vec<usize>,
    /// Root sum square of the standard deviations (rad) of all rotations; None if a factor causes several
    /// motions.
    turned: Option<f64>,
}

impl PositionFactors {
    /// Returns the factors of `sources`; None if a source belongs to equipment or is elastic.
    pub fn new(chain: &Chain, sources: &ErrorSources) -> Option<Self> {
        let axes = chain.axes();
        let (tool, all) = (PER_LINK * axes + PER_FRAME, Expansion::new(chain));
        let mut factors: Vec<(bool, Vec<(usize, f64)>)> = Vec::new();
        let mut parameters = Vec::new();
        for factor in sources.independent() {
            let mut motions = Vec::new();
            for &(source, size) in &factor {
                let parameter = sources.robot_index(source)?;
                if parameter >= Parameter::first_elastic(axes) {
                    return None;
                }
                motions.extend(all.motions(parameter).map(|(k, per_unit)| (k, per_unit * size)));
                parameters.push(parameter);
            }
            // A rotation of the tool frame about the TCP leaves the TCP in place.
            motions.retain(|(k, _)| !(tool + 3..tool + PER_FRAME).contains(k));
            let rotates = factor.iter().any(|(source, _)| is_behind(sources.list[*source].parameter, axes));
            factors.push((rotates, motions));
        }
        let mut everywhere = 0.0;
        let frames = [PER_LINK * axes, tool].into_iter();
        let first_joint = Parameter::first_joint(axes);
        for first in frames.chain((0..axes).map(|joint| first_joint + PER_FRAME * joint)) {
            let is_of = |motions: &[(usize, f64)], k: usize| matches!(motions, [(own, _)] if *own == k);
            let variance = |k: usize| {
                let alone = factors.iter().filter(|(_, motions)| is_of(motions, k));
                alone.map(|(_, motions)| motions[0].1.powi(2)).sum::<f64>()
            };
            let [x, y, z] = [0, 1, 2].map(|component| variance(first + component));
            if x == y && y == z {
                everywhere += x;
                factors.retain(|(_, motions)| (first..first + 3).all(|k| !is_of(motions, k)));
            }
        }
        let is_needed = |p: &usize| {
            let motions: Vec<usize> = all.motions(*p).map(|motion| motion.0).collect();
            factors.iter().any(|(_, factor)| factor.iter().any(|(k, _)| motions.contains(k)))
        };
        parameters.retain(is_needed);
        factors.retain(|(_, motions)| !motions.is_empty());
        let is_single = factors.iter().all(|(_, motions)| motions.len() == 1);
        let motions = factors.iter().flat_map(|(_, motions)| motions);
        let turned = motions.filter(|(k, _)| is_rotation(*k, axes)).map(|(_, size)| size * size).sum::<f64>();
        let turned = is_single.then(|| turned.sqrt());
        let (rotating, staying): (Vec<_>, Vec<_>) = factors.into_iter().partition(|(rotates, _)| *rotates);
        let [rotating, staying] = [rotating, staying].map(|all| all.into_iter().map(|f| f.1).collect());
        Some(Self { staying, rotating, everywhere, parameters, turned })
    }

    /// Returns an expansion with the derivatives that the factors need.
    pub fn expansion(&self, chain: &Chain) -> Expansion {
        Expansion::of(chain, &self.parameters)
    }

    /// Returns the covariance (base frame, m^2) of the effects that a rotation of the tool does not change.
    pub fn covariance(&self, frames: &Frames, expansion: &mut Expansion) -> Matrix3<f64> {
        expansion.set(frames);
        let [mut xx, mut yy, mut zz] = [self.everywhere; 3];
        let (mut xy, mut xz, mut yz) = (0.0, 0.0, 0.0);
        for factor in &self.staying {
            let e = effect(factor, expansion);
            (xx, yy, zz) = (xx + e.x * e.x, yy + e.y * e.y, zz + e.z * e.z);
            (xy, xz, yz) = (xy + e.x * e.y, xz + e.x * e.z, yz + e.y * e.z);
        }
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }

    /// Returns an upper bound, m, of the mean of the second-order terms of the TCP position; None if no bound
    /// is known. `covariance` is the sum of the outer products of all effects, m^2.
    ///
    /// Let g be the derivative of the TCP position with respect to a rotation. Let sigma be the standard
    /// deviation of this rotation. The second derivative is at most as long as g. So the mean is at most
    /// `1/2 sum sigma^2 |g|`, and the Cauchy-Schwarz inequality bounds this sum.
    pub fn most_mean(&self, covariance: &Matrix3<f64>) -> Option<f64> {
        Some(self.turned? * covariance.trace().max(0.0).sqrt() / 2.0)
    }

    /// Returns the effects (base frame, m) that rotate with the tool, at the posture of the last call of
    /// [`Self::covariance`].
    pub fn rotating<'a>(&'a self, expansion: &'a Expansion) -> impl Iterator<Item = Vector3<f64>> + 'a {
        self.rotating.iter().map(|factor| effect(factor, expansion))
    }
}

/// Returns whether a motion is a rotation; `k` is its index in the order of [`Parameter::of_robot`].
fn is_rotation(k: usize, axes: usize) -> bool {
    match k.checked_sub(PER_LINK * axes) {
        None => matches!(k % PER_LINK, 0 | 3 | 4),
        Some(of_frame) => of_frame % PER_FRAME >= 3,
    }
}

/// Returns the effect of a factor on the TCP position, m.
#[inline]
fn effect(factor: &[(usize, f64)], expansion: &Expansion) -> Vector3<f64> {
    factor.iter().fold(Vector3::zeros(), |sum, &(k, size)| sum + expansion.term(k).g * size)
}
