//! Tests that a layout that does not belong to a cell gives a result with a reason and never a panic.

use crate::common::{shipped, workcell};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::assess::Assessment;
use sweetspot::cell::{Azimuth, Goal, Goals, Layout, MAX_COORDINATE, Misfit, Placement, Slot, Spin};
use sweetspot::error_map::{Outcome, Unjudged};
use sweetspot::layout::{Workcell, evaluate, separated};
use sweetspot::record::MapDocument;

/// Change that makes a layout wrong, with the expected reason.
type Damage = (Box<dyn Fn(&mut Layout)>, Misfit);

fn damages(workcell: &Workcell) -> Vec<Damage> {
    let (equipment, operations) = (workcell.cell.equipment.len(), workcell.cell.operations.len());
    let counts: Vec<Damage> = vec![
        (
            Box::new(move |l| l.placements.truncate(equipment - 1)),
            Misfit::Placements { given: equipment - 1, needed: equipment },
        ),
        (
            Box::new(|l| l.placements.push(l.base)),
            Misfit::Placements { given: equipment + 1, needed: equipment },
        ),
        (Box::new(|l| l.placements.clear()), Misfit::Placements { given: 0, needed: equipment }),
        (Box::new(|l| l.attitudes.clear()), Misfit::Attitudes { given: 0, needed: operations }),
        (Box::new(|l| l.attitudes[0].elevation += 0.1), Misfit::Attitude(0)),
        (Box::new(|l| l.attitudes[0].spin = Spin::At(Vec::new())), Misfit::Attitude(0)),
        (
            Box::new(|l| l.attitudes[0].azimuth = Azimuth::Surface(f64::NAN)),
            Misfit::Coordinate(Slot::Attitude(0, 1)),
        ),
    ];
    let wrong = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -2.0 * MAX_COORDINATE];
    let numbers = wrong.into_iter().flat_map(|v| {
        let set = move |at: &mut Placement, axis: usize| {
            let mut values = at.values();
            values[axis] = v;
            *at = Placement::from_values(values);
        };
        (0..4).flat_map(move |axis| {
            let last = equipment - 1;
            let of_base: Damage = (
                Box::new(move |l: &mut Layout| set(&mut l.base, axis)),
                Misfit::Coordinate(Slot::Base(axis)),
            );
            let of_last: Damage = (
                Box::new(move |l: &mut Layout| set(&mut l.placements[last], axis)),
                Misfit::Coordinate(Slot::Equipment(last, axis)),
            );
            [of_base, of_last]
        })
    });
    counts.into_iter().chain(numbers).collect()
}

/// Every function accepts a layout that does not belong to the cell, and returns a finite, infeasible result.
#[test]
fn a_layout_of_no_cell_is_infeasible_with_its_reason() {
    let mut robust = shipped("hitachi_cell.toml");
    robust.search.robust = true;
    let robust = Workcell::new(robust).unwrap();
    for workcell in [workcell("hitachi_cell.toml"), workcell("wrist_cell.toml"), robust] {
        let start = workcell.cell.start();
        assert_eq!(workcell.cell.misfit(&start), None);
        let (feasible, maps) = (evaluate(&workcell, &start), workcell.maps(&start));
        let posture = maps[0].nodes.iter().find_map(|node| node.posture.as_ref()).unwrap();
        for (damage, reason) in damages(&workcell) {
            let mut layout = start.clone();
            damage(&mut layout);
            let evaluation = evaluate(&workcell, &layout);
            assert_eq!(evaluation.misfit, Some(reason), "{layout:?}");
            assert!(evaluation.objective.is_none() && !evaluation.is_accepted());
            assert!(evaluation.cost.is_finite() && evaluation.cost >= 1e3 * workcell.weight());
            let unjudged = Outcome::Unjudged(Unjudged::NotALayout);
            assert_eq!(evaluation.outcomes, vec![unjudged; workcell.cell.operations.len()]);
            assert!(reason.in_words(&workcell.cell).len() > 20);
            assert_eq!(separated(&workcell, &layout), None);
            assert_eq!(workcell.posed(&layout, &maps, 0, posture).err(), Some(Unjudged::NotALayout));
            assert!(workcell.refined(&layout, &maps).iter().all(Option::is_none));
            assert!(workcell.robustness(&layout, &maps).iter().all(Option::is_none));
            let goals = Goals::of(&[Goal::Error, Goal::Footprint]).unwrap();
            assert_eq!(workcell.goals(&layout, &feasible, &goals), None);
            let free = workcell.cell.free();
            let values: Vec<f64> = free.iter().map(|(slot, _)| layout.value(&workcell.cell, *slot)).collect();
            assert_eq!(values.len(), free.len());
            assert_eq!(workcell.cell.misplaced(&layout, &[]).placements.len(), layout.placements.len());
            let assessment = Assessment::new("none", &workcell, layout).misplaced();
            assert!(!assessment.is_robust() && assessment.reachable(0).is_empty());
            // The start layout is shown instead, with the reason.
            assert_eq!(assessment.layout, start);
            let document = serde_json::to_value(MapDocument::new(&assessment)).unwrap();
            assert_eq!(document["feasible"], false);
            assert_eq!(document["reasons"][0], reason.in_words(&workcell.cell));
        }
    }
}

/// Coordinates up to the greatest permitted value give finite costs.
#[test]
fn every_layout_within_the_greatest_coordinate_has_a_finite_cost() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for workcell in ["hitachi_cell.toml", "scara_cell.toml", "palletizer_cell.toml"].map(workcell) {
        for _ in 0..20 {
            let mut layout = workcell.cell.start();
            for at in layout.placements.iter_mut().chain([&mut layout.base]) {
                let far = rng.random_bool(0.5);
                let mut value = || match far {
                    true => MAX_COORDINATE * [-1.0, 1.0][rng.random_range(0..2)],
                    false => rng.random_range(-3.0..3.0),
                };
                *at = Placement::from_values([(); 4].map(|()| value()));
            }
            let evaluation = evaluate(&workcell, &layout);
            assert_eq!(evaluation.misfit, None);
            assert!(evaluation.cost.is_finite(), "{layout:?}: {evaluation:?}");
        }
    }
}
