//! The published JSON Schema of every document, made from its record.

use super::{
    AllocationDocument, BudgetDocument, CalibrationDocument, CheckDocument, ComparisonDocument,
    CorrectionDocument, EnvelopeDocument, ErrorsDocument, ExplanationDocument, ManifestDocument, MapDocument,
    MeasuringPlanDocument, ProgressLine, ReadingsDocument, RemediesDocument, RobotSheetDocument,
    RobotsDocument, RobustDocument, SearchResult, SweepPlan, SweepRow, SweepStatus, SweepTable,
    VerdictDocument,
};
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde_json::Value;

/// Kind of a document that the program writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DocumentKind {
    SearchResult,
    Map,
    Comparison,
    Report,
    Budget,
    Explanation,
    Readings,
    Robust,
    Sweep,
    SweepPlan,
    SweepRow,
    SweepStatus,
    Manifest,
    Check,
    Robots,
    RobotSheet,
    Envelope,
    Calibration,
    Errors,
    Correction,
    MeasuringPlan,
    Remedies,
    Allocation,
    Progress,
}

impl DocumentKind {
    pub const ALL: [Self; 24] = [
        Self::SearchResult,
        Self::Map,
        Self::Comparison,
        Self::Report,
        Self::Budget,
        Self::Explanation,
        Self::Readings,
        Self::Robust,
        Self::Sweep,
        Self::SweepPlan,
        Self::SweepRow,
        Self::SweepStatus,
        Self::Manifest,
        Self::Check,
        Self::Robots,
        Self::RobotSheet,
        Self::Envelope,
        Self::Calibration,
        Self::Errors,
        Self::Correction,
        Self::MeasuringPlan,
        Self::Remedies,
        Self::Allocation,
        Self::Progress,
    ];

    /// Returns the name of the schema.
    pub fn name(self) -> &'static str {
        match self {
            Self::SearchResult => "search-result",
            Self::Map => "map",
            Self::Comparison => "comparison",
            Self::Report => "report",
            Self::Budget => "budget",
            Self::Explanation => "explanation",
            Self::Readings => "readings",
            Self::Robust => "robust",
            Self::Sweep => "sweep",
            Self::SweepPlan => "sweep-plan",
            Self::SweepRow => "sweep-row",
            Self::SweepStatus => "sweep-status",
            Self::Manifest => "manifest",
            Self::Check => "check",
            Self::Robots => "robots",
            Self::RobotSheet => "robot-sheet",
            Self::Envelope => "envelope",
            Self::Calibration => "calibration",
            Self::Errors => "errors",
            Self::Correction => "correction",
            Self::MeasuringPlan => "measuring-plan",
            Self::Remedies => "remedies",
            Self::Allocation => "allocation",
            Self::Progress => "progress",
        }
    }

    /// Returns the JSON Schema (draft 7) of the documents of this kind.
    pub fn schema(self) -> Value {
        match self {
            Self::SearchResult => of::<SearchResult>(),
            Self::Map => of::<MapDocument<'static>>(),
            Self::Comparison => of::<ComparisonDocument>(),
            Self::Report => of::<VerdictDocument>(),
            Self::Budget => of::<BudgetDocument>(),
            Self::Explanation => of::<ExplanationDocument>(),
            Self::Readings => of::<ReadingsDocument>(),
            Self::Robust => of::<RobustDocument>(),
            Self::Sweep => of::<SweepTable>(),
            Self::SweepPlan => of::<SweepPlan>(),
            Self::SweepRow => of::<SweepRow>(),
            Self::SweepStatus => of::<SweepStatus>(),
            Self::Manifest => of::<ManifestDocument>(),
            Self::Check => of::<CheckDocument>(),
            Self::Robots => of::<RobotsDocument>(),
            Self::RobotSheet => of::<RobotSheetDocument>(),
            Self::Envelope => of::<EnvelopeDocument>(),
            Self::Calibration => of::<CalibrationDocument>(),
            Self::Errors => of::<ErrorsDocument>(),
            Self::Correction => of::<CorrectionDocument>(),
            Self::MeasuringPlan => of::<MeasuringPlanDocument>(),
            Self::Remedies => of::<RemediesDocument>(),
            Self::Allocation => of::<AllocationDocument>(),
            Self::Progress => of::<ProgressLine>(),
        }
    }
}

/// Returns the schema of a record.
///
/// A field is required if it is always written. The value of a required field may be null.
fn of<T: JsonSchema>() -> Value {
    SchemaSettings::draft07().for_serialize().into_generator().into_root_schema_for::<T>().into()
}
