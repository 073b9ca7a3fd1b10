//! Tolerance analysis: the parameter errors of section 2 read as a sample, a worst case or a distribution.
//!
//! The seed paper maps one signed sample. Read as tolerances, the same numbers are a box of samples, and the
//! worst of these counts. Read as random variables, their spread counts (root sum of squares, RSS):
//!
//! ```text
//! signed        |e|                        e = the model's error of the sample
//! worst-case    max |sum_k s_k g_k|        over all signs s: the farthest vertex of a zonotope
//! statistical   |N(mu, sum_k g_k g_k^T)|   its RMS, mean, percentiles, P(|e| <= limit)
//! ```
//!
//! Here `g_k` is the effect of [`ErrorSource`] k at its tolerance (or its standard deviation) in the rows of
//! a sense ([`SenseRows`]). It excludes the error that a registration removes ([`BestFit`], [`Taught`]) and,
//! for a picked part, the error of the pick ([`PickReference`]).

mod budget;
mod effects;
mod error_propagation;
mod error_sources;
mod evaluator;
mod figures;
mod monte_carlo;
pub mod norm;
#[doc(hidden)] // open for tests/it
pub mod normal_quantile;
mod posture_errors;
mod registration;
mod sense_rows;
mod work_context;
mod worst_case;
pub mod zonotope;

pub use budget::{Budget, Share};
pub use effects::Effects;
pub use error_propagation::{ErrorPropagation, PreparedSample};
pub use error_sources::{ErrorSource, ErrorSources, MAX_SOURCES};
pub use evaluator::{ErrorEvaluator, EvaluatorScratch};
pub use figures::{Figures, PostureErrors};
pub use monte_carlo::{Estimate, Histogram, MonteCarlo, monte_carlo};
pub use registration::{BestFit, Taught};
pub use sense_rows::SenseRows;
pub use work_context::{PickReference, WorkContext, WorkFrame};
pub use worst_case::WorstCase;
