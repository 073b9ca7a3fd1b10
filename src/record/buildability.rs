//! Assumptions of a cell and certificate of a layout in documents.

use crate::assess::Assessment;
use crate::cell::Cell;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Value that the cell file leaves out and that was assumed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AssumedEntry {
    /// Key with which a cell file states this value.
    pub key: String,
    /// Assumed value in the notation of the cell file.
    pub value: String,
}

impl AssumedEntry {
    /// Returns one entry per assumption of a cell.
    pub fn all(cell: &Cell) -> Vec<Self> {
        let entry = |a: &crate::cell::Assumption| Self { key: a.key.clone(), value: a.value.clone() };
        cell.assumed.iter().map(entry).collect()
    }
}

/// Whether a layout certainly works at every misplacement within its placement tolerances.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum CertifiedEntry {
    /// True: the layout is certified.
    Yes(bool),
    /// Reason why the layout is not certified.
    No(String),
}

impl CertifiedEntry {
    /// Returns the certificate of a layout. Returns None if the search ignores placement tolerances, or if no
    /// body has a tolerance.
    pub fn new(a: &Assessment<'_>) -> Option<Self> {
        if !a.workcell.certifies() {
            return None;
        }
        Some(match &a.certificate {
            Some(certificate) if certificate.holds() => Self::Yes(true),
            _ => Self::No(a.reasons().join("; ")),
        })
    }
}
