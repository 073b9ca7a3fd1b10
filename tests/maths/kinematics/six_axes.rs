//! Tests the closed-form inverse kinematics of six-axis arms against an independent D-H product, brute force
//! and numbers of solutions from another program.

use crate::common::root;
use crate::kinematics::product::{no_errors, position, rotation, tcp};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::array::from_fn;
use std::f64::consts::PI;
use sweetspot::cell::JointKind::{self, Prismatic, Revolute};
use sweetspot::cell::{Joint, JointVector, Robot};
use sweetspot::pose::Pose;
use sweetspot::reach::{
    AttitudeGoal, GeneralSixAxes, Numeric, OffsetWrist, RefinedSolver, SphericalWrist, TcpGoal, ThreeParallel,
};
use sweetspot::robot::{Chain, Posture};

/// Row of an arm: kind, and theta (degrees), r, l (mm), alpha (degrees).
pub type Row = (JointKind, [f64; 4]);

pub const R: JointKind = Revolute;
pub const P: JointKind = Prismatic;

pub fn robot(rows: &[Row]) -> Robot {
    let joint = |(k, &(kind, [theta, r, l, alpha])): (usize, &Row)| {
        let limits = if kind == Revolute { (-PI, PI) } else { (-0.5, 0.8) };
        let (theta, alpha) = (theta.to_radians(), alpha.to_radians());
        Joint {
            name: format!("q{k}"),
            kind,
            theta,
            r: r / 1e3,
            l: l / 1e3,
            alpha,
            limits,
            rates: Default::default(),
        }
    };
    let n = rows.len();
    let joints = rows.iter().enumerate().map(joint).collect();
    let serial = (0..n).map(|i| (0..n).map(|j| f64::from(i == j)).collect()).collect();
    crate::kinematics::errors::robot(joints, serial, Pose::identity())
}

pub fn turning(rows: [[f64; 4]; 6]) -> Robot {
    robot(&rows.map(|row| (R, row)))
}

pub fn from_cell(name: &str) -> Robot {
    crate::common::load_from(&root().join("tests/data"), name).unwrap_or_else(|f| panic!("{f:#?}")).cell.robot
}

pub enum Arm {
    Wrist(Box<SphericalWrist>),
    Parallel(Box<ThreeParallel>),
    Offset(Box<OffsetWrist>),
    Refined(Box<RefinedSolver>),
    General(Box<GeneralSixAxes>),
}

/// Answer of the solver for one pose.
pub struct InverseAnswer {
    pub missing: f64,
    pub found: Vec<(u8, Posture)>,
}

pub struct InverseBench {
    pub robot: Robot,
    pub chain: Chain,
    pub arm: Arm,
}

impl InverseBench {
    pub fn wrist(robot: Robot) -> Self {
        let chain = Chain::new(&robot);
        let arm = Arm::Wrist(Box::new(SphericalWrist::new(&chain).unwrap()));
        Self { robot, chain, arm }
    }

    pub fn parallel(robot: Robot) -> Self {
        let chain = Chain::new(&robot);
        let arm = Arm::Parallel(Box::new(ThreeParallel::new(&chain).unwrap()));
        Self { robot, chain, arm }
    }

    pub fn offset(robot: Robot) -> Self {
        let chain = Chain::new(&robot);
        let arm = Arm::Offset(Box::new(OffsetWrist::new(&chain).unwrap()));
        Self { robot, chain, arm }
    }

    /// Returns the bench of a chain that nearly has a closed form.
    pub fn refined(robot: Robot) -> Self {
        let chain = Chain::new(&robot);
        let arm = Arm::Refined(Box::new(RefinedSolver::new(&chain).unwrap()));
        Self { robot, chain, arm }
    }

    /// Returns the bench of any chain of six revolute axes.
    pub fn general(robot: Robot) -> Self {
        let chain = Chain::new(&robot);
        let arm = Arm::General(Box::new(GeneralSixAxes::new(&chain).unwrap()));
        Self { robot, chain, arm }
    }

    pub fn solve(&self, flange: &Pose) -> InverseAnswer {
        let mut scratch = self.chain.posture(&JointVector::default());
        let mut found = Vec::new();
        let mut push = |branch: u8, posture: &Posture| found.push((branch, *posture));
        let missing = match &self.arm {
            Arm::Wrist(arm) => arm.solve(flange, &mut scratch, &mut push),
            Arm::Parallel(arm) => arm.solve(flange, &mut scratch, &mut push),
            Arm::Offset(arm) => arm.solve(flange, &mut scratch, &mut push),
            Arm::Refined(arm) => arm.solve(flange, &mut scratch, &mut push),
            Arm::General(arm) => arm.solve(flange, &mut scratch, &mut push),
        };
        InverseAnswer { missing, found }
    }

    pub fn pose(&self, q: &[f64]) -> Pose {
        let t = tcp(&self.robot, q, &no_errors(6), 0.0);
        Pose { rotation: rotation(&t), translation: position(&t) }
    }

    pub fn random(&self, rng: &mut ChaCha8Rng) -> JointVector {
        crate::kinematics::product::random_joints(&self.robot, rng)
    }

    /// Solves the pose of `q`, which must have a solution. Checks that every solution attains the pose, and
    /// returns the solutions.
    pub fn check(&self, q: &JointVector) -> InverseAnswer {
        let answer = self.verified(q);
        assert!(!answer.found.is_empty() && answer.missing == 0.0, "{q:?}: {} missing", answer.missing);
        answer
    }

    /// Solves the pose of `q`, checks that every solution attains the pose, and returns the solutions, if
    /// any.
    pub fn verified(&self, q: &JointVector) -> InverseAnswer {
        let flange = self.pose(q);
        let answer = self.solve(&flange);
        for (branch, posture) in &answer.found {
            let held = self.chain.forward(posture);
            let position = (held.translation - flange.translation).norm();
            // The Frobenius norm of the difference is sqrt(2) times the small angle.
            let turn = (held.rotation - flange.rotation).norm() / 2f64.sqrt();
            assert!(position < 1e-9 && turn < 1e-9, "{q:?} branch {branch}: {position:e} m, {turn:e} rad");
        }
        answer
    }

    /// Returns the largest difference of a cosine, sine or slide between `q` and the nearest solution.
    pub fn nearest(&self, q: &JointVector, answer: &InverseAnswer) -> f64 {
        let original = self.chain.posture(q);
        let apart = |p: &Posture| {
            let each = |k: usize| {
                let d = [p.cos[k] - original.cos[k], p.sin[k] - original.sin[k], p.r[k] - original.r[k]];
                d.iter().fold(0.0f64, |m, x| m.max(x.abs()))
            };
            (0..6).map(each).fold(0.0, f64::max)
        };
        answer.found.iter().map(|(_, p)| apart(p)).fold(f64::INFINITY, f64::min)
    }

    /// Solves a random pose, also with the numeric solver. Returns the number of numeric solutions, how many
    /// of them are among the answers, and the number of answers.
    pub fn beside_numeric(&self, rng: &mut ChaCha8Rng) -> [usize; 3] {
        let flange = self.pose(&self.random(rng));
        let attitude = AttitudeGoal::Rotation(flange.rotation);
        let mut expected = Vec::new();
        Numeric::new(&self.chain).all(&TcpGoal { position: flange.translation, attitude }, &mut expected);
        let answer = self.solve(&flange);
        let found = expected.iter().filter(|e| self.nearest(&e.joints, &answer) < 1e-5).count();
        [expected.len(), found, answer.found.len()]
    }

    /// Checks random poses: all poses are solved, all solutions are right, and the original posture is among
    /// them. At a distance d from a singularity, the accuracy of an angle is 1e-15 / d. Nearly all angles are
    /// within 1e-7, and the rest within 1e-4.
    fn check_random(&self, count: usize, seed: u64) {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut far = 0;
        for _ in 0..count {
            let q = self.random(&mut rng);
            let answer = self.check(&q);
            let apart = self.nearest(&q, &answer);
            assert!(apart < 1e-4, "{q:?}: the nearest answer is {apart:e} away");
            far += usize::from(apart > 1e-7);
            let branches: std::collections::BTreeSet<u8> = answer.found.iter().map(|f| f.0).collect();
            assert_eq!(branches.len(), answer.found.len(), "{q:?}: a number given twice");
        }
        assert!(far * 10_000 <= count, "{far} of {count} further than 1e-7");
    }
}

pub fn puma560() -> InverseBench {
    InverseBench::wrist(from_cell("puma560.toml"))
}

pub fn ur5() -> InverseBench {
    InverseBench::parallel(from_cell("ur5.toml"))
}

/// Returns the ABB IRB 140 with an additional shoulder offset.
pub fn irb140() -> InverseBench {
    InverseBench::wrist(turning([
        [0.0, 352.0, 70.0, -90.0],
        [-90.0, 30.0, 360.0, 0.0],
        [0.0, -12.0, 15.0, -90.0],
        [0.0, 380.0, 0.0, 90.0],
        [0.0, 0.0, 0.0, -90.0],
        [180.0, 65.0, 0.0, 0.0],
    ]))
}

/// Returns the Stanford arm: two revolute joints, a slide, a wrist.
pub fn stanford() -> InverseBench {
    InverseBench::wrist(robot(&[
        (R, [0.0, 412.0, 0.0, -90.0]),
        (R, [0.0, 154.0, 0.0, 90.0]),
        (P, [-90.0, 300.0, 0.0, 0.0]),
        (R, [0.0, 0.0, 0.0, -90.0]),
        (R, [0.0, 0.0, 0.0, 90.0]),
        (R, [0.0, 263.0, 0.0, 0.0]),
    ]))
}

/// Returns the Franka Panda without joint 7. This arm has a spherical shoulder.
pub fn panda() -> InverseBench {
    InverseBench::wrist(turning([
        [0.0, 333.0, 0.0, -90.0],
        [0.0, 0.0, 0.0, 90.0],
        [0.0, 316.0, 82.5, 90.0],
        [0.0, 0.0, -82.5, -90.0],
        [0.0, 384.0, 0.0, 90.0],
        [0.0, 0.0, 88.0, 90.0],
    ]))
}

/// Returns an arm of Universal Robots' kinematic family with every offset that the family allows, and with
/// axes 3 and 4 reversed.
pub fn offsets() -> InverseBench {
    InverseBench::parallel(turning([
        [10.0, 120.0, 35.0, 70.0],
        [-20.0, 40.0, -425.0, 180.0],
        [30.0, -25.0, 392.0, 180.0],
        [5.0, 110.0, 22.0, 80.0],
        [0.0, 95.0, 0.0, -75.0],
        [40.0, 82.0, 17.0, 33.0],
    ]))
}

#[test]
fn the_inverse_recovers_postures_of_named_arms() {
    for (k, bench) in [puma560(), irb140(), ur5()].iter().enumerate() {
        bench.check_random(100_000, k as u64);
    }
    for (k, bench) in [offsets(), stanford(), panda()].iter().enumerate() {
        bench.check_random(100_000, 10 + k as u64);
    }
}

fn random_row(rng: &mut ChaCha8Rng, kind: JointKind) -> Row {
    let length = |rng: &mut ChaCha8Rng| rng.random_range(-500.0..500.0);
    (kind, [rng.random_range(-180.0..180.0), length(rng), length(rng), rng.random_range(-170.0..170.0)])
}

/// Returns a chain with a spherical wrist of random twists and a shoulder of random lengths and twists.
pub fn random_chain(rng: &mut ChaCha8Rng, kinds: [JointKind; 3]) -> Vec<Row> {
    let mut rows: Vec<Row> = kinds.iter().chain(&[R; 3]).map(|&kind| random_row(rng, kind)).collect();
    rows[3].1[2] = 0.0;
    rows[4].1[2] = 0.0;
    rows[4].1[1] = 0.0;
    rows
}

/// Returns the chain from flange to base as another robot.
pub fn end_for_end(rows: &[Row]) -> Vec<Row> {
    let twist = |k: usize| 5usize.checked_sub(k + 1).map_or([70.0, 25.0], |i| [-rows[i].1[2], -rows[i].1[3]]);
    let row = |k: usize| {
        let ((kind, [theta, r, ..]), [l, alpha]) = (rows[5 - k], twist(k));
        (kind, [-theta, -r, l, alpha])
    };
    (0..6).map(row).collect()
}

#[test]
fn the_inverse_recovers_postures_of_general_chains() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let kinds = |k: usize| from_fn(|j| if k >> j & 1 == 1 { P } else { R });
    for k in 0..8 {
        for _ in 0..10 {
            let rows = random_chain(&mut rng, kinds(k));
            InverseBench::wrist(robot(&rows)).check_random(1_000, rng.random());
            InverseBench::wrist(robot(&end_for_end(&rows))).check_random(500, rng.random());
        }
    }
}

/// Rows with right angles and zeros in every place cover the special cases of the first three joints.
#[test]
fn the_inverse_recovers_postures_of_special_chains() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    let mut solved = [0; 8];
    for k in 0..1_600 {
        let mut rows = random_chain(&mut rng, from_fn(|j| if k >> j & 1 == 1 { P } else { R }));
        for (_, row) in &mut rows[..3] {
            row[3] = [0.0, 90.0, -90.0, 180.0, row[3]][rng.random_range(0..5)];
            for column in [0, 1, 2] {
                row[column] *= f64::from(rng.random_range(0..2));
            }
        }
        let robot = robot(&rows);
        if SphericalWrist::new(&Chain::new(&robot)).is_ok() {
            // A separate seed makes the poses independent of the random chains.
            InverseBench::wrist(robot).check_random(100, k as u64);
            solved[k % 8] += 1;
        }
    }
    assert!(solved.iter().all(|n| *n > 30), "{solved:?}");
}
