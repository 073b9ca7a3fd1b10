//! Can it go: inverse kinematics with all branches and joint limits.

mod ability;
mod anthropomorphic;
mod cones;
mod converge;
mod envelope;
mod hold;
mod inverse;
mod kernel;
mod lanes;
mod limits;
mod nearest;
mod numeric;
mod pieper;
mod planar;
mod quartic;
mod scara;
mod shell;
mod spherical_wrist;
mod subproblems;
mod three_joints;
mod three_parallel;
mod unlock;

pub use envelope::{Envelope, Extent, Fineness, Outline, Region, Size};
pub use inverse::{Approach, Branch, Cost, Gap, Inverse, Reach};
pub use lanes::{Level, PlanarLanes, Targets, Wrist};
pub use limits::LimitViolation;
pub use numeric::{Goal, Held, Missing, Numeric, jacobian};
#[doc(hidden)] // open for tests/it
pub use numeric::{least_turn, rotation_vector};
pub use planar::Way;
pub use shell::Shell;
pub use spherical_wrist::SphericalWrist;
pub use three_parallel::ThreeParallel;

use ability::kept_elevation;
