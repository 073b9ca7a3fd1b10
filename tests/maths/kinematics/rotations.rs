//! Tests small motions: exponential map, logarithm and their laws from 1e-300 rad to half a turn.

use nalgebra::{Matrix3, Matrix4, Rotation3, UnitQuaternion, Vector3, vector};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use sweetspot::pose::{Displacement, SmallRotation};
use sweetspot::reach::{least_turn, rotation_vector};

const ANGLES: [f64; 12] =
    [0.0, 1e-300, 1e-160, 1e-154, 1e-16, 1e-8, 1e-4, 1.0, PI - 1e-4, PI - 1e-8, PI - 1e-12, PI];

fn unit(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0f64)).normalize()
}

fn within(rng: &mut ChaCha8Rng, bound: f64) -> Vector3<f64> {
    Vector3::from_fn(|_, _| rng.random_range(-bound..bound))
}

/// Returns `(R - 1) p` to full relative accuracy by Rodrigues' formula with the versine of the half angle.
fn rodrigues(axis: &Vector3<f64>, angle: f64, p: &Vector3<f64>) -> Vector3<f64> {
    let across = axis.cross(p);
    across * angle.sin() + axis.cross(&across) * (2.0 * (angle / 2.0).sin().powi(2))
}

fn assert_near(got: Vector3<f64>, want: Vector3<f64>, tolerance: f64, what: &str) {
    // NaN fails the comparison.
    let holds = got.iter().zip(&want).all(|(g, w)| (g - w).abs() <= tolerance);
    assert!(holds, "{what}: {got:?} instead of {want:?}, tolerance {tolerance:e}");
}

#[test]
fn the_rotation_logarithm_undoes_the_exponential() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    for (angle, _) in ANGLES.into_iter().flat_map(|a| (0..200).map(move |k| (a, k))) {
        let axis = unit(&mut rng);
        let vector = axis * angle;
        for rotation in [SmallRotation::of(&vector), SmallRotation::about(&axis, angle)] {
            let back = rotation.vector();
            // The logarithm of half a turn may be half a turn in the other direction.
            let back = if angle == PI && back.dot(&vector) < 0.0 { -back } else { back };
            assert_near(back, vector, 1e-15 * angle, "log exp");
        }
    }
    assert_eq!(SmallRotation::of(&Vector3::zeros()), SmallRotation::none());
    assert_eq!(SmallRotation::none().vector(), Vector3::zeros());
}

#[test]
fn rotations_past_half_a_turn_take_the_shorter_way() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for beyond in [1e-12, 1e-8, 1e-4, 1.0, 3.0, PI] {
        for _ in 0..100 {
            let axis = unit(&mut rng);
            let got = SmallRotation::of(&(axis * (PI + beyond))).vector();
            assert_near(got, axis * (beyond - PI), 2e-15, "the short way");
        }
    }
}

#[test]
fn points_move_by_rodrigues_formula() {
    let mut rng = ChaCha8Rng::seed_from_u64(22);
    for (angle, _) in ANGLES.into_iter().flat_map(|a| (0..200).map(move |k| (a, k))) {
        let (axis, arm) = (unit(&mut rng), within(&mut rng, 1.0));
        let moved = SmallRotation::of(&(axis * angle)).moved(&arm);
        // The relative tolerance is 1e-15, and the chord is up to 2 |arm|.
        assert_near(moved, rodrigues(&axis, angle, &arm), 2e-15 * angle.min(2.0), "moved");
        let turned = Rotation3::new(axis * angle) * arm;
        assert_near(moved + arm, turned, 2e-15, "against nalgebra");
    }
}

/// Values of log(exp(a) exp(b)), computed with 60 digits (mpmath, quaternions) for a and b as stored in f64.
#[allow(clippy::approx_constant)] // near to half a turn on purpose
const PRODUCTS: [([f64; 3], [f64; 3], [f64; 3]); 12] = [
    ([1e-300, 0.0, 0.0], [0.0, 2e-300, 0.0], [1e-300, 2e-300, 0.0]),
    ([1e-160, -2e-160, 3e-160], [1e-160, 1e-160, 0.0], [2e-160, -1e-160, 3e-160]),
    (
        [1e-16, 2e-16, -3e-16],
        [-2e-16, 1e-16, 1e-16],
        [-9.999999999999997e-17, 3.0000000000000004e-16, -1.9999999999999997e-16],
    ),
    (
        [3e-8, -1e-8, 2e-8],
        [1e-8, 4e-8, -2e-8],
        [3.999999969999999e-08, 3.00000004e-08, 6.499999988333333e-16],
    ),
    (
        [2e-4, 1e-4, -3e-4],
        [-1e-4, 3e-4, 1e-4],
        [0.00010004999916658332, 0.0004000049949166583, -0.00019996499808339164],
    ),
    ([0.5, -1.0, 0.25], [0.75, 0.5, -0.5], [1.2756462469384555, -0.24081230733668932, 0.2762609524050155]),
    (
        [0.6, 0.8, -0.4],
        [-0.6, -0.8, 0.400000001],
        [3.2505480606127333e-10, -3.2242246628929223e-10, 8.427372484279725e-10],
    ),
    ([2.0, 0.0, 0.0], [1.1415, 0.0, 0.0], [3.1415, 0.0, 0.0]),
    ([2.0, 0.0, 0.0], [1.14159265358, 0.0, 0.0], [3.14159265358, 0.0, 0.0]),
    ([0.0, 0.0, 2.5], [0.0, 0.0, 2.5], [0.0, 0.0, -1.2831853071795865]),
    (
        [0.0, 2.0, 0.0],
        [1.141592653589793, 0.0, 2.0],
        [2.522647044863262, 0.9476098534915884, 0.13161714789857515],
    ),
    ([1.5, 1.5, 1.5], [1.0, 1.5, 2.0], [-0.6784838651195596, -0.14390314939770812, -0.8834681460339734]),
];

#[test]
fn composed_rotations_agree_with_60_digits() {
    for (a, b, want) in PRODUCTS {
        let [a, b, want] = [a, b, want].map(Vector3::from);
        let got = SmallRotation::of(&a).after(&SmallRotation::of(&b)).vector();
        assert_near(got, want, 1e-15 * (a.norm() + b.norm()), "product");
    }
}

/// The product of any two rotations is finite, at most half a turn, and equal to the product of nalgebra's
/// quaternions.
#[test]
fn no_composed_rotation_is_nan() {
    let mut rng = ChaCha8Rng::seed_from_u64(23);
    for (a, b) in ANGLES.into_iter().flat_map(|a| ANGLES.map(|b| (a, b))) {
        // The two axes are either equal, so that rotations add or cancel, or arbitrary.
        let axis = unit(&mut rng);
        for (a, b) in [(axis * a, axis * b), (axis * a, axis * -b), (axis * a, unit(&mut rng) * b)] {
            let product = SmallRotation::of(&a).after(&SmallRotation::of(&b));
            let (got, arm) = (product.vector(), within(&mut rng, 1.0));
            assert!(got.norm() <= PI * (1.0 + 1e-15), "{a:?} {b:?}: {got:?}");
            let want = UnitQuaternion::from_scaled_axis(a) * UnitQuaternion::from_scaled_axis(b);
            assert_near(product.moved(&arm), want * arm - arm, 4e-15, "product");
            assert_near(SmallRotation::of(&got).moved(&arm), want * arm - arm, 4e-15, "its logarithm");
        }
    }
}

fn matrix(d: &Displacement) -> Matrix4<f64> {
    Rotation3::new(d.rotation).to_homogeneous().append_translation(&d.position)
}

fn assert_same(got: &Displacement, want: &Matrix4<f64>, what: &str) {
    let off = matrix(got) - want;
    assert!(off.iter().all(|x| x.abs() < 1e-14), "{what}: {got:?} is off by {off}");
}

/// The methods `then`, `inverse` and `at` agree with products of 4 x 4 matrices.
#[test]
fn displacements_compose_as_matrices() {
    let mut rng = ChaCha8Rng::seed_from_u64(24);
    for (a, b) in ANGLES.into_iter().flat_map(|a| ANGLES.map(|b| (a, b))) {
        let [a, b] =
            [a, b].map(|t| Displacement { position: within(&mut rng, 1.0), rotation: unit(&mut rng) * t });
        assert_same(&a.then(&b), &(matrix(&b) * matrix(&a)), "then");
        let back = matrix(&a).try_inverse().unwrap();
        assert_same(&a.inverse(), &back, "inverse");
        assert_same(&a.then(&a.inverse()), &Matrix4::identity(), "there and back");
        let arm = within(&mut rng, 1.0);
        let shift = |by: &Vector3<f64>| Matrix4::new_translation(by);
        assert_same(&a.at(&arm), &(shift(&-arm) * matrix(&a) * shift(&arm)), "at");
        let axes = Rotation3::new(unit(&mut rng) * rng.random_range(0.0..PI));
        let turned = axes.to_homogeneous() * matrix(&a) * axes.inverse().to_homogeneous();
        assert_same(&a.turned(axes.matrix()), &turned, "turned");
    }
}

/// Displacements of nanometres and nanoradians keep their digits, because no number of order 1 is involved.
#[test]
fn small_displacements_keep_their_digits() {
    let mut rng = ChaCha8Rng::seed_from_u64(25);
    for (size, _) in [1e-6, 1e-9, 1e-12, 1e-100].into_iter().flat_map(|s| (0..200).map(move |k| (s, k))) {
        let mut some = || Displacement { position: unit(&mut rng) * size, rotation: unit(&mut rng) * size };
        let (a, b) = (some(), some());
        let arm = within(&mut rng, 1.0);
        let angle = b.rotation.norm();
        let carried = rodrigues(&(b.rotation / angle), angle, &a.position);
        assert_near(a.then(&b).position, a.position + b.position + carried, 1e-15 * size, "then");
        let swept = rodrigues(&(b.rotation / angle), angle, &arm);
        assert_near(b.at(&arm).position, b.position + swept, 2e-15 * size, "at");
        assert_near(b.at(&arm).at(&-arm).position, b.position, 2e-15 * size, "there and back");
        // By the Baker-Campbell-Hausdorff formula, the remainder is of third order.
        let want = a.rotation + b.rotation + b.rotation.cross(&a.rotation) / 2.0;
        let tolerance = (1e-15 + size * size) * size;
        assert_near(a.then(&b).rotation, want, tolerance, "rotation");
        assert_near(a.then(&a.inverse()).position, vector![0.0, 0.0, 0.0], 1e-15 * size, "undone");
        assert_near(a.linear_at(&arm).position, a.position + a.rotation.cross(&arm), 1e-15 * size, "linear");
    }
}

#[test]
fn the_matrix_logarithm_undoes_the_exponential_at_every_angle() {
    let axes = [vector![1.0, 0.0, 0.0], vector![0.6, 0.0, -0.8], vector![-2.0, 3.0, 6.0] / 7.0];
    for (axis, angle) in axes
        .iter()
        .flat_map(|a| [0.0, 1e-200, 1e-12, 1e-8, 1e-3, 1.0, 3.0, PI - 1e-3, PI - 1e-8].map(|x| (a, x)))
    {
        let m = Rotation3::new(axis * angle).into_inner();
        let off = (rotation_vector(&m) - axis * angle).norm();
        assert!(off <= 1e-15 + 4e-16 * angle, "{angle} about {axis:?}: {off:e}");
    }
    for axis in axes {
        let half = 2.0 * axis * axis.transpose() - Matrix3::identity();
        let got = rotation_vector(&half);
        assert!((got.norm() - PI).abs() < 1e-15 && got.cross(&axis).norm() < 1e-14, "{got:?}");
    }
}

#[test]
fn the_shortest_rotation_carries_one_vector_onto_the_other() {
    let from = vector![0.6, 0.0, -0.8];
    for to in [from, -from, vector![0.0, 1.0, 0.0], vector![0.6, 1e-9, -0.8].normalize()] {
        let turn = least_turn(&from, &to);
        assert!((Rotation3::new(turn) * from - to).norm() < 2e-16 * 4.0);
        assert!((turn.norm() - from.angle(&to)).abs() < 2e-8, "{turn:?}");
    }
}
