//! Tests the robot library: every file in cells/robots loads and cites its source. The flange must be at the
//! position that a second description of the robot gives (tests/data/robots.py).

use crate::common::{from_text, root};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use std::path::Path;
use sweetspot::assess::RobotDataSheet;
use sweetspot::cell::{ErrorSet, JointVector, Robot, Shape};
use sweetspot::clearance::{FloorPlan, PlacedSolids, Scene};
use sweetspot::files::Loaded;
use sweetspot::robot::Chain;

/// Returns the names of the files in a folder below cells, without `.toml`.
fn names(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(root().join("cells").join(folder)).unwrap();
    let paths = entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let stem = |p: &Path| p.file_stem().unwrap().to_str().unwrap().to_string();
    let mut names: Vec<_> = paths.map(|p| stem(&p)).collect();
    names.sort();
    names
}

/// Loads a robot file in the smallest cell that uses one of its error sets.
fn load(name: &str, set: &str, more: &str) -> Loaded {
    let text = format!(
        r#"
        schema = "sweetspot/cell/1"
        units = {{ length = "mm", angle = "deg" }}
        errors = "{set}"
        [robot]
        from = "robots/{name}.toml"
        {more}
        [equipment.table]
        surface = {{ size_mm = [400, 400] }}
        placement = {{ x_mm = 400, y_mm = 400, z_mm = 300 }}
        [operation.map]
        on = "table"
        grid = [1, 1]
        bend_deg = -90
        sense = "xyz""#
    );
    from_text(&text).unwrap_or_else(|faults| panic!("{name}: {faults:#?}"))
}

fn set_of(name: &str) -> &'static str {
    if name.starts_with("hitachi") { "table-2" } else { "placeholder" }
}

pub fn robot(name: &str) -> Robot {
    load(name, set_of(name), "").cell.robot
}

fn golden() -> Value {
    serde_json::from_str(&std::fs::read_to_string(root().join("tests/data/robots.json")).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn joints(pose: &Value) -> JointVector {
    let q = numbers(&pose["q"]);
    std::array::from_fn(|i| q.get(i).copied().unwrap_or(0.0))
}

#[test]
fn every_robot_loads_without_a_warning_and_has_its_sources() {
    let names = names("robots");
    assert!(names.len() >= 42, "{names:?}");
    for name in &names {
        let loaded = load(name, set_of(name), "");
        assert!(loaded.warnings.is_empty(), "{name}: {:#?}", loaded.warnings);
        let robot = loaded.cell.robot;
        assert!(robot.source.len() > 80, "{name}: {}", robot.source);
        assert!(!robot.solids.is_empty(), "{name} has no solids");
        assert!(robot.solids.iter().any(|s| s.link == 0), "{name} has no base");
        let tolerance = |set: &ErrorSet| matches!(set, ErrorSet::Tolerance(_));
        assert!(robot.errors.iter().any(tolerance), "{name} has no tolerances");
    }
}

#[test]
fn flanges_agree_with_an_independent_description() {
    let golden = golden();
    // A robot from a URDF has the reference poses of the robot with the same rows.
    let described = names("robots").into_iter().filter(|name| name != "hitachi_pw10_urdf");
    assert_eq!(
        golden.as_object().unwrap().keys().cloned().collect::<Vec<_>>(),
        described.collect::<Vec<_>>()
    );
    for (name, poses) in golden.as_object().unwrap() {
        let chain = Chain::new(&robot(name));
        let poses = poses.as_array().unwrap();
        assert_eq!(poses.len(), 21, "{name}");
        for pose in poses {
            let q = joints(pose);
            let tcp = chain.forward(&chain.posture(&q));
            let off = (tcp.translation - Vector3::from_vec(numbers(&pose["p"]))).norm();
            let askew = (tcp.rotation - Matrix3::from_row_slice(&numbers(&pose["r"]))).norm();
            assert!(off < 1e-9 && askew < 1e-9, "{name} at {q:?}: {off:e} m, {askew:e}");
        }
    }
}

/// The first pose of the golden file is `home` in the units of the reader.
#[test]
fn home_is_read_in_the_units_of_the_joints() {
    for (name, poses) in golden().as_object().unwrap() {
        let (home, want) = (robot(name).home, joints(&poses[0]));
        for (got, want) in home.iter().zip(want) {
            assert!((got - want).abs() < 1e-12, "{name}: {home:?}");
        }
    }
}

/// A passive joint has no home coordinate. Without the key `home`, a joint rests at 0, or in the middle of
/// its limits if they exclude 0.
#[test]
fn the_default_home_is_zero_or_the_middle_of_the_limits() {
    let stanford = std::fs::read_to_string(root().join("cells/robots/stanford_arm.toml")).unwrap();
    assert!(stanford.contains("limits_mm = [304.8, 1270]"), "the test needs a range without 0");
    let text = stanford.lines().filter(|line| !line.starts_with("home")).collect::<Vec<_>>().join("\n");
    let cell = r#"
        schema = "sweetspot/cell/1"
        units = { length = "mm", angle = "deg" }
        errors = "placeholder"
        robot = { from = "robot.toml" }
        equipment.table = { surface = { size_mm = [9, 9] }, placement = { x_mm = 400, y_mm = 0, z_mm = 0 } }
        operation.map = { on = "table", grid = [1, 1], bend_deg = -90, sense = "xyz" }"#;
    let read = &mut |path: &str| {
        Ok(if path == "robot.toml" { text.clone().into_bytes() } else { cell.as_bytes().to_vec() })
    };
    let home = sweetspot::files::load("cell.toml", read).unwrap_or_else(|f| panic!("{f:#?}")).cell.robot.home;
    let middle = (304.8 + 1270.0) / 2e3;
    assert!((home[2] - middle).abs() < 1e-12 && home[0] == 0.0 && home[4] == 0.0, "{home:?}");
}

/// A solid at the origin of link k of modified rows lies at the k-th joint origin of the URDF.
#[test]
fn solids_of_modified_dh_rows_are_in_the_frames_of_the_file() {
    let ball = |k| {
        format!(
            "[[robot.solid]]\nname = \"{k}\"\nlink = {k}\nsphere = {{ centre_mm = [0, 0, 0], radius_mm = 9 }}\n"
        )
    };
    // Row 7 of the file ends 107 mm further, at the flange.
    let more: String = (1..=6).map(ball).collect();
    let robot = load("franka_panda", "placeholder", &more).cell.robot;
    let chain = Chain::new(&robot);
    for pose in golden()["franka_panda"].as_array().unwrap() {
        let frames = chain.frames(&chain.posture(&joints(pose)));
        assert_eq!(robot.solids.len(), 6);
        for link in &robot.solids {
            let Shape::Sphere { centre, .. } = link.solid.shape else { panic!("no sphere") };
            let want = Vector3::from_vec(numbers(&pose["frames"][link.link - 1]));
            let off = (frames.links[link.link].transform(&centre) - want).norm();
            assert!(off < 1e-9, "link {}: {off:e} m", link.link);
        }
    }
}

/// The travel of a track counts as reach, because its first axis is horizontal.
#[test]
fn no_flange_is_farther_from_the_base_axis_than_the_reach() {
    for (name, poses) in golden().as_object().unwrap() {
        let reach = robot(name).reach();
        let flange = |pose: &Value| numbers(&pose["p"])[0].hypot(numbers(&pose["p"])[1]);
        let farthest = poses.as_array().unwrap().iter().map(flange).fold(0.0, f64::max);
        assert!(farthest <= reach, "{name}: {farthest} m, reach {reach} m");
    }
    let (track, arm) = (robot("puma560_on_track").reach(), robot("puma560").reach());
    assert!(track >= arm + 1.0, "{track} m, and {arm} m without the metre of travel");
}

/// Reach (m) in the names of some models. It is the reach of the wrist centre, which equals the reach of the
/// flange with the tool down.
const NAMED_REACHES: [(&str, f64); 6] = [
    ("abb_irb1200", 0.9),
    ("abb_irb4600", 2.05),
    ("abb_irb6700", 2.6),
    ("kuka_kr10_r1100", 1.1),
    ("kuka_kr150_r3100_2", 3.1),
    ("kuka_kr6_r900", 0.9),
];

#[test]
fn arms_reach_as_far_as_the_names_of_their_models_say() {
    for (name, reach) in NAMED_REACHES {
        let robot = robot(name);
        let sheet = RobotDataSheet::new(&robot).envelope.unwrap();
        let farthest = sheet.size.extent.unwrap().radius.1;
        assert!((farthest - reach).abs() < 2e-3, "{name}: {farthest} m, not {reach} m");
    }
}

/// Cells of the kinematic families, one per family.
const FAMILIES: [&str; 8] =
    ["five_axis", "offset_wrist", "palletizer", "panda", "scara", "track", "ur", "wrist"];

#[test]
fn cells_of_the_families_start_without_overlap_and_collision() {
    for family in FAMILIES {
        let name = format!("{family}_cell.toml");
        let loaded =
            crate::common::load_from(&root().join("cells"), &name).unwrap_or_else(|f| panic!("{f:#?}"));
        assert!(loaded.warnings.is_empty(), "{name}: {:#?}", loaded.warnings);
        let (cell, start) = (&loaded.cell, loaded.cell.start());
        let mut overlaps = Vec::new();
        FloorPlan::new(cell).overlaps(&start, &mut overlaps);
        assert!(overlaps.is_empty(), "{name}: {overlaps:?}");
        let (scene, mut placed, chain) = (Scene::new(cell), PlacedSolids::default(), Chain::new(&cell.robot));
        scene.place(&start, &mut placed);
        let frames = chain.frames(&chain.posture(&cell.robot.home));
        assert_eq!(scene.hit(&placed, &frames.links, None), None, "{name} at home");
    }
}

/// The axial offsets of almost parallel axes are huge, but the arm reaches no farther.
#[test]
fn the_reach_of_almost_parallel_axes_is_bounded_tightly() {
    let (_, mut robot) = crate::common::robots().into_iter().find(|(name, _)| name == "ur10").unwrap();
    let nominal = robot.reach();
    let (tilt, far) = (1e-3, 500.0);
    robot.joints[1].alpha += tilt;
    robot.joints[1].r += far;
    robot.joints[2].r -= far * f64::cos(tilt);
    let chain = sweetspot::robot::Chain::new(&robot);
    let farthest = (0..5000)
        .map(|k| chain.forward(&chain.posture(&chain.halton_sample(k))).translation.xy().norm())
        .fold(0.0, f64::max);
    let reach = robot.reach();
    // The tilt moves the axes apart by half a metre.
    assert!(reach >= farthest && reach < nominal + 1.2 * far * tilt, "{reach} m, {farthest} m reached");
}
