//! Parsers of option values (clap `value_parser`s).
//!
//! An option that sets a key of the cell file is not checked against a range here. The reader of the cell
//! file checks the value. Every other length or angle must be in the range [`NumberRange::Finite`].

use crate::assess::NodeChoice;
use crate::files::{Choices, MAX_BEND, NumberRange, Setting};

/// Parses the elevation of the tool axis in degrees.
pub fn bend(text: &str) -> Result<f64, String> {
    let number = measure(text)?;
    if number.abs() <= MAX_BEND {
        Ok(number)
    } else {
        Err(format!("it must be from -{MAX_BEND} to {MAX_BEND}"))
    }
}

/// Parses the distance between sample points in mm.
pub fn step(text: &str) -> Result<f64, String> {
    let number = measure(text)?;
    if number >= 1.0 { Ok(number) } else { Err("it must be at least 1".into()) }
}

/// Parses any floating-point number, including NaN and infinity.
pub fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "it is not a number".to_string())
}

/// Parses a length in mm or an angle in degrees, which must be within the range that files allow.
pub fn measure(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    NumberRange::Finite.refuses(number).map_or(Ok(number), |(wrong, _)| Err(format!("it {wrong}")))
}

/// Parses a length in mm above 0, within the range that files allow.
pub fn positive(text: &str) -> Result<f64, String> {
    let number = measure(text)?;
    if number > 0.0 { Ok(number) } else { Err("it must be more than 0".into()) }
}

/// Parses a share that is at least 0 and below 1.
pub fn share(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if (0.0..1.0).contains(&number) { Ok(number) } else { Err("it must be at least 0 and below 1".into()) }
}

/// Parses a duration in seconds.
pub fn seconds(text: &str) -> Result<f64, String> {
    let number = number(text)?;
    if (0.0..=1e9).contains(&number) { Ok(number) } else { Err("it must be from 0 to 1e9".into()) }
}

/// Parses `best`, or the two indices of a node.
pub fn at(text: &str) -> Result<NodeChoice, String> {
    if text == "best" {
        return Ok(NodeChoice::Best);
    }
    let number = |word: &str| word.trim().parse::<usize>().ok();
    let pair = text.split_once(',').and_then(|(i, j)| Some(NodeChoice::Node(number(i)?, number(j)?)));
    pair.ok_or_else(|| "expected `best`, or the indices of a node along x and y, for example 3,4".into())
}

/// Parses `PATH=VALUE` with one value.
pub fn setting(text: &str) -> Result<Setting, String> {
    let choices = Choices::parse(text)
        .map_err(|faults| faults.first().map_or(String::new(), |f| format!("{}; {}", f.message, f.help)))?;
    match &choices.values[..] {
        [value] => Ok(Setting::new(choices.path, value.clone())),
        values => Err(format!(
            "it has {} values: give one, write a list in [ ], or run `sweetspot sweep` for all of them",
            values.len()
        )),
    }
}
