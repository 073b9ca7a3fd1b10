//! The readings of the errors against brute force, sampling, closed forms and other people's figures.

mod bench;
mod norm;
mod registration;
mod sampling;
mod spread;
mod worst;
mod zonotope;
