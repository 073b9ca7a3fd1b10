//! Tests the book in docs/ and README.md: every command runs, the shown output is real, every link leads to a
//! target, and the generated pages are up to date.
//!
//! The command `SWEETSPOT_DOCS=write cargo test --test it docs::` runs every command again, writes the output
//! into the pages, and remakes the pictures and the reference pages. `git diff` then shows the changes.

mod blocks;
mod links;
mod reference;
mod results;
mod same;
mod session;

use crate::common::root;
use blocks::Block;
use session::Session;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Command that brings the book up to date.
const REMAKE: &str = "remake with: SWEETSPOT_DOCS=write cargo test --test it docs::";

/// Returns whether the tests write the files that they would otherwise check.
fn writes() -> bool {
    std::env::var_os("SWEETSPOT_DOCS").is_some_and(|word| word == "write")
}

/// Returns the paths of all Markdown files in a folder and below, in order.
fn markdown_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.append(&mut markdown_below(&path));
        } else if path.extension().is_some_and(|ending| ending == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Returns the pages of the book, and README.md.
fn pages() -> Vec<PathBuf> {
    let mut pages = markdown_below(&root().join("docs/src"));
    pages.push(root().join("README.md"));
    pages
}

fn name(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().to_string_lossy().into_owned()
}

/// Writes a file of the book, or adds a fault if the file has another content.
fn keep(path: &Path, text: &str, faults: &mut Vec<String>) {
    if writes() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    } else if std::fs::read_to_string(path).unwrap_or_default() != text {
        faults.push(format!("{} is stale", name(path)));
    }
}

#[test]
fn every_command_of_the_book_runs_and_prints_what_its_page_shows() {
    let mut pages = pages();
    pages.reverse(); // README.md and the tutorial take longest, so they begin
    let (next, faults, count) = (Mutex::new(0), Mutex::new(Vec::new()), Mutex::new(0));
    let work = || loop {
        let at = {
            let mut next = next.lock().unwrap();
            *next += 1;
            *next - 1
        };
        let Some(page) = pages.get(at) else { return };
        let text = std::fs::read_to_string(page).unwrap();
        let mut session = Session::new(page, &text);
        let written = blocks::replaced(&text, |block: &mut Block| session.run(block));
        *count.lock().unwrap() += session.commands;
        faults.lock().unwrap().append(&mut session.faults);
        if writes() && written != text {
            std::fs::write(page, written).unwrap();
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    let (faults, count) = (faults.into_inner().unwrap(), count.into_inner().unwrap());
    assert!(faults.is_empty(), "{}\n{REMAKE}", faults.join("\n"));
    assert!(count >= 60, "only {count} commands were found in the book");
}

#[test]
fn the_reference_pages_are_current() {
    let mut faults = Vec::new();
    for (path, text) in reference::pages() {
        keep(&root().join("docs/src/reference").join(path), &text, &mut faults);
    }
    assert!(faults.is_empty(), "{}\n{REMAKE}", faults.join("\n"));
}

#[test]
fn commands_within_the_text_exist_with_their_options() {
    let helps = reference::helps();
    let mut faults = Vec::new();
    let mut count = 0;
    for page in pages() {
        let text = blocks::without_blocks(&std::fs::read_to_string(&page).unwrap());
        for said in
            links::code_spans(&text).filter_map(|span| span.strip_prefix("sweetspot ").map(String::from))
        {
            let command = said.split_whitespace().next().unwrap_or_default();
            count += 1;
            let Some(help) = helps.get(command) else {
                if !command.starts_with(['-', 'C']) {
                    faults.push(format!("{}: there is no command `sweetspot {said}`", name(&page)));
                }
                continue;
            };
            for option in said.split_whitespace().filter(|word| word.starts_with("--")) {
                let option = option.split('=').next().unwrap();
                let is_known = help.split([' ', ',', '\n']).any(|word| word == option);
                if !is_known {
                    faults.push(format!("{}: `sweetspot {said}` has no {option}", name(&page)));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 40, "only {count} commands were found in the text");
}

#[test]
fn every_relative_link_leads_to_a_file_and_a_heading() {
    let mut pages = pages();
    pages.extend(["CONTRIBUTING.md", "CHANGELOG.md"].map(|file| root().join(file)));
    for folder in ["results", "tests"] {
        let own = markdown_below(&root().join(folder));
        pages.extend(
            own.into_iter().filter(|path| !path.components().any(|part| part.as_os_str() == "node_modules")),
        );
    }
    let mut count = 0;
    let faults: Vec<String> = pages.iter().flat_map(|page| links::faults(page, &mut count)).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 150, "only {count} links were found");
}

#[test]
fn the_table_of_contents_lists_every_page_once() {
    let source = root().join("docs/src");
    let summary = std::fs::read_to_string(source.join("SUMMARY.md")).unwrap();
    let mut listed: Vec<PathBuf> = links::targets(&summary).map(|target| source.join(target)).collect();
    listed.push(source.join("SUMMARY.md"));
    listed.sort();
    assert_eq!(listed, markdown_below(&source));
}
