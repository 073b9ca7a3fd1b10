//! What is reported: a layout as drawn, or what a search found.

use super::content::PageTable;
use crate::assess::Assessment;
use crate::cell::{Cell, Unit};
use crate::record::SearchResult;
use crate::units::{m_from_mm, rad_from_deg};

/// A value of a document in SI.
pub fn si(unit: Unit, value: f64) -> f64 {
    match unit {
        Unit::Length => m_from_mm(value),
        Unit::Angle => rad_from_deg(value),
        Unit::Share => value,
    }
}

/// Everything that a report is made from.
pub struct Subject<'a> {
    /// The layout as drawn.
    pub start: Assessment<'a>,
    /// The best layout of a search that has found a feasible one.
    pub best: Option<Assessment<'a>>,
    /// What search.json says, of a search.
    pub found: Option<SearchResult>,
    pub manifest: Manifest,
    /// What loading the files had to say.
    pub warnings: Vec<String>,
}

impl<'a> Subject<'a> {
    /// The layout that the report recommends: the best, or the only one.
    pub fn shown(&self) -> &Assessment<'a> {
        self.best.as_ref().unwrap_or(&self.start)
    }

    /// Every layout, the one as drawn first.
    pub fn layouts(&self) -> impl Iterator<Item = &Assessment<'a>> {
        std::iter::once(&self.start).chain(&self.best)
    }

    /// A table of each layout, the recommended one first; the other is shown when asked for.
    pub fn tables(&self, of: impl Fn(&Assessment<'a>) -> Vec<PageTable>) -> Vec<PageTable> {
        let other = self.best.as_ref().map_or(Vec::new(), |_| of(&self.start));
        of(self.shown()).into_iter().chain(other.into_iter().map(PageTable::folded)).collect()
    }

    pub fn cell(&self) -> &'a Cell {
        self.start.cell
    }
}

/// Where the numbers come from.
pub struct Manifest {
    /// As typed.
    pub command: Vec<String>,
    /// Of the program that made the result.
    pub version: String,
    pub seed: u64,
    /// Path and SHA-256 of every file read, the cell file first.
    pub inputs: Vec<(String, String)>,
    /// The same of the files of a search.
    pub outputs: Vec<(String, String)>,
    /// Where every node is told: a file, or the command that makes one.
    pub csv: String,
    /// Today is not known to the core: the folder or file, as named by the user.
    pub source: String,
    /// Of a search: it has ended, so that its folder is complete.
    pub is_complete: bool,
}
