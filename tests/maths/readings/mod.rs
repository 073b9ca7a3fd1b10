//! Tests the readings of the errors against brute force, Monte Carlo, closed forms and published values.

pub mod bench;
mod best_fit;
mod bounded;
mod joint;
mod lower_bound;
mod measured;
mod norm;
mod normal_quantile;
mod refuted;
mod registration;
mod sampling;
mod spread;
mod upper_bound;
mod worst;
mod zonotope;
