//! The lower bound of the objective against brute force, known optima and random layouts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::shipped;
use std::sync::atomic::AtomicBool;
use sweetspot::layout::Workcell;
use sweetspot::search::bound::{Covers, Proof, ProofOptions, prove};
use sweetspot::units::mm_from_m;

fn proof(workcell: &Workcell, options: &ProofOptions) -> Proof {
    prove(workcell, options, &AtomicBool::new(false))
}

/// Brute force and search agree on it: tests/bound.rs.
const HITACHI_MM: f64 = 20.429670;

#[test]
fn hitachi_cell_is_closed() {
    let workcell = Workcell::new(shipped("hitachi_cell.toml")).unwrap();
    let proof = proof(&workcell, &ProofOptions::default());
    let bound = mm_from_m(proof.bound.unwrap());
    println!("{proof:?}");
    assert!(bound <= HITACHI_MM && bound >= HITACHI_MM - 0.02, "{bound}");
    assert_eq!(proof.covers, Covers::Everything);
}

#[test]
#[ignore = "a table for people: cargo test --release --test proof -- --ignored --nocapture table"]
fn table_of_all_cells() {
    for name in [
        "hitachi_cell",
        "hitachi_urdf",
        "hitachi_paper",
        "hitachi_paper_parallelogram",
        "palletizer_cell",
        "scara_cell",
        "five_axis_cell",
        "wrist_cell",
        "ur_cell",
        "offset_wrist_cell",
        "panda_cell",
        "track_cell",
    ] {
        let workcell = Workcell::new(shipped(&format!("{name}.toml"))).unwrap();
        let start = std::time::Instant::now();
        let proof = proof(&workcell, &ProofOptions::default());
        let time = start.elapsed();
        println!("{name:28} {time:9.1?} bound {:?} mm", proof.bound.map(mm_from_m));
        for o in &proof.operations {
            println!(
                "    {:?} boxes {} witness {:?}",
                o.value.map(mm_from_m),
                o.boxes,
                o.witness.map(|w| mm_from_m(w.0))
            );
        }
    }
}
