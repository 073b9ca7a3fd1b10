//! Section on the cycle time.

use super::content::{PageTable, Section};
use super::places::titled;
use super::subject::Subject;
use crate::report::text;

/// Returns the section on the cycle time of the recommended layout; empty if the time is unknown.
pub fn section(subject: &Subject<'_>) -> Section {
    let a = subject.shown();
    let text = "Least time at the maximum speeds and accelerations of the joints, from rest to rest. Straight \
                moves of the joints have synchronized trapezoidal speed profiles. Straight lines of the TCP are \
                parameterized time-optimally. Torques and jerk are not limited.";
    let mut section = Section::new("cycle", "Cycle time", vec![text.into()]);
    let Some(cycle) = a.cycle_time() else { return section };
    section.text.push(format!("{}.", text::cycle_heading(&cycle)));
    let drawn = &subject.start;
    if subject.found.is_some()
        && let Some(before) = drawn.cycle_time()
    {
        section.text.push(format!("In the layout as drawn, the cycle time is {:.2} s.", before.total()));
    }
    let steps = cycle.steps.iter().filter(|step| step.time > 0.0);
    let rows = steps.map(|step| vec![text::cycle_step_name(a.cell, step), format!("{:.2}", step.time)]);
    let notes = text::cycle_notes(a.cell, &cycle).join("; ");
    section
        .tables
        .push(PageTable::new(titled(a, "steps"), &["step", "time s"], rows.collect()).with_note(notes));
    section
}
