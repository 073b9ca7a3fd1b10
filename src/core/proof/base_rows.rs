//! Rows of a sense in the base frame, and checks for rotations that leave the value of any error unchanged.

use super::WhyNot;
use super::coordinates::DIRECTION_ROUNDING;
use crate::cell::{Cell, Frame, Row};
use crate::reading::ErrorEvaluator;
use nalgebra::Matrix3;

/// Returns the rows (weighted components) of the sense, with directions in the base frame.
///
/// # Errors
/// Returns the reason if these directions depend on the layout.
pub(super) fn base_rows(
    cell: &Cell,
    evaluator: &ErrorEvaluator,
    operation: usize,
) -> Result<Vec<Row>, WhyNot> {
    let sense = &evaluator.sense;
    let turned = |by: &Matrix3<f64>| -> Vec<Row> {
        sense.rows().iter().map(|row| Row { direction: by * row.direction, ..*row }).collect()
    };
    let world = turned(&cell.start().base.from_world());
    let turned_base = cell.base[3].is_free();
    match sense.frame {
        Frame::World if !turned_base || turns_with_z(&world) => Ok(world),
        Frame::World => Err(WhyNot::WorldAxes),
        _ if is_isotropic(&world) => Ok(world),
        Frame::Tool => Err(WhyNot::ToolAxes),
        Frame::Surface if turns_with_z(&world) => Ok(world),
        Frame::Surface => {
            let equipment = cell.operations[operation].equipment;
            let under = (0..cell.equipment.len()).filter(|&under| cell.rides_on(equipment, under));
            if turned_base || under.clone().any(|k| cell.equipment[k].placement[3].is_free()) {
                return Err(WhyNot::SurfaceAxes);
            }
            let start = cell.start();
            let (s, c) = (start.placements[equipment].yaw - start.base.yaw).sin_cos();
            Ok(turned(&Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)))
        }
    }
}

/// Returns `sum r r^T` over the directions r of the position rows, and the same sum over the rotation rows.
pub(super) fn grams(rows: &[Row]) -> [Matrix3<f64>; 2] {
    let gram = |turns: bool| {
        rows.iter()
            .filter(|r| r.turns == turns)
            .map(|r| r.direction * r.direction.transpose())
            .sum::<Matrix3<f64>>()
    };
    [gram(false), gram(true)]
}

/// Returns whether the value of every error stays unchanged if the error is rotated about z. The value is the
/// root sum square of the components along `rows`.
pub(super) fn turns_with_z(rows: &[Row]) -> bool {
    grams(rows).iter().all(|g| {
        let off = (g[(0, 0)] - g[(1, 1)]).abs() + g[(0, 1)].abs() + g[(0, 2)].abs() + g[(1, 2)].abs();
        off <= DIRECTION_ROUNDING * g.trace()
    })
}

/// Returns whether the value of every error stays unchanged if the error is rotated about any axis. The value
/// is the root sum square of the components along `rows`.
fn is_isotropic(rows: &[Row]) -> bool {
    turns_with_z(rows)
        && grams(rows).iter().all(|g| (g[(0, 0)] - g[(2, 2)]).abs() <= DIRECTION_ROUNDING * g.trace())
}
