//! Section 2 read three ways: what the errors of the parameters mean for an operation.
//!
//! One signed sample is what the paper maps. Read as tolerances, the same numbers are a box of
//! samples, of which the worst counts, or random variables, of which the spread counts:
//!
//! ```text
//! signed        |e|                        e = the model's error of the sample
//! worst-case    max |sum_k s_k g_k|        over all signs s: the farthest vertex of a zonotope
//! statistical   |N(mu, sum_k g_k g_k^T)|   its RMS, mean, percentiles, P(|e| <= limit)
//! ```
//!
//! with `g_k` what the k-th [`ErrorSource`] does to the error at its tolerance (or its standard
//! deviation) in the rows of a sense ([`SenseRows`]), after all that the cell has measured itself
//! ([`BestFit`], [`Taught`]) and, for a part that was picked elsewhere, less what the pick did
//! ([`WorkContext`]).

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
