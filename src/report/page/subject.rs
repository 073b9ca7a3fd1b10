//! Subject of a report: the layout of a cell file, or the result of a search.

use super::content::PageTable;
use crate::assess::Assessment;
use crate::cell::{Cell, Unit};
use crate::record::{ComparedFile, SearchResult};
use crate::units::{m_from_mm, rad_from_deg};

/// Converts a value of a document from `unit` to SI.
pub fn si(unit: Unit, value: f64) -> f64 {
    match unit {
        Unit::Length => m_from_mm(value),
        Unit::Angle => rad_from_deg(value),
        Unit::Share | Unit::Cost => value,
    }
}

/// Input of a report: the layout of a cell file or the result of a search, and the provenance.
pub struct Subject<'a> {
    /// Layout of the cell file, before a search.
    pub start: Assessment<'a>,
    /// Best layout of the search; None without a search, or if the search found no feasible layout.
    pub best: Option<Assessment<'a>>,
    /// Result of the search, from search.json.
    pub found: Option<SearchResult>,
    /// Comparison of measured positions with the predicted errors, one entry for each file.
    pub measured: Vec<ComparedFile>,
    pub manifest: Manifest,
    /// Warnings from loading the files.
    pub warnings: Vec<String>,
}

impl<'a> Subject<'a> {
    /// Returns the layout that the report recommends: the best layout of the search, otherwise the layout of
    /// the cell file.
    pub fn shown(&self) -> &Assessment<'a> {
        self.best.as_ref().unwrap_or(&self.start)
    }

    /// Returns all layouts; the layout of the cell file is the first.
    pub fn layouts(&self) -> impl Iterator<Item = &Assessment<'a>> {
        std::iter::once(&self.start).chain(&self.best)
    }

    /// Returns the tables of each layout, the recommended layout first. If a search found a best layout, the
    /// tables of the layout of the cell file follow. The page hides the rows of these tables until the reader
    /// opens them.
    pub fn tables(&self, of: impl Fn(&Assessment<'a>) -> Vec<PageTable>) -> Vec<PageTable> {
        let other = self.best.as_ref().map_or(Vec::new(), |_| of(&self.start));
        of(self.shown()).into_iter().chain(other.into_iter().map(PageTable::folded)).collect()
    }

    pub fn cell(&self) -> &'a Cell {
        self.start.cell
    }
}

/// Provenance of the numbers on a page: command, program version, files read and files written.
pub struct Manifest {
    /// Command line as typed.
    pub command: Vec<String>,
    /// Version of the program that made the result.
    pub version: String,
    pub seed: u64,
    /// Path and SHA-256 of every file read, the cell file first.
    pub inputs: Vec<(String, String)>,
    /// Path and SHA-256 of every file that the search wrote; empty without a search.
    pub outputs: Vec<(String, String)>,
    /// Name of the file that lists every node, or the command that writes that file.
    pub csv: String,
    /// Result folder or cell file of the report, as the user named it.
    pub source: String,
    /// Whether the search has ended, so that its folder is complete.
    pub is_complete: bool,
}
