//! Tests the messages about a URDF that is wrong or unusual, or has unused elements.

use crate::urdf::product::load;
use sweetspot::cell::Shape;
use sweetspot::files::{Fault, Severity};
use sweetspot::robot::Chain;

/// URDF of a base, two arms and a tool; `$` marks what a test replaces.
const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/><limit lower="-1" upper="2"/></joint>
<link name="upper"/>
<joint name="j2" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5"/></joint>
<link name="lower"/>
<joint name="hold" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="0.3 0 0"/></joint>
<link name="tool"/>
</robot>"#;

/// Returns the faults of the URDF itself after replacements.
fn faults(replace: &[(&str, &str)], lines: &str) -> Vec<Fault> {
    let mut text = ARM.to_string();
    for (what, with) in replace {
        assert!(text.contains(what), "{what}");
        text = text.replacen(what, with, 1);
    }
    match load(&text, 2, lines).0 {
        Ok(loaded) => loaded.warnings,
        Err(faults) => faults,
    }
}

/// Asserts that there is one error with the given message and help, at the line and column where `word`
/// starts.
fn one(replace: &[(&str, &str)], (line, word): (usize, &str), message: &str, help: &str) {
    let faults = faults(replace, "");
    let [fault] = &faults[..] else { panic!("{faults:#?}") };
    assert_eq!((fault.file.as_str(), fault.severity), ("robots/arm.urdf", Severity::Error), "{fault}");
    let text = replace.iter().fold(ARM.to_string(), |text, (what, with)| text.replacen(what, with, 1));
    let column = text.lines().nth(line - 1).unwrap().find(word).unwrap() + 1;
    assert_eq!((fault.line, fault.column), (line, column), "{fault}");
    assert!(fault.message.contains(message) && fault.help.contains(help), "{fault}");
}

#[test]
fn the_unchanged_urdf_is_valid() {
    assert_eq!(faults(&[], ""), []);
}

#[test]
fn joint_limits_of_a_urdf_are_checked() {
    let limit = r#"<limit lower="-1" upper="2"/>"#;
    one(&[(limit, "")], (3, "j1\""), "`j1` has no limits", "0 to 0");
    one(&[(limit, "<limit effort=\"1\"/>")], (3, "j1\""), "`j1` has no limits", "0 to 0");
    one(&[(limit, "<limit lower=\"2\" upper=\"1\"/>")], (3, "<limit"), "2 is above 1", "swap");
    one(
        &[(limit, "<limit lower=\"-9999\" upper=\"1\"/>")],
        (3, "<limit"),
        "is too far from 0: 9999, more than 1000",
        "degrees",
    );
    let warned = faults(&[(limit, "<limit lower=\"-170\" upper=\"170\"/>")], "");
    assert!(warned.len() == 1 && !warned[0].is_error() && warned[0].help.contains("degrees"), "{warned:#?}");
    let turning = faults(&[("\"revolute\"", "\"continuous\"")], "");
    assert!(turning.len() == 1 && !turning[0].is_error(), "{turning:#?}");
    assert!(turning[0].message.contains("-360 and 360"), "{turning:#?}");
}

#[test]
fn joint_speeds_of_a_urdf_are_checked() {
    let limit = r#"<limit lower="-1" upper="2"/>"#;
    let with = |velocity: &str| format!("<limit lower=\"-1\" upper=\"2\" velocity=\"{velocity}\"/>");
    one(&[(limit, &with("-2"))], (3, "-2\"/>"), "`velocity` must be greater than 0, not -2", "rad/s");
    one(&[(limit, &with("fast"))], (3, "fast"), "`fast` in `velocity` is not a number", "plain numbers");
    one(&[(limit, &with("nan"))], (3, "nan"), "`velocity` must be finite", "nan and inf");
    // Many exporters write 0, because the format requires the attribute.
    assert_eq!(faults(&[(limit, &with("0"))], ""), []);
    assert_eq!(faults(&[(limit, &with("3.14"))], ""), []);
    let warned = faults(&[(limit, &with("180"))], "");
    assert!(
        warned.len() == 1 && !warned[0].is_error() && warned[0].help.contains("degrees/s"),
        "{warned:#?}"
    );
}

#[test]
fn joint_speeds_of_a_urdf_are_read_and_overridden() {
    let limit = r#"<limit lower="-1" upper="2"/>"#;
    let text = ARM.replacen(limit, r#"<limit lower="-1" upper="2" effort="9" velocity="3.5"/>"#, 1);
    let rates = |lines: &str| -> Vec<[Option<f64>; 2]> {
        let loaded = load(&text, 2, lines).0.unwrap_or_else(|faults| panic!("{faults:#?}"));
        let joints = loaded.cell.robot.joints.iter();
        joints.map(|joint| [joint.rates.velocity, joint.rates.acceleration]).collect()
    };
    assert_eq!(rates(""), [[Some(3.5), None], [None, None]]);
    let acceleration = "rate = [{ joint = \"j1\", max_acceleration_deg_s2 = 180 }]";
    assert_eq!(rates(acceleration), [[Some(3.5), Some(std::f64::consts::PI)], [None, None]]);
    let faster = "rate = [{ joint = 1, max_velocity_deg_s = 90 }]\nfull_speed_after_s = 0.25";
    assert_eq!(rates(faster), [[Some(std::f64::consts::FRAC_PI_2), None], [None, None]]);
}

#[test]
fn the_tree_of_a_urdf_is_checked() {
    one(
        &[("<child link=\"lower\"", "<child link=\"lowr\"")],
        (5, "lowr"),
        "no link `lowr`",
        "did you mean `lower`",
    );
    one(
        &[("<child link=\"tool\"", "<child link=\"lower\"")],
        (7, "lower\"/><origin"),
        "already the child of joint `j2`",
        "loop",
    );
    one(
        &[("<parent link=\"base\"", "<parent link=\"tool\"")],
        (3, "j1\""),
        "`upper` is its own ancestor",
        "break",
    );
    one(
        &[("link name=\"tool\"", "link name=\"base\""), ("child link=\"tool\"", "child link=\"base\"")],
        (8, "base\""),
        "two links",
        "rename",
    );
    let two = faults(
        &[(
            "</robot>",
            "<link name=\"cable\"/><joint name=\"c\" type=\"fixed\"><parent link=\"upper\"/><child link=\"cable\"/></joint></robot>",
        )],
        "",
    );
    assert!(two.len() == 1 && two[0].file == "arm.toml" && two[0].help.ends_with("tool, cable"), "{two:#?}");
    let wrong = faults(&[], "tip_link = \"toll\"");
    assert!(wrong.len() == 1 && wrong[0].file == "arm.toml", "{wrong:#?}");
    assert_eq!(wrong[0].help, "did you mean `tool`?");
    let turned = faults(&[], "tip_link = \"base\"\nbase_link = \"tool\"");
    assert!(turned[0].message.contains("is not a descendant of"), "{turned:#?}");
    let none = faults(&[], "base_link = \"lower\"");
    assert!(none[0].message.starts_with("no joint between base and tip link moves"), "{none:#?}");
}

#[test]
fn unreadable_joints_are_refused() {
    for kind in ["floating", "planar"] {
        one(
            &[("\"revolute\"", &format!("\"{kind}\""))],
            (3, "j1\""),
            &format!("`j1` is {kind}"),
            "only revolute",
        );
    }
    one(
        &[("\"revolute\"", "\"revolut\"")],
        (3, "revolut\""),
        "cannot be \"revolut\"",
        "did you mean \"revolute\"",
    );
    one(&[("xyz=\"0 0 0.5\"", "xyz=\"0 0 500\"")], (3, "<origin"), "500 m away", "in mm?");
    one(&[("xyz=\"0 0 0.5\"", "xyz=\"0 nan 0\"")], (3, "0 nan"), "must be finite", "not allowed");
    one(
        &[("xyz=\"0 0 0.5\"", "xzy=\"0 0 0.5\"")],
        (3, "xzy"),
        "unknown attribute `xzy`",
        "did you mean `xyz`",
    );
    one(&[("<axis xyz=\"0 0 1\"", "<axis xyz=\"0 0 0\"")], (3, "<axis"), "no direction", "0 0 1");
}

/// Faults do not hide each other.
#[test]
fn every_urdf_fault_is_reported_at_once() {
    let all = faults(
        &[
            ("xyz=\"0 0 0.5\"", "xyz=\"0 0\""),
            ("\"fixed\"", "\"fxed\""),
            ("<axis xyz=\"0 1 0\"", "<axis xyz=\"x 1 0\""),
        ],
        "",
    );
    assert_eq!(all.iter().map(|f| f.line).collect::<Vec<_>>(), [3, 5, 7], "{all:#?}");
}

#[test]
fn a_mimic_joint_follows_one_before_it() {
    let second = r#"<axis xyz="0 1 0"/>"#;
    let mimic =
        |joint: &str| format!("{second}<mimic joint=\"{joint}\" multiplier=\"-0.5\" offset=\"0.25\"/>");
    let text = ARM.replace(second, &mimic("j1"));
    let robot = load(&text, 2, "").0.unwrap().cell.robot;
    assert_eq!(robot.coupling, [[1.0, 0.0], [-0.5, 1.0]]);
    assert!(robot.joints[1].is_passive());
    // If all actuator coordinates are 0, the second joint has the coordinate 0.25 of the URDF, so the tip is
    // lower.
    let chain = Chain::new(&robot);
    let mut q = [0.0; 8];
    for (first, bend) in [(0.0, 0.25), (1.0, -0.25)] {
        q[0] = first;
        let tip = chain.forward(&chain.posture(&q)).translation;
        assert!((tip.z - (0.5 - 0.3 * f64::sin(bend))).abs() < 1e-15, "{tip}");
    }
    one(&[(second, &mimic("j3"))], (5, "j3\" mult"), "mimics `j3`, which does not precede it", "before it");
    one(&[(second, &mimic("j2"))], (5, "j2\" mult"), "mimics `j2`, which does not precede it", "before it");
}

#[test]
fn unused_urdf_elements_are_reported_once() {
    let more = "<visual/><visual/><inertial/></link>\n<gazebo/><transmission/><link name=\"off\"/>\n\
                <joint name=\"o\" type=\"floating\"><parent link=\"base\"/><child link=\"off\"/></joint>";
    let faults =
        faults(&[("<link name=\"upper\"/>", &format!("<link name=\"upper\">{more}"))], "tip_link = \"tool\"");
    assert_eq!(faults.len(), 1, "{faults:#?}");
    let told = "elements of this URDF that are not used: 1 links off the chain, 1 joints off the chain, 1 gazebo, 1 inertial, \
                1 transmission, 2 visual";
    assert_eq!((faults[0].message.as_str(), faults[0].severity), (told, Severity::Warning));
}

/// The angles 1.5707 (not a right angle) and 1e-5 rad (not 0) are used as the file states them, with a
/// warning.
#[test]
fn almost_parallel_and_perpendicular_axes_are_derived() {
    let parallel = [("<axis xyz=\"0 1 0\"", "<axis xyz=\"0 1e-5 1\"")];
    let faults_of = |replace: &[(&str, &str)]| faults(replace, "");
    let told = faults_of(&parallel);
    assert!(
        told.len() == 1 && told[0].message.contains("almost parallel: the deviation is 1.0e-5 rad"),
        "{told:#?}"
    );
    let told = faults_of(&[("xyz=\"0.4 0 0\"", "xyz=\"0.4 0 0\" rpy=\"1e-4 0 0\"")]);
    assert!(
        told.len() == 1 && told[0].message.contains("almost at right angles: the deviation is 1.0e-4 rad"),
        "{told:#?}"
    );
    let text = ARM.replace("<axis xyz=\"0 1 0\"", "<axis xyz=\"0 1e-4 1\"");
    let robot = load(&text, 2, "").0.unwrap().cell.robot;
    assert!((robot.joints[0].alpha.abs() - 1e-4).abs() < 1e-8, "{robot:#?}");
}

#[test]
fn rows_and_urdf_exclude_each_other() {
    let faults = faults(&[], "coupling = [[1, 0], [0, 1]]");
    assert!(
        faults.len() == 1 && faults[0].message.contains("`urdf` and `coupling` cannot be given together"),
        "{faults:#?}"
    );
}

/// A mesh in mm moves with its link. A URDF in robots/ can refer to the neighbouring folder equipment/.
#[test]
fn collision_meshes_are_read() {
    let mesh = "<mesh filename=\"../equipment/machine.stl\" scale=\"0.001 0.001 0.001\"/>";
    let link = format!("<link name=\"upper\"><collision><geometry>{mesh}</geometry></collision></link>");
    let text = ARM.replace("<link name=\"upper\"/>", &link);
    let robot = load(&text, 2, "").0.unwrap_or_else(|f| panic!("{f:#?}")).cell.robot;
    let meshes: Vec<_> = robot
        .solids
        .iter()
        .filter_map(|s| match &s.solid.shape {
            Shape::Mesh { vertices, triangles, .. } => Some((s.link, vertices, triangles.len())),
            _ => None,
        })
        .collect();
    let [(link, vertices, triangles)] = meshes[..] else { panic!("{} meshes", meshes.len()) };
    let size = vertices.iter().map(|v| v.amax()).fold(0.0, f64::max);
    assert!(link > 0 && (9_000..11_000).contains(&triangles) && size > 0.1 && size < 1.0, "{link} {size}");
}

#[test]
fn collision_meshes_are_named_and_their_paths_checked() {
    let mesh = |file: &str| {
        format!(
            "<link name=\"upper\"><collision><geometry><mesh filename=\"{file}\"/></geometry></collision></link>"
        )
    };
    for (file, shown) in [
        ("meshes/a.stl", "robots/meshes/a.stl"),
        ("../a.stl", "a.stl"),
        ("package://arm/b/../a.stl", "parts/arm/a.stl"),
        ("package://other/a.stl", "package://other/a.stl"),
    ] {
        let faults = faults(&[("<link name=\"upper\"/>", &mesh(file))], "packages = { arm = \"parts/arm\" }");
        assert!(faults.len() == 1 && faults[0].is_error() && faults[0].line == 4, "{faults:#?}");
        assert!(faults[0].message.starts_with(&format!("cannot read `{shown}`")), "{faults:#?}");
        assert_eq!(
            faults[0].help.contains("--package NAME=DIR"),
            shown.starts_with("package"),
            "{faults:#?}"
        );
    }
    for file in [
        "../../a.stl",
        "/etc/passwd",
        "file:///a.stl",
        "package://arm/../../a.stl",
        "package://../a.stl",
        "package://arm",
        "a\\b.stl",
    ] {
        let faults = faults(&[("<link name=\"upper\"/>", &mesh(file))], "packages = { arm = \"parts/arm\" }");
        assert!(faults.len() == 1 && faults[0].is_error() && faults[0].line == 4, "{file}: {faults:#?}");
    }
}
