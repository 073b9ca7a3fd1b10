//! What a person reads in the terminal.

mod compare;
mod map;
mod table;

pub use compare::{comparison, feasibility};
pub use map::{distrust, maps};

use crate::cell::{Cell, ErrorSet, Quantity, Reading, Registration, Spread};
use crate::units::{mm_from_m, percent_from_share, rounded};

/// Cell, robot, error set, model, reading and registration in one line.
pub fn headline(cell: &Cell) -> String {
    let reading = match cell.reading {
        Reading::Signed => String::new(),
        reading => format!(", {} reading", reading.name()),
    };
    let registration = match cell.registration {
        Registration::None => String::new(),
        Registration::BestFit => ", base frame best-fitted".into(),
        Registration::Taught => ", surface frames taught".into(),
    };
    format!(
        "{}: {}, errors {}, {} model{reading}{registration}",
        cell.name,
        cell.robot.name,
        cell.error_set().name(),
        cell.model.name()
    )
}

/// What must be said about how the errors are read; empty if nothing.
pub fn caveats(cell: &Cell) -> Vec<String> {
    let mut said = Vec::new();
    let signed = matches!(cell.error_set(), ErrorSet::Signed(_));
    if signed && cell.reading != Reading::Signed {
        said.push(format!(
            "{} is a signed sample: its magnitudes are read as plus-or-minus ({} sigma of a normal)",
            cell.error_set().name(),
            Spread::SIGMAS
        ));
    }
    let signs = |e: &crate::cell::Equipment| e.errors.is_some_and(|errors| errors.signed().is_none());
    let operated = cell.operations.iter().map(|o| &cell.equipment[o.equipment]);
    if cell.reading == Reading::Signed
        && cell.registration != Registration::Taught
        && operated.clone().any(signs)
    {
        said.push("tolerances of equipment have no signs: the signed reading leaves them out".into());
    }
    said
}

/// What the numbers of a map are: "error", "worst case", "p95" ...
pub fn value_word(cell: &Cell) -> &'static str {
    match (cell.reading, cell.quantity) {
        (Reading::Signed, _) => "error",
        (Reading::WorstCase, _) => "worst case",
        (Reading::Statistical, Quantity::Yield) => "share of failures",
        (Reading::Statistical, quantity) => quantity.name(),
    }
}

/// What can be the matter with a node, in words.
const STATUSES: [(&str, &str); 5] = [
    ("ok", "ok"),
    ("collision", "colliding"),
    ("joint-limit", "beyond a joint limit"),
    ("out-of-reach", "out of reach"),
    ("unjudged", "that cannot be judged"),
];

fn mm(m: f64) -> String {
    rounded(mm_from_m(m), 3).to_string()
}

fn mm1(m: f64) -> String {
    format!("{:.1}", rounded(mm_from_m(m), 1))
}

/// A share as percent.
fn percent(share: f64) -> String {
    format!("{} %", rounded(percent_from_share(share), 3))
}
