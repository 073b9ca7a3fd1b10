//! Check of all combinations of a sweep before the first one is processed.

use super::threads::pool;
use crate::cli::commands::UNSOLVED;
use crate::cli::loading::FileSnapshot;
use crate::cli::output::path_word;
use crate::cli::sweep::{add_inputs, load};
use crate::cli::{Exit, cache, loading, output};
use crate::files::{Fault, Source, shown};
use crate::layout::Workcell;
use crate::record::SweepPlan;
use rayon::prelude::*;

/// Reads and checks every combination, and reports every fault once.
pub fn check_all(plan: &mut SweepPlan, kept: &FileSnapshot, jobs: usize) -> Result<Vec<Source>, Exit> {
    let check = |index: usize| -> Result<(Vec<Source>, Vec<Fault>), Vec<Fault>> {
        let loaded = load(plan, index, kept)?;
        match Workcell::remembering(loaded.cell, &mut cache::remember) {
            Ok(_) => Ok((loaded.sources, loaded.warnings)),
            Err(why) => Err(vec![Fault::of_file(&path_word(&plan.cell), why, UNSOLVED)]),
        }
    };
    let checked: Vec<_> = pool(jobs)?.install(|| (0..plan.combinations).into_par_iter().map(check).collect());
    let (mut all, mut told) = (Vec::new(), Vec::new());
    for (index, result) in checked.into_iter().enumerate() {
        let faults = match result {
            Ok((sources, warnings)) => {
                add_inputs(plan, &mut all, sources);
                warnings
            }
            Err(faults) => faults,
        };
        for fault in faults {
            match told.iter_mut().find(|(known, ..): &&mut (Fault, usize, usize)| *known == fault) {
                Some((.., count)) => *count += 1,
                None => told.push((fault, index, 1)),
            }
        }
    }
    let faults: Vec<Fault> = told.into_iter().map(|t| whose(plan, t)).collect();
    output::faults(&faults);
    if faults.iter().any(Fault::is_error) { Err(loading::exit_of(&faults)) } else { Ok(all) }
}

/// Appends the number of combinations with a fault, and the settings of the first such combination, to the
/// help text of the fault. Adds nothing if every combination has the fault. Also adds nothing if the fault
/// lies in a `--set` value and every combination with that value has the fault.
fn whose(plan: &SweepPlan, (fault, first, count): (Fault, usize, usize)) -> Fault {
    let settings = plan.settings(first);
    let own = settings.iter().position(|s| fault.file == format!("--set {}", s.words()));
    if count * own.map_or(1, |k| plan.sets[k].values.len()) == plan.combinations {
        return fault;
    }
    let words: Vec<_> = settings.iter().map(|s| shown(&s.words())).collect();
    let those = format!("in {count} of {} combinations, first with {}", plan.combinations, words.join(" "));
    let help = if fault.help.is_empty() { those } else { format!("{} ({those})", fault.help) };
    Fault { help, ..fault }
}
