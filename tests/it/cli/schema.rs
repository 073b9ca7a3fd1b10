//! Tests `schema`: it prints the files of cells/schemas, where every shipped file looks for them.

use crate::cli::sandbox::*;
use crate::common::root;

const KINDS: [&str; 4] = ["cell", "robot", "equipment", "tool"];

#[test]
fn the_committed_schemas_equal_the_printed_ones() {
    let shop = Sandbox::new();
    for kind in KINDS {
        let committed = shop.text(&format!("cells/schemas/{kind}.schema.json"));
        let ran = shop.done(&["schema", kind]);
        assert!(ran.out == committed, "run: sweetspot schema --out cells/schemas ({kind} differs)");
        assert_eq!(ran.err, "next: sweetspot schema --out schemas\n");
    }
    assert_eq!(shop.done(&["schema"]).out, shop.text("cells/schemas/cell.schema.json"));
}

#[test]
fn all_schemas_are_written_into_a_folder_and_rewritten() {
    let shop = Sandbox::new();
    shop.done(&["schema", "--out", "mine/schemas"]);
    shop.write("mine/schemas/robot.schema.json", "of another version");
    let ran = shop.done(&["schema", "--out", "mine/schemas"]);
    assert!(
        ran.out.is_empty() && ran.err.contains("#:schema ./mine/schemas/cell.schema.json"),
        "{}",
        ran.err
    );
    assert_eq!(shop.files("mine/schemas").len(), 4);
    for kind in KINDS {
        let name = format!("schemas/{kind}.schema.json");
        assert_eq!(shop.read(&format!("mine/{name}")), shop.read(&format!("cells/{name}")), "{kind}");
    }
}

#[test]
fn the_reference_of_keys_is_printed_and_written() {
    let shop = Sandbox::new();
    let cell = shop.done(&["schema", "--markdown"]).out;
    assert!(
        cell.starts_with("# Keys of cell files\n") && cell.contains("\n| `budget` | whole number"),
        "{cell}"
    );
    shop.done(&["schema", "--markdown", "--out", "reference"]);
    assert_eq!(shop.files("reference").len(), KINDS.len());
    for kind in KINDS {
        let written = shop.text(&format!("reference/{kind}.md"));
        assert_eq!(written, shop.done(&["schema", kind, "--markdown"]).out);
    }
    assert_eq!(shop.run(&["schema", "search-result", "--markdown"]).code, Some(2));
}

#[test]
fn bad_usage_of_schema_is_reported() {
    let shop = Sandbox::new();
    for args in [&["schema", "cells"][..], &["schema", "robot", "--out", "x"], &["schema", "--out"]] {
        assert_eq!(shop.run(args).code, Some(2), "{args:?}");
    }
    shop.write("file", "");
    assert_eq!(shop.run(&["schema", "--out", "file/schemas"]).code, Some(3));
    assert!(shop.done(&["schema", "--help"]).out.starts_with("Example: sweetspot schema "));
}

/// The first line of every shipped file gives a path that leads to the schema of its kind.
#[test]
fn every_shipped_file_names_its_schema() {
    let mut count = 0;
    for folder in ["cells", "cells/robots", "cells/equipment"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "toml") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let named = text.lines().next().unwrap().strip_prefix("#:schema ");
            let named = named.unwrap_or_else(|| panic!("{} names no schema", path.display()));
            assert!(path.parent().unwrap().join(named).is_file(), "{}: {named}", path.display());
            let kind =
                KINDS.into_iter().find(|kind| text.contains(&format!("\nschema = \"sweetspot/{kind}/1\"")));
            let kind = kind.unwrap_or(if folder == "cells" { "cell" } else { "robot" });
            assert!(named.ends_with(&format!("/{kind}.schema.json")), "{}: {named}", path.display());
            count += 1;
        }
    }
    assert!(count >= 42, "{count} files");
}
