//! Demand for certificates of the postures of a layout.

use crate::cell::Cell;
use crate::certificate::{Misplacements, NoValueBound, ValueBound};

/// Demand for certificates: every posture must work at every misplacement within the placement tolerances.
///
/// One demand serves all postures of the layout.
#[derive(Clone, Copy)]
pub struct Demand<'a> {
    pub cell: &'a Cell,
    pub misplacements: &'a Misplacements,
    /// Upper bound of the value, or the reason why there is no bound; None if no bound is requested.
    pub value: Option<&'a Result<ValueBound, NoValueBound>>,
}
