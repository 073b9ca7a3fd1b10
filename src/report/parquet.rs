//! The nodes of a map as an Apache Parquet table for data analysis, with the columns of map.csv.

use crate::assess::Assessment;
use crate::record::{ColumnKind, MapDocument, NodeTable, TableColumn, TableValue};
use parquet::basic::{Compression, ConvertedType, Repetition, Type as Physical};
use parquet::column::writer::ColumnWriter;
use parquet::data_type::ByteArray;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use std::sync::Arc;

/// Values of one column.
enum ColumnValues {
    Text(Vec<ByteArray>),
    Count(Vec<i32>),
    Flag(Vec<bool>),
    /// Numbers; None becomes null.
    Number(Vec<Option<f64>>),
}

impl ColumnValues {
    fn new(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Text => Self::Text(Vec::new()),
            ColumnKind::Count => Self::Count(Vec::new()),
            ColumnKind::Flag => Self::Flag(Vec::new()),
            ColumnKind::Number => Self::Number(Vec::new()),
        }
    }

    fn push(&mut self, value: TableValue) -> Result<(), String> {
        match (self, value) {
            (Self::Text(all), TableValue::Text(text)) => all.push(text.into_bytes().into()),
            (Self::Count(all), TableValue::Count(count)) => {
                all.push(
                    count.try_into().map_err(|_| format!("{count} is too large for a column of counts"))?,
                );
            }
            (Self::Flag(all), TableValue::Flag(flag)) => all.push(flag),
            (Self::Number(all), TableValue::Number(number)) => all.push(number),
            (_, value) => return Err(format!("{value:?} does not belong in its column")),
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
            _ => Err(ParquetError::General("a column does not have the type that was declared".into())),
        }
    }
}

/// Writes the nodes of all operations in one row group. Positions are in the world frame; the names of the
/// columns state the units.
///
/// # Errors
/// Fails if the Parquet writer fails, which is not expected because it writes to memory.
pub fn map(a: &Assessment<'_>) -> Result<Vec<u8>, String> {
    let document = MapDocument::new(a);
    let table = NodeTable::new(&document);
    let heads = table.columns();
    let mut columns: Vec<ColumnValues> = heads.iter().map(|head| ColumnValues::new(head.kind)).collect();
    for row in table.rows() {
        columns.iter_mut().zip(row).try_for_each(|(column, value)| column.push(value))?;
    }
    written(a, &heads, &columns).map_err(|e| e.to_string())
}

fn written(
    a: &Assessment<'_>,
    heads: &[TableColumn],
    columns: &[ColumnValues],
) -> Result<Vec<u8>, ParquetError> {
    let fields = heads.iter().zip(columns).map(|(head, column)| Ok(Arc::new(column.schema(&head.name)?)));
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
