//! Records: the serde types of the machine-readable documents. Each document has one type, for writing and
//! for reading.
//!
//! JSON, CSV, Parquet, pages and the published JSON Schemas all come from these types. Lengths are in mm and
//! angles in degrees, rounded to 1e-9. Vectors are in the world frame, unless the field names another frame.
//! Joint coordinates follow the convention of the robot file. A missing value is null; only fields that the
//! schema does not require are left out. A document with unknown fields is refused when it is read.

mod allocation;
mod budget;
mod buildability;
mod calibration;
mod cell_yield;
mod check;
mod comparison;
mod correction;
mod cycle_time;
mod errors;
mod estimate;
mod explanation;
pub mod goals;
mod manifest;
mod map;
mod measured;
mod measuring_plan;
mod misplacement;
mod node;
mod node_table;
mod numbers;
pub mod parameter_names;
mod parameter_unit;
mod placement;
mod progress;
mod readings;
mod refined;
mod region;
mod remedies;
mod robot;
mod schema;
mod search;
mod settings;
mod spot;
mod sweep;
mod sweep_status;
mod verdict;
mod words;

pub use allocation::{
    ALLOCATION_SCHEMA, AllocatedEntry, AllocationDocument, AllocationRequirement, AllocationStatus,
    BoundEntry, CostKind, JudgementEntry, ShortfallEntry, ToleranceEnd, UniformEntry,
};
pub use budget::{BudgetDocument, OperationBudget, ShareEntry, TightenEntry, TotalEntry};
pub use buildability::{AssumedEntry, CertifiedEntry};
pub use calibration::{
    AccuracyEntry, CALIBRATION_SCHEMA, CalibratedFile, CalibrationDocument, IdentifiedParameter, MisfitEntry,
    OutlierRow, TestedFile,
};
pub use cell_yield::CellYieldEntry;
pub use check::{
    CHECK_SCHEMA, CheckDocument, OperationOrderEntry, OwnPairEntry, PoseEntry, UrdfEntry, UrdfRow,
    roll_pitch_yaw,
};
pub use comparison::{ComparedLayout, ComparisonDocument};
pub use correction::{
    CORRECTION_SCHEMA, CommandedJoint, CorrectionDocument, CorrectionEntry, CorrectionState,
};
pub use cycle_time::{CyclePhaseWord, CycleStepEntry, CycleTimeEntry};
pub use errors::{
    AccuracyQuantiles, BaseChoice, ERRORS_SCHEMA, ErrorOrigin, ErrorsDocument, GuessQuestion, SpreadEntry,
    TestCubeEntry, TestPoseEntry,
};
pub use estimate::EstimateEntry;
pub use explanation::{
    DhEntry, DisplacementEntry, ExplanationDocument, FrameEntry, JointKindWord, MotionEntry, MotionKind,
    ParameterEntry, PostureGuardEntry, SenseRowEntry, SenseRowKind,
};
pub use goals::GoalsEntry;
pub use manifest::{HashedFile, ManifestDocument};
pub use map::{
    GuardEntry, JointEntry, MapDocument, ModelGuardEntry, MonteCarloEntry, OperationMapEntry, SenseEntry,
    StatusCounts, TransferEntry,
};
pub use measured::{
    ComparedFile, ComparedPosition, MeasuredSpotEntry, RepeatedPostureEntry, RepeatsEntry, SpotRankingEntry,
};
pub use measuring_plan::{
    ExpectedEntry, MEASURING_PLAN_SCHEMA, MeasuringPlanDocument, PlannedPoseEntry, TriedEntry,
};
pub use misplacement::{
    CornerEntry, EndedEntry, LargestEntry, LostEntry, MisplacedOperation, MoveEntry, RobustDocument,
    RobustnessEntry, SlopeEntry, coordinate_name,
};
pub use node::{DiscrepancyEntry, MapNode, MapNodes};
pub use node_table::{ColumnKind, NodeTable, TableColumn, TableValue};
pub use numbers::{NEAR_LIMIT, joints, near_limits, nine_digits, position_mm};
pub use parameter_unit::ParameterUnit;
pub use placement::{AttitudeEntry, ByName, PlacementEntry, placements};
pub use progress::{PROGRESS_SCHEMA, ProgressLine};
pub use readings::{OperationReadings, ReadingEntry, ReadingsDocument, RegretEntry};
pub use refined::RefinedEntry;
pub use region::{RegionEntry, TurnEntry};
pub use remedies::{REMEDIES_SCHEMA, RemediesDocument, RemedyEntry, remedy_name};
pub use robot::{
    EnvelopeDocument, EnvelopeSize, ErrorSetEntry, ErrorSetKind, JointSheet, PlanEntry, PlanOutline,
    RobotEntry, RobotSheetDocument, RobotsDocument, SectionEntry, SectionOutline, SizeEntry, ToolSheet,
};
pub use schema::DocumentKind;
pub use search::{
    AlternativeEntry, IslandEntry, ProofEntry, ProvenOperation, SearchResult, SearchStatus, StartEntry,
};
pub use settings::{ResolvedOperation, ResolvedSettings};
pub use spot::{RequirementEntry, SpotEntry};
pub use sweep::{
    SWEEP_PLAN_SCHEMA, SweepGroup, SweepMode, SweepPlan, SweepRow, SweepSpot, SweepTable, combination,
};
pub use sweep_status::{FailedCombination, HostWork, RunningCombination, SWEEP_STATUS_SCHEMA, SweepStatus};
pub use verdict::{
    FactEntry, FactMood, REPORT_SCHEMA, RequirementState, RunnerUpEntry, RunnerUpKind, VerdictAnswer,
    VerdictDocument, VerdictPlacement, VerdictSpot, VerdictSubject,
};
pub use words::{GUESS, caveats, is_guess, objective_word, reading_word, value_word};
