//! Robots in Python: built-in robots, robots from files, and the robot of a cell.

use crate::interrupt::all_or_nothing;
use crate::{faults, records};
use pyo3::prelude::*;
use std::path::PathBuf;
use sweetspot::assess::RobotDataSheet;
use sweetspot::cell::Robot as RobotModel;
use sweetspot::cli::front_end::{PackageFolders, ROBOTS, read_robot_or_urdf, robot as built_in};
use sweetspot::files::fault::did_you_mean;
use sweetspot::files::{LoadedRobot, shown};
use sweetspot::reach::Inverse;
use sweetspot::record::{RobotSheetDocument, RobotsDocument};
use sweetspot::robot::Chain;

/// Robot: chain, limits, tool and error sets.
#[pyclass(frozen, module = "sweetspot")]
#[derive(Clone)]
pub struct Robot {
    pub model: RobotModel,
}

impl Robot {
    pub fn new(model: RobotModel) -> Self {
        Self { model }
    }
}

/// Returns a built-in robot by its name, or reads a robot file or a URDF.
#[pyfunction]
#[pyo3(signature = (name, *, packages=None))]
pub fn robot(py: Python<'_>, name: PathBuf, packages: Option<Vec<(String, PathBuf)>>) -> PyResult<Robot> {
    let word = name.to_string_lossy();
    let packages = PackageFolders { folders: packages.unwrap_or_default() };
    let is_word = name.extension().is_none() && name.components().count() == 1;
    let read = match built_in(&word) {
        Some(read) => read,
        None if is_word => {
            let names = || ROBOTS.iter().map(|(name, _)| *name);
            let near = did_you_mean(&word, names()).map(|near| format!("did you mean {near}?"));
            let listed =
                || format!("known: {}; a file needs its extension", names().collect::<Vec<_>>().join(", "));
            let message = format!("unknown robot `{}`", shown(&word));
            return Err(faults::refused(py, "robot", message, &near.unwrap_or_else(listed)));
        }
        None => py.detach(|| read_robot_or_urdf(&name, &packages)),
    };
    let LoadedRobot { robot, warnings, .. } = read.map_err(|found| faults::exception(py, &found))?;
    faults::warn(py, &warnings)?;
    Ok(Robot::new(robot))
}

/// Returns the list of built-in robots, which is the record of `sweetspot robots --json`.
#[pyfunction]
pub fn robots(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let mut all = Vec::new();
    for (name, _) in ROBOTS {
        let read = built_in(name).unwrap_or_else(|| Err(Vec::new()));
        let robot = read.map_err(|found| faults::exception(py, &found))?.robot;
        let family = Inverse::new(&Chain::new(&robot)).family();
        all.push((name, robot, family));
    }
    records::object(py, "RobotsDocument", &RobotsDocument::new(&all))
}

#[pymethods]
impl Robot {
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// Names of the joints.
    #[getter]
    fn joints(&self) -> Vec<&str> {
        self.model.joints.iter().map(|joint| joint.name.as_str()).collect()
    }

    /// Names of the error sets.
    #[getter]
    fn errors(&self) -> Vec<&str> {
        self.model.errors.iter().map(|set| set.name()).collect()
    }

    /// Returns the data sheet of the robot, which is the record of `sweetspot robot --json`.
    fn sheet<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let document = all_or_nothing(py, |_| RobotSheetDocument::new(&RobotDataSheet::new(&self.model)))?;
        records::object(py, "RobotSheetDocument", &document)
    }

    fn __repr__(&self) -> String {
        format!("<Robot {}: {} joints>", shown(&self.model.name), self.model.axes())
    }
}
