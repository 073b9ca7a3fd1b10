//! Ranges of the numbers in the files.

/// Largest length (mm) or angle (degrees) that a file may contain.
pub const LARGEST: f64 = 1e7;

/// Smallest number that a file may contain if the number must be positive, such as a size or a weight.
pub const SMALLEST: f64 = 1e-6;

/// Values that a number may have, in the unit of the file. Every number is finite and at most 1e7 in absolute
/// value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NumberRange {
    Finite,
    Positive,
    NotNegative,
    /// Plus-or-minus value: half the width of a range. The value is at least 0.
    PlusMinus,
    /// Number from 0 to this value.
    UpTo(f64),
    /// Number that is at least 0 and less than this value.
    Below(f64),
}

impl NumberRange {
    /// Returns what is wrong with a value and what to do; None if the value is allowed.
    pub fn refuses(self, value: f64) -> Option<(String, String)> {
        let at_least_0 = "write 0 or a number greater than 0";
        let (wrong, remedy) = match self {
            _ if !value.is_finite() => {
                ("must be a finite number", "write a plain number; nan and inf are not allowed")
            }
            _ if value.abs() > LARGEST => {
                ("must be from -1e7 to 1e7", "is the unit right? lengths are in mm, angles in degrees")
            }
            Self::Positive if value <= 0.0 => ("must be greater than 0", "write a number greater than 0"),
            Self::Positive if value < SMALLEST => {
                ("must be at least 1e-6", "is the unit right? lengths are in mm")
            }
            Self::NotNegative | Self::UpTo(_) | Self::Below(_) if value < 0.0 => {
                ("must be 0 or greater", at_least_0)
            }
            Self::PlusMinus if value < 0.0 => {
                ("must be 0 or greater", "a tolerance has no sign; signed errors need kind = \"signed\"")
            }
            Self::UpTo(most) if value > most => {
                return Some((format!("must be at most {most}"), format!("write a number from 0 to {most}")));
            }
            Self::Below(end) if value >= end => {
                return Some((
                    format!("must be less than {end}"),
                    format!("write a number that is at least 0 and less than {end}"),
                ));
            }
            _ => return None,
        };
        Some((wrong.to_string(), remedy.to_string()))
    }

    /// Returns the number that messages suggest as the value of a missing key.
    pub fn example(self) -> &'static str {
        if self == Self::Positive { "100" } else { "0" }
    }
}
