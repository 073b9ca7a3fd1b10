//! Numeric inverse kinematics of the robots PUMA 560 and UR5, at 1000 poses each (tests/data).
//!
//! If one iteration solves several poses, the name of the benchmark states their number.

#![allow(clippy::expect_used, clippy::print_stderr)] // without its data, a benchmark has nothing to measure

use criterion::{Criterion, criterion_group, criterion_main};
use nalgebra::Matrix4;
use std::hint::black_box;
use sweetspot::files;
use sweetspot::reach::{AttitudeGoal, Numeric, TcpGoal};
use sweetspot::robot::Chain;

fn file(name: &str) -> Vec<u8> {
    let folder = std::path::PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join("tests/data");
    std::fs::read(folder.join(name)).expect("reference data")
}

fn chain(name: &str) -> Chain {
    let text = String::from_utf8(file(&format!("{name}.toml"))).expect("text");
    let loaded = files::load("cell.toml", &mut |_: &str| Ok(text.clone().into_bytes())).expect("a robot");
    Chain::new(&loaded.cell.robot)
}

fn goals(name: &str) -> Vec<TcpGoal> {
    let values: Vec<f64> = file(&format!("b_{name}_T.bin"))
        .chunks_exact(8)
        .map(|c| f64::from_le_bytes(c.try_into().expect("8 bytes")))
        .collect();
    let goal = |t: &[f64]| {
        let t = Matrix4::from_row_slice(t);
        let rotation = t.fixed_view::<3, 3>(0, 0).into_owned();
        TcpGoal {
            position: t.fixed_view::<3, 1>(0, 3).into_owned(),
            attitude: AttitudeGoal::Rotation(rotation),
        }
    };
    values.chunks_exact(16).map(goal).collect()
}

fn numeric(c: &mut Criterion) {
    for name in ["puma560", "ur5"] {
        let (chain, goals) = (chain(name), goals(name));
        let solver = Numeric::new(&chain);
        let solved = goals.iter().filter(|goal| solver.one(goal).is_some()).count();
        eprintln!("{name}: {solved} of {} solved", goals.len());
        c.bench_function(&format!("{name}: solver made ready"), |b| {
            b.iter(|| Numeric::new(black_box(&chain)))
        });
        c.bench_function(&format!("{name}: one solution of 1000 poses"), |b| {
            b.iter(|| goals.iter().filter_map(|goal| solver.one(black_box(goal))).count())
        });
        let mut out = Vec::new();
        c.bench_function(&format!("{name}: all solutions of 100 poses"), |b| {
            b.iter(|| {
                goals[..100].iter().for_each(|goal| {
                    solver.all(black_box(goal), &mut out);
                })
            })
        });
        let far = TcpGoal { position: goals[0].position * 5.0, ..goals[0] };
        c.bench_function(&format!("{name}: a reason, out of reach"), |b| {
            b.iter(|| solver.all(black_box(&far), &mut out))
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = numeric
}
criterion_main!(benches);
