//! Tests the conditions of a feasible layout that the lower bound takes into account: self-collision, overlap
//! of equipment with the robot base, reachable line ends and misplaced spots, and a shared height of the base.
//!
//! The bound is compared with searches, random layouts and random motions, none of which use the proof.

use crate::common::random_cells::random_cell;
use crate::common::{buildable, cases, from_text_to_build, robots, shipped};
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, Coordinate, Layout, NodeAggregation};
use sweetspot::clearance::{FloorPlan, Scene};
use sweetspot::layout::Workcell;
use sweetspot::pose::Pose;
use sweetspot::proof::{Proof, ProofOptions, WhyNot, prove};
use sweetspot::robot::Chain;
use sweetspot::search::{Watch, search};
use sweetspot::units::rad_from_deg;

fn ready(cell: &Cell) -> Workcell {
    Workcell::new(cell.clone()).unwrap()
}

fn proof_of(cell: &Cell, boxes: u64) -> Proof {
    prove(&ready(cell), &ProofOptions { boxes, ..ProofOptions::default() }, &AtomicBool::new(false))
}

fn bound_of(cell: &Cell) -> f64 {
    proof_of(cell, ProofOptions::default().boxes).bound.unwrap()
}

/// Returns the least objective of all layouts that a search evaluates.
fn least_found(cell: &Cell, budget: u64) -> Option<f64> {
    let mut settings = cell.search;
    settings.budget = budget;
    let watch = Watch { progress: &|_| (), stop: &AtomicBool::new(false) };
    search(&ready(cell), &settings, &watch).least
}

/// Two solids that certainly overlap after every motion up to a length still touch after such a motion.
#[test]
fn solids_that_certainly_overlap_touch_after_every_small_motion() {
    let mut rng = ChaCha8Rng::seed_from_u64(71);
    let (mut checked, mut certain) = (0, 0);
    for (stem, robot) in robots() {
        let mut cell = shipped("hitachi_cell.toml");
        cell.robot = robot;
        cell.operations.truncate(1);
        let (scene, chain) = (Scene::new(&cell), Chain::new(&cell.robot));
        let pairs = scene.self_collision_checks(0);
        for _ in 0..cases(200, 2_000) {
            let q: Vec<f64> = chain
                .links
                .iter()
                .map(|l| l.limits.0 + (l.limits.1 - l.limits.0) * rng.random::<f64>())
                .collect();
            let size = 10f64.powf(rng.random_range(-4.0..-0.5));
            let mut frames = [0.0, size].map(|size| {
                let mut moved = [0.0; 8];
                moved.iter_mut().zip(&q).for_each(|(m, q)| *m = q + size * rng.random_range(-1.0..1.0));
                chain.frames(&chain.posture(&moved)).links
            });
            for links in &mut frames {
                links[0] = Pose::identity();
            }
            for &(a, b) in &pairs {
                let (near, far) = (&scene.bounding_spheres()[a], &scene.bounding_spheres()[b]);
                let [before, after] =
                    frames.each_ref().map(|links| links[near.frame].inverse() * links[far.frame]);
                let turn = before.rotation.transpose() * after.rotation;
                let angle = ((turn.trace() - 1.0) / 2.0).clamp(-1.0, 1.0).acos();
                let slid = (before.transform(&far.centre) - after.transform(&far.centre)).norm();
                let by = slid + 2.0 * (angle / 2.0).sin() * far.radius;
                checked += 1;
                if scene.overlap_despite(&frames[0], (a, b), by) {
                    certain += 1;
                    assert!(scene.touches_itself(&frames[0], 0), "{stem}: {a} {b} do not touch before");
                    assert!(scene.touches_itself(&frames[1], 0), "{stem}: {a} {b} do not touch after {by} m");
                }
            }
        }
    }
    println!("{certain} of {checked} pairs certainly overlap");
    assert!(certain > 300, "{certain} of {checked}");
}

/// The self-collision of the youBot arm raises the bound by more than 2 %, close to the best layout found.
#[test]
fn self_collision_raises_the_bound_to_the_best_layout() {
    let cell = shipped("five_axis_cell.toml");
    let mut ghost = cell.clone();
    ghost.collision = false;
    let (bound, free) = (bound_of(&cell), bound_of(&ghost));
    let best = least_found(&cell, 5_000).unwrap();
    println!("bound {bound:e}, without collisions {free:e}, best {best:e}");
    assert!(bound <= best && bound > 0.998 * best && bound > 1.02 * free);
}

/// No placement of random equipment without an overlap brings a node nearer to the base axis than the bound.
#[test]
fn no_layout_without_an_overlap_has_a_node_nearer_to_the_base_axis() {
    let mut rng = ChaCha8Rng::seed_from_u64(73);
    let mut close = 0;
    let rounds = cases(20, 100);
    for _ in 0..rounds {
        let mut cell = shipped("five_axis_cell.toml");
        cell.equipment.truncate(1);
        cell.operations.truncate(1);
        cell.clearance = rng.random_range(0.0..0.03);
        let mut at = |low: f64, high: f64| rng.random_range(low..high);
        cell.robot.footprint.size = (at(0.1, 0.4), at(0.1, 0.4));
        cell.robot.footprint.centre = (at(-0.04, 0.04), at(-0.04, 0.04));
        cell.equipment[0].footprint.size = (at(0.2, 0.9), at(0.2, 0.9));
        cell.equipment[0].footprint.centre = (at(-0.1, 0.1), at(-0.1, 0.1));
        let (size, centre) = (cell.equipment[0].footprint.size, cell.equipment[0].footprint.centre);
        let node = (centre.0 + size.0 * at(-0.6, 0.6), centre.1 + size.1 * at(-0.6, 0.6));
        let plan = FloorPlan::new(&cell);
        let bound = plan.least_distance_from_base(0, (-0.1, 0.1), node);
        let (mut least, mut found): (f64, Vec<_>) = (f64::INFINITY, Vec::new());
        let mut layout: Layout = cell.start();
        for _ in 0..cases(20_000, 100_000) {
            let place = &mut layout.placements[0];
            (place.x, place.y, place.yaw) = (at(-0.9, 0.9), at(-0.9, 0.9), at(-PI, PI));
            let (sin, cos) = place.yaw.sin_cos();
            let there = (place.x + cos * node.0 - sin * node.1, place.y + sin * node.0 + cos * node.1);
            let radius = there.0.hypot(there.1);
            if radius < least {
                plan.overlaps(&layout, &mut found);
                least = if found.is_empty() { radius } else { least };
            }
        }
        assert!(least >= bound, "{least} below {bound}");
        close += usize::from(least < bound + 0.05);
    }
    assert!(2 * close > rounds, "{close} of {rounds} bounds are close");
}

/// A bench that may stand above the robot base has no least distance from the base axis.
#[test]
fn equipment_above_the_base_may_be_near_the_base_axis() {
    let mut cell = shipped("five_axis_cell.toml");
    cell.equipment[0].solids.truncate(1);
    let distance = |z| FloorPlan::new(&cell).least_distance_from_base(0, z, (0.0, 0.2));
    assert!(distance((0.0, 0.05)) >= 0.085 - 1e-8);
    assert_eq!(distance((0.0, 0.5)), 0.0);
}

/// The table can only stand over the robot base, so no distance of its middle from the base axis is allowed.
#[test]
fn equipment_that_always_overlaps_the_base_is_infeasible() {
    for robot in ["kuka_youbot", "ur10e"] {
        let text = format!(
            "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n\
             errors = \"placeholder\"\n[robot]\nfrom = \"robots/{robot}.toml\"\n\
             base = {{ x_mm = 0, y_mm = 0, z_mm = 700, yaw_deg = 0 }}\n\
             [equipment.bench]\nfrom = \"equipment/bench.toml\"\n[equipment.bench.placement]\n\
             x_mm = {{ min = -10, max = 10, start = 0 }}\ny_mm = 0\nz_mm = 650\nyaw_deg = 0\n\
             [operation.assembly]\non = \"bench\"\npoints_mm = [[0, 0]]\nstandoff_mm = 100\n\
             bend_deg = -90\nsense = \"xy\"\n"
        );
        let proof = proof_of(&from_text_to_build(&text).unwrap().cell, 1000);
        assert_eq!(proof.operations[0].value, Err(WhyNot::Infeasible), "{robot}");
    }
}

/// Line ends beyond a joint limit raise the bound of drilling_cell, and the bound stays below the best layout.
#[test]
fn unreachable_line_ends_raise_the_bound() {
    let mut cell = shipped("drilling_cell.toml");
    (cell.collision, cell.transfer) = (false, None);
    cell.base[2] = Coordinate::Fixed(0.03);
    let mut plain = cell.clone();
    plain.operations.iter_mut().for_each(|o| (o.approach, o.retract) = (0.0, 0.0));
    let (bound, without) = (bound_of(&cell), bound_of(&plain));
    let [best, best_without] = [&cell, &plain].map(|cell| least_found(cell, 4_000).unwrap());
    println!("bound {bound:e}, best {best:e}; without lines: bound {without:e}, best {best_without:e}");
    assert!(bound > 1.003 * without && bound <= best);
    assert!(without <= best_without && without > 0.995 * best_without);
}

/// The misplaced spots of hitachi_cell raise the bound to within 0.5 % of the best layout to build.
#[test]
fn misplaced_spots_raise_the_bound_of_layouts_to_build() {
    let cell = buildable("hitachi_cell.toml");
    let mut exact = cell.clone();
    exact.search.ideal = true;
    let (bound, without) = (bound_of(&cell), bound_of(&exact));
    let best = least_found(&cell, 6_000).unwrap();
    println!("bound {bound:e}, without misplacements {without:e}, best {best:e}");
    assert!(bound > without && bound <= best && bound > 0.995 * best);
}

/// Two operations with one height of the robot base have a greater bound than each with its own height.
#[test]
fn a_shared_height_of_the_base_raises_the_bound() {
    let mut cell = shipped("drilling_cell.toml");
    (cell.collision, cell.transfer) = (false, None);
    cell.operations.iter_mut().for_each(|o| (o.approach, o.retract) = (0.0, 0.0));
    let proof = proof_of(&cell, ProofOptions::default().boxes);
    let alone: Vec<f64> = proof.operations.iter().map(|o| o.value.unwrap()).collect();
    let (bound, best) = (proof.bound.unwrap(), least_found(&cell, 8_000).unwrap());
    println!("bound {bound:e}, each alone {:e}, best {best:e}", sweetspot::layout::combined(&cell, &alone));
    assert!(bound > 1.01 * sweetspot::layout::combined(&cell, &alone));
    assert!(bound <= best && bound > 0.99 * best);
}

/// Returns a random cell with lines, a range of the elevation, listed heights, a movable base and operations
/// at every node, each with a certain probability.
fn random_conditions(seed: u64) -> Cell {
    let rng = &mut ChaCha8Rng::seed_from_u64(1_000 + seed);
    let mut cell = from_text_to_build(&random_cell(seed).1).unwrap().cell;
    cell.search.ideal = rng.random_range(0..2) == 0;
    for operation in &mut cell.operations {
        if rng.random_range(0..2) == 0 {
            (operation.approach, operation.retract) =
                (rng.random_range(0.0..0.15), rng.random_range(0.0..0.15));
        }
        if rng.random_range(0..3) == 0 {
            let all = [NodeAggregation::Max, NodeAggregation::Mean, NodeAggregation::P95];
            operation.over = all[rng.random_range(0..all.len())];
        }
        if rng.random_range(0..3) == 0 {
            let [min, max] = [-100.0, -75.0].map(rad_from_deg);
            operation.angles[0] = Some(Coordinate::Range { min, max, start: rad_from_deg(-90.0) });
        }
    }
    for equipment in cell.equipment.iter_mut().filter(|e| e.surface.is_some()) {
        if let (Coordinate::Fixed(z), 0) = (&equipment.placement[2], rng.random_range(0..3)) {
            equipment.placement[2] = Coordinate::List(vec![*z, z + 0.1]);
        }
    }
    if rng.random_range(0..3) == 0 {
        cell.base[2] = Coordinate::Range { min: 0.0, max: 0.2, start: 0.0 };
    }
    cell
}

/// Random cells of four kinematic families with all conditions: no layout of a search is below the bound.
#[test]
fn no_layout_of_a_random_cell_with_conditions_is_below_the_bound() {
    let (mut bounded, mut compared) = (0, 0);
    for seed in 0..cases(60, 1_000) as u64 {
        let cell = random_conditions(seed);
        if Workcell::new(cell.clone()).is_err() {
            continue;
        }
        let Some(bound) = proof_of(&cell, 2_000).bound else { continue };
        bounded += 1;
        let Some(least) = least_found(&cell, cases(250, 1_000) as u64) else { continue };
        compared += 1;
        assert!(bound <= least, "seed {seed}: {bound} above {least}");
    }
    println!("{bounded} cells with a bound, {compared} of them with a feasible layout");
    assert!(compared > 15, "{compared} of {bounded}");
}

/// The flange and the base of the youBot arm are solids of revolution about the axes of their joints.
#[test]
fn solids_of_revolution_are_recognized() {
    let cell = shipped("five_axis_cell.toml");
    let (scene, chain) = (Scene::new(&cell), Chain::new(&cell.robot));
    let frames = chain.frames(&chain.posture(&[0.3; 8])).links;
    let solid = |name: &str| cell.robot.solids.iter().position(|s| s.solid.name == name).unwrap();
    let axis = |carrier: usize, joint: usize| frames[carrier].inverse() * frames[joint];
    assert!(scene.is_round_about(solid("flange"), &axis(5, 4)));
    assert!(scene.is_round_about(solid("base"), &Pose::identity()));
    assert!(!scene.is_round_about(solid("forearm"), &axis(3, 2)));
    let aside = Pose { translation: Vector3::new(0.001, 0.0, 0.0), ..Pose::identity() };
    assert!(!scene.is_round_about(solid("base"), &aside));
}
