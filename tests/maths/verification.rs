//! Tests the comparison of measured positions with predicted errors: vectors, coverage, ranks, spots and
//! repeats.

use crate::common::{cell_of_robot, from_text};
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, Normal};
use sweetspot::calibration::{
    Deformed, MeasuredPosition, MeasuringSession, RawMeasurement, SuspectRows, Unknown, unknowns,
};
use sweetspot::cell::{
    Cell, ErrorSet, JointVector, MeasuredErrors, Parameter, Reading, SignedErrors, Spread, Tolerance,
};
use sweetspot::error_map::contains_joint;
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;
use sweetspot::verification::{
    MeasuredComparison, PredictedErrors, clusters, rank_correlation, repeatability_of,
};

const REFLECTOR: Vector3<f64> = Vector3::new(0.02, -0.03, 0.093);
/// Largest distance between the poses of one spot, m.
const SPOT: f64 = 1e-3;

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    Normal::standard().inverse_cdf(rng.random_range(1e-12..1.0))
}

/// Returns a cell of the UR10 with one error set in the given reading.
fn cell(set: ErrorSet, reading: Reading) -> Cell {
    let mut cell = from_text(&cell_of_robot("ur10")).unwrap().cell;
    cell.robot.errors = vec![set];
    (cell.errors, cell.reading) = (0, reading);
    cell
}

/// Returns parameter values of a robot with the given values of the unknowns.
fn values(axes: usize, unknowns: &[Unknown], of: &[f64]) -> Vec<f64> {
    let parameter = |unknown: &Unknown| match *unknown {
        Unknown::Row(parameter) => parameter,
        Unknown::Elastic { joint, link } => Parameter::Elastic(joint, link),
        Unknown::Harmonic { .. } => panic!("the simulated arms have no periodic errors"),
    };
    let all = Parameter::of_robot(axes);
    let value =
        |p: Parameter| unknowns.iter().zip(of).find(|(u, _)| parameter(u) == p).map_or(0.0, |(_, v)| *v);
    all.map(value).collect()
}

fn postures(chain: &Chain, count: usize, rng: &mut ChaCha8Rng) -> Vec<JointVector> {
    let any = |_| -> JointVector {
        std::array::from_fn(|i| if i < chain.axes() { rng.random_range(-2.5..2.5) } else { 0.0 })
    };
    (0..count).map(any).collect()
}

/// Returns the positions that an instrument measures on an arm with errors, with noise (m) on every axis.
fn session(
    chain: &Chain,
    postures: &[JointVector],
    (unknowns, values): (&[Unknown], &[f64]),
    (noise, rng): (f64, &mut ChaCha8Rng),
) -> MeasuringSession {
    let rotation = Rotation3::from_euler_angles(0.02, -0.01, 2.0).into_inner();
    let base = Pose { rotation, translation: Vector3::new(3.0, -2.0, 0.4) };
    let measured = postures.iter().enumerate().map(|(k, joints)| {
        let interface = Deformed::new(chain, joints, unknowns, values).interface;
        let noise_of = Vector3::from_fn(|_, _| noise * normal(rng));
        MeasuredPosition {
            row: k + 1,
            joints: *joints,
            reflector: 0,
            position: base.transform(&interface.transform(&REFLECTOR)) + noise_of,
            rotation: None,
            sigma: (noise > 0.0).then_some(noise),
        }
    });
    MeasuringSession { name: "simulated".into(), measured: measured.collect() }
}

fn compared(cell: &Cell, session: &MeasuringSession) -> MeasuredComparison {
    MeasuredComparison::new(&PredictedErrors::new(cell), session, SPOT).unwrap()
}

/// The reference fits numeric motions of the frames to the exact displacements by least squares, and
/// subtracts this fit.
#[test]
fn measured_and_predicted_vectors_are_errors_without_what_the_fit_takes_up() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let nominal =
        cell(ErrorSet::Signed(SignedErrors::of_values("none".into(), 6, &[0.0; 200])), Reading::Signed);
    let chain = Chain::new(&nominal.robot);
    let unknowns = unknowns(&chain, true);
    let truth: Vec<f64> = unknowns.iter().map(|u| 0.3 * u.default_prior(&chain) * normal(&mut rng)).collect();
    let postures = postures(&chain, 40, &mut rng);
    let session = session(&chain, &postures, (&unknowns, &truth), (0.0, &mut rng));
    let place = |q: &JointVector, values: &[f64], by: &[f64; 9]| {
        let interface = Deformed::new(&chain, q, &unknowns[..values.len()], values).interface;
        let p = interface.transform(&(REFLECTOR + Vector3::new(by[6], by[7], by[8])));
        Rotation3::new(Vector3::new(by[3], by[4], by[5])) * p + Vector3::new(by[0], by[1], by[2])
    };
    let stacked = |of: &dyn Fn(&JointVector) -> Vector3<f64>| {
        DVector::from_iterator(120, postures.iter().flat_map(|q| of(q).iter().copied().collect::<Vec<_>>()))
    };
    let errors = stacked(&|q| place(q, &truth, &[0.0; 9]) - place(q, &[], &[0.0; 9]));
    let columns: Vec<_> = (0..9)
        .map(|k| {
            let step = |size: f64| std::array::from_fn(|j| if j == k { size } else { 0.0 });
            stacked(&|q| (place(q, &[], &step(1e-5)) - place(q, &[], &step(-1e-5))) / 2e-5)
        })
        .collect();
    let motions = DMatrix::from_columns(&columns);
    let fit = motions.clone().svd(true, true).solve(&errors, 1e-12).unwrap();
    let reference = &errors - &motions * fit;
    let signed = SignedErrors::of_values("true".into(), 6, &values(6, &unknowns, &truth));
    let found = compared(&cell(ErrorSet::Signed(signed), Reading::Signed), &session);
    assert!(found.coverage.is_none() && found.poses.iter().all(|pose| pose.is_inside.is_none()));
    assert!(found.measured.mean > 1e-4, "{:?}", found.measured);
    for (k, pose) in found.poses.iter().enumerate() {
        let wanted = Vector3::new(reference[3 * k], reference[3 * k + 1], reference[3 * k + 2]);
        for vector in [pose.measured, pose.predicted] {
            // The fit of the reference is linear, and errors of 1 mm rotate the arm by about 1 mrad.
            assert!((vector - wanted).norm() < 4e-6, "{k}: {vector} and {wanted}");
        }
        assert!((pose.size - pose.predicted.norm()).abs() < 1e-15);
    }
    assert!(found.residual.max < 5e-6 && found.correlation.unwrap() > 0.999, "{:?}", found.residual);
    // Without known errors, the prediction is 0, and the full measured error remains.
    let none = compared(&nominal, &session);
    assert_eq!((none.predicted.max, none.correlation), (0.0, None));
    assert_eq!(none.residual.mean, none.measured.mean);
}

/// Every draw is an arm with errors from the covariance of the set. The errors are the same at all poses, or
/// change from pose to pose.
#[test]
fn ellipsoids_cover_about_95_percent_of_the_positions_of_random_arms() {
    let mut rng = ChaCha8Rng::seed_from_u64(95);
    let chain = Chain::new(&from_text(&cell_of_robot("ur10")).unwrap().cell.robot);
    let unknowns = unknowns(&chain, true);
    let sigmas: Vec<f64> = unknowns.iter().map(|u| 0.1 * u.default_prior(&chain)).collect();
    let mean: Vec<f64> = unknowns.iter().map(|u| 0.5 * u.default_prior(&chain) * normal(&mut rng)).collect();
    let spread = |sigma: f64| Spread { sigmas: 1.0, ..Spread::of_magnitude(sigma) };
    let spread = Tolerance {
        name: "measured".into(),
        spreads: values(6, &unknowns, &sigmas).into_iter().map(spread).collect(),
        covariance: None,
        costs: Vec::new(),
    };
    let measured = MeasuredErrors {
        mean: SignedErrors::of_values("measured".into(), 6, &values(6, &unknowns, &mean)),
        spread: spread.clone(),
        ranges: None,
    };
    let measured = cell(ErrorSet::Measured(Box::new(measured)), Reading::Signed);
    let tolerances = cell(ErrorSet::Tolerance(spread), Reading::Statistical);
    let postures = postures(&chain, 24, &mut rng);
    let (mut of_measured, mut of_tolerances, mut of_varying) = (0.0, 0.0, 0.0);
    const ARMS: usize = 150;
    for _ in 0..ARMS {
        let by: Vec<f64> = sigmas.iter().map(|sigma| sigma * normal(&mut rng)).collect();
        let all: Vec<f64> = mean.iter().zip(&by).map(|(a, b)| a + b).collect();
        let simulated = session(&chain, &postures, (&unknowns, &all), (1e-5, &mut rng));
        let found = compared(&measured, &simulated);
        of_measured += found.coverage.unwrap() / ARMS as f64;
        let mut varied = simulated.clone();
        for (m, q) in varied.measured.iter_mut().zip(&postures) {
            let own: Vec<f64> = mean.iter().zip(&sigmas).map(|(m, s)| m + s * normal(&mut rng)).collect();
            let one = session(&chain, std::slice::from_ref(q), (&unknowns, &own), (1e-5, &mut rng));
            m.position = one.measured[0].position;
        }
        of_varying += compared(&measured, &varied).coverage_varying.unwrap() / ARMS as f64;
        let simulated = session(&chain, &postures, (&unknowns, &by), (1e-5, &mut rng));
        let found = compared(&tolerances, &simulated);
        assert_eq!(found.coverage_varying, None);
        of_tolerances += found.coverage.unwrap() / ARMS as f64;
        assert!(found.poses.iter().all(|pose| pose.predicted.norm() < 1e-12 && pose.size > 0.0));
    }
    for share in [of_measured, of_tolerances, of_varying] {
        assert!((0.93..0.97).contains(&share), "{of_measured}, {of_tolerances} and {of_varying}");
    }
}

/// The ranks are 1, 2.5, 2.5, 4, 5 and 2, 1, 4, 3, 5. The products of their deviations from the mean sum to
/// 6.5, and the squares sum to 9.5 and 10.
#[test]
fn the_rank_correlation_agrees_with_one_by_hand() {
    let found = rank_correlation(&[0.1, 0.2, 0.2, 0.7, 9.0], &[2.0, 1.0, 4.0, 3.0, 5.0]).unwrap();
    assert!((found - 6.5 / 95f64.sqrt()).abs() < 1e-15, "{found}");
    assert_eq!(rank_correlation(&[1.0, 2.0, 3.0], &[-1.0, -2.0, -4.0]), Some(-1.0));
    assert_eq!(rank_correlation(&[1.0, 1.0], &[1.0, 2.0]), None);
    assert_eq!(rank_correlation(&[], &[]), None);
    assert_eq!(rank_correlation(&[1.0], &[1.0, 2.0]), None);
}

/// Three visits at 1, 3 and 2 mm: the barycentre is at 2 mm, the distances are 1, 1 and 0 mm.
#[test]
fn accuracy_and_repeatability_agree_with_the_standard_by_hand() {
    let visits = [1.0, 3.0, 2.0].map(|x| Vector3::new(0.0, 0.6 * x, 0.8 * x));
    let (accuracy, repeatability) = repeatability_of(&visits).unwrap();
    assert!((accuracy - 2.0).abs() < 1e-15, "{accuracy}");
    assert!((repeatability - (2.0 / 3.0 + 3.0 / 3f64.sqrt())).abs() < 1e-14, "{repeatability}");
    assert_eq!(repeatability_of(&visits[..1]), None);
}

#[test]
fn clusters_keep_the_order_of_the_list() {
    let points = [[5.0, 0.0], [1.0, 0.0], [5.05, 0.0], [1.0, 0.5], [0.95, 0.05], [5.2, 0.0]];
    assert_eq!(clusters(&points, 0.1), [vec![0, 2], vec![1, 4], vec![3], vec![5]]);
    assert_eq!(clusters::<[f64; 2]>(&[], 0.1), [[0; 0]; 0]);
}

/// Ten postures are visited five times each with a noise of 20 um per axis.
#[test]
fn true_repeats_remain_and_give_their_repeatability() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let placeholder = from_text(&cell_of_robot("ur10")).unwrap().cell;
    let chain = Chain::new(&placeholder.robot);
    let once = postures(&chain, 10, &mut rng);
    let often: Vec<_> = (0..50).map(|k| once[k % 10]).collect();
    let session = session(&chain, &often, (&[], &[]), (2e-5, &mut rng));
    let raw: Vec<_> = session.measured.iter().map(RawMeasurement::from).collect();
    assert!(SuspectRows::new(&raw).all().is_empty());
    let found = compared(&placeholder, &session);
    let repeats = found.repeats.unwrap();
    assert_eq!((repeats.postures.len(), repeats.least_visits()), (10, 5));
    assert_eq!((found.ranking.spots.len(), found.ranking.chosen.poses), (10, 5));
    for posture in &repeats.postures {
        let visits: Vec<_> =
            found.poses.iter().filter(|p| p.row % 10 == posture.row % 10).map(|p| p.measured).collect();
        let (accuracy, repeatability) = repeatability_of(&visits).unwrap();
        assert_eq!((posture.accuracy, posture.repeatability), (accuracy, repeatability));
        assert!(posture.repeatability > 3e-5 && posture.repeatability < 2e-4, "{posture:?}");
    }
    let once = MeasuringSession { measured: session.measured[..10].to_vec(), ..session.clone() };
    assert_eq!(compared(&placeholder, &once).repeats, None);
    let few = MeasuringSession { measured: session.measured[..3].to_vec(), ..session };
    let why = MeasuredComparison::new(&PredictedErrors::new(&placeholder), &few, SPOT).unwrap_err();
    assert!(why.contains("9 measured coordinates"), "{why}");
}

#[test]
fn measured_angles_are_equal_modulo_a_turn_and_lengths_are_not() {
    let turn = std::f64::consts::TAU;
    for (range, q, of_angles, of_lengths) in [
        ((-1.0, 2.0), 2.0, true, true),
        ((-1.0, 2.0), 2.1, false, false),
        ((-1.0, 2.0), -1.1, false, false),
        ((-1.0, 2.0), 1.0 - turn, true, false),
        ((-1.0, 2.0), 2.5 + turn, false, false),
        ((3.0, 3.0), 3.0 - turn, true, false),
        ((-4.0, 4.0), 17.0, true, false),
    ] {
        let found = (contains_joint(range, q, true), contains_joint(range, q, false));
        assert_eq!(found, (of_angles, of_lengths), "{q} in {range:?}");
    }
}

/// The flange of a SCARA always points down, so the nominal arm leaves the height of a reflector
/// undetermined. With the true errors, the prediction still agrees with the measurement.
#[test]
fn reflectors_below_a_vertical_flange_are_predicted_with_the_true_errors() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut cell = from_text(&cell_of_robot("adept_cobra_s600")).unwrap().cell;
    let chain = Chain::new(&cell.robot);
    let unknowns = unknowns(&chain, false);
    let truth: Vec<f64> = unknowns.iter().map(|u| u.default_prior(&chain) * normal(&mut rng)).collect();
    let postures: Vec<_> = (0..60).map(|k| chain.halton_sample(k)).collect();
    let noise = 2e-5;
    let session = session(&chain, &postures, (&unknowns, &truth), (noise, &mut rng));
    let signed = SignedErrors::of_values("true".into(), 4, &values(4, &unknowns, &truth));
    (cell.robot.errors, cell.errors) = (vec![ErrorSet::Signed(signed)], 0);
    cell.reading = Reading::Signed;
    let found = compared(&cell, &session);
    // The length of a vector of three normal deviations rarely exceeds four standard deviations.
    assert!(found.residual.max < 4.5 * noise, "{:?}", found.residual);
    assert!(found.measured.mean > 10.0 * found.residual.mean, "{:?} {:?}", found.measured, found.residual);
}
