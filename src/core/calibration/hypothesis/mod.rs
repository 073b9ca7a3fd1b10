//! Hypotheses about measured data, compared by how well they fit the nominal robot.
//!
//! A hypothesis states the units, the joint to which each column belongs, and whether the position is
//! mirrored. It also states the signs, zero offsets and coupling of the joints. The plain reading is kept
//! unless another reading fits clearly better. The convention of the orientations is determined last, once
//! the interpretation of the positions is known.

mod data_reading;
mod joint_map;
mod linear_score;
mod rotation;
mod spread_out;

pub use data_reading::{DataReading, LENGTH_UNITS, unit_name};
pub use joint_map::JointMap;
pub use rotation::{RotationReading, explain_rotations};
pub use spread_out::spread_out;

use super::deformed::Deformed;
use super::raw::RawMeasurement;
use super::rigid::aligned;
use super::session::MeasuredPosition;
use crate::cell::{JointKind, MAX_JOINTS};
use crate::pose::Pose;
use crate::robot::Chain;
use crate::units::MILLIMETRE;
use linear_score::LinearScore;
use std::collections::HashSet;

/// Largest number of rows with which the hypotheses are compared.
const ROWS: usize = 80;

/// The plain reading is kept if its root mean square distance is below this share of the reach of the arm.
/// No other hypothesis is tried in this case.
const GOOD: f64 = 1e-3;

/// Least factor by which another hypothesis must reduce the root mean square distance of the plain reading.
const CLEARLY: f64 = 3.0;

/// Hypotheses are equally good if their root mean square distances are at most this multiple of the least
/// one. The simplest of these hypotheses is chosen.
const AS_GOOD: f64 = 1.05;

/// Least number of rows with which hypotheses about anything but the units are compared.
const LEAST_ROWS: usize = 8;

/// Reciprocal of the share of rows that are left out because they fit worst.
const WORST: usize = 10;

/// Share of the range of a joint to which the coordinates of equal postures agree.
const SAME: f64 = 1e-3;

/// Number of hypotheses whose linear score is followed by a fit of base and reflectors.
const FITTED: usize = 40;

/// Returns the reading that best explains the raw numbers. A reading states the units, and whether the
/// positions are mirrored. It also states the columns, signs, zero offsets and coupling of the joints.
///
/// Other joint maps and mirrored positions are tried under two conditions. There must be at least 8 rows. The
/// map [`JointMap::PLAIN`] must leave a root mean square distance of at least 0.1 % of `reach` (m). Another
/// reading is chosen if its root mean square distance is below both thresholds. The thresholds are a third of
/// the distance that [`JointMap::PLAIN`] leaves, and 2 % of `reach`. Returns None if the positions do not
/// determine base and reflector.
pub fn explain(chain: &Chain, raw: &[RawMeasurement], reach: f64) -> Option<DataReading> {
    // Repeats of few postures would outweigh the other postures, and fit any hypothesis.
    let raw = distinct(raw);
    let some: Vec<_> = spread_out(raw.len(), ROWS).into_iter().map(|k| raw[k]).collect();
    let plain = fitted(chain, &some, reach, &[(true, JointMap::PLAIN), (false, JointMap::PLAIN)], &[false]);
    let plain = simplest(plain);
    let is_good = plain.is_some_and(|plain| plain.rms < GOOD * reach);
    if is_good || some.len() < LEAST_ROWS {
        return plain;
    }
    let unit = plain.map_or(MILLIMETRE, |plain| plain.unit);
    let best = LinearScore::new(chain, &some, unit).best(FITTED);
    let other = simplest(fitted(chain, &some, reach, &best, &[false, true]));
    let plain_rms = plain.map_or(f64::INFINITY, |plain| plain.rms);
    let other = other.filter(|other| other.is_plausible(reach) && other.rms * CLEARLY < plain_rms);
    other.map(|other| DataReading { plain_rms, ..other }).or(plain)
}

/// Returns the first row of every posture and reflector. Postures count as equal if their joint coordinates
/// agree to the share [`SAME`] of their ranges.
fn distinct(raw: &[RawMeasurement]) -> Vec<RawMeasurement> {
    let range = |joint: usize| {
        let all = raw.iter().map(|m| m.numbers.joints[joint]);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)))
    };
    let ranges: [(f64, f64); MAX_JOINTS] = std::array::from_fn(range);
    let mut known = HashSet::new();
    let is_new = |m: &&RawMeasurement| {
        let cell = |joint: usize| {
            let (low, high) = ranges[joint];
            ((m.numbers.joints[joint] - low) / (SAME * (high - low)).max(f64::MIN_POSITIVE)).round() as i64
        };
        known.insert((m.numbers.reflector, std::array::from_fn::<i64, MAX_JOINTS, _>(cell)))
    };
    raw.iter().filter(is_new).copied().collect()
}

/// Returns the simplest of the readings that fit about as well as the best reading.
fn simplest(all: Vec<DataReading>) -> Option<DataReading> {
    let least = all.iter().map(|reading| reading.rms).min_by(f64::total_cmp)?;
    let good = all.into_iter().filter(|reading| reading.rms <= AS_GOOD * least);
    good.min_by(|a, b| a.complexity().cmp(&b.complexity()).then(a.rms.total_cmp(&b.rms)))
}

/// Fits base and reflectors for joint maps, in all units of length that suit the size of the arm. The flag of
/// a map is true if angles are in degrees.
fn fitted(
    chain: &Chain,
    raw: &[RawMeasurement],
    reach: f64,
    maps: &[(bool, JointMap)],
    mirrored: &[bool],
) -> Vec<DataReading> {
    let spread = spread(raw);
    let has_slides = chain.links.iter().any(|link| link.kind == JointKind::Prismatic);
    let suits = |unit: f64| has_slides || (1e-3..3.0).contains(&(spread * unit / reach));
    let mut units: Vec<f64> =
        LENGTH_UNITS.iter().map(|(_, unit)| *unit).filter(|unit| suits(*unit)).collect();
    if units.is_empty() {
        units = LENGTH_UNITS.iter().map(|(_, unit)| *unit).collect();
    }
    let mut all = Vec::new();
    for (degrees, joints) in maps {
        for &unit in &units {
            for &mirrored in mirrored {
                let base = Pose::IDENTITY;
                let (rms, plain_rms) = (f64::INFINITY, f64::INFINITY);
                let reading =
                    DataReading { degrees: *degrees, unit, joints: *joints, mirrored, rms, plain_rms, base };
                all.extend(judged(chain, raw, &reading));
            }
        }
    }
    all
}

/// Returns the reading with its root mean square distance and its fitted base pose. Returns None if the data
/// do not determine them.
fn judged(chain: &Chain, raw: &[RawMeasurement], reading: &DataReading) -> Option<DataReading> {
    let measured = raw.iter().map(|m| reading.applied(chain, m));
    let mut pairs: Vec<_> = measured.map(|m| (Deformed::new(chain, &m.joints, &[], &[]), m)).collect();
    let mut answer = None;
    // A first fit finds the worst rows, and a second fit leaves them out.
    for kept in [raw.len(), raw.len() - raw.len() / WORST] {
        pairs.truncate(kept);
        let (poses, measured): (Vec<_>, Vec<_>) = pairs.iter().cloned().unzip();
        let frames = aligned(&poses, &measured)?;
        let square =
            |(pose, m): &(Deformed, MeasuredPosition)| frames.residual(&pose.interface, m).norm_squared();
        let rms = (pairs.iter().map(square).sum::<f64>() / pairs.len() as f64).sqrt();
        answer =
            rms.is_finite().then_some(DataReading { rms, plain_rms: rms, base: frames.base, ..*reading });
        pairs.sort_by(|a, b| square(a).total_cmp(&square(b)));
    }
    answer
}

/// Returns the root mean square distance of the positions from their mean, in the unit of the file.
fn spread(raw: &[RawMeasurement]) -> f64 {
    let count = raw.len() as f64;
    let mean = raw.iter().map(|m| m.numbers.position).sum::<nalgebra::Vector3<f64>>() / count;
    (raw.iter().map(|m| (m.numbers.position - mean).norm_squared()).sum::<f64>() / count).sqrt()
}
