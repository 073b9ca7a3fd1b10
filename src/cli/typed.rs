//! What is typed behind an option, read: a value, or what to write instead.

use crate::assess::At;
use std::path::PathBuf;

pub fn package(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() && !folder.is_empty() => Ok((name.into(), folder.into())),
        _ => Err("write the name of a package, = and its folder".into()),
    }
}

pub fn bend(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if number.abs() <= 90.0 { Ok(number) } else { Err("it must be from -90 to 90".into()) }
}

pub fn step(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if number >= 1.0 { Ok(number) } else { Err("it must be at least 1".into()) }
}

pub fn finite(text: &str) -> Result<f64, String> {
    let number: f64 = text.trim().parse().map_err(|_| "it is not a number".to_string())?;
    if number.is_finite() { Ok(number) } else { Err("it must be finite".into()) }
}

pub fn seconds(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if (0.0..=1e9).contains(&number) { Ok(number) } else { Err("it must be from 0 to 1e9".into()) }
}

pub fn share(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if number >= 0.0 { Ok(number) } else { Err("it must not be negative".into()) }
}

pub fn limit(text: &str) -> Result<f64, String> {
    let number = finite(text)?;
    if number > 0.0 { Ok(number) } else { Err("a limit must be more than 0".into()) }
}

pub fn at(text: &str) -> Result<At, String> {
    if text == "best" {
        return Ok(At::Best);
    }
    let number = |word: &str| word.trim().parse::<usize>().ok();
    let pair = text.split_once(',').and_then(|(i, j)| Some(At::Node(number(i)?, number(j)?)));
    pair.ok_or_else(|| "write best, or the node's numbers along x and y, for example 3,4".into())
}
