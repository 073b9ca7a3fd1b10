//! Units of error parameters in documents and reports.

use super::numbers::nine_digits;
use crate::cell::{Cell, JointKind, Parameter, Robot};
use crate::units::{deg_from_rad, mm_from_m, rad_from_deg};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Unit of an error parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ParameterUnit {
    #[serde(rename = "mm")]
    Length,
    #[serde(rename = "deg")]
    Angle,
    /// Deflection of a joint, degrees per m of the horizontal lever of a link.
    #[serde(rename = "deg/m")]
    AnglePerLever,
    /// Deflection of a joint per torque, degrees per N m.
    #[serde(rename = "deg/Nm")]
    AnglePerTorque,
    /// Factor of the periodic error of a joint, without a unit.
    #[serde(rename = "1")]
    Share,
}

impl ParameterUnit {
    pub const ALL: [Self; 5] =
        [Self::Length, Self::Angle, Self::AnglePerLever, Self::AnglePerTorque, Self::Share];

    /// Returns the unit of a parameter of a cell.
    pub fn new(cell: &Cell, parameter: Parameter) -> Self {
        Self::of_robot(&cell.robot, parameter)
    }

    /// Returns the unit of a parameter of a robot.
    pub fn of_robot(robot: &Robot, parameter: Parameter) -> Self {
        let turns = match parameter {
            Parameter::Dq(i) => robot.joints[i].kind == JointKind::Revolute,
            Parameter::Dr(_) | Parameter::Dl(_) => false,
            Parameter::Dalpha(_) | Parameter::Dbeta(_) => true,
            Parameter::Base(c) | Parameter::Tool(c) => c >= 3,
            Parameter::Joint(_, c) | Parameter::Equipment(_, c) => c >= 3,
            Parameter::Elastic(..) => return Self::AnglePerLever,
            Parameter::Compliance(_) => return Self::AnglePerTorque,
            Parameter::Periodic(_) => return Self::Share,
        };
        if turns { Self::Angle } else { Self::Length }
    }

    /// Returns the name of this unit as it appears in files and reports, for example `deg/m`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Length => "mm",
            Self::Angle => "deg",
            Self::AnglePerLever => "deg/m",
            Self::AnglePerTorque => "deg/Nm",
            Self::Share => "1",
        }
    }

    /// Converts a value from SI to this unit.
    pub fn from_si(self, value: f64) -> f64 {
        match self {
            Self::Length => mm_from_m(value),
            Self::Angle | Self::AnglePerLever | Self::AnglePerTorque => deg_from_rad(value),
            Self::Share => value,
        }
    }

    /// Converts a value from SI to this unit, rounded to 9 decimals.
    pub fn shown(self, value: f64) -> f64 {
        nine_digits(self.from_si(value))
    }

    /// Converts the effect of a parameter from m per SI unit of the parameter to mm per this unit.
    pub fn effect_mm(self, effect: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Length => *effect,
            Self::Angle | Self::AnglePerLever | Self::AnglePerTorque => {
                effect.map(mm_from_m) * rad_from_deg(1.0)
            }
            Self::Share => effect.map(mm_from_m),
        }
    }
}
