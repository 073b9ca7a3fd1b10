//! Tests the rules for the source text of src. Most rules forbid something, which no other test can detect.
//!
//! Comments and strings are blanked before the search.

mod circles;
pub mod sources;
mod words;

use sources::{File, paths_from, sources, uses_crate, with_words};
use std::collections::BTreeSet;

/// Modules in the order in which data flows. Each module uses only modules before it.
const ORDER: [&str; 36] = [
    "units",
    "safe_text",
    "geometry",
    "contour",
    "pose",
    "low_discrepancy",
    "mesh",
    "colours",
    "svg_text",
    "cell",
    "robot",
    "kinematic_error",
    "calibration",
    "reading",
    "allocation",
    "verification",
    "reach",
    "correction",
    "pose_accuracy",
    "clearance",
    "motion",
    "cycle_time",
    "certificate",
    "error_map",
    "layout",
    "region",
    "proof",
    "search",
    "assess",
    "drawing",
    "raster",
    "files",
    "record",
    "report",
    "cli",
    "study",
];

/// The sources contain no tests, so the library is compiled once for the program and the tests.
#[test]
fn src_holds_no_tests() {
    let holds = |f: &&File| ["cfg(test)", "cfg!(test)", "#[test]"].iter().any(|word| f.text.contains(word));
    let found: Vec<_> = sources().iter().filter(holds).map(|f| f.path.clone()).collect();
    assert!(found.is_empty(), "tests belong in tests/it: {found:?}");
}

#[test]
fn the_core_does_no_io() {
    let outside = ["fs", "env", "io", "net", "process", "thread"];
    for file in sources().iter().filter(|f| !f.is_edge()) {
        for path in paths_from(&file.code, "std::") {
            // The STL reader needs a cursor over bytes in memory, which does no input or output.
            let cursor = file.path == "mesh/stl.rs" && path == "io" && !file.code.contains("File");
            assert!(cursor || !outside.contains(&path.as_str()), "src/{} uses std::{path}", file.path);
        }
    }
    let words = ["println!", "print!", "dbg!", "Instant", "SystemTime", "stdout", "stderr", "stdin"];
    let found = with_words(&words, File::is_edge);
    assert!(found.is_empty(), "outside cli: {found:#?}");
    // Built-in files are not input or output, but only the version and these two modules need them.
    let built_in = with_words(&["include_str!", "include_bytes!", "option_env!"], |f| {
        // These modules contain the built-in robots and the assets of the browser pages.
        ["cli/library.rs", "report/page/assets.rs"].contains(&f.path.as_str())
    });
    assert!(built_in.is_empty(), "{built_in:#?}");
}

#[test]
fn every_heavy_crate_has_one_home() {
    let homes = |name: &str| -> BTreeSet<String> {
        let files = sources();
        let users = files.iter().filter(|f| uses_crate(&f.code, name));
        users.map(|f| f.module().to_string()).collect()
    };
    let only = |name: &str| BTreeSet::from([name.to_string()]);
    assert_eq!(homes("parry3d"), only("clearance"));
    assert_eq!(homes("argmin"), only("search"));
    assert_eq!(homes("pulp"), only("error_map"));
    let programs = sources().iter().filter(|f| uses_crate(&f.code, "clarabel"));
    let programs: Vec<_> = programs.map(|f| f.path.clone()).collect();
    let allowed = |path: &str| {
        let homes = ["layout/separate.rs", "allocation/cone_program.rs"];
        homes.contains(&path) || path.starts_with("reach/numeric/")
    };
    assert!(programs.iter().all(|path| allowed(path)), "clarabel is used in {programs:?}");
    for (name, home) in [
        ("clap", "cli"),
        ("indicatif", "cli"),
        ("ctrlc", "cli"),
        ("hyper", "cli"),
        ("tokio", "cli"),
        ("tempfile", "cli"),
    ] {
        assert_eq!(homes(name), only(home), "{name}");
    }
    for name in ["minijinja", "base64", "gltf_json"] {
        assert_eq!(homes(name), only("report"), "{name}");
    }
    // Only one file uses the crates for PDF.
    for name in ["svg2pdf", "pdf_writer", "notosans"] {
        let users: Vec<_> =
            sources().iter().filter(|f| uses_crate(&f.code, name)).map(|f| f.path.clone()).collect();
        assert_eq!(users, ["report/pdf/file.rs"], "{name}");
    }
    // Hashes are computed for files that are read and written, and for the scripts that a page may run.
    assert_eq!(homes("sha2"), BTreeSet::from(["cli", "report"].map(String::from)));
    for (name, home) in
        [("toml", "files"), ("tobj", "mesh"), ("stl_io", "mesh"), ("roxmltree", "files"), ("csv", "report")]
    {
        let users: Vec<_> = sources().iter().filter(|f| f.code.contains(&format!("{name}::"))).collect();
        // `report::toml` and `report::csv` are modules of this crate. Tables of targets are also CSV files.
        let is_input = |f: &File| name == "csv" && f.path == "files/targets.rs";
        let is_home = |f: &File| f.module() == home || is_input(f);
        let foreign = users.iter().filter(|f| !is_home(f) && !f.code.contains(&format!("report::{name}::")));
        assert_eq!(foreign.map(|f| f.path.clone()).collect::<Vec<_>>(), [""; 0], "{name} outside {home}");
    }
}

#[test]
fn no_heavy_crate_shows_in_a_public_signature() {
    // Methods of a foreign trait are not `pub`. Public methods use types of this crate.
    let foreign = ["pm::", "parry3d::", "argmin::", "clarabel::", "SharedShape", "TriMesh", "Aabb"];
    for file in sources() {
        let lines = file.code.lines().filter(|l| l.trim_start().starts_with("pub "));
        for line in lines.filter(|l| !l.trim_start().starts_with("pub use")) {
            assert!(!foreign.iter().any(|f| line.contains(f)), "src/{}: {line}", file.path);
        }
    }
}

#[test]
fn a_module_uses_only_those_above_it() {
    let rank = |module: &str| ORDER.iter().position(|m| *m == module);
    let mut uses = 0;
    for file in sources() {
        let module = file.module();
        if ["lib", "main", "core"].contains(&module) {
            continue;
        }
        let own = rank(module).unwrap_or_else(|| panic!("src/{} has no place in the order", file.path));
        let mut used = paths_from(&file.code, "crate::");
        // In the first file of a module, `super` leads out of the module.
        let is_root = !file.path.contains('/') || file.path == format!("{module}/mod.rs");
        if is_root {
            used.extend(paths_from(&file.code, "super::"));
        }
        assert!(!file.code.contains("super::super"), "src/{}: write crate:: instead", file.path);
        for name in used {
            let other = rank(&name).unwrap_or_else(|| panic!("src/{} uses crate::{name}", file.path));
            assert!(other <= own, "src/{} uses {name}, which comes after {module}", file.path);
            uses += 1;
        }
    }
    assert!(uses > 80, "only {uses} uses seen");
}

#[test]
fn lib_rs_names_every_module_and_holds_no_logic() {
    let roots: Vec<&File> =
        sources().iter().filter(|f| ["lib.rs", "core/lib.rs"].contains(&f.path.as_str())).collect();
    let modules: BTreeSet<String> = roots.iter().flat_map(|lib| paths_from(&lib.code, "pub mod ")).collect();
    assert_eq!(modules, ORDER.iter().map(|m| m.to_string()).collect());
    for lib in &roots {
        assert!(!lib.code.contains("fn "), "logic in {}", lib.path);
    }
}

/// The compiler and its lints ignore a file that no module declares.
#[test]
fn a_module_declares_every_file_of_src() {
    let all = sources();
    let undeclared = |path: &str| {
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
        let (parents, name) = match (folder, name) {
            (_, "mod.rs") => match folder.rsplit_once('/') {
                Some((above, name)) => (vec![format!("{above}/mod.rs"), format!("{above}.rs")], name),
                None => (Vec::new(), folder),
            },
            ("", name) => (Vec::new(), name.trim_end_matches(".rs")),
            (folder, name) => {
                (vec![format!("{folder}/mod.rs"), format!("{folder}.rs")], name.trim_end_matches(".rs"))
            }
        };
        let roots = ["lib.rs", "core/lib.rs"].map(str::to_string).to_vec();
        let parents = if parents.is_empty() { roots } else { parents };
        let mut homes = all.iter().filter(|f| parents.contains(&f.path));
        let words = [format!("mod {name};"), format!("#[path = \"{name}.rs\"]")];
        !homes.any(|f| words.iter().any(|word| f.text.contains(word)))
    };
    let mut lost: Vec<_> = all.iter().map(|f| f.path.as_str()).filter(|path| undeclared(path)).collect();
    lost.sort_unstable();
    assert_eq!(lost, ["core/lib.rs", "lib.rs", "main.rs"]);
}

#[test]
fn src_has_no_unsafe_code() {
    let found: Vec<_> =
        sources().iter().filter(|f| uses_crate(&f.code, "unsafe")).map(|f| f.path.clone()).collect();
    assert!(found.is_empty(), "{found:?}");
    let manifest = std::fs::read_to_string(crate::common::root().join("Cargo.toml")).unwrap();
    assert!(manifest.contains("unsafe_code = \"forbid\""));
}

/// The core is total: every function returns a value or a reason and never panics.
#[test]
fn nothing_panics_on_purpose() {
    let words = [
        ".unwrap()",
        ".expect(",
        ".unwrap_err()",
        ".expect_err(",
        "panic!",
        "todo!",
        "unimplemented!",
        "unreachable!",
        ".unwrap_unchecked(",
    ];
    let found = with_words(&words, |_| false);
    assert!(found.is_empty(), "{found:#?}");
    // Assertions are allowed only in debug builds.
    let asserts = with_words(&["assert!(", "assert_eq!(", "assert_ne!("], |_| false);
    let hard: Vec<_> = asserts.iter().filter(|l| !l.contains("debug_assert")).collect();
    assert!(hard.is_empty(), "{hard:#?}");
}

/// Only units.rs contains factors between units.
///
/// The only exception is `files/keys/solid.rs`. That file has a table of the units that a mesh file may have,
/// with the length of each unit in metres.
#[test]
fn only_units_rs_converts_units() {
    let words = ["to_radians", "to_degrees", "180.0", "0.001", "57.29", "0.01745"];
    let factors = ["1000.0", "1000.", "1_000.0", "1e3", "1e-3", "1.0e3", "1.0e-3"];
    let times = |line: &str| {
        let scaled =
            |op: &str, f: &str| line.contains(&format!("{op} {f}")) || line.contains(&format!("{f} {op}"));
        factors.iter().any(|f| ["*", "/", "*=", "/="].iter().any(|op| scaled(op, f)))
    };
    let mut found = with_words(&words, |f| f.path == "units.rs");
    for file in sources().iter().filter(|f| f.path != "units.rs") {
        let lines = file.code.lines().filter(|l| times(l));
        found.extend(lines.map(|l| format!("src/{}: {}", file.path, l.trim())));
    }
    assert!(found.is_empty(), "{found:#?}");
    let inches = with_words(&["0.0254", "25.4"], |f| f.path == "units.rs");
    assert!(inches.is_empty(), "{inches:#?}");
    // The conversions are in units.rs.
    let units = sources().iter().find(|f| f.path == "units.rs").unwrap();
    assert!(["to_radians", "to_degrees", "/ 1000.0", "* 1000.0"].iter().all(|w| units.code.contains(w)));
}

/// Randomness comes only from the seed: no generator seeds itself, and no loop depends on the order of a hash
/// map.
#[test]
fn nothing_depends_on_an_unseeded_random_source() {
    let found =
        with_words(&["thread_rng", "from_entropy", "from_os_rng", "rand::rng()", "RandomState"], |_| false);
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn the_agreed_packages_are_dependencies() {
    let manifest = std::fs::read_to_string(crate::common::root().join("Cargo.toml")).unwrap();
    let section = manifest.split("[workspace.dependencies]").nth(1).unwrap().split("\n[").next().unwrap();
    let package = |line: &str| {
        let (key, value) = line.split_once('=')?;
        let renamed = value.split_once("package = \"").and_then(|(_, rest)| rest.split('"').next());
        Some(renamed.unwrap_or(key.trim()).to_string())
    };
    let lines = section.lines().filter(|l| !l.starts_with('#'));
    let packages: Vec<String> = lines.filter_map(package).collect();
    for wanted in ["nalgebra", "clarabel", "argmin", "rayon", "serde"] {
        assert!(packages.iter().any(|p| p == wanted), "{wanted} is not a dependency");
    }
    // The name of the crate depends on the precision: parry3d or parry3d-f64.
    assert!(packages.iter().any(|p| p == "parry3d" || p == "parry3d-f64"), "parry3d is not a dependency");
}

#[test]
fn the_top_level_holds_only_the_agreed_entries() {
    let folders = ["src", "cells", "tests", "benches", "results", "docs", "python", "target"];
    let files = [
        "Cargo.toml",
        "Cargo.lock",
        "README.md",
        "CHANGELOG.md",
        "CONTRIBUTING.md",
        "rustfmt.toml",
        "deny.toml",
    ];
    for entry in std::fs::read_dir(crate::common::root()).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().to_string_lossy().into_owned();
        let known = match entry.path().is_dir() {
            true => folders.contains(&name.as_str()),
            false => files.contains(&name.as_str()) || name.starts_with("LICENSE"),
        };
        assert!(known || name.starts_with('.'), "{name} has no place at the top level");
    }
    for needed in ["Cargo.toml", "Cargo.lock", "src", "cells", "tests", "benches"] {
        assert!(crate::common::root().join(needed).exists(), "{needed} is missing");
    }
}
