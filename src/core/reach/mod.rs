//! Inverse kinematics: all branches of a target, joint limits, redundancy resolution, working envelope.
//!
//! | file | content |
//! |---|---|
//! | `inverse` | [`Inverse`], the only entry point: finds every branch of a target within the limits |
//! | `known_branch` | posture of a branch whose index is known |
//! | `solver`, `pose_solver`, `exact_solver` | choice of the solver, and its test on sampled postures |
//! | `closed_form` | one file per family of arms, or per mathematical tool |
//! | `refined_solver`, `simplified_chain` | closed forms of chains that nearly belong to a family |
//! | `general_six_axes` | all solutions for any six revolute axes, by elimination |
//! | `held_joint`, `redundancy`, `between_samples` | redundancy resolution by a sweep of one joint |
//! | `redundant_coordinate`, `narrow_range` | postures between the samples of a joint or a free spin |
//! | `numeric`, `numeric_branches` | damped least squares for every other chain |
//! | `attitude_set`, `tool_attitudes`, `attitude_limits`, `fixed_elevation` | attitudes of the tool |
//! | `spin_joint`, `spin_family` | rotation of the tool about its axis by the last joint alone |
//! | `tool_task` | controlled components of the TCP motion at a posture |
//! | `limits` | joint limits; angles that differ by whole turns count as equal |
//! | `shell`, `arm_shell` | bounding shell of the reach: a cheap test before any inverse kinematics |
//! | `envelope` | sections, volume and extent of the reach |
//! | `planar_geometry`, `limit_cones` | planar arm as plain data, to solve many targets at once |

mod arm_shell;
mod attitude_limits;
mod attitude_set;
mod between_samples;
mod branch;
mod closed_form;
mod envelope;
mod exact_solver;
mod fixed_elevation;
mod general_six_axes;
mod held_joint;
mod inverse;
mod known_branch;
mod limit_cones;
mod limits;
mod narrow_range;
mod numeric;
mod numeric_branches;
mod planar_geometry;
mod pose_solver;
mod redundancy;
mod redundant_coordinate;
mod refined_solver;
mod shell;
mod simplified_chain;
mod solver;
mod spin_family;
mod spin_joint;
mod tool_attitudes;
mod tool_task;

pub use branch::{Branch, Cost, Gap, Reach};
pub use closed_form::offset_wrist::OffsetWrist;
pub use closed_form::spherical_wrist::SphericalWrist;
pub use closed_form::three_parallel::ThreeParallel;
pub use envelope::{Envelope, EnvelopeExtent, EnvelopeSection, Fineness, Outline, Size};
pub use general_six_axes::GeneralSixAxes;
pub use inverse::Inverse;
pub use limit_cones::LimitCone;
pub use limits::LimitViolation;
pub use numeric::{AttitudeGoal, Numeric, NumericSolution, PoseMiss, Shortfall, TcpGoal, jacobian};
#[doc(hidden)] // public only for the tests in tests/maths
pub use numeric::{least_turn, rotation_vector};
pub use numeric_branches::CONTINUED;
pub use planar_geometry::PlanarGeometry;
pub use redundant_coordinate::{RedundantCoordinate, SamplePosition};
pub use refined_solver::RefinedSolver;
pub use shell::Shell;
pub use spin_family::FamilyReach;
pub use tool_attitudes::{PlanarAttitude, ToolAttitudes};
pub use tool_task::{MAX_ROWS, RotationRow, ToolTask};
