//! Suspect rows of measured data: copies of other rows, and rows from stuck instruments or encoders.

use super::raw::RawMeasurement;
use super::session::MeasuredPosition;
use crate::cell::MAX_JOINTS;
use crate::robot::Chain;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Two postures count as different if a joint coordinate differs by more than this share of its measured
/// range.
const OTHER_POSTURE: f64 = 2e-3;

/// A row with unchanged joints is suspect if its position changes by more than this share of the extent. The
/// extent is the diagonal of the bounding box of all positions. The repeatability of any robot is below this
/// threshold.
const UNREPEATED: f64 = 5e-3;

/// A joint counts as not moving if its coordinate varies by less than this value, rad or m.
const STILL: f64 = 1e-3;

/// Rows of the file that are left out of a calibration.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct SuspectRows {
    /// Rows that repeat joints and position of an earlier row, digit by digit.
    pub copies: Vec<usize>,
    /// Rows that repeat the position of the previous row, although the arm has moved.
    pub stuck_positions: Vec<usize>,
    /// Rows that repeat the joints of the previous row, although the reflector has moved.
    pub stuck_joints: Vec<usize>,
}

impl SuspectRows {
    /// Finds the suspect rows of one file, whose units need not be known.
    pub fn new(raw: &[RawMeasurement]) -> Self {
        let measured: Vec<_> = raw.iter().map(|m| m.numbers).collect();
        let ranges: [f64; MAX_JOINTS] = std::array::from_fn(|joint| range(&measured, |m| m.joints[joint]));
        let size = Vector3::from_fn(|axis, _| range(&measured, |m| m.position[axis])).norm();
        let mut suspect = Self::default();
        let mut known = HashSet::new();
        for m in &measured {
            let numbers = m.joints.iter().chain(m.position.iter()).map(|number| number.to_bits());
            if !known.insert((m.reflector, numbers.collect::<Vec<_>>())) {
                suspect.copies.push(m.row);
            }
        }
        let mut last: Vec<Option<&MeasuredPosition>> = Vec::new();
        for m in &measured {
            if last.len() <= m.reflector {
                last.resize(m.reflector + 1, None);
            }
            let Some(before) = last[m.reflector].replace(m) else { continue };
            let moved = (0..MAX_JOINTS).any(|j| {
                (m.joints[j] - before.joints[j]).abs() > OTHER_POSTURE * ranges[j].max(f64::MIN_POSITIVE)
            });
            if moved && m.position == before.position {
                suspect.stuck_positions.push(m.row);
            }
            if m.joints == before.joints && (m.position - before.position).norm() > UNREPEATED * size {
                suspect.stuck_joints.push(m.row);
            }
        }
        suspect
    }

    /// Returns all suspect rows.
    pub fn all(&self) -> HashSet<usize> {
        [&self.copies, &self.stuck_positions, &self.stuck_joints].into_iter().flatten().copied().collect()
    }
}

/// Returns the difference between the largest and the least value.
fn range(measured: &[MeasuredPosition], value: impl Fn(&MeasuredPosition) -> f64) -> f64 {
    let all = measured.iter().map(value);
    let (least, most) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    most - least
}

/// Returns the joints, counted from 0, whose coordinates are nearly the same in all rows. Passive joints are
/// left out.
pub fn still_joints(chain: &Chain, measured: &[MeasuredPosition]) -> Vec<usize> {
    let active = (0..chain.axes()).filter(|&joint| !chain.links[joint].is_passive());
    active.filter(|joint| range(measured, |m| m.joints[*joint]) < STILL).collect()
}
