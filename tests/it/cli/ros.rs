//! Tests the exports for ROS: a static URDF, read by the project's own reader, and a planning scene of
//! MoveIt.

use crate::cli::sandbox::*;
use crate::common::load_from;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use sweetspot::cell::{Cell, LinkSolid, Robot, Shape};
use sweetspot::files::load_robot;
use sweetspot::pose::Pose;
use sweetspot::robot::Chain;

/// Cell with every kind of shape, a fence, a keep-out box, and a rotated and displaced robot on a pedestal.
const ROS_CELL: &str = r#"from = "hitachi_cell.toml"
name = "A & B -- <cell>"
[robot]
base = { x_mm = 40, y_mm = -30, z_mm = 100, yaw_deg = 20 }
[obstacle."2 lamps"]
solid = [
  { name = "lamp", sphere = { centre_mm = [0, 0, 1900], radius_mm = 80 } },
  { name = "pole", cylinder = { a_mm = [10, 0, 0], b_mm = [0, 50, 1800], radius_mm = 20 } },
  { name = "arm", capsule = { a_mm = [0, 0, 1800], b_mm = [200, 100, 1700], radius_mm = 15 } },
  { name = "foot", box = { centre_mm = [0, 0, 50], size_mm = [200, 300, 100], rpy_deg = [0, 0, 30] } },
]
placement = { x_mm = -1500, y_mm = 1500, z_mm = 0, yaw_deg = -70 }
[keep_out.door]
min_mm = [1700, 1500, 0]
max_mm = [1900, 1900, 1000]
[fence]
polygon_mm = [[-3000, -3000], [3000, -3000], [3000, 3000], [-3000, 3000]]
height_mm = 2000
"#;

/// Robot file of the arm that is mounted on the link `robot_base` of the exported URDF.
const ARM: &str = r#"schema = "sweetspot/robot/1"
units = { length = "mm", angle = "deg" }
name = "arm in its cell"
source = "a test"
urdf = "whole.urdf"
base_link = "world"
tip_link = "tool"
[tool]
position_mm = [0, 0, 0]
axis = [1, 0, 0]
[footprint]
size_mm = [9000, 9000]
[errors.none]
kind = "signed"
source = "a test"
dr_mm = [0, 0, 0, 0]
dl_mm = [0, 0, 0, 0]
dalpha_deg = [0, 0, 0, 0]
"#;

fn exported(shop: &Sandbox) -> Cell {
    shop.write("cells/ros.toml", ROS_CELL);
    shop.done(&["export", "cells/ros.toml", "--to", "urdf", "-o", "cells/ros.urdf"]);
    shop.done(&["export", "cells/ros.toml", "--to", "moveit", "-o", "ros.scene"]);
    load_from(&shop.path("cells"), "ros.toml").unwrap().cell
}

/// Reads the exported URDF with the arm joined to the link `robot_base`.
fn with_arm(shop: &Sandbox) -> Robot {
    let cell = shop.text("cells/ros.urdf");
    let arm = shop.text("cells/robots/hitachi_pw10.urdf");
    let links = &arm[arm.find("<link").unwrap()..arm.find("</robot>").unwrap()];
    let joint = "<joint name=\"mounted\" type=\"fixed\"><parent link=\"robot_base\"/><child link=\"base\"/></joint>\n";
    shop.write("cells/whole.urdf", &cell.replace("</robot>", &format!("{joint}{links}</robot>")));
    shop.write("cells/arm.toml", ARM);
    let mut read = |path: &str| Ok(shop.read(&format!("cells/{path}")));
    load_robot("arm.toml", &mut read).unwrap_or_else(|faults| panic!("{faults:#?}")).robot
}

/// Returns the solids of a link that are fixed to the world.
fn of_link<'r>(robot: &'r Robot, link: &str) -> Vec<&'r Shape> {
    let own = |s: &&LinkSolid| s.link == 0 && s.solid.name.split(" #").next() == Some(link);
    robot.solids.iter().filter(own).map(|s| &s.solid.shape).collect()
}

fn near_vector(a: &Vector3<f64>, b: &Vector3<f64>, by: f64) -> bool {
    (a - b).amax() < by
}

fn is_box(shape: &Shape, pose: &Pose, size: [f64; 3]) -> bool {
    let Shape::Box { pose: found, size: edges } = shape else { return false };
    let same_pose = (found.rotation - pose.rotation).amax() < 1e-10;
    same_pose
        && near_vector(&found.translation, &pose.translation, 1e-10)
        && near_vector(edges, &size.into(), 1e-10)
}

#[test]
fn a_urdf_of_the_layout_is_read_back_with_its_poses() {
    let shop = Sandbox::new();
    let cell = exported(&shop);
    let robot = with_arm(&shop);
    let layout = cell.start();
    // The arm is at the base of the cell, so its tool has the same poses.
    let (base, own, whole) = (layout.base.pose(), Chain::new(&cell.robot), Chain::new(&robot));
    for k in 0..20 {
        let joints = own.halton_sample(k);
        let expected = base * own.forward(&own.posture(&joints));
        let found = whole.forward(&whole.posture(&joints));
        assert!((found.rotation - expected.rotation).amax() < 1e-9, "{found:?} {expected:?}");
        assert!(near_vector(&found.translation, &expected.translation, 1e-9), "{found:?} {expected:?}");
    }
    for (equipment, at) in cell.equipment.iter().zip(&layout.placements) {
        let name = equipment.name.replace("2 lamps", "object_2_lamps");
        let read = of_link(&robot, &name);
        let mut read = read.iter();
        let pose = at.pose();
        for solid in &equipment.solids {
            match (solid.shape.clone().seen_from(&pose), *read.next().unwrap()) {
                (Shape::Box { pose, size }, found) => assert!(is_box(found, &pose, size.into()), "{found:?}"),
                (Shape::Sphere { centre, radius }, Shape::Sphere { centre: c, radius: r }) => {
                    assert!(near_vector(&centre, c, 1e-10) && radius == *r);
                }
                (Shape::Cylinder { a, b, radius }, Shape::Cylinder { a: p, b: q, radius: r }) => {
                    assert!(
                        near_vector(&a, p, 1e-10) && near_vector(&b, q, 1e-10) && radius == *r,
                        "{a} {p}"
                    );
                }
                (Shape::Capsule { a, b, radius }, Shape::Cylinder { a: p, b: q, radius: r }) => {
                    assert!(near_vector(&a, p, 1e-10) && near_vector(&b, q, 1e-10) && radius == *r);
                    for end in [a, b] {
                        let Shape::Sphere { centre, radius: r } = *read.next().unwrap() else {
                            panic!("no end")
                        };
                        assert!(near_vector(&end, centre, 1e-10) && radius == *r);
                    }
                }
                (Shape::Leg { x, y, size, top }, found) => {
                    // The leg reaches from the floor at height 0 up to its top.
                    let height = at.z + top;
                    let middle = pose.transform(&Vector3::new(x, y, 0.0));
                    let centre = Pose { translation: Vector3::new(middle.x, middle.y, height / 2.0), ..pose };
                    assert!(is_box(found, &centre, [size.0, size.1, height]), "{found:?}");
                }
                (
                    Shape::Mesh { pose, vertices, triangles, closed },
                    Shape::Mesh { pose: own, vertices: corners, triangles: faces, closed: shut },
                ) => {
                    assert_eq!((triangles.len(), closed), (faces.len(), *shut));
                    for (t, f) in triangles.iter().zip(faces) {
                        for (i, j) in t.iter().zip(f) {
                            let [a, b] = [
                                pose.transform(&vertices[*i as usize]),
                                own.transform(&corners[*j as usize]),
                            ];
                            assert!(near_vector(&a, &b, 2e-7), "{a} {b}");
                        }
                    }
                }
                (shape, found) => panic!("{shape:?} became {found:?}"),
            }
        }
        assert!(read.next().is_none(), "{name} has too many solids");
    }
    // The pedestal of the robot, a wall of the fence and the keep-out box.
    let pedestal = of_link(&robot, "robot_base");
    let below = base * Pose { translation: Vector3::new(0.0, 0.0, -0.05), ..Pose::IDENTITY };
    assert!(pedestal.len() == 1 && is_box(pedestal[0], &below, [0.6, 0.6, 0.1]), "{pedestal:?}");
    let wall = Pose { translation: Vector3::new(0.0, -3.0, 1.0), ..Pose::IDENTITY };
    assert!(is_box(of_link(&robot, "fence_1")[0], &wall, [6.0, 0.01, 2.0]));
    let door = Pose { translation: Vector3::new(1.8, 1.7, 0.5), ..Pose::IDENTITY };
    assert!(is_box(of_link(&robot, "keep_out_door")[0], &door, [0.2, 0.4, 1.0]));
}

#[test]
fn spots_are_frames_of_the_urdf() {
    let shop = Sandbox::new();
    exported(&shop);
    let map = shop.json(&["map", "cells/ros.toml"]);
    let urdf = shop.text("cells/ros.urdf");
    let document = roxmltree::Document::parse(&urdf).unwrap();
    let origin = |child: &str| {
        let joint = document.descendants().find(|n| {
            n.has_tag_name("joint")
                && n.children().any(|c| c.has_tag_name("child") && c.attribute("link") == Some(child))
        });
        let joint = joint.unwrap_or_else(|| panic!("no joint to {child}"));
        let of = |name: &str| {
            let origin = joint.children().find(|c| c.has_tag_name("origin")).unwrap();
            let words = origin.attribute(name).unwrap().split(' ');
            let v: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
            Vector3::new(v[0], v[1], v[2])
        };
        Pose::from_translation_rpy(of("xyz"), of("rpy"))
    };
    let mut tried = 0;
    for operation in items(&map["operations"]) {
        if operation["best"].is_null() {
            continue;
        }
        let tcp =
            origin(text(&operation["equipment"])) * origin(&format!("spot_{}", text(&operation["name"])));
        let expected = numbers(&operation["best"]["position_mm"]);
        assert!(
            (0..3).all(|k| (tcp.translation[k] - expected[k] / 1e3).abs() < 1e-9),
            "{tcp:?} {expected:?}"
        );
        // The tool of this robot points along the x axis of its TCP, which here points down.
        assert!((tcp.rotation.column(0) + Vector3::z()).amax() < 1e-9, "{tcp:?}");
        tried += 1;
    }
    assert!(tried > 0, "no spot at all");
    // With a prefix, the meshes are files of a ROS package.
    shop.done(&[
        "export",
        "cells/ros.toml",
        "--to",
        "urdf",
        "--meshes",
        "package://my_cell/meshes",
        "-o",
        "p.urdf",
    ]);
    assert!(
        shop.text("p.urdf").contains("filename=\"package://my_cell/meshes/machine_"),
        "{}",
        shop.text("p.urdf")
    );
    let ran = shop.run(&["export", "cells/ros.toml", "--to", "dxf", "--meshes", "m"]);
    assert!(ran.code == Some(2) && ran.err.contains("--meshes needs --to urdf"), "{}", ran.err);
}

/// Object of a planning scene: name, pose, shapes (kind, numbers, pose), subframes.
type Scene = Vec<(String, Pose, Vec<(String, Vec<f64>, Pose)>, Vec<(String, Pose)>)>;

/// Reads a planning scene as MoveIt does: words are separated by white space, but names are on separate
/// lines.
fn scene(text: &str) -> Scene {
    let mut lines = text.lines().skip(1);
    fn list(line: Option<&str>) -> Vec<f64> {
        line.unwrap().split(' ').map(|w| w.parse().unwrap()).collect()
    }
    fn pose<'l>(lines: &mut impl Iterator<Item = &'l str>) -> Pose {
        let (at, q) = (list(lines.next()), list(lines.next()));
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2]));
        assert!((q.iter().map(|v| v * v).sum::<f64>() - 1.0).abs() < 1e-9);
        Pose {
            rotation: turn.to_rotation_matrix().into_inner(),
            translation: Vector3::new(at[0], at[1], at[2]),
        }
    }
    let mut all = Scene::new();
    loop {
        let line = lines.next().unwrap();
        if line == "." {
            assert_eq!(lines.next(), None);
            return all;
        }
        let name = line.strip_prefix("* ").unwrap().to_string();
        let at = pose(&mut lines);
        let mut shapes = Vec::new();
        for _ in 0..list(lines.next())[0] as usize {
            let kind = lines.next().unwrap().to_string();
            let mut sizes = list(lines.next());
            if kind == "mesh" {
                let count = sizes[0] + sizes[1];
                (0..count as usize).for_each(|_| sizes.extend(list(lines.next())));
            }
            shapes.push((kind, sizes, pose(&mut lines)));
            assert_eq!(lines.next(), Some("0 0 0 0"));
        }
        let frames = (0..list(lines.next())[0] as usize)
            .map(|_| (lines.next().unwrap().to_string(), pose(&mut lines)));
        let frames = frames.collect();
        all.push((name, at, shapes, frames));
    }
}

#[test]
fn a_planning_scene_has_the_solids_of_the_urdf_in_the_frame_of_the_robot_base() {
    let shop = Sandbox::new();
    let cell = exported(&shop);
    let robot = with_arm(&shop);
    let base = cell.start().base.pose();
    let text = shop.text("ros.scene");
    assert!(
        text.starts_with("A & B -- <cell> (layout as drawn, in the frame of the robot base)\n* pedestal\n")
    );
    let objects = scene(&text);
    let mut compared = 0;
    for (name, at, shapes, _) in &objects {
        let link = if name == "pedestal" { "robot_base" } else { name };
        let solids = of_link(&robot, link);
        assert_eq!(solids.len(), shapes.len(), "{name}");
        for ((kind, sizes, pose), solid) in shapes.iter().zip(solids) {
            let in_world = base * *at * *pose;
            let centre = in_world.translation;
            match solid {
                Shape::Box { .. } => {
                    assert!(
                        kind == "box" && is_box(solid, &in_world, [sizes[0], sizes[1], sizes[2]]),
                        "{name}"
                    );
                }
                Shape::Sphere { centre: c, radius } => {
                    assert!(kind == "sphere" && sizes == &[*radius] && near_vector(c, &centre, 1e-10));
                }
                Shape::Cylinder { a, b, radius } => {
                    let half = in_world.rotation * Vector3::new(0.0, 0.0, sizes[1] / 2.0);
                    assert!(kind == "cylinder" && sizes[0] == *radius);
                    assert!(
                        near_vector(b, &(centre + half), 1e-10) && near_vector(a, &(centre - half), 1e-10)
                    );
                }
                Shape::Mesh { vertices, triangles, pose, .. } => {
                    let count = (sizes[0] as usize, sizes[1] as usize);
                    assert_eq!((kind.as_str(), count.1), ("mesh", triangles.len()));
                    let corner =
                        |i: usize| Vector3::new(sizes[2 + 3 * i], sizes[3 + 3 * i], sizes[4 + 3 * i]);
                    for (k, t) in triangles.iter().enumerate() {
                        for (c, i) in t.iter().enumerate() {
                            let own = sizes[2 + 3 * count.0 + 3 * k + c] as usize;
                            let [a, b] =
                                [in_world.transform(&corner(own)), pose.transform(&vertices[*i as usize])];
                            assert!(near_vector(&a, &b, 2e-7), "{a} {b}");
                        }
                    }
                }
                other => panic!("{other:?}"),
            }
            compared += 1;
        }
    }
    assert!(compared > 15, "only {compared} shapes");
    let frames: Vec<_> = objects.iter().flat_map(|o| &o.3).map(|f| f.0.as_str()).collect();
    assert!(!frames.is_empty() && frames.iter().all(|f| f.starts_with("spot_")), "{frames:?}");
}
