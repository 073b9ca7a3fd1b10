//! Tests the part of the error that a taught frame, a fitted base and a relative operation remove. The
//! references are errors that must vanish and independent computations. The file best_fit.rs tests the fit
//! itself.

use crate::common::{cases, shipped};
use crate::readings::bench::*;
use nalgebra::{Matrix4, Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;
use sweetspot::cell::*;
use sweetspot::error_map::NodeSign;
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::pose::Pose;
use sweetspot::reading::{Taught, WorkContext, WorkFrame};
use sweetspot::robot::{Chain, Frames};

/// Returns the paper's cell with errors in every parameter and frame.
fn all_wrong(rng: &mut ChaCha8Rng) -> Cell {
    all_wrong_with(shipped("hitachi_paper.toml").robot, rng)
}

/// Returns the paper's cell with another robot and with errors in every parameter and frame.
pub fn all_wrong_with(robot: Robot, rng: &mut ChaCha8Rng) -> Cell {
    let mut cell = shipped("hitachi_paper.toml");
    cell.robot = robot;
    let n = cell.robot.axes();
    let mut some = |bound: f64| (0..n).map(|_| rng.random_range(-bound..bound)).collect::<Vec<f64>>();
    let (dq, dr, dl, dalpha, dbeta) = (some(5e-3), some(2e-3), some(2e-3), some(5e-3), some(5e-3));
    let mut frame = || std::array::from_fn(|k| rng.random_range(-1.0..1.0) * if k < 3 { 2e-3 } else { 4e-3 });
    let (base, tool) = (frame(), frame());
    let mut quarter = || frame().map(|v: f64| v / 4.0);
    let joints = (0..n).map(|_| quarter()).collect();
    let fixture = frame();
    let (name, elastic) = ("all".into(), vec![]);
    let signed =
        SignedErrors { name, dq, dr, dl, dalpha, dbeta, base, tool, joints, elastic, periodic: vec![] };
    (cell.robot.errors, cell.errors) = (vec![ErrorSet::Signed(signed)], 0);
    cell.equipment[0].errors = Some(FrameErrors::Signed(fixture));
    cell
}

fn reachable(rng: &mut ChaCha8Rng, robot: &Robot) -> Frames {
    frames_at(robot, &random_joints(rng, robot))
}

/// A frame is taught at three postures. The rule leaves no error at the origin, an error along the line at
/// the second point, and an error in the plane at the third point.
#[test]
fn a_taught_frame_leaves_the_error_of_its_rule() {
    let mut rng = ChaCha8Rng::seed_from_u64(51);
    for _ in 0..50 {
        let mut cell = all_wrong(&mut rng);
        cell.registration = Registration::Taught;
        let chain = Chain::new(&cell.robot);
        // The triangle is as high as a triangle that an operator would teach.
        let mut postures = [0, 1, 2].map(|_| reachable(&mut rng, &cell.robot));
        let height = |p: &[Frames; 3]| {
            let [a, b, c] = [0, 1, 2].map(|k| p[k].tcp.translation);
            (b - a).cross(&(c - a)).norm() / (b - a).norm().max((c - a).norm()).max((c - b).norm())
        };
        while height(&postures) < 0.1 {
            postures[2] = reachable(&mut rng, &cell.robot);
            postures[1] = reachable(&mut rng, &cell.robot);
        }
        for model in Model::ALL {
            cell.model = model;
            let evaluator = gauge_of(&cell);
            let taught = Taught::new(&chain, &evaluator.sources, postures, false);
            let site = WorkFrame {
                equipment: 0,
                work: Pose::identity(),
                world: nalgebra::Matrix3::identity(),
                taught: Some(Box::new(taught)),
            };
            let situation = WorkContext { site, reference: None };
            let values = evaluator.sources.signed();
            let mut memory = evaluator.memory();
            let [a, b, c] =
                postures.map(|f| evaluator.error_of(&values, &situation, &f, model, &mut memory).position);
            let [o, p, q] = postures.map(|f| f.tcp.translation);
            let (x, normal) = ((p - o).normalize(), (p - o).cross(&(q - o)).normalize());
            assert!(a.norm() < 1e-14, "{model:?}: {a}");
            assert!((b - x * b.dot(&x)).norm() < 1e-12, "{model:?}: {b}");
            assert!(c.dot(&normal).abs() < 1e-12, "{model:?}: {c}");
            assert!(b.norm() > 1e-7 && c.norm() > 1e-7);
        }
    }
}

/// Errors of base and fixture move everything rigidly. They cancel with a taught frame, and errors of the
/// base cancel with a fitted base.
#[test]
fn rigid_errors_cancel_in_a_relative_error() {
    let mut rng = ChaCha8Rng::seed_from_u64(52);
    for _ in 0..cases(2, 20) {
        let mut cell = all_wrong(&mut rng);
        let n = cell.robot.axes();
        if let ErrorSet::Signed(e) = &mut cell.robot.errors[0] {
            let zeros = || vec![0.0; n];
            (e.dq, e.dr, e.dl, e.dalpha, e.dbeta, e.tool) =
                (zeros(), zeros(), zeros(), zeros(), zeros(), [0.0; 6]);
            e.joints.fill([0.0; 6]);
        }
        for (registration, fixture) in [(Registration::Taught, true), (Registration::BestFit, false)] {
            cell.registration = registration;
            if !fixture {
                cell.equipment[0].errors = None;
            }
            let start = cell.start();
            for model in Model::ALL {
                cell.model = model;
                let workcell = Workcell::new(cell.clone()).unwrap();
                let map = workcell.maps(&start).remove(0);
                assert!(map.count(NodeSign::Usable) > 70);
                for p in map.nodes.iter().filter_map(|n| n.posture.as_ref()) {
                    let bound = if model == Model::SecondOrder { 1e-6 } else { 1e-12 };
                    assert!(p.error.norm() < bound, "{registration:?} {model:?}: {}", p.error);
                    let most = p.figures.iter().map(|f| f.worst_linear.max(f.p95)).fold(0.0, f64::max);
                    // The second-order mean remains, because registration is computed to first order.
                    assert!(most < 1e-4, "{registration:?} {model:?}: {most}");
                }
            }
        }
    }
}

fn homogeneous(pose: &Pose) -> Matrix4<f64> {
    let mut t = pose.rotation.to_homogeneous();
    t.fixed_view_mut::<3, 1>(0, 3).copy_from(&pose.translation);
    t
}

/// The reference for pick and place is a product of 4 x 4 matrices. The error of the pick changes the grip of
/// the part, and the error of the place acts on the gripper again.
#[test]
fn the_relative_error_is_the_error_of_the_placed_part() {
    let mut rng = ChaCha8Rng::seed_from_u64(54);
    for _ in 0..50 {
        let mut cell = all_wrong(&mut rng);
        cell.equipment[0].errors = None;
        let evaluator = gauge_of(&cell);
        let errors = crate::common::signed(&cell).clone();
        let [pick, place] = [0, 1].map(|_| random_joints(&mut rng, &cell.robot));
        let [p, q] = [&pick, &place].map(|q| frames_at(&cell.robot, q));
        let site = || WorkFrame {
            equipment: 0,
            work: Pose::identity(),
            world: nalgebra::Matrix3::identity(),
            taught: None,
        };
        let reference = evaluator.pick_reference(site(), p);
        let situation = WorkContext { site: site(), reference: Some(Box::new(reference)) };
        let values = evaluator.sources.signed();
        let mut memory = evaluator.memory();
        let got = evaluator.error_of(&values, &situation, &q, Model::Nonlinear, &mut memory);
        // T2' (T1'^-1 T1) is the pose of the placed part, and T2 is the intended pose.
        let [t1, t2] = [&p, &q].map(|f| homogeneous(&f.tcp));
        let [wrong1, wrong2] =
            [&pick, &place].map(|q| crate::kinematics::product::tcp(&cell.robot, q, &errors, 1.0));
        let part = wrong2 * wrong1.try_inverse().unwrap() * t1;
        let position = (part - t2).fixed_view::<3, 1>(0, 3).into_owned();
        let turn = (part * t2.try_inverse().unwrap()).fixed_view::<3, 3>(0, 0).into_owned();
        assert!((got.position - position).norm() < 1e-12, "{}", got.position - position);
        assert!((Rotation3::new(got.rotation).into_inner() - turn).norm() < 1e-12);
        // The linear and the nonlinear error agree to first order. If pick and place are at the same posture,
        // the error vanishes.
        let linear = evaluator.error_of(&values, &situation, &q, Model::Linear, &mut memory);
        let off = (linear.position - position).norm();
        assert!(off < 5e-4, "{off}");
        let same = evaluator.error_of(&values, &situation, &p, Model::Nonlinear, &mut memory);
        assert!(same.position.norm() < 1e-13 && same.rotation.norm() < 1e-13);
    }
}

/// A displaced fixture changes the error, which is measured relative to the displaced work.
#[test]
fn fixture_errors_match_hand_calculation() {
    let mut cell = shipped("hitachi_paper.toml");
    let n = cell.robot.axes();
    let none = || vec![0.0; n];
    let signed = SignedErrors {
        name: "none".into(),
        dq: none(),
        dr: none(),
        dl: none(),
        dalpha: none(),
        dbeta: none(),
        base: [0.0; 6],
        tool: [0.0; 6],
        joints: vec![[0.0; 6]; n],
        elastic: vec![],
        periodic: vec![],
    };
    (cell.robot.errors, cell.errors) = (vec![ErrorSet::Signed(signed)], 0);
    cell.equipment[0].placement[3] = Coordinate::Fixed(FRAC_PI_2);
    // The fixture is 1 mm off along its x, the world's y, and turned about its z.
    let mut fixture = [0.0; 6];
    (fixture[0], fixture[5]) = (1e-3, 2e-3);
    cell.equipment[0].errors = Some(FrameErrors::Signed(fixture));
    cell.model = Model::Linear;
    let start = cell.start();
    let workcell = Workcell::new(cell).unwrap();
    for node in &workcell.maps(&start).remove(0).nodes {
        let Some(p) = &node.posture else { continue };
        let at = node.position - Vector3::new(0.0, 1.25, 1.35);
        let work = Vector3::new(0.0, 1e-3, 0.0) + Vector3::new(0.0, 0.0, 2e-3).cross(&at);
        assert!((p.error + work).norm() < 1e-15, "{} {}", p.error, work);
        assert!((p.rotation + Vector3::new(0.0, 0.0, 2e-3)).norm() < 1e-15);
        // As tolerances, the errors of robot and fixture add up.
        let worst = p.figures[4].worst_linear;
        assert!((worst - work.norm().max((work - Vector3::new(0.0, 2e-3, 0.0)).norm())).abs() < 1e-14);
    }
}

/// A fixture with errors in all components moves the work by `W Trans Rz Ry Rx W^-1`, where W is the nominal
/// frame of the work. The error is the inverse motion of the TCP.
#[test]
fn all_components_of_a_fixture_error_act_in_their_stated_order() {
    let mut cell = shipped("hitachi_paper.toml");
    let n = cell.robot.axes();
    let signed = crate::kinematics::product::no_errors(n);
    (cell.robot.errors, cell.errors) = (vec![ErrorSet::Signed(signed)], 0);
    cell.equipment[0].placement[3] = Coordinate::Fixed(0.3);
    let fixture = [1e-3, -2e-3, 3e-3, 0.05, -0.08, 0.11];
    cell.equipment[0].errors = Some(FrameErrors::Signed(fixture));
    cell.model = Model::Nonlinear;
    let turn = |axis: Vector3<f64>, angle: f64| Rotation3::new(axis * angle).to_homogeneous();
    let error = nalgebra::Translation3::new(fixture[0], fixture[1], fixture[2]).to_homogeneous()
        * turn(Vector3::z(), fixture[5])
        * turn(Vector3::y(), fixture[4])
        * turn(Vector3::x(), fixture[3]);
    let start = cell.start();
    let work = homogeneous(&start.placements[0].pose());
    let back = (work * error * work.try_inverse().unwrap()).try_inverse().unwrap();
    let mut seen = 0;
    for node in &Workcell::new(cell).unwrap().maps(&start).remove(0).nodes {
        let Some(p) = &node.posture else { continue };
        let at = (back * node.position.push(1.0)).xyz() - node.position;
        assert!((p.error - at).norm() < 1e-12, "{} {at}", p.error);
        seen += 1;
    }
    assert!(seen > 70, "{seen}");
}

/// If no three points of a surface can be touched, the surface has no taught frame, and the layout has no
/// value. A part that cannot be picked cannot be placed.
#[test]
fn a_frame_that_cannot_be_taught_is_reported() {
    let mut cell = shipped("hitachi_paper.toml");
    cell.registration = Registration::Taught;
    let workcell = Workcell::new(cell.clone()).unwrap();
    assert!(evaluate(&workcell, &cell.start()).objective.is_some());
    cell.operations[0].teach = Some([(-0.7, -0.3), (0.7, -0.3), (0.7, 0.3)]);
    let workcell = Workcell::new(cell.clone()).unwrap();
    let start = cell.start();
    let missed = evaluate(&workcell, &start);
    assert!(missed.objective.is_none() && missed.cost.is_finite());
    let map = workcell.maps(&start).remove(0);
    assert_eq!((map.count(NodeSign::Usable), map.count(NodeSign::Unjudged)), (0, 80));
    let said =
        map.nodes.iter().find(|n| n.status.name() == "unjudged").unwrap().status.reason(&workcell.cell);
    assert!(said.contains("cannot be taught"), "{said}");
}
