//! Units of length of a drawing.

use crate::units::{INCH, MILLIMETRE};

/// Length of one unit of a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawingUnit {
    Millimetre,
    Centimetre,
    Metre,
    Inch,
    Foot,
}

impl DrawingUnit {
    pub const ALL: [Self; 5] = [Self::Millimetre, Self::Centimetre, Self::Metre, Self::Inch, Self::Foot];

    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
            Self::Inch => "inch",
            Self::Foot => "foot",
        }
    }

    /// Returns the length of the unit, m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => MILLIMETRE,
            Self::Centimetre => 10.0 * MILLIMETRE,
            Self::Metre => 1.0,
            Self::Inch => INCH,
            Self::Foot => 12.0 * INCH,
        }
    }

    /// Returns the unit of a value of `$INSUNITS` in the header of a drawing; None for any other unit.
    pub fn of_code(code: i64) -> Option<Self> {
        match code {
            1 => Some(Self::Inch),
            2 => Some(Self::Foot),
            4 => Some(Self::Millimetre),
            5 => Some(Self::Centimetre),
            6 => Some(Self::Metre),
            _ => None,
        }
    }
}
