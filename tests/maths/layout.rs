//! Tests the nearest layout without overlaps against brute force.

use crate::common::{cases, from_text};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{Cell, Layout};
use sweetspot::layout::{Workcell, Workspace, evaluate_in, separated};

/// Returns a table that may stand anywhere within 2 m, and a fixed block.
fn block_and_table() -> Cell {
    let text = r#"
        schema = "sweetspot/cell/1"
        units = { length = "mm", angle = "deg" }
        errors = "table-3"
        clearance_mm = 20
        [robot]
        from = "robots/hitachi_pw10.toml"
        base = { x_mm = 8000, y_mm = 8000, z_mm = 0 }
        [equipment.table]
        surface = { size_mm = [800, 500] }
        placement = { x_mm = { min = -2000, max = 2000 }, y_mm = { min = -2000, max = 2000 }, z_mm = 700, yaw_deg = { min = -90, max = 90 } }
        [obstacle.block]
        footprint = { size_mm = [600, 400] }
        placement = { x_mm = 100, y_mm = -50, z_mm = 0, yaw_deg = 35 }
        [operation.any]
        on = "table"
        grid = [1, 1]
        bend_deg = -90
        sense = "xyz"
    "#;
    from_text(text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

fn overlapping(workcell: &Workcell, layout: &Layout) -> bool {
    overlapping_in(workcell, layout, &mut Workspace::default())
}

fn overlapping_in(workcell: &Workcell, layout: &Layout, workspace: &mut Workspace) -> bool {
    !evaluate_in(workcell, layout, workspace).overlaps.is_empty()
}

/// Returns the shortest shift that removes the overlap, by steps outwards in many directions.
fn brute_force(workcell: &Workcell, layout: &Layout) -> f64 {
    let mut workspace = Workspace::default();
    let mut free_at = |angle: f64, distance: f64| {
        let mut moved = layout.clone();
        moved.placements[0].x += distance * angle.cos();
        moved.placements[0].y += distance * angle.sin();
        !overlapping_in(workcell, &moved, &mut workspace)
    };
    let directions = (0..720).map(|k| f64::from(k) * std::f64::consts::TAU / 720.0);
    // No direction is searched beyond the shortest shift found so far.
    directions.fold(f64::INFINITY, |shortest, angle| {
        let distances = (0..2000).map(|k| f64::from(k) * 1e-3);
        distances.take_while(|d| *d < shortest).find(|d| free_at(angle, *d)).unwrap_or(shortest)
    })
}

#[test]
fn separation_finds_the_nearest_layout_without_overlap() {
    let workcell = Workcell::new(block_and_table()).unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut overlapped = 0;
    while overlapped < cases(4, 20) {
        let mut layout = workcell.cell.start();
        layout.placements[0].x = rng.random_range(-0.6..0.6);
        layout.placements[0].y = rng.random_range(-0.6..0.6);
        layout.placements[0].yaw = rng.random_range(-1.5..1.5);
        if !overlapping(&workcell, &layout) {
            continue;
        }
        overlapped += 1;
        let apart = separated(&workcell, &layout).expect("there is room");
        assert!(!overlapping(&workcell, &apart));
        let (a, b) = (layout.placements[0], apart.placements[0]);
        let shift = (a.x - b.x).hypot(a.y - b.y);
        // The steps of the brute force are a millimetre and half a degree.
        assert!(shift <= brute_force(&workcell, &layout) + 1e-5, "shift {shift}");
    }
}

#[test]
fn a_layout_without_overlap_stays_and_a_fixed_overlap_cannot_be_resolved() {
    let workcell = Workcell::new(block_and_table()).unwrap();
    let mut layout = workcell.cell.start();
    layout.placements[0].x = 1.5;
    assert_eq!(separated(&workcell, &layout), Some(layout));

    let mut cell = block_and_table();
    let start = cell.start().placements[0];
    cell.equipment[0].placement = [0.0, 0.0, start.z, 0.0].map(sweetspot::cell::Coordinate::Fixed);
    let workcell = Workcell::new(cell).unwrap();
    assert!(overlapping(&workcell, &workcell.cell.start()));
    assert_eq!(separated(&workcell, &workcell.cell.start()), None);
}

#[test]
fn the_yaw_of_a_placement_from_the_base_is_at_most_half_a_turn() {
    use sweetspot::cell::Placement;
    let at = |yaw_deg: f64| Placement::from_values([0.1, 0.2, 0.0, f64::to_radians(yaw_deg)]);
    for (table, base, expected) in
        [(315.0, -90.0, 45.0), (-170.0, 100.0, 90.0), (30.0, 10.0, 20.0), (180.0, 0.0, 180.0)]
    {
        let seen = at(table).from_base(&at(base));
        assert!(
            (seen.yaw.to_degrees() - expected).abs() < 1e-9,
            "{table} from {base}: {}",
            seen.yaw.to_degrees()
        );
        assert_eq!(Placement { yaw: 0.0, ..seen }, Placement { yaw: 0.0, ..at(table).seen_from(&at(base)) });
    }
}
