//! The nodes of a map as a table with typed columns, the content of map.csv and map.parquet.

use super::map::{MapDocument, OperationMapEntry, SenseEntry};
use super::node::{BySense, MapNode};
use crate::cell::Unit;

/// Kind of the values in a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    Text,
    Count,
    Flag,
    Number,
}

/// Column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableColumn {
    pub name: String,
    pub kind: ColumnKind,
}

/// Value in a table.
#[derive(Debug, Clone, PartialEq)]
pub enum TableValue {
    Text(String),
    Count(usize),
    Flag(bool),
    /// Number; None if there is no value.
    Number(Option<f64>),
}

/// Name of a statistical or worst-case figure, and a function that returns its values at a node. The function
/// returns the values for the senses in mm, then the values for the senses in degrees.
type FigureColumns = (&'static str, fn(&MapNode) -> [&Option<BySense>; 2]);

const FIGURES: [FigureColumns; 5] = [
    ("worst", |n| [&n.worst_mm, &n.worst_deg]),
    ("rms", |n| [&n.rms_mm, &n.rms_deg]),
    ("mean", |n| [&n.mean_mm, &n.mean_deg]),
    ("p95", |n| [&n.p95_mm, &n.p95_deg]),
    ("p99", |n| [&n.p99_mm, &n.p99_deg]),
];

/// Columns before the joint coordinates. [`ERROR_COLUMNS`] follow the joint coordinates, and
/// [`REFINED_COLUMNS`] are last.
const PLACE_COLUMNS: [(&str, ColumnKind); 9] = [
    ("operation", ColumnKind::Text),
    ("equipment", ColumnKind::Text),
    ("i", ColumnKind::Count),
    ("j", ColumnKind::Count),
    ("x_mm", ColumnKind::Number),
    ("y_mm", ColumnKind::Number),
    ("z_mm", ColumnKind::Number),
    ("status", ColumnKind::Text),
    ("reason", ColumnKind::Text),
];
const ERROR_COLUMNS: [&str; 19] = [
    "error_x_mm",
    "error_y_mm",
    "error_z_mm",
    "error_sense_mm",
    "error_sense_deg",
    "rotation_x_deg",
    "rotation_y_deg",
    "rotation_z_deg",
    "linear_x_mm",
    "linear_y_mm",
    "linear_z_mm",
    "discrepancy_x_percent",
    "discrepancy_y_percent",
    "discrepancy_z_percent",
    "discrepancy_r_percent",
    "linear_off_percent",
    "second_order_off_percent",
    "value",
    "yield",
];
const REFINED_COLUMNS: [&str; 4] = ["refined_x_mm", "refined_y_mm", "refined_z_mm", "refined_value"];

/// Nodes of all operations of a map, one row per node. Positions are in the world frame, mm; angles are in
/// degrees.
pub struct NodeTable<'d> {
    document: &'d MapDocument<'d>,
    /// All senses that the operations report.
    senses: Vec<&'d SenseEntry>,
}

impl<'d> NodeTable<'d> {
    pub fn new(document: &'d MapDocument<'d>) -> Self {
        let mut senses: Vec<&SenseEntry> = Vec::new();
        for sense in document.operations.iter().flat_map(|o| &o.senses) {
            if !senses.iter().any(|s| s.name == sense.name) {
                senses.push(sense);
            }
        }
        Self { document, senses }
    }

    /// Returns the columns in the order of the table.
    pub fn columns(&self) -> Vec<TableColumn> {
        let column = |name: String, kind| TableColumn { name, kind };
        let number = |name: String| column(name, ColumnKind::Number);
        let place = PLACE_COLUMNS.map(|(name, kind)| column(name.into(), kind)).into_iter();
        let joints = self.document.joints.iter().enumerate();
        let joints = joints.map(|(k, joint)| number(format!("q{}_{}", k + 1, joint.unit.word())));
        let errors = ERROR_COLUMNS.map(|name| number(name.into())).into_iter();
        let figures = FIGURES.iter().flat_map(|(figure, _)| {
            self.senses.iter().map(move |s| format!("{figure}_{}_{}", s.name, s.unit.word()))
        });
        let best = column("best".into(), ColumnKind::Flag);
        let refined = REFINED_COLUMNS.map(|name| number(name.into()));
        place.chain(joints).chain(errors).chain(figures.map(number)).chain([best]).chain(refined).collect()
    }

    /// Iterates over the rows. Each row is made when it is needed, because a map can have a million rows.
    pub fn rows(&self) -> impl Iterator<Item = Vec<TableValue>> + '_ {
        self.document
            .operations
            .iter()
            .flat_map(move |operation| operation.nodes.iter().map(move |node| self.row(operation, &node)))
    }

    fn row(&self, operation: &OperationMapEntry<'_>, node: &MapNode) -> Vec<TableValue> {
        let is_best = operation.best.as_ref().is_some_and(|best| (best.i, best.j) == (node.i, node.j));
        let refined = operation.refined.as_ref().filter(|_| is_best);
        let mut row = vec![
            TableValue::Text(operation.name.clone()),
            TableValue::Text(operation.equipment.clone()),
            TableValue::Count(node.i),
            TableValue::Count(node.j),
        ];
        row.extend(node.position_mm.map(|v| TableValue::Number(Some(v))));
        row.push(TableValue::Text(node.status.name().into()));
        row.push(TableValue::Text(node.reason.clone()));
        let joints = 0..self.document.joints.len();
        row.extend(joints.map(|k| TableValue::Number(node.joints_deg.as_ref().map(|q| q[k]))));
        row.extend(errors(node).map(TableValue::Number));
        for (_, figure) in FIGURES {
            row.extend(self.senses.iter().map(|sense| {
                let [lengths, angles] = figure(node);
                let values = if sense.unit == Unit::Angle { angles } else { lengths };
                TableValue::Number(values.as_ref().and_then(|v| v.get(&sense.name)).copied())
            }));
        }
        row.push(TableValue::Flag(is_best));
        row.extend([0, 1, 2].map(|k| TableValue::Number(refined.map(|r| r.position_mm[k]))));
        row.push(TableValue::Number(refined.map(|r| r.value)));
        row
    }
}

/// Returns the values of [`ERROR_COLUMNS`].
fn errors(node: &MapNode) -> [Option<f64>; 19] {
    let of = |v: &Option<[f64; 3]>| [0, 1, 2].map(|k| v.map(|v| v[k]));
    let [[ex, ey, ez], [rx, ry, rz], [lx, ly, lz]] =
        [&node.error_mm, &node.rotation_deg, &node.linear_error_mm].map(of);
    let d = node.discrepancy_percent;
    [
        ex,
        ey,
        ez,
        node.error_sense_mm,
        node.error_sense_deg,
        rx,
        ry,
        rz,
        lx,
        ly,
        lz,
        d.and_then(|d| d.x),
        d.and_then(|d| d.y),
        d.and_then(|d| d.z),
        d.and_then(|d| d.r),
        node.linear_off_percent,
        node.second_order_off_percent,
        node.value,
        node.r#yield,
    ]
}
