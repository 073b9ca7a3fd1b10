//! Tests the joint yield of several operations against plain random draws and exact bounds.

use crate::common::shipped;
use crate::readings::norm::near;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::assess::Assessment;
use sweetspot::cell::*;
use sweetspot::layout::Workcell;
use sweetspot::reading::{Estimate, share_of};
use sweetspot::units::m_from_mm;

/// At each end of Wilson's interval, the observed share differs from the end by 1.96 standard deviations.
#[test]
fn the_interval_of_a_share_solves_wilsons_equation() {
    for (count, samples) in [(0, 10), (10, 10), (3, 10), (950, 1000), (65_536, 65_536), (65_500, 65_536)] {
        let Estimate { value, low, high } = share_of(count, samples);
        assert_eq!(value, count as f64 / samples as f64);
        for end in [low, high] {
            let deviation = (end * (1.0 - end) / samples as f64).sqrt();
            let is_exact = end == value;
            assert!(is_exact || ((value - end).abs() / deviation - 1.959964).abs() < 1e-4, "{count} {end}");
        }
        assert!(0.0 <= low && low <= value && value <= high && high <= 1.0 && low < high);
    }
}

/// Returns the cell with two operations, the statistical reading, limits (mm) and errors of the equipment.
fn limited(limits: [f64; 2], errors: [Option<FrameErrors>; 2]) -> Workcell {
    let mut cell = shipped("hitachi_cell.toml");
    (cell.reading, cell.quantity, cell.model) = (Reading::Statistical, Quantity::P99, Model::Nonlinear);
    for k in [0, 1] {
        cell.operations[k].limit = Some(m_from_mm(limits[k]));
        let on = cell.operations[k].equipment;
        cell.equipment[on].errors = errors[k];
    }
    Workcell::new(cell).unwrap()
}

/// Returns the shares of plain random arms that stay within the limits of both operations, of the first and
/// of the second operation. For each arm, each parameter of the robot and of each fixture is drawn once.
fn drawn(a: &Assessment<'_>, count: usize) -> [f64; 3] {
    let mut rng = ChaCha8Rng::seed_from_u64(81);
    let posed = [0, 1].map(|k| {
        let posture = a.maps[k].best_node().unwrap().posture.as_ref().unwrap();
        a.workcell.posed(&a.layout, &a.maps, k, posture).unwrap()
    });
    let mut normal = || -> f64 {
        let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
        radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
    };
    let mut kept = [0; 3];
    for _ in 0..count {
        let mut known: Vec<(Parameter, f64)> = Vec::new();
        let is_kept = [0, 1].map(|k| {
            let (evaluator, (context, frames)) = (a.workcell.evaluator(k), &posed[k]);
            let mut value = |parameter: Parameter, deviation: f64| {
                let found = known.iter().find(|(p, _)| *p == parameter).map(|(_, value)| *value);
                found.unwrap_or_else(|| {
                    known.push((parameter, deviation * normal()));
                    known[known.len() - 1].1
                })
            };
            let values: Vec<f64> =
                evaluator.sources.list.iter().map(|s| value(s.parameter, s.deviation)).collect();
            let propagation = evaluator.propagation();
            let sample = propagation.sample(&values, Model::Nonlinear);
            let error = propagation.error(context, frames, &sample, Model::Nonlinear);
            evaluator.measure(&evaluator.sense, context, frames).size(&error) <= evaluator.limit.unwrap()
        });
        kept[0] += usize::from(is_kept[0] && is_kept[1]);
        kept[1] += usize::from(is_kept[0]);
        kept[2] += usize::from(is_kept[1]);
    }
    kept.map(|kept| kept as f64 / count as f64)
}

/// Returns the joint yield of an assessment and the yields of its two operations.
fn yields(a: &Assessment<'_>) -> [f64; 3] {
    let alone = [0, 1].map(|k| a.samples[k].as_ref().unwrap().success.unwrap().value);
    [a.cell_yield.unwrap().value, alone[0], alone[1]]
}

#[test]
fn the_yield_of_a_cell_agrees_with_random_arms() {
    let spread = |plus_minus: f64| Spread { plus_minus, distribution: Distribution::Normal, sigmas: 3.0 };
    let fixture = |mm: f64| {
        let none = spread(0.0);
        let side = spread(m_from_mm(mm));
        Some(FrameErrors::Tolerance([side, side, side, none, none, none]))
    };
    for (limits, errors) in [
        ([7.0, 9.0], [None, None]),
        ([12.0, 9.0], [fixture(4.0), fixture(6.0)]),
        ([500.0, 8.0], [None, None]),
    ] {
        let workcell = limited(limits, errors);
        let a = Assessment::new("start", &workcell, workcell.cell.start());
        let [together, first, second] = yields(&a);
        let count = 200_000;
        for (estimate, share) in [together, first, second].into_iter().zip(drawn(&a, count)) {
            let scatter = 4.0 * (0.25 / count as f64).sqrt();
            near(estimate, share, scatter + 1e-3);
        }
        // Bounds of Frechet and Bonferroni.
        assert!(together <= first.min(second) && together >= first + second - 1.0);
        let whole = a.cell_yield.unwrap();
        assert!(whole.low <= together && together <= whole.high && whole.high - whole.low < 0.01);
    }
}

/// If only the fixtures have errors, which the operations do not share, the joint yield is the product of the
/// yields. If only the robot has errors, two equal operations stay within their limits on the same arms.
#[test]
fn shared_parameters_have_one_draw_and_others_are_independent() {
    let side = Spread { plus_minus: m_from_mm(3.0), distribution: Distribution::Uniform, sigmas: 3.0 };
    let fixture = Some(FrameErrors::Tolerance([side; 6]));
    let mut cell = limited([3.0, 3.0], [fixture, fixture]).cell.clone();
    for on in [0, 1].map(|k| cell.operations[k].equipment) {
        let Some(FrameErrors::Tolerance(spreads)) = &mut cell.equipment[on].errors else { panic!() };
        spreads[3..].iter_mut().for_each(|s| s.plus_minus = 0.0);
    }
    let none = vec![Spread::of_magnitude(0.0); Parameter::count(cell.robot.axes())];
    cell.robot.errors = vec![ErrorSet::Tolerance(Tolerance {
        name: "none".into(),
        spreads: none,
        covariance: None,
        costs: Vec::new(),
    })];
    cell.errors = 0;
    let workcell = Workcell::new(cell).unwrap();
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let [together, first, second] = yields(&a);
    assert!((0.3..0.9).contains(&first) && (0.3..0.9).contains(&second), "{first} {second}");
    near(together, first * second, 0.004);

    let mut cell = limited([5.0, 5.0], [None, None]).cell.clone();
    cell.operations[1] = Operation { name: "again".into(), ..cell.operations[0].clone() };
    let workcell = Workcell::new(cell).unwrap();
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let [together, first, second] = yields(&a);
    assert!((0.05..0.95).contains(&first), "{first}");
    assert_eq!([together, first], [first, second]);
}

#[test]
fn a_cell_without_limits_or_spots_has_no_yield() {
    let mut workcell = limited([7.0, 9.0], [None, None]);
    workcell.cell.operations.iter_mut().for_each(|o| o.limit = None);
    let unlimited = Workcell::new(workcell.cell.clone()).unwrap();
    assert_eq!(Assessment::new("start", &unlimited, unlimited.cell.start()).cell_yield, None);
    let mut signed = limited([7.0, 9.0], [None, None]).cell.clone();
    signed.reading = Reading::Signed;
    let signed = Workcell::new(signed).unwrap();
    assert_eq!(Assessment::new("start", &signed, signed.cell.start()).cell_yield, None);
}
