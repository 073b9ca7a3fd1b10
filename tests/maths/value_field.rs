//! Tests value fields against the values of single nodes, which the search finds without any bound.

use crate::common::{cases, shipped};
use crate::readings::bench::alone;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{
    Cell, Coordinate, ErrorSet, NodeAggregation, Place, Quantity, Reading, Registration, Sense, Spin,
};
use sweetspot::error_map::{Grid, Outcome};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::proof::{rank_nodes, value_fields, why_no_field};
use sweetspot::search::SearchSpace;

/// Cells with value fields, and the least median ratio of the bound to the value of a node, in percent. The
/// error of the signed sample of ur10e changes its sign with the radius, so its fields are less sharp.
const CELLS: [(&str, f64); 6] = [
    ("ur_cell.toml", 20.0),
    ("scara_cell.toml", 85.0),
    ("palletizer_cell.toml", 85.0),
    ("five_axis_cell.toml", 85.0),
    ("wrist_cell.toml", 85.0),
    ("offset_wrist_cell.toml", 85.0),
];

/// Numbers of nodes that a field excludes, and of nodes that no posture reaches.
#[derive(Default)]
struct Unreachable {
    excluded: usize,
    all: usize,
}

/// Compares the fields of a cell with the values of one node per operation in random layouts. Also compares
/// the bound of every configuration with the values of its postures. Returns the ratios of bound to value of
/// the nodes, and those of the postures, in percent.
fn ratios(mut cell: Cell, layouts: usize, rng: &mut ChaCha8Rng, missed: &mut Unreachable) -> [Vec<f64>; 2] {
    (cell.collision, cell.search.ideal) = (false, true);
    for operation in &mut cell.operations {
        operation.place = Place::Points(vec![(0.05, -0.02)]);
    }
    let workcell = Workcell::new(cell).unwrap().unranked();
    let (cell, space) = (&workcell.cell, SearchSpace::new(&workcell.cell));
    let stop = AtomicBool::new(false);
    let fields: Vec<_> =
        (0..cell.operations.len()).map(|k| value_fields(&workcell, k, &stop).unwrap()).collect();
    let (inverse, context) = (workcell.inverse(), alone());
    let mut ratios = [Vec::new(), Vec::new()];
    for _ in 0..layouts {
        let point: Vec<f64> = (0..space.dimensions()).map(|_| rng.random()).collect();
        let layout = space.layout(&point);
        let outcomes = evaluate(&workcell, &layout).outcomes;
        for (k, operation) in cell.operations.iter().enumerate() {
            let at = layout.placements[operation.equipment].seen_from(&layout.base);
            let target = Grid::new(operation).target(&at, 0);
            let field =
                fields[k].iter().find(|field| field.covers(target.z, layout.attitudes[k].elevation)).unwrap();
            let bound = field.bound(&target);
            let bounds = field.posture_bounds(&target).unwrap();
            let evaluator = workcell.evaluator(k);
            let mut memory = evaluator.memory();
            let attitudes = inverse.tool_attitudes(&layout.attitudes[k], at.yaw);
            inverse.visit(&target, &attitudes, &mut inverse.scratch(), |branch, posture| {
                let value = evaluator.value(&context, &inverse.chain().frames(posture), &mut memory);
                let of_posture = bounds.of(posture);
                assert!(bound <= of_posture && of_posture <= value, "{branch}: {of_posture} > {value}");
                ratios[1].push(100.0 * of_posture / value);
            });
            match outcomes[k] {
                Outcome::Found(spot) => {
                    assert!(bound <= spot.value, "{}: {bound} > {} at {target}", operation.name, spot.value);
                    ratios[0].push(100.0 * bound / spot.value);
                }
                Outcome::Unreachable { .. } => {
                    missed.all += 1;
                    missed.excluded += usize::from(bound == f64::INFINITY);
                }
                other => panic!("{other:?}"),
            }
        }
    }
    ratios
}

/// A field is never above the least value of a node, and close to it.
#[test]
fn value_fields_bound_the_values_of_random_nodes() {
    let mut rng = ChaCha8Rng::seed_from_u64(1_611);
    let mut missed = Unreachable::default();
    for (name, least) in CELLS {
        for variant in (0..6).step_by(cases(2, 1)) {
            let mut cell = shipped(name);
            if let ErrorSet::Tolerance(_) = cell.robot.errors[cell.errors] {
                cell.reading = [Reading::Statistical, Reading::WorstCase][variant / 3];
            }
            cell.quantity = [Quantity::P95, Quantity::Rms, Quantity::P99][variant % 3];
            for operation in &mut cell.operations {
                operation.sense = Sense::plain(["xy", "xyz", "z"][variant / 2]).unwrap();
                operation.attitude.spin =
                    if variant == 2 { Spin::Free } else { operation.attitude.spin.clone() };
            }
            for mut ratios in ratios(cell, cases(80, 400), &mut rng, &mut missed) {
                ratios.sort_by(f64::total_cmp);
                let median = ratios[ratios.len() / 2];
                assert!(
                    ratios.len() > 30 && median >= least,
                    "{name} {variant}: {median} of {}",
                    ratios.len()
                );
            }
        }
    }
    assert!(missed.all > 100 && missed.excluded * 10 > missed.all * 8, "{} {}", missed.excluded, missed.all);
}

/// A field does not apply to a layout whose tool elevation lies outside the range of the search.
#[test]
fn value_fields_do_not_apply_to_other_elevations() {
    let mut cell = shipped("ur_cell.toml");
    cell.collision = false;
    for operation in &mut cell.operations {
        let (min, max) = (-1.6, -1.5);
        operation.angles[0] = Some(Coordinate::Range { min, max, start: -1.55 });
    }
    let [with_fields, judged] = [0, 1].map(|_| Workcell::new(cell.clone()).unwrap());
    let judged = judged.unranked();
    rank_nodes(&with_fields, &AtomicBool::new(false));
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for elevation in [-1.58, -1.55, -1.1, -0.3] {
        for _ in 0..5 {
            let mut layout = cell.start();
            layout.placements.iter_mut().for_each(|at| at.x += rng.random_range(-0.3..0.3));
            layout.attitudes.iter_mut().for_each(|attitude| attitude.elevation = elevation);
            let [got, want] = [&with_fields, &judged].map(|workcell| evaluate(workcell, &layout));
            assert_eq!((&got, got.cost.to_bits()), (&want, want.cost.to_bits()), "{elevation}");
        }
    }
}

/// Every condition of a field has its own message.
#[test]
fn operations_without_a_value_field_state_the_reason() {
    let reason = |name: &str, change: &dyn Fn(&mut Cell)| {
        let mut cell = shipped(name);
        change(&mut cell);
        why_no_field(&Workcell::new(cell).unwrap(), 0)
    };
    assert_eq!(reason("ur_cell.toml", &|_| ()), None);
    let reasons = [
        reason("hitachi_cell.toml", &|_| ()),
        reason("ur_cell.toml", &|cell| cell.operations[0].over = NodeAggregation::Max),
        reason("ur_cell.toml", &|cell| cell.operations[0].sense = Sense::plain("x").unwrap()),
        reason("track_cell.toml", &|_| ()),
        reason("ur_cell.toml", &|cell| cell.registration = Registration::BestFit),
    ];
    let direction = Some("its error depends on the direction of a node from the robot base");
    let expected = [
        Some("the search already ranks the nodes of each layout by a lower bound of their error"),
        Some("it happens at every node, so no node can be left out"),
        direction,
        Some("the first joint does not rotate the arm about the z axis of the robot base"),
        Some("a registration removes part of its error"),
    ];
    assert_eq!(reasons, expected);
}
