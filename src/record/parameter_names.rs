//! Names of error parameters and of frames.

use crate::assess::MotionFrame;
use crate::cell::{Cell, Convention, Parameter, Robot};
use crate::files::shown;

/// Returns the name of a parameter, such as dq1, dalpha3, base rx, joint2 y, elastic 2 3 or worktable rz.
/// Joint numbers start at 1 and refer to the rows of the robot file.
pub fn parameter(cell: &Cell, parameter: Parameter) -> String {
    match parameter {
        Parameter::Equipment(e, _) => format!("{} {}", shown(&cell.equipment[e].name), parameter.name()),
        _ => of_robot(&cell.robot, parameter),
    }
}

/// Returns the name of a parameter of a robot, as [`parameter`] does.
pub fn of_robot(robot: &Robot, parameter: Parameter) -> String {
    let modified = robot.convention == Convention::Modified;
    match parameter {
        // The common normal at the end of a standard row begins the next modified row.
        Parameter::Dl(i) if modified => Parameter::Dl(i + 1).name(),
        Parameter::Dalpha(i) if modified => Parameter::Dalpha(i + 1).name(),
        Parameter::Dbeta(i) if modified => Parameter::Dbeta(i + 1).name(),
        Parameter::Joint(0, 0) if modified => Parameter::Dl(0).name(),
        Parameter::Base(3) if modified => Parameter::Dalpha(0).name(),
        Parameter::Joint(0, 4) if modified => Parameter::Dbeta(0).name(),
        _ => parameter.name(),
    }
}

/// Returns the name of a frame, such as base, frame 2, joint 3, TCP or work.
pub fn frame_name(place: MotionFrame) -> String {
    match place {
        MotionFrame::Base => "base".into(),
        MotionFrame::Link(k) => format!("frame {k}"),
        MotionFrame::Joint(k) => format!("joint {}", k + 1),
        MotionFrame::Tcp => "TCP".into(),
        MotionFrame::Work => "work".into(),
    }
}
