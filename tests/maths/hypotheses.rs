//! Tests the hypotheses about measured data: simulated files of several arms must be interpreted as they were
//! written.

use crate::common::robots;
use crate::kinematics::product::{no_errors, position, tcp};
use nalgebra::{Rotation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI};
use sweetspot::calibration::{
    DataReading, Deformed, JointMap, MeasuredPosition, RawMeasurement, SessionFrames, SuspectRows, aligned,
    explain, spread_out,
};
use sweetspot::cell::{JointKind, JointVector, Robot};
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;

/// Standard deviation of the noise of a coordinate, m.
const NOISE: f64 = 2e-4;

/// Arm with the reflector as its TCP, and the pose of its base in the frame of the tracker.
struct Simulated {
    robot: Robot,
    chain: Chain,
    base: Pose,
}

impl Simulated {
    fn new(name: &str) -> Self {
        let (_, mut robot) = robots().into_iter().find(|(own, _)| own == name).unwrap();
        robot.tool = Pose { translation: Vector3::new(0.06, -0.04, 0.11), ..Pose::identity() };
        let chain = Chain::new(&robot);
        let rotation = Rotation3::from_euler_angles(0.02, -0.01, 2.0).into_inner();
        Self { robot, chain, base: Pose { rotation, translation: Vector3::new(3.0, -2.0, 0.4) } }
    }

    fn posture(&self, rng: &mut ChaCha8Rng) -> JointVector {
        std::array::from_fn(|i| match self.chain.links.get(i) {
            Some(link) => rng.random_range(link.limits.0.max(-2.5)..=link.limits.1.min(2.5)),
            None => 0.0,
        })
    }

    /// Returns the measured position, m: a product of textbook matrices, moved into the frame of the tracker.
    fn seen(&self, q: &JointVector, rng: &mut ChaCha8Rng) -> Vector3<f64> {
        let own = position(&tcp(&self.robot, q, &no_errors(self.robot.axes()), 0.0));
        let noise = Vector3::from_fn(|_, _| NOISE * rng.random_range(-1.7..1.7));
        self.base.transform(&self.robot.mount.transform(&own)) + noise
    }

    /// Returns rows in degrees and mm. The function `write` converts joints (rad or m) and position (mm) to
    /// the conventions of a file.
    fn file(
        &self,
        postures: &[JointVector],
        write: &dyn Fn(&mut JointVector, &mut Vector3<f64>),
        seed: u64,
    ) -> Vec<RawMeasurement> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let row = |(k, q): (usize, &JointVector)| {
            let mut position = self.seen(q, &mut rng) * 1e3;
            let mut joints = *q;
            write(&mut joints, &mut position);
            for (q, link) in joints.iter_mut().zip(&self.chain.links) {
                *q = if link.kind == JointKind::Revolute { q.to_degrees() } else { *q * 1e3 };
            }
            RawMeasurement::from(&MeasuredPosition {
                row: k + 1,
                joints,
                reflector: 0,
                position,
                rotation: None,
                sigma: None,
            })
        };
        postures.iter().enumerate().map(row).collect()
    }

    fn postures(&self, count: usize, seed: u64) -> Vec<JointVector> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        (0..count).map(|_| self.posture(&mut rng)).collect()
    }

    /// Returns the largest distance, m, of the measured positions from the nominal arm, with frames fitted to
    /// the first 40 rows.
    fn distance(&self, reading: &DataReading, rows: &[RawMeasurement]) -> f64 {
        let measured: Vec<_> = rows.iter().map(|raw| reading.applied(&self.chain, raw)).collect();
        let poses: Vec<_> =
            measured.iter().map(|m| Deformed::new(&self.chain, &m.joints, &[], &[])).collect();
        let frames: SessionFrames = aligned(&poses[..40], &measured[..40]).unwrap();
        let distance = |(pose, m): (&Deformed, &MeasuredPosition)| frames.residual(&pose.interface, m).norm();
        poses.iter().zip(&measured).skip(40).map(distance).fold(0.0, f64::max)
    }

    /// Interprets a file that `write` has written, and checks that rows outside the file fit equally well.
    fn check(&self, write: &dyn Fn(&mut JointVector, &mut Vector3<f64>), what: &str) -> DataReading {
        let rows = self.file(&self.postures(80, 5), write, 6);
        let reading = explain(&self.chain, &rows[..60], self.robot.reach()).unwrap();
        let farthest = self.distance(&reading, &rows);
        let name = &self.robot.name;
        assert!(reading.rms < 6e-4 && farthest < 3e-3, "{name}, {what}: {farthest} m, {reading:?}");
        assert!(reading.degrees && reading.unit == 1e-3, "{name}, {what}: {reading:?}");
        reading
    }
}

#[test]
fn a_file_as_expected_is_read_as_it_stands() {
    for name in ["ur10", "abb_irb460", "adept_cobra_s600", "franka_panda"] {
        let reading = Simulated::new(name).check(&|_, _| {}, "plain");
        assert!(reading.is_plain() && reading.plain_rms == reading.rms, "{name}: {reading:?}");
    }
}

/// A UR10 has offsets between all axes, so only one hypothesis explains its data.
#[test]
fn each_mistake_in_a_file_of_a_ur10_is_named() {
    let arm = Simulated::new("ur10");
    let map = |change: &dyn Fn(&mut JointMap)| {
        let mut map = JointMap::PLAIN;
        change(&mut map);
        map
    };
    let reading = arm.check(&|q, _| q[2] += q[1], "joint 3 against the floor");
    assert_eq!(reading.joints, map(&|m| m.couplings[0] = Some((2, 1, -1.0))));
    assert!(reading.plain_rms > 0.1, "{reading:?}");
    let reading = arm.check(&|q, _| q[2] -= q[1], "joint 3 against the floor, other sign");
    assert_eq!(reading.joints, map(&|m| m.couplings[0] = Some((2, 1, 1.0))));
    let reading = arm.check(&|q, _| (q[4], q[5]) = (q[4] + q[3], q[5] - q[3]), "coupled wrist");
    let wrist = [None, Some((4, 3, -1.0)), Some((5, 3, 1.0)), None];
    assert_eq!(reading.joints, map(&|m| m.couplings = wrist));
    let reading = arm.check(&|q, _| q.swap(1, 2), "joints swapped");
    assert_eq!(reading.joints.columns[..6], [0, 2, 1, 3, 4, 5]);
    let reading = arm.check(&|q, _| q[..6].rotate_right(1), "columns shifted");
    assert_eq!(reading.joints.columns[..6], [1, 2, 3, 4, 5, 0]);
    let reading = arm.check(&|q, _| q[..6].reverse(), "order reversed");
    assert_eq!(reading.joints.columns[..6], [5, 4, 3, 2, 1, 0]);
    let reading = arm.check(&|q, _| (q[1], q[3]) = (q[1] + FRAC_PI_2, q[3] - PI), "zeros");
    assert_eq!(reading.joints.signs, [1.0; 8]);
    let turns = [reading.joints.offsets[1], reading.joints.offsets[3].abs()];
    assert!((turns[0] + FRAC_PI_2).abs() < 1e-12 && (turns[1] - PI).abs() < 1e-12, "{reading:?}");
    let reading = arm.check(&|q, _| (q[1], q[2]) = (-q[1], FRAC_PI_2 - q[2]), "signs and a zero");
    assert_eq!((reading.joints.signs[1], reading.joints.signs[2]), (-1.0, -1.0));
    for swap in [(0, 1), (1, 2), (0, 2)] {
        let reading = arm.check(&|_, p| p.swap_rows(swap.0, swap.1), "coordinates swapped");
        assert!(reading.mirrored && reading.joints == JointMap::PLAIN, "{reading:?}");
    }
    let turned = arm.check(&|_, p| *p = Vector3::new(p.y, p.z, p.x), "coordinates in a cycle");
    assert!(turned.is_plain(), "{turned:?}");
}

/// Data of symmetric arms may have several explanations. An explanation is right if it also explains other
/// rows.
#[test]
fn files_of_other_arms_are_explained() {
    let palletizer = Simulated::new("abb_irb460");
    let reading = palletizer.check(&|q, _| q[2] += q[1], "joint 3 against the floor");
    assert!(!reading.is_plain());
    palletizer.check(&|q, _| (q[1], q[2]) = (-q[1], -q[2]), "signs");
    let scara = Simulated::new("adept_cobra_s600");
    scara.check(&|q, _| q[1] = -q[1], "a sign");
    scara.check(&|q, _| q.swap(0, 1), "joints swapped");
    let seven = Simulated::new("franka_panda");
    seven.check(&|q, _| (q[1], q[3], q[5]) = (-q[1], -q[3], -q[5]), "signs");
    seven.check(&|q, _| q.swap(2, 4), "joints swapped");
    seven.check(&|q, _| q[3] += FRAC_PI_2, "a zero");
}

/// A choice of rows at equal steps would always show the same joint.
#[test]
fn sweeps_of_one_joint_after_the_other_are_explained() {
    let arm = Simulated::new("ur10");
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for interleaved in [true, false] {
        let postures: Vec<JointVector> = (0..120)
            .map(|k| {
                let mut q = [0.3, -1.0, 0.9, 0.5, 1.2, 0.4, 0.0, 0.0];
                q[if interleaved { k % 6 } else { k / 20 }] = rng.random_range(-2.0..2.0);
                q
            })
            .collect();
        let rows = arm.file(&postures, &|q, _| (q[1], q[2]) = (-q[1], q[2] + q[1]), 3);
        let reading = explain(&arm.chain, &rows, arm.robot.reach()).unwrap();
        assert!(reading.rms < 6e-4 && !reading.is_plain(), "{reading:?}");
        assert_eq!(reading.joints.signs[1], -1.0);
    }
    let some = spread_out(120, 26);
    assert_eq!(some.len(), 26);
    for joint in 0..6 {
        assert!(some.iter().any(|k| k % 6 == joint) && some.iter().any(|k| k / 20 == joint));
    }
    assert_eq!(spread_out(3, 26), [0, 1, 2]);
}

#[test]
fn rows_with_gross_errors_do_not_hide_the_explanation() {
    let arm = Simulated::new("ur10");
    let mut rows = arm.file(&arm.postures(60, 5), &|q, _| q[4] = -q[4], 6);
    for k in [7, 31, 55] {
        rows[k].numbers.position.x += 700.0;
    }
    let reading = explain(&arm.chain, &rows, arm.robot.reach()).unwrap();
    assert!(reading.rms < 6e-4 && reading.joints.signs[4] == -1.0, "{reading:?}");
}

#[test]
fn positions_of_another_arm_are_not_explained() {
    let (arm, other) = (Simulated::new("ur10"), Simulated::new("puma560"));
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let mut rows = arm.file(&arm.postures(60, 5), &|_, _| {}, 6);
    rows.iter_mut().for_each(|m| m.numbers.position = other.seen(&other.posture(&mut rng), &mut rng) * 1e3);
    let reading = explain(&arm.chain, &rows, arm.robot.reach());
    assert!(reading.is_none_or(|reading| !reading.is_plausible(arm.robot.reach()) && reading.is_plain()));
}

/// Suspect rows are found before the units are known, so the units must not matter.
#[test]
fn suspect_rows_are_found_in_any_unit() {
    let arm = Simulated::new("ur10");
    for factor in [1.0, 1e-3, 1.0 / 25.4] {
        let mut rows = arm.file(&arm.postures(30, 5), &|_, p| *p *= factor, 6);
        rows[9].numbers.position = rows[8].numbers.position;
        rows[19].numbers.joints = rows[18].numbers.joints;
        // The arm repeats this posture to within a tenth of a millimetre.
        rows[25].numbers.joints = rows[24].numbers.joints;
        rows[25].numbers.position = rows[24].numbers.position.add_scalar(0.1 * factor);
        let copy = RawMeasurement { numbers: MeasuredPosition { row: 31, ..rows[3].numbers }, ..rows[3] };
        rows.push(copy);
        let suspect = SuspectRows::new(&rows);
        let wanted = SuspectRows { copies: vec![31], stuck_positions: vec![10], stuck_joints: vec![20] };
        assert_eq!(suspect, wanted);
    }
}

/// Controllers of palletizers state four joints. Their passive joint has no column, or a meaningless one.
#[test]
fn the_column_of_a_passive_joint_does_not_matter() {
    let simulated = Simulated::new("abb_irb460");
    let passive: Vec<usize> =
        (0..simulated.chain.axes()).filter(|&i| simulated.chain.links[i].is_passive()).collect();
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    let postures: Vec<_> = (0..40).map(|_| simulated.posture(&mut rng)).collect();
    let write = |q: &mut JointVector, _: &mut Vector3<f64>| {
        passive.iter().for_each(|&i| q[i] = 50.0 + q[0]);
    };
    let raw = simulated.file(&postures, &write, 3);
    let reading = explain(&simulated.chain, &raw, simulated.robot.reach()).unwrap();
    assert!(reading.is_plain() && reading.rms < 10.0 * NOISE, "{reading:?}");
    assert!(
        !passive.is_empty()
            && passive.iter().all(|&i| reading.applied(&simulated.chain, &raw[0]).joints[i] == 0.0)
    );
}
