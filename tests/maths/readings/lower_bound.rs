//! Tests lower bounds of the value at a posture against the value.

use crate::common::{cases, shipped};
use crate::readings::bench::{alone, cell_of, gauge_of, random_errors, random_robot};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;
use sweetspot::cell::{Model, Quantity, Reading, Sense};
use sweetspot::robot::Chain;

/// Every bound of a worst case holds for random robots, tolerances of every rigid parameter, senses and
/// models. With small rotations, the quick bound is near the worst case.
#[test]
fn the_bounds_of_a_worst_case_are_not_above_it() {
    let mut rng = ChaCha8Rng::seed_from_u64(71);
    let (mut close, mut small) = (0, 0);
    for k in 0..cases(60, 600) {
        let axes = rng.random_range(3..=7);
        let robot = random_robot(&mut rng, axes);
        let turned = 10f64.powf(rng.random_range(-5.0..-1.0));
        let set = random_errors(&mut rng, robot.axes(), turned).tolerance();
        let mut cell = cell_of(robot, set, Sense::plain(["xyz", "xy", "z"][k / 3 % 3]).unwrap());
        cell.reading = Reading::WorstCase;
        cell.model = [Model::Nonlinear, Model::Linear, Model::SecondOrder][k % 3];
        let evaluator = gauge_of(&cell);
        let (context, chain, mut memory) = (alone(), Chain::new(&cell.robot), evaluator.memory());
        for sample in 0..4 {
            let frames = chain.frames(&chain.posture(&chain.halton_sample(4 * k + sample)));
            let value = evaluator.value(&context, &frames, &mut memory);
            let rough = evaluator.rough_worst(&context, &frames, &mut memory);
            assert!(rough <= value, "case {k}, sample {sample}: {rough} > {value}");
            if cell.model != Model::Linear {
                let corner = evaluator.corner_worst(&context, &frames, &mut memory);
                let (searched, _) = evaluator.searched_worst(&context, &frames, corner, &mut memory);
                assert!(corner <= searched && searched <= value, "case {k}: {corner} {searched} {value}");
            }
            small += usize::from(turned < 1e-4);
            close += usize::from(turned < 1e-4 && rough > 0.97 * value);
        }
    }
    assert!(small >= 20 && 10 * close > 9 * small, "{close} of {small}");
}

/// The bounds over the rotations of the tool hold after random rotations by the last joint, in the worst
/// case and in the statistical reading. They are near the least value over many rotations.
#[test]
fn the_bounds_over_spins_hold_after_every_rotation_of_the_tool() {
    let mut rng = ChaCha8Rng::seed_from_u64(72);
    let robot = shipped("ur_cell.toml").robot;
    let (mut compared, mut close) = (0, 0);
    for k in 0..cases(24, 240) {
        let turned = 10f64.powf(rng.random_range(-5.0..-2.0));
        let set = random_errors(&mut rng, robot.axes(), turned).tolerance();
        let sense = Sense::plain(["xyz", "xy", "z"][k / 3 % 3]).unwrap();
        let mut cell = cell_of(robot.clone(), set, sense);
        cell.reading = [Reading::WorstCase, Reading::Statistical][k % 2];
        cell.model = [Model::Nonlinear, Model::Linear, Model::SecondOrder][k / 2 % 3];
        cell.quantity = [Quantity::P95, Quantity::Rms][k / 2 % 2];
        let evaluator = gauge_of(&cell);
        let (context, chain) = (alone(), Chain::new(&cell.robot));
        let (mut memory, mut other) = (evaluator.memory(), evaluator.memory());
        let mut q = chain.halton_sample(k);
        let first = chain.posture(&q);
        let bounds = evaluator.bounds_over_spins(&context, &chain.frames(&first), &mut memory).unwrap();
        for _ in 0..24 {
            q[5] = rng.random_range(0.0..TAU);
            let posture = chain.posture(&q);
            let value = evaluator.value(&context, &chain.frames(&posture), &mut other);
            let bound = bounds.at(chain.spin_between(&first, &posture));
            assert!(bound <= value, "case {k}: {bound} > {value}");
            compared += 1;
            close += usize::from(bound > 0.95 * value);
        }
    }
    assert!(10 * close > 8 * compared, "{close} of {compared}");
}
