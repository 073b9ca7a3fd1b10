//! Tests the refined spot and the effect of misplacements on a layout. The references are cells with changed
//! numbers, finer grids and scans.

use crate::common::{buildable, from_text, shipped};
use nalgebra::{Vector2, Vector3};
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, Layout, Place, Reading, Slot};
use sweetspot::error_map::{MapperWorkspace, OperationMap, Outcome, Probe, Status};
use sweetspot::layout::{MisplacementEnd, Moves, Workcell, evaluate};
use sweetspot::search::{Watch, search};
use sweetspot::units::{m_from_mm, mm_from_m, rad_from_deg};

/// Placements (mm, degrees) of the robot base, a plinth and a table on it.
type Numbers = [[f64; 4]; 3];

const DRAWN: Numbers = [[0.0; 4], [0.0, 1000.0, 400.0, 5.0], [30.0, -20.0, 200.0, -8.0]];

/// Coordinates that may be misplaced, and by how much.
const LOOSE: [(usize, usize, f64); 5] = [(0, 0, 1.5), (1, 0, 2.0), (1, 3, 0.2), (2, 1, 3.0), (2, 2, 1.0)];

fn stacked(numbers: &Numbers, more: &str, of_operation: &str) -> Cell {
    let tolerance = |body: usize| {
        let keys = LOOSE.iter().filter(|(b, ..)| *b == body);
        let keys: Vec<String> = keys
            .map(|(_, axis, by)| format!("{} = {by}", ["x_mm", "y_mm", "z_mm", "yaw_deg"][*axis]))
            .collect();
        keys.join(", ")
    };
    let place = |[x, y, z, yaw]: [f64; 4]| {
        format!("{{ x_mm = {x:?}, y_mm = {y:?}, z_mm = {z:?}, yaw_deg = {yaw:?} }}")
    };
    let [base, plinth, table] = [0, 1, 2].map(|body| place(numbers[body]));
    let [t0, t1, t2] = [0, 1, 2].map(tolerance);
    let text = format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n{more}\n\
         [robot]\nfrom = \"robots/hitachi_pw10.toml\"\nbase = {base}\nbase_tolerance = {{ {t0} }}\n\
         [equipment.plinth]\nfootprint = {{ size_mm = [100, 100] }}\nplacement = {plinth}\nplacement_tolerance = {{ {t1} }}\n\
         [equipment.table]\nsurface = {{ size_mm = [1000, 500] }}\nstands_on = \"plinth\"\nplacement = {table}\n\
         placement_tolerance = {{ {t2} }}\n\
         [operation.work]\non = \"table\"\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xy\"\n{of_operation}\n"
    );
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

/// Returns the numbers of the cell file of a misplaced layout.
fn moved(drawn: &Numbers, moves: &Moves) -> Numbers {
    let mut numbers = *drawn;
    for (slot, by) in moves {
        match *slot {
            Slot::Base(3) => numbers[0][3] += by.to_degrees(),
            Slot::Base(axis) => numbers[0][axis] += mm_from_m(*by),
            Slot::Equipment(k, 3) => numbers[k + 1][3] += by.to_degrees(),
            Slot::Equipment(k, axis) => numbers[k + 1][axis] += mm_from_m(*by),
            Slot::Attitude(..) => panic!("an attitude is not placed"),
        }
    }
    numbers
}

/// Returns the value of a node in a map if the node has the given branch; None if this branch is lost.
fn node_value(map: &OperationMap, node: usize, branch: u64) -> Option<f64> {
    let node = &map.nodes[node];
    let posture = node.posture.as_ref().filter(|p| node.status == Status::Ok && p.branch == branch)?;
    Some(posture.value)
}

/// Returns all corners of LOOSE, in any order.
fn corners(drawn: &Numbers) -> Vec<Numbers> {
    let corner = |pattern: usize| {
        let mut numbers = *drawn;
        for (k, (body, axis, by)) in LOOSE.iter().enumerate() {
            numbers[*body][*axis] += if pattern >> k & 1 == 1 { *by } else { -by };
        }
        numbers
    };
    (0..1 << LOOSE.len()).map(corner).collect()
}

/// Returns moves of the equipment of the first operation that end half a millimetre before its spot is lost.
fn short_of(workcell: &Workcell) -> Moves {
    let layout = workcell.cell.start();
    let r = workcell.robustness(&layout, &workcell.maps(&layout))[0].clone().expect("a spot");
    let Some(MisplacementEnd::Lost(lost)) = r.shift.ended else { panic!("{:?}", r.shift) };
    let share = (r.shift.most - 5e-4) / r.shift.most;
    lost.moves.iter().map(|(slot, by)| (*slot, by * share)).collect()
}

#[test]
fn misplacement_corners_agree_with_moved_cell_files() {
    let mut lost_somewhere = 0;
    // The equipment stands half a millimetre before the place where the spot is lost.
    let short = short_of(&ideal(Workcell::new(stacked(&DRAWN, "", "grid = [10, 5]")).unwrap()));
    let near = moved(&DRAWN, &short);
    for (drawn, more, operation) in [
        (&near, "", "grid = [10, 5]"),
        (&DRAWN, "", "grid = [10, 5]"),
        (&DRAWN, "registration = \"taught\"", "grid = [10, 5]"),
        (&DRAWN, "reading = \"statistical\"\nquantity = \"p95\"", "points_mm = [[100, -100]]"),
        (
            &DRAWN,
            "reading = \"worst-case\"\nmodel = \"linear\"",
            "points_mm = [[-100, -50], [200, 0]]\nover = \"mean\"",
        ),
    ] {
        let workcell = ideal(Workcell::new(stacked(drawn, more, operation)).unwrap());
        let layout = workcell.cell.start();
        let maps = workcell.maps(&layout);
        let robustness = workcell.robustness(&layout, &maps)[0].clone().expect("a spot");
        assert_eq!(robustness.tolerance.len(), 5);
        let all_nodes = operation.contains("over");
        let nodes: Vec<usize> =
            if all_nodes { (0..maps[0].nodes.len()).collect() } else { vec![maps[0].best.unwrap()] };
        let branch = |node: usize| maps[0].nodes[node].posture.as_ref().unwrap().branch;
        let value_in = |numbers: &Numbers| {
            let workcell = ideal(Workcell::new(stacked(numbers, more, operation)).unwrap());
            let map = &workcell.maps(&workcell.cell.start())[0];
            let values: Option<Vec<f64>> = nodes.iter().map(|n| node_value(map, *n, branch(*n))).collect();
            values.map(|v| v.iter().sum::<f64>() / v.len() as f64)
        };
        let values: Vec<Option<f64>> = corners(drawn).iter().map(value_in).collect();
        let lost = values.iter().filter(|v| v.is_none()).count();
        lost_somewhere += lost;
        assert_eq!((robustness.corners, robustness.lost.len()), (32, lost), "{more}");
        let worst = values.into_iter().flatten().reduce(f64::max);
        match (&robustness.worst, worst) {
            (Some(told), Some(worst)) => {
                assert!((told.value - worst).abs() < 1e-9 * worst, "{more}: {} {worst}", told.value);
                // The reported corner has the reported value.
                let there = value_in(&moved(drawn, &told.moves)).unwrap();
                assert!((told.value - there).abs() < 1e-9 * worst, "{more}: {} {there}", told.value);
                assert!(told.value > robustness.value, "{more}");
            }
            (None, None) => {}
            both => panic!("{more}: {both:?}"),
        }
        for lost in &robustness.lost {
            assert!(!lost.status.reason(&workcell.cell).is_empty());
            assert_eq!(value_in(&moved(drawn, &lost.moves)), None);
        }
    }
    assert!(lost_somewhere > 0, "no corner was lost: nothing was shown of that");
}

#[test]
fn the_gradient_agrees_with_richardson_extrapolation() {
    let operation = "points_mm = [[100, -100]]";
    let workcell = Workcell::new(stacked(&DRAWN, "", operation)).unwrap();
    let layout = workcell.cell.start();
    let robustness = workcell.robustness(&layout, &workcell.maps(&layout))[0].clone().unwrap();
    // The gradient has the four coordinates of the equipment, and the coordinates of base and plinth that
    // have a tolerance.
    assert_eq!(robustness.gradient.len(), 4 + 3);
    let mut steep = 0;
    for (slot, slope) in &robustness.gradient {
        let value = |by: f64| {
            let workcell = Workcell::new(stacked(&moved(&DRAWN, &vec![(*slot, by)]), "", operation)).unwrap();
            workcell.maps(&workcell.cell.start())[0].value.unwrap()
        };
        let central = |h: f64| (value(h) - value(-h)) / (2.0 * h);
        let richardson = (4.0 * central(2.5e-3) - central(5e-3)) / 3.0;
        let slope = slope.unwrap();
        assert!((slope - richardson).abs() < 1e-6, "{slot:?}: {slope} {richardson}");
        steep += usize::from(slope.abs() > 1e-3);
    }
    assert!(steep >= 4, "too flat to tell anything");
}

/// Returns a cell of one table before the paper's robot; `more` belongs to the operation, `tolerance` to the
/// table.
fn one_table(placement: &str, tolerance: &str, more: &str) -> Workcell {
    let text = format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         robot = {{ from = \"robots/hitachi_pw10.toml\" }}\n\
         [equipment.worktable]\nfrom = \"equipment/worktable.toml\"\nplacement = {{ {placement} }}\n{tolerance}\n\
         [operation.assembly]\non = \"worktable\"\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xy\"\n{more}"
    );
    Workcell::new(from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell).unwrap()
}

const THERE: &str = "x_mm = 0, y_mm = 1000, z_mm = 600, yaw_deg = 10";

/// Returns whether the operation keeps its nominal node and branch and its limit in a layout, according to
/// the map.
fn keeps(workcell: &Workcell, layout: &Layout, (node, branch): (usize, u64)) -> bool {
    let value = node_value(&workcell.maps(layout)[0], node, branch);
    let overlaps = !evaluate(workcell, layout).overlaps.is_empty();
    let limit = workcell.cell.operations[0].limit.unwrap_or(f64::INFINITY);
    !overlaps && value.is_some_and(|v| v <= limit)
}

/// Returns the cell with a single node, which is at `position` (world frame, m) in the start layout.
fn with_one_node(workcell: &Workcell, position: &Vector3<f64>) -> Workcell {
    let (mut cell, at) = (workcell.cell.clone(), workcell.cell.start().placements[0]);
    let (away, (sin, cos)) = (position.xy() - Vector2::new(at.x, at.y), at.yaw.sin_cos());
    cell.operations[0].place =
        Place::Points(vec![(cos * away.x + sin * away.y, cos * away.y - sin * away.x)]);
    Workcell::new(cell).unwrap()
}

/// Returns the first of many scales at which one of the layouts does not keep the operation.
fn first_failing(scales: impl Iterator<Item = f64>, keeps: impl Fn(f64) -> bool) -> f64 {
    scales.into_iter().find(|s| !keeps(*s)).expect("it fails somewhere")
}

#[test]
fn the_largest_misplacement_agrees_with_a_scan() {
    let tolerance = "placement_tolerance = { x_mm = 2, yaw_deg = 0.2 }";
    let mut limited = 0;
    for (more, share) in
        [("points_mm = [[100, 0]]", None), ("points_mm = [[100, -100]]", Some(1.01)), ("grid = [6, 4]", None)]
    {
        let mut workcell = one_table(THERE, tolerance, more);
        let layout = workcell.cell.start();
        let value = workcell.maps(&layout)[0].value.unwrap();
        workcell.cell.operations[0].limit = share.map(|share| share * value);
        let maps = workcell.maps(&layout);
        let spot = maps[0].spot().unwrap();
        let r = workcell.robustness(&layout, &maps)[0].clone().unwrap();
        // A cell whose only node is the spot has a faster map.
        let alone = with_one_node(&workcell, &maps[0].nodes[spot.node].position);
        let with = |x: f64, y: f64, yaw: f64| {
            let mut moved = layout.clone();
            moved.placements[0].x += x;
            moved.placements[0].y += y;
            moved.placements[0].yaw += yaw;
            keeps(&alone, &moved, (0, spot.branch))
        };
        let between = |most: f64, first: f64, step: f64| {
            assert!(most < first && most >= first - step, "{more}: {most}, the scan says {first}");
        };
        // The scan has three times as many directions, so it also covers directions between the tested
        // directions. The result may be too small only by the effect of the spacing of the directions and by
        // a step.
        let around = |r: f64| {
            (0..48).all(|k| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 48.0).sin_cos();
                with(r * cos, r * sin, 0.0)
            })
        };
        let step = r.shift.most / 200.0 + 1e-6;
        let near = (0..60).map(|k| 0.9 * r.shift.most + f64::from(k) * step);
        let scales = [0.25, 0.5, 0.75].map(|s| s * r.shift.most).into_iter().chain(near);
        between(r.shift.most, first_failing(scales, around), 0.025 * r.shift.most + step);
        let step = r.turn.most / 60.0 + 1e-6;
        let both = |turn: f64| with(0.0, 0.0, turn) && with(0.0, 0.0, -turn);
        between(r.turn.most, first_failing((0..120).map(|k| f64::from(k) * step), both), step);
        let scale = r.scale.as_ref().unwrap();
        let step = scale.most / 60.0 + 1e-6;
        let signs = || (-1..=1).flat_map(|a| (-1..=1).map(move |b| (f64::from(a), f64::from(b))));
        let boxed =
            |s: f64| signs().all(|(a, b)| with(s * a * m_from_mm(2.0), 0.0, s * b * rad_from_deg(0.2)));
        match scale.ended {
            Some(_) => between(scale.most, first_failing((0..120).map(|k| f64::from(k) * step), boxed), step),
            None => assert!(boxed(scale.most)),
        }
        assert_eq!(r.holds(), scale.most >= 1.0, "{more}");
        limited += usize::from(matches!(r.shift.ended, Some(MisplacementEnd::Limit(_))));
    }
    assert!(limited > 0, "no limit was ever met");
}

#[test]
fn a_requirement_missed_at_the_nominal_layout_allows_no_misplacement() {
    let workcell = one_table(THERE, "", "points_mm = [[100, -100]]\nlimit_mm = 5");
    let layout = workcell.cell.start();
    let r = workcell.robustness(&layout, &workcell.maps(&layout))[0].clone().unwrap();
    assert_eq!((r.shift.most, r.turn.most, r.scale, r.worst), (0.0, 0.0, None, None));
    assert!(matches!(r.shift.ended, Some(MisplacementEnd::Limit(_))));
}

#[test]
fn the_refined_spot_is_as_good_as_a_fine_grid() {
    let mut gained = 0;
    for (placement, of) in [
        (THERE, ""),
        ("x_mm = 200, y_mm = 1050, z_mm = 600, yaw_deg = -15", ""),
        ("x_mm = -300, y_mm = 900, z_mm = 600, yaw_deg = 30", ""),
        (THERE, "registration = \"best-fit\"\nreading = \"worst-case\""),
    ] {
        let with = |grid: &str| {
            let mut workcell = one_table(placement, "", grid).cell;
            if !of.is_empty() {
                workcell.registration = sweetspot::cell::Registration::BestFit;
                workcell.reading = sweetspot::cell::Reading::WorstCase;
            }
            Workcell::new(workcell).unwrap()
        };
        let workcell = with("grid = [6, 4]");
        let layout = workcell.cell.start();
        let maps = workcell.maps(&layout);
        let refined = workcell.refined(&layout, &maps)[0].clone().expect("a spot");
        assert_eq!(refined.node_value, maps[0].value.unwrap());
        assert!(refined.value <= refined.node_value);
        gained += usize::from(refined.value < refined.node_value * 0.999);
        let fine = with("grid = [60, 40]");
        let least = evaluate(&fine, &layout).objective.unwrap();
        assert!(refined.value <= least * (1.0 + 1e-9), "{placement}: {} {least}", refined.value);
        // With a grid spacing of some centimetres, the points between the nodes cannot be much better.
        assert!(refined.value > least * 0.97, "{placement}: {} {least}", refined.value);
        // A node exactly at the refined spot has the same value.
        let (x, y) = (mm_from_m(refined.at.0), mm_from_m(refined.at.1));
        let there = with(&format!("points_mm = [[{x:?}, {y:?}]]\nover = \"best\""));
        let map = &there.maps(&layout)[0];
        let node = map.best_node().expect("usable");
        assert!((map.value.unwrap() - refined.value).abs() < 1e-12, "{:?} {}", map.value, refined.value);
        assert!((node.position - refined.position).norm() < 1e-12);
        let joints = node.posture.as_ref().unwrap().joints;
        assert!(joints.iter().zip(&refined.joints).all(|(a, b)| (a - b).abs() < 1e-9));
    }
    assert!(gained > 0, "nothing was ever gained");
}

#[test]
fn the_refined_spot_of_shipped_cells_is_no_worse_and_keeps_off_touched_points() {
    for (name, taught) in
        [("hitachi_cell.toml", false), ("hitachi_cell.toml", true), ("scara_cell.toml", false)]
    {
        let mut cell = shipped(name);
        if taught {
            cell.registration = sweetspot::cell::Registration::Taught;
        }
        let workcell = Workcell::new(cell).unwrap();
        let layout = workcell.cell.start();
        let maps = workcell.maps(&layout);
        for (map, refined) in maps.iter().zip(workcell.refined(&layout, &maps)) {
            let refined = refined.expect("a spot");
            assert!(refined.value <= map.value.unwrap() && refined.gain() >= 0.0, "{name}");
            // Near a taught point, the rule of the taught frame removes the error.
            let touched = map.nodes.iter().filter(|n| n.posture.as_ref().is_some_and(|p| p.touched));
            let least = touched.map(|n| (n.position - refined.position).norm()).fold(f64::INFINITY, f64::min);
            assert!(least > 0.05, "{name}: {least}");
            assert_eq!(least.is_finite(), taught);
        }
    }
}

/// The test scans the redundant joint at the refined spot in 400 steps between the neighbouring samples. No
/// usable posture may be better by more than 0.1 %.
#[test]
fn the_refined_spot_resolves_the_redundant_joint() {
    for (name, reading) in [
        ("panda_cell.toml", Reading::WorstCase),
        ("track_cell.toml", Reading::WorstCase),
        ("panda_cell.toml", Reading::Statistical),
    ] {
        let mut cell = shipped(name);
        (cell.reading, cell.search.ideal) = (reading, true);
        let workcell = Workcell::new(cell).unwrap();
        let layout = workcell.cell.start();
        let maps = workcell.maps(&layout);
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let placed = workcell.placed(&layout);
        for (map, refined) in maps.iter().zip(workcell.refined(&layout, &maps)) {
            let (refined, mut memory) = (refined.expect("a spot"), MapperWorkspace::default());
            let mut probe = Probe::new(&placed, map.operation, &spots, &mut memory).unwrap();
            let spot = probe.hold(refined.at, refined.branch).unwrap();
            assert!((probe.holding(&spot).unwrap() - refined.value).abs() < 1e-12, "{name}");
            for step in 1..=200 {
                for beside in probe.beside(&spot, f64::from(step) / 200.0) {
                    let value = probe.holding(&beside).unwrap_or(f64::INFINITY);
                    assert!(value >= refined.value * 0.999, "{name}: step {step}, {value} {}", refined.value);
                }
            }
        }
    }
}

/// Returns the cell with a robust search, which evaluates the worst case over the placement tolerances.
fn robust(workcell: &Workcell) -> Workcell {
    let mut cell = workcell.cell.clone();
    (cell.search.robust, cell.search.ideal) = (true, false);
    Workcell::new(cell).unwrap()
}

/// Returns the cell with an ideal search, which evaluates the nominal placements.
fn ideal(workcell: Workcell) -> Workcell {
    let mut cell = workcell.cell;
    cell.search.ideal = true;
    Workcell::new(cell).unwrap()
}

const LOOSE_TABLE: &str = "placement_tolerance = { x_mm = 2, y_mm = 2, z_mm = 1, yaw_deg = 0.2 }";

#[test]
fn the_robust_evaluation_is_the_least_worst_case_of_all_nodes() {
    let mut chosen_otherwise = 0;
    let tables = [(0.0, 1000.0, 10.0), (200.0, 1050.0, -15.0), (-300.0, 900.0, 30.0)];
    for ((x, y, yaw), near) in tables.into_iter().flat_map(|t| [(t, false), (t, true)]) {
        let placement = format!("x_mm = {x}, y_mm = {y}, z_mm = 600, yaw_deg = {yaw}");
        let workcell = ideal(one_table(&placement, LOOSE_TABLE, "grid = [10, 8]"));
        let mut layout = workcell.cell.start();
        if near {
            let short = short_of(&workcell);
            layout.placements[0].x += short[0].1;
            layout.placements[0].y += short[1].1;
        }
        let drawn = &workcell.maps(&layout)[0];
        let corners: Vec<OperationMap> = (0..16)
            .map(|pattern: u64| {
                let sign = |k: u64| if pattern >> k & 1 == 1 { 1.0 } else { -1.0 };
                let mut moved = layout.clone();
                moved.placements[0].x += sign(0) * 0.002;
                moved.placements[0].y += sign(1) * 0.002;
                moved.placements[0].z += sign(2) * 0.001;
                moved.placements[0].yaw += sign(3) * rad_from_deg(0.2);
                workcell.maps(&moved)[0].clone()
            })
            .collect();
        let worst = |node: usize| {
            let posture =
                drawn.nodes[node].posture.as_ref().filter(|_| drawn.nodes[node].status == Status::Ok)?;
            let values = corners.iter().map(|map| node_value(map, node, posture.branch));
            values.chain([Some(posture.value)]).try_fold(0.0, |most: f64, v| Some(most.max(v?)))
        };
        let least = (0..drawn.nodes.len()).filter_map(worst).fold(f64::INFINITY, f64::min);
        let evaluation = evaluate(&robust(&workcell), &layout);
        let objective = evaluation.objective.expect("feasible");
        // The bound covers the whole box of tolerances, not only its corners.
        assert!((least..1.005 * least).contains(&objective), "{objective} {least}");
        let Outcome::Found(spot) = evaluation.outcomes[0] else { panic!("no spot") };
        assert!(worst(spot.node).unwrap() <= objective);
        // The map shows the same spot.
        assert_eq!(robust(&workcell).maps(&layout)[0].spot(), Some(spot));
        chosen_otherwise += usize::from(Some(spot.node) != drawn.best);
    }
    assert!(chosen_otherwise > 0, "the nominal spot always did");
}

#[test]
fn placement_tolerances_do_not_change_a_nominal_evaluation() {
    let [exact, loose] = ["", LOOSE_TABLE].map(|tolerance| one_table(THERE, tolerance, "grid = [10, 8]"));
    let layout = exact.cell.start();
    assert_eq!(evaluate(&exact, &layout), evaluate(&ideal(loose), &layout));
    let loose = one_table(THERE, LOOSE_TABLE, "grid = [10, 8]");
    // A misplacement cannot improve the worst value.
    assert!(evaluate(&robust(&loose), &layout).cost > evaluate(&loose, &layout).cost);
}

#[test]
fn a_layout_that_may_overlap_is_not_robust() {
    let block = |x: f64| {
        format!(
            "grid = [10, 8]\n[obstacle.block]\nfootprint = {{ size_mm = [200, 900] }}\n\
             placement = {{ x_mm = {x}, y_mm = 1000, z_mm = 0 }}\n"
        )
    };
    let there = "x_mm = 0, y_mm = 1000, z_mm = 600";
    // The table of 1500 mm ends at 750 mm, and the block begins 100 mm before its centre, so the gaps are 1,
    // 2.5 and 50 mm.
    for (gap, feasible) in [(1.0, false), (2.5, false), (50.0, true)] {
        let workcell = ideal(one_table(there, LOOSE_TABLE, &block(850.0 + gap)));
        let layout = workcell.cell.start();
        assert!(evaluate(&workcell, &layout).objective.is_some());
        let evaluation = evaluate(&robust(&workcell), &layout);
        // If the table is rotated by 0.2 degrees about its centre, its corner is 1.2 mm farther out.
        assert_eq!(evaluation.objective.is_some(), feasible, "{gap}");
        assert!(evaluation.cost.is_finite() && (evaluation.cost < 1000.0) == feasible);
    }
}

#[test]
fn a_robust_search_beats_the_worst_case_of_the_nominal_layout() {
    let placement = "x_mm = { min = -400, max = 400 }, y_mm = { min = 800, max = 1300 }, z_mm = { min = 500, max = 800 }, \
                     yaw_deg = { min = -20, max = 20 }";
    let nominal = ideal(one_table(placement, LOOSE_TABLE, "grid = [6, 4]"));
    let robust = robust(&nominal);
    let stop = AtomicBool::new(false);
    let watch = Watch { progress: &|_| (), stop: &stop };
    let run = |workcell: &Workcell| {
        let mut settings = workcell.cell.search;
        settings.budget = 800;
        search(workcell, &settings, &watch)
    };
    let (drawn, found) = (run(&nominal).best, run(&robust));
    let as_drawn = evaluate(&robust, &drawn.layout);
    // The choice of a layout with much room gives up a small part of the least objective.
    let (least, hardened) = (found.least.expect("feasible"), found.best);
    assert!(least < as_drawn.cost, "{least} {}", as_drawn.cost);
    let worst = hardened.evaluation.objective.expect("feasible");
    // The worst value over the tolerances must be greater than the nominal value of the best nominal layout.
    assert!(worst > drawn.evaluation.objective.unwrap());
    let maps = robust.maps(&hardened.layout);
    let told = robust.robustness(&hardened.layout, &maps)[0].clone().unwrap();
    assert!(told.lost.is_empty() && told.holds());
    let sampled = told.worst.unwrap().value.max(told.value);
    assert!((sampled..1.005 * sampled).contains(&worst), "{worst} {sampled}");
}

#[test]
fn placement_tolerances_are_read_in_si_units() {
    let text = std::fs::read_to_string(crate::common::root().join("tests/data/every_key.toml")).unwrap();
    let cell = from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell;
    let close = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
    assert!(close(cell.base_tolerance.0, [0.0005, 0.0, 0.0, std::f64::consts::PI / 3600.0]));
    assert!(close(cell.equipment[0].tolerance.0, [0.002, 0.003, 0.001, std::f64::consts::PI / 900.0]));
    // The file states no tolerance for the other equipment, so a tolerance is assumed only if the search
    // places this equipment.
    let [_, other, ..] = &cell.equipment[..] else { panic!("one piece of equipment") };
    let is_placed = other.placement.iter().any(sweetspot::cell::Coordinate::is_free);
    let assumed = [0.002, 0.002, 0.002, std::f64::consts::PI / 900.0];
    assert!(close(other.tolerance.0, if is_placed { assumed } else { [0.0; 4] }));
    assert!(cell.search.robust && cell.has_placement_tolerance());
    // The base has two tolerances, and the table has four. Coordinates without a tolerance are not listed.
    let listed: Vec<usize> = cell.placement_tolerances().iter().map(Vec::len).collect();
    assert_eq!(listed[..2], [2, 4]);
}

/// The corners of the tolerances are always checked, also if a certificate replaces the search for the
/// largest misplacement up to the tolerances. If all misplacements up to the tolerances are allowed, no
/// corner is lost.
#[test]
fn no_corner_is_lost_within_the_largest_allowed_misplacement() {
    let (mut wide, mut count) = (0, 0);
    for name in ["drilling_cell.toml", "five_axis_cell.toml", "hitachi_cell.toml", "palletizer_cell.toml"] {
        for mut cell in [shipped(name), buildable(name)] {
            cell.search.budget = 300;
            let workcell = Workcell::new(cell).unwrap();
            let watch = Watch { progress: &|_| (), stop: &AtomicBool::new(false) };
            let best = search(&workcell, &workcell.cell.search, &watch).best;
            let maps = workcell.maps(&best.layout);
            for (map, robustness) in maps.iter().zip(workcell.robustness(&best.layout, &maps)) {
                let Some((r, scale)) = robustness.as_ref().and_then(|r| Some((r, r.scale.as_ref()?))) else {
                    continue;
                };
                let limit = workcell.cell.operations[map.operation].limit;
                let misses = r.worst.as_ref().zip(limit).is_some_and(|(worst, limit)| worst.value > limit);
                let holds = r.lost.is_empty() && !misses;
                assert!(scale.most < 1.0 || holds, "{name}, operation {}: {r:?}", map.operation);
                wide += usize::from(scale.most >= 1.0);
                count += 1;
            }
        }
    }
    assert!(wide > 4 && count > 8, "{wide} of {count}");
}
