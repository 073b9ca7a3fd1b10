//! Columns of positions: three columns whose names differ only in the axis x, y or z.

use super::name::{ColumnOrigin, ColumnWords};
use std::collections::HashMap;

/// Columns of one reflector.
#[derive(Debug, Clone, PartialEq)]
pub struct ReflectorColumns {
    /// Name of the reflector; empty if the table has one position per row.
    pub name: String,
    pub position: [usize; 3],
}

/// Returns the position columns of one reflector, or of all reflectors that differ in a number (`smr1`) or in
/// the last letter of a word (`nestA`). The order of preference is:
/// measured positions, positions without a stated origin, commanded positions.
pub fn positions(names: &[ColumnWords]) -> Vec<ReflectorColumns> {
    let mut groups: Vec<(PositionGroup, [Option<usize>; 3])> = Vec::new();
    let mut places = HashMap::new();
    for (k, name) in names.iter().enumerate().filter(|(_, name)| name.uncertain.is_none()) {
        let Some((axis, group)) = axis_of(&name.parts()) else { continue };
        let key = PositionGroup { origin: name.origin, fillers: name.fillers, words: group };
        let place = *places.entry(key.clone()).or_insert_with(|| {
            groups.push((key, [None; 3]));
            groups.len() - 1
        });
        groups[place].1[axis].get_or_insert(k);
    }
    let whole = groups.into_iter().filter_map(|(key, [x, y, z])| Some((key, [x?, y?, z?])));
    let mut whole: Vec<_> = whole.collect();
    whole.sort_by_key(|(key, places)| (key.origin, key.words.len(), key.fillers, places[0]));
    let Some((first, place)) = whole.first().cloned() else { return Vec::new() };
    let one = ReflectorColumns { name: String::new(), position: place };
    let shape = first.shape();
    let is_alike = |key: &PositionGroup| match shape.contains(&"#") {
        true => key.shape() == shape,
        false => key.differs_in_last_letters(&first),
    };
    let alike = whole.iter().filter(|(key, _)| key.origin == first.origin && is_alike(key));
    let mut alike: Vec<_> = alike
        .map(|(key, position)| ReflectorColumns { name: key.words.join(""), position: *position })
        .collect();
    alike.sort_by_key(|columns| columns.position[0]);
    if alike.len() == 1 { vec![one] } else { alike }
}

/// Least length, bytes, of the common beginning of two words that name different reflectors.
const LEAST_STEM: usize = 3;

/// Words of a column name without the axis word. The three columns of a position agree in these words.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct PositionGroup {
    origin: ColumnOrigin,
    fillers: usize,
    words: Vec<String>,
}

impl PositionGroup {
    /// Returns the words with numbers replaced by `#`.
    fn shape(&self) -> Vec<&str> {
        let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit());
        self.words.iter().map(|word| if is_number(word) { "#" } else { word }).collect()
    }

    /// Returns whether the words of two groups are equal except for the last letter of long words.
    fn differs_in_last_letters(&self, other: &Self) -> bool {
        let stem = |word: &str| word.char_indices().next_back().map_or(0, |(at, _)| at);
        let is_alike =
            |(a, b): (&String, &String)| a == b || stem(a) >= LEAST_STEM && a[..stem(a)] == b[..stem(b)];
        self.words.len() == other.words.len() && self.words.iter().zip(&other.words).all(is_alike)
    }
}

/// Words in a column name that show that the column is not part of a position.
const NO_POSITION: [&str; 18] = [
    "rot",
    "rotation",
    "r",
    "v",
    "vel",
    "velocity",
    "speed",
    "force",
    "f",
    "torque",
    "quat",
    "q",
    "orientation",
    "ori",
    "euler",
    "a",
    "acc",
    "w",
];

/// Returns the axis that one word of a column name states, and the other words of the name.
///
/// Returns None if no word states an axis, or if another word is one of [`NO_POSITION`].
fn axis_of(words: &[&str]) -> Option<(usize, Vec<String>)> {
    let axis = |word: &str| ["x", "y", "z"].iter().position(|axis| *axis == word);
    if let [word] = words
        && let Some(axis) = word.strip_prefix('p').and_then(axis)
    {
        return Some((axis, Vec::new()));
    }
    let mut at = words.iter().enumerate().filter_map(|(k, word)| Some((k, axis(word)?)));
    let (place, axis) = at.next()?;
    let others = words.iter().enumerate().filter(|(k, _)| *k != place).map(|(_, word)| word.to_string());
    let others: Vec<String> = others.collect();
    let is_position = others.iter().all(|word| !NO_POSITION.contains(&word.as_str()));
    is_position.then_some((axis, others))
}
