//! The manifest of a result folder: program, command, settings and hashes of the files.

use super::settings::ResolvedSettings;
use crate::files::Setting;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Name and version of the manifest.
pub const MANIFEST_SCHEMA: &str = "sweetspot/manifest/1";

/// Manifest of a result folder, `manifest.json`. A folder with a manifest is complete.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ManifestDocument {
    #[schemars(extend("const" = MANIFEST_SCHEMA))]
    pub schema: String,
    pub program: String,
    /// Version of the program.
    pub version: String,
    /// Command line that makes the folder, in a form for human readers. Programs read `settings` instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<Vec<String>>,
    /// Name of the plan file of a sweep; absent in other manifests. A manifest with a plan has no `command`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plan: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cell: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<u64>,
    /// Keys of the cell file whose values come from the command line. The inputs and these settings together
    /// reproduce the cell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settings: Option<Vec<Setting>>,
    /// Settings that result when flags, cell file and defaults are merged.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolved: Option<ResolvedSettings>,
    /// Files that were read, the cell file first.
    pub inputs: Vec<HashedFile>,
    /// Files that were written.
    pub outputs: Vec<HashedFile>,
    /// Hexadecimal SHA-256 of all bytes before the comma in front of this key. The program adds this key to
    /// the text when it writes the manifest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

/// File and its SHA-256 in hexadecimal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HashedFile {
    /// Path of the file. The path of an input is relative to the folder of the cell file. The path of an
    /// output is relative to the result folder.
    pub path: String,
    pub sha256: String,
}

impl ManifestDocument {
    /// Makes a manifest with inputs and outputs only, without command, plan and settings.
    pub fn new(inputs: Vec<HashedFile>, outputs: Vec<HashedFile>) -> Self {
        Self {
            schema: MANIFEST_SCHEMA.into(),
            program: "sweetspot".into(),
            version: env!("CARGO_PKG_VERSION").into(),
            command: None,
            plan: None,
            cell: None,
            seed: None,
            settings: None,
            resolved: None,
            inputs,
            outputs,
            sha256: None,
        }
    }
}
