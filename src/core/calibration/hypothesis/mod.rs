//! Hypotheses about measured data, compared by how well they fit the nominal robot.
//!
//! A hypothesis states the units, which column belongs to which joint, signs, zeros and coupling of the
//! joints, and whether the position is mirrored. The plain reading is kept unless another one fits clearly
//! better. The convention of orientations is found after that of the positions.

mod joint_map;
mod linear_score;
mod rotation;

pub use joint_map::JointMap;
pub use rotation::{RotationReading, explain_rotations};

use super::deformed::Deformed;
use super::raw::RawMeasurement;
use super::rigid::aligned;
use super::session::MeasuredPosition;
use crate::cell::JointKind;
use crate::pose::Pose;
use crate::robot::Chain;
use crate::units::{INCH, MILLIMETRE};
use linear_score::LinearScore;

/// How the numbers of a file of measured positions are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataReading {
    /// Whether joint angles are in degrees, not rad.
    pub degrees: bool,
    /// Unit of lengths, m: 0.001, 1 or 0.0254.
    pub unit: f64,
    /// How the joint columns become actuator coordinates.
    pub joints: JointMap,
    /// Whether the frame of the positions is left-handed: two columns are swapped, or one has the wrong sign.
    pub mirrored: bool,
    /// Root mean square distance of measured from nominal positions, m, without the worst tenth of the rows;
    /// base and reflector are fitted.
    pub rms: f64,
    /// Root mean square distance of the plain reading, m: columns, signs and zeros as in the file.
    pub plain_rms: f64,
    /// Fitted pose of the robot base in the frame of the positions.
    pub base: Pose,
}

/// Units of length of measured data with their names.
pub const LENGTH_UNITS: [(&str, f64); 3] = [("mm", MILLIMETRE), ("m", 1.0), ("inch", INCH)];

/// Largest number of rows with which the hypotheses are compared.
const ROWS: usize = 80;

/// Share of the reach of the arm above which a distance shows that a hypothesis is wrong.
const IMPLAUSIBLE: f64 = 0.02;

/// Share of the reach of the arm up to which the plain reading is kept without a search for others.
const GOOD: f64 = 1e-3;

/// Ratio by which another hypothesis must reduce the distance of the plain reading.
const CLEARLY: f64 = 3.0;

/// Ratio of distances up to which the simpler one of two hypotheses is taken.
const AS_GOOD: f64 = 1.05;

/// Least number of rows with which hypotheses other than units are compared.
const LEAST_ROWS: usize = 8;

/// Number of rows of which one is left out as the worst.
const WORST: usize = 10;

/// Number of hypotheses whose linear score is followed by a fit of base and reflectors.
const FITTED: usize = 40;

impl DataReading {
    /// Returns the measured position with joint coordinates in rad or m and lengths in m.
    pub fn applied(&self, chain: &Chain, raw: &RawMeasurement) -> MeasuredPosition {
        let joints = self.joints.applied(chain, &raw.numbers.joints, self.degrees, self.unit);
        let mut position = raw.numbers.position * self.unit;
        if self.mirrored {
            position.z = -position.z;
        }
        let sigma = raw.numbers.sigma.map(|sigma| sigma * self.unit);
        MeasuredPosition { joints, position, sigma, ..raw.numbers }
    }

    /// Returns whether the nominal arm explains the data, `reach` in m.
    pub fn is_plausible(&self, reach: f64) -> bool {
        self.rms < IMPLAUSIBLE * reach
    }

    /// Returns whether columns, signs and zeros are as in the file.
    pub fn is_plain(&self) -> bool {
        self.joints == JointMap::PLAIN && !self.mirrored
    }

    /// Returns how much a hypothesis assumes.
    fn complexity(&self) -> usize {
        self.joints.complexity() + 2 * usize::from(self.mirrored)
    }
}

/// Returns the reading that explains the raw numbers: units, and columns, signs, zeros and coupling of the
/// joints.
///
/// Other joint maps than that of the file are tried if the plain one leaves more than 0.1 % of the reach (m);
/// one is taken if it reduces the distance to less than a third. Returns None if the positions do not
/// determine base and reflector.
pub fn explain(chain: &Chain, raw: &[RawMeasurement], reach: f64) -> Option<DataReading> {
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

/// Returns the simplest of the readings that fit about as well as the best one.
fn simplest(all: Vec<DataReading>) -> Option<DataReading> {
    let least = all.iter().map(|reading| reading.rms).min_by(f64::total_cmp)?;
    let good = all.into_iter().filter(|reading| reading.rms <= AS_GOOD * least);
    good.min_by(|a, b| a.complexity().cmp(&b.complexity()).then(a.rms.total_cmp(&b.rms)))
}

/// Fits base and reflectors for joint maps in degrees (true) or rad, in all units of length that suit the
/// size of the arm.
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

/// Returns the reading with its distance and base; None if the data do not determine them.
fn judged(chain: &Chain, raw: &[RawMeasurement], reading: &DataReading) -> Option<DataReading> {
    let measured = raw.iter().map(|m| reading.applied(chain, m));
    let mut pairs: Vec<_> = measured.map(|m| (Deformed::new(chain, &m.joints, &[], &[]), m)).collect();
    let mut answer = None;
    // A first fit finds the worst rows, and a second one does without them.
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

/// Returns at most `most` of the numbers below `count`, in order.
///
/// They are spread over all rows, but not at equal steps: a series that moves one joint after the other would
/// else be seen with the same joint again and again.
pub fn spread_out(count: usize, most: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (0..count).collect();
    let place = |k: &usize| (*k as f64 * GOLDEN).fract();
    all.sort_by(|a, b| place(a).total_cmp(&place(b)));
    all.truncate(most);
    all.sort_unstable();
    all
}

/// Fraction of the golden ratio, whose multiples are spread most evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Returns the root mean square distance of the positions from their mean, in the unit of the file.
fn spread(raw: &[RawMeasurement]) -> f64 {
    let count = raw.len() as f64;
    let mean = raw.iter().map(|m| m.numbers.position).sum::<nalgebra::Vector3<f64>>() / count;
    (raw.iter().map(|m| (m.numbers.position - mean).norm_squared()).sum::<f64>() / count).sqrt()
}

/// Returns the name of a unit of length; "m" for a length that is none of [`LENGTH_UNITS`].
pub fn unit_name(unit: f64) -> &'static str {
    LENGTH_UNITS.iter().find(|(_, length)| *length == unit).map_or("m", |(name, _)| name)
}
