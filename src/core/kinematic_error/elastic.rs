//! Elastic errors: deflections of revolute joints by gravity, which depend on the posture.
//!
//! An elastic parameter turns one joint by its value times a factor of the posture, which is a lever (m) or a
//! torque (N m). The factor is that of the chain without errors. Other errors change it by a share of their own
//! size, so what is left out is of second order in the errors, and every model leaves it out alike.

use crate::cell::{MAX_JOINTS, Parameter};
use crate::robot::{Chain, Frames, Loads, gravity_torque, lever};

/// Elastic parameters of one sample of errors, for one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticErrors {
    /// Parameters whose value is not 0, with these values (rad/m or rad/(N m)).
    values: Vec<(Parameter, f64)>,
    loads: Loads,
}

impl ElasticErrors {
    /// Returns the elastic errors with the given values of [`Parameter::elastic`]; None if all are 0.
    pub fn new(chain: &Chain, values: &[f64]) -> Option<Self> {
        let all = Parameter::elastic(chain.axes()).zip(values.iter().copied());
        let values: Vec<_> = all.filter(|(_, value)| *value != 0.0).collect();
        (!values.is_empty()).then_some(Self { values, loads: chain.loads })
    }

    /// Returns the deflection of every joint at a posture, rad.
    pub fn deflections(&self, frames: &Frames) -> [f64; MAX_JOINTS] {
        let mut turns = [0.0; MAX_JOINTS];
        for &(parameter, value) in &self.values {
            if let Some((joint, factor)) = deflection(frames, &self.loads, parameter) {
                turns[joint] += factor * value;
            }
        }
        turns
    }
}

/// Returns the joint that an elastic parameter deflects, and its deflection per unit of the parameter at a
/// posture, rad; None for any other parameter.
pub fn deflection(frames: &Frames, loads: &Loads, parameter: Parameter) -> Option<(usize, f64)> {
    match parameter {
        Parameter::Elastic(joint, link) => Some((joint, lever(frames, joint, link))),
        Parameter::Compliance(joint) => Some((joint, gravity_torque(frames, loads, joint))),
        _ => None,
    }
}
