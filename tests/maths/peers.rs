//! Tests against reference values that were computed with other libraries; see tests/data/README.md.

use crate::common::{data, from_text, root, shipped};
use nalgebra::Vector3;
use sweetspot::cell::{Cell, Layout, MAX_JOINTS, Model, Placement};
use sweetspot::clearance::{FloorPlan, PlacedSolids, Scene};
use sweetspot::error_map::Outcome;
use sweetspot::kinematic_error::{Perturbation, pose_error};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::robot::Chain;
use sweetspot::units::mm_from_m;

fn joints(q: &[f64]) -> [f64; MAX_JOINTS] {
    std::array::from_fn(|i| q.get(i).copied().unwrap_or(0.0))
}

/// Compares with peer set A: errors of 100 configurations by the nonlinear and the linear model.
fn errors_agree(robot_cell: &Cell, name: &str) {
    let chain = Chain::new(&robot_cell.robot);
    let errors = Perturbation::new(&chain, crate::common::signed(robot_cell));
    let n = chain.axes();
    let (q, reference) = (data(&format!("a_{name}_q.bin")), data(&format!("a_{name}_ref.bin")));
    let mut worst: f64 = 0.0;
    for (q, want) in q.chunks_exact(n).zip(reference.chunks_exact(18)) {
        let posture = chain.posture(&joints(q));
        let nonlinear = pose_error(&chain.frames(&posture), &errors, Model::Nonlinear);
        // The numbers are the rows of the 3 x 4 difference. The last column is the position part, and the
        // other columns are the rotation part.
        let position = Vector3::new(want[3], want[7], want[11]);
        worst = worst.max((nonlinear.position.map(mm_from_m) - position).abs().max());
        let nominal = chain.forward(&posture).rotation;
        let turned = nalgebra::Rotation3::new(nonlinear.rotation).into_inner() * nominal - nominal;
        for (row, col) in (0..3).flat_map(|r| (0..3).map(move |c| (r, c))) {
            worst = worst.max((turned[(row, col)] - want[4 * row + col]).abs());
        }
        let linear = pose_error(&chain.frames(&posture), &errors, Model::Linear);
        let d = Vector3::new(want[12], want[13], want[14]);
        let delta = Vector3::new(want[15], want[16], want[17]);
        worst = worst.max((linear.position.map(mm_from_m) - d).abs().max());
        worst = worst.max((linear.rotation - delta).abs().max());
    }
    assert!(worst < 1e-9, "{name}: off by {worst} mm");
}

#[test]
fn the_errors_of_peer_set_a_agree() {
    errors_agree(&shipped("hitachi_cell.toml"), "pw10");
    for name in ["puma560", "ur5"] {
        let text = std::fs::read_to_string(root().join(format!("tests/data/{name}.toml"))).unwrap();
        let cell = from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell;
        errors_agree(&cell, name);
    }
}

/// Peer set C has 4 000 configurations, checked for collision with the cell at one layout, without a floor.
#[test]
fn the_collision_flags_of_peer_set_c_agree() {
    let mut cell = shipped("hitachi_cell.toml");
    let place = |x: f64, y: f64, z: f64, yaw: f64| Placement {
        x: x / 1e3,
        y: y / 1e3,
        z: z / 1e3,
        yaw: yaw.to_radians(),
    };
    let mut layout = cell.start();
    layout.placements[0] = place(300.0, 1000.0, 600.0, 10.0);
    layout.placements[1] = place(1000.0, -400.0, 600.0, 80.0);
    // Legs end at the floor, so the floor cannot simply be lowered: solids are placed first.
    let mut placed = PlacedSolids::default();
    Scene::new(&cell).place(&layout, &mut placed);
    cell.floor = -100.0;
    let scene = Scene::new(&cell);
    let chain = Chain::new(&cell.robot);
    for set in ["q", "qtask"] {
        let flags = std::fs::read_to_string(root().join(format!("tests/data/c_hits_{set}.txt"))).unwrap();
        let mut count = 0;
        for (q, flag) in data(&format!("c_pw10_{set}.bin")).chunks_exact(4).zip(flags.lines()) {
            let frames = chain.frames(&chain.posture(&joints(q)));
            assert_eq!(scene.hit(&placed, &frames.links, None).is_some(), flag == "1", "{set} {q:?}");
            count += 1;
        }
        assert_eq!(count, 2000);
    }
}

/// Peer set D has the function values f(x) of 2 000 layouts. The test computes them from our evaluation by
/// the rules of the peer. The peer ignores the heights of equipment, so the equipment here has no solids and
/// thus any height.
#[test]
fn the_layout_evaluations_of_peer_set_d_agree() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let (layouts, reference) = (data("d_layouts.bin"), data("d_ref.bin"));
    let mut flat = workcell.cell.clone();
    flat.equipment.iter_mut().for_each(|e| e.solids.clear());
    let (plan, mut found) = (FloorPlan::new(&flat), Vec::new());
    let mut worst: f64 = 0.0;
    for (x, want) in layouts.chunks_exact(7).zip(reference) {
        let mut layout = workcell.cell.start();
        set_layout(&mut layout, x);
        let evaluation = evaluate(&workcell, &layout);
        plan.overlaps(&layout, &mut found);
        let overlaps: f64 = found.iter().map(|o| 10.0 + 0.1 * mm_from_m(o.depth)).sum();
        let away = |x: f64, y: f64, h: f64| 100.0 + 0.05 * ((x.hypot(y) - 1000.0).abs() + (h - 600.0).abs());
        let unreachable = [away(x[0], x[1], x[3]), away(x[4], x[5], 600.0)];
        let errors: f64 = evaluation
            .outcomes
            .iter()
            .zip(unreachable)
            .map(|(outcome, unreachable)| match outcome {
                Outcome::Found(spot) => mm_from_m(spot.value),
                Outcome::AllCollide { .. } | Outcome::Refused { .. } | Outcome::Uncertain { .. } => 50.0,
                Outcome::Unreachable { .. } | Outcome::Unjudged(_) => unreachable,
            })
            .sum();
        worst = worst.max((errors + overlaps - want).abs());
        assert!(worst < 1e-7, "{x:?}: {} instead of {want}", errors + overlaps);
    }
}

fn set_layout(layout: &mut Layout, x: &[f64]) {
    let place = |x: f64, y: f64, z: f64, yaw: f64| Placement {
        x: x / 1e3,
        y: y / 1e3,
        z: z / 1e3,
        yaw: yaw.to_radians(),
    };
    layout.placements[0] = place(x[0], x[1], x[3], x[2]);
    layout.placements[1] = place(x[4], x[5], 600.0, x[6]);
}
