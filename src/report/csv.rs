//! Tables as CSV. The table map.csv has one row per node, and front.csv has one row per layout. The table
//! readings.csv has one row for each combination of operation, reading and registration.

use crate::cell::{Cell, Slot};
use crate::record::{
    GoalsEntry, MapDocument, NodeTable, ReadingEntry, ReadingsDocument, TableValue, coordinate_name, goals,
};
use crate::search::SearchRecord;
use crate::units::{deg_from_rad, mm_from_m, rounded};

/// Writes the nodes of all operations as CSV with a header. Positions are in the world frame, mm; angles are
/// in degrees.
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn map(document: &MapDocument<'_>) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let table = NodeTable::new(document);
    put(&mut writer, &table.columns().into_iter().map(|c| c.name).collect::<Vec<_>>())?;
    for row in table.rows() {
        put(&mut writer, &row.into_iter().map(field).collect::<Vec<_>>())?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}

fn field(value: TableValue) -> String {
    match value {
        TableValue::Text(text) => inert(&text),
        TableValue::Count(count) => count.to_string(),
        TableValue::Flag(flag) => flag_word(flag).into(),
        TableValue::Number(number) => or_empty(number),
    }
}

/// Returns a truth value as 1 or 0.
pub fn flag_word(flag: bool) -> &'static str {
    if flag { "1" } else { "0" }
}

/// Returns a number as text; the text is empty if the number is missing.
pub fn or_empty(value: Option<f64>) -> String {
    value.map_or(String::new(), |v| v.to_string())
}

/// Writes one row of a CSV file.
///
/// # Errors
/// Fails if the csv writer fails.
pub fn put(writer: &mut ::csv::Writer<Vec<u8>>, row: &[String]) -> Result<(), String> {
    writer.write_record(row).map_err(|e| e.to_string())
}

/// Writes one CSV row for each layout that a search kept, after a header. The goals come first, then the free
/// coordinates (mm, degrees).
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn front(cell: &Cell, record: &SearchRecord) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    let free = cell.free();
    let mut header = vec!["layout".to_string()];
    header.extend(cell.measured_goals().map(|goal| goals::key(goal).to_string()));
    header.extend(free.iter().map(|(slot, _)| inert(&variable(cell, *slot))));
    put(&mut writer, &header)?;
    for (k, alternative) in record.alternatives.iter().enumerate() {
        let mut row = vec![(k + 1).to_string()];
        let values = GoalsEntry::new(cell, &alternative.goals);
        row.extend(cell.measured_goals().map(|goal| values.get(goal).to_string()));
        row.extend(free.iter().map(|(slot, _)| {
            let value = alternative.candidate.layout.value(cell, *slot);
            let value = if slot.is_angle() { deg_from_rad(value) } else { mm_from_m(value) };
            rounded(value, 9).to_string()
        }));
        put(&mut writer, &row)?;
    }
    writer.into_inner().map_err(|e| e.to_string())
}

/// Returns the name of a free coordinate: its owner and its key in the cell file, such as "table x_mm".
fn variable(cell: &Cell, slot: Slot) -> String {
    let owner = match slot {
        Slot::Base(_) => "base",
        Slot::Equipment(k, _) => &cell.equipment[k].name,
        Slot::Attitude(k, _) => &cell.operations[k].name,
    };
    format!("{owner} {}", coordinate_name(slot))
}

/// Writes the readings of all operations as CSV with a header. Positions are in the world frame, mm.
///
/// # Errors
/// Fails if the csv writer fails, which is not expected because it writes to memory.
pub fn readings(document: &ReadingsDocument) -> Result<Vec<u8>, String> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    put(&mut writer, &READINGS.map(str::to_string))?;
    for operation in &document.operations {
        for reading in &operation.readings {
            put(&mut writer, &reading_columns(&operation.name, reading))?;
        }
    }
    writer.into_inner().map_err(|e| e.to_string())
}

const READINGS: [&str; 16] = [
    "operation",
    "reading",
    "quantity",
    "registration",
    "i",
    "j",
    "x_mm",
    "y_mm",
    "z_mm",
    "value",
    "unit",
    "at_signed_choice",
    "at_unregistered_choice",
    "ratio",
    "moved_mm",
    "reason",
];

fn reading_columns(operation: &str, r: &ReadingEntry) -> [String; 16] {
    let number = |place: usize| r.node.map_or(String::new(), |node| node[place].to_string());
    let coordinate = |axis: usize| or_empty(r.position_mm.map(|p| p[axis]));
    [
        inert(operation),
        r.reading.name().into(),
        r.quantity.clone(),
        r.registration.name().into(),
        number(0),
        number(1),
        coordinate(0),
        coordinate(1),
        coordinate(2),
        or_empty(r.value),
        r.unit.word().into(),
        or_empty(r.at_signed_choice),
        or_empty(r.at_unregistered_choice),
        or_empty(r.ratio),
        or_empty(r.moved_mm),
        r.reason.as_deref().map_or(String::new(), inert),
    ]
}

/// Puts an apostrophe before a text that a spreadsheet would read as a formula.
pub fn inert(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) { format!("'{text}") } else { text.to_string() }
}
