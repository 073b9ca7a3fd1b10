//! The paper's Fig. 8: discrepancy between the linearized and the nonlinear model, node by node.

pub use super::chart::discrepancy as chart;
