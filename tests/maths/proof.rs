//! Tests the lower bound of the objective against brute force, known optima, random postures and layouts.
//!
//! Brute force and random postures use the inverse kinematics and the error evaluator. The proof uses neither
//! of them, but only the joint axes in space.

use crate::common::{cases, cell_of_robot, from_text, robots, root, shipped};
use crate::elastic::random_waves;
use nalgebra::{DMatrix, Matrix3, Vector3, Vector6};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{
    Attitude, Cell, Coordinate, Covariance, ErrorSet, JointKind, MeasuredErrors, Model, NodeAggregation,
    Objective, Parameter, Quantity, Reading, Registration, Robot, Sense, SignedErrors,
};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::pose::Pose;
use sweetspot::proof::{Covers, OperationRegion, Proof, ProofOptions, WhyNot, prove, tangent};
use sweetspot::reading::norm::NormDistribution;
use sweetspot::reading::{WorkContext, WorkFrame};
use sweetspot::search::{SearchSpace, Watch, search};
use sweetspot::units::{mm_from_m, rad_from_deg};

fn proof_of(workcell: &Workcell, boxes: u64) -> Proof {
    prove(workcell, &ProofOptions { boxes, ..ProofOptions::default() }, &AtomicBool::new(false))
}

fn ready(cell: &Cell) -> Workcell {
    Workcell::new(cell.clone()).unwrap()
}

/// Lower bound of hitachi_cell, on which brute force and search agree (tests/maths/bound.rs), mm.
const HITACHI_MM: f64 = 20.429670;

#[test]
fn the_bound_of_hitachi_cell_closes_its_gap() {
    let proof = proof_of(&ready(&shipped("hitachi_cell.toml")), 10_000);
    let bound = mm_from_m(proof.bound.unwrap());
    assert!((0.999 * HITACHI_MM..=HITACHI_MM).contains(&bound), "{bound}");
    assert_eq!(proof.covers, Covers::Everything);
    let boxes: u64 = proof.operations.iter().map(|o| o.boxes).sum();
    assert!(boxes < 1000, "{boxes}");
}

/// Returns the least value of the first operation with the TCP at a radius and a height (m), by inverse
/// kinematics.
fn at(workcell: &Workcell, radius: f64, height: f64) -> f64 {
    let operation = &workcell.cell.operations[0];
    let (inverse, evaluator) = (workcell.inverse(), workcell.evaluator(0));
    let site = WorkFrame {
        equipment: operation.equipment,
        work: Pose::identity(),
        world: nalgebra::Matrix3::identity(),
        taught: None,
    };
    let situation = WorkContext { site, reference: None };
    let approach = inverse.tool_attitudes(&operation.attitude, 0.0);
    let (mut memory, mut least) = (evaluator.memory(), f64::INFINITY);
    inverse.visit(&Vector3::new(radius, 0.0, height), &approach, &mut inverse.scratch(), |_, posture| {
        let value = evaluator.value(&situation, &inverse.chain().frames(posture), &mut memory);
        least = least.min(value);
    });
    least
}

/// Returns an upper bound of the least value, by a scan over radius and height and then by finer and finer
/// grids.
fn brute(workcell: &Workcell, (low, high): (f64, f64)) -> f64 {
    let reach = workcell.cell.robot.reach();
    let heights = if high - low < 1e-5 { 1 } else { 61 };
    let height = |j: i32| low + (high - low) * (f64::from(j) + 0.5) / f64::from(heights);
    let points = (0..heights).flat_map(|j| (0..400).map(move |i| (reach * f64::from(i) / 400.0, height(j))));
    let scanned: Vec<_> = points.map(|(r, h)| (at(workcell, r, h), r, h)).collect();
    let mut best = scanned.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    let mut step = (reach / 400.0, (high - low) / f64::from(heights));
    for _ in 0..60 {
        let (_, r, h) = best;
        for (i, j) in (-3..=3).flat_map(|i| (-3..=3).map(move |j| (i, j))) {
            let (r, h) =
                (r + step.0 * f64::from(i) / 3.0, (h + step.1 * f64::from(j) / 3.0).clamp(low, high));
            let value = at(workcell, r.max(0.0), h);
            if value < best.0 {
                best = (value, r, h);
            }
        }
        step = (0.75 * step.0, 0.75 * step.1);
    }
    best.0
}

/// Returns whether joint coordinates are within the limits, and have the stated height, elevation and value.
fn is_allowed(workcell: &Workcell, region: &OperationRegion, value: f64, q: &[f64; 8]) -> bool {
    let (evaluator, chain) = (workcell.evaluator(0), workcell.inverse().chain());
    let frames = chain.frames(&chain.posture(q));
    let elevation = (frames.tcp.rotation * chain.tool_axis).z.asin();
    let (low, high) = region.elevation.unwrap();
    let site = WorkFrame {
        equipment: region.operation,
        work: Pose::identity(),
        world: nalgebra::Matrix3::identity(),
        taught: None,
    };
    let again = evaluator.value(&WorkContext { site, reference: None }, &frames, &mut evaluator.memory());
    let within = |x: f64, (low, high): (f64, f64), by: f64| low - by <= x && x <= high + by;
    chain.links.iter().zip(q).all(|(link, q)| within(*q, link.limits, 3e-6))
        && within(frames.tcp.translation.z, region.height, 1e-8)
        && within(elevation, (low, high), 1e-5)
        && (again - value).abs() < 1e-12
}

/// The arms have random lengths, offsets, errors, limits, bends, heights, senses and models.
#[test]
fn the_bound_of_random_planar_arms_agrees_with_brute_force() {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let (mut closed, mut reachable) = (0, 0);
    for case in 0..40 {
        let mut cell = shipped("hitachi_cell.toml");
        cell.collision = false;
        cell.operations.truncate(1);
        for joint in &mut cell.robot.joints[1..] {
            joint.l *= rng.random_range(0.5..1.5);
            let middle = rng.random_range(-0.7..0.7);
            let half = rng.random_range(0.3..2.0);
            joint.limits = (middle - half, middle + half);
        }
        cell.robot.joints[0].l = rng.random_range(-0.3..0.3);
        cell.robot.joints[0].limits = (-PI, PI);
        let axes = cell.robot.axes();
        let mut error = |size: f64| (0..axes).map(|_| rng.random_range(-size..size)).collect::<Vec<f64>>();
        let (lengths, angles) = ([error(3e-3), error(3e-3)], [error(0.02), error(0.02), error(0.01)]);
        let mut values = vec![0.0; sweetspot::cell::Parameter::count(axes)];
        for i in 0..axes {
            values[5 * i..5 * i + 5].copy_from_slice(&[
                angles[0][i],
                lengths[0][i],
                lengths[1][i],
                angles[1][i],
                angles[2][i],
            ]);
        }
        cell.robot.errors = vec![ErrorSet::Signed(SignedErrors::of_values("random".into(), axes, &values))];
        cell.errors = 0;
        cell.model = [Model::Nonlinear, Model::Linear, Model::Nonlinear][case % 3];
        let operation = &mut cell.operations[0];
        operation.sense = Sense::plain(["xy", "z", "xyz"][case / 3 % 3]).unwrap();
        operation.attitude = Attitude::elevation(-FRAC_PI_2 * rng.random_range(0.3..1.0));
        if case % 2 == 0 {
            operation.attitude = Attitude::elevation(-FRAC_PI_2);
        }
        let low = rng.random_range(0.2..0.8);
        let by = if case % 4 < 2 { 0.0 } else { rng.random_range(0.05..0.5) };
        let table = &mut cell.equipment[operation.equipment].placement;
        table[2] = Coordinate::Range { min: low, max: low + by, start: low };
        let region = OperationRegion::new(&cell, 0, None);
        let workcell = ready(&cell);
        let found = &proof_of(&workcell, 50_000).operations[0];
        // The heights exclude the slack of the region.
        let inside = (region.height.0 + 2e-6, (region.height.1 - 2e-6).max(region.height.0 + 2e-6));
        // The grid may miss a corner of the region. A witness counts if its value is confirmed.
        let witness = found.witness.filter(|(value, q)| is_allowed(&workcell, &region, *value, q));
        let brute = brute(&workcell, inside).min(witness.map_or(f64::INFINITY, |w| w.0));
        match found.value {
            Ok(bound) => {
                assert!(bound <= brute, "case {case}: {bound} above {brute}");
                reachable += 1;
                // The slack of the heights limits the accuracy of a value near zero.
                let is_closed = bound >= 0.995 * brute - 1e-7;
                closed += usize::from(is_closed);
                if !is_closed {
                    println!("case {case}: {found:?}, brute force {brute:e}");
                }
            }
            Err(why) => {
                assert_eq!(why, WhyNot::Infeasible, "case {case}: brute force finds {brute}");
                assert_eq!(brute, f64::INFINITY, "case {case}: a posture is worth {brute}");
            }
        }
    }
    println!("{closed} closed of {reachable}");
    assert!(reachable >= 20 && closed == reachable, "{closed} of {reachable} are closed");
}

/// Checks that no random posture that an operation could have in some layout has a value below the bound.
fn nothing_is_below(name: &str, cell: &Cell, boxes: u64, tries: usize) -> Proof {
    judged(name, cell, boxes, tries).0
}

/// Checks like [`nothing_is_below`], and returns also the sum of the least values tried in each operation.
///
/// Random postures may collide, and their spots may overlap the base, so collisions are not checked here.
fn judged(name: &str, cell: &Cell, boxes: u64, tries: usize) -> (Proof, f64) {
    let mut cell = cell.clone();
    (cell.collision, cell.search.ideal) = (false, true);
    let (cell, workcell) = (&cell, ready(&cell));
    let proof = proof_of(&workcell, boxes);
    let (mut rng, mut sum) = (ChaCha8Rng::seed_from_u64(11), 0.0);
    for (k, found) in proof.operations.iter().enumerate() {
        let Ok(bound) = found.value else { continue };
        let (operation, evaluator, inverse) =
            (&cell.operations[k], workcell.evaluator(k), workcell.inverse());
        let region = OperationRegion::new(cell, k, inverse.fixed_elevation());
        let site = WorkFrame {
            equipment: operation.equipment,
            work: Pose::identity(),
            world: nalgebra::Matrix3::identity(),
            taught: None,
        };
        let situation = WorkContext { site, reference: None };
        let (mut memory, mut scratch) = (evaluator.memory(), inverse.scratch());
        let mut least = f64::INFINITY;
        for _ in 0..tries {
            let approach = inverse.tool_attitudes(&operation.attitude, rng.random_range(-PI..PI));
            let (reach, turn) = (cell.robot.reach(), rng.random_range(-PI..PI));
            let (low, high) = region.radius.unwrap_or((0.0, reach));
            let radius = rng.random_range(low..high.min(reach).max(low + 1e-9));
            let height = rng.random_range(region.height.0..region.height.1);
            let target = Vector3::new(radius * turn.cos(), radius * turn.sin(), height);
            inverse.visit(&target, &approach, &mut scratch, |_, posture| {
                let value = evaluator.value(&situation, &inverse.chain().frames(posture), &mut memory);
                least = least.min(value);
            });
        }
        println!("{name}, {}: bound {bound:e}, least tried {least:e}, boxes {}", operation.name, found.boxes);
        assert!(bound <= least, "{name}, {}: {bound} above {least}", operation.name);
        sum += least;
    }
    (proof, sum)
}

#[test]
fn no_posture_of_a_shipped_cell_is_below_the_bound() {
    for name in ["hitachi_paper", "palletizer_cell", "scara_cell", "five_axis_cell", "wrist_cell", "ur_cell"]
    {
        let proof = nothing_is_below(name, &shipped(&format!("{name}.toml")), 5_000, 1_000);
        let small = !["wrist_cell", "ur_cell"].contains(&name);
        assert!(!small || proof.bound.unwrap() > 0.0, "{name}");
    }
    // Arms with so many joints need more boxes for a tight bound, but the bound must still hold.
    for name in ["offset_wrist_cell", "panda_cell", "track_cell"] {
        nothing_is_below(name, &shipped(&format!("{name}.toml")), 2_000, 30);
    }
}

/// Every combination of reading, model, quantity and sense that has a bound is tested on arms of three
/// kinematic families.
#[test]
fn no_random_posture_is_below_the_bound_in_any_reading() {
    let readings = [
        (Reading::Signed, Quantity::Rms),
        (Reading::WorstCase, Quantity::Rms),
        (Reading::Statistical, Quantity::Rms),
        (Reading::Statistical, Quantity::Mean),
        (Reading::Statistical, Quantity::P95),
        (Reading::Statistical, Quantity::P99),
    ];
    for name in ["hitachi_cell", "scara_cell", "wrist_cell"] {
        for (reading, quantity) in readings {
            for model in Model::ALL {
                for sense in ["xy", "z", "xyz", "x", "rotation", "rz", "xyz@tool"] {
                    let mut cell = shipped(&format!("{name}.toml"));
                    (cell.reading, cell.quantity, cell.model) = (reading, quantity, model);
                    cell.operations.truncate(1);
                    cell.operations[0].sense = Sense::plain(sense).unwrap();
                    let tolerance = cell.error_set().tolerance();
                    if reading == Reading::Signed {
                        let values: Vec<f64> = tolerance.spreads.iter().map(|s| s.plus_minus).collect();
                        let axes = cell.robot.axes();
                        cell.robot.errors[cell.errors] =
                            ErrorSet::Signed(SignedErrors::of_values("plus".into(), axes, &values));
                    }
                    let what = format!("{name} {reading:?} {quantity:?} {model:?} {sense}");
                    let proof = nothing_is_below(&what, &cell, cases(300, 600) as u64, 60);
                    let turns = sense.starts_with('r') && model != Model::Linear;
                    let refused = turns && reading != Reading::Statistical;
                    let why = proof.operations[0].value.err();
                    assert_eq!(why == Some(WhyNot::Rotation), refused, "{what}: {why:?}");
                    assert!(refused || why.is_none() || why == Some(WhyNot::Boxes), "{what}: {why:?}");
                }
            }
        }
    }
}

/// Returns a tolerance set with random errors of rows, base, tool and joint frames. Some of them are 0.
fn random_tolerances(robot: &Robot, rng: &mut ChaCha8Rng) -> ErrorSet {
    let axes = robot.axes();
    let value = |p: Parameter| match p {
        _ if p.is_elastic() || rng.random_range(0..3) == 0 => 0.0,
        Parameter::Dl(_) | Parameter::Dr(_) => rng.random_range(0.0..3e-4),
        Parameter::Base(c) | Parameter::Tool(c) | Parameter::Joint(0, c) if c < 3 => {
            rng.random_range(0.0..6e-4)
        }
        Parameter::Dalpha(_) | Parameter::Dbeta(_) | Parameter::Dq(_) => rng.random_range(0.0..3e-4),
        Parameter::Base(_) | Parameter::Tool(_) | Parameter::Joint(0, _) => rng.random_range(0.0..6e-4),
        _ => 0.0,
    };
    let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
    ErrorSet::Tolerance(ErrorSet::Signed(SignedErrors::of_values("drawn".into(), axes, &values)).tolerance())
}

/// Errors before the first joint and after the last joint rotate about the axes of these joints, which have
/// no coordinate in the boxes. The bound stays below every posture tried. For most RMS values and
/// percentiles, it is close to the least value.
#[test]
fn errors_that_rotate_about_the_first_or_last_axis_are_bounded() {
    let mut rng = ChaCha8Rng::seed_from_u64(59);
    let mut close = [0, 0];
    for round in 0..cases(2, 12) {
        for name in ["scara_cell", "five_axis_cell", "wrist_cell", "ur_cell", "palletizer_cell"] {
            for sense in ["xy", "z", "xyz", "rotation"] {
                let mut cell = shipped(&format!("{name}.toml"));
                cell.operations.truncate(1);
                cell.operations[0].sense = Sense::plain(sense).unwrap();
                let tilts = ["wrist_cell", "ur_cell"].contains(&name) && rng.random_range(0..2) == 0;
                if tilts {
                    cell.operations[0].attitude.elevation = rng.random_range(-1.5..-0.6);
                }
                cell.reading = [Reading::Statistical, Reading::WorstCase][usize::from(round % 2 == 1)];
                cell.model = Model::Linear;
                let quantities = [Quantity::Rms, Quantity::P95, Quantity::Mean];
                cell.quantity = quantities[rng.random_range(0..quantities.len())];
                cell.robot.errors[cell.errors] = random_tolerances(&cell.robot, &mut rng);
                let what = format!("{name} {:?} {:?} {sense}, tilted {tilts}", cell.reading, cell.quantity);
                let (proof, least) = judged(&what, &cell, 3_000, 1_500);
                if cell.reading == Reading::Statistical && cell.quantity != Quantity::Mean {
                    close[0] += usize::from(proof.bound.unwrap_or(0.0) > 0.7 * least);
                    close[1] += 1;
                }
            }
        }
    }
    println!("{} of {} bounds are close", close[0], close[1]);
    assert!(3 * close[0] >= 2 * close[1], "{close:?}");
}

/// The track moves the arm along the table, and the Panda has one joint more than a pose needs.
#[test]
fn the_bound_of_redundant_arms_is_close_to_the_best_layout() {
    for name in ["track_cell", "panda_cell"] {
        let workcell = ready(&shipped(&format!("{name}.toml")));
        let proof = proof_of(&workcell, ProofOptions::default().boxes);
        let mut settings = workcell.cell.search;
        settings.budget = 150;
        let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
        let best = search(&workcell, &settings, &watch).best.evaluation.objective.unwrap();
        let gap = proof.gap(best).unwrap();
        println!("{name}: gap {gap}");
        assert!((0.0..0.02).contains(&gap) && proof.bound < Some(best), "{name}: {gap}");
    }
}

/// Returns a cell of one robot of the library with one table that may move, and a random question about it.
fn random_question(stem: &str, rng: &mut ChaCha8Rng) -> Cell {
    let mut cell = from_text(&cell_of_robot(stem)).unwrap().cell;
    cell.collision = false;
    let reach = cell.robot.reach().min(3.0);
    let free = |min: f64, max: f64| Coordinate::Range { min, max, start: (min + max) / 2.0 };
    let height = rng.random_range(-0.1..0.3) * reach;
    let heights = match rng.random_range(0..3) {
        0 => Coordinate::Fixed(height),
        1 => Coordinate::List(vec![height, height + 0.2 * reach]),
        _ => free(height, height + 0.2 * reach),
    };
    cell.equipment[0].placement =
        [free(0.2 * reach, 0.7 * reach), free(-0.5 * reach, 0.5 * reach), heights, free(-1.0, 1.0)];
    (cell.model, cell.quantity) = (
        Model::ALL[rng.random_range(0..3)],
        [Quantity::Rms, Quantity::Mean, Quantity::P95, Quantity::P99][rng.random_range(0..4)],
    );
    if rng.random_range(0..2) == 0 {
        cell.robot.errors[cell.errors] = random_tolerances(&cell.robot, rng);
    }
    cell.reading = [Reading::Signed, Reading::WorstCase, Reading::Statistical][rng.random_range(0..3)];
    let set = cell.error_set().clone();
    if cell.reading == Reading::Signed && !matches!(set, ErrorSet::Signed(_)) {
        let values: Vec<f64> = set.tolerance().spreads.iter().map(|s| s.plus_minus).collect();
        let sample = SignedErrors::of_values("plus".into(), cell.robot.axes(), &values);
        cell.robot.errors[cell.errors] = ErrorSet::Signed(sample);
    }
    let operation = &mut cell.operations[0];
    operation.sense = Sense::plain(["xy", "z", "xyz", "rotation"][rng.random_range(0..4)]).unwrap();
    operation.over = [NodeAggregation::Best, NodeAggregation::Max][rng.random_range(0..2)];
    let tilted = rng.random_range(0..2) == 0;
    if tilted {
        operation.attitude = Attitude::elevation(rng.random_range(-1.5..-0.5));
        if Workcell::new(cell.clone()).is_err() {
            cell.operations[0].attitude = Attitude::elevation(-FRAC_PI_2);
        }
    }
    cell
}

/// Cells of every robot of the library, with random readings, models, senses and errors. The heights of the
/// table are fixed, listed or free. The bound is compared with random layouts and with the best layout of a
/// search.
#[test]
fn no_layout_of_a_random_cell_is_below_the_bound() {
    let mut rng = ChaCha8Rng::seed_from_u64(61);
    let (mut cells, mut bounded, mut feasible) = (0, 0, 0);
    for _ in 0..cases(1, 6) {
        for (stem, _) in robots() {
            let cell = random_question(&stem, &mut rng);
            let Ok(workcell) = Workcell::new(cell.clone()) else { continue };
            let proof = proof_of(&workcell, cases(500, 5_000) as u64);
            let Some(bound) = proof.bound else {
                cells += 1;
                continue;
            };
            let space = SearchSpace::new(&cell);
            let numeric = workcell.inverse().family().contains("numeric");
            let tries = if numeric { 3 } else { cases(40, 150) };
            let point = |rng: &mut ChaCha8Rng| -> Vec<f64> {
                (0..space.dimensions()).map(|_| rng.random_range(0.0..1.0)).collect()
            };
            let mut values: Vec<f64> = (0..tries)
                .filter_map(|_| evaluate(&workcell, &space.layout(&point(&mut rng))).objective)
                .collect();
            let mut settings = cell.search;
            settings.budget = if numeric { 10 } else { cases(60, 150) as u64 };
            let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
            values.extend(search(&workcell, &settings, &watch).best.evaluation.objective);
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let asked = (cell.reading, cell.model, cell.quantity, cell.operations[0].sense.name.clone());
            assert!(bound <= least, "{stem} {asked:?}: {bound} is above {least}");
            println!("{stem} {asked:?}: bound {bound:.3e}, least {least:.3e}");
            (cells, bounded) = (cells + 1, bounded + usize::from(bound > 0.0));
            feasible += usize::from(!values.is_empty());
        }
    }
    println!("{cells} cells, {bounded} with a bound above 0, {feasible} feasible");
    assert!(4 * bounded > cells && 4 * feasible > cells, "{cells} {bounded} {feasible}");
}

#[test]
fn random_layouts_never_beat_the_bound() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for name in ["hitachi_cell", "palletizer_cell", "scara_cell", "five_axis_cell"] {
        // A cost of tolerances has no bound.
        for objective in [Objective::WeightedSum, Objective::WeightedMaximum, Objective::Lexicographic] {
            let mut cell = shipped(&format!("{name}.toml"));
            cell.search.objective = objective;
            cell.operations[0].weight = 2.0;
            let workcell = ready(&cell);
            let (proof, space) = (proof_of(&workcell, 5_000), SearchSpace::new(&cell));
            let each: Vec<f64> = proof.operations.iter().map(|o| o.value.unwrap()).collect();
            let whole = match objective {
                Objective::WeightedSum => 2.0 * each[0] + each[1],
                Objective::WeightedMaximum => (2.0 * each[0]).max(each[1]),
                _ => sweetspot::layout::combined(&cell, &each),
            };
            assert_eq!(proof.bound, Some(whole));
            let mut feasible = 0;
            for _ in 0..300 {
                let point: Vec<f64> = (0..space.dimensions()).map(|_| rng.random_range(0.0..1.0)).collect();
                if let Some(value) = evaluate(&workcell, &space.layout(&point)).objective {
                    feasible += 1;
                    assert!(value >= whole, "{name}: {value} below {whole}");
                }
            }
            assert!(feasible > 0, "{name}: no layout was feasible");
        }
    }
}

/// The tangent that replaces a percentile lies below the percentile everywhere, and close to it at the point
/// of contact.
#[test]
fn the_tangent_bound_is_below_the_percentile() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut covariance = |rows: usize| {
        let thin: f64 = rng.random_range(0.0..1.0);
        let mut m = Matrix3::zeros();
        for k in 0..3 {
            let scale = if k == 0 { 1.0 } else { thin.powi(4 * k) };
            let v = Vector3::from_fn(|i, _| if i < rows { scale * rng.random_range(-1.0..1.0) } else { 0.0 });
            m += v * v.transpose();
        }
        m
    };
    let quantile = |m: &Matrix3<f64>, rows: usize, p: f64| {
        let eigen = m.symmetric_eigen();
        let column = |k: usize| {
            let v = eigen.eigenvectors.column(k) * eigen.eigenvalues[k].max(0.0).sqrt();
            Vector6::new(v[0], v[1], v[2], 0.0, 0.0, 0.0)
        };
        NormDistribution::new(rows, &[column(0), column(1), column(2)], &[], &Vector6::zeros()).quantile(p)
    };
    for rows in 1..=3 {
        for (quantity, p) in [(Quantity::P95, 0.95), (Quantity::P99, 0.99)] {
            for _ in 0..100 {
                let at = covariance(rows);
                let a = tangent(&at, rows, quantity).unwrap();
                let touches = (a * at).trace() / quantile(&at, rows, p).powi(2);
                assert!((0.999..=1.0).contains(&touches), "{rows} {quantity:?}: {touches}");
                for _ in 0..30 {
                    let other = covariance(rows);
                    let ratio = (a * other).trace() / quantile(&other, rows, p).powi(2);
                    assert!(ratio <= 1.0 + 1e-9, "{rows} {quantity:?}: {ratio} at {other}");
                }
            }
        }
    }
}

#[test]
fn the_bound_without_errors_is_zero() {
    let mut cell = shipped("hitachi_cell.toml");
    let axes = cell.robot.axes();
    let none = vec![0.0; sweetspot::cell::Parameter::count(axes)];
    cell.robot.errors[cell.errors] = ErrorSet::Signed(SignedErrors::of_values("none".into(), axes, &none));
    let proof = proof_of(&ready(&cell), 1000);
    assert_eq!((proof.bound, proof.covers), (Some(0.0), Covers::Everything));
}

#[test]
fn an_unreachable_operation_is_proved_infeasible() {
    let mut cell = shipped("hitachi_cell.toml");
    cell.operations[0].standoff = 5.0;
    let workcell = ready(&cell);
    let proof = proof_of(&workcell, 1000);
    assert_eq!((proof.bound, proof.covers), (None, Covers::Infeasible));
    assert_eq!(proof.operations[0].value, Err(WhyNot::Infeasible));
    assert!(
        proof.in_words(&workcell).starts_with("no layout is feasible: assembly"),
        "{}",
        proof.in_words(&workcell)
    );
}

/// If two joints have a fixed angle, only one posture and its mirror images remain.
#[test]
fn the_bound_holds_for_joint_limits_of_no_width() {
    let mut cell = shipped("hitachi_cell.toml");
    cell.operations.truncate(1);
    let still = [None, Some(rad_from_deg(10.0)), Some(rad_from_deg(-22.0)), None];
    for (joint, at) in cell.robot.joints.iter_mut().zip(still) {
        at.into_iter().for_each(|at| joint.limits = (at, at));
    }
    let table = &mut cell.equipment[cell.operations[0].equipment].placement;
    table[2] = Coordinate::Range { min: -1.0, max: 2.0, start: 0.0 };
    let workcell = ready(&cell);
    let (inverse, evaluator) = (workcell.inverse(), workcell.evaluator(0));
    // With the tool down, q4 follows from q2 and q3.
    let q = [0.0, still[1].unwrap(), still[2].unwrap(), rad_from_deg(-78.0), 0.0, 0.0, 0.0, 0.0];
    let frames = inverse.chain().frames(&inverse.chain().posture(&q));
    assert!((frames.tcp.rotation * inverse.chain().tool_axis + Vector3::z()).norm() < 1e-12);
    let site = WorkFrame {
        equipment: 0,
        work: Pose::identity(),
        world: nalgebra::Matrix3::identity(),
        taught: None,
    };
    let value = evaluator.value(&WorkContext { site, reference: None }, &frames, &mut evaluator.memory());
    let bound = proof_of(&workcell, 1000).bound.unwrap();
    assert!(bound <= value && bound > 0.9995 * value, "{bound} {value}");
}

#[test]
fn a_cell_without_a_bound_states_the_reason() {
    let proof = |change: &dyn Fn(&mut Cell)| {
        let mut cell = shipped("hitachi_cell.toml");
        change(&mut cell);
        let workcell = ready(&cell);
        let proof = proof_of(&workcell, 2_000);
        let words = proof.in_words(&workcell);
        (proof, words)
    };
    let (relative, words) = proof(&|cell| cell.operations[1].relative_to = Some(0));
    assert_eq!(relative.operations[1].value, Err(WhyNot::Relative));
    assert_eq!((relative.covers, relative.bound), (Covers::Part, relative.operations[0].value.ok()));
    assert!(words.contains("these operations as 0: picking"), "{words}");
    let (taught, words) = proof(&|cell| cell.registration = Registration::Taught);
    assert_eq!((taught.covers, taught.bound), (Covers::Nothing, None));
    assert!(words.starts_with("no bound: "), "{words}");
    let (tool, _) = proof(&|cell| cell.operations[0].sense = Sense::plain("x@tool").unwrap());
    assert_eq!(tool.operations[0].value, Err(WhyNot::ToolAxes));
    let (surface, _) = proof(&|cell| cell.operations[0].sense = Sense::plain("x@surface").unwrap());
    assert_eq!(surface.operations[0].value, Err(WhyNot::SurfaceAxes));
    let (share, _) = proof(&|cell| {
        (cell.reading, cell.quantity) = (Reading::Statistical, Quantity::Yield);
        cell.operations.iter_mut().for_each(|o| o.limit = Some(0.01));
    });
    assert_eq!(share.operations[0].value, Err(WhyNot::Share));
}

/// A proof with one thread and a proof with two threads give the same bytes. The bound of a stopped proof
/// still holds.
#[test]
fn the_proof_does_not_depend_on_threads_and_can_be_stopped() {
    let workcell = ready(&shipped("five_axis_cell.toml"));
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| proof_of(&workcell, 3_000))
    });
    assert_eq!(one, two);
    let stopped = prove(&workcell, &ProofOptions::default(), &AtomicBool::new(true));
    assert!(stopped.interrupted && stopped.bound.is_none_or(|bound| bound <= one.bound.unwrap()));
    // A value known from a layout saves boxes and does not change the bound.
    let known = one.operations.iter().map(|o| o.witness.unwrap().0).collect();
    let options = ProofOptions { known: Some(known), ..ProofOptions::default() };
    let told = prove(&workcell, &options, &AtomicBool::new(false));
    assert!(
        told.bound.unwrap() > 0.999 * one.bound.unwrap() && told.bound.unwrap() < 1.001 * one.bound.unwrap()
    );
}

/// Cells whose proof and search take little time. The figures use all cells.
const CHEAP: [&str; 3] = ["hitachi_cell", "hitachi_paper", "palletizer_cell"];

/// Neither the start layout nor any layout found by a search lies below the bound. This command prints the
/// figures of all cells for results/proof/README.md:
///
/// ```text
/// SWEETSPOT_FIGURES=1 cargo test --test maths proof::the_proof_figures -- --nocapture
/// ```
#[test]
fn the_proof_figures_of_the_cells_are_regenerated() {
    let all = std::env::var("SWEETSPOT_FIGURES").is_ok();
    let names = if all { shipped_cells() } else { CHEAP.map(String::from).into() };
    let rows: Vec<String> = names.iter().map(|name| figures(name, all)).collect();
    let table = rows.concat();
    println!("{table}");
    if all {
        let folder = root().join("results/proof");
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("README.md");
        let old = std::fs::read_to_string(&file).unwrap_or_default();
        let rest = old.find("\n## ").map_or("", |at| &old[at..]);
        std::fs::write(file, format!("{FIGURES}{table}{rest}")).unwrap();
    }
}

fn shipped_cells() -> Vec<String> {
    let files = std::fs::read_dir(root().join("cells")).unwrap().map(|f| f.unwrap().path());
    let cells = files.filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let mut names: Vec<String> = cells.map(|p| p.file_stem().unwrap().to_str().unwrap().into()).collect();
    names.sort();
    names
}

/// Returns a row of the table. If `whole` is true, the proof has the effort of the command, otherwise little
/// effort.
fn figures(name: &str, whole: bool) -> String {
    let workcell = ready(&shipped(&format!("{name}.toml")));
    let unit = workcell.cell.unit();
    let boxes = if whole { ProofOptions::default().boxes } else { 2_000 };
    let mut settings = workcell.cell.search;
    settings.budget = if whole { settings.budget } else { 500 };
    let clock = std::time::Instant::now();
    let proof = proof_of(&workcell, boxes);
    let seconds = clock.elapsed().as_secs_f64();
    let record = search(&workcell, &settings, &Watch { progress: &|_| {}, stop: &AtomicBool::new(false) });
    let best = record.best.evaluation.objective;
    let lies_below =
        [best, record.start.evaluation.objective].into_iter().flatten().find(|o| proof.bound > Some(*o));
    assert_eq!(lies_below, None, "{name}: below the bound {:?}", proof.bound);
    assert!(whole || proof.bound.is_some_and(|b| b > 0.0) && best.is_some(), "{name}: {proof:?}");
    let told = |v: Option<f64>| v.map_or("-".into(), |v| format!("{:.6} {}", unit.from_si(v), unit.word()));
    let gap = best.and_then(|b| proof.gap(b)).map_or("-".into(), |g| format!("{:.3} %", 100.0 * g));
    let boxes: Vec<String> = proof.operations.iter().map(|o| o.boxes.to_string()).collect();
    let (bound, found, covers) = (told(proof.bound), told(best), proof.covers.name());
    let (boxes, evaluations) = (boxes.join(" + "), record.evaluations);
    format!("| {name} | {bound} | {covers} | {found} | {evaluations} | {gap} | {boxes} | {seconds:.2} |\n")
}

const FIGURES: &str = "# How good is the best layout found?\n\n\
    The table states the proven bound of every cell in cells/, and the objective of the best layout of one search with\n\
    the budget and the seed of the cell. Each cell has `ideal = true`: its layouts need only work exactly as drawn. The\n\
    gap is the largest possible improvement, as a share of the best objective. \"Boxes\" is the number of boxes that\n\
    branch and bound examines for each operation. Branch and bound stops soon after 100000 boxes for one operation. The\n\
    boxes for the shared height of the base in drilling_cell are not counted. \"Seconds\" is the time of the proof alone,\n\
    on 2 cores that other jobs also used. If a bound covers only some operations, the errors of the other operations count\n\
    as 0. `sweetspot search` says which operations have no bound, and why. This command makes the table:\n\n\
    \u{20}   SWEETSPOT_FIGURES=1 cargo test --test maths proof::the_proof_figures -- --nocapture\n\n\
    | cell | bound | covers | best found | evaluations | gap | boxes | seconds |\n\
    |---|---|---|---|---|---|---|---|\n";

/// Returns errors of rows and elastic errors of revolute joints as a tolerance or, with a covariance and
/// periodic errors, as measured errors.
fn elastic_set(robot: &Robot, is_measured: bool, rng: &mut ChaCha8Rng) -> ErrorSet {
    let axes = robot.axes();
    let value = |p: Parameter| match p {
        Parameter::Dl(_) | Parameter::Dr(_) => rng.random_range(-3e-4..3e-4),
        Parameter::Dq(_) | Parameter::Dalpha(_) => rng.random_range(-2e-4..2e-4),
        Parameter::Elastic(joint, _) if robot.joints[joint].kind == JointKind::Revolute => {
            rng.random_range(-3e-3..3e-3)
        }
        _ => 0.0,
    };
    let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
    let sample = SignedErrors::of_values("elastic".into(), axes, &values);
    let mut spread = ErrorSet::Signed(sample.clone()).tolerance();
    if !is_measured {
        return ErrorSet::Tolerance(spread);
    }
    // Elastic errors are correlated with the errors of the rows.
    let parameters: Vec<usize> = (0..values.len()).filter(|k| values[*k] != 0.0).collect();
    let n = parameters.len();
    let b = DMatrix::from_fn(n, n, |row, _| values[parameters[row]].abs() * rng.random_range(-1.0..1.0));
    let matrix = &b * b.transpose();
    for (k, &place) in parameters.iter().enumerate() {
        spread.spreads[place].plus_minus = 3.0 * matrix[(k, k)].sqrt();
    }
    spread.covariance = Some(Covariance { parameters, matrix });
    let mean = sample.with_periodic(random_waves(&mut ChaCha8Rng::seed_from_u64(43), robot, 1e-4));
    ErrorSet::Measured(Box::new(MeasuredErrors { mean, spread, ranges: None }))
}

/// In every reading, elastic errors and means have a bound, or the proof states why not.
#[test]
fn no_random_posture_is_below_the_bound_with_elastic_errors() {
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let readings = [
        (Reading::Signed, Quantity::Rms),
        (Reading::WorstCase, Quantity::Rms),
        (Reading::Statistical, Quantity::Rms),
        (Reading::Statistical, Quantity::P95),
    ];
    let mut positive = 0;
    for name in ["hitachi_cell", "five_axis_cell", "wrist_cell"] {
        for (reading, quantity) in readings {
            for (model, is_measured) in Model::ALL.into_iter().flat_map(|m| [(m, false), (m, true)]) {
                let mut cell = shipped(&format!("{name}.toml"));
                (cell.reading, cell.quantity, cell.model) = (reading, quantity, model);
                cell.operations.truncate(1);
                cell.operations[0].sense = Sense::plain("xyz").unwrap();
                let set = elastic_set(&cell.robot, is_measured, &mut rng);
                let set = match (set, reading) {
                    (ErrorSet::Tolerance(t), Reading::Signed) => {
                        // A small share of elastic errors leaves a bound above 0.
                        let axes = cell.robot.axes();
                        let values = t.spreads.iter().enumerate();
                        let rigid = Parameter::first_elastic(axes);
                        let values = values.map(|(k, s)| s.plus_minus * if k < rigid { 10.0 } else { 0.02 });
                        let values: Vec<f64> = values.collect();
                        let sample = SignedErrors::of_values("elastic".into(), axes, &values);
                        let mut others = ChaCha8Rng::seed_from_u64(44);
                        ErrorSet::Signed(sample.with_periodic(random_waves(&mut others, &cell.robot, 1e-5)))
                    }
                    (set, _) => set,
                };
                (cell.robot.errors, cell.errors) = (vec![set], 0);
                let what = format!("{name} {reading:?} {quantity:?} {model:?} measured {is_measured}");
                let proof = nothing_is_below(&what, &cell, 300, 60);
                match proof.operations[0].value {
                    Ok(bound) => positive += usize::from(bound > 0.0),
                    Err(WhyNot::Mean) => assert!(is_measured && reading == Reading::WorstCase, "{what}"),
                    Err(why) => assert_eq!(why, WhyNot::Boxes, "{what}"),
                }
            }
        }
    }
    assert!(positive >= 20, "{positive}");
}

/// A long search of a cell with elastic errors finds no layout below the bound.
#[test]
fn the_best_of_a_search_with_elastic_errors_is_not_below_the_bound() {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    for is_measured in [false, true] {
        let mut cell = shipped("hitachi_cell.toml");
        cell.operations.truncate(1);
        let set = elastic_set(&cell.robot, is_measured, &mut rng);
        (cell.robot.errors, cell.errors, cell.reading) = (vec![set], 0, Reading::Statistical);
        (cell.quantity, cell.search.budget) = (Quantity::Rms, 600);
        let workcell = ready(&cell);
        let bound = proof_of(&workcell, 4_000).bound.unwrap();
        let watch = Watch { progress: &|_| {}, stop: &AtomicBool::new(false) };
        let found = search(&workcell, &cell.search, &watch);
        let best = found.best.evaluation.objective.unwrap();
        println!("measured {is_measured}: bound {bound:e}, best {best:e}");
        assert!(bound > 0.0 && bound <= best, "{bound} {best}");
    }
}
