//! Bodies of the POST requests, as types. A request whose body does not fit its type is refused.

use crate::files::shown;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

/// Body of the request to start a search. A missing number is taken from the cell file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchBody {
    pub budget: Option<u64>,
    pub seed: Option<u64>,
}

/// Body of the request to change sense, model and reading, by their names.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuestionBody {
    /// Name of the sense; None if each operation keeps its own sense.
    pub sense: Option<String>,
    pub model: String,
    pub reading: String,
}

/// Body of the request for the region in which a piece of equipment may stand.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandingBody {
    /// Index of the piece of equipment in the cell.
    pub equipment: usize,
    /// Whether a finer outline is wanted; its computation takes longer.
    #[serde(default)]
    pub refined: bool,
}

/// Body of the request to save the layout as a cell file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SaveBody {
    pub name: String,
    /// Permission to replace an existing file.
    #[serde(default)]
    pub overwrite: bool,
}

/// Body of a request that needs no arguments: the empty object.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EmptyBody {}

/// Parses a body that must be a JSON object.
///
/// # Errors
/// Fails with a message for the page if the body is anything else.
pub fn object(body: &[u8]) -> Result<Map<String, Value>, String> {
    match serde_json::from_slice(body) {
        Ok(Value::Object(object)) => Ok(object),
        Ok(_) => Err("the request must be an object in braces, such as {}".into()),
        Err(e) => Err(format!("the request is not JSON: {e}")),
    }
}

/// Parses a JSON object as a request body of type `T`.
///
/// # Errors
/// Fails with a message for the page that names the key and what is wrong with it.
pub fn typed<T: DeserializeOwned>(object: Map<String, Value>) -> Result<T, String> {
    serde_path_to_error::deserialize(Value::Object(object)).map_err(|e| match e.path().to_string().as_str() {
        "." => format!("the request is refused: {}", shown(&e.inner().to_string())),
        key => format!("`{}` is refused: {}", shown(key), shown(&e.inner().to_string())),
    })
}
