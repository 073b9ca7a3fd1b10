//! Choice of the parameters that a calibration identifies.

use super::deformed::Deformed;
use super::unknown::Unknown;
use crate::cell::{JointKind, MAX_JOINTS};
use crate::kinematic_error::{ParameterSet, identifiable};
use crate::pose::Pose;
use crate::robot::{Chain, lever};
use nalgebra::{DMatrix, DVector, Vector3};

/// A lever is ignored if it is below this share of the largest lever.
const SHORT_LEVER: f64 = 1.0 / 6.0;

/// Returns the unknowns of a chain, with the elastic terms if `elastic` is true.
///
/// A revolute joint has an elastic term for each link that it carries and whose lever is long. A lever is
/// long if it exceeds a sixth of the longest lever of the arm. The calibration also finds base and reflector
/// of every session. Base and reflector absorb some errors, which are therefore not unknowns. Examples are
/// the errors dq and dr of the first joint, and all errors of the last row.
pub fn unknowns(chain: &Chain, elastic: bool) -> Vec<Unknown> {
    let rows = identifiable(chain, ParameterSet::FiveParameter).into_iter().map(Unknown::Row);
    let frames = FrameMotions::new(chain);
    let rows = rows.filter(|unknown| !frames.absorb(chain, *unknown));
    match elastic {
        true => rows.chain(elastic_terms(chain)).collect(),
        false => rows.collect(),
    }
}

/// Largest share of a displacement that rounding leaves if base and tool absorb the displacement.
const ABSORBED: f64 = 1e-9;
/// Number of sampled postures in which the displacements of unknowns are compared with motions of base and
/// tool.
const COMPARED: usize = 40;

/// Displacements that small motions of base and tool cause in sampled postures.
struct FrameMotions {
    postures: Vec<Deformed>,
    /// Orthonormal basis of the displacements, one column per dimension.
    basis: DMatrix<f64>,
}

impl FrameMotions {
    fn new(chain: &Chain) -> Self {
        let postures: Vec<_> =
            (0..COMPARED).map(|k| Deformed::new(chain, &chain.halton_sample(k), &[], &[])).collect();
        let axis = |k: usize| Vector3::ith(k % 3, 1.0);
        let motion = |k: usize, pose: &Pose| match k {
            0..3 => (axis(k), Vector3::zeros()),
            3..6 => (axis(k).cross(&pose.translation), axis(k)),
            6..9 => (pose.rotation * axis(k), Vector3::zeros()),
            _ => (Vector3::zeros(), pose.rotation * axis(k)),
        };
        let columns = (0..12).map(|k| stacked(&postures, |of| motion(k, &of.interface)));
        let svd = DMatrix::from_columns(&columns.collect::<Vec<_>>()).svd(true, false);
        let rank = svd.rank(ABSORBED * svd.singular_values.max());
        let basis =
            svd.u.map_or_else(|| DMatrix::zeros(6 * COMPARED, 0), |u| u.columns(0, rank).into_owned());
        Self { postures, basis }
    }

    /// Returns whether motions of base and tool cause the same displacements as an unknown.
    fn absorb(&self, chain: &Chain, unknown: Unknown) -> bool {
        let column = stacked(&self.postures, |of| {
            let motion = of.motion(chain, unknown, &of.interface.translation);
            (motion.slope, motion.axis)
        });
        let left = &column - &self.basis * self.basis.tr_mul(&column);
        left.norm() <= ABSORBED * column.norm()
    }
}

/// Returns the displacement and the rotation vector of every posture in one vector. The rotations are
/// multiplied by 1 m.
fn stacked(
    postures: &[Deformed],
    motion: impl Fn(&Deformed) -> (Vector3<f64>, Vector3<f64>),
) -> DVector<f64> {
    let parts = postures.iter().flat_map(|of| {
        let (position, rotation) = motion(of);
        position.iter().chain(rotation.iter()).copied().collect::<Vec<_>>()
    });
    DVector::from_iterator(6 * postures.len(), parts)
}

/// Number of sampled postures in which the levers of the links about the joints are compared.
const POSTURES: usize = 200;

fn elastic_terms(chain: &Chain) -> Vec<Unknown> {
    let axes = chain.axes();
    let mut longest = [[0.0_f64; MAX_JOINTS]; MAX_JOINTS];
    for k in 0..POSTURES {
        let frames = chain.frames(&chain.posture(&chain.halton_sample(k)));
        for joint in (0..axes).filter(|&j| chain.links[j].kind == JointKind::Revolute) {
            for (link, longest) in longest[joint].iter_mut().enumerate().take(axes).skip(joint) {
                *longest = longest.max(lever(&frames, joint, link).abs());
            }
        }
    }
    let short = SHORT_LEVER * longest.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
    let terms = (0..axes).flat_map(|joint| (joint..axes).map(move |link| (joint, link)));
    let terms = terms.filter(|&(joint, link)| longest[joint][link] > short);
    terms.map(|(joint, link)| Unknown::Elastic { joint, link }).collect()
}
