//! Tests the worst case of complete evaluations against every corner of the tolerance box.

use crate::common::{cases, shipped};
use crate::kinematics::product::{no_errors, tcp};
use crate::readings::bench::*;
use nalgebra::{Matrix3, Vector3};
use num_dual::Dual64;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::*;
use sweetspot::kinematic_error::{Perturbation, position_error};
use sweetspot::robot::Chain;
use sweetspot::units::mm_from_m;

/// Returns a sample in which one parameter has the error 1 and all others have none.
pub fn unit(axes: usize, parameter: Parameter) -> SignedErrors {
    let mut e = no_errors(axes);
    match parameter {
        Parameter::Dq(i) => e.dq[i] = 1.0,
        Parameter::Dr(i) => e.dr[i] = 1.0,
        Parameter::Dl(i) => e.dl[i] = 1.0,
        Parameter::Dalpha(i) => e.dalpha[i] = 1.0,
        Parameter::Dbeta(i) => e.dbeta[i] = 1.0,
        Parameter::Base(c) => e.base[c] = 1.0,
        Parameter::Tool(c) => e.tool[c] = 1.0,
        Parameter::Joint(i, c) => e.joints[i][c] = 1.0,
        Parameter::Elastic(..) | Parameter::Compliance(_) | Parameter::Periodic(_) => {
            panic!("not a small motion of constant size")
        }
        Parameter::Equipment(..) => panic!("not of a robot"),
    }
    e
}

/// Returns the effect of each tolerance on the TCP: the derivative of the D-H product by dual numbers.
pub fn columns(robot: &Robot, q: &JointVector, tolerance: &Tolerance) -> Vec<Vector3<f64>> {
    let wrong = Parameter::of_robot(robot.axes()).zip(&tolerance.spreads);
    wrong
        .filter(|(_, spread)| spread.plus_minus > 0.0)
        .map(|(parameter, spread)| {
            let t = tcp(robot, q, &unit(robot.axes(), parameter), Dual64::new(0.0, 1.0));
            Vector3::from_fn(|row, _| t[(row, 3)].eps) * spread.plus_minus
        })
        .collect()
}

/// Returns the largest size over all corners, which are visited in Gray code order, one sign change at a
/// time.
fn brute(columns: &[Vector3<f64>], keep: &Matrix3<f64>) -> f64 {
    let kept: Vec<Vector3<f64>> = columns.iter().map(|c| keep * c).collect();
    let mut signs = vec![1.0; kept.len()];
    let mut sum: Vector3<f64> = kept.iter().sum();
    let mut most = sum.norm();
    for k in 1u64..1 << kept.len().saturating_sub(1) {
        let flip = k.trailing_zeros() as usize;
        signs[flip] = -signs[flip];
        sum += kept[flip] * (2.0 * signs[flip]);
        most = most.max(sum.norm());
    }
    most
}

#[test]
fn the_worst_case_of_random_chains_agrees_with_every_corner() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let axes_of =
        [("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1]), ("xy", [1, 1, 0]), ("xyz", [1, 1, 1])];
    for k in 0..200 {
        let axes = 1 + k % 8;
        let robot = random_robot(&mut rng, axes);
        // Some cases have 2^16 corners, and the others have fewer.
        let wrong = if k % 20 == 0 { 16 } else { rng.random_range(1..=12) };
        let tolerance = random_tolerance(&mut rng, axes, wrong, (2e-3, 2e-2), &[Distribution::Normal]);
        let q = random_joints(&mut rng, &robot);
        let (frames, columns) = (frames_at(&robot, &q), columns(&robot, &q, &tolerance));
        for (name, kept) in axes_of {
            let cell = cell_of(robot.clone(), tolerance.clone(), Sense::plain(name).unwrap());
            let evaluator = gauge_of(&cell);
            let mut memory = evaluator.memory();
            evaluator.prepare(&alone(), &frames, &mut memory);
            let worst = evaluator.worst(&evaluator.sense, &alone(), &frames, &mut memory);
            let keep = Matrix3::from_diagonal(&Vector3::from(kept.map(f64::from)));
            let want = brute(&columns, &keep);
            let scale = columns.iter().map(|c| c.norm()).sum::<f64>();
            assert!(worst.exact);
            assert!(
                (worst.linear - want).abs() <= 1e-12 * want.max(1e-3 * scale),
                "{k} {name}: {} {want}",
                worst.linear
            );
            // The reported corner attains the worst case.
            let at: Vector3<f64> = columns.iter().zip(worst.corner.signs()).map(|(c, s)| keep * c * s).sum();
            assert!((at.norm() - want).abs() <= 1e-12 * scale, "{k} {name}: corner {} {want}", at.norm());
        }
    }
}

/// The paper's Table 3, read as tolerances at its initial position, was computed without this crate.
#[test]
fn the_worst_case_of_table_3_at_the_initial_position_is_exact() {
    let mut cell = shipped("hitachi_paper.toml");
    (cell.reading, cell.model) = (Reading::WorstCase, Model::Linear);
    let frames = frames_at(&cell.robot, &[0.0; MAX_JOINTS]);
    let worst = [("xyz", 15.21437), ("x", 14.781), ("y", 3.0), ("z", 2.0)];
    let rss = [("x", 8.558761), ("y", 1.732051), ("z", 2f64.sqrt())];
    let judge = |name: &str, cell: &mut Cell| {
        cell.operations[0].sense = Sense::plain(name).unwrap();
        let evaluator = gauge_of(cell);
        let mut memory = evaluator.memory();
        evaluator.prepare(&alone(), &frames, &mut memory);
        let worst = evaluator.worst(&evaluator.sense, &alone(), &frames, &mut memory).linear;
        // The root sum square of the tolerances is three times the RMS, because a tolerance is three standard
        // deviations.
        (
            mm_from_m(worst),
            3.0 * mm_from_m(evaluator.norm(&evaluator.sense, &alone(), &frames, &mut memory).rms()),
        )
    };
    for (name, want) in worst {
        let digits = if name == "x" { 5e-4 } else { 5e-6 };
        let (got, _) = judge(name, &mut cell);
        assert!((got - want).abs() <= digits, "{name}: {got} instead of {want}");
    }
    for (name, want) in rss {
        let (_, got) = judge(name, &mut cell);
        assert!((got - want).abs() <= 5e-7, "{name}: {got} instead of {want}");
    }
}

const SENSES: [(&str, [f64; 3]); 5] = [
    ("xyz", [1.0, 1.0, 1.0]),
    ("xy", [1.0, 1.0, 0.0]),
    ("x", [1.0, 0.0, 0.0]),
    ("y", [0.0, 1.0, 0.0]),
    ("z", [0.0, 0.0, 1.0]),
];

/// No corner exceeds the nonlinear worst case by more than the final local search can miss. With the
/// tolerances of the paper, the search misses nothing.
#[test]
fn the_nonlinear_worst_case_agrees_with_every_corner() {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    let mut cell = shipped("hitachi_paper.toml");
    (cell.reading, cell.model) = (Reading::WorstCase, Model::Nonlinear);
    for k in 0..cases(40, 300) {
        // The error sets are Tables 2 and 3. In the plane, several corners have equal values in the linear
        // model.
        let (sense, kept) = SENSES[k / 2 % 5];
        (cell.errors, cell.operations[0].sense) = (k % 2, Sense::plain(sense).unwrap());
        let evaluator = gauge_of(&cell);
        let chain = Chain::new(&cell.robot);
        let (n, mut memory) = (evaluator.sources.list.len(), evaluator.memory());
        assert!(n == 11 || n == 12);
        let frames = frames_at(&cell.robot, &random_joints(&mut rng, &cell.robot));
        evaluator.prepare(&alone(), &frames, &mut memory);
        let worst = evaluator.worst(&evaluator.sense, &alone(), &frames, &mut memory);
        let error = |bits: u32| {
            let values: Vec<f64> = evaluator
                .sources
                .list
                .iter()
                .enumerate()
                .map(|(k, s)| if bits >> k & 1 == 1 { s.plus_minus } else { -s.plus_minus })
                .collect();
            let all: Perturbation = evaluator.sources.perturbation(&chain, &values);
            let e = position_error(&frames, &all, Model::Nonlinear);
            let [x, y, z] = kept;
            Vector3::new(e.x * x, e.y * y, e.z * z).norm()
        };
        let want = (0..1 << n).map(error).fold(0.0, f64::max);
        assert!((worst.by_model - want).abs() <= 1e-12 * want, "{} instead of {want}", worst.by_model);
        // Along one axis, products of errors can matter more than single errors.
        assert!((worst.linear - want).abs() < if sense == "xyz" { 0.02 } else { 0.2 } * want, "{sense}");
    }
}

/// No flip of one or two signs at the worst corner increases the error, if it changes the linear error by
/// less than 1 %. Small linear effects and large rotations make products of errors matter. A search that may
/// end at a given error finds an error above it, or the worst case.
#[test]
fn no_two_flips_increase_the_worst_case_of_many_sources() {
    let mut rng = ChaCha8Rng::seed_from_u64(51);
    let (mut checked, mut partial) = (0, 0);
    for k in 0..cases(60, 600) {
        let axes = rng.random_range(4..=7);
        let robot = random_robot(&mut rng, axes);
        let turned = [1e-3, 8e-3][k % 2];
        let value = |p: Parameter| match p {
            _ if p.is_elastic() || rng.random_bool(0.3) => 0.0,
            Parameter::Dl(_) | Parameter::Dr(_) => rng.random_range(0.0..1e-4),
            Parameter::Tool(component) | Parameter::Base(component) | Parameter::Joint(_, component)
                if component < 3 =>
            {
                1e-4
            }
            _ => rng.random_range(0.0..turned),
        };
        let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
        let sample = SignedErrors::of_values("drawn".into(), axes, &values);
        let (sense, kept) = SENSES[k / 2 % 5];
        let mut cell = cell_of(robot, ErrorSet::Signed(sample).tolerance(), Sense::plain(sense).unwrap());
        (cell.reading, cell.model) = (Reading::WorstCase, Model::Nonlinear);
        let evaluator = gauge_of(&cell);
        let (chain, mut memory) = (Chain::new(&cell.robot), evaluator.memory());
        let list = &evaluator.sources.list;
        for sample in 0..3 {
            let frames = chain.frames(&chain.posture(&chain.halton_sample(3 * k + sample)));
            evaluator.prepare(&alone(), &frames, &mut memory);
            let worst = evaluator.worst(&evaluator.sense, &alone(), &frames, &mut memory);
            let size = |signs: &[f64], model| {
                let values: Vec<f64> = list.iter().zip(signs).map(|(s, sign)| s.plus_minus * sign).collect();
                let e = position_error(&frames, &evaluator.sources.perturbation(&chain, &values), model);
                Vector3::from(kept).component_mul(&e).norm()
            };
            for share in [0.0, 0.99, 0.9999, 1.0, 2.0] {
                let (enough, worst) = (share * worst.by_model, worst.by_model);
                let (found, is_complete) = evaluator.searched_worst(&alone(), &frames, enough, &mut memory);
                assert!(found <= worst && is_complete == (worst <= enough), "{found} {worst} {enough}");
                assert!(if is_complete { found == worst } else { found > enough });
                partial += usize::from(found < worst);
            }
            let mut signs = worst.corner.signs()[..list.len()].to_vec();
            let (least, linear) = (worst.by_model, size(&signs, Model::Linear));
            assert!((size(&signs, Model::Nonlinear) - least).abs() <= 1e-12 * least);
            for i in 0..list.len() {
                for j in i..list.len() {
                    signs[i] = -signs[i];
                    signs[j] = if j == i { signs[j] } else { -signs[j] };
                    let (there, flat) = (size(&signs, Model::Nonlinear), size(&signs, Model::Linear));
                    let is_near = (flat - linear).abs() <= 0.01 * worst.linear;
                    assert!(!is_near || there <= least * (1.0 + 1e-12), "{sense} {i} {j}: {there} {least}");
                    checked += usize::from(is_near);
                    signs[i] = -signs[i];
                    signs[j] = if j == i { signs[j] } else { -signs[j] };
                }
            }
        }
    }
    assert!(checked > 10_000 && partial > 30, "{checked} {partial}");
}
