//! Figures of results/measured, from the tracker data of a real UR10: `cargo bench --bench measured [-- STUDY
//! ...]`.
//!
//! | study | question |
//! |---|---|
//! | `transfer` | How well does one series predict the others? |
//! | `terms` | How do elastic terms, harmonics and priors change the errors? |
//! | `pooled` | How large are the errors after a fit to all four series? |
//! | `rank` | Does the error map find the accurate spots? |
//! | `plan` | Are chosen poses more informative than random poses? |
//! | `simulated` | How large is the coverage for arms that follow the assumptions of the fit exactly? |
//! | `speed` | How long does a fit take? |
//!
//! Poses are drawn at random with the seeds 1 to 20, or 1 to 5 if a fit is slow. Medians over the seeds
//! are printed.

#![allow(clippy::expect_used, clippy::print_stdout)] // without the data there is nothing to measure

use flate2::read::GzDecoder;
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use std::time::Instant;
use sweetspot::calibration::{
    Calibration, Deformed, IntendedCalibration, MeasuredPosition, MeasuringSession, PlanProblem, Unknown,
    UnmodelledError, aligned, calibrate, drawn, explain, harmonics, unknowns,
};
use sweetspot::files;
use sweetspot::robot::Chain;

const SEEDS: std::ops::RangeInclusive<u64> = 1..=20;
/// Seeds of the studies whose fits are slow.
const FEW_SEEDS: std::ops::RangeInclusive<u64> = 1..=5;
const SERIES: [&str; 4] = ["A", "B", "C", "D"];
/// Least number of poses of a spot. Spots with fewer poses are left out.
const POSES_OF_SPOT: usize = 10;

/// Rule of thumb that ranks spots: a function of the commanded position (base frame, m). A small value
/// predicts a small error.
type Rule<'a> = &'a dyn Fn(&Vector3<f64>) -> f64;
/// Function that prints the figures of one study.
type Study = fn(&Data);

/// Arm and its four series of measured positions.
struct Data {
    chain: Chain,
    series: Vec<Vec<MeasuredPosition>>,
    /// Spot of every pose of series A: the commanded position of the pose, rounded to multiples of 0.1 m. The
    /// unit is 0.1 m.
    spots: Vec<[i64; 3]>,
}

fn text_of(series: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../tests/data/ipa_ur10/{series}.csv.gz"));
    let packed = std::fs::read(path).expect("the data of the UR10");
    let mut text = String::new();
    GzDecoder::new(&packed[..]).read_to_string(&mut text).expect("text");
    text
}

impl Data {
    fn new() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cells/robots");
        let read = &mut |path: &str| std::fs::read(folder.join(path)).map_err(|e| e.to_string());
        let robot = files::load_robot("ur10.toml", read).expect("the robot file").robot;
        let chain = Chain::new(&robot);
        let joints: Vec<_> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
        let table = |series: &&str| {
            let table = files::measured::read(series, &text_of(series), &joints, &[], None).expect("a table");
            let reading = explain(&chain, &table.rows, robot.reach()).expect("a reading");
            table.rows.iter().map(|raw| reading.applied(&chain, raw)).collect()
        };
        let series = SERIES.iter().map(table).collect();
        let a = text_of("A");
        let spots = a.lines().skip(1).filter(|line| !line.trim().is_empty()).map(|line| {
            let mut fields =
                line.split(';').skip(1).map(|f| f.replace(',', ".").parse::<f64>().expect("a number"));
            std::array::from_fn(|_| (fields.next().expect("a coordinate") * 10.0).round_ties_even() as i64)
        });
        Self { spots: spots.collect(), series, chain }
    }

    fn calibrated(&self, sessions: &[(usize, usize)], seed: u64, terms: Terms) -> Calibration {
        let session = |&(series, count): &(usize, usize)| MeasuringSession {
            name: SERIES[series].into(),
            measured: drawn(&self.series[series], count, seed),
        };
        self.fitted(&sessions.iter().map(session).collect::<Vec<_>>(), terms)
    }

    /// Returns the unknowns of a fit and their prior standard deviations.
    fn unknowns(&self, terms: Terms) -> (Vec<Unknown>, Vec<f64>) {
        let mut unknowns = unknowns(&self.chain, terms.is_elastic);
        let mut priors: Vec<_> =
            unknowns.iter().map(|u: &Unknown| u.default_prior(&self.chain) * terms.prior_factor).collect();
        if terms.orders > 0 {
            unknowns.extend(harmonics(&self.chain, terms.orders));
            priors.extend(unknowns[priors.len()..].iter().map(|u| u.default_prior(&self.chain)));
        }
        (unknowns, priors)
    }

    fn fitted(&self, sessions: &[MeasuringSession], terms: Terms) -> Calibration {
        let (unknowns, priors) = self.unknowns(terms);
        calibrate(&self.chain, sessions, &unknowns, &priors).expect("a calibration")
    }

    /// Prints the medians of two figures over all calibrations `results`, for every series except `without`.
    /// The figures are the mean error of the predictions, mm, and the share of positions inside the 95 %
    /// ellipsoids, percent. The least and the greatest share of all results follow in parentheses.
    fn print_tests(&self, results: &[Calibration], without: Option<usize>) {
        for (other, name) in SERIES.iter().enumerate().filter(|(other, _)| Some(*other) != without) {
            let tested = results.iter().map(|r| r.tested(&self.series[other]).expect("a test"));
            let (means, shares): (Vec<_>, Vec<_>) =
                tested.map(|(t, share)| (mean(&t.distances) * 1e3, share * 100.0)).unzip();
            let (least, most) = (quantile(&shares, 0.0), quantile(&shares, 1.0));
            print!("  {name}: {:.3} | {:.1} ({least:.1}-{most:.1})", median(&means), median(&shares));
        }
        println!();
    }

    /// Returns the mean of `errors` at every spot of series A with enough poses. `errors` has one value
    /// for each pose of the series.
    fn of_spots(&self, errors: &[f64]) -> Vec<f64> {
        let mut sums: BTreeMap<[i64; 3], (f64, usize)> = BTreeMap::new();
        for (spot, error) in self.spots.iter().zip(errors) {
            let sum = sums.entry(*spot).or_default();
            *sum = (sum.0 + error, sum.1 + 1);
        }
        sums.values()
            .filter(|(_, count)| *count >= POSES_OF_SPOT)
            .map(|(sum, count)| sum / *count as f64)
            .collect()
    }

    /// Returns the position errors of the nominal arm, mm, at the postures of series A. `positions` replaces
    /// the measured positions of the series (frame of the instrument, m). Base and reflectors are fitted to
    /// `positions`.
    fn nominal_errors(&self, positions: impl Iterator<Item = Vector3<f64>>) -> Vec<f64> {
        let a = &self.series[0];
        let measured: Vec<_> =
            a.iter().zip(positions).map(|(m, position)| MeasuredPosition { position, ..*m }).collect();
        let poses: Vec<_> = a.iter().map(|m| Deformed::new(&self.chain, &m.joints, &[], &[])).collect();
        let frames = aligned(&poses, &measured).expect("a base");
        poses.iter().zip(&measured).map(|(p, m)| frames.residual(&p.interface, m).norm() * 1e3).collect()
    }
}

/// Parameters that a fit identifies in addition to the base and the reflectors.
#[derive(Clone, Copy)]
struct Terms {
    name: &'static str,
    is_elastic: bool,
    /// Largest order of the harmonics; 0 for no harmonics.
    orders: usize,
    /// Factor by which the prior standard deviations of all unknowns except harmonics are multiplied.
    prior_factor: f64,
}

const ROWS: Terms = Terms { name: "Rows", is_elastic: false, orders: 0, prior_factor: 1.0 };
const ELASTIC: Terms = Terms { name: "Elastic", is_elastic: true, ..ROWS };
const HARMONICS: Terms = Terms { name: "Harmonics 32", orders: 32, ..ELASTIC };
/// Choices of parameters that the study `terms` compares.
const CHOICES: [Terms; 7] = [
    ROWS,
    ELASTIC,
    Terms { name: "Harmonics 2", orders: 2, ..ELASTIC },
    Terms { name: "Harmonics 8", orders: 8, ..ELASTIC },
    HARMONICS,
    Terms { name: "Elastic, prior / 3", prior_factor: 1.0 / 3.0, ..ELASTIC },
    Terms { name: "Elastic, prior x 3", prior_factor: 3.0, ..ELASTIC },
];

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let (low, high) = (place.floor() as usize, place.ceil() as usize);
    (sorted[low] + sorted[high]) / 2.0
}

fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Prints how well a calibration with some poses of one series predicts the other series.
fn transfer(data: &Data) {
    println!("\ntransfer: mean error in mm | share in the 95 % ellipsoid in %, least to largest");
    for terms in [ROWS, ELASTIC] {
        for (series, count) in [(2, 300), (2, 50), (1, 300), (1, 50), (0, 300), (0, 50), (3, 300), (3, 50)] {
            print!("{:<22}", format!("{count} of {} {}", SERIES[series], terms.name));
            let results: Vec<_> =
                SEEDS.map(|seed| data.calibrated(&[(series, count)], seed, terms)).collect();
            data.print_tests(&results, Some(series));
        }
    }
    for (series, count) in [2, 1, 0, 3].into_iter().flat_map(|series| [(series, 300), (series, 50)]) {
        print!("{:<22}", format!("{count} of {} {}", SERIES[series], HARMONICS.name));
        let results: Vec<_> =
            SEEDS.map(|seed| data.calibrated(&[(series, count)], seed, HARMONICS)).collect();
        data.print_tests(&results, Some(series));
    }
}

/// Prints how elastic terms, harmonics and priors change the errors of calibrations with poses of series C.
fn terms(data: &Data) {
    println!("\nterms: mean error in mm | share in the 95 % ellipsoid in %, 5 draws");
    for count in [300, 50] {
        for terms in CHOICES {
            print!("{:<26}", format!("{count} of C {}", terms.name));
            let results: Vec<_> = FEW_SEEDS.map(|seed| data.calibrated(&[(2, count)], seed, terms)).collect();
            data.print_tests(&results, Some(2));
        }
    }
}

/// Prints the errors after a calibration with 300 poses of each series.
fn pooled(data: &Data) {
    println!("\npooled: 300 poses of each series, mean error in mm | share in the 95 % ellipsoid in %");
    for terms in [ROWS, ELASTIC, HARMONICS] {
        let all = [(0, 300), (1, 300), (2, 300), (3, 300)];
        print!("{:<13}", terms.name);
        let results: Vec<_> = FEW_SEEDS.map(|seed| data.calibrated(&all, seed, terms)).collect();
        data.print_tests(&results, None);
    }
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    order.iter().enumerate().for_each(|(rank, &i)| ranks[i] = rank as f64);
    ranks
}

/// Returns Spearman's rank correlation.
fn spearman(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let (ma, mb) = (mean(&a), mean(&b));
    let sum = |f: &dyn Fn(f64, f64) -> f64| a.iter().zip(&b).map(|(x, y)| f(x - ma, y - mb)).sum::<f64>();
    sum(&|x, y| x * y) / (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt()
}

/// Prints how well predicted errors put the spots of series A in the order of their measured errors.
/// The predictions come from calibrations with poses of series B, and from rules of thumb.
fn rank(data: &Data) {
    let measured = data.of_spots(&data.nominal_errors(data.series[0].iter().map(|m| m.position)));
    let (least, most) = (quantile(&measured, 0.0), quantile(&measured, 1.0));
    println!(
        "\nrank: {} spots of series A, measured error {:.3} mm in the mean, {least:.3} to {most:.3} mm",
        measured.len(),
        mean(&measured)
    );
    let judged = |predicted: &[f64]| {
        let best =
            (0..predicted.len()).min_by(|&a, &b| predicted[a].total_cmp(&predicted[b])).expect("a spot");
        (spearman(predicted, &measured), measured[best])
    };
    let counts = [30, 50, 100, 300].into_iter();
    let plain = [ROWS, ELASTIC].into_iter().flat_map(|terms| counts.clone().map(move |c| (terms, c, SEEDS)));
    for (terms, count, seeds) in plain.chain([(HARMONICS, 50, SEEDS), (HARMONICS, 300, SEEDS)]) {
        let one = |seed: u64| {
            let result = data.calibrated(&[(1, count)], seed, terms);
            let (fitted, _) = result.tested(&data.series[0]).expect("a test");
            let positions = data.series[0].iter().map(|m| {
                fitted.frames.base.transform(&fitted.frames.reached(&result.deformed(&m.joints).interface, 0))
            });
            judged(&data.of_spots(&data.nominal_errors(positions)))
        };
        let (correlations, spots): (Vec<_>, Vec<_>) = seeds.map(one).unzip();
        println!(
            "{:<23} Spearman {:.3} (least {:.3}); spot predicted best: {:.3} mm, at most 0.25 mm in {} of {}",
            format!("{count} of B {}", terms.name),
            median(&correlations),
            quantile(&correlations, 0.0),
            median(&spots),
            spots.iter().filter(|s| **s <= 0.25).count(),
            spots.len()
        );
    }
    let commanded = |f: &dyn Fn(&Vector3<f64>) -> f64| {
        let poses = data.series[0].iter();
        let errors: Vec<_> = poses
            .map(|m| f(&Deformed::new(&data.chain, &m.joints, &[], &[]).interface.translation))
            .collect();
        judged(&data.of_spots(&errors))
    };
    let shoulder = Vector3::new(0.0, 0.0, 0.1273);
    let rules: [(&str, Rule<'_>); 3] = [
        ("radius", &|p| p.xy().norm()),
        ("distance from the shoulder", &|p| (p - shoulder).norm()),
        ("height", &|p| p.z),
    ];
    for (name, rule) in rules {
        let (correlation, spot) = commanded(rule);
        println!("rule of thumb: {name:<28} Spearman {correlation:.3}; spot {spot:.3} mm");
    }
}

/// Prints the errors on the other series after a calibration with chosen poses of series C, and after
/// calibrations with as many random poses.
fn plan(data: &Data) {
    println!("\nplan: poses of series C, mean error in mm on A, B and D");
    let others = [0, 1, 3];
    let judged = |result: &Calibration| {
        others.map(|other| mean(&result.tested(&data.series[other]).expect("a test").0.distances) * 1e3)
    };
    let unknowns = unknowns(&data.chain, true);
    let priors: Vec<_> = unknowns.iter().map(|u: &Unknown| u.default_prior(&data.chain)).collect();
    let intended = IntendedCalibration {
        chain: &data.chain,
        unknowns: &unknowns,
        priors: &priors,
        reflector: data.chain.tool.translation,
        error: UnmodelledError::default(),
    };
    let candidates: Vec<_> = data.series[2].iter().map(|m| m.joints).collect();
    let problem = PlanProblem::new(&intended, &candidates, &candidates);
    for count in [30, 50] {
        let chosen = problem.best(count, &mut |_, _| ()).expect("a plan");
        let measured = chosen.into_iter().map(|i| data.series[2][i]).collect();
        let planned = judged(&data.fitted(&[MeasuringSession { name: "C".into(), measured }], ELASTIC));
        let random: Vec<_> =
            SEEDS.map(|seed| judged(&data.calibrated(&[(2, count)], seed, ELASTIC))).collect();
        let random = [0, 1, 2].map(|k| median(&random.iter().map(|r| r[k]).collect::<Vec<_>>()));
        println!("{count} poses: plan {planned:.3?}, median of 20 random draws {random:.3?}");
    }
}

/// Number of simulated arms.
const ARMS: u64 = 40;
/// Number of draws of poses for each simulated arm. The coverage of an arm is the median over its draws.
const DRAWS: u64 = 3;
/// Standard deviation of the independent errors of a simulated position per axis, m. The positions of the
/// real arm differ by about as much from a fit to all four series.
const SIMULATED_NOISE: f64 = 6e-5;
/// Largest number of positions of a simulated series.
const POSES_OF_SIMULATED_SERIES: usize = 1000;
/// Coverages that the goal allows, percent.
const ALLOWED: std::ops::RangeInclusive<f64> = 93.0..=97.0;

/// Returns a number drawn from the standard normal distribution (Box and Muller, 1958).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}

impl Data {
    /// Returns an arm at the postures of the real series. Its errors are drawn from the distributions that a
    /// fit with `terms` assumes: rows, elastic terms, harmonics and independent errors of the positions.
    fn simulated(&self, terms: Terms, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (unknowns, priors) = self.unknowns(terms);
        let truth: Vec<_> = priors.iter().map(|prior| prior * normal(&mut rng)).collect();
        let mut measured = |m: &MeasuredPosition| {
            let interface = Deformed::new(&self.chain, &m.joints, &unknowns, &truth).interface;
            let noise = Vector3::from_fn(|_, _| SIMULATED_NOISE * normal(&mut rng));
            let position = interface.transform(&self.chain.tool.translation) + noise;
            MeasuredPosition { position, sigma: None, ..*m }
        };
        let series = self
            .series
            .iter()
            .map(|series| drawn(series, POSES_OF_SIMULATED_SERIES, seed).iter().map(&mut measured).collect());
        Self { series: series.collect(), chain: self.chain.clone(), spots: self.spots.clone() }
    }

    /// Returns the share (percent) of positions inside the 95 % ellipsoids, for every series except `from`.
    /// The calibration uses `count` positions of the series `from`.
    fn coverage(&self, from: usize, count: usize, terms: Terms) -> Vec<f64> {
        let results: Vec<_> =
            (1..=DRAWS).map(|seed| self.calibrated(&[(from, count)], seed, terms)).collect();
        let others = (0..SERIES.len()).filter(|other| *other != from);
        let share = |result: &Calibration, other: usize| {
            result.tested(&self.series[other]).expect("a test").1 * 100.0
        };
        others.map(|other| median(&results.iter().map(|r| share(r, other)).collect::<Vec<_>>())).collect()
    }
}

/// Prints the coverage for simulated arms whose errors have exactly the distributions that the fit assumes.
fn simulated(data: &Data) {
    println!(
        "\nsimulated: share in the 95 % ellipsoid in %, median of {ARMS} arms (5 % to 95 % quantile), share \
         of arms with {} to {} %",
        ALLOWED.start(),
        ALLOWED.end()
    );
    for count in [300, 50] {
        let of_arm = |arm: u64| -> Vec<Vec<f64>> {
            let simulated = data.simulated(HARMONICS, arm);
            (0..SERIES.len()).map(|from| simulated.coverage(from, count, HARMONICS)).collect()
        };
        let arms: Vec<_> = (1..=ARMS).into_par_iter().map(of_arm).collect();
        let share_of_arms = |is_allowed: &dyn Fn(&Vec<Vec<f64>>) -> bool| {
            arms.iter().filter(|arm| is_allowed(arm)).count() as f64 / ARMS as f64 * 100.0
        };
        for from in [2, 1, 0, 3] {
            print!("{:<10}", format!("{count} of {}", SERIES[from]));
            for (k, other) in (0..SERIES.len()).filter(|other| *other != from).enumerate() {
                let shares: Vec<_> = arms.iter().map(|arm| arm[from][k]).collect();
                let [low, middle, high] = [0.05, 0.5, 0.95].map(|share| quantile(&shares, share));
                let allowed = share_of_arms(&|arm| ALLOWED.contains(&arm[from][k]));
                print!("  {}: {middle:.1} ({low:.1}-{high:.1}) {allowed:.0} %", SERIES[other]);
            }
            println!();
        }
        let all = share_of_arms(&|arm| arm.iter().flatten().all(|share| ALLOWED.contains(share)));
        let mean = mean(&arms.iter().flatten().flatten().copied().collect::<Vec<_>>());
        println!(
            "{count} of each: mean share {mean:.1} %; all twelve shares allowed: {all:.0} % of the arms"
        );
    }
}

/// Prints the median time, s, of a fit of 1000 poses of series C.
fn speed(data: &Data) {
    println!("\nspeed: fit of 1000 poses with cross-validation");
    for terms in [ELASTIC, HARMONICS] {
        let times: Vec<_> = (1..=5)
            .map(|seed| {
                let begun = Instant::now();
                std::hint::black_box(data.calibrated(&[(2, 1000)], seed, terms));
                begun.elapsed().as_secs_f64()
            })
            .collect();
        println!("{:<13} {:.2} s", terms.name, median(&times));
    }
}

fn main() {
    let data = Data::new();
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let studies: [(&str, Study); 7] = [
        ("transfer", transfer),
        ("terms", terms),
        ("pooled", pooled),
        ("rank", rank),
        ("plan", plan),
        ("simulated", simulated),
        ("speed", speed),
    ];
    for (name, study) in studies {
        if wanted.is_empty() || wanted.iter().any(|w| w == name) {
            study(&data);
        }
    }
}
