//! Ranking of nodes: a lower bound of the error at every node, computed for several nodes at once in SIMD
//! lanes.
//!
//! The bounds only order the nodes and reject the nodes that cannot be the spot. The scalar code judges the
//! remaining nodes one by one. Therefore no result depends on the processor. Only this module uses the SIMD
//! crate `pulp`.

mod lanes;
mod limits;
mod perturbed_chain;
mod planar_arm;
mod ranking;

pub use ranking::Ranker;
