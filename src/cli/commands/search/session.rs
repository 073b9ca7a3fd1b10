//! Set-up of every search: the thread pool and the proof of a lower bound.

use crate::cli::{Exit, output};
use crate::layout::Workcell;
use crate::proof::{Proof, ProofOptions, prove};
use std::sync::atomic::AtomicBool;

/// Starts a pool of threads, one per core if no number is given.
pub fn threads(count: Option<u16>) -> Result<rayon::ThreadPool, Exit> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count.map_or(0, usize::from)).build();
    pool.map_err(|e| {
        output::error(&format!("cannot start threads: {e}"));
        Exit::Io
    })
}

/// Proves a lower bound of the objective that holds for every layout of the cell.
pub fn proven(workcell: &Workcell) -> Proof {
    // Ctrl-C does not interrupt the proof, because a resumed search needs the same bound. A limit on the
    // number of boxes in the proof limits the duration of the proof.
    let proof = prove(workcell, &ProofOptions::default(), &AtomicBool::new(false));
    let settings = &workcell.cell.search;
    match settings.gap {
        Some(_) if !settings.pareto.is_empty() => {
            output::talk("note: --gap is ignored: a Pareto search has no single bound");
        }
        Some(_) if proof.bound.is_none() => {
            output::talk(&format!("note: --gap is ignored: {}", proof.in_words(workcell)));
        }
        _ => {}
    }
    proof
}
