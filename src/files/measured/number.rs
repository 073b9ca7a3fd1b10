//! Numbers of data files: decimal point or comma, missing values, units after a number.

/// Content of one field of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldValue {
    Number(f64),
    /// Empty field, or a word for a missing value.
    Missing,
    /// Text, or a number that is too large or not finite.
    Other,
}

/// Words for a missing value.
const MISSING: [&str; 9] = ["", "nan", "-", "--", "n/a", "na", "null", "none", "#n/a"];

/// Units that may follow a number.
const UNITS: [&str; 6] = ["mm", "deg", "rad", "°", "in", "m"];

/// Magnitude at and above which a number cannot be a measurement.
const TOO_LARGE: f64 = 1e15;

impl FieldValue {
    /// Reads a field from which the quotes have been removed.
    pub fn read(text: &str) -> Self {
        let text = text.trim();
        // Most fields are plain numbers.
        if let Some(number) = plain(text) {
            return number;
        }
        if text.len() > 40 {
            return Self::Other;
        }
        let lower = text.to_lowercase().replace('\u{2212}', "-");
        if MISSING.contains(&lower.as_str()) {
            return Self::Missing;
        }
        let number = UNITS.iter().find_map(|unit| lower.strip_suffix(unit)).unwrap_or(&lower).trim_end();
        let number = number.replace(',', if number.contains('.') { "," } else { "." });
        plain(&number).or_else(|| plain(&without_thousands(&number))).unwrap_or(Self::Other)
    }

    /// Returns the number in the field; None if the field holds no number.
    pub fn number(self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(number),
            Self::Missing | Self::Other => None,
        }
    }
}

/// Reads a number with a decimal point; words such as inf are not numbers.
fn plain(text: &str) -> Option<FieldValue> {
    if !text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        return None;
    }
    let number = text.parse::<f64>().or_else(|_| text.replace(['D', 'd'], "e").parse::<f64>()).ok()?;
    Some(if number.abs() < TOO_LARGE { FieldValue::Number(number) } else { FieldValue::Other })
}

/// Removes thousands separators. If a number has a point and a comma, the later sign is the decimal sign.
fn without_thousands(text: &str) -> String {
    match (text.rfind('.'), text.rfind(',')) {
        (Some(point), Some(comma)) if comma > point => text.replace('.', "").replace(',', "."),
        (Some(_), Some(_)) => text.replace(',', ""),
        _ => text.to_string(),
    }
}
