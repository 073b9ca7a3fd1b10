//! Operations without a bound.

use super::WhyNot;
use crate::cell::{Cell, Reading, Registration};

/// Checks that neither the registration nor the pick nor the equipment errors of an operation prevent a
/// bound.
///
/// # Errors
///
/// Returns the reason that prevents a bound.
pub(super) fn refuse(cell: &Cell, operation: usize) -> Result<(), WhyNot> {
    let asked = &cell.operations[operation];
    if asked.relative_to.is_some() {
        return Err(WhyNot::Relative);
    }
    if cell.registration != Registration::None {
        return Err(WhyNot::Registered);
    }
    if cell.reading == Reading::Signed && cell.equipment[asked.equipment].errors.is_some() {
        return Err(WhyNot::EquipmentErrors);
    }
    Ok(())
}
