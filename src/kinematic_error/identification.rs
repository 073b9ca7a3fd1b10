//! Can measured poses tell the errors of a chain apart? The identification Jacobian and its condition.
//!
//! Rows: the pose error at every posture, position in m and rotation in rad times a length. Columns:
//! the parameters of a [`ParameterSet`], scaled to unit length, so that m and rad weigh alike (Driels
//! and Pathre 1990 take the condition number; Schroer et al. want it below 100). A chain of n turning
//! joints has 4 n + 6 independent parameters, base and tool included (Everett, Driels and Mooring
//! 1987); the links alone have the 4 n of either set:
//!
//! - four parameters, dq, dr, dl, dalpha of every link: where two neighbouring axes are parallel, dr
//!   of both is the same slide, and near to it the two differ by the angle between the axes alone;
//! - five parameters (Hayati 1983): there dr is replaced by dbeta, the turn that four cannot make.
//!
//! A sliding joint needs less, whatever the lengths: its dr is its dq, and since a slide turns
//! nothing, all slides between two turning joints are vectors of one body, of which three tell all.
//! The rest is left out of both sets, as are the six of every joint frame, which depend
//! on the rows. How a sliding joint is turned about its axis is no parameter here. What else depends shows as it is: coincident axes, postures that do not move a joint.

use super::Expansion;
use crate::cell::{JointKind, MAX_JOINTS, Parameter};
use crate::robot::{Chain, Frames, Posture};
use nalgebra::{DMatrix, Vector3};

/// Sine of the angle below which axes count as parallel (6 degrees): past it dr is ten times worse
/// known than it could be.
const NEARLY_PARALLEL: f64 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterSet {
    FourParameter,
    /// Hayati's.
    FiveParameter,
}

/// The parameters of a set that a chain has, in the order of [`Parameter::of_robot`].
pub fn identifiable(chain: &Chain, set: ParameterSet) -> Vec<Parameter> {
    let axes = chain.axes();
    let next_is_parallel = |i: usize| i + 1 < axes && chain.links[i].sin_alpha.abs() < NEARLY_PARALLEL;
    let fifth = |i: usize| set == ParameterSet::FiveParameter && next_is_parallel(i);
    let is_of_set = |parameter: &Parameter| match *parameter {
        Parameter::Dq(_) | Parameter::Dl(_) | Parameter::Dalpha(_) => true,
        Parameter::Dr(i) => chain.links[i].kind == JointKind::Revolute && !fifth(i),
        Parameter::Dbeta(i) => fifth(i),
        Parameter::Base(_) | Parameter::Tool(_) | Parameter::Joint(..) | Parameter::Equipment(..) => false,
    };
    let mut parameters: Vec<_> = Parameter::of_robot(axes).filter(is_of_set).collect();
    let spare = spare_slides(chain, &parameters);
    parameters.retain(|p| !spare.contains(p));
    parameters
}

/// The identification Jacobian: six rows per posture, a column per parameter, not scaled. `length`
/// (m) says how much a rad of rotation weighs: 1, or the reach of the arm.
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

/// Largest over smallest singular value of the identification Jacobian with columns of unit length;
/// infinite (or beyond 1e12, by rounding) where the postures cannot tell all parameters of the set.
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

/// Those of the slides around every run of sliding joints that others of them make up.
fn spare_slides(chain: &Chain, parameters: &[Parameter]) -> Vec<Parameter> {
    // Within a run nothing turns: any posture shows the angles between its slides.
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
        // What the run before makes up already is there for nothing.
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

/// Along which axis a slide of a link goes: z before it, x after it.
fn direction(frames: &Frames, slide: Parameter) -> Vector3<f64> {
    match slide {
        Parameter::Dl(i) => frames.links[i + 1].rotation.column(0).into_owned(),
        Parameter::Dq(i) | Parameter::Dr(i) => frames.links[i].rotation.column(2).into_owned(),
        _ => Vector3::zeros(),
    }
}
