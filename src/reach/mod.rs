//! Can it go: inverse kinematics with all branches and joint limits.

mod limits;
mod numeric;
mod planar;

pub use limits::LimitViolation;
pub use numeric::{Goal, Held, Missing, Numeric, jacobian};
pub use planar::{Approach, Branch, Gap, PlanarArm, Reach};
