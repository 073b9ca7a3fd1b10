//! Hypotheses about units and joint signs of measured data, compared by how well they fit the robot.

use super::deformed::Deformed;
use super::rigid::aligned;
use super::session::MeasuredPosition;
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::Chain;
use crate::units::{INCH, MILLIMETRE, rad_from_deg};

/// How the numbers of a file of measured positions are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DataReading {
    /// Whether joint angles are in degrees, not rad.
    pub degrees: bool,
    /// Unit of lengths, m: 0.001, 1 or 0.0254.
    pub unit: f64,
    /// Sign of every joint: 1 or -1.
    pub signs: [f64; MAX_JOINTS],
    /// Root mean square distance of measured from nominal positions, m; base and reflector are fitted.
    pub rms: f64,
}

/// Units of length of measured data with their names.
pub const LENGTH_UNITS: [(&str, f64); 3] = [("mm", MILLIMETRE), ("m", 1.0), ("inch", INCH)];

/// Largest number of rows with which the hypotheses are compared.
const ROWS: usize = 80;

/// Share of the reach of the arm above which a distance shows that a hypothesis is wrong.
const IMPLAUSIBLE: f64 = 0.02;

impl DataReading {
    /// Returns the measured position with joint coordinates in rad or m and lengths in m.
    pub fn applied(&self, chain: &Chain, raw: &MeasuredPosition) -> MeasuredPosition {
        let mut joints: JointVector = raw.joints;
        for ((q, sign), link) in joints.iter_mut().zip(self.signs).zip(&chain.links) {
            *q *= sign;
            match link.kind {
                JointKind::Revolute if self.degrees => *q = rad_from_deg(*q),
                JointKind::Revolute => {}
                JointKind::Prismatic => *q *= self.unit,
            }
        }
        let (position, sigma) = (raw.position * self.unit, raw.sigma.map(|sigma| sigma * self.unit));
        MeasuredPosition { joints, position, sigma, ..*raw }
    }

    /// Returns whether the nominal arm explains the data, `reach` in m.
    pub fn is_plausible(&self, reach: f64) -> bool {
        self.rms < IMPLAUSIBLE * reach
    }

    /// Returns whether a joint turns against the sign of the file.
    pub fn has_flipped_signs(&self) -> bool {
        self.signs.iter().any(|s| *s < 0.0)
    }
}

/// Returns the reading that fits the raw numbers best: units of angle and length, and signs of the joints.
///
/// Signs other than those of the file are tried only if no unit explains the data. `reach` is the reach of
/// the arm, m. Returns None if the positions do not determine base and reflector.
pub fn explain(chain: &Chain, raw: &[MeasuredPosition], reach: f64) -> Option<DataReading> {
    let step = raw.len().div_ceil(ROWS).max(1);
    let some: Vec<_> = raw.iter().step_by(step).copied().collect();
    let plain = best(chain, &some, std::iter::once([1.0; MAX_JOINTS]))?;
    if plain.is_plausible(reach) {
        return Some(plain);
    }
    let signs = (0..1_u32 << chain.axes())
        .map(|bits| std::array::from_fn(|i| if bits & (1 << i) == 0 { 1.0 } else { -1.0 }));
    best(chain, &some, signs)
}

fn best(
    chain: &Chain,
    raw: &[MeasuredPosition],
    signs: impl Iterator<Item = [f64; MAX_JOINTS]>,
) -> Option<DataReading> {
    let readings = signs.flat_map(|signs| {
        let units = LENGTH_UNITS.iter().flat_map(|(_, unit)| [(true, *unit), (false, *unit)]);
        units.map(move |(degrees, unit)| DataReading { degrees, unit, signs, rms: f64::INFINITY })
    });
    let judged = readings.filter_map(|reading| {
        let measured: Vec<_> = raw.iter().map(|m| reading.applied(chain, m)).collect();
        let poses: Vec<_> = measured.iter().map(|m| Deformed::new(chain, &m.joints, &[], &[])).collect();
        let frames = aligned(&poses, &measured)?;
        let squares = poses.iter().zip(&measured);
        let squares = squares.map(|(pose, m)| frames.residual(&pose.interface, m).norm_squared());
        let rms = (squares.sum::<f64>() / measured.len() as f64).sqrt();
        rms.is_finite().then_some(DataReading { rms, ..reading })
    });
    judged.min_by(|a, b| a.rms.total_cmp(&b.rms))
}

/// Returns the name of a unit of length; "m" for a length that is none of [`LENGTH_UNITS`].
pub fn unit_name(unit: f64) -> &'static str {
    LENGTH_UNITS.iter().find(|(_, length)| *length == unit).map_or("m", |(name, _)| name)
}
