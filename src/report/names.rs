//! What parameters are called, and in which unit they are told.

use crate::cell::{Cell, JointKind, Parameter, Unit, shown};

/// dq1, dalpha3, base rx, tool z, worktable rz: joints by their numbers from 1.
pub fn parameter(cell: &Cell, parameter: Parameter) -> String {
    match parameter {
        Parameter::Equipment(e, _) => format!("{} {}", shown(&cell.equipment[e].name), parameter.name()),
        _ => parameter.name(),
    }
}

/// Millimetres or degrees.
pub fn unit(cell: &Cell, parameter: Parameter) -> Unit {
    let turns = match parameter {
        Parameter::Dq(i) => cell.robot.joints[i].kind == JointKind::Revolute,
        Parameter::Dr(_) | Parameter::Dl(_) => false,
        Parameter::Dalpha(_) | Parameter::Dbeta(_) => true,
        Parameter::Base(c) | Parameter::Tool(c) | Parameter::Equipment(_, c) => c >= 3,
    };
    if turns { Unit::Angle } else { Unit::Length }
}
