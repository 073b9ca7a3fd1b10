//! Identifiability of parameter errors from measured poses: the identification Jacobian and its condition.
//!
//! The rows of the Jacobian are the pose errors at every posture: position in m, rotation in rad times a
//! length. The columns are the parameters of a [`ParameterSet`]. The columns are scaled to unit length, so m
//! and rad have equal weight. Driels and Pathre (1990) judge a set of poses by the condition number of this
//! matrix. Schroer et al. require a value below 100.
//!
//! A chain of n revolute joints has 4 n + 6 independent parameters, base and tool included (Everett, Driels
//! and Mooring 1987). The links alone have 4 n parameters in each of the following two sets:
//!
//! - four parameters per link. These parameters are the errors dq of the joint coordinate, dr of the axial
//!   offset, dl of the length and dalpha of the twist. If two neighbouring axes are parallel, their errors dr
//!   are the same translation. If the axes are nearly parallel, the two translations differ only by the small
//!   angle between the axes;
//! - five parameters (Hayati 1983): where axes are parallel, dbeta replaces dr. The error dbeta is the
//!   rotation about the y axis after the link, which the other four parameters cannot produce.
//!
//! A prismatic joint has fewer independent parameters. The error dr of a prismatic joint is the same
//! translation as the error dq. The joint rotates nothing, so all translations between two revolute joints
//! are constant vectors in one frame. At most three of these vectors are independent. Both sets leave out the
//! dependent translations. Both sets also leave out the six parameters of every joint frame, because these
//! parameters depend on the parameters of the D-H rows. Neither set has a parameter for the rotation of a
//! prismatic joint about its axis. Other dependencies increase the condition number, for example coincident
//! axes, or postures that do not move a joint.

use super::Expansion;
use crate::cell::{JointKind, MAX_JOINTS, Parameter};
use crate::robot::{Chain, Frames, Posture};
use nalgebra::{DMatrix, Vector3};

/// Axes count as parallel if the sine of their angle is below this value (6 degrees).
///
/// At smaller angles, the uncertainty of the offset error dr would be more than ten times as large as for
/// perpendicular axes.
const NEARLY_PARALLEL: f64 = 0.1;

/// Parameters per link that a calibration identifies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterSet {
    /// Errors dq, dr, dl and dalpha of every link (Denavit and Hartenberg).
    FourParameter,
    /// Errors of the four-parameter set, with dbeta instead of dr where neighbouring axes are parallel
    /// (Hayati 1983).
    FiveParameter,
}

/// Returns the linearly independent parameters of a set for a chain, in the order of [`Parameter::of_robot`].
pub fn identifiable(chain: &Chain, set: ParameterSet) -> Vec<Parameter> {
    let axes = chain.axes();
    let next_is_parallel = |i: usize| i + 1 < axes && chain.links[i].sin_alpha.abs() < NEARLY_PARALLEL;
    let fifth = |i: usize| set == ParameterSet::FiveParameter && next_is_parallel(i);
    let is_of_set = |parameter: &Parameter| match *parameter {
        Parameter::Dq(_) | Parameter::Dl(_) | Parameter::Dalpha(_) => true,
        Parameter::Dr(i) => chain.links[i].kind == JointKind::Revolute && !fifth(i),
        Parameter::Dbeta(i) => fifth(i),
        Parameter::Base(_) | Parameter::Tool(_) | Parameter::Joint(..) => false,
        Parameter::Elastic(..)
        | Parameter::Compliance(_)
        | Parameter::Periodic(_)
        | Parameter::Equipment(..) => false,
    };
    let mut parameters: Vec<_> = Parameter::of_robot(axes).filter(is_of_set).collect();
    let spare = spare_slides(chain, &parameters);
    parameters.retain(|p| !spare.contains(p));
    parameters
}

/// Returns the identification Jacobian: six rows per posture, one unscaled column per parameter.
///
/// For each posture, the three rows of the rotation error are multiplied by `length` (m), for example 1 m or
/// the reach of the arm.
pub fn identification_jacobian(
    chain: &Chain,
    postures: &[Posture],
    parameters: &[Parameter],
    length: f64,
) -> DMatrix<f64> {
    let all: Vec<_> = Parameter::of_robot(chain.axes()).collect();
    let places = parameters.iter().filter_map(|p| all.iter().position(|a| a == p));
    let places: Vec<usize> = places.collect();
    let mut jacobian = DMatrix::zeros(6 * postures.len(), places.len());
    let mut expansion = Expansion::of(chain, &places);
    for (i, posture) in postures.iter().enumerate() {
        expansion.set(&chain.frames(posture));
        for (column, place) in places.iter().enumerate() {
            let error = expansion.first(*place);
            jacobian.fixed_view_mut::<3, 1>(6 * i, column).copy_from(&error.position);
            jacobian.fixed_view_mut::<3, 1>(6 * i + 3, column).copy_from(&(error.rotation * length));
        }
    }
    jacobian
}

/// Returns the condition number of the identification Jacobian with columns scaled to unit length.
///
/// For each posture, the three rows of the rotation error are multiplied by `length` (m). If the postures
/// cannot identify all parameters of the set, the condition number is infinite, or above 1e12 because of
/// rounding.
pub fn condition(chain: &Chain, postures: &[Posture], set: ParameterSet, length: f64) -> f64 {
    let mut jacobian = identification_jacobian(chain, postures, &identifiable(chain, set), length);
    if jacobian.nrows() < jacobian.ncols() {
        return f64::INFINITY;
    }
    for mut column in jacobian.column_iter_mut() {
        let size = column.norm();
        if size == 0.0 || !size.is_finite() {
            return f64::INFINITY;
        }
        column /= size;
    }
    let values = jacobian.singular_values();
    values.max() / values.min()
}

/// Returns the translational parameters that depend linearly on other parameters at prismatic joints.
///
/// The function treats each run of successive prismatic joints as a whole. A run may be a single joint.
fn spare_slides(chain: &Chain, parameters: &[Parameter]) -> Vec<Parameter> {
    // No link rotates within a run of prismatic joints, so the angles between the translations are the same
    // in every posture.
    let frames = chain.frames(&chain.posture(&[0.0; MAX_JOINTS]));
    let slides = |i: usize| chain.links[i].kind == JointKind::Prismatic;
    let mut spare = Vec::new();
    for first in (0..chain.axes()).filter(|&i| slides(i) && (i == 0 || !slides(i - 1))) {
        let end = (first..chain.axes()).find(|&i| !slides(i)).unwrap_or(chain.axes());
        let mut run: Vec<_> = (first..end).map(Parameter::Dq).collect();
        if let Some(before) = first.checked_sub(1) {
            run.extend([Parameter::Dl(before), Parameter::Dr(before)]);
        }
        run.push(Parameter::Dr(end));
        run.extend((first..end).map(Parameter::Dl));
        run.retain(|p| parameters.contains(p));
        // Translations that an earlier run left out come first, because the parameters of that run already
        // produce them.
        run.sort_by_key(|p| !spare.contains(p));
        let mut basis: Vec<Vector3<f64>> = Vec::new();
        for parameter in run {
            let along = direction(&frames, parameter);
            let new = basis.iter().fold(along, |rest, b| rest - b * b.dot(&rest));
            match new.norm() > NEARLY_PARALLEL {
                true => basis.push(new.normalize()),
                false => spare.push(parameter),
            }
        }
    }
    spare
}

/// Returns the direction of a translational parameter, in the base frame.
///
/// The direction is the z axis before the link for dr and dq, and the x axis after the link for dl.
fn direction(frames: &Frames, slide: Parameter) -> Vector3<f64> {
    match slide {
        Parameter::Dl(i) => frames.links[i + 1].rotation.column(0).into_owned(),
        Parameter::Dq(i) | Parameter::Dr(i) => frames.links[i].rotation.column(2).into_owned(),
        _ => Vector3::zeros(),
    }
}
