//! Tests upper bounds of the value at a posture against the value.

use crate::common::cases;
use crate::readings::bench::{alone, cell_of, gauge_of, random_errors, random_robot};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{Model, Quantity, Reading, Sense};
use sweetspot::robot::Chain;

/// The bound holds for random robots, errors of every rigid parameter, quantities, senses and models. Large
/// rotations make the mean of the second-order terms matter. Small errors give a bound near the value.
#[test]
fn the_upper_bound_of_a_value_is_not_below_the_value() {
    let mut rng = ChaCha8Rng::seed_from_u64(28);
    let (mut bounded, mut close) = (0, 0);
    for k in 0..cases(160, 2000) {
        let axes = rng.random_range(3..=7);
        let robot = random_robot(&mut rng, axes);
        let turned = 10f64.powf(rng.random_range(-5.0..-1.0));
        let tolerance = random_errors(&mut rng, axes, turned).tolerance();
        let sense = Sense::plain(["xyz", "xy", "z"][k % 3]).unwrap();
        let mut cell = cell_of(robot, tolerance, sense);
        cell.reading = if k % 5 == 0 { Reading::WorstCase } else { Reading::Statistical };
        cell.model = [Model::Nonlinear, Model::Linear, Model::SecondOrder][k % 3];
        cell.quantity = [Quantity::P95, Quantity::P99, Quantity::Rms, Quantity::Mean][k % 4];
        let evaluator = gauge_of(&cell);
        let (context, chain, mut memory) = (alone(), Chain::new(&cell.robot), evaluator.memory());
        for sample in 0..4 {
            let frames = chain.frames(&chain.posture(&chain.halton_sample(sample)));
            let value = evaluator.value(&context, &frames, &mut memory);
            let Some(most) = evaluator.most(&context, &frames, &mut memory) else { continue };
            assert!(value <= most, "case {k}, sample {sample}: {value} > {most}");
            bounded += 1;
            close += usize::from(most < 1.001 * value);
        }
    }
    assert!(bounded > 250 && close > 150, "{bounded} {close}");
}
