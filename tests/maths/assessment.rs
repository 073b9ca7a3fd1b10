//! Tests the judgement of a layout without its maps against the full assessment.

use crate::common::{from_text, shipped};
use sweetspot::assess::{Assessment, Feasibility};
use sweetspot::cell::Cell;
use sweetspot::layout::Workcell;

/// Changes of the shipped cell, and whether the start layout stays feasible.
const CHANGES: [(&str, bool); 9] = [
    ("", true),
    ("[equipment.worktable.placement]\nx_mm = 5000\n", false),
    ("[equipment.worktable.placement]\nx_mm = 0\ny_mm = 0\n", false),
    ("[equipment.worktable.placement]\nx_mm = 100\ny_mm = 500\n", false),
    ("[equipment.conveyor.placement]\nz_mm = 1900\n", false),
    ("clearance_mm = 400\n", false),
    (
        "[search]\nrobust = true\n[equipment.worktable]\nplacement_tolerance = { x_mm = 300, yaw_deg = 20 }\n",
        false,
    ),
    ("[operation.assembly]\nover = \"max\"\n", false),
    (
        "[operation.picking]\nrelative_to = \"assembly\"\n[equipment.worktable.placement]\nx_mm = 9000\n",
        false,
    ),
];

fn changed(change: &str) -> Cell {
    let text = format!("from = \"hitachi_cell.toml\"\n{change}");
    from_text(&text).unwrap_or_else(|faults| panic!("{change}: {faults:#?}")).cell
}

#[test]
fn a_layout_is_judged_alike_with_and_without_its_maps() {
    let (mut feasible, mut reasons) = (0, 0);
    let names = ["hitachi_paper.toml", "drilling_cell.toml", "scara_cell.toml", "track_cell.toml"];
    let cells = names.map(shipped).into_iter().chain(CHANGES.map(|(change, _)| changed(change)));
    for cell in cells {
        let name = cell.name.clone();
        let workcell = Workcell::new(cell).unwrap();
        let start = workcell.cell.start();
        let (judged, assessed) = (Feasibility::new(&workcell, &start), Assessment::new("", &workcell, start));
        assert_eq!(judged.evaluation, assessed.evaluation, "{name}");
        assert_eq!(judged.reasons, assessed.reasons(), "{name}");
        feasible += usize::from(judged.evaluation.objective.is_some());
        reasons += judged.reasons.len();
    }
    assert!(feasible >= 4 && reasons >= 8, "{feasible} feasible, {reasons} reasons");
}

#[test]
fn the_changes_are_feasible_as_stated() {
    for (change, expected) in CHANGES {
        let workcell = Workcell::new(changed(change)).unwrap();
        let judged = Feasibility::new(&workcell, &workcell.cell.start());
        assert_eq!(judged.evaluation.objective.is_some(), expected, "{change}: {:?}", judged.reasons);
    }
}
