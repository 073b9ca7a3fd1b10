//! Tests the comparison of layouts node by node, and its texts.

use crate::common::workcell;
use sweetspot::assess::{Assessment, Comparison};
use sweetspot::error_map::NodeSign;

#[test]
fn nodes_are_paired_by_their_place_on_the_surface() {
    let workcell = workcell("hitachi_paper.toml");
    let (start, mut moved) = (workcell.cell.start(), workcell.cell.start());
    moved.placements[0].y += 0.15;
    moved.placements[0].yaw += 0.2;
    let column = |name: &str, layout| Assessment::new(name, &workcell, layout);
    let comparison = Comparison::new(vec![column("A", start), column("B", moved.clone())]).unwrap();
    let difference = &comparison.differences(1).unwrap()[0];
    assert_eq!(difference.pairs.len(), 99);
    let other = &comparison.columns[1];
    for (pair, node) in difference.pairs.iter().zip(&other.maps[0].nodes) {
        let at = nalgebra::Vector3::new(pair.at.0, pair.at.1, 0.0);
        let there = moved.placements[0].pose().transform(&at);
        assert!((there - node.position).xy().norm() < 1e-12);
    }
    let (better, worse) = difference.better_and_worse();
    let (gained, lost) = difference.gained_and_lost();
    let both = difference.pairs.iter().filter(|p| p.difference().is_some()).count();
    assert!(better + worse <= both && both > 20);
    // The usable nodes of the other layout are the nodes usable in both layouts and the gained nodes.
    assert_eq!(both + gained, other.maps[0].count(NodeSign::Usable));
    assert_eq!(both + lost, comparison.columns[0].maps[0].count(NodeSign::Usable));
}

#[test]
fn a_comparison_states_how_many_times_better() {
    let workcell = workcell("hitachi_paper.toml");
    let column = |name: &str, value: Option<f64>| {
        let mut a = Assessment::new(name, &workcell, workcell.cell.start());
        a.maps[0].value = value;
        a
    };
    let say = |x: Option<f64>, y: Option<f64>| {
        let columns = vec![column("A", x), column("B", y)];
        Comparison::new(columns).unwrap().in_words().remove(0)
    };
    let name = &workcell.cell.operations[0].name;
    let sense = &workcell.cell.operations[0].sense.name;
    let said = say(Some(0.0036), Some(0.002));
    assert_eq!(said, format!("{name}: B is 1.8 times better than A in {sense} (2.000 against 3.600 mm)"));
    assert!(say(Some(0.002), Some(0.005)).contains("2.5 times worse"));
    assert!(say(Some(0.002), Some(0.00206)).contains("3.0 % worse"));
    assert!(say(Some(0.002), Some(0.002_004)).contains("as good as"));
    assert!(say(Some(0.002), None).contains("B has no spot"));
    assert!(say(None, None).contains("neither A nor B"));
}
