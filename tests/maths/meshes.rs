//! Tests mesh files: OBJ and STL files give the same mesh. Hostile files are rejected with the place of the
//! fault, and need little memory.

use crate::common::root;
use allocation_counter::measure;
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeSet;
use sweetspot::cell::Shape;
use sweetspot::files;
use sweetspot::files::{Fault, Loaded};

type V = Vector3<f64>;
type Mesh = (Vec<[f32; 3]>, Vec<[usize; 3]>);

/// Loads a cell with the mesh file `name` as an obstacle. Also returns the paths that were opened.
fn load(name: &str, units: &str, bytes: &[u8]) -> (Result<Loaded, Vec<Fault>>, BTreeSet<String>) {
    let text = format!(
        "from = \"hitachi_paper.toml\"\n[obstacle.part]\nplacement = {{ x_mm = 0, y_mm = 9000, z_mm = 0 }}\n\
         solid = [{{ name = \"body\", mesh = {{ file = \"{name}\", units = \"{units}\", centre_mm = [0, 0, 0] }} }}]\n"
    );
    let mut opened = BTreeSet::new();
    let loaded = files::load("cell.toml", &mut |path: &str| {
        opened.insert(path.to_string());
        match path {
            "cell.toml" => Ok(text.clone().into_bytes()),
            _ if path == name => Ok(bytes.to_vec()),
            _ => std::fs::read(root().join("cells").join(path)).map_err(|_| "no such file".to_string()),
        }
    });
    (loaded, opened)
}

/// Returns vertices (m) and triangles as they were read, and the warnings.
fn read(name: &str, units: &str, bytes: &[u8]) -> (Vec<V>, Vec<[u32; 3]>, bool, Vec<String>) {
    let loaded = load(name, units, bytes).0.unwrap_or_else(|f| panic!("{name}: {f:#?}"));
    let warnings = loaded.warnings.into_iter().map(|f| f.message).filter(|m| m.contains("mesh")).collect();
    let mut solids = loaded.cell.equipment.into_iter().flat_map(|e| e.solids);
    match solids.find(|s| s.name == "body").unwrap().shape {
        Shape::Mesh { vertices, triangles, closed, .. } => (vertices, triangles, closed, warnings),
        other => panic!("{other:?}"),
    }
}

/// Returns a cube from `low` to `high` whose faces point outwards.
fn cube(low: f32, high: f32) -> Mesh {
    let corner = |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { high } else { low });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    ((0..8).map(corner).collect(), triangles.collect())
}

fn turned((vertices, triangles): Mesh) -> Mesh {
    (vertices, triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect())
}

fn both((mut vertices, mut triangles): Mesh, (more, others): Mesh) -> Mesh {
    let first = vertices.len();
    vertices.extend(more);
    triangles.extend(others.into_iter().map(|t| t.map(|i| i + first)));
    (vertices, triangles)
}

fn obj((vertices, triangles): &Mesh) -> Vec<u8> {
    let vertex = |[x, y, z]: &[f32; 3]| format!("v {x} {y} {z}\n");
    let face = |[a, b, c]: &[usize; 3]| format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    vertices.iter().map(vertex).chain(triangles.iter().map(face)).collect::<String>().into_bytes()
}

fn binary_stl((vertices, triangles): &Mesh, title: &str) -> Vec<u8> {
    let mut bytes = title.as_bytes().to_vec();
    bytes.resize(80, 0);
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for t in triangles {
        bytes.extend([0; 12]);
        bytes.extend(t.iter().flat_map(|&k| vertices[k]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn text_stl((vertices, triangles): &Mesh) -> Vec<u8> {
    let corner =
        |&k: &usize| format!("    vertex {} {} {}\n", vertices[k][0], vertices[k][1], vertices[k][2]);
    let facet = |t: &[usize; 3]| {
        let corners: String = t.iter().map(corner).collect();
        format!("  facet normal 0 0 1\n   outer loop\n{corners}   endloop\n  endfacet\n")
    };
    let facets: String = triangles.iter().map(facet).collect();
    format!("solid a part\n{facets}endsolid a part\n").into_bytes()
}

#[test]
fn one_mesh_is_equal_in_every_file_format() {
    let mesh = cube(0.0, 250.0);
    let want = read("part.obj", "mm", &obj(&mesh));
    assert!(want.2 && want.3.is_empty() && want.0.len() == 8 && want.1.len() == 12);
    let in_metres = (mesh.0.iter().map(|v| v.map(|c| c / 1000.0)).collect(), mesh.1.clone());
    let text = text_stl(&mesh);
    let shouted = String::from_utf8(text.clone()).unwrap().to_uppercase();
    let with_nan =
        String::from_utf8(text.clone()).unwrap().replace("0 0 1", "nan nan nan").replace('\n', "\r\n");
    for (what, name, units, bytes) in [
        ("binary", "part.stl", "mm", binary_stl(&mesh, "")),
        ("binary titled like a text", "part.STL", "mm", binary_stl(&mesh, "solid of some program\n")),
        ("text", "part.stl", "mm", text),
        ("text in capitals", "part.stl", "mm", shouted.into_bytes()),
        ("text with normals of nan", "part.stl", "mm", with_nan.into_bytes()),
        ("metres", "part.stl", "m", binary_stl(&in_metres, "")),
    ] {
        let got = read(name, units, &bytes);
        // An STL file has separate triangles with the same corners, but its vertices are in another order.
        let corners = |(v, t, ..): &(Vec<V>, Vec<[u32; 3]>, bool, Vec<String>)| {
            t.iter().map(|t| t.map(|i| v[i as usize])).collect::<Vec<_>>()
        };
        assert!(got.2 && got.3.is_empty() && got.0.len() == 8, "{what}: {:?}", got.3);
        assert_eq!(corners(&got), corners(&want), "{what}");
    }
}

/// All solids of one text are read.
#[test]
fn every_solid_of_a_mesh_text_is_read() {
    let two = [text_stl(&cube(0.0, 100.0)), text_stl(&cube(200.0, 300.0))].concat();
    let (vertices, triangles, closed, _) = read("part.stl", "mm", &two);
    assert_eq!((vertices.len(), triangles.len(), closed), (16, 24, true));
}

#[test]
fn open_and_hollow_meshes_are_reported() {
    let (solid, inner) = (cube(0.0, 300.0), cube(100.0, 200.0));
    let mut open = solid.clone();
    open.1.pop();
    let beside = turned(cube(400.0, 500.0));
    let hollow = both(solid.clone(), turned(inner.clone()));
    for (what, mesh, closed, said) in [
        ("solid", solid.clone(), true, ""),
        ("open", open, false, "is not a closed surface"),
        ("hollow", hollow.clone(), true, "encloses a cavity"),
        ("hollow, outside in", turned(hollow), true, "encloses a cavity"),
        ("a solid in a solid", both(solid.clone(), inner), true, ""),
        ("one of two turned", both(solid, beside), true, ""),
    ] {
        for (name, bytes) in [("part.stl", binary_stl(&mesh, "")), ("part.obj", obj(&mesh))] {
            let (vertices, triangles, is_closed, warnings) = read(name, "mm", &bytes);
            assert_eq!(is_closed, closed, "{what}");
            assert!(warnings.len() == usize::from(!said.is_empty()), "{what}: {warnings:?}");
            assert!(warnings.iter().all(|w| w.contains(said)), "{what}: {warnings:?}");
            let at = |i: u32| vertices[i as usize];
            let volume: f64 = triangles.iter().map(|&[a, b, c]| at(a).dot(&at(b).cross(&at(c))) / 6.0).sum();
            let cubes: f64 = match what {
                "hollow" | "hollow, outside in" => 27.0 - 1.0,
                "a solid in a solid" | "one of two turned" => 27.0 + 1.0,
                _ => 27.0,
            };
            assert!(!is_closed || (volume - cubes * 1e-3).abs() < 1e-9, "{what}: {volume}");
        }
    }
}

/// The shipped STL is the shipped OBJ at half size. The command `UPDATE=1 cargo test --test maths meshes::`
/// writes the STL file again.
#[test]
fn the_shipped_stl_is_the_shipped_obj_at_half_size() {
    let folder = root().join("cells/equipment");
    let (vertices, triangles, closed, _) =
        read("part.obj", "mm", &std::fs::read(folder.join("machine.obj")).unwrap());
    assert!(closed && triangles.len() == 10_000);
    let half: Vec<_> = vertices.iter().map(|v| [v.x, v.y, v.z].map(|c| (c * 500.0) as f32)).collect();
    let mesh = (half, triangles.iter().map(|t| t.map(|i| i as usize)).collect());
    let bytes = binary_stl(&mesh, "machine.obj at half size, mm");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(folder.join("machine.stl"), &bytes).unwrap();
    }
    assert!(std::fs::read(folder.join("machine.stl")).unwrap() == bytes);
    let got = read("part.stl", "mm", &bytes);
    assert!(got.2 && got.3.is_empty() && got.1.len() == 10_000 && got.0.len() == vertices.len());
}

/// Every shipped equipment and tool file loads, cites its source, and has the placement that the cell states.
#[test]
fn the_shipped_equipment_loads() {
    let names = [
        "worktable",
        "conveyor",
        "machine",
        "machine_stl",
        "pallet",
        "machine_tool",
        "fixture",
        "column",
        "fence",
    ];
    let place = |(k, name): (usize, &&str)| {
        let x = 5000 + 4000 * k;
        format!(
            "[obstacle.a_{name}]\nfrom = \"equipment/{name}.toml\"\nplacement = {{ x_mm = {x}, y_mm = 5000, z_mm = 600 }}\n"
        )
    };
    let all: String = names.iter().enumerate().map(place).collect();
    let cell = format!(
        "from = \"hitachi_paper.toml\"\n[robot]\ntool = {{ from = \"equipment/gripper.toml\" }}\n{all}"
    );
    let loaded = crate::common::from_text(&cell).unwrap_or_else(|f| panic!("{f:#?}"));
    assert_eq!(loaded.cell.equipment.len(), names.len() + 1);
    assert_eq!(loaded.cell.robot.solids.last().unwrap().solid.name, "jaw right");
    let pallet = loaded.cell.equipment.iter().find(|e| e.name == "a_pallet").unwrap();
    assert_eq!(pallet.footprint.size, (1.2, 0.8));
    for file in
        loaded.sources.iter().filter(|s| s.path.starts_with("equipment/") && s.path.ends_with(".toml"))
    {
        assert!(file.text().contains("\nsource = \""), "{}", file.path);
    }
}

// --- hostile files ------------------------------------------------------------------------------

/// Returns texts and bytes made to break a reader, with the message expected for each.
fn crafted() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let stl = binary_stl(&cube(0.0, 100.0), "");
    let with = |at: usize, bytes: &[u8]| {
        let mut changed = stl.clone();
        changed.splice(at..at + bytes.len(), bytes.iter().copied());
        changed
    };
    let text = |from: &str, to: &str| {
        let text = String::from_utf8(text_stl(&cube(0.0, 100.0))).unwrap();
        text.replacen(from, to, 1).into_bytes()
    };
    let whole = String::from_utf8(text_stl(&cube(0.0, 100.0))).unwrap();
    let (v, f) = ("v 1 2 3\n", "f 1 2 3\n");
    let corners = "v 0 0 0\nv 9 0 0\nv 0 9 0\n";
    let mega = |t: &str| t.repeat(3_000_000 / t.len()).into_bytes();
    let point = |c: f32| c.to_le_bytes();
    vec![
        ("part.stl", Vec::new(), "a file of 0 bytes is not an STL file"),
        ("part.stl", vec![0; 83], "a file of 83 bytes is not an STL file"),
        ("part.stl", vec![0; 84], "the file has no triangles"),
        ("part.stl", vec![0; 134], "states 0 triangles, but the file is large enough for only 1"),
        ("part.stl", vec![0xff; 500], "states 4294967295 triangles, but the file is large enough for only 8"),
        ("part.stl", with(80, &u32::MAX.to_le_bytes()), "states 4294967295 triangles"),
        (
            "part.stl",
            with(80, &13u32.to_le_bytes()),
            "states 13 triangles, but the file is large enough for only 12",
        ),
        (
            "part.stl",
            stl[..stl.len() - 1].to_vec(),
            "states 12 triangles, but the file is large enough for only 11",
        ),
        (
            "part.stl",
            with(84 + 12, &point(f32::NAN)),
            "is not finite, or is too large for a workcell; is the unit right?, in triangle 1",
        ),
        ("part.stl", with(84 + 50 + 20, &point(f32::INFINITY)), "in triangle 2"),
        ("part.stl", with(84 + 12, &point(1e30)), "in triangle 1"),
        ("part.stl", binary_stl(&(vec![[1.0; 3]; 3], vec![[0, 1, 2]; 5]), ""), "the file has no triangles"),
        ("part.stl", text("vertex 0 0 0", "vertex nan 0 0"), "part.stl:2:1"),
        ("part.stl", text("vertex 0 0 0", "vertex 0 0"), "part.stl:2:1"),
        ("part.stl", text("vertex 0 0 0", "vertex 0 0 1e99"), "part.stl:2:1"),
        ("part.stl", text("vertex 0 0 0", "vertex 0 0 \u{202e}"), "part.stl:2:1"),
        ("part.stl", text("endloop", "endlop"), "part.stl:2:1"),
        ("part.stl", whole.as_bytes()[..whole.len() / 2].to_vec(), "the file is truncated"),
        ("part.stl", b"solid".to_vec(), "the file is truncated"),
        ("part.stl", b"solid x\nendsolid".to_vec(), "the file has no triangles"),
        ("part.stl", [whole.as_bytes(), b"  vertex \xff\n"].concat(), "this line is not text"),
        ("part.stl", mega("solid "), "the file is truncated"),
        ("part.stl", mega("solid\nfacet\n"), "more than 200000 triangles"),
        ("part.stl", mega("solid facet\n"), "the file is truncated"),
        (
            "part.stl",
            [b"solid\n".to_vec(), mega("vertex "), b"\nendsolid".to_vec()].concat(),
            "invalid facet",
        ),
        (
            "part.stl",
            [b"solid\n".to_vec(), mega("\n"), b"\nendsolid".to_vec()].concat(),
            "the file has no triangles",
        ),
        (
            "part.stl",
            binary_stl(&(vec![[1.0; 3]; 3], vec![[0, 1, 2]; 200_001]), ""),
            "more than 200000 triangles",
        ),
        ("part.obj", mega(v), "the file has no triangles"),
        ("part.obj", [mega(v), mega(v)].concat(), "more than 200000 triangles"),
        ("part.obj", mega(f), "more than 200000 triangles"),
        ("part.obj", [corners.as_bytes(), b"f", &mega(" 1 2 3")].concat(), "more than 200000 triangles"),
        (
            "part.obj",
            [corners.as_bytes(), &f.repeat(190_000).into_bytes(), b"f 1 2 4"].concat(),
            "does not exist",
        ),
        ("part.obj", b"\xff\xfe".to_vec(), "it is not UTF-8 text"),
        ("part.obj", [corners.as_bytes(), b"f 1 2 99999999999999999999"].concat(), "by integers"),
        ("part.obj", [corners.as_bytes(), b"f 1 2 -9"].concat(), "does not exist"),
    ]
}

/// Returns a valid file with a change that usually makes it invalid: the file is truncated, bytes are
/// changed, or pieces are repeated.
fn damaged(rng: &mut ChaCha8Rng) -> (&'static str, Vec<u8>) {
    let mesh = cube(0.0, 100.0);
    let kinds =
        [("part.stl", binary_stl(&mesh, "")), ("part.stl", text_stl(&mesh)), ("part.obj", obj(&mesh))];
    let (name, mut bytes) = kinds[rng.random_range(0..3)].clone();
    for _ in 0..rng.random_range(1..4) {
        let (a, b) = (rng.random_range(0..=bytes.len()), rng.random_range(0..=bytes.len()));
        let (from, to) = (a.min(b), a.max(b));
        match rng.random_range(0..4) {
            0 => bytes.truncate(from.max(to / 2)),
            1 => drop(bytes.drain(from..to.min(from + 30))),
            2 => drop(bytes.splice(from..from, bytes[from..to].to_vec()).count()),
            _ => bytes.iter_mut().skip(from).take(4).for_each(|b| *b = rng.random()),
        }
    }
    (name, bytes)
}

/// Loads a mesh and returns the peak memory above `bytes`, and the faults.
fn refused(name: &str, bytes: &[u8]) -> (u64, Option<Vec<Fault>>) {
    let mut result = None;
    let used = measure(|| result = Some(load(name, "mm", bytes)));
    let (loaded, opened) = result.unwrap();
    // The reader opens only named files, all of them in the folder.
    let known = ["cell.toml", "hitachi_paper.toml", name];
    assert!(
        opened
            .iter()
            .all(|p| known.contains(&&p[..]) || p.starts_with("robots/") || p.starts_with("equipment/"))
    );
    (used.bytes_max, loaded.err())
}

/// Checks that every fault has a file, a place and a help, and no hidden characters.
fn is_told(faults: &[Fault], what: &str) {
    assert!(faults.iter().any(Fault::is_error), "{what}");
    for fault in faults {
        let shown = fault.to_string();
        assert!(["cell.toml", "part.stl", "part.obj"].contains(&&fault.file[..]), "{what}: {shown}");
        assert!(fault.line >= 1 && fault.column >= 1 && !fault.help.is_empty(), "{what}: {shown}");
        assert!(!shown.chars().any(|c| c.is_control() && c != '\n'), "{what}: {shown:?}");
        assert!(shown.len() < 3000, "{what}: {shown}");
    }
}

/// Checks that reading needed at most four times the size of the file plus 64 MB.
fn is_modest(used: u64, bytes: &[u8], what: &str) {
    assert!(
        used <= 4 * bytes.len() as u64 + (64 << 20),
        "{what}: {used} bytes for a file of {}",
        bytes.len()
    );
}

#[test]
fn hostile_meshes_are_refused_with_a_place_and_little_memory() {
    for (k, (name, bytes, said)) in crafted().into_iter().enumerate() {
        let what = format!("crafted file {k}, which should say {said}");
        let (used, faults) = refused(name, &bytes);
        let faults = faults.unwrap_or_else(|| panic!("{what}: accepted"));
        is_told(&faults, &what);
        is_modest(used, &bytes, &what);
        let shown: Vec<_> = faults.iter().map(Fault::to_string).collect();
        assert!(shown.iter().any(|s| s.contains(said)), "{what}: {shown:?}");
    }
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut broken = 0;
    for k in 0..400 {
        let (name, bytes) = damaged(&mut rng);
        let (used, faults) = refused(name, &bytes);
        is_modest(used, &bytes, &format!("damaged file {k}"));
        if let Some(faults) = faults {
            is_told(&faults, &format!("damaged file {k}"));
            broken += 1;
        }
    }
    assert!(broken >= 200, "only {broken} of the damaged files were refused");
}

/// Valid meshes of the largest size also stay within the memory limit.
#[test]
fn the_largest_meshes_need_little_memory() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let n = 199_999;
    // Without shared corners, this number of triangles has the greatest number of vertices.
    let vertices: Vec<_> = (0..3 * n).map(|_| [0; 3].map(|_| rng.random_range(0.0..1000.0))).collect();
    let mesh = (vertices, (0..n).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect());
    for (name, bytes) in
        [("part.stl", binary_stl(&mesh, "")), ("part.stl", text_stl(&mesh)), ("part.obj", obj(&mesh))]
    {
        let (used, faults) = refused(name, &bytes);
        assert!(faults.is_none(), "{name}: {faults:#?}");
        is_modest(used, &bytes, name);
    }
}

/// Paths that lead elsewhere are refused before anything is opened.
#[test]
fn no_mesh_outside_the_folder_is_opened() {
    for name in [
        "../part.stl",
        "/etc/part.stl",
        "a/../../part.obj",
        "C:/part.stl",
        "..\\\\part.stl",
        "//host/part.stl",
    ] {
        let (loaded, opened) = load(name, "mm", &obj(&cube(0.0, 1.0)));
        assert!(loaded.is_err(), "{name}");
        assert!(opened.iter().all(|p| !p.contains("part")), "{name}: {opened:?}");
    }
}
