//! Tests that the modules of every folder have no circular dependencies, so that they form layers.

use super::sources::{File, heads_at, sources};
use std::collections::{BTreeMap, BTreeSet};

/// Modules of a folder, each with the neighbouring modules that it uses and a line of code that uses them.
type Uses = BTreeMap<String, BTreeMap<String, String>>;

/// Returns the folder to which `super::` leads in a file: `reach` for reach/scara.rs and
/// reach/numeric/mod.rs.
fn parent(path: &str) -> &str {
    let path = path.strip_suffix("/mod.rs").unwrap_or(path);
    path.rsplit_once('/').map_or("", |(folder, _)| folder)
}

/// Returns the module of `folder` that a file belongs to: `numeric` for reach/numeric/goal.rs in `reach`.
fn member<'a>(path: &'a str, folder: &str) -> Option<&'a str> {
    let below = path.strip_prefix(folder)?.strip_prefix('/')?;
    let name = below.split('/').next()?.trim_end_matches(".rs");
    (name != "mod").then_some(name)
}

/// Returns, for each name that the root of a folder reexports, the module that defines the name.
fn reexports(files: &[File], folder: &str, members: &BTreeSet<&str>) -> BTreeMap<String, String> {
    let roots = [format!("{folder}/mod.rs"), format!("{folder}.rs")];
    let mut names = BTreeMap::new();
    for root in files.iter().filter(|f| roots.contains(&f.path)) {
        for &of in members {
            let taken = heads_at(&root.code, &format!("use {of}::"));
            names.extend(taken.into_iter().map(|(name, _)| (name, of.to_string())));
            if root.code.contains(&format!("use {of}::*")) {
                let own = files.iter().filter(|f| member(&f.path, folder) == Some(of));
                let defined = own.flat_map(|f| f.code.lines().filter_map(public_name));
                names.extend(defined.map(|name| (name, of.to_string())));
            }
        }
    }
    names
}

/// Returns the public name that an unindented line defines; None for any other line.
fn public_name(line: &str) -> Option<String> {
    let mut words = line.strip_prefix("pub ")?.split(|c: char| !c.is_alphanumeric() && c != '_');
    let kinds = ["struct", "enum", "trait", "type", "fn", "const", "static"];
    words.find(|word| kinds.contains(word))?;
    words.next().map(String::from)
}

/// Returns the dependencies between the modules of a folder.
fn uses(files: &[File], folder: &str) -> Uses {
    let members: BTreeSet<&str> = files.iter().filter_map(|f| member(&f.path, folder)).collect();
    let reexports = reexports(files, folder, &members);
    let mut uses = Uses::new();
    for file in files {
        let Some(own) = member(&file.path, folder) else { continue };
        let absolute = format!("crate::{}::", folder.replace('/', "::"));
        let mut names = heads_at(&file.code, &absolute);
        if parent(&file.path) == folder {
            names.extend(heads_at(&file.code, "super::"));
        }
        for (name, line) in names {
            let other = members.get(name.as_str()).copied().or(reexports.get(&name).map(String::as_str));
            if let Some(other) = other.filter(|other| *other != own) {
                let place = format!("src/{}:{line}: {own} uses {other} ({name})", file.path);
                uses.entry(own.to_string()).or_default().entry(other.to_string()).or_insert(place);
            }
        }
    }
    uses
}

/// Returns every module that a module uses directly or indirectly.
fn reached<'a>(uses: &'a Uses, from: &str) -> BTreeSet<&'a str> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from];
    while let Some(at) = open.pop() {
        for next in uses.get(at).into_iter().flat_map(BTreeMap::keys) {
            if seen.insert(next.as_str()) {
                open.push(next);
            }
        }
    }
    seen
}

#[test]
fn no_circles_inside_a_folder() {
    let files = sources();
    let folders: BTreeSet<&str> =
        files.iter().map(|f| f.path.rsplit_once('/').map_or("", |(d, _)| d)).collect();
    let (mut seen, mut found) = (0, Vec::new());
    for folder in folders.into_iter().filter(|folder| !folder.is_empty()) {
        let uses = uses(files, folder);
        for (own, others) in &uses {
            seen += others.len();
            let back = others.iter().filter(|(other, _)| reached(&uses, other).contains(own.as_str()));
            found.extend(back.map(|(_, place)| place.clone()));
        }
    }
    assert!(seen > 150, "only {seen} uses seen");
    assert!(found.is_empty(), "circles between modules of one folder:\n{}", found.join("\n"));
}
