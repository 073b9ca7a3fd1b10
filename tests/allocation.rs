//! Tests that the node loop allocates no memory in any reading.
#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "common/mod.rs"]
mod common;

use allocation_counter::measure;
use common::shipped;
use sweetspot::assess::Feasibility;
use sweetspot::cell::*;
use sweetspot::layout::{Workcell, Workspace, evaluate_in};
use sweetspot::pose::Pose;
use sweetspot::reach::{
    AttitudeGoal, GeneralSixAxes, Inverse, Numeric, RefinedSolver, SphericalWrist, TcpGoal, ThreeParallel,
};
use sweetspot::reading::{BestFit, ErrorEvaluator, ErrorSources, Taught, WorkContext, WorkFrame};
use sweetspot::robot::{Chain, Frames};

fn situations(cell: &Cell, evaluator: &ErrorEvaluator, chain: &Chain) -> Vec<WorkContext> {
    let site = || WorkFrame {
        equipment: 0,
        work: Pose::identity(),
        world: nalgebra::Matrix3::identity(),
        taught: None,
    };
    let frames =
        |q: [f64; 4]| chain.frames(&chain.posture(&std::array::from_fn(|i| *q.get(i).unwrap_or(&0.0))));
    let postures = [[0.3, 0.2, 0.1, -0.4], [-0.6, 0.1, 0.2, -0.2], [0.4, -0.5, 0.1, 0.3]].map(frames);
    let mut all = vec![WorkContext { site: site(), reference: None }];
    if cell.registration == Registration::Taught {
        let taught = Some(Box::new(Taught::new(chain, &evaluator.sources, postures, true)));
        all = vec![WorkContext { site: WorkFrame { taught, ..site() }, reference: None }];
    }
    let picked = evaluator.pick_reference(site(), postures[1]);
    all.push(WorkContext { site: site(), reference: Some(Box::new(picked)) });
    all
}

#[test]
fn the_node_loop_does_not_allocate() {
    let mut cell = shipped("hitachi_cell.toml");
    let chain = Chain::new(&cell.robot);
    let arm = Inverse::new(&chain);
    let approach = arm.tool_attitudes(&Attitude::elevation(-std::f64::consts::FRAC_PI_2), 0.0);
    let mut postures = 0;
    for registration in Registration::ALL {
        for (reading, model) in Reading::ALL.into_iter().flat_map(|r| Model::ALL.map(|m| (r, m))) {
            for sense in ["xy", "xyz@tool", "rz", "rotation"] {
                (cell.registration, cell.reading, cell.model) = (registration, reading, model);
                cell.operations[0].sense = Sense::plain(sense).unwrap();
                let evaluator = ErrorEvaluator::new(&cell, &cell.operations[0]);
                let mut memory = evaluator.memory();
                let (mut scratch, mut frames) = (arm.scratch(), Frames::default());
                for situation in situations(&cell, &evaluator, &chain) {
                    let target = nalgebra::Vector3::new(0.2, 0.95, 0.7);
                    let mut sum = 0.0;
                    let used = measure(|| {
                        arm.visit(&target, &approach, &mut scratch, |_, posture| {
                            chain.place(posture, &mut frames);
                            sum += evaluator.value(&situation, &frames, &mut memory);
                            postures += 1;
                        });
                    });
                    assert!(sum > 0.0 && sum.is_finite());
                    assert_eq!(used.count_total, 0, "{registration:?} {reading:?} {model:?} {sense}");
                }
            }
        }
    }
    assert!(postures > 200);
    // The counter itself works.
    assert!(measure(|| drop(BestFit::new(&chain, &ErrorSources::new(&cell, 0, None), true))).count_total > 0);
}

/// For dominating bounded parameters, the statistics use points that are prepared before the node loop.
#[test]
fn the_node_loop_does_not_allocate_for_bounded_parameters() {
    let mut cell = shipped("hitachi_cell.toml");
    let chain = Chain::new(&cell.robot);
    let axes = cell.robot.axes();
    let mut spreads = vec![Spread::of_magnitude(0.0); Parameter::count(axes)];
    for (k, distribution) in
        [(0, Distribution::Uniform), (5, Distribution::Triangular), (6, Distribution::Normal)]
    {
        spreads[k] = Spread { plus_minus: 1e-3, distribution, sigmas: 3.0 };
    }
    cell.robot.errors = vec![ErrorSet::Tolerance(Tolerance {
        name: "bounded".into(),
        spreads,
        covariance: None,
        costs: Vec::new(),
    })];
    (cell.errors, cell.reading, cell.operations[0].limit) = (0, Reading::Statistical, Some(1e-3));
    let frames = chain.frames(
        &chain.posture(&std::array::from_fn(|i| [0.3, 0.2, 0.1, -0.4].get(i).copied().unwrap_or(0.0))),
    );
    for quantity in Quantity::ALL {
        cell.quantity = quantity;
        let evaluator = ErrorEvaluator::new(&cell, &cell.operations[0]);
        let mut memory = evaluator.memory();
        for situation in situations(&cell, &evaluator, &chain) {
            let mut value = 0.0;
            let used = measure(|| value = evaluator.value(&situation, &frames, &mut memory));
            assert!(value.is_finite() && used.count_total == 0, "{quantity:?}: {value} {}", used.count_total);
        }
    }
}

/// An evaluation with more nodes allocates no more memory, with ranking and without. The redundant joint of
/// track_cell is refined.
#[test]
fn an_evaluation_does_not_allocate_per_node() {
    let cells = [("hitachi_cell.toml", (40, 30)), ("track_cell.toml", (9, 8))];
    for ((name, fine), ranked) in cells.into_iter().flat_map(|cell| [(cell, true), (cell, false)]) {
        let counts = [(3, 2), fine].map(|grid| {
            let mut cell = shipped(name);
            for operation in &mut cell.operations {
                if let sweetspot::cell::Place::Grid { divisions, .. } = &mut operation.place {
                    *divisions = grid;
                }
            }
            let workcell = Workcell::new(cell).unwrap();
            assert_eq!(workcell.is_ranked(), name == "hitachi_cell.toml");
            let workcell = if ranked { workcell } else { workcell.unranked() };
            let (layout, mut memory) = (workcell.cell.start(), Workspace::default());
            evaluate_in(&workcell, &layout, &mut memory);
            measure(|| drop(evaluate_in(&workcell, &layout, &mut memory))).count_total
        });
        assert_eq!(counts[0], counts[1], "{name}, ranked: {ranked}");
    }
}

/// A map allocates the figures of every node with a posture. A judgement computes no figures.
#[test]
fn a_judgement_of_a_layout_computes_no_figures_of_nodes() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for change in ["", "[equipment.worktable.placement]\nx_mm = 100\ny_mm = 500\n"] {
        let text = format!("from = \"hitachi_cell.toml\"\n{change}");
        let mut cell = common::from_text(&text).unwrap_or_else(|faults| panic!("{faults:#?}")).cell;
        for operation in &mut cell.operations {
            if let sweetspot::cell::Place::Grid { divisions, .. } = &mut operation.place {
                *divisions = (50, 40);
            }
        }
        let workcell = Workcell::new(cell).unwrap();
        let layout = workcell.cell.start();
        // The counter sees only the thread that measures.
        let (judged, mapped) = pool.install(|| {
            let judged = measure(|| drop(Feasibility::new(&workcell, &layout))).count_total;
            (judged, measure(|| drop(workcell.maps(&layout))).count_total)
        });
        assert!(judged * 2 < mapped, "{change}: {judged} and {mapped} allocations");
    }
}

/// The fast descents use only the stack. Memory is allocated only if all fast descents miss the goal.
#[test]
fn one_numeric_solution_does_not_allocate() {
    let chain = Chain::new(&shipped("hitachi_cell.toml").robot);
    let solver = Numeric::new(&chain);
    for q in [[0.3, 0.2, 0.1, -0.4], [-0.6, 0.1, 0.2, -0.2], [0.4, -0.5, 0.1, 0.3]] {
        let q = std::array::from_fn(|i| *q.get(i).unwrap_or(&0.0));
        let tcp = chain.forward(&chain.posture(&q));
        for attitude in [
            AttitudeGoal::Any,
            AttitudeGoal::Axis(tcp.rotation * chain.tool_axis),
            AttitudeGoal::Rotation(tcp.rotation),
        ] {
            let (goal, mut solved) = (TcpGoal { position: tcp.translation, attitude }, false);
            let used = measure(|| solved = solver.one(&goal).is_some());
            assert!(solved && used.count_total == 0, "{goal:?}: {}", used.count_total);
        }
    }
}

#[test]
fn inverse_kinematics_of_six_axes_does_not_allocate() {
    let load = |name: &str| common::load_from(&common::root().join("tests/data"), name).unwrap().cell.robot;
    let (puma, ur5) = (load("puma560.toml"), load("ur5.toml"));
    let mut general = puma.clone();
    (general.joints[0].l, general.joints[1].alpha) = (0.1, 0.3);
    let (wrist, oblique) = (Chain::new(&puma), Chain::new(&general));
    let solvers = [&wrist, &oblique].map(|chain| SphericalWrist::new(chain).unwrap());
    let parallel = (Chain::new(&ur5), ThreeParallel::new(&Chain::new(&ur5)).unwrap());
    let mut nearly = puma.clone();
    nearly.joints[4].l = 1e-4;
    let nearly = Chain::new(&nearly);
    let (refined, elimination) =
        (RefinedSolver::new(&nearly).unwrap(), GeneralSixAxes::new(&nearly).unwrap());
    let q = [0.3, 0.4, -0.5, 0.6, 0.7, -0.8, 0.0, 0.0];
    let chains = [&wrist, &oblique, &parallel.0, &nearly, &nearly];
    for (solver, chain) in chains.into_iter().enumerate() {
        for far in [0.0, 9.0] {
            let mut flange = chain.forward(&chain.posture(&q));
            flange.translation.x += far;
            let (mut scratch, mut found, mut missing) = (chain.posture(&q), 0, 0.0);
            let used = measure(|| {
                missing = match solver {
                    2 => parallel.1.solve(&flange, &mut scratch, &mut |_, _| found += 1),
                    3 => refined.solve(&flange, &mut scratch, &mut |_, _| found += 1),
                    4 => elimination.solve(&flange, &mut scratch, &mut |_, _| found += 1),
                    k => solvers[k].solve(&flange, &mut scratch, &mut |_, _| found += 1),
                };
            });
            assert_eq!((used.count_total, found > 0, missing > 0.0), (0, far == 0.0, far > 0.0), "{solver}");
        }
    }
}
