//! Tests the import of a standalone URDF: right angles, the guessed tool, and the reduced copy.

use crate::common::root;
use crate::urdf::product::{apart, joints, load, poses};
use nalgebra::Isometry3;
use std::collections::HashMap;
use sweetspot::files::{UrdfOutline, lean_urdf, urdf_outline};
use sweetspot::robot::Chain;

fn outline(text: &str) -> UrdfOutline {
    urdf_outline("arm.urdf", text, None).unwrap_or_else(|faults| panic!("{faults:#?}")).0
}

/// Returns the number of angles that are read as right angles, for a URDF in which one joint has the given
/// angle.
fn snapped(angle: &str) -> usize {
    let urdf = format!(
        "<robot name=\"a\"><link name=\"a\"/><link name=\"b\"/>\
         <joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/><origin rpy=\"0 {angle} 0\"/>\
         <axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\"/></joint></robot>"
    );
    let (_, warnings) = urdf_outline("a.urdf", &urdf, None).unwrap_or_else(|faults| panic!("{faults:#?}"));
    warnings.iter().filter(|warning| warning.message.contains("right angle")).count()
}

/// An angle is read as a right angle if it is a right angle rounded or truncated to the digits of the file.
#[test]
fn angles_that_plainly_mean_right_angles_are_read_so() {
    for meant in [
        "1.57",
        "1.571",
        "1.5708",
        "1.5707",
        "-1.5708",
        "1.570796",
        "3.14",
        "3.1416",
        "3.1415",
        "-3.14159",
        "4.712",
        "6.2832",
        "15.708e-1",
        "1.57079e0",
    ] {
        assert_eq!(snapped(meant), 1, "{meant}");
    }
    for other in [
        "0",
        "0.0001",
        "1.5",
        "1.6",
        "1.58",
        "1.56",
        "1.5709",
        "1.5706",
        "1.57080001",
        "1.569",
        "3.13",
        "3.142e-1",
        "0.7854",
        "1.5707963267948966",
        "-3.141592653589793",
        "1.570796326795",
    ] {
        assert_eq!(snapped(other), 0, "{other}");
    }
}

#[test]
fn a_right_angle_gives_exact_rows() {
    let text = std::fs::read_to_string(root().join("tests/data/own_arm.urdf")).unwrap();
    let (loaded, _) = load(&lean(&text), 6, "tip_link = \"tool0\"");
    let robot = loaded.unwrap_or_else(|faults| panic!("{faults:#?}")).cell.robot;
    let turns = robot.joints.iter().map(|joint| joint.alpha.abs().to_degrees()).collect::<Vec<_>>();
    assert_eq!(turns, [90.0, 0.0, 90.0, 90.0, 90.0, 0.0]);
}

/// Returns the reduced copy of a URDF, without meshes.
fn lean(text: &str) -> String {
    lean_urdf(text, &outline(text), &HashMap::new(), "Written by a test -- with dashes.").unwrap()
}

/// The reduced copy moves like the original, and gives no warning.
#[test]
fn the_lean_copy_moves_like_the_original() {
    for name in ["puma560", "ur5", "pw10"] {
        let text = std::fs::read_to_string(root().join(format!("tests/data/{name}.urdf"))).unwrap();
        let (own, copy) = (joints(&text), lean(&text));
        let moving = own.iter().filter(|joint| joint.kind != "fixed").count();
        let tip = outline(&text).tip_link;
        let (loaded, _) = load(&copy, moving, &format!("tip_link = \"{tip}\""));
        let loaded = loaded.unwrap_or_else(|faults| panic!("{name}: {faults:#?}"));
        assert_eq!(loaded.warnings, [], "{name}");
        let chain = Chain::new(&loaded.cell.robot);
        for k in 0..20 {
            let q: Vec<f64> = (0..moving).map(|i| ((k * 7 + i * 3) % 11) as f64 / 11.0 - 0.5).collect();
            let mut actuators = [0.0; sweetspot::cell::MAX_JOINTS];
            actuators[..moving].copy_from_slice(&q);
            let all = poses(&own, &q);
            let theirs: &Isometry3<f64> = &all[own.iter().position(|joint| joint.child == tip).unwrap()].1;
            let ours = chain.forward(&chain.posture(&actuators));
            assert!(apart(&ours, theirs) < 1e-9, "{name} {k}");
        }
    }
}

/// Aligned columns of numbers with all digits are longer than any text that the program shows.
#[test]
fn the_lean_copy_keeps_long_numbers() {
    let long = "  0.30000000000000004441   0.00000000000000000000000000000012   -0.40000000000000002220  ";
    let text = chain(&[("revolute", "a", long, "0 0 1"), ("revolute", "b", "0.1 0 0", "0 1 0")]);
    let copy = lean(&text);
    assert!(long.len() > 80 && copy.contains(long.trim()), "{copy}");
}

/// Returns the URDF of a chain of joints, each given by kind, child, origin and axis. The parent of a joint
/// is the child of the previous joint.
fn chain(parts: &[(&str, &str, &str, &str)]) -> String {
    let mut text = "<robot name=\"a\"><link name=\"base\"/>".to_string();
    let mut parent = "base";
    for (kind, child, xyz, axis) in parts {
        text += &format!(
            "<link name=\"{child}\"/><joint name=\"to_{child}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"{xyz}\"/><axis xyz=\"{axis}\"/><limit lower=\"-1\" upper=\"1\"/></joint>"
        );
        parent = child;
    }
    text + "</robot>"
}

#[test]
fn the_tool_points_away_from_the_arm() {
    let scara = [
        ("revolute", "a", "0 0 0.4", "0 0 1"),
        ("revolute", "b", "0.3 0 0", "0 0 1"),
        ("prismatic", "c", "0.3 0 0", "0 0 1"),
        ("revolute", "d", "0 0 -0.1", "0 0 1"),
    ];
    let found = outline(&chain(&scara));
    assert_eq!(
        (found.tip_link.as_str(), found.joints, found.direction.as_slice()),
        ("d", 4, &[0.0, 0.0, -1.0][..])
    );
    // The tool of a planar arm is beside the axis of the last joint.
    let planar = [
        ("revolute", "a", "0 0 0.4", "0 0 1"),
        ("revolute", "b", "0 0 0.1", "0 1 0"),
        ("revolute", "c", "0.5 0 0", "0 1 0"),
        ("fixed", "tool", "0.3 0 0", "1 0 0"),
    ];
    assert_eq!(outline(&chain(&planar)).direction.as_slice(), [1.0, 0.0, 0.0]);
    let backwards = [
        ("revolute", "a", "0 0 0.4", "0 0 1"),
        ("revolute", "b", "0 0.5 0", "0 -1 0"),
        ("fixed", "c", "0 0.1 0", "0 0 1"),
    ];
    assert_eq!(outline(&chain(&backwards)).direction.as_slice(), [0.0, 1.0, 0.0]);
}

#[test]
fn a_gripper_is_no_part_of_the_arm() {
    let arm = chain(&[
        ("revolute", "a", "0 0 0.4", "0 0 1"),
        ("revolute", "b", "0 0 0.1", "0 1 0"),
        ("revolute", "c", "0 0 0.5", "0 1 0"),
        ("revolute", "d", "0 0 0.5", "0 1 0"),
        ("fixed", "palm", "0 0 0.1", "1 0 0"),
    ]);
    let joint = |name: &str, parent: &str, child: &str, more: &str| {
        format!(
            "<link name=\"{child}\"/><joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"1\"/>{more}</joint>"
        )
    };
    let add = |parts: &[String]| arm.replace("</robot>", &(parts.concat() + "</robot>"));
    let fingers = add(&[
        joint("f1", "palm", "left", ""),
        joint("f2", "palm", "right", "<mimic joint=\"f1\"/>"),
        joint("f3", "left", "tip", "<mimic joint=\"f1\"/>"),
    ]);
    let found = outline(&fingers);
    assert_eq!(
        (found.tip_link.as_str(), found.joints, found.joints_off),
        ("palm", 4, vec!["f1".into(), "f2".into(), "f3".into()])
    );
    // A bar of a parallelogram mimics an earlier joint. The main chain of the arm continues elsewhere.
    let bar =
        add(&[joint("roll", "palm", "flange", ""), joint("bar", "palm", "rod", "<mimic joint=\"to_b\"/>")]);
    let found = outline(&bar);
    assert_eq!((found.tip_link.as_str(), found.joints, found.joints_off), ("flange", 5, vec!["bar".into()]));
}

/// The base link of a cell is often the floor or a table, not the foot of the arm.
#[test]
fn the_rows_of_a_scara_do_not_depend_on_the_height_of_its_base_link() {
    let arm = [
        ("revolute", "a", "0 0 0.4", "0 0 1"),
        ("revolute", "b", "0.3 0 0.05", "0 0 1"),
        ("prismatic", "c", "0.3 0 0", "0 0 1"),
        ("revolute", "d", "0 0 -0.1", "0 0 1"),
    ];
    let raised = [&[("fixed", "lift", "0.2 0.1 0.8", "0 0 1")][..], &arm].concat();
    let robot = |parts: &[(&str, &str, &str, &str)]| {
        load(&chain(parts), 4, "tip_link = \"d\"").0.unwrap_or_else(|faults| panic!("{faults:#?}")).cell.robot
    };
    let (low, high) = (robot(&arm), robot(&raised));
    let rows = |robot: &sweetspot::cell::Robot| {
        robot.joints.iter().map(|joint| [joint.r, joint.l, joint.alpha]).collect::<Vec<_>>()
    };
    for (own, other) in rows(&low).iter().flatten().zip(rows(&high).iter().flatten()) {
        assert!((own - other).abs() < 1e-12, "{:?} and {:?}", rows(&low), rows(&high));
    }
    let moved = high.mount.translation - low.mount.translation;
    assert!((moved - nalgebra::Vector3::new(0.2, 0.1, 0.8)).norm() < 1e-12, "{moved}");
    assert!((low.mount.translation.z - 0.4).abs() < 1e-12, "{}", low.mount.translation);
}
