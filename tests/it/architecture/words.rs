//! Tests the words of src: a type name has one meaning, and each sentence of a doc comment is clear alone.

use super::sources::{File, sources};
use std::collections::BTreeMap;

/// Beginnings of sentences that are unclear without the neighbouring sentences.
const ELLIPSES: [&str; 6] = ["Of", "The same", "Its", "What is", "Those", "With"];

/// Returns the names of the types that a file defines, each with its line. Associated types are not counted.
fn types(file: &File) -> Vec<(String, usize)> {
    let name = |line: &str| {
        let mut words =
            line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
        let keyword = words.find(|word| !["pub", "crate", "super", "in", "self"].contains(word))?;
        let is_type =
            ["struct", "enum", "trait"].contains(&keyword) || keyword == "type" && !line.starts_with(' ');
        words.next().filter(|_| is_type).map(String::from)
    };
    file.code.lines().enumerate().filter_map(|(k, line)| Some((name(line)?, k + 1))).collect()
}

/// Returns every line of a doc comment at which a sentence begins, with its line number.
fn sentences(file: &File) -> Vec<(String, usize)> {
    let text = |line: &str| {
        let line = line.trim_start();
        let marked = line.strip_prefix("///").or(line.strip_prefix("//!"))?;
        (!marked.starts_with('/')).then(|| marked.trim().to_string())
    };
    let lines: Vec<Option<String>> = file.text.lines().map(text).collect();
    let ends = |line: &Option<String>| {
        line.as_ref().is_none_or(|text| text.is_empty() || text.ends_with(['.', ':']))
    };
    let is_first = |k: &usize| *k == 0 || ends(&lines[*k - 1]);
    (0..lines.len()).filter(is_first).filter_map(|k| Some((lines[k].clone()?, k + 1))).collect()
}

fn begins_with(text: &str, start: &str) -> bool {
    text.strip_prefix(start).is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

#[test]
fn every_type_name_is_unique() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in sources() {
        for (name, line) in types(file) {
            places.entry(name).or_default().push(format!("src/{}:{line}", file.path));
        }
    }
    assert!(places.len() > 300, "only {} types seen", places.len());
    let shared = places.iter().filter(|(_, places)| places.len() > 1);
    let found: Vec<_> =
        shared.flat_map(|(name, places)| places.iter().map(move |p| format!("{p}: type {name}"))).collect();
    assert!(found.is_empty(), "names of more than one type:\n{}", found.join("\n"));
}

#[test]
fn every_doc_comment_means_something_alone() {
    let mut count = 0;
    let mut found = Vec::new();
    for file in sources() {
        for (text, line) in sentences(file) {
            count += 1;
            if ELLIPSES.iter().any(|start| begins_with(&text, start)) {
                found.push(format!("src/{}:{line}: {text}", file.path));
            }
        }
    }
    assert!(count > 3000, "only {count} doc comments seen");
    assert!(
        found.is_empty(),
        "sentences of doc comments that begin with one of {ELLIPSES:?}:\n{}",
        found.join("\n")
    );
}
