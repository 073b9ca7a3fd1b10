//! What the command line says otherwise than the cell file.

use super::arguments::Overrides;
use super::{Exit, output};
use crate::cell::fault::did_you_mean;
use crate::cell::{Cell, Loaded, Model, PLAIN, Quantity, Reading, Registration, shown};
use crate::report;

/// The cell as asked for on the command line; says what must be said about it.
pub fn overridden(mut loaded: Loaded, asked: &Overrides) -> Result<Loaded, Exit> {
    let cell = &mut loaded.cell;
    choose_errors(cell, asked)?;
    // clap has checked these against the same lists.
    set(&mut cell.model, &asked.model, &Model::ALL, Model::name);
    set(&mut cell.reading, &asked.reading, &Reading::ALL, Reading::name);
    set(&mut cell.quantity, &asked.quantity, &Quantity::ALL, Quantity::name);
    set(&mut cell.registration, &asked.registration, &Registration::ALL, Registration::name);
    choose_sense(cell, asked)?;
    for said in report::text::caveats(cell) {
        output::talk(&format!("note: {said}"));
    }
    Ok(loaded)
}

fn set<T: Copy>(value: &mut T, word: &Option<String>, all: &[T], name: impl Fn(T) -> &'static str) {
    let found = word.as_ref().and_then(|word| all.iter().copied().find(|v| name(*v) == word));
    *value = found.unwrap_or(*value);
}

fn choose_errors(cell: &mut Cell, asked: &Overrides) -> Result<(), Exit> {
    let Some(name) = &asked.errors else { return Ok(()) };
    let names = || cell.robot.errors.iter().map(|e| e.name());
    let Some(found) = names().position(|n| n == name) else {
        return Err(unknown(&format!("the robot has no error set `{}`", shown(name)), name, names()));
    };
    cell.errors = found;
    Ok(())
}

fn choose_sense(cell: &mut Cell, asked: &Overrides) -> Result<(), Exit> {
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

/// Says what is not known, and what is.
fn unknown<'a>(what: &str, word: &str, known: impl Iterator<Item = &'a str> + Clone) -> Exit {
    let near = did_you_mean(word, known.clone()).map(|n| format!("did you mean {n}? ")).unwrap_or_default();
    output::error(&format!("{what}; {near}there is: {}", known.collect::<Vec<_>>().join(", ")));
    Exit::BadInput
}
