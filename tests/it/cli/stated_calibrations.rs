//! Tests calibrations that other programs state: YAML and configuration of Universal Robots, pairs of URDF
//! files.
//!
//! The reference is the product of the matrices of the stated frames. The tested errors come from the printed
//! table.

use crate::cli::sandbox::{Sandbox, items, number, text};
use crate::common::ur::CalibratedArm;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use std::fmt::Write;
use sweetspot::cell::{ErrorSet, Model, Robot};
use sweetspot::files::load_robot;
use sweetspot::kinematic_error::{Perturbation, pose_error};
use sweetspot::robot::Chain;

/// Joint frames of a UR10 in the form in which its driver writes them: x, y, z (m), roll, pitch, yaw (rad).
const NOMINAL: [[f64; 6]; 6] = [
    [0.0, 0.0, 0.1273, 0.0, 0.0, 0.0],
    [0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0],
    [-0.612, 0.0, 0.0, 0.0, 0.0, 0.0],
    [-0.5723, 0.0, 0.163941, 0.0, 0.0, 0.0],
    [0.0, -0.1157, 0.0, std::f64::consts::FRAC_PI_2, 0.0, 0.0],
    [0.0, 0.0922, 0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI, std::f64::consts::PI],
];

const JOINTS: [&str; 6] = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];

/// Returns frames that differ from the nominal frames by up to 2 mm and 2 mrad, joint by joint.
fn calibrated() -> [[f64; 6]; 6] {
    let mut frames = NOMINAL;
    for (k, value) in frames.iter_mut().flatten().enumerate() {
        *value += 2e-3 * (1.7 * k as f64 + 0.3).sin();
    }
    frames
}

fn isometry([x, y, z, roll, pitch, yaw]: [f64; 6]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
}

/// Returns the pose of the flange: the product of every frame and the rotation about its z axis.
fn flange(frames: &[[f64; 6]; 6], q: &[f64]) -> Isometry3<f64> {
    let joints = frames.iter().zip(q);
    joints.fold(Isometry3::identity(), |t, (frame, q)| {
        t * isometry(*frame) * Isometry3::rotation(Vector3::z() * *q)
    })
}

fn yaml(frames: &[[f64; 6]; 6]) -> String {
    let mut text = String::from("kinematics:\n");
    for (joint, frame) in JOINTS.iter().zip(frames) {
        writeln!(text, "  {joint}:").unwrap();
        for (key, value) in ["x", "y", "z", "roll", "pitch", "yaw"].iter().zip(frame) {
            writeln!(text, "    {key}: {value}").unwrap();
        }
    }
    text + "  hash: calib_7316905243862112345\n"
}

fn postures(count: usize) -> impl Iterator<Item = [f64; 8]> {
    (0..count)
        .map(|k| std::array::from_fn(|i| if i < 6 { 3.0 * ((k * 7 + i * 3 + 1) as f64).sin() } else { 0.0 }))
}

/// Reads a robot file with the printed table and returns the robot and its errors.
fn read_robot(shop: &Sandbox, name: &str) -> (Robot, Perturbation) {
    let loaded = load_robot(name, &mut |path| std::fs::read(shop.path(path)).map_err(|e| e.to_string()));
    let robot = loaded.unwrap_or_else(|faults| panic!("{faults:#?}")).robot;
    let measured = robot.errors.iter().find(|set| set.name() == "measured").unwrap();
    let ErrorSet::Signed(errors) = measured else { panic!("a tolerance") };
    let perturbation = Perturbation::new(&Chain::new(&robot), errors);
    (robot, perturbation)
}

/// Checks that the positions of the flange of the robot with errors equal the positions that `exact` returns.
fn assert_same(robot: Robot, errors: &Perturbation, exact: impl Fn(&[f64; 8]) -> Vector3<f64>) {
    let chain = Chain::new(&robot);
    for q in postures(200) {
        let frames = chain.frames(&chain.posture(&q));
        let moved = frames.tcp.translation + pose_error(&frames, errors, Model::Nonlinear).position;
        let off = (moved - exact(&q)).norm();
        assert!(off < 1e-9, "{off:e} m at {q:?}");
    }
}

/// Returns the built-in UR10, whose TCP is the flange.
fn ur10(shop: &Sandbox) -> String {
    shop.done(&["robot", "ur10", "--toml"]).out
}

#[test]
fn the_yaml_of_the_driver_gives_errors_of_the_joint_frames() {
    let shop = Sandbox::new();
    shop.write("my_calibration.yaml", &yaml(&calibrated()));
    let table = shop.done(&["calibrate", "ur10", "my_calibration.yaml", "--toml"]);
    assert!(table.out.contains("hash calib_7316905243862112345"), "{}", table.out);
    assert!(table.err.contains("joint 1 includes the error of the base"), "{}", table.err);
    shop.write("measured.toml", &(ur10(&shop) + "\n" + &table.out));
    let (robot, errors) = read_robot(&shop, "measured.toml");
    assert_same(robot, &errors, |q| flange(&calibrated(), q).translation.vector);
    // Nominal frames give errors of 0.
    shop.write("nominal.yaml", &yaml(&NOMINAL));
    let document = shop.json(&["calibrate", "ur10", "nominal.yaml"]);
    assert!(items(&document["parameters"]).iter().all(|p| number(&p["value"]).abs() < 1e-9), "{document}");
    let document = shop.json(&["calibrate", "ur10", "my_calibration.yaml"]);
    assert_eq!(items(&document["parameters"]).len(), 36);
    let first = &items(&document["parameters"])[0];
    assert!(text(&first["name"]) == "joint1 x" && first["sigma"].is_null(), "{first}");
    assert!(text(&items(&document["unidentified"])[0]).contains("covariance"), "{document}");
    let validator = jsonschema::draft7::new(&sweetspot::record::DocumentKind::Calibration.schema()).unwrap();
    assert!(validator.is_valid(&document));
    let words = shop.done(&["calibrate", "ur10", "my_calibration.yaml"]);
    assert!(
        words.out.contains("joint6 rz") && words.err.contains("next: sweetspot calibrate"),
        "{}",
        words.out
    );
}

#[test]
fn the_configuration_of_a_controller_gives_errors_of_the_rows() {
    let shop = Sandbox::new();
    let arm = CalibratedArm::new("ur10");
    let list = |values: &[f64]| values.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join(", ");
    let errors = &arm.factory;
    shop.write(
        "calibration.conf",
        &format!(
            "[mounting]\ndelta_theta = [ {}]\ndelta_a = [ {}]\ndelta_d = [ {}]\ndelta_alpha = [ {}]\njoint_checksum = \
             [ 0x1, 0x2, 0x3, 0x4, 0x5, 0x6]\n",
            list(&errors.dq),
            list(&errors.dl),
            list(&errors.dr),
            list(&errors.dalpha)
        ),
    );
    let table = shop.done(&["calibrate", "ur10", "calibration.conf", "--toml"]).out;
    shop.write("measured.toml", &(ur10(&shop) + "\n" + &table));
    let (robot, read) = read_robot(&shop, "measured.toml");
    let exact = Chain::new(&arm.robot);
    let perturbed = Perturbation::new(&exact, errors);
    // The rows of the controller state 1.570796327 for a right angle.
    let chain = Chain::new(&robot);
    for q in postures(100) {
        let at = |chain: &Chain, errors: &Perturbation| {
            let frames = chain.frames(&chain.posture(&q));
            pose_error(&frames, errors, Model::Nonlinear).position
        };
        let off = (at(&chain, &read) - at(&exact, &perturbed)).norm();
        assert!(off < 1e-8, "{off:e} m");
    }
}

/// Returns a URDF of the UR10 with an axis along x in the joint frames, and a tip link beyond the last joint.
fn urdf(frames: &[[f64; 6]; 6], tip: [f64; 6]) -> String {
    let mut text = String::from("<robot name=\"arm\">\n<link name=\"base\"/>\n");
    let origin = |[x, y, z, r, p, w]: [f64; 6]| format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{r} {p} {w}\"/>");
    let mut parent = "base".to_string();
    for (name, frame) in JOINTS.iter().zip(frames) {
        write!(
            text,
            "<link name=\"{name}\"><collision><geometry><mesh filename=\"package://arm/{name}.stl\"/></geometry>\
             </collision></link>\n<joint name=\"{name}_joint\" type=\"revolute\"><parent link=\"{parent}\"/><child \
             link=\"{name}\"/>{}<axis xyz=\"0 0 1\"/><limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/>\
             </joint>\n",
            origin(*frame)
        )
        .unwrap();
        parent = (*name).to_string();
    }
    let end = "<link name=\"tool0\"/><joint name=\"end\" type=\"fixed\"><parent link=\"wrist_3\"/><child link=\"tool0\"/>";
    text + end + &origin(tip) + "</joint></robot>\n"
}

#[test]
fn two_urdf_files_of_one_arm_give_errors_of_joint_frames_and_tool() {
    let shop = Sandbox::new();
    let (tip, moved) = ([0.01, 0.02, 0.1, 0.1, 0.2, 0.3], [0.011, 0.019, 0.1005, 0.101, 0.199, 0.3]);
    shop.write("nominal.urdf", &urdf(&NOMINAL, tip));
    shop.write("calibrated.urdf", &urdf(&calibrated(), moved));
    // Collision shapes of any size and meshes of any format do not matter.
    let shaped = urdf(&NOMINAL, tip).replacen(
        "<link name=\"base\"/>",
        "<link name=\"base\"><collision><geometry><box size=\"0.6 0.5 0.2\"/></geometry></collision>\n<collision name=\"x\">\
         <geometry><mesh filename=\"../meshes/base.glb\"/></geometry></collision></link>",
        1,
    );
    shop.write("shaped.urdf", &shaped);
    let of_shaped = shop.done(&["calibrate", "shaped.urdf", "calibrated.urdf", "--toml"]);
    let table = shop.done(&["calibrate", "nominal.urdf", "calibrated.urdf", "--toml"]);
    assert_eq!(of_shaped.out, table.out);
    assert!(table.out.contains("tool = {") && table.out.contains("joint = 6"), "{}", table.out);
    let bare = urdf(&NOMINAL, tip).replace("package://arm/", "");
    let bare: String = bare
        .lines()
        .map(|line| match line.split_once("<collision>") {
            Some((start, rest)) => format!("{start}{}\n", rest.split_once("</collision>").unwrap().1),
            None => format!("{line}\n"),
        })
        .collect();
    shop.write("bare.urdf", &bare);
    shop.write(
        "measured.toml",
        &("schema = \"sweetspot/robot/1\"\nunits = { length = \"mm\", angle = \"deg\" }\nurdf = \"bare.urdf\"\ntool = { \
         position_mm = [0, 0, 0], axis = [1, 0, 0] }\nfootprint = { size_mm = [200, 200] }\n\n"
            .to_string()
            + &table.out),
    );
    let (robot, errors) = read_robot(&shop, "measured.toml");
    assert_same(robot, &errors, |q| (flange(&calibrated(), q) * isometry(moved)).translation.vector);
    // A robot file with a URDF and a separate tool gives the same errors of the joints.
    let own = shop.json(&["calibrate", "measured.toml", "calibrated.urdf"]);
    let plain = shop.json(&["calibrate", "nominal.urdf", "calibrated.urdf"]);
    assert_eq!(own["parameters"], plain["parameters"]);
}

#[test]
fn wrong_calibrations_are_refused_with_their_place() {
    let shop = Sandbox::new();
    let refused = |args: &[&str], name: &str, content: &str, said: &[&str]| {
        shop.write(name, content);
        let ran = shop.run(&[&["calibrate"], args].concat());
        ran.no_panic();
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{name}: {}", ran.err);
        for words in said {
            assert!(ran.err.contains(words), "{name}: no {words:?} in {}", ran.err);
        }
    };
    let good = yaml(&calibrated());
    let bad = good.replace("wrist_1", "wirst_1").replacen("x: 0", "x: far", 1);
    refused(&["ur10", "a.yaml"], "a.yaml", &bad, &["a.yaml:3:1", "`far", "did you mean `wrist_1`?"]);
    refused(
        &["ur10", "b.yaml"],
        "b.yaml",
        &good.replace("    roll: ", "    rol: "),
        &["`roll` of shoulder is missing"],
    );
    refused(
        &["ur5e", "c.yaml"],
        "c.yaml",
        &good,
        &["frame of joint 1 is", "give the robot to which the calibration belongs"],
    );
    refused(&["hitachi_pw10", "d.yaml"], "d.yaml", &good, &["six-axis arm"]);
    refused(&["ur10", "e.yaml"], "e.yaml", &"a:\n".repeat(100_000), &["more than 1000 lines"]);
    let deep: String = (0..900).map(|k| format!("{}a:\n", " ".repeat(k))).collect();
    refused(&["ur10", "f.yaml"], "f.yaml", &deep, &["unknown key `a`"]);
    refused(
        &["ur10", "g.yaml"],
        "g.yaml",
        &good.replacen("x: 0", "x: .nan", 1),
        &["not a number in m or rad"],
    );
    refused(&["ur10", "h.yaml", "a.yaml"], "h.yaml", &good, &["give no other file with it"]);
    refused(
        &["ur10", "a.conf"],
        "a.conf",
        "delta_theta = [1, 2, x]\n",
        &["`x` is not", "has 3 numbers", "`delta_a` is missing"],
    );
    let nominal = urdf(&NOMINAL, [0.0; 6]);
    shop.write("nominal.urdf", &nominal);
    refused(&["ur10", "a.urdf"], "a.urdf", &nominal, &["was not read from a URDF"]);
    let other = nominal.replace("forearm_joint", "elbow_joint");
    refused(&["nominal.urdf", "b.urdf"], "b.urdf", &other, &["the joints of its chain differ"]);
    let other = nominal.replacen("0 0 1\"/><limit", "0 1 0\"/><limit", 1);
    refused(&["nominal.urdf", "c.urdf"], "c.urdf", &other, &["axis of joint shoulder_joint"]);
    refused(&["nominal.urdf", "d.urdf"], "d.urdf", "<robot", &["d.urdf"]);
}
