//! Tests hostile URDFs. They are refused with a located message or read validly, with little memory, and only
//! named files are opened.

use crate::common::root;
use crate::urdf::product::load;
use std::collections::BTreeMap;
use sweetspot::files::Fault;

/// Returns a valid URDF with every kind of element.
fn good() -> String {
    std::fs::read_to_string(root().join("cells/robots/hitachi_pw10.urdf")).unwrap()
}

/// Loads a URDF with 4 axes, and asserts the properties that every text must have. Returns whether it was
/// accepted, and the faults.
fn tame(what: &str, urdf: &str) -> (bool, Vec<Fault>) {
    let mut loaded = None;
    let used = allocation_counter::measure(|| loaded = Some(load(urdf, 4, "tip_link = \"tool\"")));
    let (result, paths) = loaded.unwrap();
    let most = 4 * urdf.len() as u64 + (64 << 20);
    assert!(used.bytes_max <= most, "{what}: {} bytes for {}", used.bytes_max, urdf.len());
    let named =
        ["cell.toml", "hitachi_paper.toml", "arm.toml", "robots/arm.urdf", "equipment/worktable.toml"];
    assert!(paths.iter().all(|p| named.contains(&p.as_str())), "{what}: {paths:?}");
    let (taken, faults) = match result {
        Ok(loaded) => (true, loaded.warnings),
        Err(faults) => (false, faults),
    };
    assert_eq!(taken, !faults.iter().any(Fault::is_error), "{what}");
    for fault in &faults {
        let of_file = if fault.file == "robots/arm.urdf" { urdf.lines().count() } else { usize::MAX - 1 };
        assert!(fault.line >= 1 && fault.column >= 1 && fault.line <= of_file + 1, "{what}: {fault:?}");
        let shown = fault.to_string();
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n') && shown.len() < 3000, "{what}: {shown}");
        assert!(!fault.help.is_empty() && !fault.message.is_empty(), "{what}: {shown}");
    }
    (taken, faults)
}

#[test]
fn the_valid_urdf_is_accepted() {
    let (taken, faults) = tame("good", &good());
    assert!(taken && faults.is_empty(), "{faults:#?}");
}

/// A truncated file is not XML, unless only trailing text is missing.
#[test]
fn truncated_urdf_files_are_refused() {
    let good = good();
    let mut files = 0;
    for cut in (0..good.trim_end().len()).step_by(41) {
        let (taken, faults) = tame(&format!("cut at {cut}"), &good[..cut]);
        assert!(!taken && faults.len() == 1, "cut at {cut}: {faults:#?}");
        files += 1;
    }
    assert!(files >= 80, "{files}");
}

/// Any byte may be removed, doubled or changed. Every result keeps the invariants.
#[test]
fn mutated_urdf_files_never_panic() {
    let good = good();
    let mut refused = 0;
    for (k, at) in (0..good.len()).step_by(29).enumerate() {
        let (before, after) = good.split_at(at);
        let scratched = match k % 4 {
            0 => format!("{before}{}", &after[1..]),
            1 => format!("{before}{}{after}", &after[..1]),
            2 => format!("{before}<{after}"),
            _ => format!("{before}9{after}"),
        };
        refused += usize::from(!tame(&format!("scratched at {at}"), &scratched).0);
    }
    assert!(refused > 50, "{refused}");
}

fn joints(n: usize, kind: &str) -> String {
    let joint = |k| {
        format!(
            "<joint name=\"j{k}\" type=\"{kind}\"><parent link=\"l{k}\"/><child link=\"l{}\"/>\
             <limit lower=\"-1\" upper=\"1\"/></joint>",
            k + 1
        )
    };
    let links: String = (0..=n).map(|k| format!("<link name=\"l{k}\"/>")).collect();
    format!("<robot name=\"x\">{links}{}</robot>", (0..n).map(joint).collect::<String>())
}

/// Returns hostile texts with their expected messages.
fn hostile() -> BTreeMap<&'static str, (String, &'static str)> {
    let good = good();
    let swap = |what: &str, with: &str| {
        assert!(good.contains(what), "{what}");
        good.replacen(what, with, 1)
    };
    let first = "<axis xyz=\"0 0 1\"/>";
    let lol: String =
        (1..10).map(|k| format!("<!ENTITY l{k} \"{}\">", format!("&l{};", k - 1).repeat(10))).collect();
    let bomb = format!("<!DOCTYPE r [<!ENTITY l0 \"lol\">{lol}]><robot name=\"&l9;\"/>");
    let spaces: String = (0..2000).map(|k| format!("<a xmlns:n{k}=\"u{k}\"/>")).collect();
    let attributes: String = (0..5000).map(|k| format!(" a{k}=\"\"")).collect();
    let file = "<!DOCTYPE r [<!ENTITY f SYSTEM \"file:///etc/passwd\">]><robot name=\"&f;\"/>";
    let cases: Vec<(&'static str, String, &'static str)> = vec![
        ("nested", format!("<robot>{}", "<a>".repeat(20_000)), "nested more than"),
        (
            "nested and closed",
            format!("<robot>{}{}</robot>", "<a>".repeat(900), "</a>".repeat(900)),
            "nested more than",
        ),
        ("entities", bomb, "document type"),
        ("outer entity", file.into(), "document type"),
        ("outer type", format!("<!DOCTYPE robot SYSTEM \"http://x/y.dtd\">{good}"), "document type"),
        ("unknown entity", swap("base\">", "&boom;\">"), "not XML"),
        ("many tags", format!("<robot>{}</robot>", "<a/>".repeat(200_000)), "more than 150000 tags"),
        ("many signs", format!("<robot>{}</robot>", "=".repeat(400_000)), "more than 300000 attributes"),
        ("large", format!("<robot>{}</robot>", " ".repeat(5_000_000)), "more than 4000000 bytes"),
        ("namespaces", format!("<robot>{spaces}</robot>"), "namespaces"),
        ("attributes", format!("<robot{attributes}/>"), "attributes"),
        (
            "long name",
            swap("name=\"base\"", &format!("name=\"{}\"", "x".repeat(100_000))),
            "a tag has more than",
        ),
        ("100 000 joints", joints(100_000, "revolute"), "more than"),
        ("1 100 joints", joints(1_100, "fixed"), "more than 1000 links"),
        ("nine moving", joints(9, "revolute").replace("l9", "tool"), "has 9 moving joints"),
        ("none moving", joints(9, "fixed").replace("l9", "tool"), "no joint between base and tip link moves"),
        ("huge", swap(first, "<axis xyz=\"0 0 1e400\"/>"), "must be finite"),
        ("large number", swap(first, "<axis xyz=\"0 0 1e9\"/>"), "must be finite"),
        ("nan", swap(first, "<axis xyz=\"nan 0 1\"/>"), "must be finite"),
        ("inf", swap(first, "<axis xyz=\"0 -inf 1\"/>"), "must be finite"),
        ("words", swap(first, "<axis xyz=\"a b c\"/>"), "is not a number"),
        ("macro", swap(first, "<axis xyz=\"${a} 0 1\"/>"), "is not a number"),
        ("two numbers", swap(first, "<axis xyz=\"0 1\"/>"), "must be 3 numbers"),
        ("four numbers", swap(first, "<axis xyz=\"0 0 0 1\"/>"), "must be 3 numbers"),
        (
            "million numbers",
            swap(first, &format!("<axis xyz=\"{}\"/>", "0 ".repeat(1500))),
            "must be 3 numbers",
        ),
        ("empty numbers", swap(first, "<axis xyz=\"\"/>"), "must be 3 numbers"),
        ("no numbers", swap(first, "<axis/>"), "has no `xyz`"),
        ("two axes", swap(first, "<axis xyz=\"0 0 1\"/><axis xyz=\"1 0 0\"/>"), "a second <axis>"),
        ("no parent", swap("<parent link=\"base\"/>", ""), "no <parent>"),
        ("parent of nothing", swap("<parent link=\"base\"/>", "<parent/>"), "has no `link`"),
        ("two parents", swap("<child link=\"hand\"/>", "<child link=\"turret\"/>"), "already the child"),
        ("circle", swap("<parent link=\"base\"/>", "<parent link=\"tool\"/>"), "is its own ancestor"),
        ("self", swap("<parent link=\"base\"/>", "<parent link=\"turret\"/>"), "is its own ancestor"),
        ("island", swap("</robot>", "<link name=\"island\"/></robot>"), "without a parent joint"),
        ("joint twice", swap("\"q2 (upper arm)\"", "\"q1 (waist)\""), "two joints"),
        ("link twice", swap("<link name=\"hand\">", "<link name=\"base\">"), "two links"),
        ("no name", swap("<link name=\"hand\">", "<link>"), "has no `name`"),
        ("escapes", swap("name=\"q1 (waist)\"", "name=\"&#x1b;[2J\""), "not XML"),
        ("bidi", swap("name=\"q1 (waist)\"", "name=\"&#x202e;abc\""), "cannot be a name"),
        ("no sphere", swap("sphere radius=\"0.15\"", "sphere radius=\"0\""), "greater than 0"),
        ("inside out", swap("box size=\"0.5", "box size=\"-0.5"), "greater than 0"),
        ("in mm", swap("box size=\"0.5 0.5 0.3\"", "box size=\"500 500 300\""), "larger than 20 m"),
        ("no geometry", swap("<geometry><box size=\"0.5 0.5 0.3\"/></geometry>", ""), "has no shape"),
        ("torus", swap("<box size=\"0.5 0.5 0.3\"/>", "<torus/>"), "is not a collision shape"),
        (
            "mesh up",
            swap("<box size=\"0.5 0.5 0.3\"/>", "<mesh filename=\"../../x.stl\"/>"),
            "leaves the folder",
        ),
        ("mesh root", swap("<box size=\"0.5 0.5 0.3\"/>", "<mesh filename=\"/etc/x.stl\"/>"), "absolute"),
        (
            "mesh out",
            swap("<box size=\"0.5 0.5 0.3\"/>", "<mesh filename=\"package://a/../../x\"/>"),
            "of a package",
        ),
        (
            "mesh process",
            swap("<box size=\"0.5 0.5 0.3\"/>", "<mesh filename=\"$(find a)/../../../x\"/>"),
            "leaves the folder",
        ),
        ("empty", String::new(), "not XML"),
        ("zeros", "\0".repeat(100), "not XML"),
        ("not XML", "schema = 1".into(), "not XML"),
        ("other XML", "<sdf version=\"1.6\"/>".into(), "not a <robot>"),
        ("no link", "<robot name=\"x\"/>".into(), "no link"),
        ("two roots", format!("{good}<robot/>"), "not XML"),
        ("open quote", swap("name=\"base\">", "name=\"base>"), ""),
        ("open comment", swap("<!--", "<!-- <!--"), ""),
        ("open CDATA", swap("</robot>", "<![CDATA[</robot>"), "not XML"),
        ("xacro", swap("<link name=\"tool\"/>", "<x:arm xmlns:x=\"http://ros.org/wiki/xacro\"/>"), "xacro"),
    ];
    cases.into_iter().map(|(what, text, told)| (what, (text, told))).collect()
}

#[test]
fn hostile_urdf_files_are_refused_with_the_reason() {
    let cases = hostile();
    assert!(cases.len() > 50);
    for (what, (text, told)) in cases {
        let (taken, faults) = tame(what, &text);
        assert!(!taken || told.is_empty(), "{what} is taken");
        assert!(faults.iter().any(|f| f.message.contains(told)) || told.is_empty(), "{what}: {faults:#?}");
        assert!(faults.len() < 20, "{what}: {} faults", faults.len());
    }
}

/// A file that cannot be read as text, because it is missing or has another encoding, is reported at the line
/// that names it.
#[test]
fn unreadable_files_are_reported_where_they_are_named() {
    let robot = "from = \"hitachi_paper.toml\"\n[robot]\nurdf = \"a.urdf\"\n";
    let faults = sweetspot::files::load("cell.toml", &mut |path: &str| match path {
        "cell.toml" => Ok(robot.into()),
        "a.urdf" => Ok(vec![0xff, 0xfe, 0x3c]),
        _ => std::fs::read(root().join("cells").join(path)).map_err(|e| e.to_string()),
    });
    let faults = faults.unwrap_err();
    let told = faults.iter().find(|f| f.message.contains("UTF-8")).unwrap();
    assert_eq!((told.file.as_str(), told.line, told.column), ("cell.toml", 3, 8));
}
