//! Motion: continuous collision checking, straight approach and retract, and transfers between operations.
//!
//! The module also measures how far a posture is from joint limits and singularities. [`Guard`] holds the
//! motion rules of a cell. A path consists of straight moves in joint coordinates. The function [`first_hit`]
//! checks a path. A straight line of the TCP is approximated by short moves, which [`straight`] computes.

mod continuous_collision;
mod guard;
mod measures;
mod messages;
mod motion_bounds;
mod straight_line;
mod transfer;

pub use continuous_collision::{PathHit, PathSlack, RESOLUTION, first_hit};
pub use guard::{Guard, Hindrance, LineEnds, PostureRefusal};
pub use measures::{Measures, measures, singularity};
pub use motion_bounds::MotionBounds;
pub use straight_line::{DEVIATION, Stopped, straight};
pub use transfer::{
    Blocked, KnownLines, OperationPosture, PathCheck, Transfer, TransferRoute, direct_travel, nearest_turns,
};
