//! Names of columns, split into words and a unit.

use crate::units::{CENTIMETRE, INCH, MICROMETRE, MILLIMETRE};

/// Unit that a file states for a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StatedUnit {
    Degree,
    Radian,
    Metre,
    Centimetre,
    Millimetre,
    Micrometre,
    Inch,
}

impl StatedUnit {
    fn of_word(word: &str) -> Option<Self> {
        Some(match word {
            "deg" | "degree" | "degrees" | "grad" | "°" => Self::Degree,
            "rad" | "radian" | "radians" => Self::Radian,
            "m" | "meter" | "metre" | "meters" => Self::Metre,
            "cm" | "centimeter" | "centimetre" => Self::Centimetre,
            "mm" | "millimeter" | "millimetre" => Self::Millimetre,
            "um" | "\u{b5}m" | "\u{3bc}m" | "micron" | "microns" | "micrometer" | "micrometre" => {
                Self::Micrometre
            }
            "in" | "inch" | "inches" => Self::Inch,
            _ => return None,
        })
    }

    /// Returns the length of one unit, m; None for a unit of angles.
    pub fn length(self) -> Option<f64> {
        match self {
            Self::Degree | Self::Radian => None,
            Self::Metre => Some(1.0),
            Self::Centimetre => Some(CENTIMETRE),
            Self::Millimetre => Some(MILLIMETRE),
            Self::Micrometre => Some(MICROMETRE),
            Self::Inch => Some(INCH),
        }
    }

    /// Returns the unit to which the table reader converts lengths that are stated in this unit. Centimetres
    /// and micrometres become millimetres.
    pub fn of_table(self) -> Self {
        match self {
            Self::Centimetre | Self::Micrometre => Self::Millimetre,
            unit => unit,
        }
    }
}

/// Origin of the numbers of a column. The variants are in order of preference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ColumnOrigin {
    Measured,
    Unstated,
    Commanded,
}

/// Words for numbers that an instrument or an encoder has measured.
const MEASURED: [&str; 13] = [
    "measured",
    "measurement",
    "meas",
    "mea",
    "tracker",
    "lasertracker",
    "leica",
    "faro",
    "actual",
    "act",
    "ist",
    "real",
    "observed",
];

/// Words for numbers that were commanded.
const COMMANDED: [&str; 12] = [
    "goal",
    "target",
    "commanded",
    "command",
    "cmd",
    "nominal",
    "nom",
    "desired",
    "des",
    "setpoint",
    "soll",
    "ref",
];

/// Words that mark the numbers of a column as deviations, not coordinates.
const UNCERTAIN: [&str; 12] =
    ["std", "sigma", "u95", "u", "unc", "uncertainty", "stddev", "rms", "error", "err", "dev", "residual"];

/// Words that do not tell which quantity a column holds.
const FILLERS: [&str; 8] = ["value", "pos", "position", "coordinate", "coord", "in", "angle", "tcp"];

/// Name of a column in words.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnWords {
    pub origin: ColumnOrigin,
    pub unit: Option<StatedUnit>,
    /// Word for a deviation, if the name has one.
    pub uncertain: Option<String>,
    /// All other words in lower case. A number at the end of a word is a separate word.
    pub words: Vec<String>,
    /// Number of words in the name that are [`FILLERS`].
    pub fillers: usize,
}

/// Longest name that is split into words, bytes.
const MAX_NAME: usize = 80;

impl ColumnWords {
    /// Splits a name into words; `unit` is the unit that a line of units states for the column.
    pub fn new(name: &str, unit: Option<&str>) -> Self {
        let mut of = Self {
            origin: ColumnOrigin::Unstated,
            unit: unit.and_then(|unit| StatedUnit::of_word(unit.trim_matches(['[', ']', '(', ')', ' ']))),
            uncertain: None,
            words: Vec::new(),
            fillers: 0,
        };
        if name.len() > MAX_NAME {
            return of;
        }
        let name = name.to_lowercase();
        let words: Vec<&str> =
            name.split(|c: char| !c.is_alphanumeric() && c != '°').filter(|w| !w.is_empty()).collect();
        for (k, word) in words.iter().enumerate() {
            let is_last = k > 0 && k + 1 == words.len();
            match StatedUnit::of_word(word).filter(|_| is_last) {
                Some(unit) => of.unit = Some(unit),
                None => of.add(word),
            }
        }
        of
    }

    fn add(&mut self, word: &str) {
        if MEASURED.contains(&word) {
            self.origin = ColumnOrigin::Measured;
        } else if COMMANDED.contains(&word) {
            self.origin = ColumnOrigin::Commanded;
        } else if UNCERTAIN.contains(&word) {
            self.uncertain = Some(word.into());
        } else if FILLERS.contains(&word) {
            self.fillers += 1;
        } else {
            let digit = word.find(|c: char| c.is_ascii_digit()).unwrap_or(word.len());
            let (letters, digits) = word.split_at(digit);
            let is_numbered = !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit());
            let parts = if is_numbered { [letters, digits] } else { [word, ""] };
            self.words.extend(parts.into_iter().filter(|part| !part.is_empty()).map(str::to_string));
        }
    }

    /// Returns the words as plain references, for matching.
    pub fn parts(&self) -> Vec<&str> {
        self.words.iter().map(String::as_str).collect()
    }
}
