//! Can it go: inverse kinematics with all branches and joint limits.

mod ability;
mod closed_form;
mod converge;
mod envelope;
mod hold;
mod inverse;
mod kernel;
mod limit_cones;
mod limits;
mod nearest;
mod numeric;
mod planar_geometry;
mod shell;
mod unlock;

pub use closed_form::planar::Way;
pub use closed_form::spherical_wrist::SphericalWrist;
pub use closed_form::three_parallel::ThreeParallel;
pub use envelope::{Envelope, Extent, Fineness, Outline, Region, Size};
pub use inverse::{Approach, Branch, Cost, Gap, Inverse, Reach};
pub use limit_cones::LimitCone;
pub use limits::LimitViolation;
pub use numeric::{Goal, Held, Missing, Numeric, jacobian};
#[doc(hidden)] // open for tests/it
pub use numeric::{least_turn, rotation_vector};
pub use planar_geometry::PlanarGeometry;
pub use shell::Shell;

use ability::kept_elevation;
