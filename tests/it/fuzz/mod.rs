//! Fuzzing of every parser in the test process, with damaged and hostile inputs from seeded mutation of a
//! corpus.
//!
//! An input must never cause a panic, take longer than [`LONGEST`] or allocate more than [`MOST_BYTES`].
//! Everything that a parser accepts must fulfil the checks of its target. Inputs with a new kind of answer
//! join the corpus of the run. The same seed and number give the same inputs. SWEETSPOT_FUZZ_INPUTS sets the
//! number of inputs per parser, and SWEETSPOT_FUZZ_SEED sets the seed. An input that fails is written to a
//! file, which the message names. A stack overflow ends the process, so SWEETSPOT_FUZZ_KEEP can name a file
//! to which each input is written before it is tried.

mod corpus;
mod mutation;
mod targets;

pub use corpus::{OBJ, STL};

use allocation_counter::measure;
use mutation::Mutator;
use std::any::Any;
use std::collections::HashSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};
use targets::Target;

/// Largest processor time that one input may take.
const LONGEST: Duration = Duration::from_secs(1);

/// Time after which an input counts as an endless loop, and the test gives up.
const ENDLESS: Duration = Duration::from_secs(60);

/// Largest memory that one input may use at a time, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Largest number of inputs of a run that join its corpus.
const MAX_KEPT: usize = 3_000;

/// Figures of a run.
#[derive(Default)]
struct Run {
    accepted: usize,
    kinds: usize,
    slowest: Duration,
    bytes: u64,
}

/// Returns the number in an environment variable, or the default.
fn setting(name: &str, default: usize) -> usize {
    match std::env::var(name) {
        Ok(word) => word.parse().unwrap_or_else(|_| panic!("{name} is {word:?}: set it to a whole number")),
        Err(_) => default,
    }
}

/// Fuzzes a parser with `default` inputs. All parsers together take about a minute of processor time.
fn fuzz(make: fn() -> Target, default: usize) {
    let (inputs, seed) = (setting("SWEETSPOT_FUZZ_INPUTS", default), setting("SWEETSPOT_FUZZ_SEED", 14));
    let done = Arc::new(AtomicUsize::new(0));
    let count = done.clone();
    let start = Instant::now();
    let worker = std::thread::spawn(move || run(&make(), inputs, seed as u64, &count));
    let (mut last, mut since) = (0, Instant::now());
    while !worker.is_finished() {
        std::thread::sleep(Duration::from_millis(20));
        let now = done.load(Relaxed);
        if now != last {
            (last, since) = (now, Instant::now());
        }
        assert!(since.elapsed() < ENDLESS, "input {last} of seed {seed} takes more than {ENDLESS:?}");
    }
    let (name, Run { accepted, kinds, slowest, bytes }) = match worker.join() {
        Ok(run) => run,
        Err(panic) => std::panic::resume_unwind(panic),
    };
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "| {name} | {inputs} | {accepted} | {kinds} | {:.0} | {:.1} | {:.2} |",
        inputs as f64 / seconds,
        slowest.as_secs_f64() * 1e3,
        bytes as f64 / f64::from(1 << 20)
    );
    assert!(accepted > 0 && accepted < inputs, "{name}: {accepted} of {inputs} are accepted");
}

fn run(target: &Target, inputs: usize, seed: u64, count: &AtomicUsize) -> (&'static str, Run) {
    let mut mutator = Mutator::new(&target.seeds, &target.words, seed);
    let (mut run, mut known) = (Run::default(), HashSet::new());
    let keep = std::env::var_os("SWEETSPOT_FUZZ_KEEP");
    for number in 0..inputs {
        // Each seed is tried unchanged first.
        let input = target.seeds.get(number).cloned().unwrap_or_else(|| mutator.next_input());
        if let Some(path) = &keep {
            std::fs::write(path, &input).unwrap();
        }
        let answer = tried(target, &input, number, &mut run);
        run.accepted += usize::from(answer.is_ok());
        if known.insert(kind_of(&answer)) && number >= target.seeds.len() && known.len() < MAX_KEPT {
            mutator.keep(input);
        }
        count.store(number + 1, Relaxed);
    }
    run.kinds = known.len();
    (target.name, run)
}

/// Gives one input to the parser and returns the answer. Fails if the input needs too much time or memory, or
/// causes a panic.
fn tried(target: &Target, input: &[u8], number: usize, run: &mut Run) -> Result<(), String> {
    let start = time_of_thread();
    let mut ended = None;
    let used = measure(|| ended = Some(catch_unwind(AssertUnwindSafe(|| (target.parse)(input)))));
    let took = time_of_thread().saturating_sub(start);
    let answer = match ended {
        Some(Ok(answer)) => answer,
        Some(Err(panic)) => fail(target, input, number, &format!("it panics: {}", words_of(&*panic))),
        None => fail(target, input, number, "it was not tried"),
    };
    if used.bytes_max > MOST_BYTES {
        fail(target, input, number, &format!("it takes {} bytes", used.bytes_max));
    }
    if took > LONGEST {
        fail(target, input, number, &format!("it takes {took:?}"));
    }
    run.bytes = run.bytes.max(used.bytes_max);
    run.slowest = run.slowest.max(took);
    answer
}

/// Returns the processor time of this thread, which does not depend on the load of the machine. If the system
/// does not provide it, returns the time since the first call.
fn time_of_thread() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| START.elapsed(), Duration::from_nanos)
}

/// Returns the message of a panic.
fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("no message").to_string()
}

/// Writes an input to a file and ends the test.
fn fail(target: &Target, input: &[u8], number: usize, why: &str) -> ! {
    let path: PathBuf = std::env::temp_dir().join(format!("sweetspot-fuzz-{}-{number}", target.name));
    std::fs::write(&path, input).unwrap();
    panic!("{}: input {number}, kept as {}: {why}", target.name, path.display());
}

/// Returns the kind of an answer: its text without numbers and quoted words.
fn kind_of(answer: &Result<(), String>) -> String {
    let Err(why) = answer else { return String::new() };
    let mut parts = why.split(['`', '"']).step_by(2).collect::<Vec<_>>().join("\u{1}");
    parts.retain(|c| !c.is_ascii_digit());
    parts
}

#[test]
fn cells() {
    fuzz(targets::cell, 1_500);
}

#[test]
fn robots() {
    fuzz(targets::robot, 2_400);
}

#[test]
fn equipment() {
    fuzz(targets::equipment, 2_400);
}

#[test]
fn urdfs() {
    fuzz(targets::urdf, 6_000);
}

#[test]
fn stl_meshes() {
    fuzz(targets::stl, 30_000);
}

#[test]
fn obj_meshes() {
    fuzz(targets::obj, 30_000);
}

#[test]
fn floor_plans() {
    fuzz(targets::dxf, 3_000);
}

#[test]
fn checkpoints() {
    fuzz(targets::checkpoint, 9_000);
}

#[test]
fn manifests() {
    fuzz(targets::manifest, 18_000);
}

#[test]
fn plans_and_rows_of_sweeps() {
    fuzz(targets::sweep, 18_000);
}

#[test]
fn search_results() {
    fuzz(targets::search_result, 6_000);
}

#[test]
fn tables_of_measured_positions() {
    fuzz(targets::measured_table, 6_000);
}

#[test]
fn stated_calibrations() {
    fuzz(targets::stated_calibration, 12_000);
}

#[test]
fn settings() {
    fuzz(targets::settings, 4_800);
}

#[cfg(feature = "view")]
#[test]
fn layouts_of_the_page() {
    fuzz(targets::page_layout, 18_000);
}
