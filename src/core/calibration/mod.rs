//! Calibration: identifies the kinematic errors of a robot from measured positions of its tool.
//!
//! A session is one set-up of the measuring instrument and the reflectors. Let B be the pose of the robot base
//! in the frame of the instrument, f a reflector in the frame of the mechanical interface, and T(q) the
//! pose of that interface with errors. The model of the measured position is
//!
//! ```text
//! p = B T(q) f
//! ```
//!
//! Every session has a B and an f of its own; the errors in T are common to all sessions. They are the errors
//! of the Denavit-Hartenberg rows, with dbeta instead of dr between parallel axes (Hayati 1983), and elastic
//! terms. The fit minimises, with Huber's loss,
//!
//! ```text
//! sum_i rho(|p_i - B T(q_i) f| / sigma) + sum_k (a_k / s_k)^2
//! ```
//!
//! by Newton's method with exact derivatives. Here `s_k` is the standard deviation of parameter `a_k`
//! before the measurement, and sigma is the residual standard deviation per axis, estimated in the fit.

mod accuracy;
mod deformed;
mod fit;
mod hypothesis;
mod plan;
mod plan_posterior;
mod plan_problem;
mod rigid;
mod session;
mod unknown;

pub use accuracy::Accuracy;
pub use deformed::{Deformed, PointMotion};
pub use fit::{Calibration, FittedSession, calibrate};
pub use hypothesis::{DataReading, LENGTH_UNITS, explain, unit_name};
pub use plan_problem::{IntendedCalibration, PlanProblem, UnmodelledError};
pub use rigid::{SessionFrames, aligned};
pub use session::{MeasuredPosition, MeasuringSession, drawn};
pub use unknown::{Identified, Unknown, unknowns};
