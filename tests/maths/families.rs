//! Tests one shipped cell per kinematic family. The map must have usable nodes, the search must find a layout
//! no worse than the start, and `evaluate` must confirm the result.

use crate::common::{from_text, shipped};
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Coordinate, Shape};
use sweetspot::error_map::{NodeSign, Status};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::search::{Watch, search};

/// Cells, and the method that solves their arms.
const FAMILIES: [(&str, &str); 9] = [
    ("hitachi", "base yaw and three parallel axes (closed form)"),
    ("palletizer", "base yaw, three parallel axes, roll (closed form)"),
    ("five_axis", "base yaw, three parallel axes, roll (closed form)"),
    ("scara", "SCARA (closed form)"),
    ("wrist", "six axes with three that meet in a point (closed form)"),
    ("ur", "six axes with three parallel ones (closed form)"),
    ("panda", "spherical shoulder, redundant last joint (closed form)"),
    ("track", "spherical wrist, redundant first joint (closed form)"),
    ("offset_wrist", "six axes, offset wrist (scan of joint 6)"),
];

#[test]
fn every_robot_family_is_mapped_and_searched() {
    let kinova = "from = \"offset_wrist_cell.toml\"\n[robot]\nfrom = \"robots/kinova_gen3.toml\"\n[search]\nideal = true\n";
    let kinova = from_text(kinova).unwrap_or_else(|faults| panic!("{faults:#?}")).cell;
    let kinova = (
        "kinova",
        "nearly a spherical wrist, redundant first joint (closed form and Newton's method)",
        kinova,
    );
    let mut general = kinova.2.clone();
    // With offsets of 50 mm in shoulder and wrist, the arm belongs to no family with a closed form.
    general.robot.joints[1].l += 0.05;
    general.robot.joints[4].l += 0.05;
    let general = ("general", "general chain (numeric)", general);
    let cells = FAMILIES.map(|(name, family)| (name, family, shipped(&format!("{name}_cell.toml"))));
    for (name, family, cell) in cells.into_iter().chain([kinova, general]) {
        let searched = |e: &sweetspot::cell::Equipment| {
            e.placement.iter().any(|c| matches!(c, Coordinate::Range { .. }))
        };
        let movable = cell.equipment.iter().filter(|e| e.surface.is_some() && searched(e)).count();
        assert!(movable >= 2, "{name}: {movable} movable");
        let mut settings = cell.search;
        settings.budget = if family.contains("numeric") || name == "kinova" { 6 } else { 24 };
        let workcell = Workcell::new(cell).unwrap();
        assert_eq!(workcell.inverse().family(), family, "{name}");
        let start = evaluate(&workcell, &workcell.cell.start());
        for (map, outcome) in workcell.maps(&workcell.cell.start()).iter().zip(&start.outcomes) {
            assert!(map.count(NodeSign::Usable) >= 5, "{name}: {} nodes", map.count(NodeSign::Usable));
            let spot = map.spot().unwrap();
            assert_eq!(*outcome, sweetspot::error_map::Outcome::Found(spot), "{name}");
            for node in map.nodes.iter().filter(|n| n.status == Status::Ok) {
                let posture = node.posture.as_ref().unwrap();
                let inside = workcell.cell.robot.joints.iter().zip(posture.joints);
                for (joint, q) in inside {
                    assert!(q > joint.limits.0 - 1e-5 && q < joint.limits.1 + 1e-5, "{name}: {}", joint.name);
                }
            }
        }
        let (stop, progress) = (AtomicBool::new(false), |_| {});
        let record = search(&workcell, &settings, &Watch { progress: &progress, stop: &stop });
        let best = evaluate(&workcell, &record.best.layout);
        assert_eq!(best, record.best.evaluation, "{name}");
        assert!(best.objective.unwrap() <= start.objective.unwrap(), "{name}");
    }
}

/// A six-axis cell stands beside a mesh of about 10 000 triangles, which the arm can hit.
#[test]
fn a_six_axis_cell_beside_ten_thousand_triangles_is_searched() {
    let mut cell = shipped("wrist_cell.toml");
    let solids = cell.equipment.iter().flat_map(|e| &e.solids);
    let triangles: usize =
        solids.map(|s| if let Shape::Mesh { triangles, .. } = &s.shape { triangles.len() } else { 0 }).sum();
    assert!((9_000..11_000).contains(&triangles), "{triangles} triangles");
    let machine = cell.equipment.iter().position(|e| e.name == "machine").unwrap();
    // The machine is moved over the table, where it blocks postures that were free.
    let at = cell.start().placements[0];
    cell.equipment[machine].placement = [at.x, at.y - 0.15, at.z + 0.15, 0.0].map(Coordinate::Fixed);
    let workcell = Workcell::new(cell).unwrap();
    let map = &workcell.maps(&workcell.cell.start())[0];
    let words: Vec<String> = map.nodes.iter().map(|n| n.status.reason(&workcell.cell)).collect();
    assert!(words.iter().any(|w| w.contains("machine")), "{words:#?}");
}
