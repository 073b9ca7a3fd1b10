//! Units of the numbers in the files, and their conversion to SI.

use crate::units;

/// Unit of the numbers of a key, stated by the ending of the key name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyUnit {
    None,
    Millimetres,
    Degrees,
    Percent,
    MillimetresPerDegree,
    DegreesPerMetre,
    DegreesPerNewtonMetre,
    Kilograms,
    Seconds,
    DegreesPerSecond,
    DegreesPerSecondSquared,
    MillimetresPerSecond,
    MillimetresPerSecondSquared,
}

impl KeyUnit {
    /// Converts a number of a file to SI.
    pub fn si(self, value: f64) -> f64 {
        match self {
            KeyUnit::None | KeyUnit::Kilograms | KeyUnit::Seconds => value,
            KeyUnit::Millimetres | KeyUnit::MillimetresPerSecond | KeyUnit::MillimetresPerSecondSquared => {
                units::m_from_mm(value)
            }
            KeyUnit::Degrees
            | KeyUnit::DegreesPerMetre
            | KeyUnit::DegreesPerNewtonMetre
            | KeyUnit::DegreesPerSecond
            | KeyUnit::DegreesPerSecondSquared => units::rad_from_deg(value),
            KeyUnit::Percent => units::share_from_percent(value),
            KeyUnit::MillimetresPerDegree => units::m_from_mm(value) / units::rad_from_deg(1.0),
        }
    }

    /// Returns the name of the unit for readers; empty if the number has no unit.
    pub fn name(self) -> &'static str {
        match self {
            KeyUnit::None => "",
            KeyUnit::Millimetres => "mm",
            KeyUnit::Degrees => "degrees",
            KeyUnit::Percent => "per cent",
            KeyUnit::MillimetresPerDegree => "mm per degree",
            KeyUnit::DegreesPerMetre => "degrees per m",
            KeyUnit::DegreesPerNewtonMetre => "degrees per N m",
            KeyUnit::Kilograms => "kg",
            KeyUnit::Seconds => "s",
            KeyUnit::DegreesPerSecond => "degrees per s",
            KeyUnit::DegreesPerSecondSquared => "degrees per s²",
            KeyUnit::MillimetresPerSecond => "mm per s",
            KeyUnit::MillimetresPerSecondSquared => "mm per s²",
        }
    }
}
