//! Stable entry point of the library: load a cell, set keys, evaluate and search.
//!
//! A [`Study`] consists of a cell file, all files that the cell file refers to, and settings that override
//! keys as `--set` does. A study never changes: [`Study::set`] returns another study. Results are the
//! documents that the commands print with `--json`.

use crate::assess::{Assessment, Comparison};
use crate::cell::{Cell, Layout, Unit};
use crate::cli::front_end::{FileSnapshot, PackageFolders, read_cell_with, remember};
use crate::files::{Fault, Loaded, Setting, of_setting, shown, toml_string};
use crate::layout::Workcell;
use crate::proof::{ProofOptions, prove};
use crate::record::{ByName, PlacementEntry, SearchResult, SpotEntry, nine_digits, placements};
use crate::report;
use crate::search::{Progress, SearchJob, Watch, search_job};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Cell with its files and settings, valid by construction.
#[derive(Clone)]
pub struct Study {
    origin: Arc<StudyOrigin>,
    settings: Vec<Setting>,
    loaded: Arc<Loaded>,
}

/// Files of a study: path of the cell file, folders of ROS packages, and the bytes of all files read so far.
struct StudyOrigin {
    path: PathBuf,
    packages: PackageFolders,
    files: FileSnapshot,
}

/// Reason why a study gives no result.
#[derive(Debug, Clone, PartialEq)]
pub enum StudyError {
    /// Faults of the files or settings, each with its place and a remedy.
    Faults(Vec<Fault>),
    /// The robot does not suit the cell, or a result cannot be computed. The text is the reason.
    Unsolved(String),
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Faults(faults) => {
                let lines: Vec<String> = faults.iter().map(Fault::to_string).collect();
                f.write_str(&lines.join("\n"))
            }
            Self::Unsolved(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for StudyError {}

/// Value of a key of a cell file: a number, a truth value, a text, a list, or any other TOML value.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyValue(String);

impl StudyValue {
    /// Makes a value from its TOML text, such as `{ min = 0, max = 500 }`. The text is not checked here.
    pub fn toml(text: impl Into<String>) -> Self {
        Self(text.into())
    }
}

impl From<f64> for StudyValue {
    fn from(value: f64) -> Self {
        Self(format!("{value:?}").to_lowercase())
    }
}

impl From<i32> for StudyValue {
    fn from(value: i32) -> Self {
        Self(value.to_string())
    }
}

impl From<bool> for StudyValue {
    fn from(value: bool) -> Self {
        Self(value.to_string())
    }
}

impl From<&str> for StudyValue {
    fn from(value: &str) -> Self {
        Self(toml_string(value))
    }
}

impl<T: Into<StudyValue>, const N: usize> From<[T; N]> for StudyValue {
    fn from(values: [T; N]) -> Self {
        let items: Vec<String> = values.into_iter().map(|value| value.into().0).collect();
        Self(format!("[{}]", items.join(", ")))
    }
}

/// Evaluation of the layout as drawn in the cell file: the objective, and every operation at its spot.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedStudy {
    /// Objective in `unit`; None if the layout is not feasible.
    pub objective: Option<f64>,
    pub unit: Unit,
    /// Reasons why the layout is not feasible; empty if the layout is feasible.
    pub reasons: Vec<String>,
    /// Placement of every piece of equipment in the world frame, mm and degrees.
    pub layout: ByName<PlacementEntry>,
    pub operations: Vec<SpotEntry>,
}

/// Result of a search.
pub struct SearchedStudy {
    /// Document that `sweetspot search --json` prints: best layout, layout as drawn, lower bound.
    pub result: SearchResult,
    /// Study at the best layout; None if no layout is feasible.
    pub best: Option<Study>,
}

impl Study {
    /// Loads a cell file and all files that it refers to. These files must be in the folder of the cell file
    /// or below it.
    ///
    /// # Errors
    /// Fails with all faults of all files.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, StudyError> {
        Self::load_with_packages(path, &[])
    }

    /// Loads a cell as [`Self::load`] does. `packages` contains the name and the folder of each ROS package.
    ///
    /// # Errors
    /// Fails with all faults of all files.
    pub fn load_with_packages(
        path: impl AsRef<Path>,
        packages: &[(String, PathBuf)],
    ) -> Result<Self, StudyError> {
        let packages = PackageFolders { folders: packages.to_vec() };
        let path = path.as_ref().to_path_buf();
        Self::read(Arc::new(StudyOrigin { path, packages, files: FileSnapshot::default() }), Vec::new())
    }

    /// Loads a cell from the text of a cell file. The text is treated as the content of a file at `path`,
    /// which need not exist.
    ///
    /// # Errors
    /// Fails with all faults of all files.
    pub fn from_text(text: impl Into<String>, path: impl AsRef<Path>) -> Result<Self, StudyError> {
        let path = path.as_ref().to_path_buf();
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let files = FileSnapshot::with([(name, text.into().into_bytes())]);
        Self::read(Arc::new(StudyOrigin { path, packages: PackageFolders::default(), files }), Vec::new())
    }

    fn read(origin: Arc<StudyOrigin>, settings: Vec<Setting>) -> Result<Self, StudyError> {
        let loaded = read_cell_with(&origin.path, &origin.packages, &settings, &origin.files);
        let loaded = Arc::new(loaded.map_err(StudyError::Faults)?);
        Ok(Self { origin, settings, loaded })
    }

    /// Returns a copy of this study with a new value for one key. The key is a dotted path as in TOML. The
    /// name `"*"` in the path stands for every name of a table, as in `operation."*".limit_mm`. Lengths are
    /// in mm, angles in degrees.
    ///
    /// # Errors
    /// Fails with the faults of the setting, such as an unknown key.
    pub fn set(&self, key: &str, value: impl Into<StudyValue>) -> Result<Self, StudyError> {
        self.set_all([(key, value.into())])
    }

    /// Returns a copy of this study with new values for several keys. The keys are set together, so the
    /// values need to be valid only in combination.
    ///
    /// # Errors
    /// Fails with the faults of all settings.
    pub fn set_all<'k>(
        &self,
        values: impl IntoIterator<Item = (&'k str, StudyValue)>,
    ) -> Result<Self, StudyError> {
        let added: Vec<Setting> = values.into_iter().map(|(key, value)| Setting::new(key, value.0)).collect();
        let breaks = |s: &&Setting| s.words().contains(char::is_control);
        if let Some(broken) = added.iter().find(breaks) {
            let message = "it has a line break or another control character".to_string();
            let fault = of_setting(&shown(&broken.words()), message, "write the value on one line");
            return Err(StudyError::Faults(vec![fault]));
        }
        let mut settings = self.settings.clone();
        settings.retain(|old| added.iter().all(|new| new.path != old.path));
        settings.extend(added);
        Self::read(self.origin.clone(), settings)
    }

    /// Returns the warnings about the cell file and the files that it refers to.
    pub fn warnings(&self) -> &[Fault] {
        &self.loaded.warnings
    }

    /// Returns the cell as read: plain data in m and rad. Any new version of sweetspot can change the fields
    /// of the cell.
    pub fn cell(&self) -> &Cell {
        &self.loaded.cell
    }

    /// Returns the cell prepared for evaluation, for use with the other modules of the library.
    ///
    /// # Errors
    /// Fails if the robot does not suit the cell, for example because it cannot hold a required attitude.
    pub fn workcell(&self) -> Result<Workcell, StudyError> {
        let made = Workcell::remembering(self.cell().clone(), &mut remember);
        made.map_err(|why| {
            let robot = shown(&self.cell().robot.name);
            StudyError::Unsolved(format!("the robot `{robot}` does not suit this task: {why}"))
        })
    }

    /// Evaluates the layout as drawn in the cell file.
    ///
    /// # Errors
    /// Fails if the robot does not suit the cell, for example because it cannot hold a required attitude. A
    /// layout that is not feasible is not an error.
    pub fn evaluate(&self) -> Result<EvaluatedStudy, StudyError> {
        let workcell = self.workcell()?;
        let assessment = Assessment::new("as drawn", &workcell, workcell.cell.start());
        Ok(EvaluatedStudy {
            objective: assessment.objective().map(nine_digits),
            unit: workcell.cell.unit(),
            reasons: assessment.reasons(),
            layout: placements(&workcell.cell, &assessment.layout),
            operations: (0..assessment.maps.len()).map(|k| SpotEntry::new(&assessment, k)).collect(),
        })
    }

    /// Searches for the best layout with the settings of the table `[search]`.
    ///
    /// # Errors
    /// Fails if the robot does not suit the cell, for example because it cannot hold a required attitude.
    pub fn search(&self) -> Result<SearchedStudy, StudyError> {
        self.search_until(&AtomicBool::new(false), &|_| ())
    }

    /// Searches as [`Self::search`] does, but ends early if `stop` becomes true. Calls `progress` repeatedly
    /// with the progress of the search.
    ///
    /// # Errors
    /// Fails if the robot does not suit the cell, for example because it cannot hold a required attitude.
    pub fn search_until(
        &self,
        stop: &AtomicBool,
        progress: &(dyn Fn(Progress) + Sync),
    ) -> Result<SearchedStudy, StudyError> {
        let workcell = self.workcell()?;
        let proof = prove(&workcell, &ProofOptions::default(), stop);
        let job = SearchJob { bound: proof.bound, from: None, keep: &|_, _| () };
        let record = search_job(&workcell, &workcell.cell.search, &Watch { progress, stop }, &job);
        let compared = Comparison::of_search(&workcell, &record);
        let result = SearchResult::of_comparison(&record, &proof, &compared).ok_or_else(|| {
            StudyError::Unsolved(
                "the result of the search does not contain the start layout and the best layout".into(),
            )
        })?;
        let best = record.found().then(|| self.at(&record.best.layout)).transpose()?;
        Ok(SearchedStudy { result, best })
    }

    /// Returns the text of a cell file that inherits from the file `from` and fixes the layout of this study.
    pub fn layout_file(&self, from: &str) -> String {
        report::toml::fixed(from, "Layout of a study", self.cell(), &self.cell().start())
    }

    /// Returns a study whose layout as drawn is `layout`. The study reads this layout from the text of a cell
    /// file, in the format that `sweetspot search` writes.
    fn at(&self, layout: &Layout) -> Result<Self, StudyError> {
        let mut files: Vec<(String, Vec<u8>)> =
            self.loaded.sources.iter().map(|source| (source.path.clone(), source.bytes.clone())).collect();
        let mut add = |name: &str, text: String| {
            let mut name = name.to_string();
            while files.iter().any(|(known, _)| known.eq_ignore_ascii_case(&name)) {
                name.insert(0, '_');
            }
            files.push((name.clone(), text.into_bytes()));
            name
        };
        let file = self.origin.path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let lines: Vec<String> = self.settings.iter().map(Setting::line).collect();
        let with_settings = format!("from = {}\n{}\n", toml_string(&file), lines.join("\n"));
        let from = if lines.is_empty() { file } else { add(".with-settings.toml", with_settings) };
        let name =
            add("best.toml", report::toml::fixed(&from, "Best layout of a search", self.cell(), layout));
        let (path, packages) = (self.origin.path.with_file_name(name), self.origin.packages.clone());
        Self::read(Arc::new(StudyOrigin { path, packages, files: FileSnapshot::with(files) }), Vec::new())
    }
}
