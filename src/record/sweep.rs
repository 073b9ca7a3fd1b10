//! Documents of a sweep: the plan, the row of each combination of settings, and the table of all rows.

use super::manifest::HashedFile;
use super::numbers::{in_unit, nine_digits, position_mm, rounded_down};
use super::placement::{ByName, PlacementEntry, placements};
use super::verdict::RequirementState;
use crate::assess::Assessment;
use crate::cell::{Solver, Unit};
use crate::files::{Choices, Setting};
use crate::search::SearchRecord;
use crate::units::rounded;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Name and version of the schema of a [`SweepPlan`].
pub const SWEEP_PLAN_SCHEMA: &str = "sweetspot/sweep-plan/1";
/// Name and version of the table of a sweep.
pub const SWEEP_SCHEMA: &str = "sweetspot/sweep/1";

/// Plan of a sweep, `plan.json`. A combination takes one value of every `--set` option. Plans with equal
/// fields give files with equal bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepPlan {
    #[schemars(extend("const" = SWEEP_PLAN_SCHEMA))]
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// Path of the cell file.
    pub cell: PathBuf,
    /// Name and folder of each ROS package that the option `--package` gives.
    pub packages: Vec<(String, PathBuf)>,
    /// Whether a search runs for every combination. If false, the layout of the cell file is mapped.
    pub search: bool,
    pub sets: Vec<Choices>,
    /// Flags of the command `search --islands`. This command is run as a sweep: each seed gives one
    /// combination, and each combination is one search. The flags apply to all searches, and `sets` contains
    /// the seeds. Left out in the plan of the command `sweep`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub island_flags: Option<Vec<Setting>>,
    /// Seed of every combination; null means the seed of the cell.
    pub seed: Option<u64>,
    pub budget: Option<u64>,
    pub solver: Option<Solver>,
    pub combinations: usize,
    /// Hashes of the files that the combinations read; empty until the program has read these files.
    pub inputs: Vec<HashedFile>,
    /// Hexadecimal SHA-256 of all bytes before the comma in front of this key. The program adds this key to
    /// the text when it writes the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// Returns the value of each `--set` option in a combination. The last option changes fastest.
pub fn combination(sets: &[Choices], index: usize) -> Vec<&str> {
    let mut rest = index;
    let mut values: Vec<&str> = sets
        .iter()
        .rev()
        .map(|set| {
            let value = &set.values[rest % set.values.len()];
            rest /= set.values.len();
            value.as_str()
        })
        .collect();
    values.reverse();
    values
}

impl SweepPlan {
    /// Makes the plan of a single search for the layout of a cell. The plan states the version of the running
    /// program.
    pub fn of_cell(cell: &Path, packages: &[(String, PathBuf)]) -> Self {
        Self {
            schema: SWEEP_PLAN_SCHEMA.into(),
            version: env!("CARGO_PKG_VERSION").into(),
            cell: cell.to_path_buf(),
            packages: packages.to_vec(),
            search: true,
            sets: Vec::new(),
            island_flags: None,
            seed: None,
            budget: None,
            solver: None,
            combinations: 1,
            inputs: Vec::new(),
            sha256: None,
        }
    }

    /// Returns the settings of a combination.
    pub fn settings(&self, index: usize) -> Vec<Setting> {
        let pairs = self.sets.iter().zip(combination(&self.sets, index));
        let flags = self.island_flags.iter().flatten();
        let others = flags.filter(|flag| self.sets.iter().all(|set| set.path != flag.path)).cloned();
        pairs.map(|(set, value)| Setting::new(set.path.clone(), value)).chain(others).collect()
    }

    /// Returns the command line that runs the islands of a search and merges their results.
    pub fn command(&self) -> Vec<String> {
        let packages = self.packages.iter().map(|(name, folder)| format!("{name}={}", folder.display()));
        let packages = packages.flat_map(|package| ["--package".to_string(), package]);
        let flags = self.island_flags.iter().flatten().filter_map(|setting| setting.flag.as_ref());
        let flags = flags.flat_map(|flag| flag.splitn(2, ' ').map(String::from));
        let cell = ["search".to_string(), self.cell.to_string_lossy().into_owned()];
        let islands = ["--islands".to_string(), self.combinations.to_string()];
        cell.into_iter().chain(packages).chain(flags).chain(islands).collect()
    }

    /// Returns whether the combinations are the islands of one search.
    pub fn is_of_islands(&self) -> bool {
        self.island_flags.is_some()
    }
}

/// Result of one combination, `NNNN.json`, where NNNN is the index with at least four digits. Positions are
/// in the world frame, mm; angles are in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepRow {
    pub index: usize,
    /// Values of the `--set` options. The key of each value is the path that the option states. A value is
    /// parsed as JSON if possible; otherwise it is text.
    pub set: ByName<Value>,
    pub feasible: bool,
    /// Objective of the layout in `unit`; null if the layout is not feasible.
    pub objective: Option<f64>,
    pub unit: Unit,
    /// Proven lower bound of the objective of every layout; null if no bound is known or no search ran.
    pub bound: Option<f64>,
    pub gap_percent: Option<f64>,
    /// Number of layouts evaluated.
    pub evaluations: u64,
    /// Number of evaluated layouts that are feasible and, if a search ran, within every limit.
    pub feasible_evaluations: u64,
    pub operations: Vec<SweepSpot>,
    pub layout: ByName<PlacementEntry>,
    /// Reasons why the layout is not feasible.
    pub reasons: Vec<String>,
    /// Files of the combination with their hashes: the cell file with this layout as fixed placements, and
    /// the file with the settings. Empty if the layout is not feasible. For an island of a search, the only
    /// file is NNNN.island.json.
    pub files: Vec<HashedFile>,
    /// Hexadecimal SHA-256 of all bytes before the comma in front of this key. The program adds this key to
    /// the text when it writes the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// One operation in the result of a combination: its spot, error and limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepSpot {
    pub name: String,
    /// Value of the operation, in the unit of the objective; null if the operation has no spot.
    pub value: Option<f64>,
    pub position_mm: Option<[f64; 3]>,
    /// Error that the operation's sense measures, in `error_unit`.
    pub error: Option<f64>,
    /// Largest allowed error of the operation, in `error_unit`.
    pub limit: Option<f64>,
    pub error_unit: Unit,
    /// Whether the limit is met; null if the operation has no limit or no spot. The limit counts as missed if
    /// `requirement` is `not-guaranteed`.
    pub limit_met: Option<bool>,
    /// State of the limit: `met`, `missed`, `not-guaranteed`, or `none` (no limit or no spot). The state
    /// `not-guaranteed` means that the limit is met without misplacement, but is not proven to be met for all
    /// misplacements.
    pub requirement: RequirementState,
}

impl SweepRow {
    /// Makes the row of a combination. `a` is the assessment of the layout that the combination gives.
    /// `record` is the record of the search; None if no search ran.
    pub fn new(sets: &[Choices], index: usize, a: &Assessment<'_>, record: Option<&SearchRecord>) -> Self {
        let paths = sets.iter().map(|s| s.path.clone());
        let typed = combination(sets, index).into_iter();
        let read = typed.map(|v| serde_json::from_str(v).unwrap_or_else(|_| Value::String(v.into())));
        let feasible = a.evaluation.objective.is_some();
        Self {
            index,
            set: paths.zip(read).collect(),
            feasible,
            objective: a.objective().map(nine_digits),
            unit: a.cell.unit(),
            bound: record.and_then(|r| r.bound).map(|b| rounded_down(a.cell.unit().from_si(b))),
            gap_percent: record.and_then(SearchRecord::gap).map(|g| rounded(g * 100.0, 6)),
            evaluations: record.map_or(1, |r| r.evaluations),
            feasible_evaluations: record.map_or(u64::from(feasible), |r| r.feasible),
            operations: (0..a.maps.len()).map(|k| SweepSpot::new(a, k)).collect(),
            layout: placements(a.cell, &a.layout),
            reasons: a.reasons(),
            files: Vec::new(),
            sha256: None,
        }
    }
}

impl SweepRow {
    /// Returns whether every operation that has a limit and a spot meets its limit.
    pub fn meets_limits(&self) -> bool {
        self.operations.iter().all(|spot| spot.limit_met != Some(false))
    }
}

impl SweepSpot {
    fn new(a: &Assessment<'_>, k: usize) -> Self {
        let operation = &a.cell.operations[a.maps[k].operation];
        let (error_unit, at) = (operation.sense.unit, a.spot(k));
        let error = a.error_at(k, &operation.sense.name);
        let limit = operation.limit.map(|limit| error_unit.from_si(limit));
        let within = || error.zip(limit).map(|(error, limit)| error <= limit);
        let requirement = a.requirement(k);
        Self {
            name: operation.name.clone(),
            value: at.map(|(_, p)| in_unit(a.cell.unit(), p.value)),
            position_mm: at.map(|(n, _)| position_mm(&n.position)),
            error: error.map(nine_digits),
            limit: limit.map(nine_digits),
            error_unit,
            limit_met: requirement.map(|r| r.is_met()).or_else(within),
            requirement: match (requirement, within()) {
                (Some(r), _) => RequirementState::of(r),
                (None, Some(true)) => RequirementState::Met,
                (None, Some(false)) => RequirementState::Missed,
                (None, None) => RequirementState::None,
            },
        }
    }
}

/// Table of a sweep, `table.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepTable {
    #[schemars(extend("const" = SWEEP_SCHEMA))]
    pub schema: String,
    pub mode: SweepMode,
    pub combinations: usize,
    pub feasible: usize,
    /// Index of the feasible row with the least objective. Null if no row is feasible, or if feasible rows
    /// have objectives in different units.
    pub best: Option<usize>,
    /// Best row for every value of every `--set` option.
    pub best_of: Vec<SweepGroup>,
    pub rows: Vec<SweepRow>,
}

/// Whether a sweep searched for the layout of every combination, or mapped the layout of the cell file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SweepMode {
    Search,
    Map,
}

/// Value of a `--set` option, and the best row with that value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SweepGroup {
    pub path: String,
    pub value: Value,
    /// Number of combinations with this value of the option.
    pub combinations: usize,
    pub feasible: usize,
    /// Index of the feasible row with the least objective among the rows with this value. Null if none of
    /// these rows is feasible, or if their objectives have different units.
    pub best: Option<usize>,
    pub objective: Option<f64>,
}

impl SweepTable {
    /// Makes the table of all rows, in the order of their indices.
    pub fn new(mode: SweepMode, rows: Vec<SweepRow>) -> Self {
        Self {
            schema: SWEEP_SCHEMA.into(),
            mode,
            combinations: rows.len(),
            feasible: rows.iter().filter(|r| r.feasible).count(),
            best: best_row(rows.iter()).map(|r| r.index),
            best_of: groups(&rows),
            rows,
        }
    }

    /// Returns the row of the combination `index`; None if the table does not contain that row.
    pub fn row(&self, index: usize) -> Option<&SweepRow> {
        self.rows.iter().find(|row| row.index == index)
    }
}

/// Returns the feasible row with the least objective. If several rows are equally good, returns the first
/// one. Returns None if no row is feasible, or if feasible rows have objectives in different units.
fn best_row<'a>(rows: impl Iterator<Item = &'a SweepRow> + Clone) -> Option<&'a SweepRow> {
    let feasible = rows.filter(|r| r.feasible);
    let unit = feasible.clone().next()?.unit;
    let is_one_unit = feasible.clone().all(|r| r.unit == unit);
    let objective = |r: &SweepRow| r.objective.unwrap_or(f64::INFINITY);
    let order = |a: &&SweepRow, b: &&SweepRow| {
        b.meets_limits().cmp(&a.meets_limits()).then(objective(a).total_cmp(&objective(b)))
    };
    feasible.min_by(order).filter(|_| is_one_unit)
}

/// Returns a group for every value of every `--set` option. The values of an option are in the order in which
/// the rows first use them.
fn groups(rows: &[SweepRow]) -> Vec<SweepGroup> {
    let mut groups = Vec::new();
    let Some(first) = rows.first() else { return groups };
    for path in first.set.keys() {
        let mut values: Vec<&Value> = Vec::new();
        for value in rows.iter().filter_map(|r| r.set.get(path)) {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        groups.extend(values.into_iter().map(|value| group(rows, path, value)));
    }
    groups
}

fn group(rows: &[SweepRow], path: &str, value: &Value) -> SweepGroup {
    let with_value = rows.iter().filter(|r| r.set.get(path) == Some(value));
    let best = best_row(with_value.clone());
    SweepGroup {
        path: path.to_string(),
        value: value.clone(),
        combinations: with_value.clone().count(),
        feasible: with_value.filter(|r| r.feasible).count(),
        best: best.map(|r| r.index),
        objective: best.and_then(|r| r.objective),
    }
}
