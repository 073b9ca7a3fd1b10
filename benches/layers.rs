//! Benchmarks of the layers of an evaluation, on the shipped cells: a node, a map of 99 nodes, the
//! collision check of one posture, and others. `evaluate` runs on random layouts, and on plausible
//! layouts, which place the equipment around the robot.
//!
//! `cargo bench --bench layers` runs them. The 2000 layouts are in tests/data: 1000 random, then 1000
//! plausible.

#![allow(clippy::expect_used)] // without its data, a benchmark has nothing to measure

use criterion::{Criterion, criterion_group, criterion_main};
use rayon::prelude::*;
use std::hint::black_box;
use sweetspot::cell::{Attitude, Cell, ErrorSet, Layout, Model, Place, Placement, Reading, Sense};
use sweetspot::clearance::{FloorPlan, PlacedSolids, Scene};
use sweetspot::kinematic_error::{Perturbation, position_error};
use sweetspot::layout::{Workcell, Workspace, evaluate_in};
use sweetspot::pose::Pose;
use sweetspot::reach::Inverse;
use sweetspot::reading::{ErrorEvaluator, WorkContext, WorkFrame};
use sweetspot::robot;
use sweetspot::robot::Chain;
use sweetspot::{cell, files};

fn folder() -> std::path::PathBuf {
    std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn shipped(name: &str) -> Cell {
    let read = &mut |path: &str| std::fs::read(folder().join("cells").join(path)).map_err(|e| e.to_string());
    files::load(name, read).expect("a shipped cell").cell
}

fn data(name: &str) -> Vec<f64> {
    let bytes = std::fs::read(folder().join("tests/data").join(name)).expect("reference data");
    bytes.chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().expect("8 bytes"))).collect()
}

/// Reads the layouts of the reference data. A row is x, y, yaw and height of the table, then x, y and yaw of
/// the conveyor, in mm and degrees.
fn layouts(cell: &Cell) -> Vec<Layout> {
    let at = |x: f64, y: f64, z: f64, yaw: f64| Placement {
        x: x / 1e3,
        y: y / 1e3,
        z: z / 1e3,
        yaw: yaw.to_radians(),
    };
    let layout = |x: &[f64]| {
        let mut layout = cell.start();
        layout.placements[0] = at(x[0], x[1], x[3], x[2]);
        layout.placements[1] = at(x[4], x[5], 600.0, x[6]);
        layout
    };
    data("d_layouts.bin").chunks_exact(7).map(layout).collect()
}

fn node(c: &mut Criterion) {
    let cell = shipped("hitachi_ideal.toml");
    let chain = Chain::new(&cell.robot);
    let ErrorSet::Signed(signed) = cell.error_set() else { unreachable!("a signed sample") };
    let errors = Perturbation::new(&chain, signed);
    let mut frames = chain.frames(&chain.posture(&[0.0; cell::MAX_JOINTS]));
    let arm = Inverse::new(&chain);
    let approach = arm.tool_attitudes(&Attitude::elevation(-std::f64::consts::FRAC_PI_2), 0.0);
    let target = nalgebra::Vector3::new(0.2, 0.95, 0.7);
    let mut scratch = arm.scratch();
    c.bench_function("node: all branches, limits, nonlinear error", |b| {
        b.iter(|| {
            let mut least = f64::INFINITY;
            arm.visit(black_box(&target), &approach, &mut scratch, |_, posture| {
                chain.place(posture, &mut frames);
                let e = position_error(&frames, &errors, Model::Nonlinear);
                least = least.min(e.x * e.x + e.y * e.y);
            });
            least
        })
    });
    let posture = chain.posture(&[0.3, 0.2, 0.1, -0.4, 0.0, 0.0, 0.0, 0.0]);
    c.bench_function("frames", |b| b.iter(|| chain.place(black_box(&posture), black_box(&mut frames))));
    for model in Model::ALL {
        c.bench_function(&format!("frames and position error: {}", model.name()), |b| {
            b.iter(|| {
                chain.place(black_box(&posture), &mut frames);
                position_error(&frames, &errors, model)
            })
        });
    }
}

/// Measures the readings of the errors. The operation has the sense xyz, which has three components.
///
/// The first two benchmarks visit every branch of one target: every posture that reaches this target. The
/// function `node` uses the same target. The first benchmark computes the value of the signed reading. The
/// second benchmark computes the exact worst case and the covariance of the linear model. Further benchmarks
/// compute the nonlinear worst-case and statistical figures of one posture.
fn readings(c: &mut Criterion) {
    let mut cell = shipped("hitachi_ideal.toml");
    cell.model = Model::Linear;
    cell.operations[0].sense = Sense::plain("xyz").expect("a plain sense");
    let chain = Chain::new(&cell.robot);
    let arm = Inverse::new(&chain);
    let approach = arm.tool_attitudes(&Attitude::elevation(-std::f64::consts::FRAC_PI_2), 0.0);
    let target = nalgebra::Vector3::new(0.2, 0.95, 0.7);
    let (mut scratch, mut frames) = (arm.scratch(), robot::Frames::default());
    let site = WorkFrame {
        equipment: 0,
        work: Pose::identity(),
        world: nalgebra::Matrix3::identity(),
        taught: None,
    };
    let situation = WorkContext { site, reference: None };
    for (model, reading) in [(Model::Nonlinear, "signed"), (Model::Linear, "worst case and covariance")] {
        cell.model = model;
        let evaluator = ErrorEvaluator::new(&cell, &cell.operations[0]);
        let mut memory = evaluator.memory();
        c.bench_function(&format!("node, {reading}"), |b| {
            b.iter(|| {
                let mut sum = 0.0;
                arm.visit(black_box(&target), &approach, &mut scratch, |_, posture| {
                    chain.place(posture, &mut frames);
                    if reading == "signed" {
                        sum += evaluator.value(&situation, &frames, &mut memory);
                    } else {
                        evaluator.prepare(&situation, &frames, &mut memory);
                        sum += evaluator.worst(&evaluator.sense, &situation, &frames, &mut memory).linear;
                        sum += evaluator.norm(&evaluator.sense, &situation, &frames, &mut memory).rms();
                    }
                });
                sum
            })
        });
    }
    cell.model = Model::Nonlinear;
    for reading in [Reading::WorstCase, Reading::Statistical] {
        cell.reading = reading;
        let evaluator = ErrorEvaluator::new(&cell, &cell.operations[0]);
        let mut memory = evaluator.memory();
        let posture = chain.posture(&[0.3, 0.2, 0.1, -0.4, 0.0, 0.0, 0.0, 0.0]);
        chain.place(&posture, &mut frames);
        c.bench_function(&format!("posture, nonlinear {}", reading.name()), |b| {
            b.iter(|| evaluator.value(&situation, black_box(&frames), &mut memory))
        });
        c.bench_function(&format!("posture, everything, {}", reading.name()), |b| {
            b.iter(|| evaluator.judge(&situation, black_box(&frames), &mut memory))
        });
    }
}

fn map(c: &mut Criterion) {
    let workcell = Workcell::new(shipped("hitachi_paper.toml")).expect("the paper's cell");
    let layout = workcell.cell.start();
    c.bench_function("map: 99 nodes, every branch, both models", |b| {
        b.iter(|| workcell.maps(black_box(&layout)))
    });
}

fn collision(c: &mut Criterion) {
    let mut cell = shipped("hitachi_ideal.toml");
    let chain = Chain::new(&cell.robot);
    for (what, itself) in [("work C", false), ("work C and the robot against itself", true)] {
        cell.robot.self_collision.checked = itself;
        let (scene, mut placed) = (Scene::new(&cell), PlacedSolids::default());
        scene.place(&layouts(&cell)[0], &mut placed);
        for set in ["q", "qtask"] {
            let postures: Vec<_> = data(&format!("c_pw10_{set}.bin"))
                .chunks_exact(4)
                .map(|q| chain.posture(&std::array::from_fn(|i| q.get(i).copied().unwrap_or(0.0))))
                .collect();
            let mut next = postures.iter().cycle();
            c.bench_function(&format!("collision: one configuration of {set}, {what}"), |b| {
                b.iter(|| {
                    let frames = chain.frames(next.next().expect("a cycle"));
                    scene.hit(&placed, &frames.links, None)
                })
            });
        }
    }
}

/// Measures `evaluate` on 1000 layouts per iteration, so that the order of the layouts does not matter.
///
/// The cases without collision checks measure inverse kinematics, limits and errors. The "judged" case also
/// switches off the ranking of nodes by their lower bounds. Every node is then judged: its error is computed.
fn evaluate(c: &mut Criterion) {
    let ready = |collision: bool, times: usize| {
        let mut cell = shipped("hitachi_ideal.toml");
        cell.collision = collision;
        // The grids have 99 and 63 nodes, or ten times as many.
        let grids = if times == 1 { [(10, 8), (20, 2)] } else { [(32, 29), (69, 8)] };
        for (operation, grid) in cell.operations.iter_mut().zip(grids) {
            if let Place::Grid { divisions, .. } = &mut operation.place {
                *divisions = grid;
            }
        }
        Workcell::new(cell).expect("the cell")
    };
    let cases = [
        ("evaluate", ready(true, 1)),
        ("evaluate without collision", ready(false, 1)),
        ("evaluate without collision, judged", ready(false, 1).unranked()),
        ("evaluate, 10 times the nodes", ready(true, 10)),
        ("evaluate without collision, 10 times the nodes", ready(false, 10)),
    ];
    for (what, workcell) in cases {
        let layouts = layouts(&workcell.cell);
        let mut workspace = Workspace::default();
        for (name, set) in [("random", &layouts[..1000]), ("plausible", &layouts[1000..])] {
            c.bench_function(&format!("{what}: 1000 {name} layouts"), |b| {
                b.iter(|| set.iter().map(|l| evaluate_in(&workcell, l, &mut workspace).cost).sum::<f64>())
            });
        }
    }
}

/// Measures `evaluate` on the plausible layouts with one thread and with two threads. A thread takes at least
/// 50 layouts at a time.
fn threads(c: &mut Criterion) {
    let workcell = Workcell::new(shipped("hitachi_ideal.toml")).expect("the cell");
    let layouts = &layouts(&workcell.cell)[1000..];
    for count in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads");
        c.bench_function(&format!("evaluate: 1000 plausible layouts, threads: {count}"), |b| {
            let cost = |workspace: &mut Workspace, l: &Layout| evaluate_in(&workcell, l, workspace).cost;
            let all = || layouts.par_iter().with_min_len(50).map_init(Workspace::default, cost);
            b.iter(|| pool.install(|| all().collect::<Vec<f64>>()))
        });
    }
}

/// Measures the work per layout that precedes the evaluation of the nodes: placing the solids, and checking
/// the floor spaces for overlaps.
fn layout(c: &mut Criterion) {
    let cell = shipped("hitachi_ideal.toml");
    let layouts = layouts(&cell);
    let (scene, plan) = (Scene::new(&cell), FloorPlan::new(&cell));
    let (mut placed, mut found) = (PlacedSolids::default(), Vec::new());
    c.bench_function("solids posed: 2000 layouts", |b| {
        b.iter(|| layouts.iter().for_each(|l| scene.place(black_box(l), &mut placed)))
    });
    c.bench_function("floor space: 2000 layouts", |b| {
        b.iter(|| layouts.iter().for_each(|l| plan.overlaps(black_box(l), &mut found)))
    });
}

criterion_group! {
    name = layers;
    config = Criterion::default().sample_size(20);
    targets = node, readings, map, collision, layout, evaluate, threads
}
criterion_main!(layers);
