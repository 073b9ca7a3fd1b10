//! Indices of combinations in the notation of the option `--only`, for example `0-9,17`.

use std::ops::RangeInclusive;

/// List of indices and of ranges of indices, in the order typed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IndexRanges(Vec<RangeInclusive<usize>>);

impl IndexRanges {
    /// Parses a list such as `0-9,17`.
    pub fn parse(text: &str) -> Result<Self, String> {
        text.split(',').map(range).collect::<Result<_, _>>().map(Self)
    }

    /// Returns the largest index.
    pub fn last(&self) -> usize {
        self.0.iter().map(|range| *range.end()).max().unwrap_or(0)
    }

    /// Returns the indices below `count` in ascending order, each once.
    pub fn below(&self, count: usize) -> Vec<usize> {
        (0..count).filter(|index| self.0.iter().any(|range| range.contains(index))).collect()
    }
}

fn range(text: &str) -> Result<RangeInclusive<usize>, String> {
    let number = |word: &str| word.trim().parse::<usize>().ok();
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (number(first), number(last)) {
        (Some(first), Some(last)) if first <= last => Ok(first..=last),
        (Some(first), Some(last)) => Err(format!("{first} is more than {last}: write {last}-{first}")),
        _ => Err("expected indices and ranges of indices, for example 0-9,17".into()),
    }
}
