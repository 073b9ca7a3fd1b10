//! Verification: the errors that a cell predicts, compared with positions that an instrument has measured.
//!
//! Only the commanded joints and the measured positions are known. The pose of the robot base in the frame of
//! the instrument is unknown. The positions of the reflectors on the mechanical interface are also unknown. A
//! fit of the nominal arm to the measured positions determines both. This fit absorbs a part of the errors,
//! so the same part must be removed from the prediction. Let `p_i` be the measured positions in the fitted
//! base frame, and `n_i` the nominal positions:
//!
//! ```text
//! measured    m_i = p_i - n_i
//! predicted   d_i = e_i - M_i e
//! covariance  C_i = (J_i - F_i K) C (J_i - F_i K)^T + s_i^2 I
//! ```
//!
//! Here `e_i` is the error of position i that the mean errors of the parameters cause. The vector `e` lists
//! the errors of all positions. The fit absorbs the part `M_i e` of the error `e_i`.
//!
//! C is the covariance of the parameters, and `J_i` their effect on position i. `F_i` is the effect of
//! the fitted base and reflectors on position i. The matrix K maps errors of the parameters to the changes of
//! base and reflectors by which the fit absorbs them. The standard deviation of the measurement is `s_i`.

mod clusters;
mod compared_pose;
mod comparison;
mod prediction;
mod rank_correlation;
mod repeats;
mod spots;

pub use clusters::clusters;
pub use compared_pose::ComparedPose;
pub use comparison::MeasuredComparison;
pub use prediction::PredictedErrors;
pub use rank_correlation::rank_correlation;
pub use repeats::{CYCLES_OF_STANDARD, Repeatability, RepeatedPosture, repeatability_of};
pub use spots::{MeasuredSpot, SpotRanking};
