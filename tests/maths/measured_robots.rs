//! Tests the calibration with simulated arms: exact derivatives, known parameters, units and joint signs.

use crate::common::robots;
use crate::kinematics::product::{position, product};
use nalgebra::{DVector, Rotation3, Vector3};
use num_dual::Dual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use statrs::distribution::{ContinuousCDF, Normal};
use sweetspot::calibration::{
    Calibration, Deformed, MeasuredPosition, MeasuringSession, RawMeasurement, Unknown, aligned, calibrate,
    explain, gross_errors, harmonics, unknowns,
};
use sweetspot::cell::{JointKind, JointVector, Parameter, Robot};
use sweetspot::kinematic_error::{ParameterSet, identifiable};
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;

/// Reflector in the frame of the mechanical interface, m.
const REFLECTOR: Vector3<f64> = Vector3::new(0.04, -0.03, 0.11);

fn normal(rng: &mut ChaCha8Rng) -> f64 {
    Normal::standard().inverse_cdf(rng.random_range(1e-12..1.0))
}

/// Returns a robot whose TCP is the mechanical interface.
fn without_tool(mut robot: Robot) -> Robot {
    robot.tool = Pose::identity();
    robot
}

/// Returns values of the unknowns, drawn from their prior distribution.
fn truth(chain: &Chain, unknowns: &[Unknown], rng: &mut ChaCha8Rng) -> Vec<f64> {
    unknowns.iter().map(|u| u.default_prior(chain) * normal(rng)).collect()
}

/// Returns positions that an instrument measures at random postures, with noise (m) on every axis.
fn session(
    chain: &Chain,
    unknowns: &[Unknown],
    values: &[f64],
    count: usize,
    noise: f64,
    seed: u64,
) -> MeasuringSession {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let rotation = Rotation3::from_euler_angles(0.02, -0.01, 2.0).into_inner();
    let base = Pose { rotation, translation: Vector3::new(3.0, -2.0, 0.4) };
    let measured = (1..=count).map(|row| {
        let joints: JointVector = std::array::from_fn(|i| match chain.links.get(i) {
            Some(link) => rng.random_range(link.limits.0.max(-3.0)..=link.limits.1.min(3.0)),
            None => 0.0,
        });
        let interface = Deformed::new(chain, &joints, unknowns, values).interface;
        let noise = Vector3::from_fn(|_, _| noise * normal(&mut rng));
        MeasuredPosition {
            row,
            joints,
            reflector: 0,
            position: base.transform(&interface.transform(&REFLECTOR)) + noise,
            rotation: None,
            sigma: None,
        }
    });
    MeasuringSession { name: "simulated".into(), measured: measured.collect() }
}

fn default_priors(chain: &Chain, unknowns: &[Unknown]) -> Vec<f64> {
    unknowns.iter().map(|u| u.default_prior(chain)).collect()
}

fn calibrated(chain: &Chain, session: &MeasuringSession, unknowns: &[Unknown]) -> Calibration {
    calibrate(chain, std::slice::from_ref(session), unknowns, &default_priors(chain, unknowns)).unwrap()
}

/// The reference is a product of textbook matrices, whose dual part is the derivative.
#[test]
fn the_deformed_chain_and_its_derivatives_agree_with_dual_numbers() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    for (name, robot) in robots() {
        let robot = without_tool(robot);
        let chain = Chain::new(&robot);
        let all = Parameter::of_robot(robot.axes()).take(Parameter::first_elastic(robot.axes()));
        let all: Vec<_> = all.collect();
        let rows: Vec<_> = all[..5 * robot.axes()].iter().map(|p| Unknown::Row(*p)).collect();
        let values = truth(&chain, &rows, &mut rng);
        let q = chain.halton_sample(rng.random_range(0..1000));
        let deformed = Deformed::new(&chain, &q, &rows, &values);
        for (k, unknown) in rows.iter().enumerate() {
            let mut errors = vec![Dual64::from(0.0); all.len()];
            errors.iter_mut().zip(&values).for_each(|(e, v)| *e = Dual64::from(*v));
            errors[k].eps = 1.0;
            let t = product(&robot, &q, &errors);
            let exact = robot.mount.transform(&position(&t.map(|d| d.re)));
            let slope = robot.mount.rotation * position(&t.map(|d| d.eps));
            let at = deformed.interface.translation;
            assert!((at - exact).norm() < 1e-13, "{name}: {:e} m", (at - exact).norm());
            let off = (deformed.motion(&chain, *unknown, &at).slope - slope).norm();
            assert!(off < 1e-12, "{name}: derivative {k} is wrong by {off:e}");
        }
    }
}

/// If the upper arm of a UR10 is at the angle q2 to the horizontal, its lever is `612 mm cos q2`.
#[test]
fn an_elastic_joint_turns_in_proportion_to_its_horizontal_lever() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot));
    let term = [Unknown::Elastic { joint: 1, link: 1 }];
    for q2 in [-2.5_f64, -1.0, 0.0, 0.4, 1.2] {
        let q = [0.7, q2, -0.3, 0.2, 1.0, 0.5, 0.0, 0.0];
        let at = |q: &JointVector, c: f64| Deformed::new(&chain, q, &term, &[c]).interface.translation;
        let moved = at(&q, 1e-3);
        let mut turned = q;
        // Gravity lowers the arm: its lever points along -x for the negative common normal of row 2.
        turned[1] += 1e-3 * 0.612 * q2.cos();
        let off = (at(&turned, 0.0) - moved).norm();
        assert!(off < 1e-14, "q2 = {q2}: {off:e} m");
    }
}

/// The error of joint 2 is 0.4 mrad times `sin(17 q)`, plus 0.2 mrad times `cos(5 q)`: 0.45 mrad at most.
#[test]
fn periodic_errors_of_a_joint_are_identified_and_predict_other_positions() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot));
    let wave = |order, sine| Unknown::Harmonic { joint: 1, order, sine };
    let (errors, sizes) = ([wave(17, true), wave(5, false)], [4e-4, 2e-4]);
    let q: JointVector = [0.7, -0.9, 1.1, 0.2, 1.0, 0.5, 0.0, 0.0];
    let mut turned = q;
    turned[1] += sizes[0] * (17.0 * q[1]).sin() + sizes[1] * (5.0 * q[1]).cos();
    let of_waves = Deformed::new(&chain, &q, &errors, &sizes).interface.translation;
    let of_joint = Deformed::new(&chain, &turned, &[], &[]).interface.translation;
    assert!((of_waves - of_joint).norm() < 1e-14);

    let [measured, others] = [1, 2].map(|seed| session(&chain, &errors, &sizes, 200, 2e-5, seed));
    let plain = unknowns(&chain, false);
    let mut periodic = plain.clone();
    periodic.extend(harmonics(&chain, 20));
    let mean = |unknowns: &[Unknown]| {
        let result = calibrated(&chain, &measured, unknowns);
        let (tested, inside) = result.tested(&others.measured).unwrap();
        let mean = tested.distances.iter().sum::<f64>() / tested.distances.len() as f64;
        (result, mean, inside)
    };
    let (_, without, _) = mean(&plain);
    let (result, with, inside) = mean(&periodic);
    assert!(with < without / 3.0, "{with} m with harmonics, {without} m without");
    assert!(inside > 0.9, "{inside} of the positions lie in their ellipsoids");
    for identified in &result.identified {
        if let Unknown::Harmonic { joint: 1, .. } = identified.unknown {
            let truth = errors.iter().position(|u| *u == identified.unknown).map_or(0.0, |k| sizes[k]);
            let off = (identified.value - truth).abs();
            assert!(off < 5e-5, "{:?} is off by {off} rad", identified.unknown);
        }
    }
    assert_eq!(result.parameters().len(), plain.len());
    // A file states the periodic errors as known. The covariance of the other parameters is then the inverse
    // of a block of the precision matrix.
    let known = plain.len();
    let precision = result.covariance.clone().try_inverse().unwrap();
    let block = precision.view((0, 0), (known, known)).into_owned().try_inverse().unwrap();
    let beside = result.covariance_beside_periodic_errors();
    let scale = |k: usize| result.covariance[(k, k)].sqrt();
    let off = |i: usize, j: usize| (beside[(i, j)] - block[(i, j)]).abs() / (scale(i) * scale(j));
    assert!((0..known).all(|i| (0..known).all(|j| off(i, j) < 1e-6)));
    // The reference is the joint uncertainty of zero error and periodic error at random coordinates in the
    // measured range.
    let zero = plain.iter().position(|u| *u == Unknown::Row(Parameter::Dq(1))).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let (low, high) = result.ranges[1];
    let variances = (0..4000).map(|_| {
        let q = rng.random_range(low..high);
        let part = |unknown: &Unknown| match *unknown {
            Unknown::Row(Parameter::Dq(1)) => 1.0,
            Unknown::Harmonic { joint: 1, order, sine: true } => (order as f64 * q).sin(),
            Unknown::Harmonic { joint: 1, order, .. } => (order as f64 * q).cos(),
            _ => 0.0,
        };
        let parts = DVector::from_iterator(periodic.len(), periodic.iter().map(part));
        parts.dot(&(&result.covariance * &parts))
    });
    let mean = variances.sum::<f64>() / 4000.0;
    let stated = result.variance_of_periodic_error(1) + beside[(zero, zero)];
    assert!(high - low <= 6.0 && (stated / mean - 1.0).abs() < 0.05, "{stated:e} {mean:e}");
    let expected: f64 =
        result.harmonics_of(3).map(|i| i.unknown.default_prior(&chain).powi(2)).sum::<f64>() / 2.0;
    let [found, of_other_joint] = [1, 3].map(|joint| result.periodic_variance(joint) / expected);
    assert!(of_other_joint < 0.5 && found > 2.0 * of_other_joint, "{found}, {of_other_joint}");
}

/// Seven arms of every robot, 112 in all, are simulated. The unknowns are drawn from the assumed
/// distribution, so 95 % of the intervals contain the true values.
#[test]
fn identified_parameters_of_simulated_arms_lie_in_their_intervals() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut inside, mut count) = (0, 0);
    for (k, (name, robot)) in robots().into_iter().enumerate() {
        let chain = Chain::new(&without_tool(robot));
        for draw in 0..7 {
            let unknowns = unknowns(&chain, draw % 2 == 1);
            let truth = truth(&chain, &unknowns, &mut rng);
            let session = session(&chain, &unknowns, &truth, 60, 3e-5, 10 * k as u64 + draw);
            let result = calibrated(&chain, &session, &unknowns);
            for (identified, truth) in result.identified.iter().zip(&truth).filter(|(i, _)| i.is_identified())
            {
                count += 1;
                let off = (identified.value - truth).abs();
                inside += usize::from(off < 1.96 * identified.sigma);
                assert!(off < 6.0 * identified.sigma, "{name}: {:?} is off", identified.unknown);
            }
        }
    }
    let share = inside as f64 / f64::from(count);
    assert!(count > 500, "{count} identified parameters");
    assert!((0.92..0.98).contains(&share), "{share} of {count} intervals contain the truth");
}

/// If a joint does not move, some combinations of parameters remain unknown.
#[test]
fn parameters_that_the_data_do_not_determine_are_not_identified() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let mut chain = Chain::new(&without_tool(robot));
    let unknowns = unknowns(&chain, false);
    let moving =
        calibrated(&chain, &session(&chain, &unknowns, &vec![0.0; unknowns.len()], 80, 1e-5, 3), &unknowns);
    assert_eq!((moving.rank, moving.unidentified.len()), (unknowns.len(), 0));
    chain.links[2].limits = (0.5, 0.5);
    let held =
        calibrated(&chain, &session(&chain, &unknowns, &vec![0.0; unknowns.len()], 80, 1e-5, 3), &unknowns);
    let is_known =
        |wanted| held.identified.iter().find(|i| i.unknown == Unknown::Row(wanted)).unwrap().is_identified();
    assert!(held.rank < unknowns.len());
    // If the elbow does not move, the forearm and the upper arm form one rigid body.
    assert!(!is_known(Parameter::Dl(1)) && !is_known(Parameter::Dl(2)) && is_known(Parameter::Dq(1)));
}

#[test]
fn units_and_joint_signs_of_measured_data_are_found() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot.clone()));
    let unknowns = unknowns(&chain, false);
    let truth = truth(&chain, &unknowns, &mut ChaCha8Rng::seed_from_u64(8));
    let clean = session(&chain, &unknowns, &truth, 60, 1e-5, 4);
    for (degrees, unit) in [(true, 0.0254), (false, 1e-3), (true, 1.0)] {
        for flipped in [&[][..], &[1, 4], &[2]] {
            let mut raw = clean.measured.clone();
            for m in &mut raw {
                m.position /= unit;
                for (i, q) in m.joints.iter_mut().enumerate() {
                    *q = if degrees { q.to_degrees() } else { *q };
                    *q = if flipped.contains(&i) { -*q } else { *q };
                }
            }
            let raw: Vec<_> = raw.iter().map(RawMeasurement::from).collect();
            let reading = explain(&chain, &raw, robot.reach()).unwrap();
            assert_eq!((reading.degrees, reading.unit), (degrees, unit), "{flipped:?}");
            let found: Vec<_> = (0..6).filter(|&i| reading.joints.signs[i] < 0.0).collect();
            assert_eq!(found, flipped);
            assert!(reading.is_plausible(robot.reach()));
            let again = reading.applied(&chain, &raw[7]);
            assert!((again.position - clean.measured[7].position).norm() < 1e-12);
        }
    }
}

/// Three reflectors determine parameters of the last joints that one reflector near the axis leaves unknown.
#[test]
fn several_reflectors_share_one_base() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot));
    let unknowns = unknowns(&chain, false);
    let truth = truth(&chain, &unknowns, &mut ChaCha8Rng::seed_from_u64(21));
    let mut session = session(&chain, &unknowns, &truth, 50, 0.0, 6);
    let rotation = Rotation3::from_euler_angles(0.02, -0.01, 2.0).into_inner();
    let base = Pose { rotation, translation: Vector3::new(3.0, -2.0, 0.4) };
    let places = [REFLECTOR, Vector3::new(-0.1, 0.02, 0.05), Vector3::new(0.0, 0.12, 0.01)];
    let one = session.measured.clone();
    session.measured = one
        .iter()
        .flat_map(|m| {
            let interface = Deformed::new(&chain, &m.joints, &unknowns, &truth).interface;
            let at = |place: &Vector3<f64>| base.transform(&interface.transform(place));
            let all = places.iter().enumerate();
            all.map(|(reflector, place)| MeasuredPosition { reflector, position: at(place), ..*m })
                .collect::<Vec<_>>()
        })
        .collect();
    let result = calibrated(&chain, &session, &unknowns);
    let frames = &result.sessions[0].frames;
    for (found, place) in frames.reflectors.iter().zip(&places) {
        // Errors of the last row are part of the positions of the reflectors.
        assert!((found - place).norm() < 1e-5, "{found} {place}");
    }
    assert!((frames.base.translation - base.translation).norm() < 1e-5);
    for (identified, truth) in result.identified.iter().zip(&truth) {
        assert!((identified.value - truth).abs() < 1e-5, "{:?}", identified.unknown);
    }
    assert!(result.sessions[0].distances.len() == 150 && result.residual < 1e-7);
}

#[test]
fn gross_errors_are_found_and_all_other_positions_are_kept() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot));
    let unknowns = unknowns(&chain, false);
    let truth = truth(&chain, &unknowns, &mut ChaCha8Rng::seed_from_u64(5));
    let clean = session(&chain, &unknowns, &truth, 120, 2e-5, 9);
    let found = |change: &dyn Fn(&mut [MeasuredPosition])| {
        let mut session = clean.clone();
        change(&mut session.measured);
        let all = gross_errors(&chain, &[session], &unknowns, &default_priors(&chain, &unknowns)).remove(0);
        if all.too_many {
            return Vec::new();
        }
        let mut rows: Vec<_> = all.errors.iter().map(|error| error.row).collect();
        rows.sort_unstable();
        rows
    };
    let lost = |all: &mut [MeasuredPosition]| all[30].position = Vector3::zeros();
    let displaced = |all: &mut [MeasuredPosition]| all[50].position.x += 0.04;
    let typed = |all: &mut [MeasuredPosition]| all[70].joints[2] += 0.17;
    assert_eq!(found(&|_| ()), [0; 0]);
    assert_eq!(found(&lost), [31]);
    assert_eq!(found(&displaced), [51]);
    assert_eq!(found(&typed), [71]);
    let all_three = |all: &mut [MeasuredPosition]| {
        lost(all);
        displaced(all);
        typed(all);
    };
    assert_eq!(found(&all_three), [31, 51, 71]);
    // If many positions are wrong, the model does not fit the session, and no position is left out.
    let many = |all: &mut [MeasuredPosition]| all.iter_mut().take(30).for_each(|m| m.position.y += 0.5);
    assert_eq!(found(&many), [0; 0]);
}

/// A parameter is absorbed if base and reflectors can be fitted to the arm with this error without residuals.
#[test]
fn exactly_the_parameters_that_base_and_reflectors_absorb_are_no_unknowns() {
    const ERROR: f64 = 1e-5;
    let places = [REFLECTOR, Vector3::new(-0.1, 0.02, 0.05), Vector3::new(0.0, 0.12, 0.01)];
    let mut absorbed = 0;
    for (name, robot) in robots() {
        let chain = Chain::new(&without_tool(robot));
        let chosen = unknowns(&chain, false);
        for parameter in identifiable(&chain, ParameterSet::FiveParameter) {
            let unknown = Unknown::Row(parameter);
            let (mut poses, mut measured) = (Vec::new(), Vec::new());
            for k in 0..30 {
                let joints = chain.halton_sample(k + 100);
                let actual = Deformed::new(&chain, &joints, &[unknown], &[ERROR]).interface;
                for (reflector, place) in places.iter().enumerate() {
                    let position = actual.transform(place);
                    let (rotation, sigma) = (None, None);
                    measured.push(MeasuredPosition {
                        row: k + 1,
                        joints,
                        reflector,
                        position,
                        rotation,
                        sigma,
                    });
                    poses.push(Deformed::new(&chain, &joints, &[], &[]));
                }
            }
            let frames = aligned(&poses, &measured).unwrap();
            let pairs = poses.iter().zip(&measured);
            let largest =
                pairs.map(|(pose, m)| frames.residual(&pose.interface, m).norm()).fold(0.0, f64::max);
            assert_eq!(
                chosen.contains(&unknown),
                largest > 1e-3 * ERROR,
                "{name} {parameter:?}: {largest:e} m"
            );
            absorbed += usize::from(!chosen.contains(&unknown));
        }
    }
    assert!(absorbed > 100, "{absorbed} absorbed parameters");
}

#[test]
fn default_priors_have_the_unit_of_their_joints() {
    let mut slides = 0;
    for (name, robot) in robots() {
        let chain = Chain::new(&robot);
        for (i, link) in chain.links.iter().enumerate() {
            let prior = Unknown::Row(Parameter::Dq(i)).default_prior(&chain);
            let expected = match link.kind {
                JointKind::Revolute => 0.5_f64.to_radians(),
                JointKind::Prismatic => 0.5e-3,
            };
            assert!((prior - expected).abs() < 1e-15, "{name}: joint {i} has the prior {prior}");
            slides += usize::from(link.kind == JointKind::Prismatic);
        }
    }
    assert!(slides >= 2);
}

/// Most rows repeat three postures. The few other rows are informative, not gross errors.
#[test]
fn the_few_postures_beside_many_repeats_are_kept() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot));
    let unknowns = unknowns(&chain, false);
    for seed in 0..4 {
        let truth = truth(&chain, &unknowns, &mut ChaCha8Rng::seed_from_u64(seed));
        let mut session = session(&chain, &unknowns, &truth, 12, 2e-5, 40 + seed);
        let repeated: Vec<_> = (0..90).map(|k| session.measured[k % 3]).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        session.measured.extend(repeated.into_iter().enumerate().map(|(k, m)| {
            let noise = Vector3::from_fn(|_, _| 2e-5 * normal(&mut rng));
            MeasuredPosition { row: 13 + k, position: m.position + noise, ..m }
        }));
        let found = gross_errors(&chain, &[session], &unknowns, &default_priors(&chain, &unknowns)).remove(0);
        assert!(found.errors.is_empty(), "seed {seed}: {found:?}");
    }
}

/// A gross error in a test does not condemn the other positions.
#[test]
fn a_gross_error_in_a_test_is_the_only_outlier() {
    let (_, robot) = robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let chain = Chain::new(&without_tool(robot));
    let unknowns = unknowns(&chain, false);
    let truth = truth(&chain, &unknowns, &mut ChaCha8Rng::seed_from_u64(3));
    let result = calibrated(&chain, &session(&chain, &unknowns, &truth, 80, 2e-5, 1), &unknowns);
    let mut other = session(&chain, &unknowns, &truth, 60, 2e-5, 2);
    let (clean, share) = result.tested(&other.measured).unwrap();
    assert!(clean.outliers.is_empty() && share > 0.85, "{share}");
    other.measured[20].position.z += 0.3;
    let (spoiled, share) = result.tested(&other.measured).unwrap();
    assert_eq!(spoiled.outliers.iter().map(|(row, _)| *row).collect::<Vec<_>>(), [21]);
    assert!(share > 0.85, "{share}");
    for (k, (own, before)) in spoiled.distances.iter().zip(&clean.distances).enumerate() {
        assert!(k == 20 || (own - before).abs() < 5e-5, "{k}: {own} instead of {before}");
    }
}
