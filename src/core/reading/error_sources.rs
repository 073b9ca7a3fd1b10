//! Error sources of an operation: the parameters of robot and equipment that have errors.

use crate::cell::{
    Cell, MAX_ERRORS, MAX_JOINTS, MAX_PARAMETERS, PER_FRAME, Parameter, Registration, SignedErrors, Spread,
    Tolerance,
};
use crate::kinematic_error::{Expansion, FrameError, Perturbation, TwoValuedWalk};
use crate::robot::Chain;
use nalgebra::DMatrix;

/// Largest number of sources of one operation: parameters of the robot and of two pieces of equipment.
pub const MAX_SOURCES: usize = MAX_ERRORS + 2 * PER_FRAME;

/// Parameter that has an error; the parameter belongs to the robot or to equipment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorSource {
    pub parameter: Parameter,
    /// Value of the parameter in the signed sample, m or rad; 0 if the cell gives tolerances.
    ///
    /// For an elastic parameter, `signed`, `mean`, `plus_minus` and `deviation` are in rad/m or rad/(N m), or
    /// dimensionless.
    pub signed: f64,
    /// Mean about which the parameter varies, m or rad.
    pub mean: f64,
    /// Half width of the tolerance of the parameter, m or rad.
    pub plus_minus: f64,
    /// Standard deviation of the parameter, m or rad.
    pub deviation: f64,
    /// Excess kurtosis of the distribution of the parameter.
    pub kurtosis: f64,
    /// Distribution of the parameter; None if the parameter is correlated with other parameters.
    pub spread: Option<Spread>,
    /// Index among the parameters of the robot; None for a parameter of the equipment.
    robot: Option<usize>,
}

impl ErrorSource {
    /// Returns whether the source has a tolerance that a tolerance allocation can change. The result is false
    /// for a measured or correlated source.
    pub fn is_own_tolerance(&self) -> bool {
        self.spread.is_some() && self.plus_minus > 0.0
    }
}

/// Error sources of one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorSources {
    pub list: Vec<ErrorSource>,
    /// Independent random factors, normally distributed, that together give the errors of correlated sources.
    ///
    /// Each factor is a list of sources: the index of each source, and its value at one standard deviation of
    /// the factor.
    pub factors: Vec<Vec<(usize, f64)>>,
    /// Number of robot parameters in a sample. The elastic parameters are left out if none of them has an
    /// error. If the parameters of the joint frames have no error either, they are also left out.
    parameters: usize,
    /// Indices of two pieces of equipment: first the work equipment, then the equipment from which the part
    /// was picked.
    at: [Option<usize>; 2],
}

impl ErrorSources {
    /// Returns the sources of an operation on `equipment`. If the operation places a picked part, `other` is
    /// the equipment from which the part was picked.
    pub fn new(cell: &Cell, equipment: usize, other: Option<usize>) -> Self {
        Self::beside(cell, [Some(equipment), other.filter(|o| *o != equipment)])
    }

    /// Returns the sources of the robot alone.
    pub fn of_robot(cell: &Cell) -> Self {
        Self::beside(cell, [None; 2])
    }

    fn beside(cell: &Cell, at: [Option<usize>; 2]) -> Self {
        let axes = cell.robot.axes();
        let set = cell.error_set();
        let values = |sample: Option<&SignedErrors>| {
            sample.map_or(vec![0.0; Parameter::count(axes)], SignedErrors::values)
        };
        let (tolerance, signed, mean) = (set.tolerance(), values(set.signed()), values(set.mean()));
        let mut list = Vec::new();
        let mut place = vec![None; signed.len()];
        for (k, parameter) in Parameter::of_robot(axes).enumerate() {
            let (spread, mean) = (tolerance.spreads[k], mean[k]);
            if spread.plus_minus > 0.0 || mean != 0.0 {
                place[k] = Some(list.len());
                let source = ErrorSource::new(parameter, signed[k], spread);
                list.push(ErrorSource { robot: Some(k), mean, ..source });
            }
        }
        // A taught frame moves with the equipment, so the errors of the equipment are ignored.
        for e in at.into_iter().flatten().filter(|_| cell.registration != Registration::Taught) {
            let Some(errors) = &cell.equipment[e].errors else { continue };
            let spreads = errors.tolerance();
            for (c, spread) in spreads.into_iter().enumerate().filter(|(_, s)| s.plus_minus > 0.0) {
                let signed = errors.signed().map_or(0.0, |values| values[c]);
                list.push(ErrorSource::new(Parameter::Equipment(e, c), signed, spread));
            }
        }
        let factors = factors(&tolerance, &place);
        factors.iter().flatten().for_each(|&(k, _)| list[k].spread = None);
        let robot = list.iter().filter_map(|s| s.robot);
        let parameters = match robot.max() {
            Some(last) if last >= Parameter::first_elastic(axes) => Parameter::count(axes),
            Some(last) if last >= Parameter::first_joint(axes) => Parameter::first_elastic(axes),
            _ => Parameter::first_joint(axes),
        };
        Self { list, factors, parameters, at }
    }

    /// Multiplies the tolerance of a source, its standard deviation and its entries in the random factors by
    /// `factor`.
    pub fn scale(&mut self, source: usize, factor: f64) {
        let own = &mut self.list[source];
        own.plus_minus *= factor;
        own.deviation *= factor;
        own.spread.iter_mut().for_each(|spread| spread.plus_minus *= factor);
        let of_it = self.factors.iter_mut().flatten().filter(|(k, _)| *k == source);
        of_it.for_each(|(_, value)| *value *= factor);
    }

    /// Returns the signed sample, one value per source.
    pub fn signed(&self) -> Vec<f64> {
        self.list.iter().map(|s| s.signed).collect()
    }

    /// Returns the means of all sources; None if all are 0.
    pub fn means(&self) -> Option<Vec<f64>> {
        self.list.iter().any(|s| s.mean != 0.0).then(|| self.list.iter().map(|s| s.mean).collect())
    }

    /// Returns the robot errors of a sample; `values` holds one value per source.
    pub fn perturbation(&self, chain: &Chain, values: &[f64]) -> Perturbation {
        // The buffer is cleared for every corner that is tried, and a shorter buffer is cheaper to clear.
        match self.parameters <= Parameter::first_joint(MAX_JOINTS) {
            true => self.spread_out(chain, values, &mut [0.0; Parameter::first_joint(MAX_JOINTS)]),
            false => self.spread_out(chain, values, &mut [0.0; MAX_PARAMETERS]),
        }
    }

    /// Returns the robot errors of a sample; the buffer `all` must be filled with zeros.
    fn spread_out(&self, chain: &Chain, values: &[f64], all: &mut [f64]) -> Perturbation {
        for (source, value) in self.list.iter().zip(values) {
            source.robot.into_iter().for_each(|k| all[k] = *value);
        }
        Perturbation::of_values(chain, &all[..self.parameters])
    }

    /// Returns the algorithm that computes the position error at the corners of the tolerance box.
    ///
    /// Returns None for sources of equipment, for elastic or periodic errors, and for more than 128 sources.
    /// Also returns None if one small motion of the chain depends on several sources.
    pub fn corner_walk(&self, chain: &Chain) -> Option<TwoValuedWalk> {
        let parameters: Option<Vec<usize>> = self.list.iter().map(|source| source.robot).collect();
        TwoValuedWalk::new(chain, &parameters?)
    }

    /// Returns the upper and the lower end of the tolerance of each source.
    pub fn ends(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.list.iter().map(|source| [source.at(1.0), source.at(-1.0)])
    }

    /// Returns two entries. The first belongs to the equipment on which the robot works. The second belongs
    /// to the equipment from which the robot picked the part that it places. Each entry holds the index of
    /// the equipment and its frame error. An entry is None if there is no such equipment, or if its frame
    /// error is 0. The second entry is also None if it would repeat the equipment of the first entry.
    ///
    /// The argument `values` holds one value per source.
    pub fn equipment(&self, values: &[f64]) -> [Option<(usize, FrameError)>; 2] {
        let error = |wanted: usize| {
            let mut all = [0.0; PER_FRAME];
            for (source, value) in self.list.iter().zip(values) {
                match source.parameter {
                    Parameter::Equipment(e, c) if e == wanted => all[c] = *value,
                    _ => {}
                }
            }
            FrameError::new(&all).map(|error| (wanted, error))
        };
        self.at.map(|e| e.and_then(error))
    }

    /// Returns an expansion of the TCP error with respect to the robot parameters among these sources.
    pub fn expansion(&self, chain: &Chain) -> Expansion {
        let parameters: Vec<usize> = self.list.iter().filter_map(|s| s.robot).collect();
        Expansion::of(chain, &parameters)
    }

    /// Returns every independent random factor: source indices, and the values of these sources at one
    /// standard deviation of the factor.
    pub fn independent(&self) -> Vec<Vec<(usize, f64)>> {
        let alone = self.list.iter().enumerate().filter(|(_, s)| s.spread.is_some());
        alone.map(|(k, s)| vec![(k, s.deviation)]).chain(self.factors.iter().cloned()).collect()
    }

    /// Returns whether any parameter has a bounded distribution.
    pub fn has_bounded(&self) -> bool {
        self.list.iter().any(|s| s.kurtosis != 0.0)
    }

    /// Returns whether all parameters have bounded distributions.
    pub fn are_all_bounded(&self) -> bool {
        self.list.iter().all(|s| s.kurtosis != 0.0)
    }

    /// Returns the index of a source among the parameters of the robot; None for a parameter of the
    /// equipment.
    pub fn robot_index(&self, source: usize) -> Option<usize> {
        self.list[source].robot
    }
}

impl ErrorSource {
    /// Returns the value of the parameter at the upper end (`sign` = 1) or the lower end (-1) of its
    /// tolerance.
    pub fn at(&self, sign: f64) -> f64 {
        self.mean + self.plus_minus * sign
    }

    fn new(parameter: Parameter, signed: f64, spread: Spread) -> Self {
        let (deviation, kurtosis) = (spread.deviation(), spread.distribution.excess_kurtosis());
        let (plus_minus, spread) = (spread.plus_minus, Some(spread));
        Self { parameter, signed, mean: 0.0, plus_minus, deviation, kurtosis, spread, robot: None }
    }
}

/// Returns whether the effect of a parameter on the TCP may change when the last joint rotates the tool.
///
/// If an error dl, dalpha or dbeta belongs to the last link, its effect rotates with the tool. The effects of
/// all tool errors also rotate with the tool. The last joint also changes the levers of the last link, its
/// own periodic error, and the gravity torques. So the result is also true for elastic terms of the last link
/// and for the compliance of every joint. The result is also true for the periodic error of the last joint.
pub fn is_behind(parameter: Parameter, axes: usize) -> bool {
    match parameter {
        Parameter::Dl(link) | Parameter::Dalpha(link) | Parameter::Dbeta(link) => link + 1 == axes,
        Parameter::Tool(_) => true,
        // The last joint rotates the last link and its load, and so changes levers and torques.
        Parameter::Elastic(_, link) => link + 1 == axes,
        Parameter::Compliance(_) => true,
        Parameter::Periodic(joint) => joint + 1 == axes,
        _ => false,
    }
}

/// Returns independent factors `v_f` of a tolerance's covariance `C = sum_f v_f v_f^T`; empty without a
/// covariance.
///
/// Each factor is a sparse vector: source indices, and the values of these sources. `place` maps the index of
/// a robot parameter to the index of its source.
fn factors(tolerance: &Tolerance, place: &[Option<usize>]) -> Vec<Vec<(usize, f64)>> {
    let Some(covariance) = &tolerance.covariance else { return Vec::new() };
    // The factors are principal axes of the correlation matrix, because the covariance matrix mixes m and
    // rad.
    let deviations: Vec<f64> = covariance.matrix.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect();
    let n = deviations.len();
    let correlation = |i: usize, j: usize| match deviations[i] * deviations[j] {
        0.0 => 0.0,
        scale => covariance.matrix[(i, j)] / scale,
    };
    let eigen = DMatrix::from_fn(n, n, correlation).symmetric_eigen();
    let factor = |f: usize| {
        let size = eigen.eigenvalues[f].max(0.0).sqrt();
        let entry = |(row, &parameter): (usize, &usize)| {
            Some((place[parameter]?, eigen.eigenvectors[(row, f)] * size * deviations[row]))
        };
        covariance.parameters.iter().enumerate().filter_map(entry).collect::<Vec<_>>()
    };
    let largest = eigen.eigenvalues.iter().copied().fold(0.0, f64::max);
    let real = (0..eigen.eigenvalues.len()).filter(|&f| eigen.eigenvalues[f] > 1e-15 * largest);
    real.map(factor).collect()
}
