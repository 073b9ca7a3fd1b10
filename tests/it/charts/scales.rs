//! Tests scales of numbers and of colours.

use sweetspot::report::chart::axes::AxisScale;
use sweetspot::report::chart::colour_scale::ColourScale;
use sweetspot::report::chart::difference::colour;

#[test]
fn colour_bands_end_at_iso_lines_and_grow_lighter() {
    let scale = ColourScale::new(3.77, 5.0);
    let edges: Vec<f64> = scale.bands().iter().map(|b| b.0).collect();
    assert!(edges[0] == 3.77 && edges.windows(2).all(|w| w[0] < w[1]) && edges.last() < Some(&5.0));
    for level in scale.levels().iter().filter(|l| **l < 5.0) {
        assert!(edges.iter().any(|e| (e - level).abs() < 1e-9), "{level} in {edges:?}");
    }
    // Values beyond the ends of the scale have the colours of the ends, because several maps share a scale.
    let colours: Vec<String> = [-9.0, 3.78, 4.97, 99.0].iter().map(|v| scale.colour(*v)).collect();
    assert!(colours[0] == colours[1] && colours[2] == colours[3] && colours[1] != colours[2]);
    let flat = ColourScale::new(2.0, 2.0 + 1e-13);
    assert!(flat.levels().is_empty() && flat.bands().len() == 1);
}

#[test]
fn axis_ticks_are_round_numbers_inside_the_range() {
    for (low, high) in [(0.0, 1.0), (-3.7, 12.4), (3.1e-6, 9.9e-6), (1234.5, 99999.0), (5.0, 5.0)] {
        let scale = AxisScale::linear(low, high, (0.0, 100.0));
        let ticks = scale.ticks(5.0);
        assert!((2..=11).contains(&ticks.len()), "{low} {high}: {ticks:?}");
        assert!(ticks.iter().all(|(v, _)| (0.0..=100.0).contains(&scale.at(*v))));
        let mut said: Vec<_> = ticks.iter().map(|t| t.1.clone()).collect();
        said.dedup();
        assert_eq!(said.len(), ticks.len(), "{said:?}");
    }
    let scale = AxisScale::log(1.0, 20_000.0, (0.0, 400.0));
    let said: Vec<_> = scale.ticks(5.0).into_iter().map(|t| t.1).collect();
    assert_eq!(said, ["1", "10", "100", "1000", "10000"]);
    assert!((scale.at(100.0) - 400.0 * 2.0 / 20_000f64.log10()).abs() < 1e-9);
}

#[test]
fn every_value_is_placed_on_the_axis() {
    for scale in [AxisScale::linear(f64::NAN, 1.0, (0.0, 9.0)), AxisScale::log(0.0, 0.0, (0.0, 9.0))] {
        for v in [-1.0, 0.0, 0.5, 1e300] {
            assert!((0.0..=9.0).contains(&scale.at(v)), "{scale:?} {v}");
        }
    }
}

#[test]
fn the_difference_scale_runs_from_blue_to_orange() {
    assert_eq!((colour(-1.0).as_str(), colour(1.0).as_str()), ("#005aa0", "#be4b00"));
    assert_eq!((colour(0.0), colour(-7.0)), ("#f0f0ec".to_string(), colour(-1.0)));
}
