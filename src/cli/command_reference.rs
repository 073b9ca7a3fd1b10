//! Reference of all commands in Markdown, generated from the definitions with which the command line is
//! parsed.

use super::Exit;
use clap::{Arg, Command};
use std::fmt::Write;

/// Returns the reference of all commands of the program, in Markdown.
pub fn markdown(program: &Command) -> String {
    let mut text = "# Commands\n\n".to_string();
    for command in program.get_subcommands() {
        let name = command.get_name();
        let _ = writeln!(text, "- [`sweetspot {name}`](#sweetspot-{name}): {}", about(command));
    }
    text += "\n`sweetspot --version` prints the version. Every command has `--help`.\n\n## Exit codes\n\n";
    text += "| Code | Meaning |\n|---|---|\n";
    for exit in Exit::ALL {
        let _ = writeln!(text, "| {} | {} |", exit as u8, exit.meaning());
    }
    for command in program.get_subcommands() {
        add(&mut text, command);
    }
    text
}

/// Returns the example command at the start of the help of a command; None if there is no example.
pub fn example(command: &Command) -> Option<String> {
    Some(command.get_before_help()?.to_string().strip_prefix("Example: ")?.to_string())
}

/// Appends the section about a command to `text`.
fn add(text: &mut String, command: &Command) {
    let _ = writeln!(text, "\n## sweetspot {}\n\n{}.\n", command.get_name(), about(command));
    let usage = command.clone().render_usage().to_string();
    let usage = usage.strip_prefix("Usage: ").unwrap_or(&usage);
    let _ = writeln!(text, "```text\n{}\n```", usage.trim_end());
    if let Some(example) = example(command) {
        let _ = writeln!(text, "\nExample: `{example}`");
    }
    let shown = |arg: &&Arg| !arg.is_hide_set() && !["help", "version"].contains(&arg.get_id().as_str());
    for (title, is_positional) in [("Argument", true), ("Option", false)] {
        let rows = command.get_arguments().filter(shown).filter(|arg| arg.is_positional() == is_positional);
        let rows: Vec<String> = rows.map(row).collect();
        if !rows.is_empty() {
            let _ = write!(text, "\n| {title} | Meaning |\n|---|---|\n{}", rows.concat());
        }
    }
}

fn about(command: &Command) -> String {
    command.get_about().map(ToString::to_string).unwrap_or_default()
}

/// Returns the row of an argument in the table of its command.
fn row(arg: &Arg) -> String {
    let mut meaning = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    if !meaning.is_empty() && !meaning.ends_with(['.', ']']) {
        meaning.push('.');
    }
    let values: Vec<_> = arg.get_possible_values().into_iter().filter(|value| !value.is_hide_set()).collect();
    let takes_value = arg.get_action().takes_values();
    if takes_value && !arg.is_hide_possible_values_set() && !values.is_empty() {
        let words = values.iter().map(|value| match value.get_help() {
            Some(help) => format!("`{}` ({help})", value.get_name()),
            None => format!("`{}`", value.get_name()),
        });
        let _ = write!(meaning, " Values: {}.", words.collect::<Vec<_>>().join(", "));
    }
    let defaults: Vec<_> = arg.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    if takes_value && !arg.is_hide_default_value_set() && !defaults.is_empty() {
        let _ = write!(meaning, " Default: `{}`.", defaults.join(","));
    }
    let row = format!("| `{}` | {} |\n", name(arg), meaning.trim().replace('\n', " ").replace('|', "\\|"));
    row.replace("<", "&lt;").replace(">", "&gt;")
}

/// Returns the flags of an option with its placeholder, or the placeholder of a positional argument.
fn name(arg: &Arg) -> String {
    let placeholders = arg.get_value_names().unwrap_or_default().join(" ");
    let more = if arg.get_num_args().is_some_and(|count| count.max_values() > 1) { "..." } else { "" };
    if arg.is_positional() {
        return format!("{placeholders}{more}").replace('|', "\\|");
    }
    let short = arg.get_short().map(|short| format!("-{short}"));
    let flags: Vec<_> = short.into_iter().chain(arg.get_long().map(|long| format!("--{long}"))).collect();
    let value = if arg.get_action().takes_values() { format!(" {placeholders}") } else { String::new() };
    format!("{}{value}", flags.join(", ")).replace('|', "\\|")
}
