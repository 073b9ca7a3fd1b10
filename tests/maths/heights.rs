//! Tests that objects at different heights may overlap in plan, and that the message of a rejection states
//! whether two objects overlap or are too near.

use crate::common::from_text;
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{Cell, Goal, Goals, Layout, Placement, PlacementTolerance, Shape};
use sweetspot::clearance::{FloorPlan, Overlap, Party};
use sweetspot::layout::{Workcell, evaluate, separated};
use sweetspot::pose::Pose;

/// Returns the paper's cell with collisions, a table on legs and a lamp over it at height `lamp_z`, mm.
fn lamp_over_table(lamp_z: f64, more: &str) -> Cell {
    let text = format!(
        r#"
        schema = "sweetspot/cell/1"
        units = {{ length = "mm", angle = "deg" }}
        errors = "table-3"
        clearance_mm = 15
        [robot]
        from = "robots/hitachi_pw10.toml"
        [equipment.table]
        from = "equipment/worktable.toml"
        placement = {{ x_mm = {{ min = -10, max = 10 }}, y_mm = 1250, z_mm = 850 }}
        [equipment.lamp]
        solid = [{{ name = "lamp", box = {{ centre_mm = [0, 0, 0], size_mm = [300, 300, 100] }} }}]
        placement = {{ x_mm = 0, y_mm = 1500, z_mm = {lamp_z} }}
        {more}
        [operation.mapping]
        on = "table"
        grid = [10, 8]
        bend_deg = -60
        standoff_mm = 100
        sense = "xyz"
    "#
    );
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

fn overlaps(cell: &Cell, layout: &Layout) -> Vec<Overlap> {
    let mut found = Vec::new();
    FloorPlan::new(cell).overlaps(layout, &mut found);
    found
}

fn words(cell: &Cell) -> Vec<String> {
    overlaps(cell, &cell.start()).iter().map(|o| o.in_words(cell)).collect()
}

/// The lamp is 100 mm high, so that its lower side is 50 mm below its place, and the table's top is at 850
/// mm.
#[test]
fn a_lamp_may_hang_over_a_table() {
    let none: [&str; 0] = [];
    assert_eq!(words(&lamp_over_table(915.0, "")), none);
    assert_eq!(
        words(&lamp_over_table(905.0, "")),
        ["table is nearer to lamp than the clearance: 5.0 mm instead of 15.0 mm in height"]
    );
    assert_eq!(words(&lamp_over_table(895.0, "")), ["table overlaps lamp by 250.0 mm"]);
    // Below the slab are the legs of the table.
    assert_eq!(words(&lamp_over_table(400.0, "")), ["table overlaps lamp by 250.0 mm"]);
    let workcell = Workcell::new(lamp_over_table(915.0, "")).unwrap();
    let start = workcell.cell.start();
    assert!(evaluate(&workcell, &start).overlaps.is_empty());
    assert_eq!(separated(&workcell, &start), Some(start), "nothing has to move");
}

/// A robot base of unknown height, and equipment without solids, count as infinitely high.
#[test]
fn floor_space_without_solids_has_every_height() {
    let mut cell = lamp_over_table(915.0, "");
    cell.equipment[0].solids.clear();
    assert_eq!(words(&cell).len(), 1);
    let mut cell = lamp_over_table(3000.0, "");
    let mut layout = cell.start();
    layout.placements[1] = Placement { x: 0.0, y: 0.0, z: 3.0, yaw: 0.0 };
    assert!(overlaps(&cell, &layout).is_empty(), "the lamp hangs over the robot base");
    layout.placements[1].z = 0.1;
    assert_eq!(overlaps(&cell, &layout)[0].b, Party::RobotBase);
    layout.placements[1].z = 3.0;
    cell.robot.solids.clear();
    assert_eq!(overlaps(&cell, &layout)[0].b, Party::RobotBase);
}

/// Two tables 3.4 mm apart do not overlap. Two tables that penetrate each other by 11.6 mm overlap.
#[test]
fn a_distance_below_the_clearance_is_not_called_an_overlap() {
    let beside = |gap: f64| {
        let more = format!(
            "[equipment.other]\nfrom = \"equipment/worktable.toml\"\n\
             placement = {{ x_mm = {}, y_mm = 1250, z_mm = 700 }}\n",
            1500.0 + gap
        );
        words(&lamp_over_table(2000.0, &more))
    };
    assert_eq!(
        beside(3.4),
        ["table is nearer to other than the clearance: 3.4 mm instead of 15.0 mm along a side"]
    );
    assert_eq!(beside(-11.6), ["table overlaps other by 11.6 mm"]);
    assert!(beside(15.1).is_empty());
    assert_eq!(
        beside(14.97),
        ["table is nearer to other than the clearance: just below 15.0 mm along a side"]
    );
    let fenced = |gap: f64| {
        let more = format!(
            "[fence]\npolygon_mm = [[-{0}, -2000], [{0}, -2000], [{0}, 3000], [-{0}, 3000]]\n",
            750.0 + gap
        );
        words(&lamp_over_table(2000.0, &more))
    };
    assert_eq!(
        fenced(3.4),
        ["table is nearer to the fence than the clearance: 3.4 mm instead of 15.0 mm along a side"]
    );
    assert_eq!(fenced(-5.0), ["table reaches beyond the fence by 5.0 mm"]);
}

/// Random blocks at random heights: an overlap is reported exactly if the blocks overlap in plan and their
/// ranges of height are nearer than the clearance. The reported distance is the greater one of the distances
/// in height and in plan.
#[test]
fn overlaps_of_blocks_agree_with_their_corners() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    let mut cell = lamp_over_table(2000.0, "");
    let (mut low, mut found) = (0, [0, 0, 0]);
    for round in 0..20_000 {
        cell.clearance = [0.0, 0.015, 0.2][round % 3];
        for equipment in &mut cell.equipment {
            let mut size = || rng.random_range(0.1..1.0);
            let size = Vector3::new(size(), size(), size());
            let turn = Vector3::new(rng.random_range(-0.5..0.5), 0.0, 0.0);
            let centre = Vector3::new(0.0, 0.0, rng.random_range(-0.3..0.3));
            equipment.solids.truncate(1);
            equipment.solids[0].shape = Shape::Box { pose: Pose::from_translation_rpy(centre, turn), size };
            equipment.footprint.size = (size.x, size.y + size.z);
            equipment.surface = None;
        }
        let mut layout = cell.start();
        for at in &mut layout.placements {
            let mut value = |half: f64| rng.random_range(-half..half);
            *at =
                Placement { x: 9.0 + value(0.8), y: 9.0 + value(0.8), z: 2.0 + value(0.8), yaw: value(3.0) };
        }
        let heights = [0, 1].map(|k| {
            let Shape::Box { pose, size } = &cell.equipment[k].solids[0].shape else { panic!() };
            let corner = |c: usize| {
                let sign = |bit: usize| if c >> bit & 1 == 0 { -0.5 } else { 0.5 };
                let p = Vector3::new(sign(0) * size.x, sign(1) * size.y, sign(2) * size.z);
                (layout.placements[k].pose() * *pose).transform(&p).z
            };
            let all = (0..8).map(corner);
            (all.clone().fold(f64::INFINITY, f64::min), all.fold(f64::NEG_INFINITY, f64::max))
        });
        let rise = (heights[0].0 - heights[1].1).max(heights[1].0 - heights[0].1);
        let mut flat = cell.clone();
        flat.equipment.iter_mut().for_each(|e| e.solids.clear());
        let (got, in_plan) = (overlaps(&cell, &layout), overlaps(&flat, &layout));
        let is_near = rise < cell.clearance;
        assert_eq!(got.len(), if is_near { in_plan.len() } else { 0 }, "{heights:?}");
        low += usize::from(!in_plan.is_empty() && !is_near);
        let Some(overlap) = got.first() else { continue };
        assert_eq!(overlap.depth, in_plan[0].depth);
        let aside = cell.clearance - overlap.depth;
        let said = overlap.in_words(&cell);
        let number = |text: &str| text.split(' ').next().unwrap().parse::<f64>().unwrap() / 1e3;
        match said.split_once("overlaps lamp by ") {
            Some((_, by)) => {
                assert!(aside < 0.0 && rise <= 1e-12 && (number(by) + aside).abs() < 1e-4, "{said}");
                found[0] += 1;
            }
            None => {
                let (_, near) = said.split_once("clearance: ").unwrap();
                let near = near.trim_start_matches("just below ");
                assert!((number(near) - aside.max(rise)).abs() < 1e-4, "{said}: {aside} {rise}");
                found[if said.ends_with("in height") { 1 } else { 2 }] += 1;
            }
        }
    }
    assert!(low > 100 && found.iter().all(|n| *n > 100), "{low} {found:?}");
}

/// For two floor spaces that overlap in plan, the clearance goal counts the distance in height.
#[test]
fn the_clearance_goal_of_a_lamp_is_its_height_over_the_table() {
    let mut cell = lamp_over_table(2850.0, "");
    cell.equipment[1].placement[1] = sweetspot::cell::Coordinate::Fixed(1.25);
    let plan = FloorPlan::new(&cell);
    let mut layout = cell.start();
    for (z, wanted) in [(1.0, 0.1), (1.2, 0.3), (0.9, 0.0)] {
        layout.placements[1].z = z;
        assert!((plan.spacing(&cell, &layout, 0.5) - wanted).abs() < 1e-12, "{z}");
    }
    // The lamp is beside and above the table, so the distance is measured between edges.
    layout.placements[1] = Placement { x: 1.0, y: 1.25, z: 1.1, yaw: 0.0 };
    assert!((plan.spacing(&cell, &layout, 0.5) - 0.1_f64.hypot(0.2)).abs() < 1e-12);
    let workcell = Workcell::new(cell).unwrap();
    let goals = Goals::of(&[Goal::Clearance]).unwrap();
    let start = workcell.cell.start();
    let evaluation = evaluate(&workcell, &start);
    assert!(evaluation.objective.is_some(), "{evaluation:?}");
    assert!(workcell.goals(&start, &evaluation, &goals).unwrap()[0] > 0.0);
}

/// The gap between lamp and table exceeds the clearance by 10 mm. If each of them may be misplaced by 4 mm in
/// height, they keep the clearance. If each may be misplaced by 6 mm, they do not, although one misplacement
/// alone would be allowed.
#[test]
fn a_robust_search_misplaces_two_heights_at_once() {
    for (lamp, table, kept) in [(4.0, 4.0, true), (6.0, 6.0, false), (6.0, 0.0, true), (0.0, 11.0, false)] {
        let mut cell = lamp_over_table(925.0, "");
        // The lamp is away from the path of the robot, over the corner of the table.
        cell.equipment[1].placement[0] = sweetspot::cell::Coordinate::Fixed(0.85);
        cell.equipment[1].placement[1] = sweetspot::cell::Coordinate::Fixed(1.65);
        for (k, mm) in [(0, table), (1, lamp)] {
            cell.equipment[k].tolerance = PlacementTolerance([0.0, 0.0, mm / 1e3, 0.0]);
        }
        (cell.search.robust, cell.search.ideal) = (true, false);
        let workcell = Workcell::new(cell).unwrap();
        let evaluation = evaluate(&workcell, &workcell.cell.start());
        assert!(evaluation.overlaps.is_empty(), "{:?}", evaluation.overlaps);
        assert_eq!(evaluation.objective.is_some(), kept, "{lamp} {table}: {evaluation:?}");
    }
}
