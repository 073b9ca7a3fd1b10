//! Single values: numbers of a believable size, texts, names.

use super::document::Library;
use super::tree::{At, Node, Value};
use crate::files::fault::{did_you_mean, shown};

/// Largest length (mm) or angle (degrees) that any file can mean.
pub const LARGEST: f64 = 1e7;

/// Smallest size or weight that any file can mean.
pub const SMALLEST: f64 = 1e-6;

/// Longest name, characters.
pub const LONGEST_NAME: usize = 60;

/// What a number must be besides finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Must {
    BeFinite,
    BePositive,
    NotBeNegative,
    /// Half the width of a tolerance.
    BePlusMinus,
}

impl Must {
    /// A number to write for a missing one.
    pub fn example(self) -> &'static str {
        if self == Must::BePositive { "100" } else { "0" }
    }

    pub fn examples(self, len: usize) -> String {
        format!("[{}]", vec![self.example(); len].join(", "))
    }

    /// What is wrong with a value, and what to do.
    fn refuses(self, value: f64) -> Option<(&'static str, &'static str)> {
        if !value.is_finite() {
            Some(("must be a finite number", "write a plain number: nan and inf are no measures"))
        } else if value.abs() > LARGEST {
            Some(("must be from -1e7 to 1e7", "is the unit right? lengths are in mm, angles in degrees"))
        } else if self == Must::BePositive && value <= 0.0 {
            Some(("must be greater than 0", "write a number greater than 0"))
        } else if self == Must::BePositive && value < SMALLEST {
            Some(("must be at least 1e-6", "is the unit right? lengths are in mm"))
        } else if self == Must::NotBeNegative && value < 0.0 {
            Some(("must not be negative", "write 0 or a number greater than 0"))
        } else if self == Must::BePlusMinus && value < 0.0 {
            Some(("must not be negative", "a plus-or-minus has no sign; a sample has: kind = \"signed\""))
        } else {
            None
        }
    }
}

/// A number as someone would write it.
pub fn plain(value: f64) -> String {
    let exponent = value != 0.0 && value.is_finite() && !(1e-6..1e15).contains(&value.abs());
    if value.is_nan() {
        "nan".into()
    } else if exponent {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// A finite number of a believable size.
pub fn number(node: &Node, what: &str, must: Must, lib: &mut Library<'_>) -> Option<f64> {
    let value = match &node.value {
        Value::Integer(i) => *i as f64,
        Value::Float(f) => *f,
        other => {
            let help = match other {
                Value::Text(t) if t.trim().parse::<f64>().is_ok() => "write it without quotes",
                _ => "write a plain number, without unit and quotes",
            };
            lib.error(node.at, format!("{what} must be a number, not {}", other.kind()), help);
            return None;
        }
    };
    if let Some((wrong, help)) = must.refuses(value) {
        lib.error(node.at, format!("{what} {wrong}, not {}", plain(value)), help);
        return None;
    }
    Some(value)
}

/// A list of exactly `len` numbers.
pub fn numbers(node: &Node, what: &str, len: usize, must: Must, lib: &mut Library<'_>) -> Option<Vec<f64>> {
    let given = match &node.value {
        Value::Array(items) if items.len() == len => {
            let numbered = items.iter().enumerate();
            let read = |(i, n)| number(n, &format!("number {} of {what}", i + 1), must, lib);
            let values: Vec<_> = numbered.map(read).collect();
            return values.into_iter().collect();
        }
        Value::Array(items) => items.len().to_string(),
        other => other.kind().to_string(),
    };
    let wanted = if len == 1 { "1 number".to_string() } else { format!("{len} numbers") };
    let help = format!("write {wanted} in [ ], with commas");
    lib.error(node.at, format!("{what} must be a list of {wanted}, not {given}"), help);
    None
}

pub fn text(node: &Node, key: &str, lib: &mut Library<'_>) -> Option<String> {
    match &node.value {
        Value::Text(s) => Some(s.clone()),
        other => {
            let message = format!("`{key}` must be a text, not {}", other.kind());
            lib.error(node.at, message, format!("write {key} = \"...\""));
            None
        }
    }
}

/// One of a closed set of words.
pub fn choice<T: Copy>(
    node: &Node,
    key: &str,
    all: &[T],
    name: impl Fn(T) -> &'static str,
    lib: &mut Library<'_>,
) -> Option<T> {
    let word = text(node, key, lib)?;
    let found = all.iter().copied().find(|&v| name(v) == word);
    if found.is_none() {
        let help = match did_you_mean(&word, all.iter().map(|&v| name(v))) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("write {key} = {}", any_of(all, name)),
        };
        lib.error(node.at, format!("`{key}` cannot be \"{}\"", shown(&word)), help);
    }
    found
}

/// The words of a closed set, quoted.
pub fn any_of<T: Copy>(all: &[T], name: impl Fn(T) -> &'static str) -> String {
    let names: Vec<_> = all.iter().map(|&v| name(v)).collect();
    format!("\"{}\"", names.join("\" or \""))
}

/// A whole number from `min` to `max`.
pub fn integer(node: &Node, what: &str, (min, max): (u64, u64), lib: &mut Library<'_>) -> Option<u64> {
    let range = match max {
        u64::MAX => format!("write a whole number from {min} on"),
        _ => format!("write a whole number from {min} to {max}"),
    };
    let (wrong, help) = match &node.value {
        Value::Integer(i) => match u64::try_from(*i) {
            Ok(value) if (min..=max).contains(&value) => return Some(value),
            _ if *i > i128::from(max) => (format!("at most {max}, not {i}"), range),
            _ => (format!("at least {min}, not {i}"), range),
        },
        Value::Float(f) if f.fract() == 0.0 && f.abs() < 1e15 => {
            (format!("a whole number, not {f:?}"), format!("write {f:.0}, without point and exponent"))
        }
        Value::Float(f) => (format!("a whole number, not {}", plain(*f)), range),
        other => (format!("a whole number, not {}", other.kind()), range),
    };
    lib.error(node.at, format!("{what} must be {wrong}"), help);
    None
}

/// Names are shown and written to files: short, printable, not blank.
pub fn checked_name(name: &str, at: At, lib: &mut Library<'_>) -> Option<String> {
    if is_name(name) {
        return Some(name.to_string());
    }
    let message = format!("`{}` cannot be a name", shown(name));
    lib.error(at, message, format!("write 1 to {LONGEST_NAME} printable characters, no blank first or last"));
    None
}

pub fn is_name(name: &str) -> bool {
    name.chars().count() <= LONGEST_NAME && shown(name) == name && name.trim() == name && !name.is_empty()
}
