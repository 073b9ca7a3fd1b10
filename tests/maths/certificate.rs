//! Tests certificates against random misplacements, each judged as a separate layout. Also tests searches for
//! layouts that can be built against scans.

use crate::common::random_cells::random_cell;
use crate::common::{buildable, cases, from_text_to_build, shipped};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use sweetspot::assess::Assessment;
use sweetspot::cell::{Cell, Placement, Slot};
use sweetspot::cli::first_cell_texts;
use sweetspot::error_map::Status;
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::region::{Region, Regions};
use sweetspot::search::{EvaluatedLayout, SearchSpace, Watch, search};
use sweetspot::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg};

/// Numbers of certified and refused operations, and the largest ratio of a certified bound to the worst value
/// found.
#[derive(Default)]
struct Tried {
    certified: usize,
    refused: BTreeMap<String, usize>,
    widest: f64,
}

/// Returns a random misplacement inside the tolerances. With probability 1/2, the misplacement is a corner of
/// the box.
fn random_moves(cell: &Cell, rng: &mut ChaCha8Rng) -> Vec<(Slot, f64)> {
    let corner: bool = rng.random();
    let mut by = |half: f64| match corner {
        true => half * if rng.random() { 1.0 } else { -1.0 },
        false => half * rng.random_range(-1.0..1.0),
    };
    cell.placement_tolerances().concat().into_iter().map(|(slot, half)| (slot, by(half))).collect()
}

impl Tried {
    /// Judges random misplacements of every certified operation of one layout.
    fn misplace(&mut self, workcell: &Workcell, a: &Assessment<'_>, count: usize, rng: &mut ChaCha8Rng) {
        let cell = &workcell.cell;
        let certificate = workcell.certificate(&a.layout, &a.maps);
        for (operation, found) in certificate.operations.iter().enumerate() {
            let most = match found {
                Some(Ok(found)) => found.most,
                Some(Err(why)) => {
                    let word = format!("{why:?}");
                    *self.refused.entry(word.split([' ', '(']).next().unwrap().into()).or_default() += 1;
                    continue;
                }
                None => continue,
            };
            self.certified += 1;
            let mut worst = 0.0f64;
            for _ in 0..count {
                let moves = random_moves(cell, rng);
                match workcell.misplaced_value(&a.layout, &a.maps, operation, &moves) {
                    Ok(value) => worst = worst.max(value),
                    // Floor spaces concern the whole layout.
                    Err(Status::Overlap(_)) if !certificate.overlaps.is_empty() => {}
                    Err(status) => panic!("{} {operation} at {moves:?}: {}", cell.name, status.reason(cell)),
                }
            }
            if let Some(most) = most.filter(|_| worst > 0.0) {
                assert!(worst <= most, "{}: {worst} at a misplacement, certified {most}", cell.name);
                self.widest = self.widest.max(most / worst);
            }
        }
    }
}

/// Certifies random layouts of a shipped cell, and misplaces the certified layouts.
fn misplace_cell(cell: Cell, layouts: usize, count: usize) -> Tried {
    let workcell = Workcell::new(cell).unwrap();
    let space = SearchSpace::new(&workcell.cell);
    let mut rng = ChaCha8Rng::seed_from_u64(15);
    let mut tried = Tried::default();
    for k in 0..layouts {
        let point: Vec<f64> = (0..space.dimensions()).map(|_| rng.random()).collect();
        let layout = if k == 0 { workcell.cell.start() } else { space.layout(&point) };
        tried.misplace(&workcell, &Assessment::new("", &workcell, layout), count, &mut rng);
    }
    tried
}

#[test]
fn no_misplacement_breaks_a_certificate() {
    for (name, layouts) in [
        ("hitachi_cell.toml", 30),
        ("ur_cell.toml", 4),
        ("scara_cell.toml", 15),
        ("five_axis_cell.toml", 10),
        ("palletizer_cell.toml", 10),
        ("wrist_cell.toml", 6),
        ("drilling_cell.toml", 10),
        ("track_cell.toml", 1),
        ("panda_cell.toml", 1),
    ] {
        let tried = misplace_cell(buildable(name), cases(layouts, 20 * layouts), cases(20, 1000));
        let Tried { certified, refused, widest } = tried;
        println!(
            "{name}: {certified} certified, {refused:?} refused, bound at most {widest:.4} of the worst"
        );
        assert!(certified > 0, "{name}");
        // A bound far above every value would hold but would be useless.
        assert!(widest < 1.15, "{name}: {widest}");
    }
}

/// Every posture of these cells has a singularity measure near the margin: the margin is raised to a typical
/// measure of the arm.
#[test]
fn no_misplacement_breaks_a_large_singularity_margin() {
    for (name, margin, layouts) in [
        ("five_axis_cell.toml", 0.15, 20),
        ("scara_cell.toml", 0.2, 20),
        ("palletizer_cell.toml", 0.15, 20),
        ("wrist_cell.toml", 0.05, 10),
        ("ur_cell.toml", 0.05, 5),
        ("track_cell.toml", 0.1, 2),
        ("panda_cell.toml", 0.1, 2),
    ] {
        let mut cell = buildable(name);
        cell.margins.singularity = margin;
        let tried = misplace_cell(cell, cases(layouts, 20 * layouts), cases(50, 1000));
        let Tried { certified, refused, .. } = tried;
        println!("{name}: {certified} certified, {refused:?} refused");
        assert!(certified > 0, "{name}");
    }
}

/// The arm is folded, and its singularity measure is 0.16. The certificate must not take it for a posture below
/// the margin of 0.02.
#[test]
fn a_folded_posture_far_from_singular_postures_is_certified() {
    let workcell = Workcell::new(buildable("five_axis_cell.toml")).unwrap();
    let mut layout = workcell.cell.start();
    let placement =
        |x, y, z, yaw| Placement::from_values([m_from_mm(x), m_from_mm(y), m_from_mm(z), rad_from_deg(yaw)]);
    layout.placements = vec![placement(462.0, 34.0, 800.0, -27.9), placement(76.0, -241.0, 700.0, -12.5)];
    let a = Assessment::new("", &workcell, layout);
    let certificate = workcell.certificate(&a.layout, &a.maps);
    assert!(matches!(certificate.operations[1], Some(Ok(_))), "{:?}", certificate.operations[1]);
}

#[test]
fn no_misplacement_breaks_a_certificate_of_a_random_cell() {
    let (cells, count) = (0..cases(40, 1000) as u64, cases(10, 30));
    let certified: usize = cells
        .into_par_iter()
        .map(|seed| {
            let text = random_cell(seed).1;
            let workcell = Workcell::new(from_text_to_build(&text).unwrap().cell).unwrap();
            let space = SearchSpace::new(&workcell.cell);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let mut tried = Tried::default();
            for _ in 0..5 {
                let point: Vec<f64> = (0..space.dimensions()).map(|_| rng.random()).collect();
                let a = Assessment::new("", &workcell, space.layout(&point));
                tried.misplace(&workcell, &a, count, &mut rng);
            }
            tried.certified
        })
        .sum();
    println!(
        "{} misplacements of {certified} certified operations, none breaks a certificate",
        count * certified
    );
    assert!(certified > 20, "{certified}");
}

fn found(workcell: &Workcell, budget: u64) -> EvaluatedLayout {
    let mut settings = workcell.cell.search;
    settings.budget = budget;
    search(workcell, &settings, &Watch { progress: &|_| (), stop: &AtomicBool::new(false) }).best
}

/// A scan of all placements in steps of 20 mm finds no certified layout that is better by 1 %.
#[test]
fn a_search_finds_the_best_certified_layout_of_a_scan() {
    let text = "from = \"hitachi_cell.toml\"\n\
                [equipment.worktable.placement]\nx_mm = { min = -200, max = 500 }\ny_mm = { min = 800, max = 1300 }\n\
                z_mm = 650\nyaw_deg = 0\n\
                [equipment.conveyor.placement]\nx_mm = 1000\ny_mm = -400\nyaw_deg = 80\n";
    let workcell = Workcell::new(from_text_to_build(text).unwrap().cell).unwrap();
    let best = found(&workcell, 1500).evaluation.objective.expect("a certified layout");
    let mut start = workcell.cell.start();
    let mut scanned = Vec::new();
    for i in 0..=35 {
        for j in 0..=25 {
            (start.placements[0].x, start.placements[0].y) =
                (-0.2 + 0.02 * f64::from(i), 0.8 + 0.02 * f64::from(j));
            scanned.extend(evaluate(&workcell, &start).objective);
        }
    }
    let least = scanned.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(scanned.len() > 50 && scanned.len() < 900, "{} certified", scanned.len());
    assert!(best < 1.01 * least, "{best} {least}");
}

/// A scan of all placements in steps of 20 mm and 15 deg finds no certified layout that is better by 1 %.
#[test]
fn a_search_of_three_variables_finds_the_best_certified_layout_of_a_scan() {
    let text = "from = \"hitachi_cell.toml\"\n\
                [equipment.worktable.placement]\nx_mm = { min = -100, max = 500 }\ny_mm = { min = 800, max = 1200 }\n\
                z_mm = 650\nyaw_deg = { min = -45, max = 45 }\n\
                [equipment.conveyor.placement]\nx_mm = 1000\ny_mm = -400\nyaw_deg = 80\n";
    let workcell = Workcell::new(from_text_to_build(text).unwrap().cell).unwrap();
    let best = found(&workcell, 3000).evaluation.objective.expect("a certified layout");
    let start = workcell.cell.start();
    let scanned: Vec<f64> = (0..31 * 21 * 7)
        .into_par_iter()
        .filter_map(|k| {
            let (i, j, turn) = (k % 31, k / 31 % 21, k / (31 * 21));
            let mut layout = start.clone();
            let at = &mut layout.placements[0];
            (at.x, at.y) = (-0.1 + 0.02 * f64::from(i), 0.8 + 0.02 * f64::from(j));
            at.yaw = rad_from_deg(-45.0 + 15.0 * f64::from(turn));
            evaluate(&workcell, &layout).objective
        })
        .collect();
    let least = scanned.iter().copied().fold(f64::INFINITY, f64::min);
    println!("{} of {} layouts certified, least {least}, search {best}", scanned.len(), 31 * 21 * 7);
    assert!(scanned.len() > 100 && scanned.len() < 4000, "{} certified", scanned.len());
    assert!(best < 1.01 * least, "{best} {least}");
}

/// With the sampled joint held at every misplacement, the certified error would be 4.9 % above the ideal one.
#[test]
fn a_seven_axis_arm_is_certified_at_nearly_its_least_error() {
    let objective = |cell: Cell| {
        let workcell = Workcell::new(cell).unwrap();
        evaluate(&workcell, &workcell.cell.start()).objective.expect("a feasible layout")
    };
    let [ideal, strict] = [shipped("panda_cell.toml"), buildable("panda_cell.toml")].map(objective);
    assert!(strict >= ideal && strict < 1.01 * ideal, "{strict} {ideal}");
}

/// Searches a cell, and misplaces the layout that is found.
fn misplace_best(name: &str, cell: Cell, budget: u64, count: usize) {
    let workcell = Workcell::new(cell).unwrap();
    let best = found(&workcell, budget);
    assert!(best.evaluation.objective.is_some(), "{name}: {:?}", best.evaluation);
    let a = Assessment::new("", &workcell, best.layout);
    assert!(a.certificate.as_ref().is_some_and(|c| c.holds()), "{name}");
    let mut tried = Tried::default();
    tried.misplace(&workcell, &a, count, &mut ChaCha8Rng::seed_from_u64(1));
    assert_eq!(tried.certified, workcell.cell.operations.len(), "{name}");
    println!("{name}: {count} misplacements of {} operations hold", tried.certified);
}

/// Redundant arms and arms without a closed form, whose searches take long.
const SLOW: [&str; 4] = ["kinova_gen3", "kuka_iiwa14", "panda", "ufactory_xarm6"];

/// Number of first cells, which cover all kinds of arms. A short run also tests every fourth of the other
/// cells.
const KINDS: usize = 16;

#[test]
fn the_best_layouts_of_the_first_cells_withstand_random_misplacements() {
    for (k, (name, text)) in first_cell_texts().enumerate() {
        let cell = from_text_to_build(&text).unwrap().cell;
        let is_tried = k < KINDS || k.is_multiple_of(cases(4, 1));
        if is_tried && !SLOW.contains(&name) {
            let budget = cases(120, cell.search.budget as usize) as u64;
            misplace_best(name, cell, budget, cases(20, 1000));
        }
    }
}

/// The full test takes long: `SWEETSPOT_TEST_CASES=full cargo test --test maths of_slow_arms -- --nocapture`.
#[test]
fn the_best_layouts_of_slow_arms_withstand_random_misplacements() {
    for name in ["panda_cell.toml", "offset_wrist_cell.toml"] {
        misplace_best(name, buildable(name), cases(12, 100) as u64, cases(4, 1000));
    }
}

/// Prints the table of results/buildable.
#[test]
fn the_best_layouts_to_build_withstand_random_misplacements() {
    let all = [
        ("hitachi_cell.toml", 2000),
        ("ur_cell.toml", 200),
        ("scara_cell.toml", 200),
        ("five_axis_cell.toml", 300),
        ("palletizer_cell.toml", 200),
        ("wrist_cell.toml", 200),
        ("drilling_cell.toml", 800),
        ("track_cell.toml", 30),
    ];
    println!(
        "| cell | layouts | ideal mm | to build mm | more | worst within the tolerances mm | room mm | room deg |\n\
         |---|---|---|---|---|---|---|---|"
    );
    for (name, budget) in all {
        let [ideal, strict] = [shipped(name), buildable(name)].map(|cell| Workcell::new(cell).unwrap());
        let budget = cases(budget as usize, 10 * budget as usize) as u64;
        let [drawn, best] = [&ideal, &strict].map(|workcell| found(workcell, budget));
        let objective = |found: &EvaluatedLayout| found.evaluation.objective.map(mm_from_m);
        let (Some(least), Some(objective)) = (objective(&drawn), objective(&best)) else {
            panic!("{name}: {:?} {:?}", drawn.evaluation, best.evaluation)
        };
        let a = Assessment::new("", &strict, best.layout);
        assert!(a.certificate.as_ref().is_some_and(|c| c.holds()), "{name}");
        let mut tried = Tried::default();
        tried.misplace(&strict, &a, cases(100, 1000), &mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!(tried.certified, strict.cell.operations.len(), "{name}");
        let worst: Vec<String> = (0..a.maps.len())
            .map(|k| a.worst(k).map_or("-".into(), |worst| format!("{:.4}", mm_from_m(worst))))
            .collect();
        let more = 100.0 * (objective / least - 1.0);
        // Regions take long and are only printed.
        let regions = Some(()).filter(|()| cases(0, 1) == 1).and_then(|()| Regions::new(&strict, &a.layout));
        let pieces = regions.map_or(Vec::new(), |regions| regions.pieces);
        let least_of = |of: fn(&Region) -> Option<f64>| pieces.iter().filter_map(of).reduce(f64::min);
        let room = least_of(|r| r.room).map_or("-".into(), |room| format!("{:.1}", mm_from_m(room)));
        let turn = least_of(|r| r.turn).map_or("-".into(), |turn| format!("{:.2}", deg_from_rad(turn)));
        let worst = worst.join(", ");
        println!(
            "| {name} | {budget} | {least:.4} | {objective:.4} | {more:.2} % | {worst} | {room} | {turn} |"
        );
    }
}
