//! Spots: poses at one commanded position, and the ranking of all spots by their errors.

use super::clusters::clusters;
use super::compared_pose::ComparedPose;
use super::rank_correlation::rank_correlation;
use nalgebra::Vector3;

/// Commanded position with the errors of all poses there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredSpot {
    /// Mean of the nominal positions, m, base frame.
    pub position: Vector3<f64>,
    /// Number of poses at this position.
    pub poses: usize,
    /// Mean size of the measured errors, m.
    pub measured: f64,
    /// Mean of the predicted sizes of the errors, m.
    pub predicted: f64,
}

/// Ranking of the spots of one session by their errors. A spot is a commanded position.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotRanking {
    /// Spots in the order of their first poses.
    pub spots: Vec<MeasuredSpot>,
    /// Spearman correlation of predicted and measured errors over all spots; None if all predicted errors are
    /// equal, or if all measured errors are equal.
    pub correlation: Option<f64>,
    /// Spot with the least predicted error.
    pub chosen: MeasuredSpot,
    /// Mean of the measured errors of all spots, m.
    pub mean: f64,
    /// Least measured error of a spot, m.
    pub least: f64,
    /// Greatest measured error of a spot, m.
    pub greatest: f64,
}

impl SpotRanking {
    /// Groups the poses into spots. In each spot, all command positions are within `distance` (m) of the
    /// first one along every axis.
    ///
    /// The command position of a pose is either the nominal position of its reflector, or the nominal
    /// position of the TCP of the cell (`tcp`, base frame, m). The measured data do not state which of the
    /// two points the robot program commanded. The function therefore uses the point that gives fewer spots.
    /// Returns None if there are no poses.
    pub fn new(poses: &[ComparedPose], tcp: &[Vector3<f64>], distance: f64) -> Option<Self> {
        let of_reflector: Vec<[f64; 3]> = poses.iter().map(|pose| pose.nominal.into()).collect();
        let of_tcp: Vec<[f64; 3]> = tcp.iter().map(|p| (*p).into()).collect();
        let candidates = [&of_reflector, &of_tcp].map(|points| clusters(points, distance));
        let groups = candidates.into_iter().min_by_key(Vec::len)?;
        let spot = |members: &Vec<usize>| {
            let count = members.len() as f64;
            let mean = |of: &dyn Fn(&ComparedPose) -> f64| {
                members.iter().map(|&i| of(&poses[i])).sum::<f64>() / count
            };
            MeasuredSpot {
                position: members.iter().map(|&i| poses[i].nominal).sum::<Vector3<f64>>() / count,
                poses: members.len(),
                measured: mean(&|pose| pose.measured.norm()),
                predicted: mean(&|pose| pose.size),
            }
        };
        let spots: Vec<MeasuredSpot> = groups.iter().map(spot).collect();
        let (predicted, measured): (Vec<_>, Vec<_>) = spots.iter().map(|s| (s.predicted, s.measured)).unzip();
        let chosen = spots.iter().min_by(|a, b| a.predicted.total_cmp(&b.predicted)).copied()?;
        Some(Self {
            correlation: rank_correlation(&predicted, &measured),
            chosen,
            mean: measured.iter().sum::<f64>() / measured.len() as f64,
            least: measured.iter().copied().fold(f64::MAX, f64::min),
            greatest: measured.iter().copied().fold(0.0, f64::max),
            spots,
        })
    }
}
