//! List of faults found while the text of a URDF is borrowed. The [`Library`] receives the faults afterwards.

use crate::files::fault::Severity;
use crate::files::toml::document::Library;
use crate::files::toml::tree::At;

/// Largest number of faults that are kept. This number exceeds the number that [`Library`] lists.
const MAX_FAULTS: usize = 600;

pub struct UrdfFault {
    at: At,
    message: String,
    help: String,
}

pub struct Faults {
    /// Index of the URDF among the sources.
    file: usize,
    found: Vec<UrdfFault>,
    /// Number of angles that [`Self::snap`] has replaced by a right angle, and the largest difference between
    /// an angle and its replacement, rad.
    pub snapped: (usize, f64),
}

/// Least difference of an angle, rad, that counts as a change. A smaller difference is a rounding error.
const LEAST_CHANGE: f64 = 1e-9;

impl Faults {
    pub fn new(file: usize) -> Self {
        Self { file, found: Vec::new(), snapped: (0, 0.0) }
    }

    /// Replaces an angle by the right angle that is meant, and counts the replacement.
    pub fn snap(&mut self, angle: &mut f64, meant: f64) {
        let change = (*angle - meant).abs();
        if change > LEAST_CHANGE {
            self.snapped = (self.snapped.0 + 1, self.snapped.1.max(change));
        }
        *angle = meant;
    }

    pub fn at(&self, offset: usize) -> At {
        At { file: self.file, offset }
    }

    pub fn wrong(&self, offset: usize, message: String, help: impl Into<String>) -> UrdfFault {
        UrdfFault { at: self.at(offset), message, help: help.into() }
    }

    pub fn error(&mut self, at: At, message: String, help: impl Into<String>) {
        self.push(UrdfFault { at, message, help: help.into() });
    }

    pub fn push(&mut self, wrong: UrdfFault) {
        if self.found.len() < MAX_FAULTS {
            self.found.push(wrong);
        }
    }

    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    pub fn tell(self, lib: &mut Library<'_>) {
        self.found.into_iter().for_each(|w| lib.fault(w.at, Severity::Error, w.message, w.help));
    }
}
