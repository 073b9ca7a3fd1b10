//! Seeds and words of the fuzzing: shipped files, broken files, reference data, and the files of tests/fuzz.

use crate::common::root;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use sweetspot::files::{FileKind, schema};

/// Small mesh that replaces every mesh file: a tetrahedron.
pub const OBJ: &str = "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// Small mesh that replaces every STL file: one triangle.
pub const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 100 0 0\nvertex 0 100 0\nendloop\nendfacet\nendsolid a\n";

/// Returns the bytes of the files of a folder whose names end in `end`, sorted by name.
pub fn files(folder: &str, end: &str) -> Vec<Vec<u8>> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    let paths: BTreeSet<_> = entries.map(|entry| entry.unwrap().path()).collect();
    let wanted = paths.iter().filter(|path| path.is_file() && path.to_string_lossy().ends_with(end));
    wanted.map(|path| std::fs::read(path).unwrap()).collect()
}

/// Returns the seed file `name` of tests/fuzz.
pub fn seed(name: &str) -> Vec<u8> {
    std::fs::read(root().join("tests/fuzz").join(name)).unwrap()
}

/// Returns the files that cells may name, by their paths: the files of cells/ and the parts of tests/broken.
pub fn named_files() -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    collect(&root().join("tests/broken"), "", &mut all);
    collect(&root().join("cells"), "", &mut all);
    all
}

fn collect(folder: &Path, prefix: &str, all: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{prefix}{}", path.file_name().unwrap().to_string_lossy());
        if path.is_dir() {
            collect(&path, &format!("{name}/"), all);
        } else {
            let small = std::fs::metadata(&path).unwrap().len() < 10_000;
            all.insert(name, if small { std::fs::read(&path).unwrap() } else { OBJ.into() });
        }
    }
}

/// Returns every key and every fixed word of the files, from the tables of keys.
pub fn keys_and_words() -> Vec<String> {
    fn collect(value: &Value, all: &mut BTreeSet<String>) {
        match value {
            Value::Object(entries) => {
                all.extend(
                    entries
                        .get("properties")
                        .and_then(Value::as_object)
                        .into_iter()
                        .flatten()
                        .map(|e| e.0.clone()),
                );
                let words = entries.get("enum").and_then(Value::as_array).into_iter().flatten();
                all.extend(words.filter_map(Value::as_str).map(|word| format!("\"{word}\"")));
                entries.values().for_each(|below| collect(below, all));
            }
            Value::Array(items) => items.iter().for_each(|item| collect(item, all)),
            _ => {}
        }
    }
    let mut all = BTreeSet::new();
    FileKind::ALL.into_iter().for_each(|kind| collect(&schema(kind), &mut all));
    let marks = [
        "[[robot.joint]]",
        "[operation.work]",
        "[search]",
        "{ min = 0, max = 1 }",
        "[]",
        "{}",
        "true",
        "\"\"\"",
        "'''",
    ];
    all.into_iter().chain(marks.map(String::from)).collect()
}

/// Returns the names and texts of a JSON document as words.
pub fn words_of_json(documents: &[Vec<u8>]) -> Vec<String> {
    fn collect(value: &Value, all: &mut BTreeSet<String>) {
        match value {
            Value::Object(entries) => entries.iter().for_each(|(name, below)| {
                all.insert(format!("\"{name}\""));
                collect(below, all);
            }),
            Value::Array(items) => items.iter().for_each(|item| collect(item, all)),
            other => drop(all.insert(other.to_string())),
        }
    }
    let mut all =
        BTreeSet::from(["null", "{}", "[]", "true", "1e999", "\"\\u0000\"", "\"\\ud800\""].map(String::from));
    documents
        .iter()
        .filter_map(|bytes| serde_json::from_slice(bytes).ok())
        .for_each(|d: Value| collect(&d, &mut all));
    all.into_iter().filter(|word| word.len() < 80).collect()
}

/// Returns words as owned texts for a target.
pub fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| word.to_string()).collect()
}
