//! Reads the source files as text and finds code, paths and words in them.

use std::path::Path;
use std::sync::LazyLock;

/// Source file of src.
pub struct File {
    /// Path below src or, for a module of the core, below src/core, with forward slashes.
    pub path: String,
    pub text: String,
    /// Text with comments and the contents of strings blanked.
    pub code: String,
}

impl File {
    /// Returns the top module of the file: `cell` for cell/layout.rs, `pose` for pose.rs.
    pub fn module(&self) -> &str {
        self.path.split('/').next().unwrap().trim_end_matches(".rs")
    }

    /// Returns whether the file belongs to the edge, the only part that may access the outside world.
    pub fn is_edge(&self) -> bool {
        ["cli", "main"].contains(&self.module())
    }
}

/// Returns every source file of src. The files are read once.
pub fn sources() -> &'static [File] {
    static SOURCES: LazyLock<Vec<File>> = LazyLock::new(|| {
        let mut files = Vec::new();
        collect(&crate::common::root().join("src"), "", &mut files);
        for file in files.iter_mut().filter(|f: &&mut File| f.path != "core/lib.rs") {
            file.path = file.path.trim_start_matches("core/").to_string();
        }
        assert!(files.len() > 40, "only {} files found", files.len());
        files
    });
    &SOURCES
}

fn collect(folder: &Path, prefix: &str, files: &mut Vec<File>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let path = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            collect(&entry.path(), &format!("{path}/"), files);
        } else if path.ends_with(".rs") {
            let text = std::fs::read_to_string(entry.path()).unwrap();
            files.push(File { path, code: code_of(&text), text });
        }
    }
}

/// Returns a text in which comments and the contents of strings are blanked. Line breaks remain.
fn code_of(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut code = String::with_capacity(text.len());
    let mut k = 0;
    while k < chars.len() {
        let end = end_of_no_code(&chars, k);
        if end > k {
            code.push_str(if chars[k] == '/' { " " } else { "\"\"" });
            code.extend(chars[k..end].iter().filter(|&&c| c == '\n'));
            k = end;
        } else {
            code.push(chars[k]);
            k += 1;
        }
    }
    code
}

/// Returns the end of the comment, string or character that starts at `k`; returns `k` if none of these
/// starts there.
fn end_of_no_code(chars: &[char], k: usize) -> usize {
    let starts = |word: &str| word.chars().enumerate().all(|(i, c)| chars.get(k + i) == Some(&c));
    let in_name = k > 0 && (chars[k - 1].is_alphanumeric() || chars[k - 1] == '_');
    if starts("//") {
        return (k..chars.len()).find(|&i| chars[i] == '\n').unwrap_or(chars.len());
    }
    if starts("/*") {
        return end_of_block(chars, k);
    }
    if chars[k] == '"' {
        return end_of_text(chars, k + 1);
    }
    if chars[k] == 'r' && !in_name && (starts("r\"") || starts("r#")) {
        let hashes = chars[k + 1..].iter().take_while(|&&c| c == '#').count();
        let open = k + 1 + hashes;
        if chars.get(open) == Some(&'"') {
            let closes = |&i: &usize| chars[i] == '"' && (1..=hashes).all(|h| chars.get(i + h) == Some(&'#'));
            return (open + 1..chars.len()).find(closes).map_or(chars.len(), |i| i + 1 + hashes);
        }
    }
    if chars[k] == '\'' {
        // This is a character ('x' or an escape), not a lifetime.
        if chars.get(k + 1) == Some(&'\\') {
            return (k + 3..chars.len()).find(|&i| chars[i] == '\'').map_or(chars.len(), |i| i + 1);
        }
        if chars.get(k + 2) == Some(&'\'') {
            return k + 3;
        }
    }
    k
}

fn end_of_text(chars: &[char], mut k: usize) -> usize {
    while k < chars.len() && chars[k] != '"' {
        k += if chars[k] == '\\' { 2 } else { 1 };
    }
    k + 1
}

/// Returns the end of a block comment. Block comments may be nested.
fn end_of_block(chars: &[char], mut k: usize) -> usize {
    let mut depth = 0;
    while k < chars.len() {
        match (chars[k], chars.get(k + 1)) {
            ('/', Some('*')) => (depth, k) = (depth + 1, k + 2),
            ('*', Some('/')) => (depth, k) = (depth - 1, k + 2),
            _ => k += 1,
        }
        if depth == 0 {
            break;
        }
    }
    k
}

/// Returns the names after a path root in code: `fs` for `std::fs`, `fmt` and `io` for `std::{fmt, io}`.
pub fn paths_from(code: &str, root: &str) -> Vec<String> {
    heads_at(code, root).into_iter().map(|(name, _)| name).collect()
}

/// Returns the names of [`paths_from`], each with its line.
pub fn heads_at(code: &str, root: &str) -> Vec<(String, usize)> {
    let starts = code.match_indices(root).filter(|(at, _)| {
        let before = code[..*at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':')
    });
    let names = |(at, _): (usize, &str)| {
        let line = code[..at].matches('\n').count() + 1;
        heads(&code[at + root.len()..]).into_iter().map(move |name| (name, line))
    };
    starts.flat_map(names).collect()
}

/// Returns the first names after `root::`: one name, or all names of a group in braces.
fn heads(rest: &str) -> Vec<String> {
    let name = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let rest = rest.trim_start();
    let Some(group) = rest.strip_prefix('{') else { return vec![name(rest)] };
    let (mut depth, mut names, mut item) = (0, Vec::new(), String::new());
    for c in group.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => names.push(name(std::mem::take(&mut item).trim())),
            _ => {}
        }
        if c != ',' || depth > 0 {
            item.push(c);
        }
    }
    names.push(name(item.trim()));
    names.retain(|n| !n.is_empty());
    names
}

/// Returns the lines of code that contain one of the words, outside the allowed files.
pub fn with_words(words: &[&str], allowed: impl Fn(&File) -> bool) -> Vec<String> {
    let has = |f: &File| {
        let lines = f.code.lines().enumerate();
        let found = lines.filter(|(_, l)| words.iter().any(|w| l.contains(w)));
        found.map(|(k, l)| format!("src/{}:{}: {}", f.path, k + 1, l.trim())).collect::<Vec<_>>()
    };
    sources().iter().filter(|f| !allowed(f)).flat_map(has).collect()
}

/// Returns whether code uses the crate with exactly this name: `parry3d_like` does not use `parry3d`.
pub fn uses_crate(code: &str, name: &str) -> bool {
    let word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    code.match_indices(name)
        .any(|(at, _)| !word(code[..at].chars().next_back()) && !word(code[at + name.len()..].chars().next()))
}

#[test]
fn code_is_read_without_comments_and_strings() {
    let text = "use a; // std::fs\n/* .unwrap() /* nested */ panic! */ let x = \"std::fs \\\" // no\";\n\
                let r = r#\"unsafe \" {\"#; let c = '\"'; fn f<'a>(s: &'a str) {} // 'x\nlet d = '\\'';\n\
                let std = std::io::stdin();";
    let code = code_of(text);
    for absent in ["std::fs", "unwrap", "panic", "nested", "unsafe", "no"] {
        assert!(!code.contains(absent), "{absent} in {code}");
    }
    for there in ["use a;", "fn f<'a>(s: &'a str)", "let d = ", "std::io::stdin"] {
        assert!(code.contains(there), "{there} not in {code}");
    }
    assert_eq!(code_of(text).lines().count(), text.lines().count());
    let code = "use std::{fmt, io::{self, Read}, fs};\nmystd::env; let x = std::time::Instant::now();";
    assert_eq!(paths_from(code, "std::"), ["fmt", "io", "fs", "time"]);
    assert!(uses_crate("use parry3d::x", "parry3d") && !uses_crate("my_parry3d", "parry3d"));
}
