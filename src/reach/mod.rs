//! Can it go: inverse kinematics with all branches and joint limits.

mod limits;
mod planar;

pub use limits::LimitViolation;
pub use planar::{Approach, Branch, Gap, PlanarArm, Reach};
