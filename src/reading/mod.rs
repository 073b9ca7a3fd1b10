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
//! with `g_k` what the k-th [`Source`] does to the error at its tolerance (or its standard
//! deviation) in the rows of a sense ([`Measure`]), after all that the cell has measured itself
//! ([`BestFit`], [`Taught`]) and, for a part that was picked elsewhere, less what the pick did
//! ([`Situation`]).

mod budget;
mod effects;
mod figures;
mod gauge;
mod measure;
mod monte_carlo;
pub mod norm;
mod registration;
mod situation;
mod sources;
mod worst_case;
pub mod zonotope;

pub use budget::{Budget, Share};
pub use effects::Effects;
pub use figures::{Figures, Judgement};
pub use gauge::{Gauge, Memory};
pub use measure::Measure;
pub use monte_carlo::{Estimate, Histogram, MonteCarlo, monte_carlo};
pub use registration::{BestFit, Taught};
pub use situation::{Reference, Sample, Site, Situation, Theory};
pub use sources::{MAX_SOURCES, Source, Sources};
pub use worst_case::WorstCase;
