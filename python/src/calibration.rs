//! Calibration from arrays: identifies the errors of a robot from measured positions.

use crate::interrupt::all_or_nothing;
use crate::robot::Robot;
use crate::{faults, records};
use numpy::{AllowTypeChange, PyArray2, PyArrayLikeDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};
use std::time::Instant;
use sweetspot::calibration::{MeasuredPosition, MeasuringSession, calibrate as fitted, harmonics, unknowns};
use sweetspot::cell::MAX_JOINTS;
use sweetspot::record::{CalibratedFile, CalibrationDocument, TestedFile};
use sweetspot::report::measured_errors;
use sweetspot::robot::Chain;
use sweetspot::units::m_from_mm;

/// Array of numbers from Python. The array may have any number of dimensions.
type Numbers<'py> = PyArrayLikeDyn<'py, f64, AllowTypeChange>;

/// Error set of a robot: the table `errors.NAME` of a robot file.
#[pyclass(frozen, module = "sweetspot", str = "{toml}")]
#[derive(Clone)]
pub struct Errors {
    pub name: String,
    /// Text of the table `errors.NAME` for a robot file.
    pub toml: String,
    /// Value of the key `errors.NAME` as TOML text on one line.
    pub inline: String,
}

#[pymethods]
impl Errors {
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// Text of the table `errors.NAME` for a robot file.
    #[getter]
    fn toml(&self) -> &str {
        &self.toml
    }

    fn __repr__(&self) -> String {
        format!("<Errors {}>", self.name)
    }
}

impl Errors {
    /// Reads the table `errors.NAME` from a text that has no other table of errors.
    fn new(toml: String) -> Result<Self, String> {
        let table: toml::Table = toml.parse().map_err(|e: toml::de::Error| e.to_string())?;
        let sets = table.get("errors").and_then(toml::Value::as_table);
        let (name, set) = sets.and_then(|sets| sets.iter().next()).ok_or("the table has no errors")?;
        Ok(Self { name: name.clone(), inline: set.to_string(), toml: toml.clone() })
    }
}

/// Identified errors of a robot, with their uncertainty.
#[pyclass(frozen, module = "sweetspot")]
pub struct Calibration {
    errors: Errors,
    document: Py<PyAny>,
    covariance: Vec<Vec<f64>>,
    residual_mm: Option<f64>,
}

/// Joint coordinates of one session, and the positions or poses measured in it.
type Session<'py> = (Numbers<'py>, Numbers<'py>);

/// Returns the sessions of `q` and `measured`: one if they are arrays, several if they are lists of arrays.
fn several<'py>(q: &Bound<'py, PyAny>, measured: &Bound<'py, PyAny>) -> PyResult<Vec<Session<'py>>> {
    let is_list = q.is_instance_of::<PyList>() || q.is_instance_of::<PyTuple>();
    let arrays = if is_list { q.extract::<Vec<Numbers<'_>>>().unwrap_or_default() } else { Vec::new() };
    if arrays.is_empty() || arrays.iter().any(|array| array.shape().len() != 2) {
        return Ok(vec![(q.extract()?, measured.extract()?)]);
    }
    let measured: Vec<Numbers<'_>> = measured.extract().map_err(|_| {
        PyTypeError::new_err(
            "q is a list of arrays, one per session, so measured must be a list of arrays, too",
        )
    })?;
    if arrays.len() != measured.len() {
        let message = format!("q has {} sessions, but measured has {}", arrays.len(), measured.len());
        return Err(PyTypeError::new_err(message));
    }
    Ok(arrays.into_iter().zip(measured).collect())
}

/// Returns the sessions of a pair (q, measured), or of a list of such pairs.
fn pairs<'py>(test: &Bound<'py, PyAny>) -> PyResult<Vec<Session<'py>>> {
    let pairs: Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>)> = match test.is_instance_of::<PyList>() {
        true => test.extract()?,
        false => vec![test.extract()?],
    };
    let each = pairs.iter().map(|(q, measured)| several(q, measured));
    Ok(each.collect::<PyResult<Vec<_>>>()?.into_iter().flatten().collect())
}

/// Identifies the kinematic errors of a robot from measured positions of its tool.
///
/// `q` contains the joint coordinates (n, axes) in rad (m for a prismatic joint). `measured` contains the
/// positions (n, 3) or the poses (n, 4, 4) of one reflector in the frame of the instrument, in `unit`.
/// `sigma` is the standard deviation of the instrument per axis, in `unit`. `test` is a pair (q, measured)
/// that is not part of the fit.
///
/// `elastic` adds the deflection of the joints by the weight of the links. `harmonics` is the
/// largest order of the periodic errors of the revolute joints; None adds no periodic errors.
///
/// For several sessions with different frames of the instrument or different tools, `q` and `measured` are
/// lists with one array per session. `test` may be a list of pairs (q, measured).
#[pyfunction]
#[pyo3(signature = (robot, q, measured, *, unit="m", sigma=None, test=None, elastic=false, harmonics=None))]
#[allow(clippy::too_many_arguments)] // keywords of Python
pub fn calibrate(
    py: Python<'_>,
    robot: &Robot,
    q: &Bound<'_, PyAny>,
    measured: &Bound<'_, PyAny>,
    unit: &str,
    sigma: Option<f64>,
    test: Option<&Bound<'_, PyAny>>,
    elastic: bool,
    harmonics: Option<u8>,
) -> PyResult<Calibration> {
    let of_file: fn(f64) -> f64 = match unit {
        "m" => |length| length,
        "mm" => m_from_mm,
        _ => return Err(PyValueError::new_err("`unit` must be \"m\" or \"mm\"")),
    };
    let model = &robot.model;
    let read = |word: &str, sessions: &[Session<'_>]| {
        let each = sessions.iter().enumerate().map(|(k, (q, measured))| {
            let name = if sessions.len() == 1 { word.into() } else { format!("{word} {}", k + 1) };
            let measured = rows(q, measured, model.axes(), of_file, sigma.map(of_file))
                .map_err(|why| if sessions.len() == 1 { why } else { in_session(py, &name, &why) })?;
            Ok(MeasuringSession { name, measured })
        });
        each.collect::<PyResult<Vec<_>>>()
    };
    let sessions = read("measured", &several(q, measured)?)?;
    let tests = read("test", &test.map_or(Ok(Vec::new()), pairs)?)?;
    let begun = Instant::now();
    let made = all_or_nothing(py, |_| {
        let chain = Chain::new(model);
        let mut unknowns = unknowns(&chain, elastic);
        unknowns.extend(
            harmonics.map(|orders| self::harmonics(&chain, usize::from(orders))).into_iter().flatten(),
        );
        let priors: Vec<f64> = unknowns.iter().map(|unknown| unknown.default_prior(&chain)).collect();
        let calibration = fitted(&chain, &sessions, &unknowns, &priors)?;
        let pairs = sessions.iter().zip(&calibration.sessions);
        let calibrated =
            pairs.filter_map(|(session, fit)| CalibratedFile::new(&chain, session, fit)).collect();
        let tested =
            tests.iter().filter_map(|session| TestedFile::new(&chain, session, &calibration)).collect();
        let seconds = begun.elapsed().as_secs_f64();
        let document = CalibrationDocument::new(model, &calibration, calibrated, tested, seconds);
        let toml = measured_errors::table(model, &calibration, &document);
        let covariance = calibration.covariance.row_iter().map(|row| row.iter().copied().collect()).collect();
        Ok::<_, String>((document, Errors::new(toml)?, covariance))
    })?;
    let (document, errors, covariance) = made.map_err(|why| {
        let help = "measure more postures, with every joint in several positions";
        faults::refused(py, "calibrate", format!("cannot calibrate {}: {why}", model.name), help)
    })?;
    let residual_mm = document.residual_mm;
    let document = records::object(py, "CalibrationDocument", &document)?.unbind();
    Ok(Calibration { errors, document, covariance, residual_mm })
}

/// Returns the exception `why` with the name of its session at the beginning of the message.
fn in_session(py: Python<'_>, name: &str, why: &PyErr) -> PyErr {
    PyErr::from_type(why.get_type(py), format!("{name}: {}", why.value(py)))
}

/// Returns measured positions from arrays of joint coordinates (n, axes) and of positions (n, 3) or poses (n,
/// 4, 4).
fn rows(
    q: &Numbers<'_>,
    measured: &Numbers<'_>,
    axes: usize,
    of_file: fn(f64) -> f64,
    sigma: Option<f64>,
) -> PyResult<Vec<MeasuredPosition>> {
    let count = match q.shape() {
        [count, columns] if *columns == axes => *count,
        shape => {
            let message = format!("q has the shape {shape:?}; the robot needs (n, {axes}), rad or m");
            return Err(PyTypeError::new_err(message));
        }
    };
    let has_poses = match measured.shape() {
        [n, 3] if *n == count => false,
        [n, 4, 4] if *n == count => true,
        shape => {
            let message =
                format!("measured has the shape {shape:?}; expected ({count}, 3) or ({count}, 4, 4)");
            return Err(PyTypeError::new_err(message));
        }
    };
    let (q, measured) = (q.as_array(), measured.as_array());
    if let Some(k) = q.iter().position(|v| !v.is_finite()) {
        return Err(PyValueError::new_err(format!("row {} of q is not finite", k / axes)));
    }
    if let Some(k) = measured.iter().position(|v| !v.is_finite()) {
        let per_row = if has_poses { 16 } else { 3 };
        return Err(PyValueError::new_err(format!("row {} of measured is not finite", k / per_row)));
    }
    let row = |k: usize| {
        let mut joints = [0.0; MAX_JOINTS];
        (0..axes).for_each(|joint| joints[joint] = q[[k, joint].as_slice()]);
        let at = |i: usize, j: usize| measured[[k, i, j].as_slice()];
        let (position, rotation) = if has_poses {
            let rotation = nalgebra::Matrix3::from_fn(at);
            (nalgebra::Vector3::from_fn(|i, _| of_file(at(i, 3))), Some(rotation))
        } else {
            (nalgebra::Vector3::from_fn(|i, _| of_file(measured[[k, i].as_slice()])), None)
        };
        MeasuredPosition { row: k, joints, reflector: 0, position, rotation, sigma }
    };
    Ok((0..count).map(row).collect())
}

#[pymethods]
impl Calibration {
    /// Identified errors, for `Cell.with_errors`.
    #[getter]
    fn errors(&self) -> Errors {
        self.errors.clone()
    }

    /// Record of `sweetspot calibrate --json`.
    #[getter]
    fn document(&self, py: Python<'_>) -> Py<PyAny> {
        self.document.clone_ref(py)
    }

    /// Table of the identified parameters.
    #[getter]
    fn parameters(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.document.getattr(py, "parameters")
    }

    /// Covariance matrix of the unknowns in products of their units (m, rad, rad/m); harmonics are in the
    /// last rows and columns.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray2::from_vec2(py, &self.covariance).map_err(|e| PyValueError::new_err(e.to_string()))
    }

    /// Residual standard deviation per axis, in mm.
    #[getter]
    fn residual_mm(&self) -> Option<f64> {
        self.residual_mm
    }

    fn __repr__(&self) -> String {
        let residual = self.residual_mm.map_or("none".into(), |r| format!("{r} mm"));
        format!("<Calibration: {} unknowns, residual {residual} per axis>", self.covariance.len())
    }
}
