//! Can it go: inverse kinematics with all branches and joint limits.

mod anthropomorphic;
mod limits;
mod nearest;
mod pieper;
mod planar;
mod quartic;
mod spherical_wrist;
mod subproblems;
mod three_joints;
mod three_parallel;

pub use limits::LimitViolation;
pub use planar::{Approach, Branch, Gap, PlanarArm, Reach};
pub use spherical_wrist::SphericalWrist;
pub use three_parallel::ThreeParallel;
