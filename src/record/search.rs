//! The result of a search: `search.json` and `search --json`.

use super::buildability::{AssumedEntry, CertifiedEntry};
use super::cell_yield::CellYieldEntry;
use super::cycle_time::CycleTimeEntry;
use super::goals::{self, GoalsEntry};
use super::numbers::{in_unit, nine_digits, rounded_down};
use super::placement::{AttitudeEntry, ByName, PlacementEntry, attitudes, placements};
use super::region::{RegionEntry, TurnEntry};
use super::spot::SpotEntry;
use super::words::{VALUE_WORDS, caveats, value_word};
use crate::assess::{Assessment, Comparison};
use crate::cell::{Cell, Goal, Model, Objective, Operation, Reading, Registration, Solver, Unit};
use crate::proof::{Covers, OperationBound, Proof, WhyNot};
use crate::search::{Island, SearchEnd, SearchRecord, best_island};
use crate::units::rounded;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the result of a search.
pub const SEARCH_SCHEMA: &str = "sweetspot/search/1";

/// Result of a search: the best layout found, the layout before the search and the proven bound. Positions
/// are in the world frame, mm; angles are in degrees. The document is the same, byte for byte, for every
/// number of threads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchResult {
    #[schemars(extend("const" = SEARCH_SCHEMA))]
    pub schema: String,
    pub status: SearchStatus,
    /// Objective of the best layout; null if the objective is not a length or the layout is not feasible.
    pub objective_mm: Option<f64>,
    /// Objective of the best layout, in `unit`; null if no layout is feasible.
    pub objective_value: Option<f64>,
    pub unit: Unit,
    /// Reduction of the objective from the layout before the search to the best layout, percent.
    pub gain_percent: Option<f64>,
    /// Proven lower bound of the objective of every layout, in `unit`.
    pub bound: Option<f64>,
    /// Gap: excess of the objective of the best layout over the bound, in percent of the bound.
    pub gap_percent: Option<f64>,
    pub proof: ProofEntry,
    /// Number of layouts evaluated.
    pub evaluations: u64,
    /// Number of evaluated layouts that are feasible and within every limit.
    pub feasible: u64,
    /// Reason why the search ended.
    pub ended: SearchEnd,
    pub cell: String,
    pub robot: String,
    /// Name of the error set.
    pub errors: String,
    pub model: Model,
    pub reading: Reading,
    /// Name of the figure that the search minimizes.
    #[schemars(extend("enum" = VALUE_WORDS))]
    pub quantity: String,
    pub registration: Registration,
    /// Caveats on the interpretation of the errors.
    pub notes: Vec<String>,
    pub objective: Objective,
    pub solver: Solver,
    /// Seed of the random numbers; for several islands, the seed of the first island.
    pub seed: u64,
    /// Largest number of layouts to evaluate; for several islands, the largest number for each island.
    pub budget: u64,
    /// Whether the worst case over the placement tolerances was minimized.
    pub robust: bool,
    /// Goals of a Pareto search; null for a search that minimizes only the objective.
    pub pareto: Option<Vec<Goal>>,
    /// Number of layouts to keep; null if the cell states none.
    pub keep: Option<usize>,
    /// Whether every piece is assumed to stand exactly at its placement, so that placement tolerances are
    /// ignored.
    pub ideal: bool,
    /// Values that the cell file leaves out and that were assumed.
    pub assumed: Vec<AssumedEntry>,
    /// Whether the best layout certainly works at every misplacement within its placement tolerances: true,
    /// or the reason why not. Null if no placement has a tolerance, or if `ideal` in the table `[search]` is
    /// true.
    pub certified: Option<CertifiedEntry>,
    /// Least objective found, in `unit`. Layouts count as equally good if their objectives exceed the least
    /// objective by at most `indifference_percent` (cell file). Among these layouts, the search chooses one
    /// with nearly the largest room. The room of a layout is the least `room_mm` of its pieces. Null if no
    /// layout is feasible and within every limit.
    #[serde(default)]
    pub least_value: Option<f64>,
    /// One region for each piece that the search places. The piece may stand anywhere in its region.
    #[serde(default)]
    pub regions: Vec<RegionEntry>,
    /// Angles by which equipment may rotate as one body about the base axis. Equipment takes part in this
    /// rotation if its x, y and yaw have ranges. At these angles, the objective grows by at most the
    /// percentage `indifference_percent` of the cell file. Null if the layout is infeasible or misses a
    /// limit, or if equipment under an operation does not take part.
    #[serde(default)]
    pub whole_cell: Option<TurnEntry>,
    /// Reasons why the best layout is not feasible.
    pub reasons: Vec<String>,
    /// Goals of the best layout; null if that layout is not feasible.
    pub goals: Option<GoalsEntry>,
    pub layout: ByName<PlacementEntry>,
    pub base: PlacementEntry,
    pub attitudes: ByName<AttitudeEntry>,
    pub operations: Vec<SpotEntry>,
    /// Overall yield: share of sampled arms that stay within the limits of all operations. Present if the
    /// reading is statistical, every operation has a spot, and at least one operation has a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell_yield: Option<CellYieldEntry>,
    /// Cycle time of the best layout; left out if that layout is not feasible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time: Option<CycleTimeEntry>,
    pub start: StartEntry,
    /// Pareto front or shortlist of layouts; null if the cell requests neither.
    pub front: Option<Vec<AlternativeEntry>>,
    /// Improvements of the best layout during the search: the number of evaluations so far, and the objective
    /// in `unit`.
    pub trace: Vec<(u64, f64)>,
    /// Searches that were merged into this result. Their seeds are consecutive numbers. Present for
    /// `search --islands`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub islands: Option<Vec<IslandEntry>>,
    /// Duration of the search, s; left out in `search.json`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// Island: one of several searches that differ only in the seed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct IslandEntry {
    pub seed: u64,
    /// Whether this island found the best layout: the layout with the least objective. If several islands are
    /// equally good, the first of them counts as the best.
    pub is_best: bool,
    /// Least objective found, in `unit`; null if no layout is feasible and within every limit.
    pub least_value: Option<f64>,
    /// Number of layouts evaluated.
    pub evaluations: u64,
    /// Number of evaluated layouts that are feasible and within every limit.
    pub feasible: u64,
    /// Reason why the search ended.
    pub ended: SearchEnd,
}

/// Whether a search has found a feasible layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SearchStatus {
    Found,
    None,
}

/// Lower bounds that hold for every layout of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProofEntry {
    /// Operations that the bound covers: all, some or none. The value `infeasible` means that no layout is
    /// feasible.
    pub covers: Covers,
    pub operations: Vec<ProvenOperation>,
}

/// Lower bound of one operation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProvenOperation {
    pub name: String,
    /// Lower bound of the value of the operation at any spot in any layout, in `unit`.
    pub bound: Option<f64>,
    /// Unit of the operation's sense.
    pub unit: Unit,
    /// Reason why there is no bound.
    pub why_not: Option<String>,
    /// Number of boxes of joint coordinates that the branch-and-bound method examined.
    pub boxes: u64,
}

/// Layout from which the search started.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StartEntry {
    pub objective_mm: Option<f64>,
    pub objective_value: Option<f64>,
    pub reasons: Vec<String>,
    pub layout: ByName<PlacementEntry>,
    pub base: PlacementEntry,
    pub attitudes: ByName<AttitudeEntry>,
    pub operations: Vec<SpotEntry>,
    /// Overall yield: share of sampled arms that stay within the limits of all operations. Present if the
    /// reading is statistical, every operation has a spot, and at least one operation has a limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell_yield: Option<CellYieldEntry>,
    /// Cycle time; left out if the layout is not feasible.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle_time: Option<CycleTimeEntry>,
}

/// Layout of the Pareto front or of the shortlist. The shortlist contains the best layouts that differ
/// clearly from each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AlternativeEntry {
    /// Cell file of the layout in the folder of the search.
    pub file: String,
    pub objective_value: Option<f64>,
    pub goals: GoalsEntry,
    pub layout: ByName<PlacementEntry>,
    pub base: PlacementEntry,
    pub attitudes: ByName<AttitudeEntry>,
}

impl SearchResult {
    /// Makes the result of a search. `start` is the layout before the search, and `best` is the best layout.
    pub fn new(
        record: &SearchRecord,
        proof: &Proof,
        start: &Assessment<'_>,
        best: &Assessment<'_>,
        gain_percent: Option<f64>,
    ) -> Self {
        let cell = best.cell;
        let (proof, gap) = best.proven(proof);
        let settings = &cell.search;
        Self {
            schema: SEARCH_SCHEMA.into(),
            status: if record.found() { SearchStatus::Found } else { SearchStatus::None },
            objective_mm: best.objective_mm().map(nine_digits),
            objective_value: best.objective().map(nine_digits),
            unit: cell.unit(),
            gain_percent,
            bound: proof.bound.map(|b| rounded_down(cell.unit().from_si(b))),
            gap_percent: gap.map(|g| rounded(g * 100.0, 6)),
            proof: ProofEntry::new(cell, &proof),
            evaluations: record.evaluations,
            feasible: record.feasible,
            ended: record.ended,
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            errors: cell.error_set().name().into(),
            model: cell.model,
            reading: cell.reading,
            quantity: value_word(cell).into(),
            registration: cell.registration,
            notes: caveats(cell),
            objective: settings.objective,
            solver: settings.solver,
            seed: settings.seed,
            budget: settings.budget,
            robust: settings.robust,
            pareto: (!settings.pareto.is_empty()).then(|| settings.pareto.iter().collect()),
            keep: Some(settings.keep).filter(|keep| *keep > 0),
            ideal: settings.ideal,
            assumed: AssumedEntry::all(cell),
            certified: CertifiedEntry::new(best),
            least_value: record.least.map(|least| in_unit(cell.unit(), least)),
            regions: RegionEntry::all(best),
            whole_cell: TurnEntry::new(best),
            reasons: [best.reasons(), best.ending_tolerances()].concat(),
            goals: best.goals().map(|values| GoalsEntry::new(cell, &values)),
            layout: placements(cell, &best.layout),
            base: PlacementEntry::new(&best.layout.base),
            attitudes: attitudes(cell, &best.layout),
            operations: SpotEntry::all(best),
            cell_yield: CellYieldEntry::new(best),
            cycle_time: CycleTimeEntry::new(best),
            start: StartEntry::new(start),
            front: AlternativeEntry::all(cell, record),
            trace: record.trace.iter().map(|(n, e)| (*n, in_unit(cell.unit(), *e))).collect(),
            islands: None,
            seconds: None,
        }
    }

    /// Makes the result of a search from a comparison of two layouts: the layout before the search and the
    /// best layout.
    ///
    /// Returns None if the comparison does not have two layouts.
    pub fn of_comparison(record: &SearchRecord, proof: &Proof, comparison: &Comparison<'_>) -> Option<Self> {
        let [start, best] = &comparison.columns[..] else { return None };
        let gain = comparison.change_percent(1, Assessment::objective).map(|c| rounded(-c, 6));
        Some(Self::new(record, proof, start, best, gain))
    }

    /// Adds the islands from which the result was merged. The list is empty for a search without islands.
    pub fn of_islands(mut self, islands: Vec<IslandEntry>) -> Self {
        self.islands = Some(islands).filter(|islands| !islands.is_empty());
        self
    }

    /// Adds the duration of the search, s, rounded to milliseconds.
    pub fn timed(mut self, seconds: f64) -> Self {
        self.seconds = Some(rounded(seconds, 3));
        self
    }

    /// Returns the kept layouts except the best layout itself.
    pub fn others(&self) -> impl Iterator<Item = &AlternativeEntry> {
        let best = (&self.layout, &self.base, &self.attitudes);
        self.front.iter().flatten().filter(move |a| (&a.layout, &a.base, &a.attitudes) != best)
    }
}

impl IslandEntry {
    /// Makes one entry for each island of a search. `cell` determines the unit of the objective.
    pub fn all(cell: &Cell, islands: &[Island]) -> Vec<Self> {
        let best = best_island(islands);
        let entry = |(k, island): (usize, &Island)| Self {
            seed: island.seed,
            is_best: best == Some(k),
            least_value: island.least.map(|least| in_unit(cell.unit(), least)),
            evaluations: island.evaluations,
            feasible: island.feasible,
            ended: island.ended,
        };
        islands.iter().enumerate().map(entry).collect()
    }
}

impl ProofEntry {
    fn new(cell: &Cell, proof: &Proof) -> Self {
        let operation = |(bound, operation): (&OperationBound, &Operation)| {
            let unit = operation.sense.unit;
            ProvenOperation {
                name: operation.name.clone(),
                bound: bound.value.ok().map(|v| rounded_down(unit.from_si(v))),
                unit,
                why_not: bound.value.err().map(|why| WhyNot::in_words(why).into()),
                boxes: bound.boxes,
            }
        };
        let operations = proof.operations.iter().zip(&cell.operations).map(operation).collect();
        Self { covers: proof.covers, operations }
    }
}

impl StartEntry {
    fn new(start: &Assessment<'_>) -> Self {
        Self {
            objective_mm: start.objective_mm().map(nine_digits),
            objective_value: start.objective().map(nine_digits),
            reasons: start.reasons(),
            layout: placements(start.cell, &start.layout),
            base: PlacementEntry::new(&start.layout.base),
            attitudes: attitudes(start.cell, &start.layout),
            operations: SpotEntry::all(start),
            cell_yield: CellYieldEntry::new(start),
            cycle_time: CycleTimeEntry::new(start),
        }
    }
}

impl AlternativeEntry {
    /// Makes one entry per kept layout; None if the cell requests neither a Pareto front nor a shortlist.
    fn all(cell: &Cell, record: &SearchRecord) -> Option<Vec<Self>> {
        if cell.search.keep == 0 && cell.search.pareto.is_empty() {
            return None;
        }
        let count = record.alternatives.len();
        let all = record.alternatives.iter().enumerate().map(|(k, alternative)| {
            let candidate = &alternative.candidate;
            Self {
                file: goals::file_name(k, count),
                objective_value: candidate.evaluation.objective.map(|o| in_unit(cell.unit(), o)),
                goals: GoalsEntry::new(cell, &alternative.goals),
                layout: placements(cell, &candidate.layout),
                base: PlacementEntry::new(&candidate.layout.base),
                attitudes: attitudes(cell, &candidate.layout),
            }
        });
        Some(all.collect())
    }
}
