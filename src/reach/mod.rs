//! Can it go: inverse kinematics with all branches and joint limits.

mod ability;
mod closed_form;
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
mod shell;
mod unlock;

pub use closed_form::planar::Way;
pub use closed_form::spherical_wrist::SphericalWrist;
pub use closed_form::three_parallel::ThreeParallel;
pub use envelope::{Envelope, Extent, Fineness, Outline, Region, Size};
pub use inverse::{Approach, Branch, Cost, Gap, Inverse, Reach};
pub use lanes::{Level, PlanarLanes, Targets, Wrist};
pub use limits::LimitViolation;
pub use numeric::{Goal, Held, Missing, Numeric, jacobian};
#[doc(hidden)] // open for tests/it
pub use numeric::{least_turn, rotation_vector};
pub use shell::Shell;

use ability::kept_elevation;
