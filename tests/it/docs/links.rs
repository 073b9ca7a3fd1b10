//! Links of Markdown pages: every relative link must lead to a file, and to a heading if the link names a
//! heading.

use super::blocks::without_blocks;
use super::name;
use crate::common::root;
use std::path::{Path, PathBuf};

/// Returns the targets of all links and pictures of a text without code blocks.
pub fn targets(text: &str) -> impl Iterator<Item = String> {
    let plain = without_spans(text);
    let ends: Vec<usize> = plain.match_indices("](").map(|(at, _)| at + 2).collect();
    ends.into_iter().map(move |at| plain[at..].split(')').next().unwrap().trim().to_string())
}

/// Returns the inline code of a text without code blocks.
pub fn code_spans(text: &str) -> impl Iterator<Item = String> {
    let paragraphs: Vec<String> = text.split("\n\n").map(str::to_string).collect();
    paragraphs.into_iter().flat_map(|paragraph| {
        let spans: Vec<String> = paragraph.split('`').skip(1).step_by(2).map(one_line).collect();
        spans
    })
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn without_spans(text: &str) -> String {
    text.split("\n\n").map(|p| p.split('`').step_by(2).collect::<Vec<_>>().join("`") + "\n\n").collect()
}

/// Returns the anchor that mdBook and GitHub give to a heading.
fn anchor(heading: &str) -> String {
    let heading = heading.trim().to_lowercase();
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Returns the anchors of all headings of a page. A repeated heading gets a number.
fn anchors(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for line in without_blocks(text).lines().filter(|line| line.starts_with('#')) {
        let own = anchor(line.trim_start_matches('#'));
        let count = found.iter().filter(|known| **known == own).count();
        found.push(if count == 0 { own } else { format!("{own}-{count}") });
    }
    found
}

/// Returns the faults of the links of a page, and adds the number of links to `count`.
pub fn faults(page: &Path, count: &mut usize) -> Vec<String> {
    let text = std::fs::read_to_string(page).unwrap();
    let book = root().join("docs/src");
    let mut faults = Vec::new();
    for target in targets(&without_blocks(&text)) {
        if target.starts_with("http://") || target.starts_with("https://") {
            continue;
        }
        *count += 1;
        let (file, heading) = target.split_once('#').unwrap_or((&target, ""));
        let path =
            if file.is_empty() { page.to_path_buf() } else { plain(&page.parent().unwrap().join(file)) };
        let mut fault = |what: &str| faults.push(format!("{}: {target}: {what}", name(page)));
        if !path.exists() {
            fault("the file does not exist");
        } else if page.starts_with(&book) && !path.starts_with(&book) {
            fault("a page of the book can link only to its own files");
        } else if !heading.is_empty()
            && !anchors(&std::fs::read_to_string(&path).unwrap()).contains(&heading.into())
        {
            fault("the page has no such heading");
        }
    }
    faults
}

/// Returns a path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir => {
                plain.pop();
            }
            std::path::Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

#[test]
fn a_broken_link_is_seen() {
    let folder = tempfile::tempdir_in(root().join("target")).unwrap();
    let page = folder.path().join("page.md");
    let text = "# One two\n\n[a](page.md#one-two) [b](#one-two) [c](#three) [d](gone.md) `[e](x)`\n\n```text\n[f](y)\n```\n";
    std::fs::write(&page, text).unwrap();
    let mut count = 0;
    let faults = faults(&page, &mut count);
    assert_eq!(count, 4);
    let has = |at: usize, word: &str| faults[at].contains(word);
    assert!(faults.len() == 2 && has(0, "no such heading") && has(1, "does not exist"), "{faults:?}");
}
