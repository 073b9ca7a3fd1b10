//! Tests free coordinates other than placements of equipment: the robot base, the orientation of the tool,
//! lists of allowed values, and equipment on equipment. Also tests operations at more than one spot.

use crate::common::from_text;
use rand::Rng;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, Coordinate, Layout, Slot};
use sweetspot::error_map::{Outcome, Status};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::proof::{ProofOptions, prove};
use sweetspot::report;
use sweetspot::search::{Watch, search};

/// Returns the paper's arm with one table and one obstacle; `base`, `table` and `operation` are TOML.
fn text(base: &str, table: &str, operation: &str) -> String {
    format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         [robot]\nfrom = \"robots/hitachi_pw10.toml\"\n{base}\n\
         [equipment.table]\nsurface = {{ size_mm = [600, 400] }}\n\
         solid = [{{ name = \"top\", box = {{ centre_mm = [0, 0, -25], size_mm = [600, 400, 50] }} }}]\n{table}\n\
         [obstacle.post]\nsolid = [{{ name = \"post\", box = {{ centre_mm = [0, 0, 900], size_mm = [80, 80, 1800] }} }}]\n\
         placement = {{ x_mm = 300, y_mm = 700, z_mm = 0 }}\n\
         [operation.work]\non = \"table\"\nstandoff_mm = 100\nsense = \"xy\"\n{operation}\n\
         [search]\nbudget = 3000\n"
    )
}

fn cell(base: &str, table: &str, operation: &str) -> Cell {
    from_text(&text(base, table, operation)).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

const TABLE: &str = "placement = { x_mm = 0, y_mm = 1000, z_mm = 600, yaw_deg = 10 }";
const GRID: &str = "grid = [6, 4]\nbend_deg = -90";

fn value(workcell: &Workcell, layout: &Layout) -> Option<f64> {
    evaluate(workcell, layout).objective
}

/// Moving the robot is equivalent to moving everything else in the opposite direction.
#[test]
fn moving_the_base_equals_moving_the_cell_the_other_way() {
    let range = "{ min = -500, max = 500, start = 0 }";
    let base = format!(
        "base = {{ x_mm = {range}, y_mm = {range}, z_mm = {range}, yaw_deg = {{ min = -180, max = 180 }} }}"
    );
    let workcell = Workcell::new(cell(&base, TABLE, GRID)).unwrap();
    assert_eq!(workcell.cell.free().len(), 4);
    let start = workcell.cell.start();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut feasible = 0;
    for _ in 0..300 {
        let mut layout = start.clone();
        for (value, size) in [
            (&mut layout.base.x, 0.4),
            (&mut layout.base.y, 0.4),
            (&mut layout.base.z, 0.2),
            (&mut layout.base.yaw, 1.0),
        ] {
            *value = rng.random_range(-size..size);
        }
        let mut opposite = start.clone();
        for (at, before) in opposite.placements.iter_mut().zip(&start.placements) {
            *at = before.seen_from(&layout.base);
        }
        let [moved, still] = [&layout, &opposite].map(|l| evaluate(&workcell, l));
        // The floor does not move, so at another height the arm may touch the floor, or a leg may become
        // longer.
        if let (Some(a), Some(b)) = (moved.objective, still.objective) {
            feasible += 1;
            assert!((a - b).abs() <= 1e-12 + 1e-9 * b, "{a} for {b}");
        } else if layout.base.z == 0.0 {
            assert_eq!(moved.objective.is_some(), still.objective.is_some());
        }
        let maps = [&layout, &opposite].map(|l| workcell.maps(l));
        let to_world = layout.base.pose();
        for (a, b) in maps[0][0].nodes.iter().zip(&maps[1][0].nodes) {
            let Some((p, q)) = a.posture.as_ref().zip(b.posture.as_ref()) else { continue };
            assert!((a.position - to_world.transform(&b.position)).norm() < 1e-9);
            if p.branch == q.branch {
                assert!((p.error - to_world.rotation * q.error).norm() < 1e-9, "errors turn with the base");
            }
        }
    }
    assert!(feasible > 50, "{feasible} feasible pairs are too few to say anything");
}

#[test]
fn a_search_finds_the_best_of_listed_values() {
    let table = "placement = { x_mm = [-400, -200, 0, 200, 400], y_mm = [800, 900, 1000, 1100, 1200], \
                 z_mm = [500, 600, 700], yaw_deg = [0, 30, 90] }";
    let workcell = Workcell::new(cell("", table, GRID)).unwrap();
    let free = workcell.cell.free();
    let mut best = f64::INFINITY;
    let mut count = [0usize; 4];
    let lists: Vec<&[f64]> = free
        .iter()
        .map(|(_, c)| match c {
            Coordinate::List(values) => &values[..],
            other => panic!("{other:?} is no list"),
        })
        .collect();
    loop {
        let layout = workcell.cell.layout(|slot, c| {
            free.iter().position(|f| f.0 == slot).map_or(c.start(), |k| lists[k][count[k]])
        });
        best = best.min(value(&workcell, &layout).unwrap_or(f64::INFINITY));
        let Some(k) = (0..4).find(|&k| count[k] + 1 < lists[k].len()) else { break };
        count[k] += 1;
        count[..k].fill(0);
    }
    let stop = AtomicBool::new(false);
    let watch = Watch { progress: &|_| (), stop: &stop };
    let record = search(&workcell, &workcell.cell.search, &watch);
    for (slot, coordinate) in &free {
        let Coordinate::List(values) = coordinate else { panic!() };
        assert!(values.contains(&record.best.layout.value(&workcell.cell, *slot)), "{slot:?}");
    }
    assert_eq!(record.best.evaluation.objective, Some(best), "of 225 layouts");
    // The bound holds for the listed heights, not for all heights between them.
    let bound = |workcell: &Workcell| prove(workcell, &ProofOptions::default(), &stop).bound.unwrap();
    let between = table.replace("[500, 600, 700]", "{ min = 500, max = 700 }");
    let (listed, between) = (bound(&workcell), bound(&Workcell::new(cell("", &between, GRID)).unwrap()));
    assert!(between <= listed && listed <= best, "{between} {listed} {best}");
}

const FIXTURE: &str = "[equipment.fixture]\nstands_on = \"table\"\nsurface = { size_mm = [100, 100] }\n\
     solid = [{ name = \"block\", box = { centre_mm = [0, 0, -20], size_mm = [120, 120, 40] } }]\n\
     placement = { x_mm = 100, y_mm = -50, z_mm = 40.5, yaw_deg = 20 }\n";

/// Equipment on a moved table is equivalent to separate equipment at the resulting placement.
#[test]
fn equipment_on_a_table_moves_with_it() {
    let on = GRID.to_string() + "\n" + FIXTURE;
    let operation = on.replace("grid = [6, 4]", "grid = [2, 2]");
    let table =
        "placement = { x_mm = 0, y_mm = { min = 500, max = 1500, start = 1000 }, z_mm = 600, yaw_deg = 10 }";
    let text = |tied: bool, at: &str| {
        let whole =
            operation.replace("stands_on = \"table\"\n", if tied { "stands_on = \"table\"\n" } else { "" });
        let whole =
            if tied { whole } else { whole.replace("x_mm = 100, y_mm = -50, z_mm = 40.5, yaw_deg = 20", at) };
        let mut cell = cell("", table, &whole);
        cell.operations[0].equipment = cell.equipment.iter().position(|e| e.name == "fixture").unwrap();
        cell
    };
    let tied = Workcell::new(text(true, "")).unwrap();
    for y in [0.9, 1.0, 1.05] {
        let layout = tied.cell.layout(|slot, c| if let Slot::Equipment(0, 1) = slot { y } else { c.start() });
        let fixture = layout.placements[1];
        // The expected placement is calculated by hand for a table rotated by 10 degrees.
        let (s, c) = 10f64.to_radians().sin_cos();
        let by_hand = [0.1 * c + 0.05 * s, y + 0.1 * s - 0.05 * c, 0.6405, 30f64.to_radians()];
        for (is, want) in fixture.values().iter().zip(by_hand) {
            assert!((is - want).abs() < 1e-12, "{is} for {want}");
        }
        let own = tied.cell.own_placement(&layout, 1);
        for (is, want) in own.values().iter().zip([0.1, -0.05, 0.0405, 20f64.to_radians()]) {
            assert!((is - want).abs() < 1e-12, "{is} for {want}");
        }
        let evaluation = evaluate(&tied, &layout);
        assert!(evaluation.overlaps.is_empty(), "{:?}", evaluation.overlaps);
        assert!(evaluation.objective.is_some(), "{:?}", evaluation.outcomes);
        // Separate equipment at the same placements gives the same map.
        let at = by_hand.map(|v| v * 1000.0);
        let at = format!("x_mm = {}, y_mm = {}, z_mm = {}, yaw_deg = 30", at[0], at[1], at[2]);
        let alone = Workcell::new(text(false, &at)).unwrap();
        let mut apart = alone.cell.start();
        apart.placements[0] = layout.placements[0];
        let maps = [(&tied, &layout), (&alone, &apart)].map(|(w, l)| w.maps(l));
        for (a, b) in maps[0][0].nodes.iter().zip(&maps[1][0].nodes) {
            if let (Status::Ok, Some(p), Some(q)) = (a.status, &a.posture, &b.posture) {
                assert!((p.value - q.value).abs() < 1e-10);
            }
        }
        assert!(evaluate(&alone, &apart).overlaps.is_empty(), "it stands on the table");
        apart.placements[1].z -= 0.001;
        assert!(!evaluate(&alone, &apart).overlaps.is_empty(), "a millimetre lower it stands in the table");
    }
}

#[test]
fn ties_that_cannot_be_are_refused() {
    let faults = |tie: &str| {
        let text = FIXTURE.replace("stands_on = \"table\"", tie);
        let text =
            format!("from = \"hitachi_cell.toml\"\n{text}[equipment.worktable]\nstands_on = \"fixture\"\n");
        from_text(&text).expect_err("is refused").iter().map(|f| f.message.clone()).collect::<Vec<_>>()
    };
    let circle = faults("stands_on = \"worktable\"");
    assert!(circle.iter().any(|m| m.contains("would stand on itself")), "{circle:?}");
    let unknown = faults("stands_on = \"worktabel\"");
    assert!(unknown.iter().any(|m| m.contains("no equipment `worktabel`")), "{unknown:?}");
}

/// A cell with a range of the bend gives the same result as a cell with a fixed bend.
#[test]
fn an_orientation_from_a_range_equals_the_fixed_orientation() {
    let ranged = GRID.replace("-90", "{ min = -100, max = -60, start = -90 }");
    let workcell = Workcell::new(cell("", TABLE, &ranged)).unwrap();
    for bend in [-90.0, -85.0, -70.0, -60.0] {
        let layout = workcell.cell.layout(|slot, c| match slot {
            Slot::Attitude(0, 0) => f64::to_radians(bend),
            _ => c.start(),
        });
        let fixed = Workcell::new(cell("", TABLE, &GRID.replace("-90", &bend.to_string()))).unwrap();
        let [a, b] = [value(&workcell, &layout), value(&fixed, &fixed.cell.start())];
        assert!(a.is_some() && a.map(f64::to_bits) == b.map(f64::to_bits), "{a:?} for {b:?} at {bend}");
    }
    let stop = AtomicBool::new(false);
    let watch = Watch { progress: &|_| (), stop: &stop };
    let record = search(&workcell, &workcell.cell.search, &watch);
    let scanned = (0..=4000).map(|k| {
        let bend = f64::to_radians(-100.0 + 0.01 * f64::from(k));
        let layout =
            workcell.cell.layout(|slot, c| if slot == Slot::Attitude(0, 0) { bend } else { c.start() });
        value(&workcell, &layout).unwrap_or(f64::INFINITY)
    });
    let least = scanned.fold(f64::INFINITY, f64::min);
    let found = record.best.evaluation.objective.unwrap();
    assert!(found <= least * 1.0001, "{found} for {least} in the scan");
    assert!((record.best.layout.attitudes[0].elevation + FRAC_PI_2).abs() > 0.01, "the bend was not used");
}

/// The maximum, the mean and the p95 over points agree with separate operations at one point each.
#[test]
fn every_point_counts() {
    let points = [(-200.0, -100.0), (-200.0, 100.0), (0.0, 0.0), (150.0, -150.0), (200.0, 100.0)];
    let one = |p: &[(f64, f64)], over: &str| {
        let listed: Vec<_> = p.iter().map(|(x, y)| format!("[{x}, {y}]")).collect();
        let operation = format!("points_mm = [{}]\nbend_deg = -90\nover = \"{over}\"", listed.join(", "));
        let workcell = Workcell::new(cell("", TABLE, &operation)).unwrap();
        let evaluation = evaluate(&workcell, &workcell.cell.start());
        let map = &workcell.maps(&workcell.cell.start())[0];
        assert_eq!(map.value, evaluation.objective, "map and search agree");
        let Outcome::Found(spot) = evaluation.outcomes[0] else { panic!("{:?}", evaluation.outcomes) };
        assert_eq!(map.spot(), Some(spot));
        spot.value
    };
    let each: Vec<f64> = points.iter().map(|p| one(&[*p], "max")).collect();
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} for {b}");
    close(one(&points, "max"), each.iter().copied().fold(0.0, f64::max));
    close(one(&points, "best"), each.iter().copied().fold(1.0, f64::min));
    close(one(&points, "mean"), each.iter().sum::<f64>() / 5.0);
    close(one(&points, "p95"), each.iter().copied().fold(0.0, f64::max));
}

/// A region here is a grid over a part of the surface. One unusable node makes the operation infeasible.
#[test]
fn every_node_of_a_region_is_evaluated() {
    let region = |over: &str, size: f64| {
        let operation = format!(
            "grid = [7, 5]\nregion = {{ centre_mm = [50, 20], size_mm = [{size}, 200] }}\nbend_deg = -90\nover = \"{over}\""
        );
        Workcell::new(cell("", TABLE, &operation)).unwrap()
    };
    let best = region("best", 300.0);
    let map = &best.maps(&best.cell.start())[0];
    let mut values: Vec<f64> = map.nodes.iter().map(|n| n.posture.as_ref().unwrap().value).collect();
    assert!(map.nodes.iter().all(|n| n.status == Status::Ok), "a region of usable nodes");
    values.sort_by(f64::total_cmp);
    assert_eq!(values.len(), 48);
    for (over, want) in
        [("max", values[47]), ("p95", values[45]), ("mean", values.iter().sum::<f64>() / 48.0)]
    {
        let workcell = region(over, 300.0);
        let found = value(&workcell, &workcell.cell.start()).unwrap();
        assert!((found - want).abs() < 1e-15, "{over}: {found} for {want}");
    }
    // If the table is at one side, some node violates a joint limit.
    let far = region("max", 300.0);
    let mut layout = far.cell.start();
    layout.placements[0].y = 1.35;
    let maps = far.maps(&layout);
    let usable = maps[0].nodes.iter().filter(|n| n.status == Status::Ok).count();
    assert!(usable > 0 && usable < 48, "{usable} usable");
    assert_eq!((value(&far, &layout), maps[0].best), (None, None));
    assert!(value(&best, &layout).is_some());
}

/// The file best.toml contains every kind of free coordinate, and reading it gives the same bits.
#[test]
fn what_was_found_can_be_written_and_read() {
    let base = "base = { x_mm = [0, 50], y_mm = { min = -100, max = 100 }, z_mm = 0, yaw_deg = { min = -20, max = 20 } }";
    let table =
        "placement = { x_mm = { min = -100, max = 100 }, y_mm = 1000, z_mm = 600, yaw_deg = [10, 20] }";
    let operation = GRID.replace("-90", "{ min = -95, max = -80, start = -90 }") + "\n" + FIXTURE;
    let whole = text(base, table, &operation.replace("x_mm = 100", "x_mm = { min = -100, max = 100 }"));
    let workcell = Workcell::new(from_text(&whole).unwrap().cell).unwrap();
    let stop = AtomicBool::new(false);
    let watch = Watch { progress: &|_| (), stop: &stop };
    let settings = sweetspot::cell::SearchSettings { budget: 300, ..workcell.cell.search };
    let record = search(&workcell, &settings, &watch);
    let text = report::toml::fixed("whole.toml", "found", &workcell.cell, &record.best.layout);
    // Every free coordinate has become a number, and the other keys are unchanged.
    for key in [
        "[robot.base]",
        "[equipment.\"table\".placement]",
        "[equipment.\"fixture\".placement]",
        "bend_deg = ",
    ] {
        assert!(text.contains(key), "{key} in {text}");
    }
    let mut read = |path: &str| match path {
        "best.toml" => Ok(text.clone().into_bytes()),
        "whole.toml" => Ok(whole.clone().into_bytes()),
        _ => std::fs::read(crate::common::root().join("cells").join(path)).map_err(|e| e.to_string()),
    };
    let again =
        sweetspot::files::load("best.toml", &mut read).unwrap_or_else(|f| panic!("{f:#?}\n{text}")).cell;
    assert!(again.free().is_empty(), "everything is fixed");
    let layout = again.start();
    assert_eq!(layout, record.best.layout, "{text}");
    let evaluation = evaluate(&Workcell::new(again).unwrap(), &layout);
    assert_eq!(evaluation.cost.to_bits(), record.best.evaluation.cost.to_bits());
}

/// The first operation decides. If the values differ by at most the indifference, the second operation
/// decides.
#[test]
fn lexicographic_is_first_things_first() {
    let second = "[operation.later]\non = \"table\"\ngrid = [3, 3]\nbend_deg = -90\nsense = \"z\"\n";
    let mut cell = cell("", TABLE, &(GRID.to_string() + "\n" + second));
    cell.search.objective = sweetspot::cell::Objective::Lexicographic;
    let combined = |a: f64, b: f64| sweetspot::layout::combined(&cell, &[a, b]);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..10_000 {
        let [a, b, c, d] = [(); 4].map(|()| 1e-6 * 10f64.powf(rng.random_range(0.0..4.0)));
        let (x, y) = (combined(a, b), combined(c, d));
        if c > a * 1.0201 {
            assert!(x < y, "({a}, {b}) is better than ({c}, {d})");
        }
        assert!(combined(a, b) <= combined(a * 1.001, b * 1.001), "it rises with each");
        assert!((x / a - 1.0).abs() < 0.0101, "{x} is near {a}");
        if d > b {
            assert!(combined(a, b) < combined(a, d));
        }
    }
}
