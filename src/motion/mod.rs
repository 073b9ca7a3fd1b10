//! Can it get there: moves that touch nothing, between samples too; straight approach and retract; the
//! ways from one operation to the next; how far a posture is from limits and singularities.
//!
//! [`Guard`] holds what a cell asks of motion. A move is a straight line in joint coordinates, checked
//! by [`first_hit`]; a straight line of the TCP is made of such moves, by [`straight`].

mod guard;
mod line;
mod measures;
mod path;
mod transfer;
mod words;

pub use guard::{Guard, Hindrance, Refusal};
pub use line::{DEVIATION, Stopped, straight};
pub use measures::{Measures, measures, singularity};
pub use path::{PathHit, RESOLUTION, first_hit};
pub use transfer::{Blocked, Stance, Transfer, Way, direct_travel};
