//! front.svg: the layouts of a front by two of their goals.

pub use super::chart::pareto as picture;
