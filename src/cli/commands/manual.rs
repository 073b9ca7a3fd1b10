//! `man`: manual pages and the reference of all commands; `completions`: completions for a shell.

use crate::cli::arguments::{Arguments, CompletionsArguments, ManArguments};
use crate::cli::lookup::unknown;
use crate::cli::output::path_word;
use crate::cli::{Exit, command_reference, loading, output};
use crate::files::shown;
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};

/// Runs `sweetspot man`.
pub fn man(a: &ManArguments) -> Result<Exit, Exit> {
    let mut program = Arguments::command();
    program.build();
    if a.markdown {
        output::data(&command_reference::markdown(&program))?;
        return Ok(Exit::Done);
    }
    if let Some(folder) = &a.out {
        loading::make_folder(folder)?;
        let pages = std::iter::once(&program).chain(program.get_subcommands());
        let pages: Vec<_> =
            pages.map(|command| Ok((file_name(command), page(command)?))).collect::<Result<_, Exit>>()?;
        for (name, text) in &pages {
            loading::write_whole(&folder.join(name), text)?;
        }
        output::talk(&format!("wrote {} manual pages into {}", pages.len(), path_word(folder)));
        return Ok(Exit::Done);
    }
    let command = match &a.command {
        None => &program,
        Some(name) => program.find_subcommand(name).ok_or_else(|| {
            let names: Vec<_> = program.get_subcommands().map(Command::get_name).collect();
            unknown(&format!("there is no command `{}`", shown(name)), name, names.into_iter())
        })?,
    };
    output::data(&String::from_utf8_lossy(&page(command)?))?;
    Ok(Exit::Done)
}

/// Runs `sweetspot completions`.
pub fn completions(a: &CompletionsArguments) -> Result<Exit, Exit> {
    let mut text = Vec::new();
    clap_complete::generate(a.shell, &mut Arguments::command(), "sweetspot", &mut text);
    output::data(&String::from_utf8_lossy(&text))?;
    Ok(Exit::Done)
}

fn file_name(command: &Command) -> String {
    format!("{}.1", command.get_display_name().unwrap_or(command.get_name()))
}

/// Returns the manual page of a command in roff, with an example and the exit codes.
fn page(command: &Command) -> Result<Vec<u8>, Exit> {
    let version = env!("CARGO_PKG_VERSION");
    let man = Man::new(command.clone()).manual("sweetspot manual").source(format!("sweetspot {version}"));
    let mut more = Roff::new();
    if let Some(example) = command_reference::example(command) {
        more.control("SH", ["EXAMPLE"]).text([roman(example)]);
    }
    more.control("SH", ["EXIT STATUS"]);
    for exit in Exit::ALL {
        more.control("TP", []).text([bold((exit as u8).to_string())]).text([roman(exit.meaning())]);
    }
    let mut page = Vec::new();
    let written = man.render(&mut page).and_then(|()| more.to_writer(&mut page));
    output::written(written)?;
    Ok(page)
}
