//! Tolerance analysis: the error of an operation for a signed sample, a tolerance box or a distribution.
//!
//! The seed paper, from which this project grew, computes the error for one signed sample of the parameter
//! errors (section 2). If the error set gives tolerances, they bound a box of samples. The worst-case reading
//! takes the worst sample of this box. If the errors are random variables, the statistical reading gives
//! statistics of the error, for example the root sum square (RSS):
//!
//! ```text
//! signed        |e|                        e = error of the sample by the model
//! worst-case    max |m + sum_k s_k g_k|    over all signs s: the farthest vertex of a zonotope
//! statistical   |mu + sum_k g_k x_k|       random x_k: its RMS, mean, percentiles, P(|e| <= limit)
//! ```
//!
//! Here `g_k` holds the components of the effect of [`ErrorSource`] k along the directions of a sense
//! ([`SenseRows`]). In the worst-case reading, `g_k` is the effect of an error as large as the tolerance of
//! the source. In the statistical reading, `g_k` is the effect of one standard deviation. The mean error is
//! `mu`. The vector `m` is the linear error that the means of measured errors cause; without measured errors,
//! `m` is 0. The factors `x_k` have the distributions of the sources, scaled to unit variance. Each `g_k`
//! excludes the error that a registration removes ([`BestFit`], [`Taught`]). For a picked part, `g_k` also
//! excludes the error of the pick ([`PickReference`]).

mod budget;
mod corner;
mod corner_model;
mod corner_search;
mod effects;
mod error_covariance;
mod error_propagation;
mod error_sources;
mod evaluator;
mod figures;
mod flip_prediction;
mod isotropic_tool;
mod least_over_spins;
mod monte_carlo;
pub mod norm;
#[doc(hidden)] // public for tests/maths
pub mod normal_quantile;
mod pair_gains;
mod position_factors;
mod position_moments;
mod posture_errors;
mod registration;
mod sample_space;
mod sense_rows;
mod spin_bound;
mod spun_worst_case;
mod statistics;
mod upper_bound;
mod work_context;
mod workspace_average;
mod worst_bounds;
mod worst_case;
mod worst_corner;
pub mod zonotope;

pub use budget::{Budget, Share};
pub use corner::ToleranceCorner;
pub use effects::Effects;
pub use error_propagation::{ErrorPropagation, PreparedSample};
pub use error_sources::{ErrorSource, ErrorSources, MAX_SOURCES};
pub use evaluator::{ErrorEvaluator, EvaluatorScratch};
pub use figures::{Figures, PostureErrors};
pub use monte_carlo::{
    Estimate, Histogram, JointSamples, MonteCarlo, SampledPosture, joint_monte_carlo, monte_carlo, share_of,
};
pub use registration::{BestFit, Taught};
pub use sample_space::SampleSpace;
pub use sense_rows::SenseRows;
pub use work_context::{PickReference, WorkContext, WorkFrame};
pub use worst_case::{WorstCase, farthest};
