//! Targets of the fuzzing: each parser with its seeds, its words, and the checks of everything that it
//! accepts.

use super::corpus::{OBJ, STL, files, keys_and_words, named_files, seed, words, words_of_json};
use crate::cli::sandbox::sha256;
use crate::common::root;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use sweetspot::cell::Cell;
use sweetspot::cli;
use sweetspot::files as cell_files;
use sweetspot::files::dxf::{PlanDrawing, bodies, outlines, text_of};
use sweetspot::files::measured;
use sweetspot::files::stated::{self, StatedCalibration};
use sweetspot::files::{Choices, Fault, Setting};
use sweetspot::layout::{Workcell, evaluate};
use sweetspot::mesh::{Triangles, Vertices, from_obj, from_stl, solidity};
use sweetspot::record::{ManifestDocument, SearchResult, SweepPlan, SweepRow};

/// Parser of bytes. The error is the reason of a rejection.
pub type Parse = dyn Fn(&[u8]) -> Result<(), String>;

/// Parser with its seeds and words.
pub struct Target {
    pub name: &'static str,
    pub seeds: Vec<Vec<u8>>,
    pub words: Vec<String>,
    pub parse: Box<Parse>,
}

/// Largest number of nodes of an accepted cell that is also evaluated.
const MAX_NODES: usize = 12;

/// Checks that a rejection has an error, and that every fault can be displayed and lies in its file.
fn checked<T>(result: Result<(T, Vec<Fault>), Vec<Fault>>, name: &str, input: &[u8]) -> Result<T, String> {
    let lines = input.split(|b| *b == b'\n').count();
    let (read, faults) = match result {
        Ok((read, warnings)) => (Some(read), warnings),
        Err(faults) => (None, faults),
    };
    assert_eq!(faults.iter().any(Fault::is_error), read.is_none(), "{faults:#?}");
    for fault in &faults {
        let is_setting = fault.line == 0 && fault.column == 0 && fault.file.starts_with("--set ");
        assert!(is_setting || fault.line >= 1 && fault.column >= 1, "{fault:?}");
        assert!(fault.file != name || fault.line <= lines + 1, "{fault:?}");
        let shown = fault.to_string();
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{shown:?}");
        assert!(shown.lines().count() <= 4 && shown.len() < 3000, "{shown}");
        assert!(!fault.help.is_empty() && !fault.message.is_empty(), "{shown}");
    }
    read.ok_or_else(|| faults.into_iter().find(Fault::is_error).map_or(String::new(), |fault| fault.message))
}

/// Evaluates an accepted cell with few nodes, and checks that every layout has a finite cost.
fn evaluated(cell: Cell) -> Result<(), String> {
    let nodes: usize = cell.operations.iter().map(|operation| operation.nodes()).sum();
    if nodes > MAX_NODES {
        return Ok(());
    }
    // If the robot cannot attain the attitude, the cell is refused with a reason.
    let workcell = Workcell::new(cell)?;
    let evaluation = evaluate(&workcell, &workcell.cell.start());
    assert!(evaluation.cost.is_finite(), "the cost is {}", evaluation.cost);
    assert!(evaluation.objective.is_none_or(|objective| objective.is_finite() && objective >= 0.0));
    Ok(())
}

/// Loads a cell from bytes in memory. `named` returns the files that the cell names.
fn load_cell(
    bytes: &[u8],
    settings: &[Setting],
    named: impl Fn(&str) -> Option<Vec<u8>>,
) -> Result<(Cell, Vec<Fault>), Vec<Fault>> {
    let loaded = cell_files::load_with("cell.toml", settings, &mut |path| match path {
        "cell.toml" => Ok(bytes.to_vec()),
        other => named(other).ok_or_else(|| "no such file".to_string()),
    });
    loaded.map(|loaded| (loaded.cell, loaded.warnings))
}

pub fn cell() -> Target {
    let named = named_files();
    let all = [("cells", ".toml"), ("tests/broken", ".toml"), ("tests/data", "_key.toml")];
    let mut seeds = vec![seed("cell.toml")];
    seeds.extend(all.iter().flat_map(|(folder, end)| files(folder, end)));
    let parse = move |input: &[u8]| {
        let loaded = load_cell(input, &[], |path| named.get(path).cloned());
        evaluated(checked(loaded, "cell.toml", input)?)
    };
    Target { name: "cell", seeds, words: keys_and_words(), parse: Box::new(parse) }
}

/// Loads a robot file from bytes in memory. The URDF that the file names is `urdf`, and all meshes are
/// [`OBJ`].
fn load_robot(bytes: &[u8], urdf: &[u8], checks: (&str, &[u8])) -> Result<(), String> {
    let loaded = cell_files::load_robot("robot.toml", &mut |path| {
        let mesh = if path.to_ascii_lowercase().ends_with(".stl") { STL } else { OBJ };
        Ok(match path {
            "robot.toml" => bytes.to_vec(),
            path if path.ends_with(".urdf") => urdf.to_vec(),
            _ => mesh.into(),
        })
    });
    checked(loaded.map(|loaded| ((), loaded.warnings)), checks.0, checks.1)
}

pub fn robot() -> Target {
    let urdf = seed("arm.urdf");
    let parse = move |input: &[u8]| {
        let is_robot = cell_files::is_robot("robot.toml", &mut |_| Ok(input.to_vec()));
        let answer = load_robot(input, &urdf, ("robot.toml", input));
        assert!(is_robot || answer.is_err(), "an accepted robot is not recognized as one");
        answer
    };
    let seeds = [files("cells/robots", ".toml"), vec![seed("robot.toml")]].concat();
    Target { name: "robot", seeds, words: keys_and_words(), parse: Box::new(parse) }
}

pub fn equipment() -> Target {
    let cell = String::from_utf8(seed("cell.toml")).unwrap();
    let with_part =
        "\n[obstacle.it]\nfrom = \"part.toml\"\nplacement = { x_mm = 9000, y_mm = 0, z_mm = 600 }\n";
    let with_tool = cell
        .replace("tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }", "tool = { from = \"part.toml\" }");
    assert!(with_tool.contains("from = \"part.toml\""));
    let cells = [cell + with_part, with_tool];
    let parse = move |input: &[u8]| {
        let is_tool = input.windows(16).any(|word| word == b"sweetspot/tool/1");
        let loaded = load_cell(cells[usize::from(is_tool)].as_bytes(), &[], |path| {
            Some(if path == "part.toml" { input.to_vec() } else { OBJ.into() })
        });
        evaluated(checked(loaded, "part.toml", input)?)
    };
    Target {
        name: "equipment",
        seeds: files("cells/equipment", ".toml"),
        words: keys_and_words(),
        parse: Box::new(parse),
    }
}

pub fn urdf() -> Target {
    let robot = seed("robot_of_urdf.toml");
    let named = move |input: &[u8]| load_robot(&robot, input, ("arm.urdf", input));
    let seeds =
        [files("cells/robots", ".urdf"), files("tests/data", ".urdf"), vec![seed("arm.urdf")]].concat();
    let words = words(&[
        "<link name=\"a\"/>",
        "<joint name=\"j\" type=\"revolute\">",
        "</joint>",
        "<parent link=\"a\"/>",
        "<child link=\"b\"/>",
        "<origin xyz=\"0 0 1\" rpy=\"0 0 0\"/>",
        "<axis xyz=\"0 0 0\"/>",
        "<limit lower=\"-1\" upper=\"1\"/>",
        "<mimic joint=\"j1\" multiplier=\"-1\" offset=\"0\"/>",
        "<collision><geometry><sphere radius=\"0.1\"/></geometry></collision>",
        "<mesh filename=\"package://p/a.stl\" scale=\"1 -1 1\"/>",
        "<!-- -->",
        "<![CDATA[",
        "]]>",
        "<?xml version=\"1.0\"?>",
        "<!DOCTYPE a [<!ENTITY b \"c\">]>",
        "&b;",
        "&#0;",
        "&#x10ffff;",
        "xmlns:a=\"b\"",
        "fixed",
        "continuous",
        "prismatic",
        "floating",
        "planar",
    ]);
    Target { name: "urdf", seeds, words, parse: Box::new(named) }
}

/// Checks properties of every mesh that is read: the vertices are finite and not far away, and each triangle
/// has three of them.
fn sound((vertices, mut triangles): (Vertices, Triangles)) -> Result<(), String> {
    assert!(vertices.iter().all(|v| v.iter().all(|c| c.abs() < 1e4)));
    let is_triangle = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let count = vertices.len();
    assert!(triangles.iter().all(|t| is_triangle(t) && t.iter().all(|&i| (i as usize) < count)));
    assert!((1..=200_000).contains(&triangles.len()));
    let before = triangles.len();
    solidity(&vertices, &mut triangles);
    assert_eq!(triangles.len(), before);
    Ok(())
}

pub fn stl() -> Target {
    let mut binary = vec![0u8; 80];
    binary.extend(4u32.to_le_bytes());
    for corners in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
        let points: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let normal_and_corners = [[0.0; 3]].into_iter().chain(corners.map(|k| points[k]));
        binary.extend(normal_and_corners.flatten().flat_map(f32::to_le_bytes));
        binary.extend([0, 0]);
    }
    let list = ["solid", "endsolid", "facet", "normal", "outer loop", "vertex 0 0 0", "endloop", "endfacet"];
    let parse = |input: &[u8]| match from_stl(input, 1e-3) {
        Ok(mesh) => sound(mesh),
        Err((_, why)) => Err(why),
    };
    Target { name: "stl", seeds: vec![STL.into(), binary], words: words(&list), parse: Box::new(parse) }
}

pub fn obj() -> Target {
    let rich = "# a\nmtllib a.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1 1 1 1\nvt 0 0\nvn 0 0 1\ng a b\nusemtl a\ns 1\nf 1/1/1 2//1 3/1 4\nf -1 -2 -3\nl 1 2\np 1\n";
    let list = [
        "v 0 0 0",
        "f 1 2 3",
        "f -1 -2 -3",
        "f 1//1 2//1 3//1",
        "vt",
        "vn",
        "vp",
        "l 1 2",
        "p 1",
        "o a",
        "g a",
        "s off",
        "usemtl",
        "mtllib",
        "\\\n",
        "/",
        "//",
    ];
    let parse = |input: &[u8]| match from_obj(&String::from_utf8_lossy(input), 1e-3) {
        Ok(mesh) => sound(mesh),
        Err((line, why)) => {
            let lines = input.split(|b| *b == b'\n').count();
            assert!(line.is_none_or(|line| line < lines), "line {line:?} of {lines}: {why}");
            Err(why)
        }
    };
    Target { name: "obj", seeds: vec![OBJ.into(), rich.into()], words: words(&list), parse: Box::new(parse) }
}

pub fn dxf() -> Target {
    let hall = std::fs::read(root().join("cells/equipment/hall.dxf")).unwrap();
    // The entities come last. The tables before them contain only layers.
    let start = hall.windows(6).position(|w| w == b"BLOCKS").unwrap() - 12;
    let small = [&b"0\nSECTION\n"[..], &hall[start..]].concat();
    let list = [
        "0",
        "10",
        "20",
        "42",
        "70",
        "8",
        "LWPOLYLINE",
        "INSERT",
        "BLOCK",
        "COLUMN",
        "ENDBLK",
        "1e9",
        "-1",
        "nan",
    ];
    let layers = BTreeSet::from(["WALLS", "COLUMNS", "MACHINES"].map(String::from));
    let parse = move |input: &[u8]| {
        let drawing = PlanDrawing::read(&text_of(input)).map_err(|fault| fault.message)?;
        let found = outlines(&drawing, &layers, 1e-3, 1e-3);
        match found.errors.into_iter().next() {
            Some(fault) => Err(fault.message),
            None => bodies(&found.found, 3.0).map(|_| ()).map_err(|fault| fault.message),
        }
    };
    Target { name: "dxf", seeds: vec![small], words: words(&list), parse: Box::new(parse) }
}

/// Returns the text of a sealed document, whose last line contains the hash of the text before it.
fn sealed(content: &[u8]) -> Vec<u8> {
    let text = content.trim_ascii_end();
    let text = text.strip_suffix(b"}").unwrap_or(text).trim_ascii_end();
    let end = format!(",\n  \"sha256\": \"{}\"\n}}\n", sha256(text));
    [text, end.as_bytes()].concat()
}

/// Reads a sealed document as the program does, and checks that the result can be written and read again.
fn read_sealed<T: DeserializeOwned + Serialize>(input: &[u8]) -> Result<(), String> {
    let own = sealed(input);
    assert!(cli::unsealed(&own).is_some(), "a sealed text is not accepted");
    // Only the seal of exactly this content is accepted.
    let given = cli::unsealed(input);
    assert!(given.is_none_or(|text| sealed(&text) == input), "a foreign seal is accepted");
    read_again::<T>(&cli::unsealed(&own).unwrap_or_default())
}

/// Reads a JSON document, and checks that the result can be written and read again.
fn read_again<T: DeserializeOwned + Serialize>(input: &[u8]) -> Result<(), String> {
    let document: T = serde_json::from_slice(input).map_err(|e| e.to_string())?;
    let text = serde_json::to_string(&document).unwrap();
    let again: T = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(serde_json::to_string(&again).unwrap(), text);
    Ok(())
}

fn of_json(name: &'static str, seeds: Vec<Vec<u8>>, parse: fn(&[u8]) -> Result<(), String>) -> Target {
    let words = words_of_json(&seeds);
    Target { name, seeds, words, parse: Box::new(parse) }
}

/// Returns a document of results/ without its seal.
fn result(path: &str) -> Vec<u8> {
    let bytes = std::fs::read(crate::common::root().join("results").join(path)).unwrap();
    cli::unsealed(&bytes).unwrap_or(bytes)
}

pub fn manifest() -> Target {
    let paths = ["hitachi_cell/manifest.json", "paper/manifest.json", "readings/paper/manifest.json"];
    of_json("manifest", paths.map(result).to_vec(), read_sealed::<ManifestDocument>)
}

pub fn sweep() -> Target {
    of_json("plan and row of a sweep", vec![seed("plan.json"), seed("row.json")], |input| {
        let plan = read_sealed::<SweepPlan>(input);
        plan.or_else(|of_plan| read_sealed::<SweepRow>(input).map_err(|of_row| of_plan + " " + &of_row))
    })
}

pub fn search_result() -> Target {
    of_json("search result", vec![result("hitachi_cell/search.json")], read_again::<SearchResult>)
}

pub fn checkpoint() -> Target {
    of_json("checkpoint", vec![seed("checkpoint.json")], |input| {
        // The first line contains the hash of the second line.
        let content: Vec<u8> = input.iter().map(|b| if *b == b'\n' { b' ' } else { *b }).collect();
        let header = serde_json::json!({
            "schema": "sweetspot/checkpoint/1",
            "version": env!("CARGO_PKG_VERSION"),
            "sha256": sha256(&content),
        });
        let file = [format!("{header}\n").as_bytes(), &content].concat();
        assert!(
            cli::evaluations_of_checkpoint(input).is_err(),
            "a checkpoint without its first line is accepted"
        );
        cli::evaluations_of_checkpoint(&file).map(drop).map_err(|(line, why)| {
            assert_eq!(line, 2, "{why}");
            why
        })
    })
}

/// Returns the target for tables of measured positions. Accepted numbers are finite, and every reflector has
/// a name.
pub fn measured_table() -> Target {
    let seeds = [
        "q1,q2,q3,q4,q5,q6,x,y,z\n1,2,3,4,5,6,100.5,200,300\n2,3,4,5,6,7,-1e2,2,3\n",
        "# made\nA1;A2;A3;A4;A5;A6;X (mm);Y (mm);Z (mm);rx;ry;rz;u95\n1;2;3;4;5;6;0,5;1;2;3;4;5;0,01\n",
        "q1 q2 q3 q4 q5 q6 smr1_x smr1_y smr1_z smr2_x smr2_y smr2_z\n1 2 3 4 5 6 1 2 3 nan nan nan\n",
        "reflector\tJ1 [deg]\tJ2\tJ3\tJ4\tJ5\tJ6\tx\ty\tz\tq0\tq1\tq2\tq3\nleft\t1\t2\t3\t4\t5\t6\t1\t2\t3\t1\t0\t0\t0\n",
        "1 2 3 4 5 6 7 8 9\n2 3 4 5 6 7 8 9 1\n",
    ];
    let list = [
        "q1",
        "x",
        "measured_",
        "goal_",
        "std_",
        "rx",
        "q0",
        "r11",
        "reflector",
        "nan",
        "-",
        "1e308",
        "1,5",
        "1.234,5",
        "1D5",
        "inf",
        ";",
        ",",
        "\t",
        "|",
        "\"",
        "#",
        "%",
        "deg",
        "[mm]",
        "mm",
        "\u{feff}",
        "\r\n",
        "1",
    ];
    let joints = ["q1", "q2", "q3", "q4", "q5", "q6"];
    let parse = move |input: &[u8]| {
        let text = measured::decode(input)?;
        let read = measured::read("table.csv", &text, &joints, &[], None);
        // The lines of a UTF-16 text differ from the lines of its bytes.
        let table = checked(read.map(|table| (table, Vec::new())), "table.csv", text.as_bytes())?;
        for row in &table.rows {
            let numbers = row.numbers.joints.iter().chain(row.numbers.position.iter());
            assert!(numbers.into_iter().all(|number| number.abs() < 1e9));
            assert!(row.numbers.reflector < table.reflectors.len());
        }
        assert!(!table.rows.is_empty() && table.joints.len() == 6);
        Ok(())
    };
    let seeds = seeds.map(|seed| seed.as_bytes().to_vec()).to_vec();
    Target { name: "table of measured positions", seeds, words: words(&list), parse: Box::new(parse) }
}

/// Returns the target for YAML and configuration files of Universal Robots. The first byte decides which
/// format is read.
pub fn stated_calibration() -> Target {
    let mut yaml = String::from("kinematics:\n");
    for joint in ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"] {
        yaml += &format!(
            "  {joint}:\n    x: 0.1\n    y: 0\n    z: -1e-3\n    roll: 1.57\n    pitch: 0\n    yaw: 0\n"
        );
    }
    yaml += "  hash: calib_1\n";
    let conf =
        ["theta", "a", "d", "alpha"].map(|of| format!("delta_{of} = [ 1, 2e-3, 3, -4, 5, 6]\n")).concat();
    let list = [
        "x:",
        "hash:",
        "forearm:",
        "kinematics:",
        "  ",
        "delta_d = [",
        "]",
        "nan",
        "1e9",
        ".inf",
        "&a",
        "*a",
        "- 1",
    ];
    let parse = |input: &[u8]| {
        let text = String::from_utf8_lossy(input);
        let read = if text.starts_with('d') { stated::read_conf } else { stated::read_yaml };
        let read = read("calibration", &text).map(|stated| (stated, Vec::new()));
        match checked(read, "calibration", input)? {
            StatedCalibration::Frames { frames, .. } => {
                let is_finite =
                    |frame: &sweetspot::pose::Pose| frame.rotation.iter().all(|r| r.abs() < 1.000001);
                assert!(frames.len() == 6 && frames.iter().all(is_finite));
            }
            StatedCalibration::Rows { theta, a, d, alpha } => {
                assert!([theta, a, d, alpha].iter().all(|row| row.len() == 6));
            }
        }
        Ok(())
    };
    let seeds = vec![yaml.into_bytes(), conf.into_bytes()];
    Target { name: "stated calibration", seeds, words: words(&list), parse: Box::new(parse) }
}

pub fn settings() -> Target {
    let cell = seed("cell.toml");
    let seeds = [
        "clearance_mm=0,10",
        "operation.work.grid=[2, 3]",
        "equipment.table.placement={ x_mm = 1, y_mm = 2, z_mm = 3 }",
        "operation.\"*\".sense=xy",
        "robot.'tool'.axis=[0, 0, 1]",
        "obstacle.o={ footprint = { size_mm = [1, 1] }, placement = { x_mm = 9, y_mm = 9, z_mm = 9 } }",
    ];
    let parse = move |input: &[u8]| {
        let text = String::from_utf8_lossy(input);
        let first = |faults: Vec<Fault>| {
            let place = |fault: Fault| (fault.line == 0 && !fault.help.is_empty()).then_some(fault.message);
            faults.into_iter().next().and_then(place).expect("a fault without place and with a help")
        };
        let choices = Choices::parse(&text).map_err(first)?;
        let value = choices.values.first().expect("at least one value");
        let setting = [Setting::new(choices.path.clone(), value.clone())];
        let loaded = load_cell(&cell, &setting, |_| None);
        evaluated(checked(loaded, "cell.toml", &cell)?)
    };
    let seeds = seeds.map(|seed| seed.as_bytes().to_vec()).to_vec();
    Target { name: "--set", seeds, words: keys_and_words(), parse: Box::new(parse) }
}

#[cfg(feature = "view")]
pub fn page_layout() -> Target {
    let loaded = load_cell(&seed("cell.toml"), &[], |_| None).unwrap();
    let workcell = Workcell::new(loaded.0).unwrap();
    let seeds = [
        "{\"equipment\":{\"table\":{\"x_mm\":600,\"y_mm\":0,\"z_mm\":100,\"yaw_deg\":1}}}",
        "{\"robot_base\":{\"x_mm\":0,\"yaw_deg\":-90},\"attitude\":{\"work\":{\"bend_deg\":-80}}}",
    ];
    let parse = move |input: &[u8]| {
        let layout = cli::requested_layout(&workcell.cell, input)?;
        assert!(evaluate(&workcell, &layout).cost.is_finite());
        Ok(())
    };
    let seeds = seeds.map(|seed| seed.as_bytes().to_vec()).to_vec();
    let words = words_of_json(&seeds);
    Target { name: "layout of the page", seeds, words, parse: Box::new(parse) }
}
