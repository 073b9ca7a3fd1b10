//! Tests the best fit of the robot base, which has a closed form, against sums over many postures.

use crate::common::{cases, robots, shipped, signed};
use crate::readings::registration::all_wrong_with;
use nalgebra::{Matrix3, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::*;
use sweetspot::kinematic_error::{Perturbation, position_error};
use sweetspot::layout::Workcell;
use sweetspot::reading::{BestFit, Effects, ErrorSources};
use sweetspot::robot::{Chain, Frames};

/// Returns postures between the joint limits by the Kronecker sequence of the square roots of the primes.
fn spread_postures(robot: &Robot, chain: &Chain, count: usize) -> Vec<Frames> {
    let primes = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0_f64];
    let joints = |k: usize| -> JointVector {
        std::array::from_fn(|i| {
            let Some(Joint { limits: (low, high), .. }) = robot.joints.get(i) else { return 0.0 };
            low + (high - low) * (0.5 + k as f64 * primes[i].sqrt()).fract()
        })
    };
    (0..count).map(|k| chain.frames(&chain.posture(&joints(k)))).collect()
}

/// Returns the root mean square of the lengths of vectors.
fn rms(vectors: impl ExactSizeIterator<Item = Vector3<f64>>) -> f64 {
    let count = vectors.len() as f64;
    (vectors.map(|v| v.norm_squared()).sum::<f64>() / count).sqrt()
}

/// Returns the rotation and the two centres of the rigid motion that Kabsch's method (singular value
/// decomposition) fits.
fn kabsch(nominal: &[Vector3<f64>], moved: &[Vector3<f64>]) -> (Matrix3<f64>, Vector3<f64>, Vector3<f64>) {
    let mean = |points: &[Vector3<f64>]| points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let (from, to) = (mean(nominal), mean(moved));
    let pairs = nominal.iter().zip(moved);
    let h = pairs.fold(Matrix3::zeros(), |h, (a, b)| h + (b - to) * (a - from).transpose());
    let svd = h.svd(true, true);
    let (u, vt) = (svd.u.unwrap(), svd.v_t.unwrap());
    let sign = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * vt).determinant()));
    (u * sign * vt, from, to)
}

/// The closed form of the fitted base agrees with Kabsch's method over ten thousand postures of every robot
/// of the library. The tolerance is a hundredth of the error that the fit leaves.
#[test]
fn the_best_fit_agrees_with_kabsch_over_the_workspace() {
    let mut rng = ChaCha8Rng::seed_from_u64(53);
    for (name, robot) in robots() {
        let cell = all_wrong_with(robot, &mut rng);
        let chain = Chain::new(&cell.robot);
        let fit = BestFit::new(&chain, &ErrorSources::new(&cell, 0, None), false);
        let errors = Perturbation::new(&chain, signed(&cell));
        let postures = spread_postures(&cell.robot, &chain, cases(30_000, 100_000));
        for model in [Model::Nonlinear, Model::SecondOrder] {
            let motion = fit.motion(&errors, model);
            let nominal: Vec<_> = postures.iter().map(|f| f.tcp.translation).collect();
            let moved: Vec<_> =
                postures.iter().map(|f| f.tcp.translation + position_error(f, &errors, model)).collect();
            let (rotation, from, to) = kabsch(&nominal, &moved);
            let fitted = |p: &Vector3<f64>| to + rotation * (p - from);
            let left = rms(nominal.iter().zip(&moved).map(|(p, moved)| moved - fitted(p)));
            let off = rms(postures.iter().map(|frames| {
                let p = frames.tcp.translation;
                p + motion.at(&fit.arm(frames)).position - fitted(&p)
            }));
            assert!(left > 1e-5 && off < 0.01 * left, "{name} {model:?}: {off} of {left}");
        }
    }
}

/// The parts of the effects that the fitted base removes agree with least squares over ten thousand postures
/// of every robot of the library. The tolerance is a hundredth of the effects.
#[test]
fn the_fitted_effects_agree_with_least_squares_over_the_workspace() {
    let mut rng = ChaCha8Rng::seed_from_u64(55);
    for (name, robot) in robots() {
        let cell = all_wrong_with(robot, &mut rng);
        let chain = Chain::new(&cell.robot);
        let sources = ErrorSources::new(&cell, 0, None);
        let fit = BestFit::new(&chain, &sources, true);
        let postures = spread_postures(&cell.robot, &chain, cases(30_000, 100_000));
        let count = postures.len() as f64;
        let centre = postures.iter().map(|f| f.tcp.translation).sum::<Vector3<f64>>() / count;
        let (mut inertia, mut expansion) = (Matrix3::zeros(), sources.expansion(&chain));
        // Sums of d, r x d and |d|^2 of every source, and of the mean.
        let mut sums = vec![(Vector3::zeros(), Vector3::zeros(), 0.0); sources.list.len() + 1];
        for frames in &postures {
            let r = frames.tcp.translation - centre;
            inertia += Matrix3::identity() * r.norm_squared() - r * r.transpose();
            let mut effects = Effects::default();
            expansion.set(frames);
            effects.set(&sources, &expansion, true);
            let columns = effects.columns[..sources.list.len()].iter().chain([&effects.mean]);
            for (sum, d) in sums.iter_mut().zip(columns) {
                *sum = (sum.0 + d.position, sum.1 + r.cross(&d.position), sum.2 + d.position.norm_squared());
            }
        }
        let columns = fit.effects.columns[..sources.list.len()].iter().chain([&fit.effects.mean]);
        for (k, ((shift, moment, square), got)) in sums.iter().zip(columns).enumerate() {
            let turn = inertia.try_inverse().unwrap() * moment;
            let off = rms(postures.iter().map(|frames| {
                let expected = shift / count + turn.cross(&(frames.tcp.translation - centre));
                got.linear_at(&fit.arm(frames)).position - expected
            }));
            let size = (square / count).sqrt();
            assert!(off < 0.01 * size + 1e-12, "{name}, source {k}: {off} of {size}");
        }
    }
}

/// A fit over 64 postures is not converged: the least signed error of the paper's table is 1.954 mm, not 2.23
/// mm.
#[test]
fn the_least_error_of_the_paper_with_a_fitted_base_is_converged() {
    let mut cell = shipped("hitachi_paper.toml");
    cell.registration = Registration::BestFit;
    let workcell = Workcell::new(cell.clone()).unwrap();
    let map = workcell.maps(&cell.start()).remove(0);
    let chain = Chain::new(&cell.robot);
    let errors = Perturbation::new(&chain, signed(&cell));
    let at =
        |f: &Frames| (f.tcp.translation, f.tcp.translation + position_error(f, &errors, Model::Nonlinear));
    let (nominal, moved): (Vec<_>, Vec<_>) =
        spread_postures(&cell.robot, &chain, 50_000).iter().map(at).unzip();
    let (rotation, from, to) = kabsch(&nominal, &moved);
    let mut least = f64::INFINITY;
    for posture in map.nodes.iter().filter_map(|node| node.posture.as_ref()) {
        let (p, moved) = at(&chain.frames(&chain.posture(&posture.joints)));
        let left = (rotation.transpose() * (moved - to) - (p - from)).norm();
        assert!((posture.value - left).abs() < 0.01 * left, "{} {left}", posture.value);
        least = least.min(left);
    }
    assert!((map.value.unwrap() - least).abs() < 0.01 * least, "{:?} {least}", map.value);
    assert!((least - 1.954e-3).abs() < 0.015e-3, "{least}");
}
