//! Tests searches with several goals: the goals against independent measures, front and shortlist against
//! enumeration, and the checkpoints of these searches.

use crate::common::{from_text, shipped};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{Cell, Coordinate, Goal, Goals, Layout, SearchSettings, Solver};
use sweetspot::layout::{MAX_CLEARANCE, Workcell, evaluate};
use sweetspot::search::scalarization::weights;
use sweetspot::search::{
    Checkpoint, Moment, REALLY_DIFFERENT, SearchJob, SearchRecord, SearchSpace, Stopping, Unfit, Watch,
    search_job,
};

/// Returns a cell of the paper's arm, two tables and a post, in which every free coordinate is a list of
/// values.
fn listed_cell(work: &str, more: &str) -> Cell {
    let text = format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         robot = {{ from = \"robots/hitachi_pw10.toml\" }}\n\
         [equipment.table]\nsurface = {{ size_mm = [500, 400] }}\n\
         solid = [{{ name = \"top\", box = {{ centre_mm = [0, 0, -25], size_mm = [500, 400, 50] }} }}]\n\
         placement = {{ {work} }}\n\
         [equipment.feeder]\nsurface = {{ size_mm = [300, 300] }}\n\
         solid = [{{ name = \"top\", box = {{ centre_mm = [0, 0, -25], size_mm = [300, 300, 50] }} }}]\n\
         placement = {{ x_mm = [900, 800, 700], y_mm = [-300, 0], z_mm = 600 }}\n\
         [obstacle.post]\nsolid = [{{ name = \"post\", box = {{ centre_mm = [0, 0, 900], size_mm = [80, 80, 1800] }} }}]\n\
         placement = {{ x_mm = 550, y_mm = 650, z_mm = 0 }}\n\
         [operation.work]\non = \"table\"\ngrid = [4, 3]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xy\"\n\
         [operation.feed]\non = \"feeder\"\ngrid = [2, 2]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xy\"\n{more}"
    );
    from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

/// States a maximum speed and acceleration for every joint, so that the layouts have a cycle time.
fn timed(mut cell: Cell) -> Cell {
    for (k, joint) in cell.robot.joints.iter_mut().enumerate() {
        joint.rates.velocity = Some([2.0, 1.0, 1.5, 3.0][k % 4]);
        joint.rates.acceleration = Some([4.0, 3.0, 5.0, 9.0][k % 4]);
    }
    cell
}

const LISTS: &str = "x_mm = [0, -100, 100, 200, 300], y_mm = [1000, 700, 800, 900, 1100], z_mm = [600, 500], \
                     yaw_deg = [0, 30, 60]";

/// Returns every layout of a cell whose free coordinates are lists.
fn every_layout(cell: &Cell) -> Vec<Layout> {
    let free = cell.free();
    let lists: Vec<&Vec<f64>> = free
        .iter()
        .map(|(_, c)| match c {
            Coordinate::List(values) => values,
            other => panic!("{other:?}"),
        })
        .collect();
    let count: usize = lists.iter().map(|l| l.len()).product();
    let layout = |mut number: usize| {
        let mut values = Vec::new();
        for list in &lists {
            values.push(list[number % list.len()]);
            number /= list.len();
        }
        cell.layout(|slot, c| free.iter().position(|(s, _)| *s == slot).map_or(c.start(), |k| values[k]))
    };
    (0..count).map(layout).collect()
}

fn goals(named: &[Goal]) -> Goals {
    Goals::of(named).unwrap()
}

fn run(
    workcell: &Workcell,
    settings: &SearchSettings,
    from: Option<&str>,
    every: usize,
) -> (SearchRecord, Vec<Checkpoint>) {
    let kept = Mutex::new((0, Vec::new()));
    let keep = |c: &Checkpoint, _: Moment| {
        let mut kept = kept.lock().unwrap();
        kept.0 += 1;
        if kept.0 % every == 0 {
            kept.1.push(c.clone());
        }
    };
    let from: Option<Checkpoint> = from.map(|text| serde_json::from_str(text).unwrap());
    let watch = Watch { progress: &|_| (), stop: &AtomicBool::new(false) };
    let job = SearchJob { bound: None, from: from.as_ref(), keep: &keep };
    let record = search_job(workcell, settings, &watch, &job);
    (record, kept.into_inner().unwrap().1)
}

/// Returns the losses of every feasible layout, one per goal.
fn enumerated(workcell: &Workcell, goals: &Goals) -> Vec<(Layout, Vec<f64>)> {
    let of = |layout: Layout| {
        let values = workcell.goals(&layout, &evaluate(workcell, &layout), goals)?;
        Some((layout, losses(goals, &values)))
    };
    every_layout(&workcell.cell).into_iter().filter_map(of).collect()
}

fn losses(goals: &Goals, values: &[f64]) -> Vec<f64> {
    let smaller = |goal: Goal| matches!(goal, Goal::Error | Goal::Travel | Goal::Footprint | Goal::Time);
    // Differences below a nanometre come from rounding.
    let rounded = |v: f64| (v * 1e9).round() / 1e9;
    goals.iter().zip(values).map(|(g, v)| rounded(if smaller(g) { *v } else { -v })).collect()
}

fn dominates(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b) && a != b
}

/// Returns the hypervolume between points and a corner that is worse than all points. It is a sum over the
/// grid cells that the coordinates of the points define.
fn hypervolume(points: &[Vec<f64>], worst: &[f64]) -> f64 {
    let axes: Vec<Vec<f64>> = (0..worst.len())
        .map(|k| {
            let mut axis: Vec<f64> = points.iter().map(|p| p[k]).chain([worst[k]]).collect();
            axis.sort_by(f64::total_cmp);
            axis.dedup();
            axis
        })
        .collect();
    let mut volume = 0.0;
    let counts: Vec<usize> = axes.iter().map(|a| a.len() - 1).collect();
    for mut number in 0..counts.iter().product::<usize>() {
        let (mut low, mut size) = (Vec::new(), 1.0);
        for (axis, count) in axes.iter().zip(&counts) {
            let at = number % count;
            number /= count;
            low.push(axis[at]);
            size *= axis[at + 1] - axis[at];
        }
        if points.iter().any(|p| p.iter().zip(&low).all(|(p, l)| p <= l)) {
            volume += size;
        }
    }
    volume
}

/// Scales losses to the range of the enumeration.
fn scaled(all: &[Vec<f64>]) -> impl Fn(&Vec<f64>) -> Vec<f64> {
    let least: Vec<f64> =
        (0..all[0].len()).map(|k| all.iter().map(|a| a[k]).fold(f64::INFINITY, f64::min)).collect();
    let most: Vec<f64> =
        (0..all[0].len()).map(|k| all.iter().map(|a| a[k]).fold(f64::NEG_INFINITY, f64::max)).collect();
    move |a| {
        a.iter().zip(least.iter().zip(&most)).map(|(v, (lo, hi))| (v - lo) / (hi - lo).max(1e-12)).collect()
    }
}

#[test]
fn the_front_agrees_with_enumeration() {
    let workcell = Workcell::new(timed(listed_cell(LISTS, ""))).unwrap();
    for named in [
        &[Goal::Error, Goal::Clearance][..],
        &[Goal::Error, Goal::Travel],
        &[Goal::Error, Goal::Time],
        &[Goal::Time, Goal::Clearance, Goal::Error],
        &[Goal::Footprint, Goal::Error],
        &[Goal::Error, Goal::Clearance, Goal::Travel],
        &[Goal::JointLimits, Goal::Singularity, Goal::Footprint],
    ] {
        let goals = goals(named);
        let all = enumerated(&workcell, &goals);
        let losses_of: Vec<Vec<f64>> = all.iter().map(|(_, l)| l.clone()).collect();
        let truth: Vec<Vec<f64>> =
            losses_of.iter().filter(|a| !losses_of.iter().any(|b| dominates(b, a))).cloned().collect();
        assert!(truth.len() > 2, "{named:?}: {} points make no front", truth.len());
        let settings = SearchSettings { budget: 6_000, pareto: goals, ..workcell.cell.search };
        let (record, _) = run(&workcell, &settings, None, 1);
        let found: Vec<Vec<f64>> = record
            .alternatives
            .iter()
            .map(|a| {
                let c = &a.candidate;
                let again = workcell.goals(&c.layout, &evaluate(&workcell, &c.layout), &goals).unwrap();
                losses(&goals, &again)
            })
            .collect();
        let scale = scaled(&losses_of);
        let [whole, got] = [&truth, &found].map(|points| {
            let points: Vec<_> = points.iter().map(&scale).collect();
            hypervolume(&points, &vec![1.05; named.len()])
        });
        let share = got / whole;
        assert!(truth.iter().all(|t| found.contains(t)), "{named:?}: some of the front is missing");
        for f in &found {
            assert!(!losses_of.iter().any(|a| dominates(a, f)), "{named:?}: {f:?} is dominated");
        }
        assert!(share >= 0.99, "{named:?}: {share}");
        // No layout occurs twice, and the layouts are in the order of the first goal.
        for (k, a) in record.alternatives.iter().enumerate() {
            let twin = record.alternatives[..k].iter().any(|b| a.candidate.layout == b.candidate.layout);
            assert!(!twin, "{named:?}: layout {k} comes twice");
        }
        assert!(found.windows(2).all(|w| w[0][0] <= w[1][0]), "{named:?}");
    }
}

/// A search whose budget is too small for all layouts still covers nearly the whole front.
#[test]
fn a_small_budget_covers_most_of_the_front() {
    let workcell = Workcell::new(listed_cell(LISTS, "")).unwrap();
    let goals = goals(&[Goal::Error, Goal::Clearance, Goal::Travel]);
    let all: Vec<Vec<f64>> = enumerated(&workcell, &goals).into_iter().map(|(_, l)| l).collect();
    let scale = scaled(&all);
    let truth = all.iter().filter(|a| !all.iter().any(|b| dominates(b, a)));
    let truth: Vec<Vec<f64>> = truth.map(&scale).collect();
    let whole = hypervolume(&truth, &[1.05; 3]);
    for seed in 1..=5 {
        let settings = SearchSettings { budget: 1_500, pareto: goals, seed, ..workcell.cell.search };
        let (record, _) = run(&workcell, &settings, None, 1);
        assert!(record.evaluations <= 1_500);
        let found: Vec<Vec<f64>> = record
            .alternatives
            .iter()
            .map(|a| scale(&losses(&goals, &[a.goals[0], a.goals[1], a.goals[4]])))
            .collect();
        let share = hypervolume(&found, &[1.05; 3]) / whole;
        assert!(share >= 0.97, "seed {seed}: {share}");
    }
}

/// The distance between listed values is a share of their number. Here all these shares exceed a twentieth,
/// so every two layouts differ enough.
#[test]
fn the_shortlist_agrees_with_enumeration() {
    let workcell = Workcell::new(listed_cell(LISTS, "")).unwrap();
    let mut all: Vec<f64> = every_layout(&workcell.cell)
        .iter()
        .filter_map(|layout| evaluate(&workcell, layout).objective)
        .collect();
    all.sort_by(f64::total_cmp);
    for (keep, budget) in [(1, 5_000), (7, 5_000), (40, 5_000), (5, 1_500)] {
        let settings = SearchSettings { budget, keep, ..workcell.cell.search };
        let (record, _) = run(&workcell, &settings, None, 1);
        let kept: Vec<f64> =
            record.alternatives.iter().map(|a| a.candidate.evaluation.objective.unwrap()).collect();
        assert_eq!(kept, all[..keep], "keep {keep}, budget {budget}");
        assert_eq!(record.best.evaluation.objective, Some(kept[0]));
    }
}

/// Every layout of a shortlist over ranges differs from the other layouts by more than the stated distance.
/// The best layout comes first, and no layout is worse than the greedy choice from an enumerated grid.
#[test]
fn a_shortlist_of_ranges_differs_by_the_least_distance() {
    let workcell = Workcell::new(listed_cell(
        "x_mm = { min = -200, max = 400, start = 0 }, y_mm = { min = 650, max = 1150, start = 900 }, z_mm = 600",
        "",
    ))
    .unwrap();
    let settings = SearchSettings { budget: 6_000, keep: 6, ..workcell.cell.search };
    let (record, _) = run(&workcell, &settings, None, 1);
    let space = SearchSpace::new(&workcell.cell);
    let points: Vec<_> = record.alternatives.iter().map(|a| space.point(&a.candidate.layout)).collect();
    let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > REALLY_DIFFERENT);
    assert_eq!(points.len(), 6);
    for (k, p) in points.iter().enumerate() {
        assert!(points[..k].iter().all(|q| differ(p, q)), "{p:?} of {points:?}");
    }
    let kept: Vec<f64> =
        record.alternatives.iter().map(|a| a.candidate.evaluation.objective.unwrap()).collect();
    assert!(kept.windows(2).all(|w| w[0] <= w[1]), "{kept:?}");
    // The reference is the greedy rule over a grid of 41 by 41 and the listed values.
    let mut grid = Vec::new();
    for i in 0..41 * 41 {
        for (fx, fy) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)] {
            let (fx, fy) = ((f64::from(fx) + 0.5) / 3.0, (f64::from(fy) + 0.5) / 2.0);
            let point = vec![f64::from(i % 41) / 40.0, f64::from(i / 41) / 40.0, fx, fy];
            if let Some(objective) = evaluate(&workcell, &space.layout(&point)).objective {
                grid.push((objective, point));
            }
        }
    }
    grid.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut greedy: Vec<(f64, Vec<f64>)> = Vec::new();
    for (objective, point) in grid {
        if greedy.len() < 6 && greedy.iter().all(|g| differ(&g.1, &point)) {
            greedy.push((objective, point));
        }
    }
    for (k, (kept, (grid, _))) in kept.iter().zip(&greedy).enumerate() {
        assert!(*kept <= grid * 1.005, "{k}: kept {kept}, grid {grid}");
    }
}

fn bits(record: &SearchRecord) -> String {
    let SearchRecord { best, evaluations, feasible, trace, ended, alternatives, .. } = record;
    // The Debug format prints floats with enough digits to restore every bit.
    format!("{best:?} {evaluations} {feasible} {trace:?} {ended:?} {alternatives:?}")
}

#[test]
fn every_checkpoint_of_a_front_resumes_to_the_same_bits() {
    let workcell = Workcell::new(timed(shipped("hitachi_cell.toml"))).unwrap();
    let own = workcell.cell.search;
    let pareto = goals(&[Goal::Error, Goal::Clearance, Goal::Travel]);
    let times = goals(&[Goal::Error, Goal::Time]);
    for settings in [
        SearchSettings { budget: 2_600, pareto, ..own },
        SearchSettings { budget: 900, pareto, solver: Solver::ParticleSwarm, ..own },
        SearchSettings { budget: 900, keep: 4, ..own },
        SearchSettings { budget: 900, pareto: times, ..own },
    ] {
        let (whole, kept) = run(&workcell, &settings, None, 1);
        assert!(whole.alternatives.len() > 3, "{}", whole.alternatives.len());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let text = |c: &Checkpoint| serde_json::to_string(c).unwrap();
        for (k, from) in
            kept.iter().enumerate().step_by(1 + kept.len() / 12).chain(kept.iter().enumerate().next_back())
        {
            let (record, after) = pool.install(|| run(&workcell, &settings, Some(&text(from)), 1));
            assert_eq!(bits(&record), bits(&whole), "checkpoint {k} of {}", kept.len());
            assert_eq!(after.last().map(text), kept.last().map(text), "checkpoint {k}");
        }
        let last = kept.last().unwrap();
        let rules = Stopping::new(&settings, None);
        assert_eq!(last.check(7, &rules), Ok(()));
        let others = goals(&[Goal::Error, Goal::Footprint]);
        for other in [Stopping { keep: settings.keep + 1, ..rules }, Stopping { pareto: others, ..rules }] {
            assert_eq!(last.check(7, &other), Err(Unfit::Kept));
        }
    }
}

/// Returns the corners of the floor spaces of robot base and equipment, in the world, m.
fn floor_corners(cell: &Cell, layout: &Layout) -> Vec<Vec<[f64; 2]>> {
    let corners = |r: &sweetspot::cell::Rectangle, at: &sweetspot::cell::Placement| {
        let (x, y) = (r.size.0 / 2.0, r.size.1 / 2.0);
        [(x, y), (-x, y), (-x, -y), (x, -y)]
            .map(|(u, v)| {
                let (u, v) = (r.centre.0 + u, r.centre.1 + v);
                let (sin, cos) = at.yaw.sin_cos();
                [at.x + cos * u - sin * v, at.y + sin * u + cos * v]
            })
            .to_vec()
    };
    let mut all: Vec<_> =
        cell.equipment.iter().zip(&layout.placements).map(|(e, at)| corners(&e.footprint, at)).collect();
    all.push(corners(&cell.robot.footprint, &layout.base));
    all
}

/// Returns the area of the convex hull by gift wrapping and the shoelace formula.
fn hull_area(points: &[[f64; 2]]) -> f64 {
    let turn =
        |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let first = *points.iter().min_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))).unwrap();
    let (mut hull, mut here) = (Vec::new(), first);
    loop {
        hull.push(here);
        let mut next = points[0];
        for p in points {
            let side = turn(here, next, *p);
            let farther =
                (p[0] - here[0]).hypot(p[1] - here[1]) > (next[0] - here[0]).hypot(next[1] - here[1]);
            if next == here || side < 0.0 || (side == 0.0 && farther) {
                next = *p;
            }
        }
        here = next;
        if here == first || hull.len() > points.len() {
            break;
        }
    }
    let next = hull.iter().cycle().skip(1);
    hull.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

#[test]
fn the_footprint_goal_agrees_with_a_gift_wrapped_hull() {
    let workcell = Workcell::new(listed_cell(LISTS, "")).unwrap();
    let all = enumerated(&workcell, &goals(&[Goal::Footprint]));
    assert!(all.len() > 500);
    for (layout, value) in all {
        let corners = floor_corners(&workcell.cell, &layout);
        // The post is an obstacle whose floor space does not count.
        let posts = workcell.cell.equipment.iter().position(|e| e.name == "post").unwrap();
        let points: Vec<_> =
            corners.iter().enumerate().filter(|(k, _)| *k != posts).flat_map(|(_, c)| c.clone()).collect();
        let wanted = hull_area(&points);
        assert!((value[0] - wanted).abs() < 1e-9, "{value:?} {wanted}");
    }
}

/// No joint of this arm has a range of more than one turn, so no posture has equivalent turns.
#[test]
fn the_travel_limit_and_error_goals_agree_with_the_maps() {
    let workcell = Workcell::new(listed_cell(LISTS, "")).unwrap();
    let named = goals(&[Goal::Travel, Goal::JointLimits, Goal::Error]);
    let joints = &workcell.cell.robot.joints;
    assert!(joints.iter().all(|j| j.limits.1 - j.limits.0 < std::f64::consts::TAU));
    for layout in every_layout(&workcell.cell).iter().step_by(29) {
        let evaluation = evaluate(&workcell, layout);
        let Some(got) = workcell.goals(layout, &evaluation, &named) else {
            assert_eq!(evaluation.objective, None);
            continue;
        };
        let maps = workcell.maps(layout);
        let q: Vec<_> =
            maps.iter().map(|m| m.best_node().unwrap().posture.as_ref().unwrap().joints).collect();
        let travel = (0..joints.len()).map(|j| (q[0][j] - q[1][j]).abs()).fold(0.0, f64::max);
        let share = |j: usize, q: f64| {
            let (low, high) = joints[j].limits;
            1.0 - (q - (low + high) / 2.0).abs() / ((high - low) / 2.0)
        };
        let limits = q.iter().flat_map(|q| (0..joints.len()).map(|j| share(j, q[j])).collect::<Vec<_>>());
        let limits = limits.fold(f64::INFINITY, f64::min);
        let error = maps.iter().map(|m| m.value.unwrap()).sum::<f64>();
        for (got, wanted) in got.iter().zip([travel, limits, error]) {
            assert!((got - wanted).abs() < 1e-9, "{got} {wanted}");
        }
    }
}

/// Returns the distance of a point from a box, m.
fn to_box(p: nalgebra::Vector3<f64>, pose: &sweetspot::pose::Pose, size: nalgebra::Vector3<f64>) -> f64 {
    let local = pose.rotation.transpose() * (p - pose.translation);
    (0..3).map(|k| (local[k].abs() - size[k] / 2.0).max(0.0).powi(2)).sum::<f64>().sqrt()
}

/// Returns the range of heights (m) of the boxes of every piece of equipment, and last the range of the robot
/// base, which reaches down to the floor.
fn heights(cell: &Cell, layout: &Layout) -> Vec<(f64, f64)> {
    use sweetspot::cell::Shape;
    let upright = |shape: &Shape, z: f64| {
        let Shape::Box { pose, size } = shape else { panic!("{shape:?}") };
        (z + pose.translation.z - size.z / 2.0, z + pose.translation.z + size.z / 2.0)
    };
    let pairs = cell.equipment.iter().zip(&layout.placements);
    let mut all: Vec<_> = pairs.map(|(e, at)| upright(&e.solids[0].shape, at.z)).collect();
    let base = cell.robot.solids.iter().find(|s| s.link == 0).unwrap();
    all.push((f64::NEG_INFINITY, upright(&base.solid.shape, layout.base.z).1));
    all
}

/// Returns whether any of many points of the rectangle `a` lies in the rectangle `b` (corners anticlockwise).
fn share_points(a: &[[f64; 2]], b: &[[f64; 2]]) -> bool {
    let is_in_b = |p: [f64; 2]| {
        (0..4).all(|k| {
            let (u, v) = (b[k], b[(k + 1) % 4]);
            (v[0] - u[0]) * (p[1] - u[1]) - (v[1] - u[1]) * (p[0] - u[0]) >= 0.0
        })
    };
    let at = |s: f64, t: f64| {
        [0, 1].map(|axis| a[0][axis] + s * (a[1][axis] - a[0][axis]) + t * (a[3][axis] - a[0][axis]))
    };
    (0..=200).any(|i| (0..=200).any(|j| is_in_b(at(f64::from(i) / 200.0, f64::from(j) / 200.0))))
}

/// The reference samples thousands of points along the capsules of the robot and the edges of floor spaces.
/// The nearest sample is never nearer than the stated clearance, and only slightly farther. The clearance
/// also counts the difference in height of floor spaces.
#[test]
fn the_clearance_goal_agrees_with_dense_sampling() {
    use sweetspot::cell::Shape;
    let workcell = Workcell::new(listed_cell(LISTS, "")).unwrap();
    let cell = &workcell.cell;
    let (mut by_robot, mut in_plan) = (0, 0);
    for layout in every_layout(cell).iter().step_by(7) {
        let Some(got) = workcell.goals(layout, &evaluate(&workcell, layout), &goals(&[Goal::Clearance]))
        else {
            continue;
        };
        let mut nearest = MAX_CLEARANCE;
        let maps = workcell.maps(layout);
        let chain = sweetspot::robot::Chain::new(&cell.robot);
        for (operation, map) in cell.operations.iter().zip(&maps) {
            let q = map.best_node().unwrap().posture.as_ref().unwrap().joints;
            let frames = chain.frames(&chain.posture(&q));
            for solid in &cell.robot.solids {
                let frame = frames.links[solid.link];
                let Shape::Capsule { a, b, radius } = solid.solid.shape else { continue };
                let (a, b) = (frame.transform(&a), frame.transform(&b));
                for k in 0..=4000 {
                    let p = a + (b - a) * f64::from(k) / 4000.0;
                    if solid.link > 1 {
                        nearest = nearest.min(p.z - radius - cell.floor);
                    }
                    for (e, (equipment, at)) in cell.equipment.iter().zip(&layout.placements).enumerate() {
                        if solid.link == cell.robot.axes() && e == operation.equipment {
                            continue;
                        }
                        for other in &equipment.solids {
                            let Shape::Box { pose, size } = other.shape else { panic!("{other:?}") };
                            nearest = nearest.min(to_box(p, &(at.pose() * pose), size) - radius);
                        }
                    }
                }
            }
        }
        let robot = nearest;
        let (spaces, heights) = (floor_corners(cell, layout), heights(cell, layout));
        // The last two spaces belong to post and base, which do not move.
        for (i, a) in spaces.iter().enumerate().take(spaces.len() - 2) {
            for (j, b) in spaces.iter().enumerate().skip(i + 1) {
                let rise = (heights[i].0 - heights[j].1).max(heights[j].0 - heights[i].1).max(0.0);
                if rise < nearest && share_points(a, b) {
                    nearest = rise;
                }
                for (from, to) in [(a, b), (b, a)] {
                    for p in from {
                        for k in 0..4 {
                            let (u, v) = (to[k], to[(k + 1) % 4]);
                            for t in 0..=400 {
                                let t = f64::from(t) / 400.0;
                                let q = [u[0] + t * (v[0] - u[0]), u[1] + t * (v[1] - u[1])];
                                nearest = nearest.min((p[0] - q[0]).hypot(p[1] - q[1]).hypot(rise));
                            }
                        }
                    }
                }
            }
        }
        let off = nearest - got[0];
        assert!((-1e-5..2e-3).contains(&off), "said {}, sampled {nearest} (robot {robot})", got[0]);
        match () {
            () if got[0] == MAX_CLEARANCE => {}
            () if nearest < robot => in_plan += 1,
            () => by_robot += 1,
        }
    }
    assert!(by_robot > 5 && in_plan > 5, "robot {by_robot}, floor space {in_plan}");
}

#[test]
fn goal_weights_fill_the_simplex_evenly() {
    for goals in 2..=6 {
        let all: Vec<_> = (0..600).map(|run| weights(goals, run)).collect();
        for w in &all {
            assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-12 && w.iter().all(|w| *w >= 0.0), "{w:?}");
        }
        // The mean of each weight on the simplex is one over their number.
        for k in 0..goals {
            let mean = all[goals..].iter().map(|w| w[k]).sum::<f64>() / (600 - goals) as f64;
            assert!((mean - 1.0 / goals as f64).abs() < 0.02, "{goals} goals: {mean}");
        }
    }
    assert_eq!(weights(2, 0), [1.0, 0.0]);
    assert_eq!([2, 3, 4].map(|run| weights(2, run)[0]), [0.5, 0.25, 0.75]);
}
