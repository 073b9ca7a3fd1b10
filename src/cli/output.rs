//! Output: data on stdout, messages on stderr.

use super::Exit;
use crate::cli::mutex::locked;
use crate::files::{Fault, FaultKind, shown};
use indexmap::IndexMap;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

/// Writes data to stdout. A closed pipe (`| head`) is not an error.
pub fn data(text: &str) -> Result<(), Exit> {
    let mut out = std::io::stdout().lock();
    written(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// Reports a failed write to stdout on stderr. A closed pipe (`| head`) is not an error.
pub fn written(result: std::io::Result<()>) -> Result<(), Exit> {
    match result {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
            error(&format!("cannot write to stdout: {e}"));
            Err(Exit::Io)
        }
        _ => Ok(()),
    }
}

/// Prints a line on stderr.
pub fn talk(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}

/// Text of the last error that [`error`] has printed.
static LAST_ERROR: Mutex<Option<String>> = Mutex::new(None);

/// Prints an error on stderr.
pub fn error(text: &str) {
    talk(&format!("error: {text}"));
    *locked(&LAST_ERROR) = Some(text.into());
}

/// Returns the text of the last printed error; None if there is none. A worker records this text as the
/// reason for its failure.
pub fn last_error() -> Option<String> {
    locked(&LAST_ERROR).clone()
}

/// Prints the faults of files and the number of errors.
pub fn faults(faults: &[Fault]) {
    for fault in faults {
        talk(&format!("{fault}\n"));
    }
    let errors = faults.iter().filter(|f| f.is_error()).count();
    if errors > 0 {
        talk(&format!("{errors} error{}; nothing was done", if errors == 1 { "" } else { "s" }));
    }
}

/// Prints the warnings of the import of a URDF. Warnings of one kind, which have the same help, are
/// printed as one.
pub fn import_warnings(warnings: &[Fault]) {
    for Fault { file, message, help, .. } in grouped_by_help(warnings) {
        talk(&format!("{}: warning: {message}\n  help: {help}", shown(&file)));
    }
}

/// Groups the warnings of the import of a URDF by kind; warnings of one kind have the same help. Returns the
/// first warning of each kind, with the number of further warnings of that kind.
pub fn grouped_by_help(warnings: &[Fault]) -> Vec<Fault> {
    let mut kinds: IndexMap<&str, Vec<&Fault>> = IndexMap::new();
    for warning in warnings.iter().filter(|fault| fault.kind == FaultKind::Import) {
        kinds.entry(&warning.help).or_default().push(warning);
    }
    let grouped = kinds.into_values().map(|all| {
        let mut first = all[0].clone();
        if all.len() > 1 {
            first.message += &format!(" (and {} more of this kind)", all.len() - 1);
        }
        first
    });
    grouped.collect()
}

/// Returns a progress bar on stderr that counts evaluated layouts; hidden if stderr is not a terminal.
pub fn progress_bar(length: u64) -> ProgressBar {
    let bar = ProgressBar::new(length);
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} layouts, {eta} left, best {msg}") {
        bar.set_style(style);
    }
    bar.set_message("none yet");
    bar
}

/// Returns a spinner on stderr for work whose length is unknown; hidden if stderr is not a terminal.
pub fn spinner(message: &'static str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_message(message);
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Returns a hidden progress bar that counts sample points. [`advance`] shows the bar after one second if
/// stderr is a terminal.
pub fn points_bar() -> ProgressBar {
    let bar = ProgressBar::hidden();
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {percent} %, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// Returns a hidden progress bar that counts combinations. [`advance`] shows the bar after one second if
/// stderr is a terminal.
pub fn combinations_bar() -> ProgressBar {
    let bar = ProgressBar::hidden();
    if let Ok(style) = ProgressStyle::with_template("{bar:24} {pos}/{len} combinations, {eta} left") {
        bar.set_style(style);
    }
    bar
}

/// Sets the length of a progress bar to `of`, and advances the bar by `count`. Shows a hidden bar that is at
/// least one second old.
pub fn advance(bar: &ProgressBar, count: u64, of: u64) {
    if bar.is_hidden() && bar.elapsed().as_secs() >= 1 {
        bar.set_draw_target(ProgressDrawTarget::stderr());
    }
    bar.set_length(of);
    bar.inc(count);
}

/// Returns a path quoted for a shell.
pub fn path_word(path: &Path) -> String {
    let text = path.to_string_lossy();
    // A program would take a leading hyphen for an option.
    if text.starts_with('-') { word(&format!("./{text}")) } else { word(&text) }
}

/// Returns a word quoted for a shell, if it needs quotes.
pub fn word(text: &str) -> String {
    let text = shown(text);
    let plain = |c: char| c.is_alphanumeric() || "-_./,:@+=%~\\".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text
    } else {
        format!("'{}'", text.replace('\'', "'\\''"))
    }
}

/// Returns a count and its noun, such as `3 layouts`. The noun is in the plural unless the count is 1.
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
