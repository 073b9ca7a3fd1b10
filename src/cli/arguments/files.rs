//! Arguments of the commands that help to write cell files: `schema` and `init`.

use crate::cli::packages::PackageFolders;
use crate::files::FileKind;
use crate::record::DocumentKind;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

/// Returns the names of all schemas.
pub fn kinds() -> impl Iterator<Item = &'static str> {
    FileKind::ALL.into_iter().map(FileKind::name).chain(DocumentKind::ALL.into_iter().map(DocumentKind::name))
}

#[derive(Args)]
pub struct SchemaArguments {
    /// Kind of an input file, or of a document that a command writes
    #[arg(
        value_name = "KIND",
        default_value = FileKind::Cell.name(),
        value_parser = PossibleValuesParser::new(kinds().collect::<Vec<_>>()),
        conflicts_with = "out"
    )]
    pub kind: String,
    /// Print the reference of all keys of a file, or of all fields of a document, as Markdown
    #[arg(long)]
    pub markdown: bool,
    /// Write all schemas to this folder (with --markdown, all references); existing files are replaced
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct InitArguments {
    /// Your robot: a URDF, a xacro file, a robot file (TOML) or the folder of a ROS package. Alternatively,
    /// the name or the short name of a built-in robot [default: list the names]
    #[arg(value_name = "ROBOT|NAME")]
    pub name: Option<String>,
    /// Arguments of the xacro file
    #[arg(value_name = "NAME:=VALUE", value_parser = xacro_argument)]
    pub arguments: Vec<String>,
    /// Link of the URDF that carries the tool [default: the last link of the longest chain]
    #[arg(long, value_name = "LINK", requires = "name")]
    pub tip: Option<String>,
    /// Write to this folder, which must be new or empty [default: the folder NAME; for a URDF, the folder
    /// NAME-cell beside it]
    #[arg(long, value_name = "DIR", requires = "name")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub packages: PackageFolders,
}

/// Parses an argument of a xacro file, written as `NAME:=VALUE`.
fn xacro_argument(text: &str) -> Result<String, String> {
    match text.split_once(":=") {
        Some((name, _)) if name.chars().all(|c| c.is_alphanumeric() || c == '_') && !name.is_empty() => {
            Ok(text.into())
        }
        _ => Err("expected NAME:=VALUE, an argument of the xacro file".into()),
    }
}
