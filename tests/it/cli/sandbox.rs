//! Sandbox of command tests: a folder with a copy of cells/, commands that run in this folder, and their
//! output.

use rustix::fs::{StatVfsMountFlags, statvfs};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// File system in the memory of Linux.
const MEMORY: &str = "/dev/shm";
/// Free space that the tests need at most, bytes.
const ROOM: u64 = 2 << 30;

/// Creates a temporary folder: in TMPDIR if it is set, otherwise in memory if there is room for programs and
/// files. The program syncs every file that it writes, which takes 20 ms on some disks and no time in memory.
pub fn temporary_folder() -> TempDir {
    let is_suitable = statvfs(MEMORY).is_ok_and(|system| {
        system.f_bavail * system.f_frsize >= ROOM && !system.f_flag.contains(StatVfsMountFlags::NOEXEC)
    });
    match std::env::var_os("TMPDIR") {
        None if is_suitable => tempfile::tempdir_in(MEMORY).or_else(|_| tempfile::tempdir()).unwrap(),
        _ => tempfile::tempdir().unwrap(),
    }
}

/// Temporary folder with a copy of cells/, in which the command runs.
pub struct Sandbox {
    pub dir: TempDir,
}

/// Exit code and streams of a run.
pub struct RunOutput {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Sandbox {
    pub fn new() -> Self {
        let dir = temporary_folder();
        copy_folder(&crate::common::root().join("cells"), &dir.path().join("cells"));
        Self { dir }
    }

    pub fn path(&self, inside: &str) -> PathBuf {
        self.dir.path().join(inside)
    }

    pub fn write(&self, inside: &str, text: &str) {
        self.write_bytes(inside, text.as_bytes());
    }

    pub fn write_bytes(&self, inside: &str, bytes: &[u8]) {
        std::fs::write(self.path(inside), bytes).unwrap();
    }

    pub fn read(&self, inside: &str) -> Vec<u8> {
        std::fs::read(self.path(inside)).unwrap_or_else(|e| panic!("{inside}: {e}"))
    }

    pub fn text(&self, inside: &str) -> String {
        String::from_utf8(self.read(inside)).unwrap()
    }

    pub fn document(&self, inside: &str) -> Value {
        serde_json::from_slice(&self.read(inside)).unwrap()
    }

    pub fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sweetspot"));
        command.env("SWEETSPOT_CACHE", "off").args(args).current_dir(self.dir.path()).stdin(Stdio::null());
        command
    }

    pub fn run(&self, args: &[&str]) -> RunOutput {
        ran(self.command(args).output().unwrap())
    }

    /// Runs the command and asserts success.
    pub fn done(&self, args: &[&str]) -> RunOutput {
        let ran = self.run(args);
        assert_eq!(ran.code, Some(0), "{args:?}: {}{}", ran.out, ran.err);
        ran
    }

    /// Runs the command with --json, asserts success and returns the document.
    pub fn json(&self, args: &[&str]) -> Value {
        self.done(&[args, &["--json"]].concat()).document()
    }

    /// Asserts that a folder contains the given files.
    pub fn has(&self, folder: &str, names: &[&str]) {
        let files = self.files(folder);
        names.iter().for_each(|n| assert!(files.contains(&n.to_string()), "no {n} among {files:?}"));
    }

    /// Returns every file below a folder, sorted.
    pub fn files(&self, inside: &str) -> Vec<String> {
        let mut all = Vec::new();
        list(&self.path(inside), "", &mut all);
        all.sort();
        all
    }
}

impl RunOutput {
    /// Returns the JSON document that stdout must consist of.
    pub fn document(&self) -> Value {
        assert!(self.out.ends_with("}\n"), "no document: {}", self.out);
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {}", self.out))
    }

    pub fn no_panic(&self) {
        assert!(!self.err.contains("panicked"), "{}", self.err);
    }
}

pub fn ran(output: Output) -> RunOutput {
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    RunOutput { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
}

pub fn copy_folder(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}

pub fn list(folder: &Path, prefix: &str, all: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            list(&entry.path(), &format!("{name}/"), all);
        } else {
            all.push(name);
        }
    }
}

pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Returns the text of a sealed JSON file with the hash of its present content.
pub fn resealed(text: &str) -> String {
    let (content, _) = text.rsplit_once(",\n  \"sha256\": \"").unwrap();
    format!("{content},\n  \"sha256\": \"{}\"\n}}\n", sha256(content.as_bytes()))
}

pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap_or_else(|| panic!("no list: {value}")).iter().map(number).collect()
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

pub fn text(value: &Value) -> &str {
    value.as_str().unwrap_or_else(|| panic!("no text: {value}"))
}

pub fn items(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("no list: {value}"))
}

/// Returns the value of a key, which must exist but may be null.
pub fn field<'a>(value: &'a Value, key: &str) -> &'a Value {
    value.get(key).unwrap_or_else(|| panic!("no `{key}` in {value}"))
}

pub fn near(a: &[f64], b: &[f64], tolerance: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

pub const CELL: &str = "cells/hitachi_cell.toml";
/// The shipped cell for ideal layouts, without assumed values.
pub const IDEAL: &str = "cells/hitachi_ideal.toml";
pub const PAPER: &str = "cells/hitachi_paper.toml";

/// Cell whose table is out of reach at every allowed placement.
pub const BEYOND_REACH: &str = "from = \"hitachi_cell.toml\"\n[equipment.worktable.placement]\n\
                            x_mm = { min = 5000, max = 6000 }\n";

/// Returns the objective of best.toml from `map`, from `compare` and from search.json.
pub fn objectives(shop: &Sandbox, folder: &str) -> [f64; 3] {
    let best = format!("{folder}/best.toml");
    [
        number(&shop.json(&["map", &best])["objective_mm"]),
        number(&shop.json(&["compare", folder])["layouts"][0]["objective_mm"]),
        number(&shop.document(&format!("{folder}/search.json"))["objective_mm"]),
    ]
}
