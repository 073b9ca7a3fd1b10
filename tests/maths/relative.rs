//! Tests the choice of the spots of a pick and of a place relative to the pick, against every pair of spots.

use crate::common::{from_text, shipped};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{Cell, Coordinate, Place};
use sweetspot::layout::{Workcell, combined, evaluate};
use sweetspot::record::caveats;

/// Returns the points of the grid of an operation, m.
fn points(cell: &Cell, operation: usize) -> Vec<(f64, f64)> {
    let Place::Grid { area, divisions: (m, n) } = cell.operations[operation].place else { panic!() };
    let at = |k: usize, of: usize, centre: f64, size: f64| centre + size * (k as f64 / of as f64 - 0.5);
    let point = |(i, j)| (at(i, m, area.centre.0, area.size.0), at(j, n, area.centre.1, area.size.1));
    (0..=m).flat_map(|i| (0..=n).map(move |j| (i, j))).map(point).collect()
}

/// The spot of the pick is chosen without regard to the place, so some pairs are better. No pair is better
/// than the bound that the note states.
#[test]
fn no_pair_of_spots_is_better_than_the_bound_of_the_note() {
    let mut cell = shipped("hitachi_cell.toml");
    cell.operations[1].relative_to = Some(0);
    let workcell = Workcell::new(cell.clone()).unwrap();
    let singles: Vec<Workcell> = points(&cell, 0)
        .into_iter()
        .map(|point| {
            let mut single = cell.clone();
            single.operations[0].place = Place::Points(vec![point]);
            Workcell::new(single).unwrap()
        })
        .collect();
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut seen, mut better) = (0, 0);
    while seen < 6 {
        let layout = cell.layout(|_, coordinate: &Coordinate| {
            let (low, high) = coordinate.range();
            let near = coordinate.start() + 0.1 * (high - low) * rng.random_range(-1.0..=1.0);
            near.clamp(low, high)
        });
        let evaluation = evaluate(&workcell, &layout);
        let Some(chosen) = evaluation.objective else { continue };
        seen += 1;
        let pick = workcell.maps(&layout)[0].value.unwrap();
        let bound = combined(&cell, &[pick, 0.0]);
        let of_pairs = singles.iter().filter_map(|single| evaluate(single, &layout).objective);
        let best = of_pairs.fold(f64::INFINITY, f64::min);
        assert!(best <= chosen + 1e-12, "the chosen pair is one of the pairs: {chosen} {best}");
        assert!(best >= bound - 1e-12, "{best} {bound}");
        better += usize::from(best < chosen - 1e-9);
    }
    assert!(better > 0, "no pair is better than the chosen one: the note would be needless");
}

#[test]
fn a_note_names_the_pick_that_is_chosen_alone() {
    let text = "from = \"hitachi_cell.toml\"\n[operation.picking]\nrelative_to = \"assembly\"\n";
    let cell = from_text(text).unwrap_or_else(|f| panic!("{f:#?}")).cell;
    let notes = caveats(&cell);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(
        notes[0].starts_with("picking is relative to assembly. The spot of assembly is chosen first"),
        "{notes:?}"
    );
    assert!(notes[0].ends_with("at most to its value with an error of 0 at picking"), "{notes:?}");
    assert!(caveats(&shipped("hitachi_cell.toml")).is_empty());
    // A pick at every node leaves no choice.
    let mut all = cell;
    all.operations[0].over = sweetspot::cell::NodeAggregation::Max;
    assert!(caveats(&all).is_empty());
}
