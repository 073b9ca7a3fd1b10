//! Comparison of measured positions with the predicted errors of a cell, as part of the document of
//! `map --json`.

use super::calibration::AccuracyEntry;
use super::numbers::{joints, millimetres, nine_digits, position_mm};
use crate::cell::Cell;
use crate::verification::{
    CYCLES_OF_STANDARD, ComparedPose, MeasuredComparison, MeasuredSpot, PredictedErrors, Repeatability,
    SpotRanking,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Comparison of a file of measured positions with the errors that the cell predicts. Base and reflectors are
/// fitted so that the nominal arm matches the measured positions best. Vectors are in the base frame of the
/// robot, mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ComparedFile {
    pub file: String,
    /// Statistics of the measured errors: the distances between measured and nominal positions.
    pub measured: AccuracyEntry,
    /// Statistics of the predicted sizes of these errors.
    pub predicted: AccuracyEntry,
    /// Whether the predicted sizes include the random part of the errors. Sizes that include this part are
    /// root mean squares.
    pub predicted_rms: bool,
    /// Statistics of the lengths of the differences between measured and predicted errors.
    pub residual: AccuracyEntry,
    /// Share of the positions inside their predicted 95 % ellipsoids. Null if the errors have no random part.
    ///
    /// These ellipsoids assume that the random parameter errors of a robot have the same values at all poses.
    /// The fit of base and reflectors absorbs a part of the random errors.
    pub coverage_95: Option<f64>,
    /// Share of the positions inside a second set of 95 % ellipsoids. These ellipsoids assume that the random
    /// parameter errors change from pose to pose, as the misfit of a calibration does. Null unless the error
    /// set of the robot comes from measurements.
    pub coverage_95_varying: Option<f64>,
    /// Spearman correlation of predicted and measured sizes over all positions. Null if all predicted or all
    /// measured sizes are equal.
    pub rank_correlation: Option<f64>,
    pub spots: SpotRankingEntry,
    /// Accuracy and repeatability of postures that were visited several times; null if there is no such
    /// posture.
    pub repeats: Option<RepeatsEntry>,
    pub positions: Vec<ComparedPosition>,
}

/// One measured position with its prediction, in the base frame of the robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ComparedPosition {
    /// Line of the file, counted from 1.
    pub row: usize,
    /// Number of the reflector, counted from 1.
    pub reflector: usize,
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints: Vec<f64>,
    /// Position of the reflector for the nominal robot.
    pub nominal_mm: [f64; 3],
    /// Measured error: the measured minus the nominal position.
    pub measured_mm: [f64; 3],
    /// Predicted error without the part that the fit of base and reflectors absorbs.
    pub predicted_mm: [f64; 3],
    /// Predicted size of the error.
    pub predicted_size_mm: f64,
    /// Length of the difference between `measured_mm` and `predicted_mm`.
    pub residual_mm: f64,
    /// Whether the measured error is inside the predicted 95 % ellipsoid. Null if the errors have no random
    /// part.
    pub inside_95: Option<bool>,
}

/// Spots of a file, ranked by their errors. A spot is a commanded position. The error of a spot is the mean
/// error of its poses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpotRankingEntry {
    /// Number of spots.
    pub count: usize,
    /// Spearman correlation of predicted and measured errors over the spots. Null if all predicted or all
    /// measured errors are equal.
    pub rank_correlation: Option<f64>,
    /// Spot with the least predicted error.
    pub predicted_best: MeasuredSpotEntry,
    /// Mean of the measured errors of all spots.
    pub mean_mm: f64,
    /// Least measured error over all spots.
    pub least_mm: f64,
    /// Greatest measured error over all spots.
    pub greatest_mm: f64,
}

/// Spot (a commanded position), with the errors of the poses at this position.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeasuredSpotEntry {
    /// Mean position of the reflector for the nominal robot, in the base frame.
    pub position_mm: [f64; 3],
    /// Number of measured positions.
    pub positions: usize,
    /// Mean size of the measured errors.
    pub measured_mm: f64,
    /// Mean of the predicted sizes.
    pub predicted_mm: f64,
}

/// Pose accuracy AP and pose repeatability RP of positions, as ISO 9283 defines them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RepeatsEntry {
    /// Largest pose accuracy of a posture.
    pub largest_ap_mm: f64,
    /// Largest pose repeatability of a posture.
    pub largest_rp_mm: f64,
    /// Number of visits to the repeated posture that was visited least often.
    pub least_visits: usize,
    /// Whether every repeated posture was visited as often as the standard demands.
    pub enough_visits: bool,
    pub postures: Vec<RepeatedPostureEntry>,
}

/// One posture that was visited several times.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RepeatedPostureEntry {
    /// Line number of the first visit in the file, counted from 1.
    pub row: usize,
    pub visits: usize,
    /// Position of the reflector for the nominal robot, in the base frame.
    pub position_mm: [f64; 3],
    /// Distance of the barycentre of the measured positions from the command position.
    pub ap_mm: f64,
    /// Mean distance of the measured positions from the barycentre, plus three standard deviations.
    pub rp_mm: f64,
}

impl ComparedFile {
    pub fn new(cell: &Cell, errors: &PredictedErrors, compared: &MeasuredComparison) -> Self {
        Self {
            file: compared.name.clone(),
            measured: AccuracyEntry::new(&compared.measured),
            predicted: AccuracyEntry::new(&compared.predicted),
            predicted_rms: errors.counts_deviations(),
            residual: AccuracyEntry::new(&compared.residual),
            coverage_95: compared.coverage.map(nine_digits),
            coverage_95_varying: compared.coverage_varying.map(nine_digits),
            rank_correlation: compared.correlation.map(nine_digits),
            spots: SpotRankingEntry::new(&compared.ranking),
            repeats: compared.repeats.as_ref().map(RepeatsEntry::new),
            positions: compared.poses.iter().map(|pose| ComparedPosition::new(cell, pose)).collect(),
        }
    }
}

impl ComparedPosition {
    fn new(cell: &Cell, pose: &ComparedPose) -> Self {
        Self {
            row: pose.row,
            reflector: pose.reflector + 1,
            joints: joints(cell, &pose.joints),
            nominal_mm: position_mm(&pose.nominal),
            measured_mm: position_mm(&pose.measured),
            predicted_mm: position_mm(&pose.predicted),
            predicted_size_mm: millimetres(pose.size),
            residual_mm: millimetres(pose.residual().norm()),
            inside_95: pose.is_inside,
        }
    }
}

impl SpotRankingEntry {
    fn new(ranking: &SpotRanking) -> Self {
        Self {
            count: ranking.spots.len(),
            rank_correlation: ranking.correlation.map(nine_digits),
            predicted_best: MeasuredSpotEntry::new(&ranking.chosen),
            mean_mm: millimetres(ranking.mean),
            least_mm: millimetres(ranking.least),
            greatest_mm: millimetres(ranking.greatest),
        }
    }
}

impl MeasuredSpotEntry {
    fn new(spot: &MeasuredSpot) -> Self {
        Self {
            position_mm: position_mm(&spot.position),
            positions: spot.poses,
            measured_mm: millimetres(spot.measured),
            predicted_mm: millimetres(spot.predicted),
        }
    }
}

impl RepeatsEntry {
    fn new(repeats: &Repeatability) -> Self {
        let posture = |posture: &crate::verification::RepeatedPosture| RepeatedPostureEntry {
            row: posture.row,
            visits: posture.visits,
            position_mm: position_mm(&posture.position),
            ap_mm: millimetres(posture.accuracy),
            rp_mm: millimetres(posture.repeatability),
        };
        Self {
            largest_ap_mm: millimetres(repeats.largest_accuracy()),
            largest_rp_mm: millimetres(repeats.largest_repeatability()),
            least_visits: repeats.least_visits(),
            enough_visits: repeats.least_visits() >= CYCLES_OF_STANDARD,
            postures: repeats.postures.iter().map(posture).collect(),
        }
    }
}
