//! Tests moves, lines, transfers, margins and the fence against dense sampling and closed forms.

use crate::common::from_text;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::assess::Assessment;
use sweetspot::cell::{Cell, JointVector, MAX_JOINTS, Shape};
use sweetspot::clearance::{ACCURACY, FloorPlan, Hit, Load, Party, PlacedSolids, Scene, SolidRef};
use sweetspot::error_map::{NodeSign, Outcome, Status};
use sweetspot::layout::{Workcell, evaluate, separated};
use sweetspot::motion::{
    DEVIATION, Guard, Hindrance, OperationPosture, PathHit, PathSlack, PostureRefusal, RESOLUTION, Stopped,
    TransferRoute, first_hit, measures, singularity, straight,
};
use sweetspot::pose::Pose;
use sweetspot::reach::{Inverse, Reach};
use sweetspot::robot::Chain;

type V = Vector3<f64>;
type Frames = [Pose; MAX_JOINTS + 1];

fn load(text: &str) -> Cell {
    from_text(text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

/// Returns a cell with a robot of the library. `more` adds tables, and `head` adds plain keys.
fn cell(robot: &str, errors: &str, head: &str, more: &str) -> Cell {
    load(&format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"{errors}\"\n{head}\n\
         [robot]\nfrom = \"robots/{robot}.toml\"\n\
         [equipment.table]\nsurface = {{ size_mm = [600, 400] }}\n\
         solid = [{{ name = \"top\", box = {{ centre_mm = [0, 0, -20], size_mm = [600, 400, 40] }} }}]\n\
         placement = {{ x_mm = 0, y_mm = 1200, z_mm = 600 }}\n\
         [operation.work]\non = \"table\"\ngrid = [2, 2]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xyz\"\n{more}"
    ))
}

fn placed(cell: &Cell, scene: &Scene) -> PlacedSolids {
    let mut placed = PlacedSolids::default();
    scene.place(&cell.start(), &mut placed);
    placed
}

fn random_joints(chain: &Chain, rng: &mut ChaCha8Rng) -> JointVector {
    let mut q = [0.0; MAX_JOINTS];
    for (q, link) in q.iter_mut().zip(&chain.links) {
        *q = if link.limits.0 < link.limits.1 { rng.random_range(link.limits.0..link.limits.1) } else { 0.0 };
    }
    q
}

fn between(a: &JointVector, b: &JointVector, s: f64) -> JointVector {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * s)
}

fn links(chain: &Chain, q: &JointVector) -> Frames {
    chain.frames(&chain.posture(q)).links
}

// --- distances -----------------------------------------------------------------------------------

/// Solid in the world: all points within a radius of a core (point, segment or box).
enum RoundedSolid {
    Bar(V, V, f64),
    Box(Pose, V),
}

impl RoundedSolid {
    fn of(shape: &Shape, frame: &Pose) -> Self {
        match shape {
            Shape::Sphere { centre, radius } => {
                Self::Bar(frame.transform(centre), frame.transform(centre), *radius)
            }
            Shape::Capsule { a, b, radius } => Self::Bar(frame.transform(a), frame.transform(b), *radius),
            Shape::Box { pose, size } => Self::Box(*frame * *pose, size / 2.0),
            other => panic!("{other:?}"),
        }
    }

    /// Returns the nearest point of the core.
    fn nearest(&self, p: &V) -> V {
        match self {
            Self::Bar(a, b, _) => {
                let u = b - a;
                let s = if u.norm_squared() > 0.0 { (p - a).dot(&u) / u.norm_squared() } else { 0.0 };
                a + u * s.clamp(0.0, 1.0)
            }
            Self::Box(pose, half) => {
                let local = pose.rotation.transpose() * (p - pose.translation);
                pose.transform(&local.zip_map(half, |x, h| x.clamp(-h, h)))
            }
        }
    }

    fn radius(&self) -> f64 {
        if let Self::Bar(.., r) = self { *r } else { 0.0 }
    }

    /// Returns the distance of two convex sets by alternating projections (Cheney and Goldstein).
    fn distance(&self, other: &Self) -> f64 {
        let mut best = f64::INFINITY;
        for start in [V::zeros(), V::new(3.0, 0.0, 0.0), V::new(0.0, 0.0, 5.0)] {
            let mut p = self.nearest(&start);
            let mut gap = f64::INFINITY;
            for _ in 0..200_000 {
                let q = other.nearest(&p);
                p = self.nearest(&q);
                let now = (p - q).norm();
                if gap - now < 1e-15 {
                    break;
                }
                gap = now;
            }
            best = best.min(gap);
        }
        (best - self.radius() - other.radius()).max(0.0)
    }
}

fn probe_cell(link: &str, part: &str) -> Cell {
    load(&format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         floor_mm = -100000\n\
         [robot]\nfrom = \"robots/hitachi_pw10.toml\"\nsolid = [{{ name = \"probe\", link = 4, {link} }}]\n\
         [equipment.part]\nsurface = {{ size_mm = [10, 10] }}\nsolid = [{{ name = \"body\", {part} }}]\n\
         placement = {{ x_mm = 100, y_mm = 900, z_mm = 700, yaw_deg = 20 }}\n\
         [operation.work]\non = \"part\"\ngrid = [1, 1]\nbend_deg = -90\nsense = \"xyz\"\n"
    ))
}

fn random_pose(rng: &mut ChaCha8Rng, centre: V, size: f64) -> Pose {
    let mut angle = || rng.random_range(-3.2..3.2);
    let rotation: Matrix3<f64> = Rotation3::from_euler_angles(angle(), angle(), angle()).into_inner();
    Pose { rotation, translation: centre + V::from_fn(|_, _| rng.random_range(-size..size)) }
}

#[test]
fn distances_agree_with_alternating_projections() {
    let shapes = [
        "sphere = { centre_mm = [10, 0, 20], radius_mm = 35 }",
        "capsule = { a_mm = [-150, 0, 10], b_mm = [100, 40, 0], radius_mm = 30 }",
        "box = { centre_mm = [20, 0, 0], size_mm = [240, 90, 160] }",
    ];
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut apart, mut worst) = (0, 0.0_f64);
    for link in shapes {
        for part in shapes {
            let cell = probe_cell(link, part);
            let scene = Scene::new(&cell);
            let there = placed(&cell, &scene);
            let (Shape::Sphere { .. } | Shape::Capsule { .. } | Shape::Box { .. }) =
                &cell.equipment[0].solids[0].shape
            else {
                panic!()
            };
            let body =
                RoundedSolid::of(&cell.equipment[0].solids[0].shape, &cell.start().placements[0].pose());
            for _ in 0..150 {
                let pose = random_pose(&mut rng, V::new(0.1, 0.9, 0.7), 0.6);
                let mut frames = [Pose::identity(); MAX_JOINTS + 1];
                frames[4] = pose;
                let want = RoundedSolid::of(&cell.robot.solids[0].solid.shape, &pose).distance(&body);
                let got = scene.distance(&there, &frames, Some(0), 10.0);
                let off = got.distance - want;
                // The reference converges from above, and slowly if faces are nearly parallel.
                assert!((-1e-5..=ACCURACY).contains(&off), "{link} {part}: {} for {want}", got.distance);
                let pair = Hit { solid: SolidRef::Robot(0), other: SolidRef::Equipment(0, 0) };
                assert_eq!(got.pair, Some(pair));
                worst = worst.max(off.abs());
                apart += usize::from(want > 1e-3);
                // Beyond a maximum no distance is reported.
                let near = scene.distance(&there, &frames, Some(0), want * 0.9);
                assert!(want == 0.0 || (near.distance == want * 0.9 && near.pair.is_none()));
            }
        }
    }
    assert!(apart > 800, "{apart} of 1350 apart, off by {worst:e}");
}

// --- moves ---------------------------------------------------------------------------------------

const AROUND: &str = "[obstacle.post]\nsolid = [{ name = \"post\", box = { centre_mm = [0, 0, 900], size_mm = [120, 120, 1800] } }]\n\
     placement = { x_mm = 700, y_mm = 500, z_mm = 0, yaw_deg = 20 }\n\
     [obstacle.tank]\nsolid = [{ name = \"tank\", cylinder = { a_mm = [0, 0, 0], b_mm = [0, 0, 900], radius_mm = 200 } }]\n\
     placement = { x_mm = -700, y_mm = 500, z_mm = 0 }\n";

#[test]
fn a_free_move_collides_in_no_sample() {
    const SAMPLES: usize = 10_000;
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    // The cells have a machine as a mesh, a round tank, and six axes.
    for (robot, cell) in [
        ("hitachi_cell", crate::common::shipped("hitachi_cell.toml")),
        ("hitachi_pw10", cell("hitachi_pw10", "table-2", "clearance_mm = 5", AROUND)),
        ("ur5e", cell("ur5e", "placeholder", "clearance_mm = 5", AROUND)),
    ] {
        let moves = 50;
        let (scene, chain) = (Scene::new(&cell), Chain::new(&cell.robot));
        let there = placed(&cell, &scene);
        let (mut free, mut blocked, mut early) = (0, 0, 0);
        for turn in 0..moves {
            let is_free = |q: &JointVector| scene.hit(&there, &links(&chain, q), Some(0)).is_none();
            let mut draw = || random_joints(&chain, &mut rng);
            let (a, b) = (std::iter::repeat_with(&mut draw).find(is_free).unwrap(), draw());
            // Each path has one to five moves.
            let count = 1 + turn % 5;
            let knots: Vec<_> = (0..=count)
                .map(|k| match k {
                    0 => a,
                    _ => between(
                        &between(&a, &b, 0.3 * k as f64 / count as f64),
                        &draw(),
                        0.02 * (count - 1) as f64,
                    ),
                })
                .collect();
            let at = |s: f64| {
                let k = ((s * count as f64) as usize).min(count - 1);
                between(&knots[k], &knots[k + 1], s * count as f64 - k as f64)
            };
            let hits = |s: f64| scene.hit(&there, &links(&chain, &at(s)), Some(0)).is_some();
            let sampled = (0..=SAMPLES).map(|k| k as f64 / SAMPLES as f64).find(|&s| hits(s));
            let found = hit(&chain, &scene, &there, &knots);
            match (sampled, found) {
                (None, None) => free += 1,
                (Some(s), None) => panic!("{robot}: free, but it hits at {s}"),
                // The reported hit is not after the first colliding sample by more than the last step.
                (Some(s), Some(hit)) => {
                    assert!(hit.at <= s + 1e-3, "{robot}: {} after {s}", hit.at);
                    blocked += 1;
                }
                // A hit that lies only between samples is rare.
                (None, Some(hit)) => {
                    let near = links(&chain, &at(hit.at));
                    let gap = scene.distance(&there, &near, Some(0), 1.0).distance - cell.clearance;
                    let own = !matches!(hit.hit.other, SolidRef::Equipment(..) | SolidRef::Floor);
                    assert!(own || gap < 2.0 * RESOLUTION, "{robot}: {hit:?} at {gap}");
                    early += 1;
                }
            }
        }
        assert!(free > moves / 10 && blocked > moves / 10 && early < moves / 10, "{free} {blocked} {early}");
    }
}

#[test]
fn a_zero_move_hits_only_what_stands_in_the_way() {
    let cell = cell("hitachi_pw10", "table-2", "", "");
    let (scene, chain) = (Scene::new(&cell), Chain::new(&cell.robot));
    let there = placed(&cell, &scene);
    let still = [0.0; MAX_JOINTS];
    assert_eq!(hit(&chain, &scene, &there, &[still, still]), None);
    // The arm stands in the table from the start.
    let mut layout = cell.start();
    layout.placements[0].y = 0.0;
    layout.placements[0].z = 0.2;
    let mut there = PlacedSolids::default();
    scene.place(&layout, &mut there);
    let hit = hit(&chain, &scene, &there, &[still, still]).unwrap();
    assert_eq!((hit.at, hit.hit.solid), (0.0, SolidRef::Robot(0)));
}

/// Returns the first hit of a path during the first operation.
fn hit(chain: &Chain, scene: &Scene, placed: &PlacedSolids, knots: &[JointVector]) -> Option<PathHit> {
    first_hit(chain, scene, placed, knots, Load::of(Some(0)), &PathSlack::default())
}

// --- lines ---------------------------------------------------------------------------------------

#[test]
fn straight_lines_are_straight_and_hold_the_tool() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for (robot, along_tool) in [
        ("hitachi_pw10", true),
        ("adept_cobra_s600", true),
        ("ur5e", false),
        ("kuka_youbot", true),
        ("franka_panda", false),
        ("puma560_on_track", false),
        ("abb_irb460", true),
    ] {
        let cell = load(&crate::common::cell_of_robot(robot));
        let (chain, reach) = (Chain::new(&cell.robot), cell.robot.reach());
        let (mut done, mut stopped) = (0, 0);
        for _ in 0..60 {
            let from = random_joints(&chain, &mut rng);
            let start = chain.forward(&chain.posture(&from));
            let random = V::from_fn(|_, _| rng.random_range(-1.0..1.0));
            // Arms with few axes keep their orientation only on lines along the tool axis.
            let direction = if along_tool { start.rotation * chain.tool_axis } else { random.normalize() };
            let way = direction * 0.15;
            let knots = match straight(&chain, &from, &way, reach) {
                Ok(knots) => knots,
                Err(Stopped::Limit { joint, after }) => {
                    assert!(joint < chain.axes() && after > 0.0 && after < 0.15 + 1e-12, "{robot}");
                    stopped += 1;
                    continue;
                }
                Err(Stopped::Lost { after }) => {
                    assert!((0.0..0.15).contains(&after), "{robot}");
                    stopped += 1;
                    continue;
                }
            };
            done += 1;
            assert_eq!(knots[0], from);
            for ends in knots.windows(2) {
                for s in [0.0, 0.2, 0.5, 0.7, 1.0] {
                    let q = between(&ends[0], &ends[1], s);
                    let tcp = chain.forward(&chain.posture(&q));
                    let along = tcp.translation - start.translation;
                    let aside = (along - direction * along.dot(&direction)).norm();
                    assert!(aside < 1.05 * DEVIATION, "{robot}: {aside} off the line");
                    if s == 0.0 || s == 1.0 {
                        assert!(aside < 1e-8 && (tcp.rotation - start.rotation).norm() < 1e-8, "{robot}");
                    }
                    for (q, link) in q.iter().zip(&chain.links) {
                        assert!(*q > link.limits.0 - 2e-6 && *q < link.limits.1 + 2e-6, "{robot}");
                    }
                }
            }
            let end = chain.forward(&chain.posture(knots.last().unwrap())).translation;
            assert!((end - start.translation - way).norm() < 1e-8, "{robot}");
        }
        assert!(done > 10, "{robot}: {done} lines, {stopped} stopped");
    }
}

#[test]
fn a_line_that_leaves_the_reach_is_refused() {
    let cell = cell("ur5e", "placeholder", "", "");
    let chain = Chain::new(&cell.robot);
    let from = [0.3, -1.2, 1.4, -1.8, -1.57, 0.2, 0.0, 0.0];
    let tcp = chain.forward(&chain.posture(&from)).translation;
    let out = V::new(tcp.x, tcp.y, 0.0).normalize() * 2.0;
    let Err(Stopped::Lost { after }) = straight(&chain, &from, &out, cell.robot.reach()) else { panic!() };
    // No line leads beyond the sum of the link lengths.
    assert!(after > 0.05 && (tcp + out.normalize() * after).norm() < 1.3, "{after}");
}

// --- measures ------------------------------------------------------------------------------------

/// Returns the smallest singular value of a Jacobian by eigenvalues. The Jacobian comes from central
/// differences, with lengths divided by the reach.
fn smallest_by_differences(chain: &Chain, q: &JointVector, reach: f64) -> f64 {
    let n = chain.axes();
    let step = 1e-5;
    let mut jacobian = nalgebra::DMatrix::<f64>::zeros(6, n);
    let here = chain.forward(&chain.posture(q)).rotation;
    for j in 0..n {
        let at = |by: f64| {
            let mut q = *q;
            q[j] += by;
            chain.forward(&chain.posture(&q))
        };
        let (a, b) = (at(-step), at(step));
        let position = (b.translation - a.translation) / (2.0 * step * reach);
        let turn = (b.rotation - a.rotation) / (2.0 * step) * here.transpose();
        let rotation = V::new(turn[(2, 1)], turn[(0, 2)], turn[(1, 0)]);
        jacobian.fixed_view_mut::<3, 1>(0, j).copy_from(&position);
        jacobian.fixed_view_mut::<3, 1>(3, j).copy_from(&rotation);
    }
    let gram = if n < 6 { jacobian.transpose() * &jacobian } else { &jacobian * jacobian.transpose() };
    gram.symmetric_eigenvalues().min().max(0.0).sqrt()
}

#[test]
fn the_singularity_measure_is_the_smallest_singular_value() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for robot in ["hitachi_pw10", "ur5e", "franka_panda", "puma560_on_track", "adept_cobra_s600"] {
        let cell = load(&crate::common::cell_of_robot(robot));
        let (chain, reach) = (Chain::new(&cell.robot), cell.robot.reach());
        for _ in 0..50 {
            let q = random_joints(&chain, &mut rng);
            let got = singularity(&chain, &chain.frames(&chain.posture(&q)), reach);
            let want = smallest_by_differences(&chain, &q, reach);
            assert!((got - want).abs() < 1e-6, "{robot}: {got} for {want}");
        }
    }
    let cell = cell("ur5e", "placeholder", "", "");
    let chain = Chain::new(&cell.robot);
    let at = |q: [f64; 6]| {
        let mut joints = [0.0; MAX_JOINTS];
        joints[..6].copy_from_slice(&q);
        singularity(&chain, &chain.frames(&chain.posture(&joints)), cell.robot.reach())
    };
    assert!(at([0.4, -1.1, 0.0, 0.3, 1.0, 0.1]) < 1e-12, "the elbow is stretched");
    assert!(at([0.4, -1.1, 1.2, 0.3, 0.0, 0.1]) < 1e-12, "the wrist is in line");
    assert!(at([0.4, -1.1, 1.2, 0.3, 1.0, 0.1]) > 0.02);
}

#[test]
fn the_joint_limit_measure_is_one_in_the_middle_and_zero_at_the_limit() {
    let cell = cell("hitachi_pw10", "table-2", "", "");
    let chain = Chain::new(&cell.robot);
    let mut q = [0.0; MAX_JOINTS];
    for (q, link) in q.iter_mut().zip(&chain.links) {
        *q = (link.limits.0 + link.limits.1) / 2.0;
    }
    assert!((measures(&chain, &q, 1.0).limits - 1.0).abs() < 1e-12);
    q[2] = chain.links[2].limits.1;
    assert_eq!((measures(&chain, &q, 1.0).limits.abs() < 1e-12, measures(&chain, &q, 1.0).joint), (true, 2));
    q[0] = chain.links[0].limits.0 - 0.25 * (chain.links[0].limits.1 - chain.links[0].limits.0);
    let beyond = measures(&chain, &q, 1.0);
    assert!((beyond.limits + 0.5).abs() < 1e-12 && beyond.joint == 0, "{beyond:?}");
}

#[test]
fn a_posture_exactly_at_the_margin_is_used_and_one_beyond_it_is_not() {
    let wide = cell("hitachi_pw10", "table-2", "", "");
    let narrow = cell("hitachi_pw10", "table-2", "", "[margins]\njoint_deg = 5\n");
    let margin = narrow.margins.turn;
    assert!((margin - 5f64.to_radians()).abs() < 1e-15);
    let (free, kept) = (Chain::new(&wide.robot), Chain::with_margins(&narrow.robot, &narrow.margins));
    let inverse = Inverse::new(&kept);
    let down = inverse.tool_attitudes(&wide.operations[0].attitude, 0.0);
    let usable = |q1: f64| {
        let first = [q1, -0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        // The wrist turns the tool down.
        let bend = |q4: f64| {
            let mut q = first;
            q[3] = q4;
            free.forward(&free.posture(&q))
        };
        let axis = bend(0.0).rotation * free.tool_axis;
        let q4 = -std::f64::consts::FRAC_PI_2 - axis.z.asin();
        let tcp = bend(q4);
        assert!((tcp.rotation * free.tool_axis).z < -1.0 + 1e-12);
        match inverse.branches(&tcp.translation, &down) {
            Reach::Branches(all) => all.iter().any(|b| b.is_usable() && (b.joints[0] - q1).abs() < 1e-6),
            _ => false,
        }
    };
    for side in [-1.0, 1.0] {
        let edge = side * (wide.robot.joints[0].limits.1 - margin);
        assert!(usable(edge) && usable(edge - side * 1e-4) && !usable(edge + side * 1e-4), "{edge}");
    }
}

// --- ways ----------------------------------------------------------------------------------------

/// Returns a cell with two tables to the left and right of the arm, and the object `between` between them.
fn two_tables(between: &str, transfer: &str) -> Cell {
    load(&format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         {transfer}\n[robot]\nfrom = \"robots/hitachi_pw10.toml\"\n\
         [equipment.left]\nsurface = {{ size_mm = [20, 20] }}\nfootprint = {{ size_mm = [300, 300] }}\n\
         placement = {{ x_mm = -800, y_mm = 800, z_mm = 350 }}\n\
         [equipment.right]\nsurface = {{ size_mm = [20, 20] }}\nfootprint = {{ size_mm = [300, 300] }}\n\
         placement = {{ x_mm = 800, y_mm = 800, z_mm = 350 }}\n\
         [operation.pick]\non = \"left\"\ngrid = [1, 1]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xyz\"\n\
         [operation.place]\non = \"right\"\ngrid = [1, 1]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xyz\"\n\
         {between}"
    ))
}

const POST: &str = "[obstacle.post]\nsolid = [{ name = \"post\", box = { centre_mm = [0, 0, 325], size_mm = [100, 100, 650] } }]\n\
     placement = { x_mm = 0, y_mm = 1130, z_mm = 0 }\n";
const WALL: &str = "[obstacle.wall]\nsolid = [{ name = \"wall\", box = { centre_mm = [0, 0, 2000], size_mm = [20, 2000, 4000] } }]\n\
     placement = { x_mm = 0, y_mm = 1300, z_mm = 0 }\n";

/// Returns whether no sample of a path touches anything.
fn is_free(cell: &Cell, path: &[JointVector]) -> bool {
    let (scene, chain) = (Scene::new(cell), Chain::new(&cell.robot));
    let there = placed(cell, &scene);
    let free = |q: &JointVector| scene.hit(&there, &links(&chain, q), None).is_none();
    path.windows(2).all(|ends| (0..=2000).all(|k| free(&between(&ends[0], &ends[1], k as f64 / 2000.0))))
}

fn transfers_of(cell: Cell) -> (Cell, sweetspot::layout::Evaluation) {
    let workcell = Workcell::new(cell).unwrap();
    let evaluation = evaluate(&workcell, &workcell.cell.start());
    assert!(evaluation.outcomes.iter().all(|o| matches!(o, Outcome::Found(_))), "{evaluation:?}");
    (workcell.cell, evaluation)
}

#[test]
fn a_transfer_lifts_over_a_post_between_two_spots() {
    let rules = "transfer = { lift_mm = 300, via = [] }";
    let (cell, open) = transfers_of(two_tables("", rules));
    assert_eq!(open.transfers.iter().map(|t| t.way).collect::<Vec<_>>(), [TransferRoute::Direct]);
    assert!(open.objective.is_some() && is_free(&cell, &open.transfers[0].path));
    // Only the travel of the first joint counts, because it is the longest.
    let path = &open.transfers[0].path;
    assert!((open.transfers[0].travel - (path[1][0] - path[0][0]).abs()).abs() < 1e-9);

    let (cell, lifted) = transfers_of(two_tables(POST, rules));
    assert_eq!(lifted.transfers.iter().map(|t| t.way).collect::<Vec<_>>(), [TransferRoute::Lift]);
    let transfer = &lifted.transfers[0];
    assert!(is_free(&cell, &transfer.path) && transfer.travel > open.transfers[0].travel);
    let ends = [transfer.path[0], *transfer.path.last().unwrap()];
    assert!(!is_free(&cell, &ends), "the direct way");
    let chain = Chain::new(&cell.robot);
    let top =
        transfer.path.iter().map(|q| chain.forward(&chain.posture(q)).translation.z).fold(0.0, f64::max);
    assert!((top - 0.75).abs() < 1e-6, "lifted to {top}");

    // The lift is too low, or there is no lift.
    for (rules, tries) in [("transfer = { lift_mm = 100, via = [] }", 2), ("transfer = { via = [] }", 1)] {
        let (cell, blocked) = transfers_of(two_tables(POST, rules));
        let why = blocked.blocked.unwrap();
        assert_eq!((why.from, why.to, why.tries.len(), blocked.objective), (0, 1, tries, None));
        assert!(why.in_words(&cell).contains("tool touches post (post)"), "{}", why.in_words(&cell));
        assert!(blocked.cost > 1000.0 && blocked.cost.is_finite());
    }
    // The path goes through a raised posture.
    let via = "transfer = { via = [[0, -20, 45, 0], [0, 0, 40, 20]] }";
    let (cell, through) = transfers_of(two_tables(POST, via));
    assert!(
        matches!(through.transfers[0].way, TransferRoute::Via(_))
            && is_free(&cell, &through.transfers[0].path)
    );
    // The cycle returns to the start.
    let (cell, round) = transfers_of(two_tables(POST, "transfer = { lift_mm = 300, cycle = true }"));
    assert_eq!(round.transfers.len(), 2);
    assert!(round.transfers.iter().all(|t| is_free(&cell, &t.path)));
    assert_eq!(round.transfers[1].path.last(), round.transfers[0].path.first());
    // The cell does not request transfers.
    let (_, silent) = transfers_of(two_tables(WALL, "transfer = { check = false }"));
    assert!(silent.transfers.is_empty() && silent.blocked.is_none() && silent.objective.is_some());
}

#[test]
fn a_wall_between_two_spots_blocks_every_transfer() {
    let cell = two_tables(WALL, "transfer = { lift_mm = 300, via = [[0, 0, 0, 0], [0, -40, 0, 0]] }");
    let workcell = Workcell::new(cell).unwrap();
    let start = workcell.cell.start();
    let evaluation = evaluate(&workcell, &start);
    let blocked = evaluation.blocked.clone().unwrap();
    let ways: Vec<_> = blocked.tries.iter().map(|t| t.0).collect();
    assert_eq!(
        ways,
        [
            TransferRoute::Direct,
            TransferRoute::Lift,
            TransferRoute::Via(0),
            TransferRoute::Via(1),
            TransferRoute::LiftVia(0),
            TransferRoute::LiftVia(1)
        ]
    );
    for (way, what) in &blocked.tries {
        let Hindrance::Hit(hit) = what else { panic!("{way:?}: {what:?}") };
        assert_eq!(hit.hit.other, SolidRef::Equipment(2, 0), "{way:?}");
        assert!(hit.at > 0.0 && hit.at < 1.0, "{way:?}: {hit:?}");
    }
    let assessed = Assessment::new("start", &workcell, start.clone());
    let reasons = assessed.reasons();
    assert!(
        reasons.iter().any(|r| r.starts_with("no collision-free transfer from pick to place: direct: ")),
        "{reasons:?}"
    );
    assert_eq!(evaluation, evaluate(&workcell, &start));
}

#[test]
fn a_cycle_takes_the_nearest_turn_and_does_not_wind_up() {
    let cell = cell("ur5e", "placeholder", "transfer = { via = [], cycle = true }\ncollision = false", "");
    let (guard, scene) = (Guard::new(&cell).unwrap(), Scene::new(&cell));
    let there = placed(&cell, &scene);
    let near = |wrist: f64| [0.2, -1.2, 1.4, -1.8, -1.5, wrist, 0.0, 0.0];
    let stances = [3.0, -3.0, 1.0].map(|w| OperationPosture { operation: 0, joints: near(w) });
    let ways = guard.transfers(&scene, &there, &stances, &|_| None, None).unwrap();
    let short = std::f64::consts::TAU - 6.0;
    assert!((ways[0].travel - short).abs() < 1e-12, "{}", ways[0].travel);
    assert!((ways[0].arrival[5] - (3.0 + short)).abs() < 1e-12);
    // The distance from 3.28 to the nearest turn of 1 is 2.28.
    assert!((ways[1].travel - (2.0 + short)).abs() < 1e-12, "{}", ways[1].travel);
    assert_eq!(ways[2].path.last().unwrap(), &near(3.0));
}

// --- approach and retract ------------------------------------------------------------------------

/// Returns a cell with a lid over the table that has a square hole. The part at the tip is 100 mm wide.
fn lidded(hole: f64, lengths: &str) -> Cell {
    let (side, at) = (400.0, hole / 2.0 + 200.0);
    let slab = |name: &str, x: f64, y: f64, sx: f64, sy: f64| {
        format!(
            "{{ name = \"{name}\", box = {{ centre_mm = [{x}, {y}, 250], size_mm = [{sx}, {sy}, 20] }} }},"
        )
    };
    let wide = hole + 2.0 * side;
    let slabs = slab("lid a", at, 0.0, side, wide)
        + &slab("lid b", -at, 0.0, side, wide)
        + &slab("lid c", 0.0, at, hole, side)
        + &slab("lid d", 0.0, -at, hole, side);
    load(&format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         [robot]\nfrom = \"robots/hitachi_pw10.toml\"\n\
         [equipment.table]\nsurface = {{ size_mm = [600, 400] }}\nsolid = [{slabs}]\n\
         placement = {{ x_mm = 0, y_mm = 1150, z_mm = 350 }}\n\
         [operation.work]\non = \"table\"\ngrid = [2, 2]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xyz\"\n{lengths}\n\
         held = {{ solid = [{{ name = \"disc\", box = {{ centre_mm = [-30, 0, 0], size_mm = [40, 100, 100] }} }}] }}\n"
    ))
}

#[test]
fn a_hole_narrower_than_the_held_part_blocks_approach_and_retract() {
    for (lengths, hole, want) in [
        ("", 90.0, "ok"),
        ("approach_mm = 50\nretract_mm = 50", 90.0, "ok"),
        ("approach_mm = 250", 90.0, "approach"),
        ("approach_mm = 50\nretract_mm = 250", 90.0, "retract"),
        ("approach_mm = 250\nretract_mm = 250", 160.0, "ok"),
    ] {
        let cell = lidded(hole, lengths);
        let workcell = Workcell::new(cell).unwrap();
        let start = workcell.cell.start();
        let map = &workcell.maps(&start)[0];
        // The middle of the table lies under the middle of the hole.
        let node = &map.nodes[4];
        assert_eq!(node.status.name(), want, "{lengths} {hole}: {}", node.status.reason(&workcell.cell));
        if want != "ok" {
            let reason = node.status.reason(&workcell.cell);
            assert!(reason.starts_with(&format!("{want}: disc touches table (lid")), "{reason}");
            let Status::Refused(PostureRefusal::Approach(what) | PostureRefusal::Retract(what)) = node.status
            else {
                panic!()
            };
            let Hindrance::Hit(hit) = what else { panic!("{what:?}") };
            // The disc (10 mm under its upper side) meets the lid after 90 of 250 mm.
            let upper = 0.25 - 0.01 - (0.1 + 0.05);
            assert!((hit.at - upper / 0.25).abs() < 0.01, "{hit:?}");
            let outcome = evaluate(&workcell, &start).outcomes[0];
            assert!(matches!(outcome, Outcome::Refused { .. }), "{outcome:?}");
        } else {
            assert!(matches!(evaluate(&workcell, &start).outcomes[0], Outcome::Found(s) if s.node == 4));
        }
    }
}

#[test]
fn nearly_singular_postures_are_not_used() {
    let open = cell("hitachi_pw10", "table-2", "", "");
    let workcell = Workcell::new(open.clone()).unwrap();
    let chain = Chain::new(&open.robot);
    let measure = |q: &JointVector| measures(&chain, q, open.robot.reach()).singularity;
    let map = workcell.maps(&open.start()).remove(0);
    let mut all: Vec<f64> =
        map.nodes.iter().filter_map(|n| Some(measure(&n.posture.as_ref()?.joints))).collect();
    all.sort_by(f64::total_cmp);
    let middle = (all[all.len() / 2] + all[all.len() / 2 - 1]) / 2.0;
    let shut =
        Workcell::new(cell("hitachi_pw10", "table-2", "", &format!("[margins]\nsingularity = {middle}\n")));
    let kept = shut.unwrap().maps(&open.start()).remove(0);
    assert!(kept.count(NodeSign::Singular) > 0 && kept.count(NodeSign::Usable) > 0);
    for (node, before) in kept.nodes.iter().zip(&map.nodes) {
        match node.status {
            Status::Ok => assert!(measure(&node.posture.as_ref().unwrap().joints) >= middle),
            Status::Refused(PostureRefusal::Singular { measure }) => assert!(measure < middle),
            _ => assert_eq!(node.status, before.status),
        }
    }
}

// --- fence ---------------------------------------------------------------------------------------

fn fenced(polygon: &str, more: &str) -> Cell {
    cell("hitachi_pw10", "table-2", more, &format!("[fence]\npolygon_mm = {polygon}\n"))
}

const L_SHAPE: &str = "[[-1500, -900], [1700, -900], [1700, 900], [400, 900], [400, 2300], [-1500, 2300]]";

/// Returns whether a point is inside a polygon, by the winding number.
fn inside(corners: &[(f64, f64)], (x, y): (f64, f64)) -> bool {
    let n = corners.len();
    let angle: f64 = (0..n)
        .map(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % n]);
            let (u, v) = ((a.0 - x, a.1 - y), (b.0 - x, b.1 - y));
            (u.0 * v.1 - u.1 * v.0).atan2(u.0 * v.0 + u.1 * v.1)
        })
        .sum();
    angle.abs() > 3.0
}

#[test]
fn the_fence_contains_a_solid_with_all_its_points() {
    // The corners of the fence are in either order. A spike of the fence goes through the table.
    let turned = "[[-1500, 2300], [400, 2300], [400, 900], [1700, 900], [1700, -900], [-1500, -900]]";
    let spike =
        "[[-1500, -900], [1700, -900], [1700, 2300], [40, 2300], [0, 1150], [-40, 2300], [-1500, 2300]]";
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for polygon in [L_SHAPE, turned, spike] {
        let cell = fenced(polygon, "");
        let corners = cell.fence.as_ref().unwrap().corners.clone();
        let plan = FloorPlan::new(&cell);
        let ends = corners.iter().zip(corners.iter().cycle().skip(1));
        let line: Vec<(f64, f64)> = ends
            .flat_map(|(a, b)| {
                (0..2000)
                    .map(|k| f64::from(k) / 2000.0)
                    .map(move |s| (a.0 + s * (b.0 - a.0), a.1 + s * (b.1 - a.1)))
            })
            .collect();
        let mut layout = cell.start();
        let (mut within, mut without, mut found) = (0, 0, Vec::new());
        for _ in 0..1500 {
            let at = &mut layout.placements[0];
            (at.x, at.y, at.yaw) =
                (rng.random_range(-1.9..2.1), rng.random_range(-1.3..2.7), rng.random_range(-3.0..3.0));
            let at = layout.placements[0];
            let (sin, cos) = at.yaw.sin_cos();
            // The centre of the rectangle lies inside the fence, and no point of the fence lies in the
            // rectangle. For a certain verdict, the rectangle is grown or shrunk.
            let all = |grow: f64| {
                let in_it = |&(x, y): &(f64, f64)| {
                    let (dx, dy) = (x - at.x, y - at.y);
                    let (u, v) = (cos * dx + sin * dy, cos * dy - sin * dx);
                    u.abs() < 0.3 * grow && v.abs() < 0.2 * grow
                };
                inside(&corners, (at.x, at.y)) && !line.iter().any(in_it)
            };
            plan.overlaps(&layout, &mut found);
            let passed = found.iter().find(|o| (o.a, o.b) == (Party::Equipment(0), Party::Fence));
            if all(1.02) {
                assert!(passed.is_none(), "{polygon}: {passed:?} at {at:?}");
                within += 1;
            } else if !all(0.98) {
                assert!(passed.is_some_and(|o| o.depth > 0.0), "{polygon}: {at:?}");
                without += 1;
            }
        }
        assert!(within > 100 && without > 300, "{within} {without}");
        // The depth grows with the distance outside.
        let depth = |x: f64| {
            let mut layout = cell.start();
            (layout.placements[0].x, layout.placements[0].y) = (x, 0.2);
            let mut found = Vec::new();
            plan.overlaps(&layout, &mut found);
            found.iter().find(|o| o.b == Party::Fence).map_or(0.0, |o| o.depth)
        };
        for k in 0..200 {
            let x = -1.0 - f64::from(k) * 0.01;
            let want = (-1.2 - x).max(0.0);
            assert!((depth(x) - want).abs() < 1e-9, "{polygon}: {} for {want} at {x}", depth(x));
        }
    }
}

#[test]
fn the_fence_keeps_the_clearance_and_the_base_inside() {
    let cell = fenced("[[-1000, -200], [1000, -200], [1000, 2000], [-1000, 2000]]", "clearance_mm = 50");
    let (plan, mut found) = (FloorPlan::new(&cell), Vec::new());
    let mut layout = cell.start();
    layout.placements[0].x = 0.65;
    plan.overlaps(&layout, &mut found);
    // The base, which is 600 mm wide, passes the fence by 100 mm plus the clearance. The table just fits.
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!((found[0].a, found[0].b), (Party::RobotBase, Party::Fence));
    assert!((found[0].depth - 0.15).abs() < 1e-9 && found[0].concerns(0));
    assert_eq!(found[0].in_words(&cell), "the robot base reaches beyond the fence by 100.0 mm");
    layout.placements[0].x = 0.651;
    plan.overlaps(&layout, &mut found);
    assert!(found.iter().any(|o| o.a == Party::Equipment(0) && (o.depth - 0.001).abs() < 1e-9), "{found:?}");
    // An obstacle may stand outside.
    let far = "[obstacle.far]\nfootprint = { size_mm = [100, 100] }\nplacement = { x_mm = 5000, y_mm = 0, z_mm = 0 }\n";
    let polygon = "[[-3000, -3000], [3000, -3000], [3000, 3000], [-3000, 3000]]";
    let cell = load(&format!("{}{far}", cell_text_of(polygon)));
    FloorPlan::new(&cell).overlaps(&cell.start(), &mut found);
    assert!(found.is_empty(), "{found:?}");
}

fn cell_text_of(polygon: &str) -> String {
    format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"table-2\"\n\
         [robot]\nfrom = \"robots/hitachi_pw10.toml\"\n\
         [equipment.table]\nsurface = {{ size_mm = [600, 400] }}\n\
         placement = {{ x_mm = {{ min = -5000, max = 5000, start = 0 }}, y_mm = {{ min = -5000, max = 5000, start = 1200 }}, z_mm = 600 }}\n\
         [operation.work]\non = \"table\"\ngrid = [2, 2]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xyz\"\n\
         [fence]\npolygon_mm = {polygon}\n"
    )
}

#[test]
fn a_table_is_pulled_back_into_a_convex_fence() {
    let cell = load(&cell_text_of("[[-2000, -1000], [2000, -1000], [1500, 2000], [-1500, 2000]]"));
    let workcell = Workcell::new(cell).unwrap();
    let mut layout = workcell.cell.start();
    (layout.placements[0].x, layout.placements[0].y) = (2.5, 2.5);
    let back = separated(&workcell, &layout).unwrap();
    let evaluation = evaluate(&workcell, &back);
    assert!(evaluation.overlaps.is_empty());
    // At the nearest place, the table touches the slanted side and the far side of the fence.
    let at = &back.placements[0];
    assert!((at.y - 1.8).abs() < 1e-4 && at.x > 1.1 && at.x < 1.25, "{at:?}");
}

#[test]
fn fence_walls_are_solid() {
    let polygon = "[[-1500, -800], [1500, -800], [1500, 1150], [-1500, 1150]]\nheight_mm = 2500";
    let open = load(&cell_text_of("[[-1500, -800], [1500, -800], [1500, 1150], [-1500, 1150]]"));
    let walled = load(&cell_text_of(polygon));
    let mut q = [0.0; MAX_JOINTS];
    q[0] = 0.05;
    let chain = Chain::new(&open.robot);
    let frames = chain.frames(&chain.posture(&q));
    // The tool reaches over the line at y = 1.15.
    assert!(frames.tcp.translation.y > 1.2);
    let hit = |cell: &Cell| {
        let scene = Scene::new(cell);
        let there = placed(cell, &scene);
        (scene.hit(&there, &frames.links, Some(0)), scene.distance(&there, &frames.links, None, 0.5))
    };
    assert_eq!(hit(&open).0, None);
    let (touched, near) = hit(&walled);
    // The tool touches the third edge, from the corner (1500, 1150).
    assert_eq!(touched.map(|h| h.other), Some(SolidRef::Fence(2)));
    assert_eq!(touched.unwrap().other.in_words(&walled), "wall 3 of the fence");
    assert_eq!((near.distance, near.pair.map(|h| h.other)), (0.0, Some(SolidRef::Fence(2))));
}
