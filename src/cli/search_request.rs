//! Request of a search: cell file, packages, settings and command line.

use super::arguments::SearchArguments;
use super::packages::PackageFolders;
use super::{Exit, arguments, asked, output};
use crate::files::{Loaded, Setting};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Settings that may change when a search is resumed, because they only decide when the search ends.
const STOPPING_RULES: [&str; 3] = ["search.budget", "search.gap", "search.stagnation"];

/// Request of a search. The checkpoint stores the request, so a resumed search does not need the old command
/// line.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SearchRequest {
    pub cell: PathBuf,
    /// Folders of ROS packages, by name.
    packages: Vec<(String, PathBuf)>,
    /// Settings from the flags. These settings override the cell file.
    pub settings: Vec<Setting>,
    /// Command line that gives the same result in one uninterrupted run.
    pub command: Vec<String>,
}

impl SearchRequest {
    /// Returns the request that the command line states.
    pub fn new(a: &SearchArguments) -> Result<Self, Exit> {
        // clap requires a cell file without --resume.
        let cell = a.cell.clone().ok_or(Exit::BadInput)?;
        let packages = a.packages.folders.clone();
        Ok(Self { cell, packages, settings: a.settings(), command: arguments::typed() })
    }

    /// Loads the cell of this request with [`Self::settings`].
    pub fn load(&self) -> Result<Loaded, Exit> {
        let packages = PackageFolders { folders: self.packages.clone() };
        asked::load_for_search(&self.cell, &packages, &self.settings)
    }

    /// Returns the request with the stopping rules of the command line that resumes the search. Refuses any
    /// other change.
    pub fn resumed(mut self, a: &SearchArguments) -> Result<Self, Exit> {
        let is_rule = |s: &Setting| STOPPING_RULES.contains(&s.path.as_str());
        let (rules, others): (Vec<_>, Vec<_>) = a.settings().into_iter().partition(is_rule);
        refuse_changes(&self.settings, &others)?;
        // The cell file may be at another path now; only its content must be unchanged.
        self.cell = a.cell.clone().unwrap_or(self.cell);
        if !a.packages.folders.is_empty() {
            self.packages = a.packages.folders.clone();
        }
        for rule in rules {
            if self.settings.iter().all(|s| s.path != rule.path || s.value != rule.value) {
                self.settings.retain(|s| s.path != rule.path);
                restate(&mut self.command, &rule);
                self.settings.push(rule);
            }
        }
        Ok(self)
    }
}

/// Refuses settings that differ from the settings with which the search began.
fn refuse_changes(then: &[Setting], now: &[Setting]) -> Result<(), Exit> {
    let mut said: Vec<String> = Vec::new();
    for setting in now {
        let was = then.iter().find(|s| s.path == setting.path);
        if was.is_some_and(|was| was.value == setting.value) {
            continue;
        }
        let (option, value) = typed(setting);
        let was = was.map_or("not given".into(), |was| output::word(&typed(was).1));
        let is = output::word(&value);
        let change = format!("{option} was {was} when the search began, but now it is {is}");
        if !said.contains(&change) {
            said.push(change);
        }
    }
    said.iter().for_each(|change| output::error(change));
    if said.is_empty() {
        return Ok(());
    }
    output::talk("  help: omit the changed options to resume, or start another search in a new folder");
    Err(Exit::BadInput)
}

/// Returns a setting as a command-line option and its value.
fn typed(setting: &Setting) -> (String, String) {
    match setting.flag.as_deref() {
        Some(flag) => {
            let (option, value) = flag.split_once(' ').unwrap_or((flag, "given"));
            (option.to_string(), value.to_string())
        }
        None => (format!("--set {}", setting.path), setting.value.clone()),
    }
}

/// Removes the flag of a setting from a command line, and appends the flag with its new value. A `--set`
/// option is appended, and earlier `--set` options remain.
fn restate(command: &mut Vec<String>, setting: &Setting) {
    if setting.flag.is_none() {
        command.extend(["--set".to_string(), setting.words()]);
        return;
    }
    let (option, value) = typed(setting);
    let joined = format!("{option}=");
    if let Some(at) = command.iter().position(|word| *word == option) {
        command.drain(at..(at + 2).min(command.len()));
    }
    command.retain(|word| !word.starts_with(&joined));
    command.extend([option, value]);
}
