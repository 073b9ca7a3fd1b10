//! Tests first and second derivatives of the pose against the D-H product in hyper-dual numbers, and the
//! second-order model that uses these derivatives.

use crate::common::cases;
use crate::kinematics::errors::{predicted, random_errors, random_robot};
use crate::kinematics::product::{product, random_joints};
use nalgebra::{Matrix3, Matrix4, Vector3, vector};
use num_dual::HyperDual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::array::from_fn;
use std::f64::consts::FRAC_PI_2;
use sweetspot::cell::{JointVector, Model, Parameter, Robot, SignedErrors};
use sweetspot::kinematic_error::{Expansion, Perturbation, pose_error};
use sweetspot::pose::Displacement;
use sweetspot::robot::Chain;

/// Kinds of degenerate postures.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Degeneracy {
    Random,
    /// Every angle is zero.
    Zero,
    /// Every axis is parallel to the first.
    Parallel,
    /// All axes lie on one line, so the TCP can move only perpendicular to it.
    Stretched,
    /// All axes meet in one point, and every second axis lies on the same line, as in a straight wrist.
    Aligned,
    /// All axes meet in one point, and the TCP lies there.
    Collapsed,
}

const CASES: [Degeneracy; 6] = [
    Degeneracy::Random,
    Degeneracy::Zero,
    Degeneracy::Parallel,
    Degeneracy::Stretched,
    Degeneracy::Aligned,
    Degeneracy::Collapsed,
];

/// Returns a robot of `n` axes with couplings and prismatic joints, and a posture.
fn posed(rng: &mut ChaCha8Rng, n: usize, case: Degeneracy) -> (Robot, JointVector) {
    let mut robot = random_robot(rng, n, case == Degeneracy::Parallel);
    let q = random_joints(&robot, rng);
    if matches!(case, Degeneracy::Random | Degeneracy::Parallel) {
        return (robot, q);
    }
    for (i, joint) in robot.joints.iter_mut().enumerate() {
        joint.theta = 0.0;
        match case {
            Degeneracy::Stretched => (joint.r, joint.alpha) = (0.0, 0.0),
            Degeneracy::Aligned | Degeneracy::Collapsed => {
                (joint.r, joint.l, joint.alpha) = (0.0, 0.0, if i % 2 == 0 { FRAC_PI_2 } else { -FRAC_PI_2 })
            }
            _ => {}
        }
    }
    match case {
        Degeneracy::Stretched => robot.tool.translation = vector![0.2, 0.0, 0.0],
        Degeneracy::Collapsed => robot.tool.translation = Vector3::zeros(),
        _ => {}
    }
    (robot, JointVector::default())
}

/// Returns the displacement of the TCP in one part of the dual numbers. The rotation vector follows from the
/// antisymmetric part of `R' R^T = exp [phi]`. This part contains `[phi]` and terms of third order, which do
/// not affect second derivatives.
fn part(t: &Matrix4<HyperDual64>, of: impl Fn(&HyperDual64) -> f64, position: Vector3<f64>) -> Displacement {
    let get = |f: &dyn Fn(&HyperDual64) -> f64| Matrix3::from_fn(|i, k| f(&t[(i, k)]));
    let spin = get(&of) * get(&|x| x.re).transpose();
    let rotation = vector![spin.m32 - spin.m23, spin.m13 - spin.m31, spin.m21 - spin.m12] / 2.0;
    Displacement { position, rotation }
}

/// Returns the largest difference of a component. NaN counts as infinite.
fn off(a: Displacement, b: Displacement) -> f64 {
    let d = a - b;
    let size = |x: &f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
    d.position.iter().chain(&d.rotation).map(size).fold(0.0, f64::max)
}

/// Returns the largest differences of a first and of a second derivative.
fn worst(robot: &Robot, q: &JointVector, expansion: &mut Expansion) -> (f64, f64) {
    let chain = Chain::new(robot);
    expansion.set(&chain.frames(&chain.posture(q)));
    let count = Parameter::first_elastic(robot.axes());
    let (mut first, mut second) = (0f64, 0f64);
    for (j, k) in (0..count).flat_map(|j| (j..count).map(move |k| (j, k))) {
        let mut values = vec![HyperDual64::from(0.0); count];
        values[j].eps1 = 1.0;
        values[k].eps2 = 1.0;
        let t = product(robot, q, &values);
        let column = |of: fn(&HyperDual64) -> f64| {
            part(&t, of, vector![of(&t[(0, 3)]), of(&t[(1, 3)]), of(&t[(2, 3)])])
        };
        first = first.max(off(expansion.first(j), column(|x| x.eps1)));
        let want = column(|x| x.eps1eps2);
        second = second.max(off(expansion.second(j, k), want)).max(off(expansion.second(k, j), want));
    }
    (first, second)
}

/// The derivatives of chains of a few metres agree to 1e-13 (m or rad, per m or rad of each parameter).
/// Typical differences are 4e-15.
#[test]
fn every_derivative_agrees_with_dual_numbers() {
    let robots = 8 * cases(12, 48);
    let off = (0..robots).into_par_iter().map(|k| {
        let mut rng = ChaCha8Rng::seed_from_u64(100 + k as u64);
        let (n, round) = (1 + k % 8, k / 8);
        let case = if round % 2 == 0 { Degeneracy::Random } else { CASES[round / 2 % 6] };
        let (robot, q) = posed(&mut rng, n, case);
        let chain = Chain::new(&robot);
        // The expansion is first set to another posture, so that reused memory is tested.
        let mut expansion = Expansion::new(&chain);
        expansion.set(&chain.frames(&chain.posture(&[0.3; 8])));
        let (first, second) = worst(&robot, &q, &mut expansion);
        assert!(first < 1e-13 && second < 1e-13, "{case:?}, {n} axes: {first:e}, {second:e}");
        (first, second)
    });
    let off: Vec<_> = off.collect();
    let largest = |which: fn(&(f64, f64)) -> f64| off.iter().map(which).fold(0.0, f64::max);
    println!("largest difference: first {:.1e}, second {:.1e}", largest(|x| x.0), largest(|x| x.1));
}

/// The expansion of some parameters equals the corresponding part of the expansion of all parameters, also
/// with joint coupling.
#[test]
fn derivatives_of_some_parameters_equal_those_among_all() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for k in 0..80 {
        let (robot, q) = posed(&mut rng, 1 + k % 8, Degeneracy::Random);
        let (chain, count) = (Chain::new(&robot), Parameter::count(robot.axes()));
        let some: Vec<usize> = (0..count).filter(|_| rng.random_bool(0.2)).collect();
        let [mut all, mut few] = [Expansion::new(&chain), Expansion::of(&chain, &some)];
        let frames = chain.frames(&chain.posture(&q));
        all.set(&frames);
        few.set(&frames);
        for (&j, &k) in some.iter().flat_map(|j| some.iter().map(move |k| (j, k))) {
            assert_eq!((few.first(j), few.second(j, k)), (all.first(j), all.second(j, k)));
        }
    }
}

fn values(errors: &SignedErrors, size: f64) -> Vec<f64> {
    errors.values().iter().map(|v| v * size).collect()
}

/// Every parameter has an error, including base and tool.
#[test]
fn the_second_order_model_agrees_with_its_derivatives() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for k in 0..240 {
        let n = 1 + k % 8;
        let (robot, q) = posed(&mut rng, n, CASES[k / 8 % 6]);
        let errors = random_errors(&mut rng, n, 1e-2, 1e-2);
        let chain = Chain::new(&robot);
        let mut expansion = Expansion::new(&chain);
        expansion.set(&chain.frames(&chain.posture(&q)));
        let e = values(&errors, 1.0);
        let all = || 0..e.len();
        let first = all().fold(Displacement::NONE, |sum, j| sum + expansion.first(j) * e[j]);
        let pairs = all().flat_map(|j| all().map(move |k| (j, k)));
        let whole = pairs.fold(first, |sum, (j, k)| sum + expansion.second(j, k) * (0.5 * e[j] * e[k]));
        for (model, want) in [(Model::Linear, first), (Model::SecondOrder, whole)] {
            let got = predicted(&robot, &q, &errors, model);
            assert!(off(got, want) < 1e-12, "{model:?}: {got:?} instead of {want:?}");
        }
    }
}

/// If the errors are halved, the remainder is divided by eight for the second-order model and by four for the
/// linear model.
#[test]
fn error_models_converge_with_their_order() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    for k in 0..240 {
        let n = 1 + k % 8;
        let (robot, q) = posed(&mut rng, n, CASES[k / 8 % 6]);
        let errors = random_errors(&mut rng, n, 1.0, 1.0);
        let chain = Chain::new(&robot);
        let frames = chain.frames(&chain.posture(&q));
        let gap = |model: Model, size: f64| {
            let errors = Perturbation::of_values(&chain, &values(&errors, size));
            pose_error(&frames, &errors, model) - pose_error(&frames, &errors, Model::Nonlinear)
        };
        for (model, factor) in [(Model::Linear, 4.0), (Model::SecondOrder, 8.0)] {
            let [whole, half] = [1e-3, 5e-4].map(|size| gap(model, size));
            let parts: [(f64, f64); 2] = [
                (whole.position.norm(), half.position.norm()),
                (whole.rotation.norm(), half.rotation.norm()),
            ];
            for (whole, half) in parts {
                assert!((whole / half / factor - 1.0).abs() < 0.02, "{model:?}: {whole:e} to {half:e}");
            }
        }
    }
}

/// Rz(a) Tx(l) gives p = l (cos a, sin a, 0), differentiated by hand.
#[test]
fn second_derivatives_of_one_link_match_hand_calculation() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut robot, _) = posed(&mut rng, 1, Degeneracy::Stretched);
    robot.joints[0].kind = sweetspot::cell::JointKind::Revolute;
    robot.joints[0].l = rng.random_range(0.1..1.0);
    let reach = robot.joints[0].l + 0.2;
    let chain = Chain::new(&robot);
    let mut expansion = Expansion::new(&chain);
    expansion.set(&chain.frames(&chain.posture(&from_fn(|_| 0.0))));
    let [dq, dl] = [0, 2];
    let near = |a: Vector3<f64>, b: Vector3<f64>| assert!((a - b).norm() < 1e-15, "{a:?} {b:?}");
    near(expansion.first(dq).position, vector![0.0, reach, 0.0]);
    near(expansion.second(dq, dq).position, vector![-reach, 0.0, 0.0]);
    near(expansion.second(dl, dq).position, vector![0.0, 1.0, 0.0]);
    near(expansion.second(dl, dl).position, Vector3::zeros());
    // Rz(a) Rx(b) turns by (b, 0, a) + (0, a b, 0) / 2.
    near(expansion.second(dq, 3).rotation, vector![0.0, 0.5, 0.0]);
}
