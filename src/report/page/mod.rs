//! The report: one page of HTML that needs nothing else, not even a network.
//!
//! A [`Subject`] is what is reported; the sections of the page are plain data made from it, and one
//! template puts them into markup. Script and style are inside and named by their hashes in the
//! Content-Security-Policy, so that nothing else runs, whatever a name in a file says.

mod assets;
mod assumptions;
mod content;
mod figures;
mod nodes;
mod places;
mod readings;
mod report;
mod runner_up;
mod shell;
mod subject;
mod verdict;

pub use content::{Figure, Section, Table};
pub use report::{Report, report};
pub use subject::{Alternative, Found, Manifest, Proof, ProofOf, StartFound, Subject};
pub use verdict::{Fact, Spot, Verdict};
