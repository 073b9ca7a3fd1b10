//! Tests the steps from the URDF of a user to a first cell: `init` with a URDF, a xacro file or the folder of
//! a package.

use crate::cli::sandbox::*;
use crate::common::root;

/// Returns the command of the only `next:` line.
fn next(ran: &RunOutput) -> Vec<String> {
    let line = ran.err.lines().find_map(|line| line.strip_prefix("next: sweetspot ")).expect("no next");
    line.split(' ').map(str::to_string).collect()
}

fn words(args: &[String]) -> Vec<&str> {
    args.iter().map(String::as_str).collect()
}

/// Returns the URDF of the arm of these tests.
fn arm() -> String {
    std::fs::read_to_string(root().join("tests/data/own_arm.urdf")).unwrap()
}

/// Returns a cube with edges of 300 mm that stands on the origin, as STL in mm.
fn stl() -> String {
    let corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1];
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = "solid base\n".to_string();
    for [a, b, c, d] in faces {
        for triangle in [[a, b, c], [a, c, d]] {
            let vertex = |k: usize| {
                let [x, y, z] = corner(k);
                format!("vertex {} {} {}\n", 300 * x as i32 - 150, 300 * y as i32 - 150, 300 * z)
            };
            let vertices: String = triangle.map(vertex).concat();
            text += &format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n");
        }
    }
    text + "endsolid base\n"
}

/// Writes the ROS package of the arm into ws/own_arm.
fn with_package(urdf: &str) -> Sandbox {
    let shop = Sandbox::new();
    for folder in ["ws/own_arm/urdf", "ws/own_arm/meshes"] {
        std::fs::create_dir_all(shop.path(folder)).unwrap();
    }
    shop.write("ws/own_arm/package.xml", "<package><name>own_arm</name></package>");
    shop.write("ws/own_arm/urdf/arm.urdf", urdf);
    shop.write("ws/own_arm/meshes/base.stl", &stl());
    shop
}

const URDF: &str = "ws/own_arm/urdf/arm.urdf";
const CELL_OF_ARM: &str = "ws/own_arm/urdf/arm-cell/cell.toml";

#[test]
fn a_urdf_leads_to_the_first_error_map_and_a_search() {
    let shop = with_package(&arm());
    let ran = shop.done(&["init", URDF]);
    assert!(ran.out.is_empty(), "{}", ran.out);
    for said in
        ["the tool is guessed: tool0 is the last link", "6 joints", "the errors are guessed", "preset medium"]
    {
        assert!(ran.err.contains(said), "no {said}: {}", ran.err);
    }
    assert!(ran.err.contains("the arm can use 35 of 35 nodes"), "{}", ran.err);
    assert_eq!(next(&ran).join(" "), format!("map {CELL_OF_ARM} --svg map.svg"));
    let map = shop.done(&words(&next(&ran)));
    assert!(map.out.contains("35 of 35 nodes usable"), "{}", map.out);
    assert!(shop.text("map.svg").starts_with("<svg"));
    assert_eq!(next(&map).join(" "), format!("search {CELL_OF_ARM}"));
    let found = shop.json(&["search", CELL_OF_ARM, "--budget", "40", "--out", "found"]);
    assert_eq!(found["status"], "found", "{found}");
    // The import has reported all warnings, so the copy of the URDF gives no warning.
    let check = shop.json(&["check", CELL_OF_ARM]);
    assert_eq!(items(&check["faults"]).len(), 0, "{check}");
    assert_eq!(number(&check["urdf"]["rows"][1]["l_mm"]).abs(), 600.0);
    let folder = "ws/own_arm/urdf/arm-cell";
    shop.has(
        folder,
        &[
            "cell.toml",
            "equipment/table.toml",
            "robots/arm.toml",
            "robots/arm.urdf",
            "robots/meshes/base.stl",
        ],
    );
    for guess in
        ["GUESS: the last link", "GUESS: a tool of length 0", "GUESS, not measured: the preset medium"]
    {
        assert!(shop.text(&format!("{folder}/robots/arm.toml")).contains(guess), "no {guess}");
    }
}

#[test]
fn init_never_overwrites_a_cell_of_the_user() {
    let shop = with_package(&arm());
    shop.done(&["init", URDF]);
    shop.write(CELL_OF_ARM, "mine");
    let again = shop.run(&["init", URDF]);
    assert!(again.code == Some(2) && again.err.contains("nothing is overwritten"), "{}", again.err);
    assert_eq!(shop.text(CELL_OF_ARM), "mine");
    shop.done(&["init", URDF, "--out", "my shop/cell"]);
    shop.has("my shop/cell", &["cell.toml", "robots/arm.urdf"]);
    shop.write("file", "");
    assert_eq!(shop.run(&["init", URDF, "--out", "file/x"]).code, Some(3));
}

#[test]
fn warnings_of_an_import_come_once_and_grouped() {
    let shop = with_package(&arm());
    let ran = shop.done(&["init", URDF]);
    assert_eq!(ran.err.matches("6 angles are rounded right angles").count(), 1, "{}", ran.err);
    assert_eq!(ran.err.matches("continuous joint").count(), 1, "{}", ran.err);
    assert!(ran.err.contains("(and 1 more of this kind)"), "{}", ran.err);
    assert!(ran.err.contains("they stand still, and their links have no solids: left, right"), "{}", ran.err);
    // If a cell names the original URDF, only `check` prints the warnings.
    std::fs::copy(shop.path(URDF), shop.path("ws/own_arm/urdf/arm-cell/robots/arm.urdf")).unwrap();
    let named = ["--package", "own_arm=ws/own_arm"];
    let check = shop.done(&[&["check", CELL_OF_ARM][..], &named].concat());
    assert_eq!(check.err.matches("6 angles are rounded right angles").count(), 1, "{}", check.err);
    for command in ["map", "budget", "explain"] {
        let ran = shop.done(&[&[command, CELL_OF_ARM][..], &named].concat());
        assert!(!ran.err.contains("angles") && !ran.err.contains("continuous"), "{command}: {}", ran.err);
        assert!(
            ran.err.contains(" --package own_arm=ws/own_arm"),
            "{command} drops the package: {}",
            ran.err
        );
    }
}

#[test]
fn packages_are_found_beside_the_urdf_and_where_ros_looks() {
    let urdf = arm().replace("own_arm/meshes/base.stl", "arm_meshes/base.stl");
    let shop = with_package(&urdf);
    let count = |ran: &RunOutput| {
        let solids = shop.text("out/robots/arm.urdf").matches("<collision>").count();
        std::fs::remove_dir_all(shop.path("out")).unwrap();
        (solids, ran.err.contains("1 of 3 collision shapes are left out"))
    };
    let init = ["init", URDF, "--out", "out"];
    let run = |variable: &str, value: &str| {
        let mut command = shop.command(&init);
        command.env_remove("ROS_PACKAGE_PATH").env_remove("AMENT_PREFIX_PATH").env(variable, value);
        ran(command.output().unwrap())
    };
    let unknown = run("NONE", "");
    assert!(unknown.err.contains("the folder of the package arm_meshes is unknown"), "{}", unknown.err);
    assert!(unknown.err.contains("add --package arm_meshes=DIR"), "{}", unknown.err);
    assert_eq!(count(&unknown), (2, true));
    for (folder, variable, value) in [
        ("ros1/arm_meshes", "ROS_PACKAGE_PATH", "ros1"),
        ("ros1/stack/arm_meshes", "ROS_PACKAGE_PATH", "ros1"),
        ("ros2/share/arm_meshes", "AMENT_PREFIX_PATH", "other:ros2"),
        ("ws/arm_meshes", "NONE", ""),
        ("elsewhere", "--package", ""),
    ] {
        std::fs::create_dir_all(shop.path(folder)).unwrap();
        shop.write(&format!("{folder}/base.stl"), &stl());
        let ran = match variable {
            "--package" => shop.done(&[&init[..], &["--package", "arm_meshes=elsewhere"]].concat()),
            _ => run(variable, value),
        };
        assert_eq!(ran.code, Some(0), "{}", ran.err);
        assert_eq!(count(&ran), (3, false), "{folder}: {}", ran.err);
        std::fs::remove_dir_all(shop.path(folder)).unwrap();
    }
}

#[test]
fn a_collada_mesh_is_left_out_with_the_command_that_converts_it() {
    let shop = with_package(&arm().replace("base.stl", "base.dae"));
    std::fs::rename(shop.path("ws/own_arm/meshes/base.stl"), shop.path("converted.stl")).unwrap();
    shop.write("ws/own_arm/meshes/base.dae", "<?xml version=\"1.0\"?>\n<COLLADA/>");
    let ran = shop.done(&["init", URDF, "--out", "without"]);
    assert!(ran.err.contains("warning: 1 of 3 collision shapes are left out"), "{}", ran.err);
    let line = ran.err.lines().find(|line| line.contains("assimp export ")).expect("no command");
    let paths: Vec<_> = line.split_whitespace().skip(2).collect();
    let same =
        |path: &str, inside: &str| std::path::Path::new(path) == shop.path(inside).canonicalize().unwrap();
    assert!(same(paths[0], "ws/own_arm/meshes/base.dae"), "{line}");
    assert!(shop.text("without/robots/arm.toml").contains("footprint = "), "the base has no solids");
    // The result of the suggested command is used instead.
    std::fs::rename(shop.path("converted.stl"), paths[1]).unwrap();
    let ran = shop.done(&["init", URDF, "--out", "with"]);
    assert!(!ran.err.contains("left out"), "{}", ran.err);
    shop.has("with/robots/meshes", &["base.stl"]);
    assert!(!shop.text("with/robots/arm.toml").contains("footprint = "));
}

#[test]
fn a_mesh_that_cannot_be_read_is_left_out_with_its_reason() {
    for (bytes, why) in
        [("solid x\nfacet normal 0 0 0\nouter loop\n", "truncated"), ("q,w\n1,2\n", "a table of data")]
    {
        let shop = with_package(&arm());
        shop.write("ws/own_arm/meshes/base.stl", bytes);
        let ran = shop.done(&["init", URDF, "--out", "out"]);
        assert!(
            ran.err.contains("1 of 3 collision shapes are left out") && ran.err.contains(why),
            "{}",
            ran.err
        );
        shop.done(&["map", "out/cell.toml"]);
    }
    // A URDF cannot copy other files of the machine into the cell.
    let shop = with_package(&arm().replace("package://own_arm/meshes/base.stl", "file:///etc/hostname"));
    let ran = shop.done(&["init", URDF, "--out", "out"]);
    assert!(
        ran.err.contains("it is not an STL or OBJ file") || ran.err.contains("no such file"),
        "{}",
        ran.err
    );
    assert!(shop.files("out/robots").iter().all(|file| !file.starts_with("meshes")));
}

#[test]
fn a_robot_file_in_toml_gets_a_cell_too() {
    let shop = Sandbox::new();
    for (robot, errors) in [("hitachi_pw10_urdf", "table-3-tolerance"), ("adept_cobra_s600", "placeholder")] {
        let ran = shop.done(&["init", &format!("cells/robots/{robot}.toml"), "--out", robot]);
        assert!(ran.err.contains(&format!("next: sweetspot map {robot}/cell.toml")), "{}", ran.err);
        assert!(shop.text(&format!("{robot}/cell.toml")).contains(&format!("errors = \"{errors}\"")));
        assert!(number(&shop.json(&["map", &format!("{robot}/cell.toml")])["objective_mm"]) > 0.0);
    }
    shop.has("hitachi_pw10_urdf/robots", &["hitachi_pw10.urdf", "hitachi_pw10_urdf.toml"]);
    // A signed error set is read as a signed sample.
    let signed = shop.text("cells/robots/hitachi_pw10_urdf.toml");
    let signed = &signed[..signed.find("[errors.table-3-tolerance]").unwrap()];
    shop.write("cells/robots/signed.toml", signed);
    shop.done(&["init", "cells/robots/signed.toml", "--out", "signed"]);
    assert!(shop.text("signed/cell.toml").contains("reading = \"signed\""));
    assert!(number(&shop.json(&["map", "signed/cell.toml"])["objective_mm"]) > 0.0);
    let cell = shop.run(&["init", CELL]);
    assert!(cell.code == Some(2) && cell.err.contains("is not a URDF"), "{}", cell.err);
}

#[test]
fn the_tool_can_be_named() {
    let shop = with_package(&arm());
    let ran = shop.done(&["init", URDF, "--tip", "flange", "--out", "out"]);
    assert!(ran.err.contains("the tool is at flange") && ran.err.contains("along (1, 0, 0)"), "{}", ran.err);
    assert!(shop.text("out/robots/arm.toml").contains("axis = [1, 0, 0]"));
    let slip = shop.run(&["init", URDF, "--tip", "flnge", "--out", "slip"]);
    assert!(slip.code == Some(2) && slip.err.contains("did you mean `flange`?"), "{}", slip.err);
    assert!(!shop.path("slip").exists());
    let other = shop.run(&["init", "scara", "--tip", "flange"]);
    assert!(other.code == Some(2) && other.err.contains("only to a URDF"), "{}", other.err);
}

#[test]
fn a_folder_with_one_urdf_is_enough_and_several_are_listed() {
    let shop = with_package(&arm());
    let ran = shop.done(&["init", "ws/own_arm"]);
    assert!(ran.err.contains("ws/own_arm/urdf/arm.urdf is the only robot"), "{}", ran.err);
    // The URDF in the folder of the new cell is ignored.
    let again = shop.run(&["init", "ws/own_arm"]);
    assert!(again.err.contains("nothing is overwritten"), "{}", again.err);
    shop.write("ws/own_arm/urdf/long.urdf", &arm());
    let several = shop.run(&["init", "ws/own_arm"]);
    assert_eq!(several.code, Some(2));
    for line in [
        "2 robots in ws/own_arm",
        "  sweetspot init ws/own_arm/urdf/arm.urdf",
        "  sweetspot init ws/own_arm/urdf/long.urdf",
    ] {
        assert!(several.err.contains(line), "{}", several.err);
    }
    let none = shop.run(&["init", "ws/own_arm/meshes"]);
    assert!(none.code == Some(2) && none.err.contains("no URDF and no xacro file"), "{}", none.err);
}

#[test]
fn robot_check_envelope_and_errors_take_a_urdf() {
    let shop = with_package(&arm());
    let check = shop.done(&["check", URDF]);
    assert!(
        check.out.contains("six axes with three that meet in a point") && check.out.contains("3 solids"),
        "{}",
        check.out
    );
    assert_eq!(next(&check).join(" "), format!("init {URDF}"));
    let document = shop.json(&["check", URDF]);
    assert_eq!(
        (&document["valid"], &document["urdf"]["rows"][0]["alpha_deg"]),
        (&true.into(), &(-90.0).into())
    );
    let sheet = shop.done(&["robot", URDF]);
    assert!(
        sheet.out.contains("guess, a tolerance") && sheet.err.contains("the tool is guessed"),
        "{}",
        sheet.out
    );
    assert!(shop.done(&["robot", URDF, "--toml"]).out.contains("tip_link = \"tool0\""));
    let envelope = shop.json(&["envelope", URDF]);
    assert!(number(&envelope["size"]["radius_mm"][1]) > 900.0, "{envelope}");
    assert!(shop.done(&["errors", URDF]).out.contains("guess"));
    let wrong = arm().replace("upper=\"2.2\"", "upper=\"-2.2\"");
    shop.write(URDF, &wrong);
    for command in ["check", "robot", "envelope", "errors", "init"] {
        let ran = shop.run(&[command, URDF]);
        assert_eq!(ran.code, Some(2), "{command}: {}", ran.err);
        assert!(
            ran.err.contains(&format!("{URDF}:31:"))
                && ran.err.contains("are reversed")
                && !ran.err.contains("warning"),
            "{}",
            ran.err
        );
    }
}

/// Runs a command with a search path for programs, which decides whether programs that expand xacro files are
/// found.
fn with_path(shop: &Sandbox, args: &[&str], path: &str) -> RunOutput {
    ran(shop.command(args).env("PATH", path).output().unwrap())
}

const XACRO: &str = "ws/own_arm/urdf/arm.urdf.xacro";

fn with_xacro() -> Sandbox {
    let shop = with_package(&arm());
    std::fs::remove_file(shop.path(URDF)).unwrap();
    let macros = "<robot name=\"own_arm\" xmlns:xacro=\"http://ros.org/wiki/xacro\">\n<xacro:arg name=\"base\" default=\"0.4\"/>";
    let text = arm()
        .replace("<robot name=\"own_arm\">", macros)
        .replace("xyz=\"0 0 0.4\"", "xyz=\"0 0 $(arg base)\"");
    shop.write(XACRO, &text);
    shop
}

#[test]
fn without_xacro_the_exact_command_is_printed() {
    let shop = with_xacro();
    let ran = with_path(&shop, &["init", XACRO, "base:=0.5"], "");
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    let command = "xacrodoc -d ";
    let line = ran.err.lines().find(|line| line.contains(command)).expect("no command");
    let rest = format!(
        "/ws {XACRO} base:=0.5 -o ws/own_arm/urdf/arm.urdf; then: sweetspot init ws/own_arm/urdf/arm.urdf"
    );
    assert!(line.ends_with(&rest), "{line}");
    assert!(ran.err.contains("pip install xacrodoc"), "{}", ran.err);
    for wrong in ["base", "--base:=1", ":=1"] {
        assert_eq!(shop.run(&["init", XACRO, wrong]).code, Some(2), "{wrong}");
    }
}

#[cfg(unix)]
#[test]
fn init_calls_xacro_and_a_cell_file_does_not() {
    use std::os::unix::fs::PermissionsExt;
    let shop = with_xacro();
    std::fs::create_dir(shop.path("bin")).unwrap();
    // This script expands the only macro of the test and writes a log line.
    let script = "#!/bin/sh\necho ran >> \"$0.log\"\nbase=\"${2#base:=}\"\n\
                  while IFS= read -r line; do case \"$line\" in\n*xacro:arg*) ;;\n*'$(arg base)'*)\n\
                  printf '%s%s%s\\n' \"${line%%\\$*}\" \"$base\" \"${line##*)}\" ;;\n*) printf '%s\\n' \"$line\" ;;\nesac; done < \"$1\"\n";
    shop.write("bin/xacro", script);
    std::fs::set_permissions(shop.path("bin/xacro"), std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = shop.path("bin").to_string_lossy().into_owned();
    let ran = with_path(&shop, &["init", XACRO, "base:=0.5", "--out", "out"], &path);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    assert_eq!(shop.text("bin/xacro.log"), "ran\n");
    let rows = shop.json(&["check", "out/cell.toml"])["urdf"]["rows"][0]["r_mm"].clone();
    assert_eq!(rows, 500.0);
    // A cell whose robot names the xacro file is refused, and no program runs.
    std::fs::copy(shop.path(XACRO), shop.path("out/robots/arm.urdf")).unwrap();
    let refused = with_path(&shop, &["map", "out/cell.toml"], &path);
    assert!(refused.code == Some(2) && refused.err.contains("is not expanded here"), "{}", refused.err);
    assert_eq!(shop.text("bin/xacro.log"), "ran\n");
}

#[test]
fn a_failing_xacro_repeats_its_reason() {
    let shop = with_xacro();
    std::fs::create_dir(shop.path("bin")).unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        shop.write("bin/xacrodoc", "#!/bin/sh\necho 'Package not found: arm_meshes' >&2\nexit 1\n");
        std::fs::set_permissions(shop.path("bin/xacrodoc"), std::fs::Permissions::from_mode(0o755)).unwrap();
        let ran = with_path(&shop, &["init", XACRO], &shop.path("bin").to_string_lossy());
        assert!(
            ran.code == Some(2) && ran.err.contains("xacrodoc: Package not found: arm_meshes"),
            "{}",
            ran.err
        );
    }
}

#[test]
fn a_robot_that_reaches_no_table_gets_no_cell() {
    let start = arm().find("<joint name=\"j2\"").unwrap();
    let arm = arm();
    // One joint rotates the rest of the arm about the vertical.
    let rigid = format!(
        "{}{}",
        &arm[..start],
        arm[start..].replace("revolute", "fixed").replace("continuous", "fixed")
    );
    let shop = with_package(&rigid);
    let ran = shop.run(&["init", URDF]);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    assert!(ran.err.contains("no place was found where the arm own_arm can reach a table"), "{}", ran.err);
    assert!(!shop.path("ws/own_arm/urdf/arm-cell").exists());
}
