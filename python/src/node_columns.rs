//! Columns of the nodes of a map.
//!
//! The table has the columns of map.csv that have a value for at least one node. The table leaves out the
//! columns of the spot refined between the nodes, because this spot is not a node. A figure in the sense of
//! the operation has a name without the sense. If this sense is xy, for example, the column `p95_mm` has the
//! values of the column `p95_xy_mm` of map.csv.

use crate::table::table;
use arrow_array::builder::{BooleanBuilder, PrimitiveBuilder, StringDictionaryBuilder};
use arrow_array::types::{Float64Type, Int32Type, UInt32Type};
use arrow_array::{ArrayRef, RecordBatch};
use pyo3::prelude::*;
use std::sync::Arc;
use sweetspot::record::{
    ColumnKind, MapDocument, MapNodes, NodeTable, OperationMapEntry, TableColumn, TableValue,
};

/// Figures that the table has for every sense.
const FIGURES: [&str; 5] = ["worst", "rms", "mean", "p95", "p99"];

/// Column that grows row by row. A column without values needs no memory.
enum Column {
    Text(StringDictionaryBuilder<Int32Type>),
    Count(PrimitiveBuilder<UInt32Type>),
    Flag(BooleanBuilder),
    Number { values: Option<PrimitiveBuilder<Float64Type>>, rows: usize, all: usize },
}

impl Column {
    fn new(kind: ColumnKind, all: usize) -> Self {
        match kind {
            ColumnKind::Text => Self::Text(StringDictionaryBuilder::new()),
            ColumnKind::Count => Self::Count(PrimitiveBuilder::with_capacity(all)),
            ColumnKind::Flag => Self::Flag(BooleanBuilder::with_capacity(all)),
            ColumnKind::Number => Self::Number { values: None, rows: 0, all },
        }
    }

    fn push(&mut self, value: &TableValue) {
        match (self, value) {
            (Self::Text(column), TableValue::Text(text)) => column.append_value(text),
            (Self::Count(column), TableValue::Count(count)) => column.append_value(*count as u32),
            (Self::Flag(column), TableValue::Flag(flag)) => column.append_value(*flag),
            (Self::Number { values, rows, all }, TableValue::Number(number)) => {
                if let (None, Some(_)) = (&values, number) {
                    let mut begun = PrimitiveBuilder::with_capacity(*all);
                    begun.append_nulls(*rows);
                    *values = Some(begun);
                }
                values.iter_mut().for_each(|column| column.append_option(*number));
                *rows += 1;
            }
            // No other pair occurs, because every value has the kind that the table states for its column.
            _ => {}
        }
    }

    /// Returns the column; None if it holds no value.
    fn finish(self) -> Option<ArrayRef> {
        match self {
            Self::Text(mut column) => Some(Arc::new(column.finish())),
            Self::Count(mut column) => Some(Arc::new(column.finish())),
            Self::Flag(mut column) => Some(Arc::new(column.finish())),
            Self::Number { values, .. } => values.map(|mut column| Arc::new(column.finish()) as ArrayRef),
        }
    }
}

/// Returns the nodes of a map as a table. `every_sense` adds the figures in all senses to the figures in
/// the sense of the operation.
pub fn node_columns(document: &MapDocument<'_>, every_sense: bool) -> PyResult<RecordBatch> {
    let (table_of_nodes, all) = (NodeTable::new(document), rows(document));
    let columns = table_of_nodes.columns();
    let place = |name: &str| columns.iter().position(|column| column.name == name);
    let mut kept: Vec<Option<Column>> = columns
        .iter()
        .map(|column| is_kept(column, document, every_sense).then(|| Column::new(column.kind, all)))
        .collect();
    let mut own: Vec<(String, Column)> = Vec::new();
    for figure in FIGURES {
        for unit in ["mm", "deg"] {
            own.push((format!("{figure}_{unit}"), Column::new(ColumnKind::Number, all)));
        }
    }
    // This list holds, for each operation and each figure in its own sense, the index of the column with the
    // value.
    let sources = document.operations.iter().map(|operation| {
        let source = |name: &String| {
            let (figure, unit) = name.split_once('_')?;
            place(&format!("{figure}_{}_{unit}", operation.sense))
        };
        own.iter().map(|(name, _)| source(name)).collect::<Vec<_>>()
    });
    let sources: Vec<Vec<Option<usize>>> = sources.collect();
    let counts = document.operations.iter().map(nodes);
    let of_row = counts.enumerate().flat_map(|(k, count)| std::iter::repeat_n(k, count));
    for (row, operation) in table_of_nodes.rows().zip(of_row) {
        for (column, value) in kept.iter_mut().zip(&row) {
            column.iter_mut().for_each(|column| column.push(value));
        }
        for ((_, column), source) in own.iter_mut().zip(&sources[operation]) {
            column.push(source.map_or(&TableValue::Number(None), |k| &row[k]));
        }
    }
    let names = columns.into_iter().map(|column| column.name);
    let kept = names.zip(kept).filter_map(|(name, column)| Some((name, column?.finish()?)));
    let own = own.into_iter().filter_map(|(name, column)| Some((name, column.finish()?)));
    table(kept.chain(own).collect())
}

fn nodes(operation: &OperationMapEntry<'_>) -> usize {
    match &operation.nodes {
        MapNodes::Read(nodes) => nodes.len(),
        MapNodes::OfMap(_, map) => map.nodes.len(),
    }
}

fn rows(document: &MapDocument<'_>) -> usize {
    document.operations.iter().map(nodes).sum()
}

fn is_kept(column: &TableColumn, document: &MapDocument<'_>, every_sense: bool) -> bool {
    let is_figure = document.operations.iter().flat_map(|o| &o.senses).any(|sense| {
        let end = format!("_{}_{}", sense.name, sense.unit.word());
        column.name.strip_suffix(&end).is_some_and(|figure| FIGURES.contains(&figure))
    });
    !column.name.starts_with("refined_") && (every_sense || !is_figure)
}
