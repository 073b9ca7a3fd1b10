//! Tests the farthest vertex of a zonotope against all corners, and the methods against each other.

use crate::common::cases;
use nalgebra::{Rotation2, Rotation3, SVector, Vector2, Vector3, Vector6};
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use sweetspot::reading::zonotope::*;

type Set<const M: usize> = Vec<SVector<f64, M>>;

/// Returns the distance of the farthest corner. The corners are visited in Gray code order, and every 64th
/// sum is computed afresh.
fn brute<const M: usize>(set: &Set<M>) -> f64 {
    let mut best = 0.0;
    let mut sum = SVector::<f64, M>::zeros();
    for step in 0..1_usize << set.len().saturating_sub(1) {
        let gray = step ^ step >> 1;
        let sign = |k: usize| if gray >> k & 1 == 0 { 1.0 } else { -1.0 };
        if step % 64 == 0 {
            sum = set.iter().enumerate().map(|(k, g)| g * sign(k)).sum();
        } else {
            let k = step.trailing_zeros() as usize;
            sum += set[k] * (2.0 * sign(k));
        }
        best = f64::max(best, sum.norm_squared());
    }
    best.sqrt()
}

/// Runs the solver of this dimension with a sign buffer that is too long and filled with garbage.
fn solve<const M: usize>(set: &Set<M>, scratch: &mut ZonotopeScratch) -> (Farthest, Vec<f64>) {
    let n = set.len();
    let mut signs = vec![7.0; n + 1];
    let found = match M {
        1 => farthest_1(&set.iter().map(|g| g[0]).collect::<Vec<_>>(), &mut signs),
        2 => farthest_2(&resized(set), scratch, &mut signs),
        3 => farthest_3(&resized(set), scratch, &mut signs),
        _ => farthest_6(&resized(set), scratch, &mut signs),
    };
    assert_eq!(signs.pop(), Some(7.0), "wrote past the generators");
    (found, signs)
}

/// Returns the generators truncated to `K` components, or extended with zeros.
fn resized<const M: usize, const K: usize>(set: &Set<M>) -> Set<K> {
    set.iter().map(|g| SVector::from_fn(|d, _| if d < M { g[d] } else { 0.0 })).collect()
}

fn assert_close(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a - b).abs() <= tolerance * b.abs(), "{what}: {a:e} instead of {b:e}");
}

/// Checks every documented property of a result, except that the vertex is the farthest.
fn check_promises<const M: usize>(set: &Set<M>, scratch: &mut ZonotopeScratch, what: &str) -> Farthest {
    let (found, signs) = solve(set, scratch);
    assert!(found.value.is_finite() && found.upper >= found.value, "{what}: {found:?}");
    let zero = SVector::<f64, M>::zeros();
    let mut first = None;
    for (g, s) in set.iter().zip(&signs) {
        assert!(s.abs() == 1.0, "{what}: sign {s}");
        assert!(*g != zero || *s == 1.0, "{what}: sign of nothing");
        first = first.or((*g != zero).then_some(*s));
    }
    assert_eq!(first.unwrap_or(1.0), 1.0, "{what}: overall sign");
    let sum: SVector<f64, M> = set.iter().zip(&signs).map(|(g, s)| g * *s).sum();
    assert_close(found.value, sum.norm(), 1e-15 * set.len() as f64, &format!("{what}: value at the corner"));
    assert_eq!(
        (found, signs),
        solve(set, &mut ZonotopeScratch::default()),
        "{what}: again with fresh memory"
    );
    found
}

fn check<const M: usize>(set: &Set<M>, scratch: &mut ZonotopeScratch, rng: &mut ChaCha8Rng, what: &str) {
    let what = &format!("{what} of {} in {M}-D", set.len());
    let found = check_promises(set, scratch, what);
    assert_close(found.value, brute(set), 1e-12, what);
    assert_eq!(found.value, found.upper, "{what}: exact");
    let mut mixed = set.clone();
    mixed.shuffle(rng);
    assert_close(solve(&mixed, scratch).0.value, found.value, 1e-14, &format!("{what}: shuffled"));
}

fn random<const M: usize>(rng: &mut ChaCha8Rng, n: usize) -> Set<M> {
    (0..n).map(|_| SVector::from_fn(|_, _| rng.random_range(-1.0..1.0))).collect()
}

fn spoil<const M: usize>(set: &mut Set<M>, rng: &mut ChaCha8Rng, by: f64) {
    for g in set {
        *g += SVector::from_fn(|_, _| by * rng.random_range(-1.0..1.0));
    }
}

/// Returns random combinations of a few directions, so the rank is below the dimension.
fn of_rank<const M: usize>(rng: &mut ChaCha8Rng, n: usize, rank: usize) -> Set<M> {
    let basis = random::<M>(rng, rank);
    (0..n).map(|_| basis.iter().map(|b| b * rng.random_range(-1.0..1.0)).sum()).collect()
}

/// Returns copies of a few directions of any length and either sign.
fn bundles<const M: usize>(rng: &mut ChaCha8Rng, n: usize, directions: usize) -> Set<M> {
    let basis = random::<M>(rng, directions);
    (0..n).map(|k| basis[k % directions] * rng.random_range(-2.0..2.0)).collect()
}

/// Returns one set of `n` generators of each kind.
fn families<const M: usize>(rng: &mut ChaCha8Rng, n: usize) -> Vec<(&'static str, Set<M>)> {
    let mut sets = vec![("general", random(rng, n)), ("collinear", bundles(rng, n, 1))];
    sets.push(("two directions", bundles(rng, n, 2)));
    sets.push(("five directions", bundles(rng, n, 5)));
    sets.push(("rank 2", of_rank(rng, n, 2)));
    sets.push(("rank 3", of_rank(rng, n, 3)));
    for by in [1e-6, 1e-9, 1e-12, 1e-13, 1e-14, 1e-15] {
        for directions in [1, 3, 6] {
            let mut near = bundles(rng, n, directions);
            spoil(&mut near, rng, by);
            sets.push(("nearly parallel", near));
        }
        let mut near = of_rank(rng, n, 2);
        spoil(&mut near, rng, by);
        sets.push(("nearly coplanar", near));
    }
    let mut gaps = random::<M>(rng, n);
    gaps.iter_mut().step_by(3).for_each(|g| g.fill(0.0));
    sets.push(("some zero", gaps));
    sets.push(("all zero", vec![SVector::zeros(); n]));
    sets.push(("tiny", random(rng, n).iter().map(|g| g * 1e-60).collect()));
    let sizes = |k: usize| if k.is_multiple_of(2) { 1.0 } else { 1e-12 };
    sets.push(("sizes 1 and 1e-12", random(rng, n).iter().enumerate().map(|(k, g)| g * sizes(k)).collect()));
    let any = |g: &SVector<f64, M>, e: f64| g * 10f64.powf(e);
    sets.push(("any size", random(rng, n).iter().map(|g| any(g, rng.random_range(-12.0..0.0))).collect()));
    sets.push(("equal length", random::<M>(rng, n).iter().map(|g| g.normalize()).collect()));
    let cube = |k: usize| SVector::from_fn(|d, _| f64::from(d == k % M));
    sets.push(("cube", (0..n).map(cube).collect()));
    // With vectors of a grid, every sum is exact and ties are frequent, as for the edges of a cube or an
    // octahedron.
    let step = |rng: &mut ChaCha8Rng| f64::from(rng.random_range(-1..=1));
    sets.push(("grid", (0..n).map(|_| SVector::from_fn(|_, _| step(rng))).collect()));
    sets
}

fn all_families<const M: usize>(seed: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut scratch = ZonotopeScratch::default();
    // The walk in 3-D begins at 12 generators.
    for n in (0..=14).chain([12, 13, 14].into_iter().cycle().take(60)) {
        for (what, set) in families::<M>(&mut rng, n) {
            check(&set, &mut scratch, &mut rng, what);
        }
    }
}

#[test]
fn collinear_generators_add_up() {
    all_families::<1>(1);
}

#[test]
fn planar_zonotopes_agree_with_all_corners() {
    all_families::<2>(2);
}

#[test]
fn spatial_zonotopes_agree_with_all_corners() {
    all_families::<3>(3);
}

#[test]
fn six_dimensional_zonotopes_agree_with_all_corners() {
    all_families::<6>(6);
}

#[test]
fn random_zonotopes_agree_with_all_corners() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut scratch = ZonotopeScratch::default();
    for k in 0..2000 {
        let n = 1 + k % 12;
        check(&random::<2>(&mut rng, n), &mut scratch, &mut rng, "general");
        check(&random::<3>(&mut rng, n), &mut scratch, &mut rng, "general");
        check(&random::<6>(&mut rng, n), &mut scratch, &mut rng, "general");
    }
}

#[test]
fn sixteen_generators_agree_with_all_corners() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut scratch = ZonotopeScratch::default();
    for _ in 0..20 {
        check(&random::<2>(&mut rng, 16), &mut scratch, &mut rng, "general");
        check(&random::<3>(&mut rng, 16), &mut scratch, &mut rng, "general");
        check(&random::<6>(&mut rng, 16), &mut scratch, &mut rng, "general");
        check(&of_rank::<6>(&mut rng, 16, 4), &mut scratch, &mut rng, "rank 4");
    }
}

/// The effects of a planar arm lie in a plane or along its normal. The plane may have any orientation in
/// space.
#[test]
fn a_perpendicular_generator_adds_as_pythagoras() {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let mut scratch = ZonotopeScratch::default();
    for k in 0..600 {
        let (n, normals) = (2 + k % 13, k % 3);
        let turn = Rotation3::from_euler_angles(0.3 * k as f64, 0.7 * k as f64, 0.1);
        let mut set: Set<3> = of_rank::<2>(&mut rng, n, 2).iter().map(|g| g.push(0.0)).collect();
        for _ in 0..normals {
            let at = rng.random_range(0..set.len());
            set[at] = Vector3::z() * rng.random_range(-1.0..1.0);
        }
        check(&set, &mut scratch, &mut rng, "upright");
        let turned = set.iter().map(|g| turn * g).collect();
        check(&turned, &mut scratch, &mut rng, "turned");
        let straight = solve(&set, &mut scratch).0.value;
        assert_close(solve(&turned, &mut scratch).0.value, straight, 1e-14, "turned as upright");
    }
}

#[test]
fn simple_zonotopes_match_hand_calculation() {
    let mut scratch = ZonotopeScratch::default();
    let mut signs = [0.0; 12];
    let found = farthest_1(&[0.0, -3.0, 2.0, -0.5], &mut signs);
    assert_eq!((found.value, &signs[..4]), (5.5, &[1.0, 1.0, -1.0, 1.0][..]));
    // Twelve edges of the unit cube, four each way, reach the corner (4, 4, 4).
    let cube: Vec<_> = (0..12).map(|k| Vector3::ith(k % 3, if k < 6 { -1.0 } else { 1.0 })).collect();
    assert_close(farthest_3(&cube, &mut scratch, &mut signs).value, 48f64.sqrt(), 1e-15, "cube");
    // Six directions of the edges of an octahedron: the sum with all signs is a corner of the
    // truncated octahedron, (4, 2, 0).
    let ends = [(0, 1, 1.0), (0, 1, -1.0), (0, 2, 1.0), (0, 2, -1.0), (1, 2, 1.0), (1, 2, -1.0)];
    let edges = ends.map(|(a, b, s)| Vector3::ith(a, 1.0) + Vector3::ith(b, s));
    assert_close(farthest_3(&edges, &mut scratch, &mut signs).value, 20f64.sqrt(), 1e-15, "octahedron");
    // The farthest vertex of a regular 16-gon of side 2 lies on its circumscribed circle.
    let sides: Vec<_> = (0..8).map(|k| Rotation2::new(f64::from(k) * PI / 8.0) * Vector2::x()).collect();
    let radius = 1.0 / (PI / 16.0).sin();
    assert_close(farthest_2(&sides, &mut scratch, &mut signs).value, radius, 1e-15, "16-gon");
    assert_eq!(farthest_6(&[], &mut scratch, &mut []).upper, 0.0);
}

/// For sets with too many corners to enumerate, three methods agree.
#[test]
fn both_methods_agree_on_many_generators() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let mut scratch = ZonotopeScratch::default();
    for n in [20, 25, 26, 31, 40, 50, MAX_GENERATORS] {
        let flat = random::<2>(&mut rng, n);
        let found = check_promises(&flat, &mut scratch, "2-D").value;
        let lifted: Set<3> = flat.iter().map(|g| Vector3::new(g.x, 0.6 * g.y, 0.8 * g.y)).collect();
        assert_close(check_promises(&lifted, &mut scratch, "lifted").value, found, 1e-12, "2-D in 3-D");
        // The bend does not change the result noticeably, but prevents the set from being split.
        let bent: Set<3> = lifted.iter().map(|g| g + Vector3::x() * rng.random_range(0.0..1e-13)).collect();
        assert_close(check_promises(&bent, &mut scratch, "bent").value, found, 1e-12, "2-D nearly in 3-D");
        let solid = random::<3>(&mut rng, n);
        let found = check_promises(&solid, &mut scratch, "3-D").value;
        let deep = check_promises(&resized::<3, 6>(&solid), &mut scratch, "3-D in 6-D");
        assert_close(deep.value, found, 1e-12, "3-D in 6-D");
        assert_eq!(deep.value, deep.upper);
    }
}

/// The zonotope of the thirty generators of a robot is solved exactly: none of many random corners is
/// farther.
#[test]
fn six_dimensional_zonotopes_of_a_robot_are_exact() {
    let mut rng = ChaCha8Rng::seed_from_u64(10);
    let mut scratch = ZonotopeScratch::default();
    for _ in 0..10 {
        let set = random::<6>(&mut rng, 30);
        let found = check_promises(&set, &mut scratch, "robot");
        assert_eq!(found.value, found.upper);
        for _ in 0..500 {
            let way: Vector6<f64> = random(&mut rng, 1)[0];
            let mut sum = way;
            for _ in 0..8 {
                sum = set.iter().map(|g| g * 1f64.copysign(g.dot(&sum))).sum();
            }
            assert!(sum.norm() <= found.value * (1.0 + 1e-12));
        }
    }
}

/// NaN and infinity give invalid results, but no panic.
#[test]
fn the_worst_case_handles_nan_and_infinity() {
    let mut scratch = ZonotopeScratch::default();
    let mut signs = [0.0; MAX_GENERATORS];
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for bad in [f64::NAN, f64::INFINITY, f64::MAX, 1e-300] {
        for n in [1, 2, 7, 8, 12, 20, 40, MAX_GENERATORS, 10, 3] {
            let at = rng.random_range(0..n);
            let put = |k: usize| if k == at { bad } else { 1.0 + k as f64 };
            farthest_1(&(0..n).map(put).collect::<Vec<_>>(), &mut signs);
            let mut set = random::<6>(&mut rng, n);
            set[at].fill(bad);
            for all in [false, true] {
                if all {
                    set.fill(Vector6::repeat(bad));
                }
                farthest_2(&resized(&set), &mut scratch, &mut signs);
                farthest_3(&resized(&set), &mut scratch, &mut signs);
                farthest_6(&set, &mut scratch, &mut signs);
            }
        }
    }
}

/// A far vertex is a vertex, and it is nearly as far from the origin as the farthest one. The starting
/// directions are at most 6 deg (2-D) and 30 deg (3-D) from any direction. So the distance is at least the
/// cosine of this angle times the largest distance.
#[test]
fn far_vertices_are_nearly_the_farthest() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    for k in 0..cases(200, 2000) {
        let (rows, n) = ([1, 2, 3, 5][k % 4], rng.random_range(1..=11));
        let component =
            |d: usize, rng: &mut ChaCha8Rng| if d < rows { rng.random_range(-1.0..1.0) } else { 0.0 };
        let set: Set<6> = (0..n).map(|_| Vector6::from_fn(|d, _| component(d, &mut rng))).collect();
        let (found, most) = (far_vertex(&set, rows), brute(&set));
        let sum = |bits: u32| -> Vector6<f64> {
            set.iter().enumerate().map(|(k, g)| if bits >> k & 1 == 1 { -g } else { *g }).sum()
        };
        assert!((0..1u32 << n).any(|bits| (sum(bits) - found).norm() < 1e-12), "{rows}-D: not a vertex");
        let least = [1.0 - 1e-12, 6f64.to_radians().cos(), 30f64.to_radians().cos(), 0.5][k % 4];
        assert!(found.norm() >= least * most, "{rows}-D: {} of {most}", found.norm());
    }
}
