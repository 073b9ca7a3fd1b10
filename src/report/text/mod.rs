//! Text for the terminal.

mod allocation;
mod answer;
mod budget;
mod buildability;
mod calibration;
mod check;
mod compare;
mod correction;
mod cycle_time;
mod envelope;
mod errors;
mod explain;
mod front;
mod islands;
mod map;
mod measured;
mod measuring_plan;
mod proof;
mod readings;
mod remedies;
mod robust;
mod self_collision_pairs;
mod sweep;
mod sweep_status;
pub mod table;
mod urdf;

pub use allocation::allocation;
pub use answer::answer;
pub use budget::budget;
pub use buildability::{assumptions, certificate};
pub use calibration::{calibration, stated_calibration};
pub use check::{yield_in_words, yield_lines};
pub use compare::{comparison, comparison_table, feasibility, side_by_side, verdict};
pub use correction::correction;
pub use cycle_time::{cycle_heading, cycle_notes, cycle_step_name, cycle_time};
pub use envelope::{envelope, envelope_title, kind_of, robot, robots};
pub use errors::{errors, presets};
pub use explain::explanation;
pub use front::{front, goals_line};
pub use islands::islands;
pub use map::{distrust, extrapolation, maps};
pub use measured::{measured, measured_findings};
pub use measuring_plan::measuring_plan;
pub use proof::proven;
pub use readings::{findings, readings};
pub use remedies::remedies;
pub use robust::{robust_lines, robustness};
pub use self_collision_pairs::self_collision_pairs;
pub use sweep::sweep;
pub use sweep_status::sweep_status;
pub use urdf::derived;

use crate::cell::{Cell, NO_TOLERANCES, Quantity, Reading, Registration, Unit};
use crate::error_map::NodeSign;

use crate::assess::PostureContext;
use crate::files::shown;
use crate::units::{mm_from_m, percent_from_share, rounded};

/// Returns cell, robot, error set and model in one line.
pub fn question(cell: &Cell) -> String {
    format!(
        "{}: {}, errors {}, {} model",
        cell.name,
        cell.robot.name,
        cell.error_set().name(),
        cell.model.name()
    )
}

/// Returns cell, robot, error set, model, reading and registration in one line.
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
    format!("{}{reading}{registration}", question(cell))
}

/// Kinds of nodes whose count is printed even if it is 0.
const ALWAYS_COUNTED: [NodeSign; 4] =
    [NodeSign::Usable, NodeSign::Collision, NodeSign::JointLimit, NodeSign::OutOfReach];

/// Returns a length in mm, rounded to 1 um.
fn mm(m: f64) -> String {
    rounded(mm_from_m(m), 3).to_string()
}

/// Returns a length in mm with one decimal.
fn mm1(m: f64) -> String {
    format!("{:.1}", rounded(mm_from_m(m), 1))
}

/// Returns a share as percent with up to three decimals.
fn percent(share: f64) -> String {
    format!("{} %", rounded(percent_from_share(share), 3))
}

/// Returns the gap between an objective and its proven bound, percent. The gap is rounded up, so that the
/// printed gap is never too small.
pub fn gap(percent: f64) -> String {
    let digits = if percent < 0.1 { 1e4 } else { 1e1 };
    format!("{} %", (percent.max(0.0) * digits).ceil() / digits)
}

/// Returns a share as percent with one decimal.
fn percent1(share: f64) -> String {
    format!("{} %", fixed(percent_from_share(share), 1))
}

/// Returns a number with a fixed number of decimals, never as negative zero.
fn fixed(value: f64, digits: usize) -> String {
    format!("{:.digits$}", rounded(value, digits as i32))
}

/// Returns a value with its unit; a share is in percent.
fn amount(unit: Unit, si: f64) -> String {
    match unit {
        Unit::Share => format!("{} %", fixed(percent_from_share(si), 4)),
        _ => format!("{} {}", fixed(unit.from_si(si), 4), unit.word()),
    }
}

/// Returns a line that states why a signed sample has no worst case and no statistics. Large errors of a
/// calibrated arm may cancel each other. The magnitudes of such errors are not tolerances.
pub fn no_tolerances() -> String {
    format!("worst case and statistics have no values, because {NO_TOLERANCES}")
}

/// Returns operation, surface, node and position in one line.
fn place_words(context: &PostureContext<'_>) -> String {
    let operation = &context.cell.operations[context.operation];
    let surface = shown(&context.cell.equipment[operation.equipment].name);
    let at = match context.node {
        Some((i, j)) => format!("node ({i}, {j})"),
        None => "the joints given".to_string(),
    };
    let [x, y, z] = [context.position.x, context.position.y, context.position.z].map(mm1);
    format!("{} on {surface}: {at}, x {x} y {y} z {z} mm\n", shown(&operation.name))
}

/// Returns the name, with the definite article, of the value that a tighter tolerance reduces.
fn tightened_word(context: &PostureContext<'_>) -> &'static str {
    match (context.evaluator.reading, context.evaluator.quantity) {
        (Reading::Statistical, Quantity::Yield) => "the share of failures",
        (Reading::Statistical, Quantity::Rms) => "the rms",
        (Reading::Statistical, Quantity::Mean) => "the mean",
        (Reading::Statistical, Quantity::P95) => "the p95",
        (Reading::Statistical, Quantity::P99) => "the p99",
        _ => "the worst case",
    }
}
