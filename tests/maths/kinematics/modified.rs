//! Tests errors of standard and modified (Craig) rows of a cell file against an independent product of such
//! rows. Covers the order of `rotation_deg`, the place of dbeta, and the frame of `joints`.

use crate::common::{from_text, signed};
use crate::kinematics::errors::predicted;
use crate::kinematics::product::{position, random_joints, rotation};
use nalgebra::{Matrix4, Rotation3, Translation3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;
use sweetspot::cell::{Model, Robot};

const DEG: f64 = PI / 180.0;

fn slide(x: f64, y: f64, z: f64) -> Matrix4<f64> {
    Translation3::new(x, y, z).to_homogeneous()
}

fn turn(axis: Vector3<f64>, angle: f64) -> Matrix4<f64> {
    Rotation3::new(axis * angle).to_homogeneous()
}

/// Returns `Trans(x, y, z) Rz Ry Rx` from mm and degrees.
fn frame(e: &[f64]) -> Matrix4<f64> {
    let [z, y, x] =
        [(Vector3::z(), 5), (Vector3::y(), 4), (Vector3::x(), 3)].map(|(a, k)| turn(a, e[k] * DEG));
    slide(e[0] / 1e3, e[1] / 1e3, e[2] / 1e3) * z * y * x
}

/// Chain and its errors as a file states them, in mm and degrees. Each row has r, l, alpha, theta, and dq,
/// dr, dl, dalpha, dbeta. Base, tool and joint frames follow.
struct Chain {
    modified: bool,
    rows: Vec<[f64; 4]>,
    slides: Vec<bool>,
    errors: Vec<[f64; 5]>,
    frames: [[f64; 6]; 2],
    joints: Vec<[f64; 6]>,
}

impl Chain {
    fn random(rng: &mut ChaCha8Rng, n: usize, modified: bool) -> Self {
        let mut some = |bound: f64| rng.random_range(-bound..bound);
        let rows = (0..n).map(|_| [some(500.0), some(500.0), some(180.0), some(180.0)]).collect();
        let slides = (0..n).map(|_| some(1.0) > 0.5).collect();
        let errors = (0..n).map(|_| [(); 5].map(|()| some(1.0))).collect();
        let mut frame = || [(); 6].map(|()| some(2.0));
        let (mut base, tool) = (frame(), frame());
        let mut joints: Vec<_> = (0..n).map(|_| frame()).collect();
        // Modified row 1 contains the first of these errors, and its joint frame contains the other.
        if modified {
            (base[3], joints[0]) = (0.0, [0.0; 6]);
        }
        Self { modified, rows, slides, errors, frames: [base, tool], joints }
    }

    /// Returns the shipped cell with this robot. The operations of the cell do not matter.
    fn robot_text(&self) -> String {
        let row = |(k, ([r, l, alpha, theta], slides)): (usize, (&[f64; 4], &bool))| {
            let kind = match slides {
                true => format!("kind = \"prismatic\"\ntheta_deg = {theta}\nlimits_mm = [-300, 300]"),
                false => format!("q_offset_deg = {theta}\nlimits_deg = [-180, 180]"),
            };
            format!("[[robot.joint]]\nname = \"q{k}\"\nr_mm = {r}\nl_mm = {l}\nalpha_deg = {alpha}\n{kind}\n")
        };
        let rows: String = self.rows.iter().zip(&self.slides).enumerate().map(row).collect();
        let list = |k: usize| self.errors.iter().map(|e| e[k]).collect::<Vec<_>>();
        let dq = |slides: bool| {
            let own = self.errors.iter().zip(&self.slides);
            own.map(|(e, s)| if *s == slides { e[0] } else { 0.0 }).collect::<Vec<_>>()
        };
        let keys = |e: &[f64]| format!("position_mm = {:?}, rotation_deg = {:?}", &e[..3], &e[3..]);
        let joints = self.joints.iter().enumerate();
        let joints: String = joints.map(|(k, e)| format!("{{ joint = {}, {} }}, ", k + 1, keys(e))).collect();
        format!(
            "{rows}[robot.errors.ours]\nkind = \"signed\"\nsource = \"made up\"\ndq_deg = {:?}\ndq_mm = {:?}\n\
             dr_mm = {:?}\ndl_mm = {:?}\ndalpha_deg = {:?}\ndbeta_deg = {:?}\nbase = {{ {} }}\n\
             tool = {{ {} }}\njoints = [{joints}]\n",
            dq(false),
            dq(true),
            list(1),
            list(2),
            list(3),
            list(4),
            keys(&self.frames[0]),
            keys(&self.frames[1])
        )
    }

    /// Returns `Tx(l + dl) Rx(alpha + dalpha) Ry(dbeta) J Rz(theta) Tz(r)` of every modified row, and `J
    /// Rz(theta) Tz(r) Tx(l + dl) Rx(alpha + dalpha) Ry(dbeta)` of every standard row, with `unit` times the
    /// errors.
    fn tcp(&self, robot: &Robot, q: &[f64], unit: f64) -> Matrix4<f64> {
        let scaled = |e: &[f64; 6]| frame(&e.map(|v| v * unit));
        let mut t = scaled(&self.frames[0]);
        for (i, ([r, l, alpha, theta], e)) in self.rows.iter().zip(&self.errors).enumerate() {
            let [dq, dr, dl, dalpha, dbeta] = e.map(|v| v * unit);
            let (turned, slid) = if self.slides[i] { (0.0, q[i] + dq / 1e3) } else { (q[i] + dq * DEG, 0.0) };
            let link = slide((l + dl) / 1e3, 0.0, 0.0)
                * turn(Vector3::x(), (alpha + dalpha) * DEG)
                * turn(Vector3::y(), dbeta * DEG);
            let joint = scaled(&self.joints[i])
                * turn(Vector3::z(), theta * DEG + turned)
                * slide(0.0, 0.0, (r + dr) / 1e3 + slid);
            t *= if self.modified { link * joint } else { joint * link };
        }
        let mut tool = robot.tool.rotation.to_homogeneous();
        tool.fixed_view_mut::<3, 1>(0, 3).copy_from(&robot.tool.translation);
        t * tool * scaled(&self.frames[1])
    }
}

#[test]
fn errors_of_dh_rows_of_both_conventions_agree_with_the_matrix_product() {
    let mut rng = ChaCha8Rng::seed_from_u64(71);
    for k in 0..200 {
        let chain = Chain::random(&mut rng, 1 + k % 8, k % 16 < 8);
        let convention = if chain.modified { "modified" } else { "standard" };
        let text = format!(
            "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"ours\"\n\
             collision = false\n\
             [robot]\nname = \"r\"\nsource = \"made up\"\nconvention = \"{convention}\"\n\
             tool = {{ position_mm = [30, -50, 120], rpy_deg = [40, 100, -70], axis = [1, 0, 0] }}\n\
             footprint = {{ size_mm = [100, 100] }}\n{}\n\
             [equipment.worktable]\nfrom = \"equipment/worktable.toml\"\n\
             placement = {{ x_mm = 0, y_mm = 1250, z_mm = 1350 }}\n\
             [operation.o]\non = \"worktable\"\ngrid = [2, 2]\nbend_deg = 0\nsense = \"xyz\"\n",
            chain.robot_text()
        );
        let cell = from_text(&text).unwrap_or_else(|f| panic!("{f:#?}")).cell;
        let q = random_joints(&cell.robot, &mut rng);
        let error = predicted(&cell.robot, &q, signed(&cell), Model::Nonlinear);
        let [nominal, wrong] = [0.0, 1.0].map(|unit| chain.tcp(&cell.robot, &q, unit));
        let off = error.position - (position(&wrong) - position(&nominal));
        let turned = Rotation3::new(error.rotation).into_inner() * rotation(&nominal) - rotation(&wrong);
        assert!(off.norm() < 1e-12 && turned.norm() < 1e-12, "{k}: off by {off} and {turned}");
    }
}
