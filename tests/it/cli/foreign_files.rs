//! Tests that no kind of file is read as another kind. Each kind is recognized by its content, and the
//! message states the next step.

use crate::cli::sandbox::*;

const TRIANGLE: &str =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

/// Returns foreign files: name, content, expected description, and a part of the expected next step.
fn files() -> Vec<(&'static str, Vec<u8>, &'static str, &'static str)> {
    let mut binary_stl = vec![b'x'; 84 + 50];
    binary_stl[80..84].copy_from_slice(&1u32.to_le_bytes());
    let text = |text: &str| text.as_bytes().to_vec();
    let urdf = text("<?xml version=\"1.0\"?>\n<!-- <a> -->\n<robot name=\"a\"><link name=\"b\"/></robot>");
    vec![
        ("arm.urdf", urdf.clone(), "a URDF", "sweetspot init cells/arm.urdf"),
        ("arm.toml", urdf, "a URDF", "sweetspot init cells/arm.toml"),
        ("arm.xacro", text("<robot><xacro:x/></robot>"), "a xacro file", "sweetspot init cells/arm.xacro"),
        ("a b.dae", text("<COLLADA/>"), "a COLLADA mesh", "assimp export 'cells/a b.dae' 'cells/a b.stl'"),
        ("page.html", text("<html></html>"), "an XML file", "in TOML"),
        ("part.stl", text(&format!("solid x\n{TRIANGLE}endsolid x\n")), "an STL mesh", "mesh = { file"),
        ("part.toml", binary_stl, "an STL mesh", "mesh = { file"),
        (
            "part.obj",
            text("# x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            "a Wavefront OBJ mesh",
            "mesh = { file",
        ),
        (
            "plan.dxf",
            text("  0\nSECTION\n  2\nHEADER\n  0\nENDSEC\n  0\nEOF\n"),
            "a DXF drawing",
            "plan = { file",
        ),
        (
            "part.step",
            text("ISO-10303-21;\nHEADER;\n"),
            "a STEP model",
            "gmsh cells/part.step -2 -format stl -o cells/part.stl",
        ),
        ("map.json", text("{\n  \"schema\": 1\n}\n"), "a JSON file", "sweetspot report FOLDER"),
        (
            "arm.yaml",
            text("kinematics:\n  shoulder:\n    x: 0\n    y: 1\n"),
            "a YAML file",
            "calibrate ROBOT cells/arm.yaml",
        ),
        (
            "tracker.csv",
            text("q1,q2,x\n1,2,3\n4,5,6\n"),
            "a table of data",
            "calibrate ROBOT cells/tracker.csv",
        ),
        (
            "tracker.txt",
            text("q1;q2;x\n1,5;2,5;3,5\n"),
            "a table of data",
            "calibrate ROBOT cells/tracker.txt",
        ),
        ("photo.png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec(), "a binary file", "in TOML"),
    ]
}

#[test]
fn every_command_says_what_a_foreign_file_is() {
    let shop = Sandbox::new();
    for (name, bytes, ..) in files() {
        shop.write_bytes(&format!("cells/{name}"), &bytes);
    }
    let commands: [&[&str]; 11] = [
        &["map"],
        &["search"],
        &["compare"],
        &["budget"],
        &["allocate"],
        &["explain"],
        &["readings"],
        &["robust"],
        &["correct"],
        &["export", "--to", "dxf"],
        &["calibrate", "--plan", "5"],
    ];
    for (name, _, what, next) in files() {
        let path = format!("cells/{name}");
        let is_robot = what == "a URDF" || what == "a xacro file";
        let own: &[&[&str]] =
            if is_robot { &[] } else { &[&["check"], &["robot"], &["envelope"], &["errors"], &["init"]] };
        for command in commands.iter().chain(own) {
            let ran = shop.run(&[command, &[path.as_str()][..]].concat());
            ran.no_panic();
            let told = format!("{command:?} {name}: {}", ran.err);
            assert_eq!(ran.code, Some(2), "{told}");
            assert_eq!(ran.err.matches("error: ").count(), 1, "{told}");
            assert!(ran.err.contains(what) && ran.err.contains(next), "{told}");
            assert!(ran.err.lines().count() <= 5, "{told}");
        }
    }
}

#[test]
fn a_file_that_a_cell_names_is_recognised_where_it_is_named() {
    let shop = Sandbox::new();
    shop.write("cells/part.toml", &format!("solid x\n{TRIANGLE}endsolid x\n"));
    shop.write("cells/cell.toml", "from = \"hitachi_paper.toml\"\n[robot]\nfrom = \"part.toml\"\n");
    let ran = shop.run(&["map", "cells/cell.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("cells/cell.toml:3:8: error: `part.toml` is an STL mesh"), "{}", ran.err);
    // The name of this mesh file has the wrong extension.
    shop.write("cells/part.obj", &format!("solid x\n{TRIANGLE}endsolid x\n"));
    let mesh = "mesh = { file = \"part.obj\", units = \"m\", centre_mm = [0, 0, 0] }";
    let obstacle = format!(
        "[obstacle.o]\nsolid = [{{ name = \"o\", {mesh} }}]\nplacement = {{ x_mm = 9000, y_mm = 0, z_mm = 0 }}\n"
    );
    shop.write("cells/cell.toml", &format!("from = \"hitachi_paper.toml\"\n{obstacle}"));
    let ran = shop.run(&["map", "cells/cell.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("`part.obj` is an STL mesh, not a Wavefront OBJ mesh"), "{}", ran.err);
}

#[test]
fn tables_of_data_are_no_other_file() {
    let shop = Sandbox::new();
    for (name, bytes, what, _) in files() {
        if ["a YAML file", "a table of data", "a binary file", "a URDF"].contains(&what)
            || what.contains("xacro")
        {
            continue;
        }
        shop.write_bytes("data.txt", &bytes);
        for args in [&["calibrate", "ur10", "data.txt"][..], &["correct", CELL, "--targets", "data.txt"]] {
            let ran = shop.run(args);
            assert_eq!(ran.code, Some(2), "{args:?}, {name}: {}", ran.err);
            assert!(ran.err.contains(what) && ran.err.contains("not a table of data"), "{name}: {}", ran.err);
        }
    }
    let ran = shop.run(&["calibrate", "ur10", CELL]);
    assert!(ran.code == Some(2) && ran.err.contains("not a table of data"), "{}", ran.err);
}

/// Broken TOML is still treated as TOML: the message states the place of the fault.
#[test]
fn broken_toml_is_no_foreign_file() {
    let shop = Sandbox::new();
    for text in [
        "[robot]\nx = \n",
        "name = \"a\", b\n",
        "a\nb\n",
        "[[1]\n",
        "",
        "# a, b\n# c, d\n",
        "solid = [1]\nx = 2\n",
    ] {
        shop.write("cells/cell.toml", text);
        let ran = shop.run(&["check", "cells/cell.toml"]);
        assert_eq!(ran.code, Some(2), "{text:?}: {}", ran.err);
        assert!(!ran.err.contains("not a cell or robot file"), "{text:?}: {}", ran.err);
    }
}
