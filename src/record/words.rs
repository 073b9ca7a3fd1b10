//! Words that documents, pages and the terminal share.

use crate::cell::{Cell, ErrorSet, Objective, Quantity, Reading, Spread};
use crate::files::shown;

/// Returns the name of the figure that a search of the cell minimizes: "error", "worst case", "p95" and so
/// on.
pub fn value_word(cell: &Cell) -> &'static str {
    match cell.search.objective {
        Objective::ToleranceCost => "tolerance cost",
        _ => reading_word(cell),
    }
}

/// Returns the name of the figure that the reading gives, such as "worst case". The name does not depend on
/// the objective of a search.
pub fn reading_word(cell: &Cell) -> &'static str {
    match (cell.reading, cell.quantity) {
        (Reading::Signed, _) => "error",
        (Reading::WorstCase, _) => "worst case",
        (Reading::Statistical, Quantity::Yield) => "share of failures",
        (Reading::Statistical, quantity) => quantity.name(),
    }
}

/// Returns the name of the objective: [`value_word`], or a phrase such as "sum of the operations' worst
/// cases".
///
/// The phrase is used if the objective combines several operations in a worst-case or statistical reading. In
/// such a reading, the errors of the arm are not fixed values. The figures of two operations may result from
/// different values of these errors. So there may be no single set of errors that gives the combined value.
pub fn objective_word(cell: &Cell) -> String {
    let word = value_word(cell);
    let is_alone = cell.search.objective == Objective::ToleranceCost || cell.reading == Reading::Signed;
    if cell.operations.len() < 2 || is_alone {
        return word.to_string();
    }
    let each = match word {
        "worst case" => "worst cases".to_string(),
        "share of failures" => "shares of failures".to_string(),
        word => format!("{word} figures"),
    };
    let weighted = if cell.operations.iter().any(|o| o.weight != 1.0) { "weighted " } else { "" };
    match cell.search.objective {
        Objective::WeightedSum => format!("{weighted}sum of the operations' {each}"),
        Objective::WeightedMaximum => format!("{weighted}maximum of the operations' {each}"),
        Objective::Lexicographic => format!("comparison of the operations' {each} in order of priority"),
        Objective::ToleranceCost => word.to_string(),
    }
}

/// All words that [`value_word`] can return.
pub const VALUE_WORDS: [&str; 8] =
    ["error", "worst case", "share of failures", "rms", "mean", "p95", "p99", "tolerance cost"];

/// Returns whether an error set is a guess. The name of a guessed error set begins with "guess".
pub fn is_guess(error_set: &str) -> bool {
    error_set.starts_with(GUESS)
}

/// Beginning of the names of guessed error sets.
pub const GUESS: &str = "guess";

/// Returns caveats on the interpretation of the errors and on the choice of the spots, in sentences.
pub fn caveats(cell: &Cell) -> Vec<String> {
    let mut said = Vec::new();
    let name = cell.error_set().name();
    if is_guess(name) {
        said.push(format!(
            "{} is a GUESS from a data sheet or a class of arms, not a measurement of this robot",
            shown(name)
        ));
    }
    let signed = matches!(cell.error_set(), ErrorSet::Signed(_));
    if signed && cell.reading != Reading::Signed {
        said.push(format!(
            "{} is a signed sample: its magnitudes are read as plus-or-minus tolerances ({} sigma of a normal distribution)",
            cell.error_set().name(),
            Spread::SIGMAS
        ));
        if cell.errors_compensate() {
            said.push(format!(
                "the errors of {} compensate each other in one calibrated arm; one of these errors alone \
                exceeds the reach of the arm, so worst case and statistics do not describe a real arm",
                cell.error_set().name()
            ));
        }
    }
    said.extend(cell.operations.iter().filter_map(|place| {
        let pick = &cell.operations[place.relative_to?];
        (!pick.over.needs_every_node()).then(|| {
            let [place, pick] = [&place.name, &pick.name].map(|name| shown(name));
            format!(
                "{place} is relative to {pick}. The spot of {pick} is chosen first, with the least error of {pick}. A joint choice of both spots could lower the objective, at most to its value with an error of 0 at {place}"
            )
        })
    }));
    said
}
