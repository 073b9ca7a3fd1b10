//! `schema`: JSON Schemas of the files.

use super::suggest;
use crate::cli::arguments::SchemaArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, loading, output, results};
use crate::files;
use crate::files::FileKind;

/// `sweetspot schema`
pub fn schema(a: &SchemaArguments) -> Result<Exit, Exit> {
    let Some(folder) = &a.out else {
        let kind = FileKind::ALL.into_iter().find(|kind| kind.name() == a.kind).unwrap_or(FileKind::Cell);
        output::data(&text(kind)?)?;
        suggest("schema --out schemas");
        return Ok(Exit::Done);
    };
    loading::make_folder(folder)?;
    for (name, text) in all()? {
        loading::write_whole(&folder.join(name), text.as_bytes())?;
    }
    let first = path_word(&folder.join(file_name(FileKind::Cell)));
    output::talk(&format!("wrote {} schemas into {}", FileKind::ALL.len(), path_word(folder)));
    output::talk(&format!("editors use a schema if the first line of a file names it: #:schema ./{first}"));
    suggest("init");
    Ok(Exit::Done)
}

/// Returns name and text of every schema.
pub fn all() -> Result<Vec<(String, String)>, Exit> {
    FileKind::ALL.into_iter().map(|kind| Ok((file_name(kind), text(kind)?))).collect()
}

fn file_name(kind: FileKind) -> String {
    format!("{}.schema.json", kind.name())
}

fn text(kind: FileKind) -> Result<String, Exit> {
    results::pretty(&files::schema(kind)).map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}
