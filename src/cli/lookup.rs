//! Look-up of names on the command line. An unknown name is reported with the list of known names.

use super::{Exit, output};
use crate::cell::Cell;
use crate::files::fault::did_you_mean;
use crate::files::shown;

/// Returns the index of the operation with a name.
pub fn operation(cell: &Cell, name: &str) -> Result<usize, Exit> {
    let names = || cell.operations.iter().map(|o| o.name.as_str());
    let found = names().position(|n| n == name);
    found.ok_or_else(|| unknown(&format!("the cell has no operation `{}`", shown(name)), name, names()))
}

/// Prints that a name is unknown, and which names are known.
pub fn unknown<'a>(what: &str, word: &str, known: impl Iterator<Item = &'a str> + Clone) -> Exit {
    let near = did_you_mean(word, known.clone());
    let near = near.map(|n| format!("did you mean {}? ", shown(n))).unwrap_or_default();
    output::error(&format!("{what}; {near}known: {}", known.map(shown).collect::<Vec<_>>().join(", ")));
    Exit::BadInput
}
