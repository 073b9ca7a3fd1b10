//! Tests the drawing of an assessed layout.

mod arrows;
mod mesh;

use crate::common::workcell;
use sweetspot::assess::Assessment;
use sweetspot::drawing::{Detail, Drawing, PartKind};

#[test]
fn a_drawing_shows_the_values_of_the_assessment() {
    let workcell = workcell("hitachi_paper.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let drawing = Drawing::new(&a, &Detail::FULL).unwrap();
    let field = &drawing.fields[0];
    assert_eq!((field.nodes.len(), field.size, field.usable().count()), (99, (11, 9), 80));
    assert_eq!(drawing.lenses.len(), field.takes.len());
    assert_eq!(drawing.lenses.len(), 9, "{:?}", drawing.lenses);
    // The first lens belongs to the cell.
    let own = field.range(0, field.sense).unwrap().0;
    assert!((own - a.maps[0].value.unwrap()).abs() < 1e-15);
    // The worst case is never less than the signed sample, node by node.
    let lens = |reading| drawing.lenses.iter().position(|l| l.reading == reading).unwrap();
    let [signed, worst] = [sweetspot::cell::Reading::Signed, sweetspot::cell::Reading::WorstCase].map(lens);
    for k in field.usable() {
        let value = |take: usize| field.takes[take].values[field.sense][k].unwrap();
        assert!(value(worst) >= value(signed), "node {k}");
    }
    assert!(!drawing.envelopes[0].at_work.is_empty() && !drawing.envelopes[0].around.is_empty());
}

#[test]
fn the_robot_moves_from_home_to_its_spots_and_back() {
    let workcell = workcell("hitachi_cell.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let drawing = Drawing::new(&a, &Detail::PLAIN).unwrap();
    let movement = &drawing.movement;
    assert_eq!(movement.frames.len(), movement.times.len());
    assert!(movement.times.windows(2).all(|t| t[0] < t[1]));
    let spots = (0..a.maps.len()).filter(|k| a.spot(*k).is_some()).count();
    assert_eq!(movement.stops.len(), spots + 2);
    for k in 0..a.maps.len() {
        let Some((node, _)) = a.spot(k) else { continue };
        let tcp = movement.at(k).unwrap().last().unwrap();
        assert!((tcp.translation - node.position).norm() < 1e-9);
    }
    // No joint frame jumps from one picture to the next.
    for pair in movement.frames.windows(2) {
        let far = pair[0].iter().zip(&pair[1]).map(|(a, b)| (a.translation - b.translation).norm());
        assert!(far.fold(0.0, f64::max) < 0.25);
    }
    assert_eq!(drawing.lenses.len(), 1);
}

#[test]
fn a_large_map_is_thinned_and_keeps_its_spot() {
    let workcell = workcell("hitachi_cell.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 30 }).unwrap();
    for (field, map) in drawing.fields.iter().zip(&a.maps) {
        assert!(field.every > 1 && field.nodes.len() <= 30);
        assert_eq!(field.nodes.len(), field.size.0 * field.size.1);
        assert_eq!(field.spot, map.best_node().map(|n| n.position));
    }
}

/// A robot without solids is drawn as bars between the origins of its frames.
#[test]
fn every_robot_without_solids_is_drawn_as_bars() {
    for name in ["ur_cell.toml", "panda_cell.toml", "scara_cell.toml", "track_cell.toml"] {
        let mut workcell = workcell(name);
        let (solids, tools) = (workcell.cell.robot.solids.len(), workcell.cell.robot.tool_solids);
        workcell.cell.robot.solids.drain(..solids - tools);
        let a = Assessment::new("start", &workcell, workcell.cell.start());
        let plain = Detail { lenses: false, envelopes: false, nodes: usize::MAX };
        let parts = Drawing::new(&a, &plain).unwrap().parts;
        let robot: Vec<_> = parts.iter().filter(|p| p.kind == PartKind::Robot).collect();
        assert!(robot.len() > 2, "{name}");
        assert_eq!(parts.iter().filter(|p| p.kind == PartKind::Tool).count(), tools, "{name}");
    }
}
