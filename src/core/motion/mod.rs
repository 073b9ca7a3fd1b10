//! Motion: continuous collision checking, straight approach and retract, transfers between operations.
//!
//! The module also measures how far a posture is from joint limits and singularities. [`Guard`] holds the
//! motion rules of a cell. A move is a straight line in joint coordinates, checked by [`first_hit`]. A
//! straight line of the TCP is approximated by short moves, which [`straight`] computes.

mod continuous_collision;
mod guard;
mod measures;
mod messages;
mod straight_line;
mod transfer;

pub use continuous_collision::{Move, PathHit, PathSlack, RESOLUTION, first_hit, first_hit_with};
pub use guard::{Guard, Hindrance, PostureRefusal};
pub use measures::{Measures, measures, singularity};
pub use straight_line::{DEVIATION, Stopped, straight};
pub use transfer::{
    Blocked, OperationPosture, PathCheck, Transfer, TransferRoute, direct_travel, nearest_turns,
};
