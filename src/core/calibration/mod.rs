//! Calibration: identifies the kinematic errors of a robot from measured positions of its tool.
//!
//! A session is one set-up of the measuring instrument and the reflectors. Let B be the pose of the robot
//! base in the frame of the instrument. Let f be the position of a reflector in the frame of the mechanical
//! interface. Let T(q) be the pose of that interface in the base frame. This pose depends on the actuator
//! coordinates q and on the errors of the robot. The model of the measured position is
//!
//! ```text
//! p = B T(q) f
//! ```
//!
//! Each session has its own B and f. The errors in T are common to all sessions. These errors comprise errors
//! of the Denavit-Hartenberg rows, elastic terms, and periodic errors of the joints. Between parallel axes,
//! dbeta replaces dr (Hayati 1983). The fit minimizes this sum:
//!
//! ```text
//! sum_i r_i^T S_i^-1 r_i + sum_k (a_k / s_k)^2,   r_i = p_i - B T(q_i) f
//! ```
//!
//! Newton's method with exact derivatives finds the minimum, but ignores second derivatives with respect to
//! harmonics. If a residual is large, Huber's loss replaces its term in the sum. The number `s_k` is the
//! prior standard deviation of parameter `a_k`. `S_i` is the covariance of the error that the parameters do
//! not explain (see `residual_variances`). On a real arm, most of the unexplained error comes from the
//! joints.

mod accuracy;
mod deformed;
mod fit;
mod fit_state;
mod gross_errors;
mod harmonics;
mod hypothesis;
mod known_harmonics;
mod normal_equations;
mod plan;
mod plan_posterior;
mod plan_problem;
mod raw;
mod residual_variances;
mod result;
mod rigid;
mod session;
mod stated;
mod suspect;
mod taken_up;
mod unknown;
mod unknowns;
mod validation;

pub use accuracy::Accuracy;
pub use deformed::{Deformed, PointMotion};
pub use gross_errors::{GrossError, GrossErrors, LEAST_POSITIONS, gross_errors};
pub use harmonics::harmonics;
pub use hypothesis::{
    DataReading, JointMap, LENGTH_UNITS, RotationReading, explain, explain_rotations, spread_out, unit_name,
};
pub use plan_problem::{IntendedCalibration, PlanProblem, UnmodelledError};
pub use raw::{RawMeasurement, RawRotation, RotationConvention};
pub use residual_variances::ResidualVariances;
pub use result::{CHI_SQUARED_95, Calibration, FittedSession, calibrate};
pub use rigid::{SessionFrames, aligned};
pub use session::{MeasuredPosition, MeasuringSession, drawn};
pub use stated::{errors_between, errors_of_frames, no_errors, nominal_frames};
pub use suspect::{SuspectRows, still_joints};
pub use taken_up::{PositionJacobians, jacobian, taken_up};
pub use unknown::{Identified, Unknown};
pub use unknowns::unknowns;
