//! Typed reading of the located tree: every fault is recorded and reading goes on.

use super::document::{At, Library, Node, Value};
use super::fault::{did_you_mean, shown};
use crate::units;
use nalgebra::Vector3;

/// Largest length (mm) or angle (degrees) that any file can mean.
const ABSURD: f64 = 1e7;

/// What a number must be besides finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Must {
    BeFinite,
    BePositive,
    NotBeNegative,
}

/// A table being read. [`Table::finish`] reports the keys that nobody asked for.
pub struct Table<'n> {
    pub at: At,
    entries: &'n [(String, At, Node)],
    asked: Vec<&'static str>,
}

impl<'n> Table<'n> {
    pub fn of(node: &'n Node, what: &str, lib: &mut Library<'_>) -> Option<Self> {
        match &node.value {
            Value::Table(entries) => Some(Self { at: node.at, entries, asked: Vec::new() }),
            other => {
                lib.error(node.at, format!("{what} must be a table, not {}", other.kind()), "");
                None
            }
        }
    }

    /// The node of a key that may be missing.
    pub fn get(&mut self, key: &'static str) -> Option<&'n Node> {
        self.asked.push(key);
        self.entries.iter().find(|(k, ..)| k == key).map(|(.., node)| node)
    }

    /// The node of a key that must be there.
    pub fn need(&mut self, key: &'static str, lib: &mut Library<'_>) -> Option<&'n Node> {
        let found = self.get(key);
        if found.is_none() {
            // A near miss is reported as an unknown key with a suggestion; say it once.
            let near = self.entries.iter().any(|(k, ..)| did_you_mean(k, [key]).is_some());
            if !near {
                lib.error(self.at, format!("`{key}` is missing"), format!("add {key} = {}", example(key)));
            }
        }
        found
    }

    /// All entries of a table of named tables, in file order.
    pub fn named(&self) -> impl Iterator<Item = (&'n str, At, &'n Node)> {
        self.entries.iter().map(|(k, at, node)| (k.as_str(), *at, node))
    }

    pub fn number(&mut self, key: &'static str, must: Must, lib: &mut Library<'_>) -> Option<f64> {
        number(self.need(key, lib)?, &format!("`{key}`"), must, lib)
    }

    pub fn number_or(
        &mut self,
        key: &'static str,
        default: f64,
        must: Must,
        lib: &mut Library<'_>,
    ) -> Option<f64> {
        self.get(key).map_or(Some(default), |n| number(n, &format!("`{key}`"), must, lib))
    }

    /// A length given in mm, in m.
    pub fn length(&mut self, key: &'static str, must: Must, lib: &mut Library<'_>) -> Option<f64> {
        self.number(key, must, lib).map(units::m_from_mm)
    }

    /// An angle given in degrees, in rad.
    pub fn angle(&mut self, key: &'static str, lib: &mut Library<'_>) -> Option<f64> {
        self.number(key, Must::BeFinite, lib).map(units::rad_from_deg)
    }

    pub fn numbers(
        &mut self,
        key: &'static str,
        len: usize,
        must: Must,
        lib: &mut Library<'_>,
    ) -> Option<Vec<f64>> {
        numbers(self.need(key, lib)?, key, len, must, lib)
    }

    pub fn numbers_or_zero(
        &mut self,
        key: &'static str,
        len: usize,
        lib: &mut Library<'_>,
    ) -> Option<Vec<f64>> {
        self.get(key).map_or(Some(vec![0.0; len]), |n| numbers(n, key, len, Must::BeFinite, lib))
    }

    /// Three lengths in mm, in m.
    pub fn vector(&mut self, key: &'static str, must: Must, lib: &mut Library<'_>) -> Option<Vector3<f64>> {
        let v = self.numbers(key, 3, must, lib)?;
        Some(Vector3::new(v[0], v[1], v[2]).map(units::m_from_mm))
    }

    pub fn text(&mut self, key: &'static str, lib: &mut Library<'_>) -> Option<String> {
        text(self.need(key, lib)?, key, lib)
    }

    pub fn text_or(&mut self, key: &'static str, default: &str, lib: &mut Library<'_>) -> Option<String> {
        self.get(key).map_or(Some(default.to_string()), |n| text(n, key, lib))
    }

    pub fn boolean_or(&mut self, key: &'static str, default: bool, lib: &mut Library<'_>) -> Option<bool> {
        let Some(node) = self.get(key) else { return Some(default) };
        if let Value::Boolean(b) = node.value {
            return Some(b);
        }
        lib.error(node.at, format!("`{key}` must be true or false, not {}", node.value.kind()), "");
        None
    }

    /// A whole number of `min` to `max`.
    pub fn integer_or(
        &mut self,
        key: &'static str,
        default: u64,
        (min, max): (u64, u64),
        lib: &mut Library<'_>,
    ) -> Option<u64> {
        let Some(node) = self.get(key) else { return Some(default) };
        integer(node, key, (min, max), lib)
    }

    /// One of a closed set of words.
    pub fn choice<T: Copy>(
        &mut self,
        key: &'static str,
        all: &[T],
        name: impl Fn(T) -> &'static str,
        default: Option<T>,
        lib: &mut Library<'_>,
    ) -> Option<T> {
        let node = match (self.get(key), default) {
            (None, Some(value)) => return Some(value),
            (None, None) => self.need(key, lib)?,
            (Some(node), _) => node,
        };
        let word = text(node, key, lib)?;
        let found = all.iter().copied().find(|&v| name(v) == word);
        if found.is_none() {
            let names: Vec<_> = all.iter().map(|&v| name(v)).collect();
            let help = match did_you_mean(&word, names.iter().copied()) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => format!("one of: {}", names.join(", ")),
            };
            lib.error(node.at, format!("`{key}` cannot be \"{}\"", shown(&word)), help);
        }
        found
    }

    /// Reports every key that is not known here.
    pub fn finish(self, lib: &mut Library<'_>) {
        for (key, at, _) in self.entries {
            if self.asked.contains(&key.as_str()) {
                continue;
            }
            let help = match did_you_mean(key, self.asked.iter().copied()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", self.asked.join(", ")),
            };
            lib.error(*at, format!("unknown key `{}`", shown(key)), help);
        }
    }
}

/// A finite number of a believable size.
pub fn number(node: &Node, what: &str, must: Must, lib: &mut Library<'_>) -> Option<f64> {
    let value = match node.value {
        Value::Integer(i) => i as f64,
        Value::Float(f) => f,
        ref other => {
            lib.error(node.at, format!("{what} must be a number, not {}", other.kind()), "");
            return None;
        }
    };
    let wrong = if !value.is_finite() {
        Some(("must be a finite number", "nan and inf are no measures"))
    } else if value.abs() > ABSURD {
        Some(("is beyond any workcell", "lengths are in mm, angles in degrees"))
    } else if must == Must::BePositive && value <= 0.0 {
        Some(("must be greater than 0", ""))
    } else if must == Must::NotBeNegative && value < 0.0 {
        Some(("must not be negative", ""))
    } else {
        None
    };
    if let Some((message, help)) = wrong {
        lib.error(node.at, format!("{what} {message}, not {value}"), help);
        return None;
    }
    Some(value)
}

fn numbers(node: &Node, key: &str, len: usize, must: Must, lib: &mut Library<'_>) -> Option<Vec<f64>> {
    let Value::Array(items) = &node.value else {
        lib.error(node.at, format!("`{key}` must be a list of {len} numbers, not {}", node.value.kind()), "");
        return None;
    };
    if items.len() != len {
        let message = format!("`{key}` must have {len} numbers, not {}", items.len());
        lib.error(node.at, message, "");
        return None;
    }
    let values: Vec<_> =
        items.iter().enumerate().map(|(i, n)| number(n, &format!("`{key}`[{i}]"), must, lib)).collect();
    values.into_iter().collect()
}

pub fn text(node: &Node, key: &str, lib: &mut Library<'_>) -> Option<String> {
    match &node.value {
        Value::Text(s) => Some(s.clone()),
        other => {
            lib.error(node.at, format!("`{key}` must be a text, not {}", other.kind()), "write it in quotes");
            None
        }
    }
}

pub fn integer(node: &Node, key: &str, (min, max): (u64, u64), lib: &mut Library<'_>) -> Option<u64> {
    match node.value {
        Value::Integer(i) if u64::try_from(i).is_ok_and(|u| (min..=max).contains(&u)) => Some(i as u64),
        Value::Integer(i) => {
            lib.error(node.at, format!("`{key}` must be from {min} to {max}, not {i}"), "");
            None
        }
        ref other => {
            let got = if let Value::Float(f) = other { f.to_string() } else { other.kind().to_string() };
            lib.error(node.at, format!("`{key}` must be a whole number, not {got}"), "");
            None
        }
    }
}

/// What to write for a missing key, by its unit.
fn example(key: &str) -> &'static str {
    match key {
        "position_mm" | "min_mm" | "max_mm" | "centre_mm" | "a_mm" | "b_mm" => "[0, 0, 0]",
        "size_mm" => "[1500, 700]",
        "limits_deg" | "limits_mm" => "[-90, 90]",
        "grid" => "[10, 8]",
        "units" => "{ length = \"mm\", angle = \"deg\" }",
        "sense" => "\"xy\"",
        _ if key.ends_with("_mm") || key.ends_with("_deg") => "0",
        _ => "...",
    }
}
