//! Look-up of names on the command line. An unknown name is reported with the list of known names.

use super::{Exit, output};
use crate::cell::Cell;
use crate::files::fault::did_you_mean;
use crate::files::shown;
use indexmap::IndexSet;

/// Returns the index of the operation called `name`. Prints a message if the cell has no such operation.
pub fn operation(cell: &Cell, name: &str) -> Result<usize, Exit> {
    let names = || cell.operations.iter().map(|o| o.name.as_str());
    let found = names().position(|n| n == name);
    found.ok_or_else(|| unknown(&format!("the cell has no operation `{}`", shown(name)), name, names()))
}

/// Number of known names above which a message lists only the names that contain the unknown name. If no
/// known name contains the unknown name, the message lists all known names.
const MAX_LISTED: usize = 12;

/// Prints that the name `word` is unknown, and which names are known. Returns the exit code.
pub fn unknown<'a>(what: &str, word: &str, known: impl Iterator<Item = &'a str> + Clone) -> Exit {
    let near = did_you_mean(word, known.clone());
    let near = near.map(|n| format!("did you mean {}? ", shown(n))).unwrap_or_default();
    let all: IndexSet<&str> = known.collect();
    let part = word.to_ascii_lowercase();
    let alike: Vec<_> =
        all.iter().filter(|name| word.len() > 1 && name.to_ascii_lowercase().contains(&part)).collect();
    let list = match all.len() > MAX_LISTED && !alike.is_empty() {
        true => format!(
            "names that contain it: {}",
            alike.into_iter().map(|n| shown(n)).collect::<Vec<_>>().join(", ")
        ),
        false => format!("known: {}", all.iter().map(|n| shown(n)).collect::<Vec<_>>().join(", ")),
    };
    output::error(&format!("{what}; {near}{list}"));
    Exit::BadInput
}
