//! Arguments of the commands about the command line itself: `man` and `completions`.

use clap::Args;
use clap_complete::Shell;
use std::path::PathBuf;

#[derive(Args)]
pub struct ManArguments {
    /// Command whose manual page is printed [default: the page of sweetspot itself]
    #[arg(value_name = "COMMAND", conflicts_with_all = ["out", "markdown"])]
    pub command: Option<String>,
    /// Write the manual pages of all commands to this folder; existing files are replaced
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the reference of all commands as Markdown
    #[arg(long, conflicts_with = "out")]
    pub markdown: bool,
}

#[derive(Args)]
pub struct CompletionsArguments {
    /// Shell that reads the completions
    #[arg(value_name = "SHELL")]
    pub shell: Shell,
}
