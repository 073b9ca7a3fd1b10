//! Section with the cheapest tolerances that meet every limit.

use super::content::{PageFigure, Section};
use super::places::titled;
use super::subject::Subject;
use crate::assess::{AllocatedNodes, CellAllocation, NoAllocation};
use crate::cell::Reading;
use crate::record::AllocationDocument;
use crate::report::chart;

/// Required yield: share of arms with random parameter errors that must stay within each limit. The command
/// `sweetspot allocate` has the same default.
const SHARE: f64 = 0.99;

/// Returns the section of the shown layout. The section is empty if no operation has a limit, or if the
/// reading is signed.
pub fn section(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "The chart shows the cheapest tolerances with which every operation stays within its limit at \
                its spot. A bar to the left marks a tolerance to tighten, and a bar to the right marks a tolerance \
                that may be looser. The error set states the costs. If it states none, each present tolerance costs 1, and \
                half of that tolerance costs 2.";
    let mut section = Section::new("allocation", "Cheapest tolerances", vec![text.into()]);
    if a.cell.reading == Reading::Signed {
        return section;
    }
    let wanted = (None, AllocatedNodes::Spots);
    let Ok(problem) = CellAllocation::new(a.workcell, &a.layout, &a.maps, wanted, SHARE) else {
        return section;
    };
    let found = match problem.solve() {
        Ok(found) => Ok(found),
        Err(NoAllocation::Infeasible(shortfalls)) => Err(shortfalls),
        Err(_) => return section,
    };
    let document = AllocationDocument::new(&problem, found.as_ref().map_err(Vec::as_slice));
    let caption = "The command sweetspot allocate prints the figures, and with --toml the tables to paste.";
    let title = titled(a, "tolerances before and after");
    section.figures.push(PageFigure::new(title, caption, chart::allocation(&document)));
    section
}
