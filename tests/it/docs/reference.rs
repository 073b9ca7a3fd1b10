//! Reference pages of the book, which the program generates: commands from their definitions, keys from the
//! table of keys, and documents from their schemas.

use crate::cli::sandbox::Sandbox;
use std::collections::BTreeMap;
use sweetspot::files::FileKind;
use sweetspot::record::DocumentKind;

/// First line of a generated page.
const GENERATED: &str = "<!-- Made by SWEETSPOT_DOCS=write cargo test --test it docs:: -->\n\n";

/// Returns the names of all generated pages with their texts.
pub fn pages() -> Vec<(String, String)> {
    let shop = Sandbox::new();
    let made = |args: &[&str]| GENERATED.to_string() + &shop.done(args).out;
    let files = FileKind::ALL.map(|kind| (format!("keys-{}.md", kind.name()), kind.name()));
    let documents = DocumentKind::ALL.map(|kind| (format!("documents/{}.md", kind.name()), kind.name()));
    let references = files.into_iter().chain(documents);
    let mut pages: Vec<_> =
        references.map(|(path, kind)| (path, made(&["schema", kind, "--markdown"]))).collect();
    pages.push(("commands.md".into(), made(&["man", "--markdown"])));
    pages
}

/// Returns the help of every command.
pub fn helps() -> BTreeMap<String, String> {
    let shop = Sandbox::new();
    let help = shop.done(&["--help"]).out;
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    let names = names.map(|line| line.split_whitespace().next().unwrap().to_string());
    names.map(|name| (name.clone(), shop.done(&[&name, "--help"]).out)).collect()
}
