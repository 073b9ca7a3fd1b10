//! Elastic and periodic errors: deflections of revolute joints that depend on the posture.
//!
//! An elastic parameter rotates one joint by its value times a factor that depends on the posture. The
//! factor is a lever (m), a torque (N m), or the periodic error of the joint (rad). The factor is computed
//! for the chain without errors. Other errors change the factor to first order. The resulting change of the
//! deflection is of second order in the errors, and every model neglects it.

use crate::cell::{MAX_JOINTS, Parameter};
use crate::robot::{Chain, Frames, Loads, PeriodicDeflection, gravity_torque, lever};
use std::sync::Arc;

/// Elastic parameters of one sample of errors, for one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticErrors {
    /// Parameters whose value is not 0, with these values (rad/m, rad/(N m) or a share).
    values: Vec<(Parameter, f64)>,
    loads: Loads,
    periodic: Arc<[PeriodicDeflection]>,
}

impl ElasticErrors {
    /// Returns the elastic errors with the given values of [`Parameter::elastic`]; None if all are 0.
    pub fn new(chain: &Chain, values: &[f64]) -> Option<Self> {
        let all = Parameter::elastic(chain.axes()).zip(values.iter().copied());
        let values: Vec<_> = all.filter(|(_, value)| *value != 0.0).collect();
        (!values.is_empty()).then(|| Self { values, loads: chain.loads, periodic: chain.periodic.clone() })
    }

    /// Returns the deflection of every joint at a posture, rad.
    pub fn deflections(&self, frames: &Frames) -> [f64; MAX_JOINTS] {
        let mut turns = [0.0; MAX_JOINTS];
        for &(parameter, value) in &self.values {
            if let Some((joint, factor)) = deflection(frames, &self.loads, &self.periodic, parameter) {
                turns[joint] += factor * value;
            }
        }
        turns
    }
}

/// Returns the joint that an elastic parameter deflects, and its deflection (rad) at a posture per unit of
/// the parameter. Returns None for any other parameter.
pub fn deflection(
    frames: &Frames,
    loads: &Loads,
    periodic: &[PeriodicDeflection],
    parameter: Parameter,
) -> Option<(usize, f64)> {
    match parameter {
        Parameter::Elastic(joint, link) => Some((joint, lever(frames, joint, link))),
        Parameter::Compliance(joint) => Some((joint, gravity_torque(frames, loads, joint))),
        Parameter::Periodic(joint) => {
            let own = periodic.iter().filter(|error| error.joint == joint);
            Some((joint, own.map(|error| error.at(&frames.links)).sum()))
        }
        _ => None,
    }
}
