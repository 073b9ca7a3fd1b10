//! Error sets: signed samples and tolerances of the parameters of a robot or of a frame.

use super::parameter::{PER_FRAME, PER_LINK, Parameter};
use super::tolerance_cost::ToleranceCost;
use nalgebra::DMatrix;

/// Signed sample of the kinematic errors of a robot, with one value per parameter.
///
/// The [seed paper](crate) interprets its Tables 2 and 3 as such a sample. A sample is not a tolerance,
/// because its signs are part of the data.
#[derive(Debug, Clone, PartialEq)]
pub struct SignedErrors {
    pub name: String,
    /// Errors of the actuator coordinates, one per joint, rad or m.
    pub dq: Vec<f64>,
    /// Errors of the axial offsets, m.
    pub dr: Vec<f64>,
    /// Errors of the common normals, m.
    pub dl: Vec<f64>,
    /// Errors of the twists, rad.
    pub dalpha: Vec<f64>,
    /// Errors of the fifth parameter (Hayati), rad.
    pub dbeta: Vec<f64>,
    /// Error of the base frame in its own axes (m, rad).
    pub base: [f64; PER_FRAME],
    /// Error of the tool frame (TCP) in its own axes (m, rad).
    pub tool: [f64; PER_FRAME],
    /// Error of every joint frame in its own axes (m, rad).
    pub joints: Vec<[f64; PER_FRAME]>,
    /// Values of [`Parameter::elastic`], in rad/m, in rad/(N m) or dimensionless. Values beyond the end of
    /// the list are 0.
    pub elastic: Vec<f64>,
    /// Periodic errors of joints; the values of [`Parameter::Periodic`] are their factors.
    pub periodic: Vec<PeriodicError>,
}

/// Error of the coordinate q of a revolute joint; the error repeats with every revolution.
///
/// The error is the sum of `cos[k] cos((k + 1) q) + sin[k] sin((k + 1) q)`.
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicError {
    /// Index of the joint.
    pub joint: usize,
    /// Coefficients of the cosines, rad.
    pub cos: Vec<f64>,
    /// Coefficients of the sines, rad; there are as many as there are coefficients of the cosines.
    pub sin: Vec<f64>,
}

impl SignedErrors {
    /// Returns the sample with the given values (m, rad), in the order of [`Parameter::of_robot`], without
    /// periodic errors.
    pub fn of_values(name: String, axes: usize, values: &[f64]) -> Self {
        let row = |k: usize| (0..axes).map(|i| values[PER_LINK * i + k]).collect();
        let frame = |k: usize| std::array::from_fn(|c| values[PER_LINK * axes + PER_FRAME * k + c]);
        let [dq, dr, dl, dalpha, dbeta] = [0, 1, 2, 3, 4].map(row);
        let joints = (0..axes).map(|i| frame(2 + i)).collect();
        let elastic = values.get(Parameter::first_elastic(axes)..).unwrap_or_default().to_vec();
        let (base, tool, periodic) = (frame(0), frame(1), Vec::new());
        Self { name, dq, dr, dl, dalpha, dbeta, base, tool, joints, elastic, periodic }
    }

    /// Returns this sample with periodic errors, whose factors become 1.
    pub fn with_periodic(mut self, periodic: Vec<PeriodicError>) -> Self {
        let axes = self.dq.len();
        self.elastic.resize(Parameter::elastic(axes).count(), 0.0);
        for (value, parameter) in self.elastic.iter_mut().zip(Parameter::elastic(axes)) {
            if let Parameter::Periodic(joint) = parameter
                && periodic.iter().any(|error| error.joint == joint)
            {
                *value = 1.0;
            }
        }
        Self { periodic, ..self }
    }

    /// Returns the values in the order of [`Parameter::of_robot`].
    pub fn values(&self) -> Vec<f64> {
        let value = |parameter| match parameter {
            Parameter::Dq(i) => self.dq[i],
            Parameter::Dr(i) => self.dr[i],
            Parameter::Dl(i) => self.dl[i],
            Parameter::Dalpha(i) => self.dalpha[i],
            Parameter::Dbeta(i) => self.dbeta[i],
            Parameter::Base(c) => self.base[c],
            Parameter::Tool(c) => self.tool[c],
            Parameter::Joint(i, c) => self.joints[i][c],
            // The elastic values follow below.
            _ => 0.0,
        };
        let axes = self.dq.len();
        let mut values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
        let places = values.iter_mut().skip(Parameter::first_elastic(axes));
        places.zip(&self.elastic).for_each(|(place, value)| *place = *value);
        values
    }
}

/// Distribution of a parameter within its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    Normal,
    Uniform,
    Triangular,
}

impl Distribution {
    /// All distributions.
    pub const ALL: [Distribution; 3] =
        [Distribution::Normal, Distribution::Uniform, Distribution::Triangular];

    /// Returns the name of this distribution as it is written in files, for example `normal`.
    pub const fn name(self) -> &'static str {
        match self {
            Distribution::Normal => "normal",
            Distribution::Uniform => "uniform",
            Distribution::Triangular => "triangular",
        }
    }

    /// Returns the excess kurtosis of the distribution: the fourth cumulant divided by the squared variance.
    pub fn excess_kurtosis(self) -> f64 {
        match self {
            Distribution::Normal => 0.0,
            Distribution::Uniform => -1.2,
            Distribution::Triangular => -0.6,
        }
    }
}

/// Tolerance of one parameter (half width, m or rad), with the distribution of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    pub plus_minus: f64,
    pub distribution: Distribution,
    /// Half width as a number of standard deviations; used for the normal distribution only.
    pub sigmas: f64,
}

impl Spread {
    /// Default half width of a tolerance as a number of standard deviations.
    pub const SIGMAS: f64 = 3.0;

    /// Returns a tolerance of a normally distributed parameter; the half width is the absolute value of
    /// `value`.
    ///
    /// The half width is three standard deviations.
    pub fn of_magnitude(value: f64) -> Self {
        Self { plus_minus: value.abs(), distribution: Distribution::Normal, sigmas: Self::SIGMAS }
    }

    /// Returns the standard deviation, m or rad.
    pub fn deviation(&self) -> f64 {
        match self.distribution {
            Distribution::Normal => self.plus_minus / self.sigmas,
            Distribution::Uniform => self.plus_minus / 3f64.sqrt(),
            Distribution::Triangular => self.plus_minus / 6f64.sqrt(),
        }
    }
}

/// Covariance of normally distributed parameters, as a calibration reports it.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Parameters of the rows of the matrix, as indices into the list of [`Parameter::of_robot`].
    pub parameters: Vec<usize>,
    /// Covariance matrix: symmetric and positive semidefinite; entries in products of m and rad.
    pub matrix: DMatrix<f64>,
}

/// Tolerances of the parameters of a robot.
///
/// Tolerances are not a sample, since they have no signs.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    pub name: String,
    /// Tolerances of all parameters in the order of [`Parameter::of_robot`]. For a parameter in `covariance`,
    /// the tolerance follows from the diagonal of that matrix.
    pub spreads: Vec<Spread>,
    pub covariance: Option<Covariance>,
    /// Cost models of all parameters in the order of `spreads`; empty if every parameter has the default
    /// model.
    pub costs: Vec<ToleranceCost>,
}

/// Errors of one robot as a calibration identified them: values and their uncertainties.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredErrors {
    /// Values with their signs: the means of the parameters.
    pub mean: SignedErrors,
    /// Deviations of the parameters from their means.
    pub spread: Tolerance,
    /// Range of every joint coordinate in the calibration, rad or m; None if the set does not state the
    /// ranges.
    pub ranges: Option<Vec<(f64, f64)>>,
}

/// Named error set of a robot.
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorSet {
    Signed(SignedErrors),
    Tolerance(Tolerance),
    Measured(Box<MeasuredErrors>),
}

impl ErrorSet {
    /// Returns the name of the set.
    pub fn name(&self) -> &str {
        match self {
            ErrorSet::Signed(e) => &e.name,
            ErrorSet::Tolerance(t) => &t.name,
            ErrorSet::Measured(m) => &m.mean.name,
        }
    }

    /// Returns the signed sample of the set; None if the set consists of tolerances.
    pub fn signed(&self) -> Option<&SignedErrors> {
        match self {
            ErrorSet::Signed(errors) => Some(errors),
            ErrorSet::Tolerance(_) => None,
            ErrorSet::Measured(measured) => Some(&measured.mean),
        }
    }

    /// Returns the means about which the parameters vary; None if they vary about 0.
    ///
    /// If a signed sample is read as tolerances, its parameters vary about 0.
    pub fn mean(&self) -> Option<&SignedErrors> {
        if let ErrorSet::Measured(measured) = self { Some(&measured.mean) } else { None }
    }

    /// Returns the error set as tolerances. For a signed sample, the half widths are the magnitudes of its
    /// values. For measured errors, the tolerances are deviations from the means.
    pub fn tolerance(&self) -> Tolerance {
        match self {
            ErrorSet::Tolerance(t) => t.clone(),
            ErrorSet::Measured(m) => m.spread.clone(),
            ErrorSet::Signed(e) => Tolerance {
                name: e.name.clone(),
                spreads: e.values().into_iter().map(Spread::of_magnitude).collect(),
                covariance: None,
                costs: Vec::new(),
            },
        }
    }
}

/// Errors of the frame of a piece of equipment, in the axes of that frame (m, rad).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FrameErrors {
    Signed([f64; PER_FRAME]),
    Tolerance([Spread; PER_FRAME]),
}

impl FrameErrors {
    /// Returns the signed sample; None if the errors are tolerances.
    pub fn signed(&self) -> Option<&[f64; PER_FRAME]> {
        match self {
            FrameErrors::Signed(values) => Some(values),
            FrameErrors::Tolerance(_) => None,
        }
    }

    /// Returns the errors as tolerances. For a signed sample, the half widths are the magnitudes of its
    /// values.
    pub fn tolerance(&self) -> [Spread; PER_FRAME] {
        match self {
            FrameErrors::Signed(values) => values.map(Spread::of_magnitude),
            FrameErrors::Tolerance(spreads) => *spreads,
        }
    }
}
