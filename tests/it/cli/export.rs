//! Tests `export`: the binary writes every format, and independent code reads it.

use crate::cli::sandbox::{numbers as numbers_of, *};
use crate::report::planar_face::{area, loops};
use serde_json::Value;
use std::collections::BTreeMap;

/// Formats of this build.
const FORMATS: &[&str] = match (cfg!(feature = "parquet"), cfg!(feature = "pdf")) {
    (true, true) => &[
        "dxf", "glb", "svg", "csv", "json", "krl", "rapid", "urscript", "fanuc", "urdf", "moveit", "parquet",
        "pdf",
    ],
    (false, true) => {
        &["dxf", "glb", "svg", "csv", "json", "krl", "rapid", "urscript", "fanuc", "urdf", "moveit", "pdf"]
    }
    (true, false) => &[
        "dxf", "glb", "svg", "csv", "json", "krl", "rapid", "urscript", "fanuc", "urdf", "moveit", "parquet",
    ],
    (false, false) => {
        &["dxf", "glb", "svg", "csv", "json", "krl", "rapid", "urscript", "fanuc", "urdf", "moveit"]
    }
};

/// Hostile name as a TOML string: unescaped, it would be a command for a spreadsheet, a CAD program and a
/// browser. Control characters are not included, because the reader of cells rejects them in names.
const HOSTILE: &str = "=cmd|'/C c'!A0<script>x()</script>%%c^J\\\\U+0041\\\"&\u{fc}";

/// Returns the group codes and values of an ASCII DXF.
fn pairs(dxf: &str) -> Vec<(u16, &str)> {
    let lines: Vec<&str> = dxf.split("\r\n").collect();
    assert_eq!(lines.len() % 2, 1, "an odd line");
    lines.chunks_exact(2).map(|l| (l[0].trim().parse().unwrap(), l[1])).collect()
}

/// Returns the entities of the model: kind, and the first value of each group code.
fn entities(dxf: &str) -> Vec<(String, BTreeMap<u16, String>)> {
    let pairs = pairs(dxf);
    let start = pairs.iter().position(|p| *p == (2, "ENTITIES")).unwrap();
    let end = start + pairs[start..].iter().position(|p| *p == (0, "ENDSEC")).unwrap();
    let mut all: Vec<(String, BTreeMap<u16, String>)> = Vec::new();
    for (code, value) in &pairs[start + 1..end] {
        match all.last_mut() {
            _ if *code == 0 => all.push((value.to_string(), BTreeMap::new())),
            Some((_, entity)) => drop(entity.entry(*code).or_insert_with(|| value.to_string())),
            None => panic!("{code} {value} before any entity"),
        }
    }
    all
}

fn point(entity: &BTreeMap<u16, String>, code: u16) -> [f64; 3] {
    [0, 10, 20].map(|axis| entity[&(code + axis)].parse().unwrap())
}

fn on<'e>(
    all: &'e [(String, BTreeMap<u16, String>)],
    kind: &str,
    layer: &str,
) -> Vec<&'e BTreeMap<u16, String>> {
    all.iter().filter(|(k, e)| k == kind && e[&8] == layer).map(|(_, e)| e).collect()
}

#[test]
fn a_dxf_shows_the_values_of_the_map() {
    let shop = Sandbox::new();
    let ran = shop.done(&["export", CELL, "--to", "dxf"]);
    assert_eq!(ran.out, "");
    assert!(ran.err.contains("wrote hitachi_cell.dxf") && ran.err.contains("next: sweetspot export"));
    let dxf = shop.text("hitachi_cell.dxf");
    let map = shop.json(&["map", CELL]);
    let all = entities(&dxf);
    let nodes: Vec<&Value> = items(&map["operations"]).iter().flat_map(|o| items(&o["nodes"])).collect();
    let (ok, out): (Vec<&Value>, Vec<&Value>) = nodes.iter().partition(|n| n["status"] == "ok");
    for (layer, nodes) in [("NODES_OK", &ok), ("NODES_OUT", &out)] {
        let circles = on(&all, "CIRCLE", layer);
        assert_eq!(circles.len(), nodes.len(), "{layer}");
        for (circle, node) in circles.iter().zip(nodes.iter()) {
            assert!(near(&point(circle, 10), &numbers(&node["position_mm"]), 1e-5), "{layer}");
        }
    }
    // All arrows have the same exaggeration, which a text of the drawing states.
    let texts = on(&all, "TEXT", "TEXT");
    let said = texts.iter().find_map(|t| t[&1].strip_prefix("arrows: signed sample, enlarged ")).unwrap();
    let enlarged: f64 = said.split(' ').next().unwrap().parse().unwrap();
    for (axis, layer) in ["ARROWS_X", "ARROWS_Y", "ARROWS_Z", "ARROWS_R"].into_iter().enumerate() {
        let lines = on(&all, "LINE", layer);
        // An arrow has a shaft and four lines as its head.
        assert_eq!(lines.len(), 5 * ok.len(), "{layer}");
        for (arrow, node) in lines.chunks(5).zip(&ok) {
            let (tail, tip) = (point(arrow[0], 10), point(arrow[0], 11));
            let error = numbers(&node["error_mm"]);
            assert!(near(&tail, &numbers(&node["position_mm"]), 1e-5));
            for k in 0..3 {
                let shown = if axis == 3 || axis == k { error[k] * enlarged } else { 0.0 };
                assert!((tip[k] - tail[k] - shown).abs() < 1e-4, "{layer} {tip:?} {tail:?} {error:?}");
            }
            assert!(arrow[1..].iter().all(|barb| point(barb, 10) == tip));
        }
    }
    // The dimensions state the positions of the frames. The base is at the origin of this cell.
    let dimensions = on(&all, "DIMENSION", "DIMENSIONS");
    let (angular, linear): (Vec<_>, Vec<_>) =
        dimensions.into_iter().partition(|d| d[&70].parse::<u16>().unwrap() & 7 == 5);
    let mut measured: Vec<f64> = linear.iter().map(|d| d[&42].parse().unwrap()).collect();
    let mut turned: Vec<f64> = angular.iter().map(|d| d[&42].parse::<f64>().unwrap().to_degrees()).collect();
    let mut yaws: Vec<f64> =
        ["worktable", "conveyor"].iter().map(|name| number(&map["layout"][*name]["yaw_deg"]).abs()).collect();
    [&mut turned, &mut yaws].into_iter().for_each(|v| v.sort_by(f64::total_cmp));
    assert!(near(&turned, &yaws, 1e-4), "{turned:?} {yaws:?}");
    let mut stands: Vec<f64> = ["worktable", "conveyor"]
        .iter()
        .flat_map(|name| ["x_mm", "y_mm"].map(|key| number(&map["layout"][*name][key]).abs()))
        .collect();
    [&mut measured, &mut stands].into_iter().for_each(|v| v.sort_by(f64::total_cmp));
    assert!(near(&measured, &stands, 1e-5), "{measured:?} {stands:?}");
    // Units are millimetres, every handle occurs once, and every entity lies on an existing layer.
    let pairs = pairs(&dxf);
    let units = pairs.iter().position(|p| *p == (9, "$INSUNITS")).unwrap();
    assert_eq!(pairs[units + 1], (70, "4"));
    let handles: Vec<&str> = pairs.iter().filter(|(c, _)| [5, 105].contains(c)).map(|(_, v)| *v).collect();
    let mut once = handles.clone();
    once.sort();
    once.dedup();
    assert_eq!(once.len(), handles.len());
    for (_, entity) in &all {
        assert!(pairs.windows(2).any(|w| w[0] == (100, "AcDbLayerTableRecord") && w[1] == (2, &entity[&8])));
    }
}

/// Every piece is one block at the placement of the layout. The block contains the solids and the outline of
/// the piece.
#[test]
fn a_dxf_has_one_block_for_each_piece_and_a_paper() {
    let shop = Sandbox::new();
    shop.done(&["export", CELL, "--to", "dxf"]);
    let dxf = shop.text("hitachi_cell.dxf");
    let map = shop.json(&["map", CELL]);
    let all = entities(&dxf);
    let inserts: Vec<_> = all.iter().filter(|(kind, _)| kind == "INSERT").map(|(_, e)| e).collect();
    let names: Vec<&str> = inserts.iter().map(|e| e[&2].as_str()).collect();
    assert_eq!(names[1..], ["worktable", "conveyor", "cabinet", "post", "machine"]);
    for name in ["worktable", "conveyor"] {
        let insert = inserts.iter().find(|e| e[&2] == name).unwrap();
        let at = &map["layout"][name];
        let stands = ["x_mm", "y_mm", "z_mm"].map(|key| number(&at[key]));
        assert!(near(&point(insert, 10), &stands, 1e-5), "{name}");
        assert!((insert[&50].parse::<f64>().unwrap() - number(&at["yaw_deg"])).abs() < 1e-5, "{name}");
    }
    // No solid is outside a block.
    assert!(!all.iter().any(|(kind, _)| kind == "3DFACE"));
    let pairs = pairs(&dxf);
    let block = |name: &str| {
        let starts = |w: &[(u16, &str)]| w[0] == (100, "AcDbBlockBegin") && w[1] == (2, name);
        let start = pairs.windows(2).position(starts).unwrap();
        let end = start + pairs[start..].iter().position(|p| *p == (0, "ENDBLK")).unwrap();
        &pairs[start..end]
    };
    for name in &names {
        let of = |kind: &str| block(name).iter().filter(|p| **p == (0, kind)).count();
        assert!(of("3DFACE") >= 12 && of("LWPOLYLINE") >= 2 && of("TEXT") == 1, "{name}");
        // No part has so many faces that a CAD program becomes slow.
        assert!(of("3DFACE") < 8000, "{name}: {}", of("3DFACE"));
    }
    // The layer of the many faces is frozen. The layer of the outlines is not.
    let frozen = |layer: &str| {
        let starts = |w: &[(u16, &str)]| w[0] == (100, "AcDbLayerTableRecord") && w[1] == (2, layer);
        let start = pairs.windows(2).position(starts).unwrap();
        pairs[start + 2] == (70, "1")
    };
    assert!(frozen("FACES") && !frozen("EQUIPMENT") && !frozen("ARROWS_R"));
    // The paper space has a title block and, besides its own viewport, a viewport on the model.
    let on_paper =
        |kind: &str| all.iter().filter(|(k, e)| k == kind && e.get(&67).is_some_and(|v| v == "1")).count();
    assert_eq!(on_paper("VIEWPORT"), 2);
    assert!(on_paper("TEXT") > 12 && on_paper("LWPOLYLINE") > 12);
    assert_eq!(pairs.iter().filter(|p| **p == (0, "LAYOUT")).count(), 2);
    // The envelope is an outline with two circles.
    let circles = on(&all, "CIRCLE", "ENVELOPE");
    assert_eq!(circles.len(), 2 * items(&map["operations"]).len());
    assert!(!on(&all, "LWPOLYLINE", "ENVELOPE").is_empty() && !on(&all, "LWPOLYLINE", "REGION").is_empty());
}

/// The faces of the REGION entities are the areas that the outlines on their layer enclose.
#[test]
fn the_allowed_placements_are_regions_of_a_dxf() {
    let shop = Sandbox::new();
    shop.done(&["export", CELL, "--to", "dxf"]);
    let dxf = shop.text("hitachi_cell.dxf");
    let pairs = pairs(&dxf);
    let bodies = |kind: &'static str| {
        let starts = pairs.iter().enumerate().filter(move |(_, p)| **p == (0, kind));
        starts.map(|(k, _)| pairs[k + 1..].iter().take_while(|(code, _)| *code != 0).collect::<Vec<_>>())
    };
    let on_layer = |body: &Vec<&(u16, &str)>| body.contains(&&(8, "REGION"));
    let mut outlines = Vec::new();
    for body in bodies("LWPOLYLINE").filter(on_layer) {
        let of = |code: u16| body.iter().filter(move |p| p.0 == code).map(|p| p.1.parse::<f64>().unwrap());
        let z = of(38).next().unwrap();
        let corners: Vec<_> = of(10).zip(of(20)).map(|(x, y)| [x, y, z]).collect();
        outlines.push((z, area(&corners).abs()));
    }
    let mut faces = Vec::new();
    for body in bodies("REGION") {
        assert!(on_layer(&body) && body.contains(&&(100, "AcDbModelerGeometry")));
        let lines: Vec<&str> = body.iter().filter(|(code, _)| *code == 1).map(|(_, line)| *line).collect();
        for (k, corners) in loops(&lines).iter().enumerate() {
            // The outer loop runs anticlockwise, and a hole clockwise.
            assert_eq!(area(corners) > 0.0, k == 0);
            faces.push((corners[0][2], area(corners).abs()));
        }
    }
    [&mut outlines, &mut faces].into_iter().for_each(|v| v.sort_by(|a, b| a.partial_cmp(b).unwrap()));
    assert!(outlines.len() >= 2 && outlines.len() == faces.len());
    for ((z, outline), (height, face)) in outlines.iter().zip(&faces) {
        assert_eq!(z, height);
        assert!((outline - face).abs() < 1e-9 * outline, "{outline} {face}");
    }
}

/// Returns header, JSON and numbers of a binary glTF.
fn glb(bytes: &[u8]) -> (Value, Vec<u8>) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let json = word(12);
    assert_eq!((&bytes[16..20], json % 4), (&b"JSON"[..], 0));
    let numbers = 20 + json;
    assert_eq!(&bytes[numbers + 4..numbers + 8], b"BIN\0");
    assert_eq!(numbers + 8 + word(numbers), bytes.len());
    (serde_json::from_slice(&bytes[20..numbers]).unwrap(), bytes[numbers + 8..].to_vec())
}

/// Returns the numbers of an accessor, a list per vector.
fn read(document: &Value, numbers: &[u8], accessor: &Value) -> Vec<Vec<f64>> {
    let accessor = &document["accessors"][accessor.as_u64().unwrap() as usize];
    let view = &document["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
    let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
    let bytes = &numbers[start..start + view["byteLength"].as_u64().unwrap() as usize];
    let width = match text(&accessor["type"]) {
        "SCALAR" => 1,
        "VEC3" => 3,
        "VEC4" => 4,
        other => panic!("{other}"),
    };
    let word = |c: &[u8]| match accessor["componentType"].as_u64().unwrap() {
        5126 => f64::from(f32::from_le_bytes(c.try_into().unwrap())),
        5125 => f64::from(u32::from_le_bytes(c.try_into().unwrap())),
        other => panic!("{other}"),
    };
    let all: Vec<f64> = bytes.chunks(4).map(word).collect();
    assert_eq!(all.len(), width * accessor["count"].as_u64().unwrap() as usize);
    all.chunks(width).map(<[f64]>::to_vec).collect()
}

fn turned(q: &[f64], p: [f64; 3]) -> [f64; 3] {
    // p + 2 u x (u x p + w p)
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let u = [q[0], q[1], q[2]];
    let inner = cross(u, p);
    let outer = cross(u, [0, 1, 2].map(|k| inner[k] + q[3] * p[k]));
    [0, 1, 2].map(|k| p[k] + 2.0 * outer[k])
}

#[test]
fn a_glb_is_valid_and_its_robot_moves_to_the_spots() {
    let shop = Sandbox::new();
    shop.done(&["export", CELL, "--to", "glb", "--posture", "picking", "-o", "cell.glb"]);
    let map = shop.json(&["map", CELL]);
    let (document, numbers) = glb(&shop.read("cell.glb"));
    for mesh in items(&document["meshes"]) {
        for primitive in items(&mesh["primitives"]) {
            let positions = read(&document, &numbers, &primitive["attributes"]["POSITION"]);
            let indices = read(&document, &numbers, &primitive["indices"]);
            assert!(indices.iter().all(|i| (i[0] as usize) < positions.len()));
            if primitive["mode"] == Value::Null || primitive["mode"] == 4 {
                let normals = read(&document, &numbers, &primitive["attributes"]["NORMAL"]);
                assert_eq!((normals.len(), indices.len() % 3), (positions.len(), 0));
                let norm = |n: &Vec<f64>| n.iter().map(|c| c * c).sum::<f64>().sqrt();
                assert!(normals.iter().all(|n| (norm(n) - 1.0).abs() < 1e-5));
            }
        }
    }
    let nodes = items(&document["nodes"]);
    let index =
        |name: &str| nodes.iter().position(|n| n["name"] == name).unwrap_or_else(|| panic!("no {name}"));
    // The first node rotates z to y. With this rotation, the table is at the position of the map.
    let top = &nodes[document["scenes"][0]["nodes"][0].as_u64().unwrap() as usize];
    let up = turned(&numbers_of(&top["rotation"]), [0.0, 0.0, 1.0]);
    assert!(near(&up, &[0.0, 1.0, 0.0], 1e-6), "{up:?}");
    let table = &nodes[index("worktable")];
    let place = ["x_mm", "y_mm", "z_mm"].map(|key| number(&map["layout"]["worktable"][key]) / 1000.0);
    assert!(near(&numbers_of(&table["translation"]), &place, 1e-6));
    let yaw = number(&map["layout"]["worktable"]["yaw_deg"]).to_radians();
    let along = turned(&numbers_of(&table["rotation"]), [1.0, 0.0, 0.0]);
    assert!(near(&along, &[yaw.cos(), yaw.sin(), 0.0], 1e-6));
    // The drawn TCP is at the requested spot. The animation passes every spot and ends where it starts.
    let spot = |k: usize| {
        numbers_of(&map["operations"][k]["best"]["position_mm"])
            .iter()
            .map(|v| v / 1000.0)
            .collect::<Vec<_>>()
    };
    let tcp = index("tcp");
    assert!(near(&numbers_of(&nodes[tcp]["translation"]), &spot(1), 1e-6));
    let animation = &document["animations"][0];
    let channel = |node: usize, path: &str| {
        let of = |c: &&Value| c["target"]["node"] == node && c["target"]["path"] == path;
        let channel = items(&animation["channels"]).iter().find(of).unwrap();
        &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize]
    };
    let way = read(&document, &numbers, &channel(tcp, "translation")["output"]);
    let times = read(&document, &numbers, &channel(tcp, "translation")["input"]);
    assert!(times.windows(2).all(|t| t[0] < t[1]) && times.len() == way.len());
    for k in 0..2 {
        assert!(way.iter().any(|p| near(p, &spot(k), 1e-6)), "never at the spot of operation {k}");
    }
    assert_eq!(way.first(), way.last());
    let joints = numbers_of(&map["operations"][0]["best"]["joints_deg"]).len();
    for link in (1..=joints).map(|k| index(&format!("link {k}"))) {
        let turns = read(&document, &numbers, &channel(link, "rotation")["output"]);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!(turns.iter().all(|q| (dot(q, q) - 1.0).abs() < 1e-5));
        assert!(turns.windows(2).all(|q| dot(&q[0], &q[1]) > 0.9), "link {link} jumps");
    }
    // At home the TCP is elsewhere.
    shop.done(&["export", CELL, "--to", "glb", "--posture", "home", "-o", "home.glb"]);
    let (home, _) = glb(&shop.read("home.glb"));
    let at_home = numbers_of(&home["nodes"][tcp]["translation"]);
    assert!(near(&at_home, way.first().unwrap(), 1e-6) && !near(&at_home, &spot(1), 0.01));
}

#[test]
fn a_drawing_to_scale_has_the_size_of_its_scale() {
    let shop = Sandbox::new();
    shop.done(&["export", CELL, "--to", "svg", "-o", "sheet.svg"]);
    let svg = shop.text("sheet.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    let root = document.root_element();
    let [width, height] = ["width", "height"]
        .map(|key| root.attribute(key).unwrap().strip_suffix("mm").unwrap().parse().unwrap());
    let formats = [(210.0, 297.0), (297.0, 210.0), (297.0, 420.0), (420.0, 297.0)];
    assert!(formats.contains(&(width, height)), "{width} by {height}");
    assert_eq!(root.attribute("viewBox"), Some(format!("0 0 {width} {height}").as_str()));
    let texts: Vec<String> = document
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .filter_map(|n| n.text())
        .map(str::to_string)
        .collect();
    let ratio: f64 = texts.iter().find_map(|t| t.strip_prefix("1:")).unwrap().parse().unwrap();
    assert!([1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0].contains(&ratio));
    // In the plan, the distance of the marks of both spots is their distance in the map divided by the scale.
    let circles: Vec<_> = document.descendants().filter(|n| n.attribute("r") == Some("1.8")).collect();
    let at = |k: usize| ["cx", "cy"].map(|a| circles[k].attribute(a).unwrap().parse::<f64>().unwrap());
    assert_eq!(circles.len(), 4); // plan and front of each
    let map = shop.json(&["map", CELL]);
    let spot = |k: usize| numbers(&map["operations"][k]["best"]["position_mm"]);
    let (a, b) = (spot(0), spot(1));
    let [plan, front] = [0, 2].map(|first| {
        let (from, to) = (at(first), at(first + 1));
        [to[0] - from[0], from[1] - to[1]]
    });
    assert!(near(&plan, &[(b[0] - a[0]) / ratio, (b[1] - a[1]) / ratio], 0.02), "{plan:?}");
    assert!(near(&front, &[(b[0] - a[0]) / ratio, (b[2] - a[2]) / ratio], 0.02), "{front:?}");
    for circle in &circles {
        let [x, y] = ["cx", "cy"].map(|a| circle.attribute(a).unwrap().parse::<f64>().unwrap());
        assert!((20.0..width - 10.0).contains(&x) && (10.0..height - 10.0).contains(&y), "outside: {x} {y}");
    }
}

#[test]
fn exported_tables_and_documents_equal_those_of_map() {
    let shop = Sandbox::new();
    shop.done(&["map", PAPER, "--out", "map"]);
    for (format, file) in [("csv", "map/map.csv"), ("json", "map/map.json")] {
        shop.done(&["export", PAPER, "--to", format]);
        assert_eq!(shop.read(&format!("hitachi_paper.{format}")), shop.read(file), "{format}");
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn a_build_without_parquet_says_how_to_get_it() {
    let shop = Sandbox::new();
    let ran = shop.run(&["export", PAPER, "--to", "parquet"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("this build has no Parquet writer"), "{}", ran.err);
    assert!(ran.err.contains("cargo install --path . --features parquet"), "{}", ran.err);
    assert!(!shop.path("hitachi_paper.parquet").exists());
}

#[cfg(feature = "parquet")]
#[test]
fn the_exported_parquet_table_equals_the_csv_of_map() {
    let shop = Sandbox::new();
    shop.done(&["map", PAPER, "--out", "map"]);
    shop.done(&["export", PAPER, "--to", "parquet"]);
    let bytes = shop.read("hitachi_paper.parquet");
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::{Field, RowAccessor};
    let file =
        SerializedFileReader::new(std::fs::File::open(shop.path("hitachi_paper.parquet")).unwrap()).unwrap();
    let table = shop.text("map/map.csv");
    let mut table = csv::Reader::from_reader(table.as_bytes());
    let names = table.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(file.metadata().file_metadata().num_rows() as usize, rows.len());
    let mut nulls = 0;
    for (row, expected) in file.get_row_iter(None).unwrap().zip(&rows) {
        let row = row.unwrap();
        assert_eq!(row.get_column_iter().count(), names.len());
        for (k, (name, field)) in row.get_column_iter().enumerate() {
            assert_eq!(name, &names[k]);
            match field {
                Field::Str(text) => assert_eq!(text, &expected[k]),
                Field::Null => {
                    nulls += 1;
                    assert_eq!(&expected[k], "", "{name}");
                }
                Field::Bool(is) => assert_eq!(if *is { "1" } else { "0" }, &expected[k]),
                Field::Int(n) => assert_eq!(n.to_string(), expected[k]),
                Field::Double(v) => assert_eq!(*v, expected[k].parse::<f64>().unwrap(), "{name}"),
                other => panic!("{name}: {other:?}"),
            }
        }
        assert!(row.get_int(2).unwrap() <= 10);
    }
    assert!(nulls > 100);
}

#[test]
fn one_layout_exports_to_the_same_bytes() {
    let shop = Sandbox::new();
    for folder in ["a", "b"] {
        std::fs::create_dir(shop.path(folder)).unwrap();
    }
    // The PDF crate writes its objects in random order, so the tests in `print_out` compare PDF files.
    for format in FORMATS.iter().copied().filter(|format| *format != "pdf") {
        // The name of a KRL or RAPID module is the name of its file.
        for folder in ["a", "b"] {
            shop.done(&["export", PAPER, "--to", format, "-o", &format!("{folder}/cell.{format}")]);
        }
        assert_eq!(
            shop.read(&format!("a/cell.{format}")),
            shop.read(&format!("b/cell.{format}")),
            "{format}"
        );
    }
}

#[test]
fn a_folder_is_exported_by_its_best_or_its_start_layout() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "300", "--out", "found"]);
    for (args, of) in [(&[][..], "found/best.toml"), (&["--start"][..], CELL)] {
        shop.done(&[&["export", "found", "--to", "csv", "-o", "export.csv"], args].concat());
        shop.done(&["export", of, "--to", "csv", "-o", "direct.csv"]);
        assert_eq!(shop.read("export.csv"), shop.read("direct.csv"), "{of}");
    }
    shop.done(&["export", "found", "--to", "json"]);
    assert!(shop.path("found.json").exists());
    // Options of the command line take effect.
    shop.done(&["export", "found", "--to", "json", "--reading", "worst-case", "-o", "worst.json"]);
    assert_eq!(shop.document("worst.json")["operations"][0]["reading"], "worst-case");
    std::fs::create_dir(shop.path("empty")).unwrap();
    for (args, said) in [
        (&["export", "empty", "--to", "dxf"][..], "holds no manifest.json"),
        (&["export", CELL, "--to", "dxf", "--start"], "--start needs a result folder"),
        (&["export", CELL, "--to", "dwg"], "invalid value 'dwg'"),
        (&["export", CELL], "--to <FORMAT>"),
        (&["export", CELL, "--to", "dxf", "--posture", "assembyl"], "did you mean assembly?"),
    ] {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{args:?}: {}", ran.err);
    }
    assert!(!shop.path("empty.dxf").exists() && !shop.path("hitachi_cell.dxf").exists());
    assert_eq!(shop.run(&["export", "nowhere.toml", "--to", "dxf"]).code, Some(3));
}

#[test]
fn a_failed_export_leaves_existing_files_untouched() {
    let shop = Sandbox::new();
    for out in ["no/such/folder/cell.dxf", "cells"] {
        let ran = shop.run(&["export", PAPER, "--to", "dxf", "-o", out]);
        assert_eq!(ran.code, Some(3), "{out}: {}", ran.err);
        assert!(ran.err.contains("cannot write"), "{}", ran.err);
    }
    // A missing spot is refused, and the old file stays.
    shop.write("cells/far.toml", BEYOND_REACH);
    shop.write("far.glb", "old");
    let ran =
        shop.run(&["export", "cells/far.toml", "--to", "glb", "-o", "far.glb", "--posture", "assembly"]);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    assert_eq!(shop.text("far.glb"), "old");
    let left: Vec<String> = shop.files(".").into_iter().filter(|f| f.contains(".sweetspot-")).collect();
    assert!(left.is_empty(), "{left:?}");
    // If no spot is requested, every format shows the robot at home.
    for format in FORMATS.iter().copied() {
        shop.done(&["export", "cells/far.toml", "--to", format, "-o", &format!("far.{format}")]);
    }
}

#[test]
fn hostile_names_are_text_in_every_format() {
    let shop = Sandbox::new();
    let cell = shop.text(PAPER);
    let cell = cell
        .replace("name = \"Paper, section 4.3\"", &format!("name = \"{HOSTILE}\""))
        .replace("[operation.mapping]", &format!("[operation.\"{HOSTILE}\"]"))
        .replace("[equipment.worktable]", &format!("[equipment.\"{HOSTILE}\"]"))
        .replace("on = \"worktable\"", &format!("on = \"{HOSTILE}\""));
    shop.write("cells/hostile.toml", &cell);
    for format in FORMATS.iter().copied() {
        shop.done(&["export", "cells/hostile.toml", "--to", format]);
    }
    let dxf = shop.text("hostile.dxf");
    let values: Vec<(u16, &str)> = pairs(&dxf);
    assert_eq!(values.iter().filter(|p| **p == (0, "EOF")).count(), 1);
    for (code, value) in &values {
        assert!(value.bytes().all(|b| (b' '..=b'~').contains(&b)), "{code} {value}");
        // Only the codes for the signs of plus or minus and of degrees are allowed.
        let others = value.replace("%%p", "").replace("%%d", "");
        assert!(!others.contains("%%") && !others.contains("^J"), "{code} {value}");
    }
    assert!(values.iter().any(|(c, v)| *c == 1 && v.contains("<script>")), "no name at all");
    let svg = shop.text("hostile.svg");
    let document = roxmltree::Document::parse(&svg).unwrap();
    assert!(!document.descendants().any(|n| n.has_tag_name("script")));
    assert!(svg.contains("&lt;script&gt;"));
    let csv = shop.text("hostile.csv");
    let first = csv::Reader::from_reader(csv.as_bytes()).records().next().unwrap().unwrap();
    assert!(first[0].starts_with("'=cmd") && first[1].starts_with("'=cmd"), "{first:?}");
    let (scene, _) = glb(&shop.read("hostile.glb"));
    assert!(items(&scene["nodes"]).iter().any(|n| n["name"].as_str().is_some_and(|n| n.starts_with("=cmd"))));
}

#[test]
fn an_output_name_of_another_format_is_refused() {
    let shop = Sandbox::new();
    let ran = shop.run(&["export", "cells/hitachi_paper.toml", "--to", "png", "-o", "a.dxf"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains(".png") && !shop.path("a.dxf").exists(), "{}", ran.err);
}

#[test]
fn frames_for_controllers_are_those_of_the_layout() {
    let shop = Sandbox::new();
    let map = shop.json(&["map", CELL]);
    let table = &map["layout"]["worktable"];
    for (format, file) in [("krl", "hitachi_cell.dat"), ("rapid", "hitachi_cell.mod")] {
        shop.done(&["export", CELL, "--to", format]);
        let text = shop.text(file);
        let line = text.lines().find(|l| l.contains("_worktable")).unwrap();
        for key in ["x_mm", "y_mm", "z_mm"] {
            let value = format!("{:.4}", number(&table[key]));
            assert!(line.contains(&value), "{key} {value} is not in {line}");
        }
    }
    // The base frame of a robot on a pedestal is not the world frame. The spot is the pose of the TCP in its
    // work object.
    shop.done(&["export", "cells/ur_cell.toml", "--to", "urscript"]);
    let map = shop.json(&["map", "cells/ur_cell.toml"]);
    let script = shop.text("ur_cell.script");
    let pose = |name: &str| {
        let line = script.lines().find(|l| l.starts_with(&format!("global {name} = p["))).unwrap();
        let inside = line.split_once("p[").unwrap().1.trim_end_matches(']').to_string();
        inside.split(", ").map(|v| v.parse().unwrap()).collect::<Vec<f64>>()
    };
    let operation = &map["operations"][0];
    let on = text(&operation["equipment"]);
    let spot = pose(&format!("spot_{}", text(&operation["name"])));
    let at = &map["layout"][on];
    let yaw = number(&at["yaw_deg"]).to_radians();
    let world = [
        number(&at["x_mm"]) / 1e3 + yaw.cos() * spot[0] - yaw.sin() * spot[1],
        number(&at["y_mm"]) / 1e3 + yaw.sin() * spot[0] + yaw.cos() * spot[1],
        number(&at["z_mm"]) / 1e3 + spot[2],
    ];
    let expected: Vec<f64> = numbers_of(&operation["best"]["position_mm"]).iter().map(|v| v / 1e3).collect();
    assert!(near(&world, &expected, 1e-6), "{world:?} {expected:?}");
    // The tool points down, so the frame of the TCP is rotated by half a turn.
    let turn = spot[3..].iter().map(|v| v * v).sum::<f64>().sqrt();
    assert!((turn - std::f64::consts::PI).abs() < 1e-6, "{turn}");
}

#[test]
fn drawings_of_infeasible_layouts_are_marked() {
    let shop = Sandbox::new();
    shop.write("cells/far.toml", BEYOND_REACH);
    for (cell, is_feasible) in [("cells/far.toml", false), (CELL, true)] {
        for (format, extension) in [
            ("svg", "svg"),
            ("dxf", "dxf"),
            ("krl", "dat"),
            ("rapid", "mod"),
            ("urscript", "script"),
            ("fanuc", "txt"),
        ] {
            let out = format!("drawing.{extension}");
            let ran = shop.done(&["export", cell, "--to", format, "-o", &out]);
            let drawing = shop.text(&out).to_uppercase();
            let is_marked = drawing.contains("NOT FEASIBLE") && drawing.contains("DO NOT BUILD");
            assert_eq!(is_marked, !is_feasible, "{cell} as {format}");
            let warns = ran.err.contains("warning: the layout is not feasible; do not build it: ");
            assert_eq!(warns, !is_feasible, "{cell} as {format}: {}", ran.err);
        }
    }
}

#[test]
fn an_output_never_replaces_a_file_that_the_command_has_read() {
    let shop = Sandbox::new();
    let before = shop.text(CELL);
    for args in [
        &["map", CELL, "--svg", CELL][..],
        &["export", CELL, "--to", "json", "-o", "cells/robots/../hitachi_cell.json"],
        &["export", CELL, "--to", "dxf", "-o", "cells/folder.dxf"],
        &["envelope", CELL, "--svg", CELL],
    ] {
        std::fs::create_dir_all(shop.path("cells/folder.dxf")).unwrap();
        let ran = shop.run(args);
        let is_new = args.contains(&"json");
        let code = if is_new { 0 } else { 2 + i32::from(args.contains(&"dxf")) };
        assert_eq!(ran.code, Some(code), "{args:?}: {}", ran.err);
        assert!(is_new || ran.err.contains("choose another name for the output"), "{args:?}: {}", ran.err);
        assert_eq!(shop.text(CELL), before, "{args:?}");
    }
}

/// Both ends of a dimension have an extension line.
#[test]
fn extension_lines_of_a_sheet_have_a_length() {
    let shop = Sandbox::new();
    shop.done(&["export", CELL, "--to", "svg", "-o", "sheet.svg"]);
    let sheet = shop.text("sheet.svg");
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let mut lines = 0;
    for path in sheet.split("d=\"M").skip(1).filter_map(|rest| rest.split('"').next()) {
        let segments: Vec<&str> = path.split('M').collect();
        // The extension lines of a corner and of the base, downwards and to the left.
        let is_vertical = |segment: &&str| segment.matches('V').count() == 1 && !segment.contains('H');
        if segments.len() != 4 || segments.iter().filter(|s| is_vertical(s)).count() != 2 {
            continue;
        }
        for segment in segments {
            let (start, end) = segment.split_once(['V', 'H']).unwrap();
            let (x, y) = start.split_once(' ').unwrap();
            let from = if segment.contains('V') { y } else { x };
            let length = (number(from).unwrap() - number(end).unwrap()).abs();
            assert!(length > 1.0, "{segment} in {path}");
            lines += 1;
        }
    }
    assert!(lines >= 8, "{lines} extension lines");
}
