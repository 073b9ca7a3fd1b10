//! Quick score of joint maps: a linear fit without the constraint that the base is a rotation.

use super::joint_map::JointMap;
use super::spread_out::spread_out;
use crate::calibration::raw::RawMeasurement;
use crate::cell::{JointKind, JointVector};
use crate::robot::Chain;
use nalgebra::{SMatrix, SVector, Vector3};

/// Number of unknowns of the linear fit: nine of a matrix, three of a translation and three of the
/// reflector.
const UNKNOWNS: usize = 15;

/// Largest number of rows with which joint maps are scored.
const ROWS: usize = 26;

/// Joint coordinate above which a number cannot be in rad, because it would exceed three revolutions.
const SURELY_DEGREES: f64 = 20.0;

/// Number of joint maps from which a search for combinations begins.
const STARTS: usize = 12;

/// Ridge term that keeps the fit solvable if the positions lie in a plane.
const RIDGE: f64 = 1e-9;

/// Measurements of one reflector, prepared for many scores.
pub struct LinearScore<'c> {
    chain: &'c Chain,
    /// Unit of the coordinates of prismatic joints, m.
    unit: f64,
    joints: Vec<JointVector>,
    /// Positions with mean 0 and root mean square 1.
    positions: Vec<Vector3<f64>>,
    degrees: Vec<bool>,
}

impl<'c> LinearScore<'c> {
    /// Prepares the rows of the reflector that was seen most often.
    pub fn new(chain: &'c Chain, raw: &[RawMeasurement], unit: f64) -> Self {
        let count = |reflector: usize| raw.iter().filter(|m| m.numbers.reflector == reflector).count();
        let most = raw.iter().map(|m| m.numbers.reflector).max_by_key(|reflector| count(*reflector));
        let own: Vec<_> = raw.iter().filter(|m| Some(m.numbers.reflector) == most).collect();
        let some: Vec<_> = spread_out(own.len(), ROWS).into_iter().map(|k| own[k]).collect();
        let mean = some.iter().map(|m| m.numbers.position).sum::<Vector3<f64>>() / some.len() as f64;
        let square = some.iter().map(|m| (m.numbers.position - mean).norm_squared()).sum::<f64>();
        let scale = (square / some.len() as f64).sqrt().max(f64::MIN_POSITIVE);
        let joints: Vec<_> = some.iter().map(|m| m.numbers.joints).collect();
        let largest = joints.iter().flatten().fold(0.0_f64, |most, q| most.max(q.abs()));
        let has_slides = chain.links.iter().any(|link| link.kind == JointKind::Prismatic);
        let degrees = if largest > SURELY_DEGREES && !has_slides { vec![true] } else { vec![true, false] };
        let positions = some.iter().map(|m| (m.numbers.position - mean) / scale).collect();
        Self { chain, unit, joints, positions, degrees }
    }

    /// Returns at most `count` joint maps, those with the least residuals. The flag of each map is true if
    /// angles are in degrees.
    pub fn best(&self, count: usize) -> Vec<(bool, JointMap)> {
        let axes = self.chain.axes();
        let mut maps = vec![JointMap::PLAIN];
        maps.extend(JointMap::couplings(axes));
        maps.extend(JointMap::orders(axes));
        maps.extend(JointMap::turns(self.chain));
        let signs = 0..1_u32 << axes;
        let flipped = maps.iter().flat_map(|map| signs.clone().map(|bits| map.flipped(bits)));
        let flipped: Vec<JointMap> = flipped.collect();
        let mut scored = Vec::new();
        for &degrees in &self.degrees {
            scored.extend(flipped.iter().map(|map| (self.residual(map, degrees), degrees, *map)));
        }
        keep_best(&mut scored, count);
        // Each further map combines one of the best maps so far with one more change.
        let starts: Vec<_> = scored.iter().take(STARTS).copied().collect();
        let single = (0..axes).map(|i| JointMap::PLAIN.flipped(1 << i));
        let atoms: Vec<JointMap> = maps.into_iter().skip(1).chain(single).collect();
        for (_, degrees, start) in starts {
            let both = atoms.iter().map(|atom| start.with(atom));
            scored.extend(both.map(|map| (self.residual(&map, degrees), degrees, map)));
        }
        keep_best(&mut scored, count);
        scored.into_iter().map(|(_, degrees, map)| (degrees, map)).collect()
    }

    /// Returns the root mean square residual, m, of the equation `A p + b - R f = t` with free A, b and f.
    ///
    /// Here R and t are the rotation and the translation of the mechanical interface, and p is the scaled
    /// measured position.
    fn residual(&self, map: &JointMap, degrees: bool) -> f64 {
        let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::identity() * RIDGE;
        let mut right = SVector::<f64, UNKNOWNS>::zeros();
        let mut squares = 0.0;
        for (raw, p) in self.joints.iter().zip(&self.positions) {
            let q = map.applied(self.chain, raw, degrees, self.unit);
            let interface = self.chain.frames(&self.chain.posture(&q)).links[self.chain.axes()];
            for k in 0..3 {
                let r = interface.rotation.row(k);
                let row = [(4 * k, p.x), (4 * k + 1, p.y), (4 * k + 2, p.z), (4 * k + 3, 1.0)];
                let row = row.into_iter().chain([(12, -r[0]), (13, -r[1]), (14, -r[2])]);
                let t = interface.translation[k];
                squares += t * t;
                for (i, a) in row.clone() {
                    right[i] += a * t;
                    // The factorization reads only the lower triangle.
                    row.clone().filter(|(j, _)| *j <= i).for_each(|(j, b)| normal[(i, j)] += a * b);
                }
            }
        }
        let Some(factor) = normal.cholesky() else { return f64::INFINITY };
        let left = squares - factor.solve(&right).dot(&right);
        let freedom = (3 * self.joints.len()).saturating_sub(UNKNOWNS).max(1);
        (left.max(0.0) / freedom as f64).sqrt()
    }
}

/// Keeps the `count` maps with the least residuals, the simpler one first if residuals are equal.
fn keep_best(scored: &mut Vec<(f64, bool, JointMap)>, count: usize) {
    scored.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.complexity().cmp(&b.2.complexity())));
    scored.dedup_by(|a, b| a.1 == b.1 && a.2 == b.2);
    scored.truncate(count);
}
