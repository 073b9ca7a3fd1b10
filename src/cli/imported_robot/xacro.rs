//! Expansion of xacro files by the program `xacro` or `xacrodoc`. Only a command with a xacro file as its
//! argument runs these programs.

use super::ros_packages::package_above;
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, output};
use crate::files::shown;
use std::path::Path;
use std::process::{Command, Stdio};

/// Largest number of lines of a program's error output that are shown.
const MAX_LINES: usize = 4;

/// Returns the URDF that a xacro file expands to. `arguments` are the arguments of the xacro file, each
/// as NAME:=VALUE.
pub fn expanded(path: &Path, arguments: &[String]) -> Result<String, Exit> {
    let near = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // The packages of a workspace lie side by side.
    let workspace = package_above(near).and_then(|package| package.parent().map(Path::to_path_buf));
    let folder = workspace.unwrap_or_else(|| near.to_path_buf());
    let mut complaints = Vec::new();
    for program in ["xacro", "xacrodoc"] {
        let mut command = Command::new(program);
        if program == "xacrodoc" {
            command.arg("-d").arg(&folder);
        }
        match command.arg(path).args(arguments).stdin(Stdio::null()).output() {
            Ok(run) if run.status.success() => match String::from_utf8(run.stdout) {
                Ok(text) => return Ok(text),
                Err(_) => complaints.push(format!("{program} wrote output that is not UTF-8")),
            },
            Ok(run) => {
                complaints.push(format!("{program}: {}", last_lines(&String::from_utf8_lossy(&run.stderr))))
            }
            Err(_) => {}
        }
    }
    output::error(&format!("cannot expand the xacro file {}", path_word(path)));
    complaints.iter().for_each(|complaint| output::talk(&format!("  {complaint}")));
    if complaints.is_empty() {
        output::talk(
            "  neither xacro nor xacrodoc is installed: install one of the programs, for example with pip install xacrodoc",
        );
    }
    let words: String = arguments.iter().map(|argument| format!(" {}", word(argument))).collect();
    let urdf = path.with_extension("").with_extension("urdf");
    output::talk(&format!(
        "  help: xacrodoc -d {} {}{words} -o {urdf}; then: sweetspot init {urdf}",
        path_word(&folder),
        path_word(path),
        urdf = path_word(&urdf)
    ));
    Err(Exit::BadInput)
}

fn last_lines(text: &str) -> String {
    let lines: Vec<_> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(MAX_LINES)..]
        .iter()
        .map(|line| shown(line))
        .collect::<Vec<_>>()
        .join("\n    ")
}
