//! Tests the regions of the pieces of found layouts: the outlines against layouts at random points, the room,
//! and the choice of a layout with much room.

use crate::common::{buildable, cases, from_text, from_text_to_build};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, Layout, Slot};
use sweetspot::contour::contours;
use sweetspot::layout::{HeldLayout, HeldMemory, Workcell, evaluate};
use sweetspot::region::{Domain, Inside, MovableBody, Region, Regions, TwoLattices};
use sweetspot::search::{SearchRecord, Watch, search};

type Point = (f64, f64);

/// Returns whether a point lies in an odd number of rings.
fn is_in_rings(rings: &[Vec<Point>], p: Point) -> bool {
    let crosses = |(a, b): (&Point, &Point)| {
        (a.1 > p.1) != (b.1 > p.1) && p.0 < (b.0 - a.0) * (p.1 - a.1) / (b.1 - a.1) + a.0
    };
    let edges = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    edges.filter(|edge| crosses(*edge)).count() % 2 == 1
}

/// Returns the distance from a point to the nearest line of the rings.
fn distance_to_rings(rings: &[Vec<Point>], p: Point) -> f64 {
    let edges = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    let distance = |(a, b): (&Point, &Point)| {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let share = ((p.0 - a.0) * dx + (p.1 - a.1) * dy) / (dx * dx + dy * dy).max(1e-30);
        let share = share.clamp(0.0, 1.0);
        (a.0 + share * dx - p.0).hypot(a.1 + share * dy - p.1)
    };
    edges.map(distance).fold(f64::INFINITY, f64::min)
}

/// A disc with a hole, and a second disc.
struct Discs;

impl Inside for Discs {
    type Memory = ();

    fn inside(&self, (x, y): Point, (): &mut ()) -> bool {
        let r = x.hypot(y);
        (0.2..0.7).contains(&r) || (x - 1.4).hypot(y - 1.1) < 0.3
    }
}

#[test]
fn the_outline_of_discs_with_a_hole_is_found() {
    let lattices = TwoLattices {
        domain: Domain { x: (-0.65, 2.0), y: (-2.0, 2.0) },
        origin: (0.45, 0.1),
        step: 0.005,
        coarse: 20,
    };
    let rings = lattices.trace(&Discs);
    assert_eq!(rings.len(), 3, "outer circle, hole, second disc");
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..20_000 {
        let p = (rng.random_range(-0.65..2.0), rng.random_range(-2.0..2.0));
        let is_inside = Discs.inside(p, &mut ());
        assert!(is_in_rings(&rings, p) == is_inside || distance_to_rings(&rings, p) < 0.003, "{p:?}");
    }
    // The vertices of each outline lie on its circle. The domain cuts the first circle.
    for (x, y) in rings.concat() {
        let off = |r: f64, c: Point| ((x - c.0).hypot(y - c.1) - r).abs();
        let nearest = off(0.7, (0.0, 0.0)).min(off(0.2, (0.0, 0.0))).min(off(0.3, (1.4, 1.1)));
        assert!(nearest < 1e-4 || (x + 0.65).abs() < 1e-4, "{x} {y}");
    }
}

/// Two vertices inside that are opposite corners of a square have a contour each.
#[test]
fn vertices_that_meet_at_a_corner_have_separate_contours() {
    let inside = [(0, 0), (1, 1)];
    let starts = inside.map(|(i, j)| ((i, j), (i - 1, j)));
    let found = contours(starts, |vertex| inside.contains(&vertex));
    let expected = inside.map(|(i, j)| [(i - 1, j), (i, j - 1), (i + 1, j), (i, j + 1)].map(|b| ((i, j), b)));
    assert_eq!(found, expected);
    // Every start on a contour that is known already is skipped.
    assert_eq!(contours(expected.concat(), |vertex| inside.contains(&vertex)).len(), 2);
}

fn found(workcell: &Workcell, budget: u64, seed: u64) -> SearchRecord {
    let settings = sweetspot::cell::SearchSettings { budget, seed, ..workcell.cell.search };
    search(workcell, &settings, &Watch { progress: &|_| (), stop: &AtomicBool::new(false) })
}

/// Returns the layout with a piece at a point in plan.
fn placed_at(cell: &Cell, layout: &Layout, body: MovableBody, (x, y): Point) -> Layout {
    let (at, slot): (_, &dyn Fn(usize) -> Slot) = match body {
        MovableBody::Base => (layout.base, &Slot::Base),
        MovableBody::Equipment(k) => (layout.placements[k], &move |axis| Slot::Equipment(k, axis)),
    };
    cell.misplaced(layout, &[(slot(0), x - at.x), (slot(1), y - at.y)])
}

/// At random points inside the outlines, the layout is accepted. At points outside, except in the rim, it is
/// not. At points inside, the full layout is also feasible and has an objective within the indifference.
#[test]
fn everything_holds_inside_the_outlines_and_nothing_outside() {
    for (name, budget) in [("hitachi_cell.toml", 3000), ("ur_cell.toml", 300), ("scara_cell.toml", 300)] {
        let workcell = Workcell::new(buildable(name)).unwrap();
        let best = found(&workcell, budget, 1).best;
        let most = best.evaluation.objective.unwrap() * (1.0 + workcell.cell.search.indifference);
        let regions = Regions::new(&workcell, &best.layout).unwrap();
        assert!(!regions.pieces.is_empty(), "{name}");
        let held = HeldLayout::new(&workcell, &best.layout).unwrap();
        for region in &regions.pieces {
            let mut tried = Tried { inside: 0, outside: 0, count: cases(200, 1000) };
            tried.run(&workcell, &best.layout, region, |layout, is_inside| {
                let held = held.judge(layout, most, &mut HeldMemory::default());
                assert_eq!(held.is_ok(), is_inside, "{name} {:?} {held:?}", region.body);
                if is_inside {
                    let anew = evaluate(&workcell, layout);
                    assert!(anew.is_accepted() && anew.objective.unwrap() <= most, "{name} {anew:?}");
                }
            });
        }
    }
}

/// A layout that is judged with its own spots has exactly the objective of its evaluation, even if a lower
/// bound of the worst case is much cheaper than the worst case.
#[test]
fn a_layout_held_at_its_own_spots_keeps_its_objective() {
    for model in ["linear", "nonlinear"] {
        let text = format!(
            "from = \"hitachi_cell.toml\"\nerrors = \"table-3-tolerance\"\nreading = \"worst-case\"\nmodel = \"{model}\""
        );
        let workcell = Workcell::new(from_text(&text).unwrap().cell).unwrap();
        for seed in 1..=10 {
            let best = found(&workcell, 60, seed).best;
            let Some(held) = HeldLayout::new(&workcell, &best.layout) else { continue };
            let judged = held.judge(&best.layout, f64::INFINITY, &mut HeldMemory::default());
            assert_eq!(judged.ok(), best.evaluation.objective, "{model}, seed {seed}");
        }
    }
}

struct Tried {
    inside: usize,
    outside: usize,
    count: usize,
}

impl Tried {
    /// Judges random points of a region away from its rim, half of them inside and half outside.
    fn run(
        &mut self,
        workcell: &Workcell,
        layout: &Layout,
        region: &Region,
        mut judge: impl FnMut(&Layout, bool),
    ) {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let all: Vec<Point> = region.rings.concat();
        let range = |of: fn(&Point) -> f64| {
            let (low, high) = all.iter().map(of).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            (low - 0.2, high + 0.2)
        };
        let (x, y) = (range(|p| p.0), range(|p| p.1));
        let MovableBody::Equipment(k) = region.body else {
            panic!("no shipped cell of this test moves its base")
        };
        let domain = [0, 1].map(|axis| workcell.cell.equipment[k].placement[axis].range());
        for _ in 0..1_000_000 {
            if self.inside >= self.count && self.outside >= self.count {
                return;
            }
            let p = (rng.random_range(x.0..x.1), rng.random_range(y.0..y.1));
            let is_inside = is_in_rings(&region.rings, p);
            let is_in_range =
                (domain[0].0..=domain[0].1).contains(&p.0) && (domain[1].0..=domain[1].1).contains(&p.1);
            let count = if is_inside { &mut self.inside } else { &mut self.outside };
            if *count >= self.count || !is_in_range || distance_to_rings(&region.rings, p) < region.rim {
                continue;
            }
            *count += 1;
            judge(&placed_at(&workcell.cell, layout, region.body, p), is_inside);
        }
        panic!("only {} points inside and {} outside", self.inside, self.outside);
    }
}

/// The layout is accepted on the circle of the room, and after rotations by the largest angle in both
/// directions.
#[test]
fn the_room_holds_all_round() {
    let workcell = Workcell::new(buildable("hitachi_cell.toml")).unwrap();
    let best = found(&workcell, 3000, 1).best;
    let held = HeldLayout::new(&workcell, &best.layout).unwrap();
    let most = held.objective * (1.0 + workcell.cell.search.indifference);
    let regions = Regions::new(&workcell, &best.layout).unwrap();
    for region in &regions.pieces {
        let MovableBody::Equipment(k) = region.body else { panic!() };
        let at = best.layout.placements[k];
        let (room, turn) = (region.room.unwrap(), region.turn.unwrap());
        assert!(room > 1e-3, "{room}");
        for n in 0..200 {
            let (sin, cos) = (n as f64 * 0.0314159).sin_cos();
            let layout =
                placed_at(&workcell.cell, &best.layout, region.body, (at.x + room * cos, at.y + room * sin));
            held.judge(&layout, most, &mut HeldMemory::default()).unwrap();
        }
        for by in [-turn, turn] {
            let layout = workcell.cell.misplaced(&best.layout, &[(Slot::Equipment(k, 3), by)]);
            held.judge(&layout, most, &mut HeldMemory::default()).unwrap();
        }
        assert!(region.z.0 <= at.z && at.z <= region.z.1 && region.yaw.0 <= at.yaw && at.yaw <= region.yaw.1);
    }
    // All pieces together rotate about the base axis without a change of the errors.
    let whole = regions.whole.unwrap();
    assert!(whole.most - whole.least > 0.1, "{whole:?}");
    for angle in [whole.least, whole.least / 2.0, whole.most / 2.0, whole.most] {
        let mut layout = best.layout.clone();
        let (sin, cos) = angle.sin_cos();
        for (at, equipment) in layout.placements.iter_mut().zip(&workcell.cell.equipment) {
            if equipment.placement[3].is_free() {
                (at.x, at.y, at.yaw) = (cos * at.x - sin * at.y, sin * at.x + cos * at.y, at.yaw + angle);
            }
        }
        let value = held.judge(&layout, most, &mut HeldMemory::default()).unwrap();
        assert!((value - held.objective).abs() < 1e-9, "{value} {}", held.objective);
    }
}

/// Searches with different seeds end with nearly the same room. The room costs at most the indifference.
#[test]
fn all_seeds_end_with_the_same_room() {
    let workcell = Workcell::new(buildable("hitachi_cell.toml")).unwrap();
    let mut rooms = Vec::new();
    for seed in 1..=cases(3, 10) as u64 {
        let record = found(&workcell, 20_000, seed);
        let (least, objective) = (record.least.unwrap(), record.best.evaluation.objective.unwrap());
        assert!(objective <= least * (1.0 + workcell.cell.search.indifference), "{objective} {least}");
        let regions = Regions::new(&workcell, &record.best.layout).unwrap();
        let room = regions.pieces.iter().filter_map(|region| region.room).fold(f64::INFINITY, f64::min);
        rooms.push(room);
    }
    let (low, high) = rooms.iter().fold((f64::MAX, f64::MIN), |(l, h), r| (l.min(*r), h.max(*r)));
    println!("rooms {rooms:?}");
    assert!(high < 1.1 * low, "{rooms:?}");
}

/// The region of a piece that the search moves along one axis is a line. A piece that the search only rotates
/// has no outline.
#[test]
fn a_piece_with_one_free_coordinate_has_a_line() {
    let text = "from = \"hitachi_cell.toml\"\n\
                [equipment.worktable.placement]\nx_mm = { min = 1000, max = 1500, start = 1261 }\ny_mm = -120\nz_mm = 722\n\
                yaw_deg = 0.2\n\
                [equipment.conveyor.placement]\nx_mm = 362\ny_mm = 1516\nyaw_deg = { min = 0, max = 90, start = 52 }\n";
    let workcell = Workcell::new(from_text_to_build(text).unwrap().cell).unwrap();
    let regions = Regions::new(&workcell, &workcell.cell.start()).unwrap();
    let [table, conveyor] = &regions.pieces[..] else { panic!("{regions:?}") };
    let [[(left, y), (right, _)]] = table.rings.iter().map(|r| [r[0], r[1]]).collect::<Vec<_>>()[..] else {
        panic!()
    };
    assert!(left < 1.261 && 1.261 < right && (y + 0.12).abs() < 1e-12, "{left} {right} {y}");
    assert!((table.room.unwrap() - (right - 1.261).min(1.261 - left)).abs() < 1e-12);
    assert!(conveyor.rings.is_empty() && conveyor.room.is_none() && conveyor.turn.unwrap() > 0.0);
}

/// A range of kilometres, or of thousands of turns, is scanned in a bounded number of steps.
#[test]
fn wide_ranges_take_a_bounded_number_of_steps() {
    let text = "from = \"hitachi_cell.toml\"\n\
                [equipment.worktable.placement]\nx_mm = { min = -9000000, max = 9000000, start = 1261 }\ny_mm = -120\n\
                z_mm = 722\nyaw_deg = { min = -9000000, max = 9000000, start = 0.2 }\n\
                [equipment.conveyor.placement]\nx_mm = 362\ny_mm = { min = -2000, max = 2000, start = 1516 }\n\
                yaw_deg = 52\n";
    let workcell = Workcell::new(from_text_to_build(text).unwrap().cell).unwrap();
    let regions = Regions::new(&workcell, &workcell.cell.start()).unwrap();
    let [table, conveyor] = &regions.pieces[..] else { panic!("{regions:?}") };
    assert!(table.room.is_some() && table.turn.is_some() && conveyor.room.is_some(), "{regions:?}");
}
