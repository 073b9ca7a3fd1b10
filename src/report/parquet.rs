//! The rows of map.csv with typed columns: Apache Parquet, for data frames.

use super::csv;
use crate::assess::Assessment;
use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

/// What a column holds.
enum Column {
    Text(Vec<ByteArray>),
    Count(Vec<i32>),
    Flag(Vec<bool>),
    /// Null where the table is empty.
    Number(Vec<Option<f64>>),
}

impl Column {
    fn of(name: &str) -> Self {
        match name {
            "operation" | "equipment" | "status" | "reason" => Self::Text(Vec::new()),
            "i" | "j" => Self::Count(Vec::new()),
            "best" => Self::Flag(Vec::new()),
            _ => Self::Number(Vec::new()),
        }
    }

    fn push(&mut self, cell: String) -> Result<(), String> {
        match self {
            Self::Text(all) => all.push(cell.into_bytes().into()),
            Self::Count(all) => all.push(cell.parse().map_err(|_| format!("no count: {cell}"))?),
            Self::Flag(all) => all.push(cell == "1"),
            Self::Number(all) if cell.is_empty() => all.push(None),
            Self::Number(all) => all.push(Some(cell.parse().map_err(|_| format!("no number: {cell}"))?)),
        }
        Ok(())
    }

    fn schema(&self, name: &str) -> Result<Type, ParquetError> {
        let (physical, repetition) = match self {
            Self::Text(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED),
            Self::Count(_) => (Physical::INT32, Repetition::REQUIRED),
            Self::Flag(_) => (Physical::BOOLEAN, Repetition::REQUIRED),
            Self::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL),
        };
        let plain = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        match self {
            Self::Text(_) => plain.with_converted_type(ConvertedType::UTF8).build(),
            _ => plain.build(),
        }
    }

    fn write(&self, to: &mut ColumnWriter<'_>) -> Result<usize, ParquetError> {
        match (self, to) {
            (Self::Text(all), ColumnWriter::ByteArrayColumnWriter(to)) => to.write_batch(all, None, None),
            (Self::Count(all), ColumnWriter::Int32ColumnWriter(to)) => to.write_batch(all, None, None),
            (Self::Flag(all), ColumnWriter::BoolColumnWriter(to)) => to.write_batch(all, None, None),
            (Self::Number(all), ColumnWriter::DoubleColumnWriter(to)) => {
                let values: Vec<f64> = all.iter().flatten().copied().collect();
                let there: Vec<i16> = all.iter().map(|v| i16::from(v.is_some())).collect();
                to.write_batch(&values, Some(&there), None)
            }
            _ => Err(ParquetError::General("a column of another type than said".into())),
        }
    }
}

/// The maps of all operations in one row group. World frame, mm and degrees by the names of the columns.
///
/// # Errors
/// Those of the parquet writer, which writes to memory here.
pub fn map(a: &Assessment<'_>) -> Result<Vec<u8>, String> {
    let names = csv::columns(a);
    let mut columns: Vec<Column> = names.iter().map(|name| Column::of(name)).collect();
    csv::rows(a, |row| columns.iter_mut().zip(row).try_for_each(|(column, cell)| column.push(cell)))?;
    written(a, &names, &columns).map_err(|e| e.to_string())
}

fn written(a: &Assessment<'_>, names: &[String], columns: &[Column]) -> Result<Vec<u8>, ParquetError> {
    let fields = names.iter().zip(columns).map(|(name, column)| Ok(Arc::new(column.schema(name)?)));
    let fields = fields.collect::<Result<_, ParquetError>>()?;
    let schema = Type::group_type_builder("map").with_fields(fields).build()?;
    let (cell, version) = (a.cell, env!("CARGO_PKG_VERSION"));
    let said = [
        ("cell", cell.name.clone()),
        ("robot", cell.robot.name.clone()),
        ("layout", a.label.clone()),
        ("question", super::text::headline(cell)),
        ("units", "length mm, angle deg, world frame; value in the unit of the objective".into()),
        ("value_unit", cell.unit().word().into()),
        ("version", version.into()),
    ];
    let said = said.into_iter().map(|(key, value)| KeyValue::new(format!("sweetspot.{key}"), value));
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_created_by(format!("sweetspot {version}"))
        .set_key_value_metadata(Some(said.collect()))
        .build();
    let mut file = SerializedFileWriter::new(Vec::new(), Arc::new(schema), Arc::new(properties))?;
    let mut group = file.next_row_group()?;
    for column in columns {
        let Some(mut writer) = group.next_column()? else { break };
        column.write(writer.untyped())?;
        writer.close()?;
    }
    group.close()?;
    file.into_inner()
}
