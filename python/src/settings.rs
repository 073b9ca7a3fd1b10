//! Settings of a cell from Python values: the keys of `--set` and the flags of the commands.

use crate::calibration::Errors;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use sweetspot::cli::front_end::{ErrorFlags, QuestionFlags, SearchArguments, StoppingFlags};
use sweetspot::files::fault::did_you_mean;
use sweetspot::files::{Choices, Setting, toml_string};

/// Names of the flags that choose errors and their interpretation.
const QUESTION: [&str; 7] = ["errors", "model", "sense", "limit", "reading", "quantity", "registration"];

/// Names of the flags of a search.
const SEARCH: [&str; 9] =
    ["seed", "ideal", "robust", "pareto", "keep", "solver", "budget", "gap", "stagnation"];

/// Returns the settings of `sets`. Each entry is a text `PATH=VALUE` as after `--set`, or a mapping of paths
/// to values.
pub fn of_sets(sets: &Bound<'_, PyTuple>) -> PyResult<Vec<Setting>> {
    let mut settings = Vec::new();
    for set in sets {
        if let Ok(text) = set.cast::<PyString>() {
            settings.push(of_text(text.py(), &text.to_cow()?)?);
        } else if let Ok(mapping) = set.cast::<PyDict>() {
            for (path, value) in mapping {
                settings.push(Setting::new(path.extract::<String>()?, toml(&value)?));
            }
        } else {
            return Err(PyTypeError::new_err("expected a string PATH=VALUE, or a dict of paths and values"));
        }
    }
    Ok(settings)
}

/// Parses `PATH=VALUE` as `--set` does.
fn of_text(py: Python<'_>, text: &str) -> PyResult<Setting> {
    let Choices { path, values } =
        Choices::parse(text).map_err(|faults| crate::faults::exception(py, &faults))?;
    match <[String; 1]>::try_from(values) {
        Ok([value]) => Ok(Setting::new(path, value)),
        Err(values) => Err(PyValueError::new_err(format!(
            "{path} has {} values, but a cell takes one value per key: write a list in brackets",
            values.len()
        ))),
    }
}

/// Returns a Python value as TOML text. None is refused, because TOML has no such value.
pub fn toml(value: &Bound<'_, PyAny>) -> PyResult<String> {
    // Numbers and arrays of numpy have `tolist`.
    if let Ok(plain) = value.call_method0("tolist") {
        return toml(&plain);
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().to_string());
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.extract::<i64>()?.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(format!("{:?}", value.extract::<f64>()?).to_lowercase());
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(toml_string(&text.to_cow()?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let items = value.try_iter()?.map(|item| toml(&item?)).collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("[{}]", items.join(", ")));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let entry = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{} = {}", toml_string(&key.extract::<String>()?), toml(&value)?))
        };
        let entries = table.iter().map(entry).collect::<PyResult<Vec<_>>>()?;
        return Ok(format!("{{ {} }}", entries.join(", ")));
    }
    let kind = value.get_type().name()?;
    Err(PyTypeError::new_err(format!("a key of a cell cannot have a value of type {kind}")))
}

/// Returns the settings of the flags in `given`. The Python function `name` takes only the flags `QUESTION`
/// and refuses all other flags.
pub fn of_question(name: &str, given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<Setting>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    refuse_others(name, given, &QUESTION)?;
    Ok(question(given)?.settings())
}

/// Returns the settings of the flags in `given`. The Python function `name` takes only the flags `QUESTION`
/// and `SEARCH`.
pub fn of_search(name: &str, given: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<Setting>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    refuse_others(name, given, &[&QUESTION[..], &SEARCH[..]].concat())?;
    let rules = StoppingFlags {
        budget: get(given, "budget")?,
        gap: get(given, "gap")?,
        stagnation: get(given, "stagnation")?,
        time: None,
    };
    let flags = SearchArguments {
        question: question(given)?,
        seed: get(given, "seed")?,
        ideal: get(given, "ideal")?.unwrap_or(false),
        robust: get(given, "robust")?.unwrap_or(false),
        pareto: get(given, "pareto")?,
        keep: get(given, "keep")?,
        solver: get(given, "solver")?,
        rules,
        ..SearchArguments::default()
    };
    Ok(flags.settings())
}

fn question(given: &Bound<'_, PyDict>) -> PyResult<QuestionFlags> {
    let errors = ErrorFlags {
        errors: get(given, "errors")?,
        model: get(given, "model")?,
        sense: get(given, "sense")?,
        limit: get(given, "limit")?,
        sets: Vec::new(),
    };
    Ok(QuestionFlags {
        errors,
        reading: get(given, "reading")?,
        quantity: get(given, "quantity")?,
        registration: get(given, "registration")?,
    })
}

/// Returns the value of a keyword; None if the keyword is not given or has the value None.
fn get<T: for<'a, 'py> FromPyObject<'a, 'py, Error: Into<PyErr>>>(
    given: &Bound<'_, PyDict>,
    name: &str,
) -> PyResult<Option<T>> {
    let value = given.get_item(name)?.filter(|value| !value.is_none());
    value.map(|value| value.extract().map_err(Into::into)).transpose()
}

fn refuse_others(name: &str, given: &Bound<'_, PyDict>, known: &[&str]) -> PyResult<()> {
    for key in given.keys() {
        let key: String = key.extract()?;
        if !known.contains(&key.as_str()) {
            let near = did_you_mean(&key, known.iter().copied());
            let help =
                near.map_or(format!("known: {}", known.join(", ")), |near| format!("did you mean {near}?"));
            return Err(PyTypeError::new_err(format!("{name}() has no keyword `{key}`; {help}")));
        }
    }
    Ok(())
}

/// Adds the settings `added` to `settings`. An added setting replaces an older setting of the same key.
pub fn merged(mut settings: Vec<Setting>, added: Vec<Setting>) -> Vec<Setting> {
    settings.retain(|old| added.iter().all(|new| new.path != old.path));
    settings.extend(added);
    settings
}

/// Returns two settings. The first setting adds the error set to the robot of a cell. The second setting
/// selects this error set for the cell.
pub fn of_errors(errors: &Errors) -> Vec<Setting> {
    let mut settings = vec![Setting::new(format!("robot.errors.{}", errors.name), errors.inline.clone())];
    let flag = format!("--errors {}", errors.name);
    settings.push(Setting::of_flag(&flag, "errors", toml_string(&errors.name)));
    settings
}
