//! Two arms of Universal Robots, nominal and as built, from tests/data/ur_calibration.toml.

use nalgebra::Vector3;
use std::f64::consts::PI;
use sweetspot::cell::{Convention, Joint, JointKind, MAX_JOINTS, Rectangle, Robot, SignedErrors};
use sweetspot::pose::Pose;
use toml::de::{DeTable, DeValue};

/// Arm of Universal Robots as the calibration file describes it.
pub struct CalibratedArm {
    pub robot: Robot,
    /// Errors of the arm as built.
    pub factory: SignedErrors,
    /// Joint coordinates, each with the position of the flange at these coordinates, m.
    pub golden: Vec<(Vec<f64>, Vector3<f64>)>,
    figures: Vec<(String, f64)>,
}

impl CalibratedArm {
    /// Reads `ur10` or `ur10e`. The TCP is at the flange, and every joint has the range [-pi, pi].
    pub fn new(name: &str) -> Self {
        let path = super::root().join("tests/data/ur_calibration.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let file = DeTable::parse(&text).unwrap();
        let arm = file.get_ref().get(name).unwrap().get_ref();
        let rows = |of: &str, key: &str| numbers(arm[of].get_ref(), key);
        let golden = arm.get("golden").and_then(|g| g.get_ref().as_array()).into_iter().flatten();
        let golden = golden.map(|g| ["q", "p"].map(|key| numbers(g.get_ref(), key)));
        let figures = arm["figures"].get_ref().as_table().unwrap().iter();
        Self {
            robot: robot(name, |key| rows("nominal", key)),
            factory: errors(|key| rows("difference", key)),
            golden: golden.map(|[q, p]| (q, Vector3::from_vec(p))).collect(),
            figures: figures.map(|(key, v)| (key.get_ref().to_string(), number(v.get_ref()))).collect(),
        }
    }

    pub fn figure(&self, key: &str) -> f64 {
        self.figures.iter().find(|f| f.0 == key).unwrap().1
    }
}

fn number(value: &DeValue<'_>) -> f64 {
    value.as_float().unwrap().as_str().parse().unwrap()
}

fn numbers(table: &DeValue<'_>, key: &str) -> Vec<f64> {
    table[key].get_ref().as_array().unwrap().iter().map(|x| number(x.get_ref())).collect()
}

fn robot(name: &str, rows: impl Fn(&str) -> Vec<f64>) -> Robot {
    let [r, l, theta, alpha] = ["d", "a", "theta", "alpha"].map(rows);
    let joint = |i: usize| {
        let (theta, r, l, alpha) = (theta[i], r[i], l[i], alpha[i]);
        Joint {
            name: format!("q{i}"),
            kind: JointKind::Revolute,
            theta,
            r,
            l,
            alpha,
            limits: (-PI, PI),
            rates: Default::default(),
        }
    };
    let row = |i: usize| (0..6).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
    Robot {
        name: name.into(),
        source: "tests/data/ur_calibration.toml".into(),
        convention: Convention::Standard,
        mount: Pose::identity(),
        joints: (0..6).map(joint).collect(),
        joint_frames: vec![Pose::identity(); 6],
        coupling: (0..6).map(row).collect(),
        home: [0.0; MAX_JOINTS],
        tool: Pose::identity(),
        tool_axis: Vector3::z(),
        solids: vec![],
        tool_solids: 0,
        masses: vec![],
        self_collision: Default::default(),
        full_speed_after: None,
        footprint: Rectangle { centre: (0.0, 0.0), size: (0.4, 0.4) },
        errors: vec![],
        urdf: None,
    }
}

fn errors(rows: impl Fn(&str) -> Vec<f64>) -> SignedErrors {
    let [dr, dl, dq, dalpha] = ["d", "a", "theta", "alpha"].map(rows);
    let (base, tool) = ([0.0; 6], [0.0; 6]);
    SignedErrors {
        name: "factory".into(),
        dq,
        dr,
        dl,
        dalpha,
        dbeta: vec![0.0; 6],
        base,
        tool,
        joints: vec![[0.0; 6]; 6],
        elastic: vec![],
        periodic: vec![],
    }
}
