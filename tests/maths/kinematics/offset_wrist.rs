//! Tests the inverse kinematics of arms with an offset wrist against an independent D-H product, and against
//! the numeric solver.

use crate::kinematics::six_axes::{InverseBench, turning};
use nalgebra::Matrix3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use sweetspot::reach::{Inverse, OffsetWrist, SphericalWrist};
use sweetspot::robot::Chain;

/// Returns the rows of the FANUC CRX-10iA: theta (degrees), r, l (mm), alpha (degrees).
fn crx() -> [[f64; 4]; 6] {
    [
        [0.0, 245.0, 0.0, -90.0],
        [-90.0, 0.0, 540.0, 180.0],
        [0.0, 0.0, 0.0, -90.0],
        [0.0, -540.0, 0.0, 90.0],
        [0.0, 150.0, 0.0, -90.0],
        [0.0, -160.0, 0.0, 0.0],
    ]
}

/// Returns the rows of a random arm whose wrist has two offsets. If `anthropomorphic` is true, axes 2 and 3
/// are parallel.
fn random_rows(rng: &mut ChaCha8Rng, anthropomorphic: bool) -> [[f64; 4]; 6] {
    let mut side = || if rng.random() { 1.0 } else { -1.0 };
    let [first, second] = [side(), side()];
    let mut of = |low: f64, high: f64| rng.random_range(low..high);
    let shoulder = match anthropomorphic {
        true => [
            [10.0, 300.0, of(0.0, 200.0), 90.0 * first],
            [20.0, of(-50.0, 50.0), of(300.0, 700.0), 90.0 - 90.0 * second],
            [-30.0, of(-20.0, 20.0), of(-80.0, 80.0), 90.0 * second],
        ],
        false => [
            [10.0, 300.0, of(40.0, 200.0), first * of(40.0, 140.0)],
            [20.0, of(-50.0, 50.0), of(200.0, 500.0), second * of(10.0, 170.0)],
            [-30.0, of(-90.0, 90.0), of(50.0, 200.0), of(40.0, 140.0)],
        ],
    };
    let [a, b, c] = shoulder;
    [
        a,
        b,
        c,
        [40.0, of(300.0, 600.0), 0.0, first * of(30.0, 150.0)],
        [50.0, of(40.0, 200.0), of(-60.0, 60.0), second * of(30.0, 150.0)],
        [60.0, of(50.0, 200.0), of(-40.0, 40.0), of(-180.0, 180.0)],
    ]
}

/// Returns the rows of the chain from flange to base. Row k is joint 7 - k with the twist of row 6 - k, both
/// reversed.
fn reversed(rows: &[[f64; 4]; 6]) -> [[f64; 4]; 6] {
    std::array::from_fn(|k| {
        let [theta, r, ..] = rows[5 - k];
        let (l, alpha) = if k < 5 { (rows[4 - k][2], rows[4 - k][3]) } else { (30.0, 20.0) };
        [-theta, -r, -l, -alpha]
    })
}

/// Returns the number of random poses whose original posture is not found. Checks that every posture found
/// attains the pose.
fn missed(bench: &InverseBench, count: usize, seed: u64) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let missed = |_| {
        let q = bench.random(&mut rng);
        let answer = bench.verified(&q);
        let numbers: std::collections::BTreeSet<u8> = answer.found.iter().map(|f| f.0).collect();
        assert_eq!(numbers.len(), answer.found.len(), "{q:?}: a number occurs twice");
        assert!(answer.found.len() <= 16 && numbers.iter().all(|n| *n < 16));
        usize::from(bench.nearest(&q, &answer) > 1e-5)
    };
    (0..count).map(missed).sum()
}

/// Two postures that nearly coincide may be missed together, which concerns about one pose in 3 000.
#[test]
fn the_scan_finds_the_original_posture() {
    let poses = crate::common::cases(3000, 100_000);
    let lost = missed(&InverseBench::offset(turning(crx())), poses, 1);
    assert!(lost * 1000 <= poses, "{lost} of {poses} postures of the CRX-10iA are missed");
}

#[test]
fn the_scan_finds_the_original_posture_of_random_arms_in_both_directions() {
    let arms: Vec<u64> = (0..crate::common::cases(24, 200) as u64).collect();
    let (poses, all) = (150, arms.len());
    let lost: Vec<(u64, usize)> = arms
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(100 + seed);
            let rows = random_rows(&mut rng, seed.is_multiple_of(2));
            let is_reversed = seed % 4 >= 2;
            let rows = if is_reversed { reversed(&rows) } else { rows };
            let bench = InverseBench::offset(turning(rows));
            let joint = if is_reversed { "(scan of joint 1)" } else { "(scan of joint 6)" };
            assert!(Inverse::new(&bench.chain).family().ends_with(joint), "seed {seed}");
            (seed, missed(&bench, poses, seed))
        })
        .collect();
    let sum: usize = lost.iter().map(|(_, lost)| lost).sum();
    println!("{sum} of {} postures are missed: {lost:?}", all * poses);
    assert!(sum * 500 <= all * poses, "{sum} of {}: {lost:?}", all * poses);
}

/// The numeric solver starts from 384 postures, so it rarely misses a solution.
#[test]
fn the_scan_finds_the_solutions_of_the_numeric_solver() {
    let counts: Vec<[usize; 3]> = (0..40u64)
        .into_par_iter()
        .map(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(500 + seed);
            let rows = if seed.is_multiple_of(2) { crx() } else { random_rows(&mut rng, seed % 4 == 1) };
            let bench = InverseBench::offset(turning(rows));
            bench.beside_numeric(&mut rng)
        })
        .collect();
    let [expected, both, found] = [0, 1, 2].map(|k| counts.iter().map(|c| c[k]).sum::<usize>());
    assert!(
        expected > 150 && both == expected && found >= expected,
        "{expected}, {both}, {found}: {counts:?}"
    );
}

/// The distance of a target out of reach is the distance of the intersection of axes 4 and 5.
#[test]
fn a_target_out_of_reach_has_the_least_distance_of_the_wrist() {
    let bench = InverseBench::offset(turning(crx()));
    let mut flange = bench.pose(&[0.0; 8]);
    flange.rotation = Matrix3::identity();
    flange.translation = nalgebra::Vector3::new(3.0, 0.0, 0.245);
    let answer = bench.solve(&flange);
    // The point P is 150 mm from axis 6, which passes 160 mm beside the target. The arm reaches 1080 mm.
    let on_circle = |angle: f64| nalgebra::Vector3::new(3.0 + 0.15 * angle.cos(), 0.15 * angle.sin(), 0.405);
    let distance = |angle: f64| (on_circle(angle) - nalgebra::Vector3::new(0.0, 0.0, 0.245)).norm() - 1.08;
    let least = (0..3600).map(|k| distance(f64::from(k).to_radians() / 10.0)).fold(f64::INFINITY, f64::min);
    assert!(answer.found.is_empty() && (answer.missing - least).abs() < 0.02, "{} {least}", answer.missing);
}

#[test]
fn arms_of_other_kinds_are_refused_with_a_reason() {
    let mut rows = crx();
    rows[3][2] = 20.0;
    rows[1][2] = 0.0;
    let why = OffsetWrist::new(&Chain::new(&turning(rows))).unwrap_err();
    assert!(why.contains("the axes 4 and 5 do not intersect"), "{why}");
    let mut rows = crx();
    rows[4][3] = 180.0;
    let why = OffsetWrist::new(&Chain::new(&turning(rows))).unwrap_err();
    assert!(why.contains("parallel"), "{why}");
    // Without the offset, the closed form of a spherical wrist applies.
    rows = crx();
    rows[4][1] = 0.0;
    assert!(SphericalWrist::new(&Chain::new(&turning(rows))).is_ok());
}
