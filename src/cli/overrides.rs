//! What the command line says otherwise than the cell file.

use super::arguments::{Choice, Overrides};
use super::{Exit, output};
use crate::cell::{Cell, Model, Operation, PLAIN, Quantity, Reading, Registration, Sense, Unit};
use crate::files::fault::did_you_mean;
use crate::files::{Loaded, shown};
use crate::report;
use crate::units;

/// The cell as asked for on the command line; says what must be said about it.
pub fn overridden(mut loaded: Loaded, asked: &Overrides) -> Result<Loaded, Exit> {
    let cell = &mut loaded.cell;
    // clap has checked these against the same lists.
    set(&mut cell.quantity, &asked.quantity, &Quantity::ALL, Quantity::name);
    set(&mut cell.registration, &asked.registration, &Registration::ALL, Registration::name);
    if asked.quantity.is_some() {
        cell.reading = Reading::Statistical;
    }
    set(&mut cell.reading, &asked.reading, &Reading::ALL, Reading::name);
    choose(cell, &asked.choice)?;
    if asked.reading.is_none() && read_as_tolerance(cell) {
        output::talk(&format!(
            "note: {} is a tolerance: read as worst-case (--reading statistical for the other way)",
            shown(cell.error_set().name())
        ));
    }
    if asked.quantity.is_some() && cell.reading != Reading::Statistical {
        output::talk("note: --quantity says nothing: it is of the statistical reading");
    }
    answerable(cell)?;
    say_caveats(cell);
    Ok(loaded)
}

/// The cell with the errors chosen, to be read in every way.
pub fn chosen(mut loaded: Loaded, asked: &Choice) -> Result<Loaded, Exit> {
    let cell = &mut loaded.cell;
    choose(cell, asked)?;
    read_as_tolerance(cell);
    cell.reading = if cell.reading == Reading::Signed { cell.reading } else { Reading::WorstCase };
    answerable(cell)?;
    let magnitudes = Cell { reading: Reading::WorstCase, ..cell.clone() };
    say_caveats(&magnitudes);
    Ok(loaded)
}

fn choose(cell: &mut Cell, asked: &Choice) -> Result<(), Exit> {
    choose_errors(cell, asked)?;
    set(&mut cell.model, &asked.model, &Model::ALL, Model::name);
    choose_sense(cell, asked)?;
    if let Some(limit) = asked.limit {
        cell.operations.iter_mut().for_each(|o| o.limit = Some(limit_in_si(&o.sense, limit)));
    }
    Ok(())
}

fn limit_in_si(sense: &Sense, limit: f64) -> f64 {
    match sense.unit {
        Unit::Length => units::m_from_mm(limit),
        Unit::Angle => units::rad_from_deg(limit),
        Unit::Share => limit,
    }
}

/// A tolerance has no signs: it is read as the worst case if it would be read as signed.
fn read_as_tolerance(cell: &mut Cell) -> bool {
    let unsigned = cell.reading == Reading::Signed && cell.default_reading() != Reading::Signed;
    if unsigned {
        cell.reading = Reading::WorstCase;
    }
    unsigned
}

/// Refuses what has no answer, as the cell file would have been.
fn answerable(cell: &Cell) -> Result<(), Exit> {
    let faults = cell.question_faults();
    for fault in &faults {
        output::error(&fault.message);
        output::talk(&format!("  help: {}", fault.help));
    }
    if faults.is_empty() { Ok(()) } else { Err(Exit::BadInput) }
}

fn say_caveats(cell: &Cell) {
    for said in record::caveats(cell) {
        output::talk(&format!("note: {said}"));
    }
}

fn set<T: Copy>(value: &mut T, word: &Option<String>, all: &[T], name: impl Fn(T) -> &'static str) {
    let found = word.as_ref().and_then(|word| all.iter().copied().find(|v| name(*v) == word));
    *value = found.unwrap_or(*value);
}

fn choose_errors(cell: &mut Cell, asked: &Choice) -> Result<(), Exit> {
    let Some(name) = &asked.errors else { return Ok(()) };
    let names = || cell.robot.errors.iter().map(|e| e.name());
    let Some(found) = names().position(|n| n == name) else {
        return Err(unknown(&format!("the robot has no error set `{}`", shown(name)), name, names()));
    };
    cell.errors = found;
    Ok(())
}

fn choose_sense(cell: &mut Cell, asked: &Choice) -> Result<(), Exit> {
    let Some(word) = &asked.sense else { return Ok(()) };
    let Some(sense) = cell.sense(word) else {
        let defined = cell.senses.iter().map(|s| s.name.as_str());
        return Err(unknown(
            &format!("there is no sense `{}`", shown(word)),
            word,
            PLAIN.into_iter().chain(defined),
        ));
    };
    for operation in &mut cell.operations {
        // A limit of the other unit says nothing here.
        operation.limit = operation.limit.filter(|_| operation.sense.unit == sense.unit);
        operation.sense = sense.clone();
    }
    Ok(())
}

/// The operation of a name.
pub fn operation(cell: &Cell, name: &str) -> Result<usize, Exit> {
    let names = || cell.operations.iter().map(|o: &Operation| o.name.as_str());
    names()
        .position(|n| n == name)
        .ok_or_else(|| unknown(&format!("the cell has no operation `{}`", shown(name)), name, names()))
}

/// Says what is not known, and what is.
pub fn unknown<'a>(what: &str, word: &str, known: impl Iterator<Item = &'a str> + Clone) -> Exit {
    let near = did_you_mean(word, known.clone());
    let near = near.map(|n| format!("did you mean {}? ", shown(n))).unwrap_or_default();
    output::error(&format!("{what}; {near}there is: {}", known.map(shown).collect::<Vec<_>>().join(", ")));
    Exit::BadInput
}

/// The overrides as one would type them again, with a space before each.
pub fn again(asked: &Overrides) -> String {
    let Overrides { choice, reading, quantity, registration } = asked;
    let limit = choice.limit.map(|limit| limit.to_string());
    let given = [
        ("errors", &choice.errors),
        ("model", &choice.model),
        ("sense", &choice.sense),
        ("limit", &limit),
        ("reading", reading),
        ("quantity", quantity),
        ("registration", registration),
    ];
    let typed = |(name, value): (&str, &Option<String>)| {
        value.as_ref().map(|value| format!(" --{name} {}", output::word(value)))
    };
    given.into_iter().filter_map(typed).collect()
}
