//! Cycle time: the least time of the motions of a layout under the speed and acceleration limits of the
//! joints.
//!
//! Every motion has a trapezoidal speed profile or the time-optimal profile. A straight move in joint
//! coordinates has a trapezoidal profile with synchronized joints ([`straight_move_time`]). A straight line
//! of the TCP, such as an approach, is parameterized time-optimally ([`line_time`]). The robot stops at every
//! corner between a line and a move, because the direction of motion changes abruptly there. Blending is not
//! modelled. Torques and jerk are not limited.

mod line_time;
mod path_timing;
mod rate_bounds;
mod sequence;
mod spline;
mod straight_move;

pub use line_time::{line_time, path_of_legs_time};
pub use rate_bounds::{ASSUMED_FULL_SPEED_AFTER, RateBounds};
pub use sequence::{CyclePhase, CycleStep, CycleTime, MotionSequence};
pub use straight_move::{rest_to_rest, straight_move_time};
