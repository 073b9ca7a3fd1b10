//! Simulated session of a reader who types every command of one page, in a temporary folder with the files of
//! the project.

use super::blocks::{Block, LEFT_OUT, Step};
use super::{name, same, writes};
use crate::cli::sandbox::{Sandbox, copy_folder};
use crate::common::root;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Time within which a server must print its address.
const PATIENCE: Duration = Duration::from_secs(60);

/// Duration above which a command is reported, so that the check of the book stays fast.
const SLOW: Duration = Duration::from_secs(3);

/// Temporary folder in which the commands of one page run, with the faults found.
pub struct Session<'a> {
    page: &'a Path,
    sandbox: Sandbox,
    pub commands: usize,
    pub faults: Vec<String>,
}

impl<'a> Session<'a> {
    pub fn new(page: &'a Path, text: &str) -> Self {
        let sandbox = Sandbox::new();
        for folder in ["tests/data", "results/hitachi_cell"] {
            if text.contains(folder) {
                copy_folder(&root().join(folder), &sandbox.path(folder));
            }
        }
        Self { page, sandbox, commands: 0, faults: Vec::new() }
    }

    /// Runs the commands of a block and checks their exit codes, outputs and pictures, or writes them into
    /// the block.
    pub fn run(&mut self, block: &mut Block) {
        if let Some(file) = block.option("file") {
            let path = self.sandbox.path(file);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, block.lines.join("\n") + "\n").unwrap();
        }
        let is_run = block.language() == "console";
        let others = block.lines.iter().any(|line| line.trim_start_matches("$ ").starts_with("sweetspot "));
        if !is_run {
            // The synopsis on a reference page has the language `text`.
            if others && block.language() != "text" {
                self.fault(block, "commands of sweetspot belong in a block of the language console");
            }
            return;
        }
        let mut lines = Vec::new();
        for step in block.steps() {
            let shown = self.output(block, &step);
            lines.extend(step.typed.iter().enumerate().map(|(k, line)| match k {
                0 => format!("$ {line}"),
                _ => line.clone(),
            }));
            lines.extend(shown);
        }
        if cheaper(block).is_none() {
            self.check_pictures(block);
        }
        if writes() {
            block.lines = lines;
        }
    }

    /// Runs a command and returns the lines of its output that the page shows.
    fn output(&mut self, block: &Block, step: &Step) -> Vec<String> {
        let words = step.words();
        if words.first().is_none_or(|word| word != "sweetspot") {
            self.fault(
                block,
                "only commands of sweetspot can be run; others belong in a block of the language sh",
            );
            return Vec::new();
        }
        self.commands += 1;
        let (arguments, target) = match words.iter().position(|word| word == ">>") {
            Some(at) => (&words[1..at], words.get(at + 1)),
            None => (&words[1..], None),
        };
        let mut command = self.sandbox.command(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        let budget = cheaper(block);
        if let Some(budget) = budget {
            command.args(["--budget", budget]);
        }
        let start = Instant::now();
        let (code, text) = self.ran(command, target.map(|file| self.sandbox.path(file)), block.has("serves"));
        if start.elapsed() > SLOW {
            println!("{:.1} s: {}", start.elapsed().as_secs_f64(), words.join(" "));
        }
        let wanted = block.option("exit").map_or(0, |code| code.parse().unwrap());
        if !block.has("serves") && code != Some(wanted) {
            self.fault(
                block,
                &format!("`{}` ends with {code:?} instead of {wanted}:\n{text}", words.join(" ")),
            );
        }
        if block.has("silent") || block.has("serves") || budget.is_some() {
            return Vec::new();
        }
        let shown = self.excerpt(block, &text);
        if !writes()
            && let Some(difference) = same::difference(&step.shown, &shown)
        {
            self.fault(block, &format!("`{}` prints something else:\n{difference}", words.join(" ")));
        }
        shown
    }

    /// Runs a command to its end, or until a server has printed its address. Returns the exit code and both
    /// streams.
    fn ran(&self, mut command: Command, target: Option<PathBuf>, serves: bool) -> (Option<i32>, String) {
        let both = self.sandbox.path(".output");
        let stream = std::fs::File::create(&both).unwrap();
        let errors = stream.try_clone().unwrap();
        let append = |file: PathBuf| std::fs::File::options().append(true).create(true).open(file).unwrap();
        let out = target.map_or(stream, append);
        let mut child = command.stdout(out).stderr(errors).stdin(Stdio::null()).spawn().unwrap();
        if serves {
            stop_after_address(&mut child, &both);
        }
        let code = child.wait().unwrap().code();
        let mut text = String::new();
        std::fs::File::open(&both).unwrap().read_to_string(&mut text).unwrap();
        (code, text)
    }

    /// Returns the lines of an output that a block shows, without the parts that differ from run to run.
    fn excerpt(&self, block: &Block, text: &str) -> Vec<String> {
        let folder = self.sandbox.dir.path().to_string_lossy().into_owned();
        let own = text.replace(&folder, "$PWD").replace(env!("CARGO_BIN_EXE_sweetspot"), "sweetspot");
        let lines = own.lines().filter(|line| !line.starts_with("{\"schema\":\"sweetspot/progress"));
        let lines: Vec<String> = lines.map(|line| line.trim_end().to_string()).collect();
        let Some((first, last)) = block.option("lines").and_then(|range| range.split_once('-')) else {
            return lines;
        };
        let (first, last): (usize, usize) = (first.parse().unwrap(), last.parse().unwrap_or(usize::MAX));
        let mut shown: Vec<String> = lines.iter().take(last).skip(first - 1).cloned().collect();
        if first > 1 {
            shown.insert(0, LEFT_OUT.into());
        }
        if last < lines.len() {
            shown.push(LEFT_OUT.into());
        }
        shown
    }

    /// Compares the pictures that a block makes with the pictures of the book, or copies them there.
    /// `FILE@WORDS` means the chart of a page whose label contains the words, which are joined by hyphens.
    fn check_pictures(&mut self, block: &Block) {
        for made in block.option("pictures").into_iter().flat_map(|files| files.split('+')) {
            let made = match made.split_once('@') {
                Some((page, words)) => self.chart(page, words),
                None => self.sandbox.path(made),
            };
            let stem = self.page.file_stem().unwrap().to_string_lossy();
            let file = format!("{stem}-{}", made.file_name().unwrap().to_string_lossy());
            let kept = root().join("docs/src/pictures").join(file);
            if writes() {
                std::fs::create_dir_all(kept.parent().unwrap()).unwrap();
                std::fs::copy(made, kept).unwrap();
            } else if let Some(difference) = same::pictures(&kept, &made) {
                self.fault(block, &format!("{} is stale: {difference}", name(&kept)));
            }
        }
    }

    /// Writes a chart of an HTML page to a separate file, and returns the path.
    fn chart(&self, page: &str, words: &str) -> PathBuf {
        let text = self.sandbox.text(page);
        let charts = text.split("<svg").skip(1).filter_map(|rest| rest.split_once("</svg>"));
        let label = words.replace('-', " ");
        let is_it = |chart: &&str| chart.split('>').next().is_some_and(|tag| tag.contains(&label));
        let chart =
            charts.map(|(chart, _)| chart).find(is_it).unwrap_or_else(|| panic!("{page} has no {label}"));
        self.sandbox.write(&format!("{words}.svg"), &format!("<svg{chart}</svg>\n"));
        self.sandbox.path(&format!("{words}.svg"))
    }

    fn fault(&mut self, block: &Block, what: &str) {
        self.faults.push(format!("{}:{}: {what}", name(self.page), block.line));
    }
}

/// Returns the smaller budget with which the commands of a block run if the pages are only checked.
fn cheaper(block: &Block) -> Option<&str> {
    block.option("budget").filter(|_| !writes())
}

/// Waits until a server has printed its address, and ends it.
fn stop_after_address(child: &mut Child, output: &Path) {
    let start = Instant::now();
    while !std::fs::read_to_string(output).unwrap_or_default().contains("http://127.0.0.1") {
        assert!(start.elapsed() < PATIENCE, "no address after {PATIENCE:?}");
        assert!(
            child.try_wait().unwrap().is_none(),
            "the server ended: {:?}",
            std::fs::read_to_string(output)
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    child.kill().unwrap();
}
