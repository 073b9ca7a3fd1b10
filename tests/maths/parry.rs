//! Tests every verdict of a scene against the crate parry alone, with all pairs and without bounds, memory or
//! closed forms.

use crate::common::{data, shipped};
use nalgebra::{Rotation3, Vector3};
use parry3d::math as pm;
use parry3d::query::intersection_test;
use parry3d::shape::{SharedShape, TriMesh, TriMeshFlags};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{BaseSupport, Cell, Coordinate, LinkSolid, MAX_JOINTS, Placement, Shape, Solid};
use sweetspot::clearance::{ContactMemory, PlacedSolids, Scene};
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;

type V = Vector3<f64>;

/// Padding of the clearance, m: contact is a collision.
const TOUCHING: f64 = 1e-7;
/// Distance from contact (m) within which verdicts may differ, because parry uses other shapes or frames.
const NEAR: f64 = 1e-4;

/// Solid for parry, with its pose in the world and a point of the solid. The inside of a closed mesh belongs
/// to the solid.
struct PosedSolid {
    shape: SharedShape,
    pose: pm::Pose,
    point: pm::Vector,
    closed: bool,
}

fn vector(v: &V) -> pm::Vector {
    pm::Vector::new(v.x, v.y, v.z)
}

fn posed(shape: SharedShape, frame: &Pose, local: &Pose) -> PosedSolid {
    let at = *frame * *local;
    let column = |i: usize| vector(&at.rotation.column(i).into_owned());
    let rotation = pm::Rotation::from_mat3(&pm::Matrix::from_cols(column(0), column(1), column(2)));
    let pose = pm::Pose::from_parts(vector(&at.translation), rotation);
    PosedSolid { shape, pose, point: pose.translation, closed: false }
}

/// Returns a shape grown by `by`, with its carrier at `frame`. Legs end at the floor. Returns None for a leg
/// without length.
fn solid(shape: &Shape, frame: &Pose, by: f64, floor: f64) -> Option<PosedSolid> {
    let cuboid = |half: V| match by > 0.0 {
        true => SharedShape::round_cuboid(half.x, half.y, half.z, by),
        false => SharedShape::cuboid(half.x, half.y, half.z),
    };
    let at = |translation: V| Pose { translation, ..Pose::identity() };
    Some(match shape {
        Shape::Box { pose, size } => posed(cuboid(size / 2.0), frame, pose),
        Shape::Sphere { centre, radius } => posed(SharedShape::ball(radius + by), frame, &at(*centre)),
        Shape::Capsule { a, b, radius } => {
            let (middle, half) = ((a + b) / 2.0, (b - a) / 2.0);
            posed(SharedShape::capsule(vector(&-half), vector(&half), radius + by), frame, &at(middle))
        }
        Shape::Cylinder { a, b, radius } => {
            let half = (b - a).norm() / 2.0;
            let turn = Rotation3::rotation_between(&V::y(), &(b - a)).unwrap();
            let pose = Pose { rotation: turn.into_inner(), translation: (a + b) / 2.0 };
            let round = match by > 0.0 {
                true => SharedShape::round_cylinder(half, *radius, by),
                false => SharedShape::cylinder(half, *radius),
            };
            posed(round, frame, &pose)
        }
        Shape::Leg { x, y, size, top } => {
            let height = frame.translation.z + top - floor;
            if height <= 0.0 {
                return None;
            }
            let half = V::new(size.0 / 2.0, size.1 / 2.0, height / 2.0);
            posed(cuboid(half), frame, &at(V::new(*x, *y, top - height / 2.0)))
        }
        Shape::Mesh { pose, vertices, triangles, closed } => {
            let flags = if *closed { TriMeshFlags::ORIENTED } else { TriMeshFlags::empty() };
            let points = vertices.iter().map(vector).collect();
            let mesh = TriMesh::with_flags(points, triangles.clone(), flags).unwrap();
            PosedSolid { closed: *closed, ..posed(SharedShape::new(mesh), frame, pose) }
        }
    })
}

fn touch(a: &PosedSolid, b: &PosedSolid) -> bool {
    let holds = |shell: &PosedSolid, point| shell.closed && shell.shape.contains_point(&shell.pose, point);
    intersection_test(&a.pose, &*a.shape, &b.pose, &*b.shape).unwrap().intersecting || holds(b, a.point)
}

/// Returns whether the robot, with its solids grown by `by`, touches anything except itself.
fn brute(cell: &Cell, standing: &[PosedSolid], frames: &[Pose; MAX_JOINTS + 1], by: f64) -> bool {
    cell.robot.solids.iter().any(|s| {
        let base = cell.start().base;
        let frame = if s.link == 0 { base.pose() } else { base.pose() * frames[s.link] };
        let moving = solid(&s.solid.shape, &frame, by, cell.floor).unwrap();
        let low = moving.shape.compute_aabb(&moving.pose).mins.z;
        s.link > 0 && low <= cell.floor || standing.iter().any(|other| touch(&moving, other))
    })
}

fn random_vector(rng: &mut ChaCha8Rng, size: f64) -> V {
    V::from_fn(|_, _| rng.random_range(-size..size))
}

/// Returns a solid of up to `size` (m) about the origin of its carrier.
fn random_solid(rng: &mut ChaCha8Rng, kind: usize, size: f64) -> Solid {
    let side = |rng: &mut ChaCha8Rng| rng.random_range(0.1 * size..size);
    let turn = random_vector(rng, 3.0);
    let pose = Pose::from_translation_rpy(random_vector(rng, size / 2.0), turn);
    let (a, b) = (random_vector(rng, size), random_vector(rng, size));
    let shape = match kind {
        0 => Shape::Box { pose, size: V::new(side(rng), side(rng), side(rng)) },
        1 => Shape::Sphere { centre: a, radius: side(rng) / 2.0 },
        2 => Shape::Capsule { a, b, radius: side(rng) / 4.0 },
        3 => Shape::Cylinder { a, b, radius: side(rng) / 4.0 },
        _ => Shape::Leg { x: a.x, y: a.y, size: (side(rng), side(rng)), top: b.z },
    };
    Solid { name: "random".into(), shape }
}

/// Returns the shipped cell (with a mesh of 10 000 triangles) with other solids for each seed. The robot has
/// its capsules or random solids, and table and conveyor have random solids.
fn random_cell(seed: u64, rng: &mut ChaCha8Rng) -> Cell {
    let mut cell = shipped("hitachi_cell.toml");
    cell.robot.self_collision.checked = false;
    cell.clearance = [0.0, 0.0, 0.02, 0.1][seed as usize % 4];
    if !seed.is_multiple_of(3) {
        cell.base = [0.1, -0.2, 0.15, 0.4].map(Coordinate::Fixed);
    }
    if seed % 2 == 1 {
        let links = (0..7).map(|k| LinkSolid { link: k % 5, solid: random_solid(rng, k % 4, 0.3) });
        cell.robot.solids = links.collect();
    }
    for e in 0..2 {
        cell.equipment[e].solids = (0..6).map(|k| random_solid(rng, k % 5, 0.4)).collect();
    }
    cell
}

#[test]
fn random_cells_agree_with_parry_alone() {
    let (mut hits, mut free, mut near) = (0, 0, 0);
    for seed in 0..40 {
        let rng = &mut ChaCha8Rng::seed_from_u64(seed);
        // The reference has no pedestal.
        let cell = Cell { base_support: BaseSupport::Hung, ..random_cell(seed, rng) };
        let (scene, mut placed, chain) =
            (Scene::new(&cell), PlacedSolids::default(), Chain::new(&cell.robot));
        let mut memory = ContactMemory::default();
        for _ in 0..5 {
            let mut layout = cell.start();
            for at in &mut layout.placements[..2] {
                let place = random_vector(rng, 1.8);
                *at = Placement { x: place.x, y: place.y, z: 0.6 + place.z / 6.0, yaw: place.z };
            }
            scene.place(&layout, &mut placed);
            let standing: Vec<PosedSolid> = cell
                .equipment
                .iter()
                .zip(&layout.placements)
                .flat_map(|(e, at)| {
                    e.solids.iter().filter_map(|s| solid(&s.shape, &at.pose(), 0.0, cell.floor))
                })
                .collect();
            for _ in 0..100 {
                let q = std::array::from_fn(|i| match cell.robot.joints.get(i) {
                    Some(joint) => rng.random_range(joint.limits.0..joint.limits.1),
                    None => 0.0,
                });
                let frames = chain.frames(&chain.posture(&q)).links;
                let got = scene.hit(&placed, &frames, None).is_some();
                let is_free = scene.is_free(&placed, &frames, None, &mut memory);
                assert_eq!(is_free, !got, "hit and is_free, seed {seed}");
                let want = |by: f64| brute(&cell, &standing, &frames, (cell.clearance + by).max(0.0));
                if got != want(TOUCHING) {
                    assert!(want(NEAR) != want(-NEAR), "seed {seed}: {got} at {q:?} {layout:?}");
                    near += 1;
                }
                (hits, free) = (hits + u32::from(got), free + u32::from(!got));
            }
        }
    }
    println!("{} verdicts of random cells, {near} differ within 0.1 mm of contact", hits + free);
    assert!(hits > 3_000 && free > 3_000 && near < 20, "{hits} hits, {free} free, {near} near contact");
}

/// In the postures of peer set C, the robot turns until its capsules barely pass the mesh. Bisection finds
/// the border between the verdicts, where errors of culling would appear first.
#[test]
fn the_last_free_posture_agrees_with_parry() {
    let mut cell = shipped("hitachi_cell.toml");
    cell.robot.self_collision.checked = false;
    let (scene, mut placed, chain) = (Scene::new(&cell), PlacedSolids::default(), Chain::new(&cell.robot));
    let layout = cell.start();
    scene.place(&layout, &mut placed);
    let standing: Vec<PosedSolid> = cell
        .equipment
        .iter()
        .zip(&layout.placements)
        .flat_map(|(e, at)| e.solids.iter().filter_map(|s| solid(&s.shape, &at.pose(), 0.0, cell.floor)))
        .collect();
    let q = data("c_pw10_q.bin");
    let mut met = 0;
    for pair in q.chunks_exact(8).take(150) {
        let at =
            |t: f64| std::array::from_fn(|i| if i < 4 { pair[i] + t * (pair[i + 4] - pair[i]) } else { 0.0 });
        let links = |t: f64| chain.frames(&chain.posture(&at(t))).links;
        let want = |t: f64, by: f64| brute(&cell, &standing, &links(t), by.max(0.0));
        let (mut from, mut to) = (0.0, 1.0);
        let first = want(from, TOUCHING);
        if want(to, TOUCHING) == first {
            continue;
        }
        for _ in 0..30 {
            let middle = (from + to) / 2.0;
            if want(middle, TOUCHING) == first {
                from = middle
            } else {
                to = middle
            }
            let got = scene.hit(&placed, &links(middle), None).is_some();
            let same = got == want(middle, TOUCHING);
            // In the last steps the difference is less than parry's own error.
            assert!(same || to - from < 1e-5, "{got} at {middle} of {pair:?}");
        }
        met += 1;
    }
    assert!(met > 30, "{met} contacts");
}
