//! Pose accuracy and repeatability as in ISO 9283, predicted from the tolerances of a robot.
//!
//! The standard measures five poses P1 to P5 in a diagonal plane of a cube. This cube is the largest one in
//! the most used part of the working space. One pose is at the centre of the cube. The other four poses are
//! on the diagonals of the cube, each at a distance of 10 % of a diagonal from a corner. The pose accuracy AP
//! of one robot at one pose is the distance of the barycentre of the attained positions from the command
//! position. Random errors move each attained position, but not the barycentre. AP therefore contains only
//! the constant errors of the robot, and the repeatability RP contains the random errors:
//!
//! ```text
//! AP_p = |e_p - M_p|                 e_p = position error at pose p, M_p = motion of the fitted base frame
//! AP   = mean of AP_p over p         one number of one robot
//! series: median of AP over robots   half of the robots of the series are better
//! RP   = mean over p of l + 3 S      l, S = mean and standard deviation of the distance from the barycentre
//! ```
//!
//! A data sheet states one AP for a whole series. The prediction assumes that this is the AP of the median
//! robot of the series. The base frame is fitted to the robot, because a test measures in a frame that is
//! aligned with the robot. The base frame is fitted over the working space, as in the registration
//! `best-fit`.

mod arm_series;
mod base_fit;
mod guess;
mod preset;
mod repeatability;
mod test_cube;

pub use arm_series::{PoseAccuracy, PoseAccuracyTest};
pub use guess::{ErrorGuess, GuessFault, guessed};
pub use preset::{ErrorPreset, PRESETS};
pub use repeatability::{joint_scatter, repeatability};
pub use test_cube::{TestCube, TestPose};
