//! The command-line interface: arguments, files, progress, exit codes.
//!
//! Only this module touches the file system, the clock or the terminal.

mod arguments;
mod asked;
mod cache;
mod checkpoint;
mod combination_checkpoint;
mod command_reference;
mod commands;
mod document_reference;
mod first_cells;
mod folder_lock;
pub mod front_end;
mod imported_robot;
mod island_plan;
mod json_text;
mod library;
mod loading;
mod lookup;
mod mutex;
mod output;
mod output_folder;
mod packages;
mod progress;
mod read_files;
mod report_source;
mod results;
mod results_folder;
mod search_request;
mod shared_work;
mod signals;
mod slurm;
mod sweep;
mod sweep_claims;
#[cfg(feature = "view")]
mod view;
mod written_layout;

pub use checkpoint::evaluations_of_checkpoint;
#[doc(hidden)] // open for tests/maths
pub use first_cells::texts as first_cell_texts;
pub use json_text::unsealed;
#[cfg(feature = "view")]
pub use view::requested_layout;

use arguments::{Arguments, Command};
use clap::Parser;
use clap::error::ErrorKind;
use std::ffi::OsString;
use std::process::ExitCode;

/// Exit code of a command. Scripts rely on the numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// The command succeeded.
    Done = 0,
    /// The command ran, and the answer is no: for example, no layout is feasible, or a limit is exceeded.
    AnswerIsNo = 1,
    /// The usage or the input is invalid.
    BadInput = 2,
    /// A file could not be read or written.
    Io = 3,
    /// A limit of time or of attempts was reached; the command can be resumed.
    Limit = 4,
    /// Ctrl-C or SIGTERM stopped the command. A search or a sweep can be resumed.
    Interrupted = 130,
}

impl Exit {
    /// All exit codes, in the order of their numbers.
    const ALL: [Self; 6] =
        [Self::Done, Self::AnswerIsNo, Self::BadInput, Self::Io, Self::Limit, Self::Interrupted];

    /// Returns the meaning of the exit code, in sentences.
    fn meaning(self) -> &'static str {
        match self {
            Self::Done => "The command succeeded.",
            Self::AnswerIsNo => {
                "The command ran, and the answer is no: no layout is feasible, a limit is exceeded, the \
                layout is not \
                 robust, or the given node cannot be used."
            }
            Self::BadInput => "The usage or the input is invalid. Nothing was done.",
            Self::Io => "A file could not be read or written.",
            Self::Limit => "A limit of time or of attempts was reached. The command can be resumed.",
            Self::Interrupted => {
                "Ctrl-C or SIGTERM stopped the command. A search or a sweep has written its state and can be resumed."
            }
        }
    }
}

/// Returns the words of the command line, in which `COMMAND --help` replaces `help COMMAND`.
///
/// The command `help` of clap is not used, because it would appear in the manual pages of all commands.
fn with_help(words: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
    let mut words: Vec<_> = words.into_iter().collect();
    if words.get(1).is_some_and(|word| word == "help") {
        words.remove(1);
        words.push("--help".into());
    }
    words
}

/// Runs the command line and returns its exit code.
pub fn run() -> ExitCode {
    let arguments = match Arguments::try_parse_from(with_help(std::env::args_os())) {
        Ok(arguments) => arguments,
        Err(e) => {
            let asked = matches!(e.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            // clap prints help to stdout and errors to stderr; a closed pipe is not an error.
            let _ = e.print();
            return code(if asked { Exit::Done } else { Exit::BadInput });
        }
    };
    let exit = match arguments.command {
        Command::Check(a) => commands::check(&a),
        Command::Map(a) => commands::map(&a),
        Command::Search(a) => commands::search(&a),
        Command::Sweep(a) => commands::sweep(&a),
        Command::Compare(a) => commands::compare(&a),
        Command::Budget(a) => commands::budget(&a),
        Command::Allocate(a) => commands::allocate(&a),
        Command::Explain(a) => commands::explain(&a),
        Command::Readings(a) => commands::readings(&a),
        Command::Robust(a) => commands::robust(&a),
        Command::Calibrate(a) => commands::calibrate(&a),
        Command::Errors(a) => commands::errors(&a),
        Command::Correct(a) => commands::correct(&a),
        Command::Robots(a) => commands::robots(&a),
        Command::Robot(a) => commands::robot(&a),
        Command::Export(a) => commands::export(&a),
        Command::Envelope(a) => commands::envelope(&a),
        Command::Report(a) => commands::report(&a),
        Command::View(a) => commands::view(&a),
        Command::Schema(a) => commands::schema(&a),
        Command::Figures(a) => commands::figures(&a),
        Command::Init(a) => commands::init(&a),
        Command::Man(a) => commands::man(&a),
        Command::Completions(a) => commands::completions(&a),
    };
    code(exit.unwrap_or_else(|exit| exit))
}

fn code(exit: Exit) -> ExitCode {
    ExitCode::from(exit as u8)
}
