//! Moves, lines, transfers, margins and the fence against dense sampling and closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod common;

use common::from_text;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{Cell, JointVector, MAX_JOINTS, Shape};
use sweetspot::clearance::{ACCURACY, Hit, Load, Placed, Scene, SolidRef};
use sweetspot::motion::{RESOLUTION, first_hit};
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;

type V = Vector3<f64>;
type Frames = [Pose; MAX_JOINTS + 1];

fn load(text: &str) -> Cell {
    from_text(text).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

/// A cell round a robot of the library; `more` adds tables, `head` plain keys.
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

fn placed(cell: &Cell, scene: &Scene) -> Placed {
    let mut placed = Placed::default();
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

/// A solid as a core (point, segment or box) in the world, with a radius round it.
enum Round {
    Bar(V, V, f64),
    Box(Pose, V),
}

impl Round {
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

    /// The nearest point of the core.
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

    /// Alternating projections between convex sets come as near as the sets are (Cheney and Goldstein).
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
fn distances_are_those_of_alternating_projections() {
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
            let body = Round::of(&cell.equipment[0].solids[0].shape, &cell.start().placements[0].pose());
            for _ in 0..150 {
                let pose = random_pose(&mut rng, V::new(0.1, 0.9, 0.7), 0.6);
                let mut frames = [Pose::identity(); MAX_JOINTS + 1];
                frames[4] = pose;
                let want = Round::of(&cell.robot.solids[0].solid.shape, &pose).distance(&body);
                let got = scene.distance(&there, &frames, Some(0), 10.0);
                let off = got.distance - want;
                // The reference comes from above, and slowly where faces are nearly parallel.
                assert!(off <= ACCURACY && off >= -1e-5, "{link} {part}: {} for {want}", got.distance);
                let pair = Hit { solid: SolidRef::Robot(0), other: SolidRef::Equipment(0, 0) };
                assert_eq!(got.pair, Some(pair));
                worst = worst.max(off.abs());
                apart += usize::from(want > 1e-3);
                // Up to a maximum, beyond which nothing is said.
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
fn a_free_move_hits_in_no_sample() {
    const SAMPLES: usize = 10_000;
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for (robot, errors, moves) in [("hitachi_pw10", "table-2", 50), ("ur5e", "placeholder", 50)] {
        let cell = cell(robot, errors, "clearance_mm = 5", AROUND);
        let (scene, chain) = (Scene::new(&cell), Chain::new(&cell.robot));
        let there = placed(&cell, &scene);
        let (mut free, mut blocked, mut early) = (0, 0, 0);
        for _ in 0..moves {
            let is_free = |q: &JointVector| scene.hit(&there, &links(&chain, q), Some(0)).is_none();
            let mut draw = || random_joints(&chain, &mut rng);
            let (a, b) = (std::iter::repeat_with(&mut draw).find(is_free).unwrap(), draw());
            let b = between(&a, &b, 0.3);
            let hits = |s: f64| scene.hit(&there, &links(&chain, &between(&a, &b, s)), Some(0)).is_some();
            let sampled = (0..=SAMPLES).map(|k| k as f64 / SAMPLES as f64).find(|&s| hits(s));
            let found = first_hit(&chain, &scene, &there, (&a, &b), Load::of(Some(0)));
            match (sampled, found) {
                (None, None) => free += 1,
                (Some(s), None) => panic!("{robot}: free, but it hits at {s}"),
                // What is told is never after the first sample that hits, but for the last step.
                (Some(s), Some(hit)) => {
                    assert!(hit.at <= s + 1e-3, "{robot}: {} after {s}", hit.at);
                    blocked += 1;
                }
                // Nearer than the resolution: rare.
                (None, Some(hit)) => {
                    let near = links(&chain, &between(&a, &b, hit.at));
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
