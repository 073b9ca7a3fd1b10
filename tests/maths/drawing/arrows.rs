//! Tests the error arrows of a drawing.

use crate::common::workcell;
use nalgebra::Vector3;
use sweetspot::assess::Assessment;
use sweetspot::cell::Reading;
use sweetspot::drawing::Detail;
use sweetspot::drawing::round_numbers::{HALF_DIGITS, round_down};
use sweetspot::drawing::{Arrow, Component, Drawing};

#[test]
fn arrows_are_the_exaggerated_errors() {
    let workcell = workcell("hitachi_paper.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let detail = Detail { lenses: false, envelopes: false, nodes: usize::MAX };
    let drawing = Drawing::new(&a, &detail).unwrap();
    // The file has ten by eight divisions of a table of 1500 by 700 mm.
    assert!((drawing.fields[0].spacing() - 0.7 / 8.0).abs() < 1e-12);
    let enlarged = drawing.exaggeration(0);
    let errors = || a.maps[0].nodes.iter().filter(|n| n.status.name() == "ok");
    let longest = errors().map(|n| n.posture.as_ref().unwrap().error.norm()).fold(0.0, f64::max);
    let share = longest * enlarged / (1.5 * 0.7 / 8.0);
    assert!((0.66..=1.0).contains(&share), "{longest} times {enlarged}");
    for (axis, component) in Component::ALL.into_iter().enumerate() {
        let arrows = drawing.arrows(0, 0, component);
        assert_eq!(arrows.len(), 80, "{component:?}");
        for (arrow, node) in arrows.iter().zip(errors()) {
            let error = node.posture.as_ref().unwrap().error;
            let mut shown = (arrow.tip - arrow.tail) / enlarged;
            assert_eq!(arrow.tail, node.position);
            if axis < 3 {
                assert!((shown[axis] - error[axis]).abs() < 1e-12);
                shown[axis] = 0.0;
                assert_eq!(shown, Vector3::zeros());
            } else {
                assert!((shown - error).norm() < 1e-12);
            }
        }
    }
}

#[test]
fn unsigned_errors_have_arrows_both_ways() {
    let workcell = workcell("hitachi_paper.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let detail = Detail { lenses: true, envelopes: false, nodes: usize::MAX };
    let drawing = Drawing::new(&a, &detail).unwrap();
    let worst = drawing.lenses.iter().position(|l| l.reading == Reading::WorstCase).unwrap();
    let enlarged = drawing.exaggeration(worst);
    for (sense, component) in [(0, Component::X), (2, Component::Z), (4, Component::Resultant)] {
        let arrows = drawing.arrows(0, worst, component);
        assert_eq!(arrows.len(), 160);
        for pair in arrows.chunks(2) {
            assert_eq!(pair[0].node, pair[1].node);
            assert!((pair[0].tip + pair[1].tip - 2.0 * pair[0].tail).norm() < 1e-12);
            let said = drawing.fields[0].takes[worst].values[sense][pair[0].node].unwrap();
            assert!(((pair[0].tip - pair[0].tail).norm() / enlarged - said).abs() < 1e-12);
        }
    }
}

#[test]
fn an_arrow_exaggeration_is_a_round_number() {
    let cases = [(37.4, 35.0), (3.99, 3.5), (1.0, 1.0), (1e3, 1e3), (999.0, 950.0), (0.27, 0.25)];
    for (raw, said) in cases {
        let round = round_down(raw, HALF_DIGITS);
        assert!((round / said - 1.0f64).abs() < 1e-12, "{raw}: {round}");
    }
}

#[test]
fn a_solid_arrow_is_closed_and_its_barbs_are_perpendicular() {
    for tip in [Vector3::new(0.3, -0.4, 0.0), Vector3::new(0.0, 0.0, -0.5), Vector3::new(0.1, 0.2, 0.3)] {
        let arrow = Arrow { node: 0, tail: Vector3::new(1.0, 2.0, 3.0), tip, head: 0.04 };
        let mesh = arrow.mesh();
        let p = |i: u32| mesh.positions[i as usize] - arrow.tail;
        let volume: f64 = mesh.triangles.iter().map(|[a, b, c]| p(*a).dot(&p(*b).cross(&p(*c)))).sum();
        // Prism and pyramid stand on regular hexagons of area 3 sqrt(3) / 2 r^2.
        let hexagon = |r: f64| 1.5 * 3f64.sqrt() * r * r;
        let shaft = (arrow.tip - arrow.tail).norm() - arrow.head;
        let exact = hexagon(arrow.head * 0.12) * shaft + hexagon(arrow.head * 0.35) * arrow.head / 3.0;
        assert!((volume / 6.0 / exact - 1.0).abs() < 1e-9, "{tip:?}: {volume}");
        let [a, b, c, d] = arrow.barbs();
        assert!((a - b).z.abs() < 1e-12 && (a - b).dot(&(c - d)).abs() < 1e-12);
        assert!((((a + b) / 2.0 - arrow.tip).norm() - 0.04).abs() < 1e-12);
    }
}
