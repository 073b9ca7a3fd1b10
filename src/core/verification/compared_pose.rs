//! Measured position with its prediction.

use crate::cell::JointVector;
use nalgebra::Vector3;

/// One measured position and its prediction. All vectors are in the base frame of the robot, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparedPose {
    /// Row of the measurement file, counted from 1.
    pub row: usize,
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
    /// Index of the reflector in the session.
    pub reflector: usize,
    /// Position of the reflector for the nominal arm, base frame, m.
    pub nominal: Vector3<f64>,
    /// Measured minus nominal position, base frame, m.
    pub measured: Vector3<f64>,
    /// Predicted mean of the measured error, base frame, m. The part of this error that the fit of base and
    /// reflectors absorbs is removed.
    pub predicted: Vector3<f64>,
    /// Predicted size of the error, m. In the signed reading, this is the length of [`Self::predicted`]. In
    /// the other readings, this is the root mean square of the error, random deviations included.
    pub size: f64,
    /// Whether the measured error is inside the predicted 95 % ellipsoid; None if the prediction contains no
    /// random deviations ([`super::PredictedErrors::has_deviations`]).
    ///
    /// The ellipsoid assumes that each parameter deviates by the same amount at all poses, because all poses
    /// belong to one arm. The ellipsoid excludes the part of the error that the fit of base and reflectors
    /// absorbs.
    pub is_inside: Option<bool>,
    /// Whether the measured error is inside a second 95 % ellipsoid. The second ellipsoid assumes that the
    /// deviations of the parameters change from pose to pose. None unless the error set comes from
    /// measurements.
    pub is_inside_varying: Option<bool>,
}

impl ComparedPose {
    /// Returns the measured minus the predicted error, m, base frame.
    pub fn residual(&self) -> Vector3<f64> {
        self.measured - self.predicted
    }
}
