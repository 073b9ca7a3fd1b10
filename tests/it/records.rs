//! Tests the documents of shipped cells. Each document is valid against its published schema, and the type
//! that wrote it can read it again. A document with an unknown field is refused.

use crate::common::workcell;
use jsonschema::Validator;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::sync::atomic::AtomicBool;
use sweetspot::assess::{
    AllocatedNodes, Assessment, BudgetReport, CellAllocation, Comparison, Explanation, NoAllocation,
    NodeChoice, PostureContext, Readings,
};
use sweetspot::cell::Reading;
use sweetspot::layout::Workcell;
use sweetspot::proof::{ProofOptions, prove};
use sweetspot::record::{
    AllocationDocument, BudgetDocument, ComparisonDocument, DocumentKind, ExplanationDocument, MapDocument,
    NodeTable, ReadingsDocument, RobustDocument, SearchResult, SweepRow, TableValue,
};
use sweetspot::search::{Watch, search};

/// Cells whose map and assessment take at most a second.
const CELLS: [&str; 6] = [
    "drilling_cell.toml",
    "five_axis_cell.toml",
    "hitachi_cell.toml",
    "hitachi_paper.toml",
    "scara_cell.toml",
    "wrist_cell.toml",
];

fn validator(kind: DocumentKind) -> Validator {
    let schema = kind.schema();
    assert!(jsonschema::draft7::meta::is_valid(&schema), "{}", kind.name());
    jsonschema::draft7::new(&schema).unwrap()
}

/// Checks a document against its schema, and reads it with the type that wrote it.
fn holds<R: Serialize + DeserializeOwned>(kind: DocumentKind, document: &impl Serialize, what: &str) {
    let name = kind.name();
    let value = serde_json::to_value(document).unwrap();
    let validator = validator(kind);
    let faults: Vec<_> =
        validator.iter_errors(&value).map(|e| format!("{}: {e}", e.instance_path())).collect();
    assert!(faults.is_empty(), "{name} of {what}: {faults:#?}");
    let read: R = serde_json::from_value(value.clone()).unwrap_or_else(|e| panic!("{name} of {what}: {e}"));
    let again = serde_json::to_string(&read).unwrap();
    assert!(again == serde_json::to_string(document).unwrap(), "{name} of {what} changes when rewritten");
    for unknown in with_unknown_field(&value) {
        assert!(!validator.is_valid(&unknown), "{name} of {what}: the schema accepts an unknown field");
        let refused = serde_json::from_value::<R>(unknown).is_err();
        assert!(refused, "{name} of {what}: the reader accepts an unknown field");
    }
}

/// Returns copies of the document with one unknown field each: at the top, or in the first object of a list.
fn with_unknown_field(document: &Value) -> Vec<Value> {
    let mut top = document.clone();
    top["unknown_field"] = json!(1);
    let mut all = vec![top];
    for (key, value) in document.as_object().unwrap() {
        if value.as_array().is_some_and(|list| list.first().is_some_and(Value::is_object)) {
            let mut inside = document.clone();
            inside[key][0]["unknown_field"] = json!(1);
            all.push(inside);
        }
    }
    all
}

fn accounts<'a>(workcell: &'a Workcell, a: &Assessment<'a>) -> Vec<BudgetReport<'a>> {
    let context = |k| PostureContext::at(workcell, &a.layout, &a.maps, k, NodeChoice::Best).ok();
    (0..a.maps.len()).filter_map(|k| context(k).map(BudgetReport::new)).collect()
}

#[test]
fn documents_of_shipped_cells_validate_against_their_schemas() {
    for name in CELLS {
        let workcell = workcell(name);
        let cell = &workcell.cell;
        let a = Assessment::new("start", &workcell, cell.start()).misplaced();
        holds::<MapDocument<'static>>(DocumentKind::Map, &MapDocument::new(&a), name);
        holds::<RobustDocument>(DocumentKind::Robust, &RobustDocument::new(&a), name);
        let accounts = accounts(&workcell, &a);
        assert!(!accounts.is_empty(), "{name}");
        holds::<BudgetDocument>(DocumentKind::Budget, &BudgetDocument::new(cell, &accounts), name);
        let context = PostureContext::at(&workcell, &a.layout, &a.maps, 0, NodeChoice::Best);
        if let Ok(context) = context {
            let document = ExplanationDocument::new(&Explanation::new(context));
            holds::<ExplanationDocument>(DocumentKind::Explanation, &document, name);
        }
        let row = SweepRow::new(&[], 0, &a, None);
        holds::<SweepRow>(DocumentKind::SweepRow, &row, name);
        let other = Assessment::new("other", &workcell, cell.start());
        let comparison = Comparison::new(vec![a, other]).unwrap();
        let document = ComparisonDocument::new(&comparison);
        holds::<ComparisonDocument>(DocumentKind::Comparison, &document, name);
    }
}

#[test]
fn results_of_searches_and_readings_validate_against_their_schemas() {
    let mut workcell = workcell("hitachi_cell.toml");
    (workcell.cell.search.budget, workcell.cell.search.keep) = (200, 2);
    let stop = AtomicBool::new(false);
    let record = search(&workcell, &workcell.cell.search, &Watch { progress: &|_| {}, stop: &stop });
    let proof = prove(&workcell, &ProofOptions::default(), &stop);
    let [start, best] = [("start", &record.start), ("best", &record.best)]
        .map(|(label, found)| Assessment::new(label, &workcell, found.layout.clone()));
    let comparison = Comparison::new(vec![start, best]).unwrap();
    let result = SearchResult::of_comparison(&record, &proof, &comparison).unwrap();
    holds::<SearchResult>(DocumentKind::SearchResult, &result, "a search");
    holds::<SearchResult>(DocumentKind::SearchResult, &result.timed(1.0), "a timed search");
    let readings = Readings::new(&workcell.cell).unwrap();
    let document = ReadingsDocument::new(&readings, vec!["a finding".into()]);
    holds::<ReadingsDocument>(DocumentKind::Readings, &document, "all readings");
}

#[test]
fn allocations_validate_against_their_schema() {
    for (limit, statistical) in [(0.02, false), (0.008, true), (0.001, false)] {
        let mut cell = crate::common::shipped("hitachi_cell.toml");
        cell.operations.iter_mut().for_each(|operation| operation.limit = Some(limit));
        cell.reading = if statistical { Reading::Statistical } else { Reading::WorstCase };
        let workcell = Workcell::new(cell).unwrap();
        let layout = workcell.cell.start();
        let maps = workcell.maps(&layout);
        let problem =
            CellAllocation::new(&workcell, &layout, &maps, (None, AllocatedNodes::Spots), 0.99).unwrap();
        let found = match problem.solve() {
            Ok(found) => Ok(found),
            Err(NoAllocation::Infeasible(shortfalls)) => Err(shortfalls),
            Err(why) => panic!("{why:?}"),
        };
        assert_eq!(found.is_err(), limit == 0.001);
        let document = AllocationDocument::new(&problem, found.as_ref().map_err(Vec::as_slice));
        holds::<AllocationDocument>(DocumentKind::Allocation, &document, "an allocation");
    }
}

/// CSV and Parquet are written from these rows, so each value must have the kind of its column.
#[test]
fn rows_of_the_node_table_have_the_kinds_of_its_columns() {
    use sweetspot::record::ColumnKind as Kind;
    let workcell = workcell("drilling_cell.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let document = MapDocument::new(&a);
    let table = NodeTable::new(&document);
    let columns = table.columns();
    let mut rows = 0;
    for row in table.rows() {
        assert_eq!(row.len(), columns.len());
        for (value, column) in row.iter().zip(&columns) {
            let kind = match value {
                TableValue::Text(_) => Kind::Text,
                TableValue::Count(_) => Kind::Count,
                TableValue::Flag(_) => Kind::Flag,
                TableValue::Number(_) => Kind::Number,
            };
            assert_eq!(kind, column.kind, "{}", column.name);
        }
        rows += 1;
    }
    assert_eq!(rows, a.maps.iter().map(|m| m.nodes.len()).sum::<usize>());
}

/// The words in a document equal the names that the program uses.
#[test]
fn words_of_documents_equal_the_names_in_the_program() {
    use sweetspot::cell::{
        Goal, Model, NodeAggregation, Objective, Quantity, Reading, Registration, Solver, Unit,
    };
    use sweetspot::error_map::NodeSign;
    use sweetspot::record::ParameterUnit;
    fn same<T: Serialize + Copy>(all: &[T], name: impl Fn(T) -> &'static str) {
        all.iter().for_each(|word| assert_eq!(json!(word), json!(name(*word))));
    }
    same(&Model::ALL, Model::name);
    same(&Reading::ALL, Reading::name);
    same(&Quantity::ALL, Quantity::name);
    same(&Registration::ALL, Registration::name);
    same(&NodeAggregation::ALL, NodeAggregation::name);
    same(&Objective::ALL, Objective::name);
    same(&Solver::ALL, Solver::name);
    same(&Goal::ALL, Goal::name);
    same(&Unit::ALL, Unit::word);
    same(&ParameterUnit::ALL, ParameterUnit::word);
    same(&NodeSign::ALL, NodeSign::name);
}

/// The nodes of a map are written one by one. Neither a list nor the text of all nodes is in memory.
#[test]
fn a_map_is_written_node_by_node() {
    let workcell = workcell("hitachi_paper.toml");
    let assessment = Assessment::new("start", &workcell, workcell.cell.start());
    let document = MapDocument::new(&assessment);
    let written = serde_json::to_string(&document).unwrap();
    // A document that is written through a value in memory has the same bytes.
    assert_eq!(written, serde_json::to_value(&document).unwrap().to_string());
    let erased: &dyn erased_serde::Serialize = &document;
    let mut bytes = 0;
    let counted = allocation_counter::measure(|| {
        let mut out = CountedBytes(&mut bytes);
        serde_json::to_writer(&mut out, erased).unwrap();
    });
    assert_eq!(bytes, written.len());
    let of_node = written.len() as u64 / 99;
    assert!(counted.bytes_max < 8 * of_node, "{} bytes at most, {of_node} per node", counted.bytes_max);
}

/// Writer that counts its bytes and discards them.
struct CountedBytes<'a>(&'a mut usize);

impl std::io::Write for CountedBytes<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        *self.0 += bytes.len();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
