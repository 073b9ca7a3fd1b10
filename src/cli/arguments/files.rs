//! Arguments of the commands that help to write cell files: `schema` and `init`.

use crate::files::FileKind;
use crate::record::DocumentKind;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

/// Returns the names of all schemas.
fn kinds() -> impl Iterator<Item = &'static str> {
    FileKind::ALL.into_iter().map(FileKind::name).chain(DocumentKind::ALL.into_iter().map(DocumentKind::name))
}

#[derive(Args)]
pub struct SchemaArguments {
    /// Kind of input file, or of document that a command writes
    #[arg(
        value_name = "KIND",
        default_value = FileKind::Cell.name(),
        value_parser = PossibleValuesParser::new(kinds().collect::<Vec<_>>()),
        conflicts_with = "out"
    )]
    pub kind: String,
    /// Print the reference of all keys of an input file as Markdown
    #[arg(long)]
    pub markdown: bool,
    /// Write all schemas to this folder (with --markdown, all references); existing files are replaced
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct InitArguments {
    /// Name of a first cell or of a built-in robot [default: list them]
    pub name: Option<String>,
    /// Write to this folder, which must be new or empty [default: the folder NAME]
    #[arg(long, value_name = "DIR", requires = "name")]
    pub out: Option<PathBuf>,
}
