//! Tests the bound of the change of the Jacobian against Jacobians at random postures of the joint enclosure.

use crate::library;
use nalgebra::{SMatrix, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::{JointKind, JointVector, MAX_JOINTS};
use sweetspot::certificate::{JointEnclosure, TargetBox};
use sweetspot::reach::{MAX_ROWS, RotationRow, ToolTask, jacobian};
use sweetspot::robot::{Chain, Frames};

type Columns = SMatrix<f64, 6, MAX_JOINTS>;

/// Returns the geometric Jacobian, with lengths divided by `reach`.
fn scaled(chain: &Chain, frames: &Frames, reach: f64) -> Columns {
    let mut all = Columns::zeros();
    for (k, column) in jacobian(chain, frames).iter().enumerate().take(chain.axes()) {
        all.fixed_view_mut::<3, 1>(0, k).copy_from(&(column.position / reach));
        all.fixed_view_mut::<3, 1>(3, k).copy_from(&column.rotation);
    }
    all
}

/// Returns the task in which the joints `active` follow the target.
fn task(active: &[usize]) -> ToolTask {
    let mut all = [0; MAX_ROWS];
    all[..active.len()].copy_from_slice(active);
    let rotation = [Vector3::y(), Vector3::x(), Vector3::z()].map(|e| (RotationRow::Along(e), 0.0));
    ToolTask { rows: active.len(), active: all, rotation, radial: false, keeps_orientation: true }
}

/// Random postures of one arm, in which the joint `held` does not move. Returns the largest change of the
/// Jacobian as a share of its bound. The first axis is not parallel to the second, so a rotation about the
/// first axis does not count.
fn largest_share(name: &str, held: Option<usize>) -> f64 {
    let robot = library::robot(name);
    let (chain, reach) = (Chain::new(&robot), robot.reach());
    let active: Vec<usize> = (0..chain.axes()).filter(|j| Some(*j) != held).collect();
    let (task, mut rng) = (task(&active), ChaCha8Rng::seed_from_u64(18));
    let (mut largest, mut tested) = (0.0f64, 0);
    for _ in 0..400 {
        let mut joints: JointVector = [0.0; MAX_JOINTS];
        for (q, link) in joints.iter_mut().zip(&chain.links) {
            *q = rng.random_range(link.limits.0..=link.limits.1);
        }
        let frames = chain.frames(&chain.posture(&joints));
        let size = 10f64.powf(rng.random_range(-4.0..-2.0));
        let position = Vector3::from_fn(|_, _| size * f64::from(u8::from(rng.random::<bool>())));
        let target = TargetBox { position, yaw: 0.0, heading: 0.0 };
        let around = [0.0; MAX_JOINTS];
        let Ok(found) = JointEnclosure::new(&chain, &task, (&joints, &frames), &target, &around) else {
            continue;
        };
        tested += 1;
        let bound = found.jacobian_change(&chain, &task, &frames, reach);
        let nominal = scaled(&chain, &frames, reach);
        let mut singular = nominal.singular_values();
        singular.as_mut_slice().sort_by(f64::total_cmp);
        for k in 0..30 {
            let mut moved = joints;
            for step in &found.first {
                let share =
                    if k < 8 { [-1.0, 1.0][rng.random_range(0..2)] } else { rng.random_range(-1.0..1.0) };
                moved.iter_mut().zip(step).for_each(|(q, by)| *q += share * by);
            }
            let there = scaled(&chain, &chain.frames(&chain.posture(&moved)), reach);
            let mut values = there.singular_values();
            values.as_mut_slice().sort_by(f64::total_cmp);
            let change = (values - singular).amax();
            assert!(change <= bound + 1e-12, "{name}: a singular value changes by {change}, bound {bound}");
            if chain.links[0].kind == JointKind::Revolute && held != Some(0) {
                moved[0] = joints[0];
            }
            let there = scaled(&chain, &chain.frames(&chain.posture(&moved)), reach);
            let change = (there - nominal).norm();
            assert!(change <= bound + 1e-12, "{name}: the Jacobian changes by {change}, bound {bound}");
            largest = largest.max(change / bound.max(1e-12));
        }
    }
    assert!(tested > 100, "{name}: {tested} enclosures");
    largest
}

#[test]
fn the_jacobian_changes_by_at_most_its_bound() {
    for (name, held) in [
        ("kuka_youbot", None),
        ("puma560", None),
        ("ur10e", None),
        ("stanford_arm", None),
        ("fanuc_crx10ia", None),
        ("franka_panda", Some(6)),
        ("franka_panda", Some(2)),
        ("kinova_gen3", Some(0)),
        ("puma560_on_track", Some(0)),
        ("puma560_on_track", Some(1)),
    ] {
        let largest = largest_share(name, held);
        println!("{name} {held:?}: the change is at most {:.1} % of its bound", 100.0 * largest);
        // A much smaller share would mean that the bound refuses usable postures.
        assert!(largest > 0.5, "{name}: {largest}");
    }
}
