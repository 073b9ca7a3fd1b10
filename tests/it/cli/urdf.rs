//! Tests robots from URDF files on the command line.

use crate::cli::sandbox::Sandbox;
use crate::common::root;
use serde_json::Value;

/// Writes a cell whose URDF is in a ROS package.
fn with_package(shop: &Sandbox) {
    let robot = shop.text("cells/robots/hitachi_pw10_urdf.toml");
    let robot = robot.replace("\"hitachi_pw10.urdf\"", "\"package://pw10/urdf/arm.urdf\"");
    shop.write("cells/robots/packaged.toml", &robot);
    let cell = "from = \"hitachi_urdf.toml\"\nname = \"P\"\n[robot]\nfrom = \"robots/packaged.toml\"\n";
    shop.write("cells/packaged.toml", cell);
    std::fs::create_dir_all(shop.path("ros/pw10/urdf")).unwrap();
    std::fs::rename(shop.path("cells/robots/hitachi_pw10.urdf"), shop.path("ros/pw10/urdf/arm.urdf"))
        .unwrap();
}

#[test]
fn check_shows_the_derived_rows() {
    let shop = Sandbox::new();
    let ran = shop.done(&["check", "cells/hitachi_urdf.toml"]);
    let row = |words: [&str; 5]| ran.out.lines().any(|l| words.iter().all(|w| l.contains(w)));
    assert!(row(["A1", "q1 (waist)", "90", "750", "-150"]), "{}", ran.out);
    assert!(row(["A3", "q3 (forearm)", "-90", "850", "45"]), "{}", ran.out);
    assert!(ran.out.contains("not used: nothing"), "{}", ran.out);
    let ran = shop.done(&["check", "--json", "cells/hitachi_urdf.toml"]);
    let document: Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(document["urdf"]["rows"][1]["l_mm"], 600.0);
    assert_eq!(document["urdf"]["rows"][2]["theta_deg"], -90.0);
}

#[test]
fn an_arm_without_inverse_kinematics_shows_its_rows() {
    let shop = Sandbox::new();
    let urdf = std::fs::read_to_string(root().join("tests/data/ur5.urdf")).unwrap();
    shop.write("cells/ur5.urdf", &urdf.replace("</robot>", "<gazebo/></robot>"));
    let zeros = "[0, 0, 0, 0, 0, 0]";
    shop.write(
        "cells/ur5.toml",
        &format!(
            "from = \"hitachi_paper.toml\"\n[robot]\nfrom = \"ur5_robot.toml\"\n[robot.errors.table-3]\n\
             kind = \"signed\"\nsource = \"-\"\ndr_mm = {zeros}\ndl_mm = {zeros}\ndalpha_deg = {zeros}\n"
        ),
    );
    shop.write(
        "cells/ur5_robot.toml",
        "schema = \"sweetspot/robot/1\"\nunits = { length = \"mm\", angle = \"deg\" }\nurdf = \"ur5.urdf\"\n\
         tool = { position_mm = [0, 0, 0], axis = [0, 0, 1] }\nfootprint = { size_mm = [400, 400] }\n",
    );
    let ran = shop.run(&["check", "cells/ur5.toml"]);
    assert!(ran.out.contains("-392.25") && ran.out.contains("not used: 1 gazebo"), "{}{}", ran.out, ran.err);
    assert!(ran.err.contains("warning: elements of this URDF that are not used: 1 gazebo"), "{}", ran.err);
}

#[test]
fn packages_are_found_where_the_command_line_says() {
    let shop = Sandbox::new();
    with_package(&shop);
    let named = ["--package", "pw10=ros/pw10"];
    for command in [&["map"][..], &["check"], &["budget"], &["explain"], &["readings"], &["compare"]] {
        shop.done(&[command, &["cells/packaged.toml"], &named].concat());
    }
    let ran = shop.run(&["check", "cells/packaged.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("--package pw10=DIR"), "{}", ran.err);
    for wrong in ["pw10", "=ros", "pw10="] {
        assert_eq!(shop.run(&["check", "cells/packaged.toml", "--package", wrong]).code, Some(2), "{wrong}");
    }
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_out_of_a_package_is_refused() {
    let shop = Sandbox::new();
    with_package(&shop);
    let (inside, outside) = (shop.path("ros/pw10/urdf/arm.urdf"), shop.path("ros/arm.urdf"));
    std::fs::rename(&inside, &outside).unwrap();
    std::os::unix::fs::symlink(&outside, &inside).unwrap();
    let ran = shop.run(&["check", "cells/packaged.toml", "--package", "pw10=ros/pw10"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("is outside the folder of its package"), "{}", ran.err);
}
