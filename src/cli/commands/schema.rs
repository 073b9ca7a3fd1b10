//! `schema`: JSON Schemas of files and documents, and a readable reference of all keys and fields.

use super::suggest;
use crate::cli::arguments::{SchemaArguments, kinds};
use crate::cli::output::path_word;
use crate::cli::{Exit, document_reference, json_text, loading, output};
use crate::files;
use crate::files::FileKind;
use crate::record::DocumentKind;
use serde_json::Value;
use std::path::Path;

/// Runs `sweetspot schema`.
pub fn schema(a: &SchemaArguments) -> Result<Exit, Exit> {
    if a.markdown {
        return references(a);
    }
    let Some(folder) = &a.out else {
        output::data(&text(&schema_of(&a.kind))?)?;
        suggest("schema --out schemas");
        return Ok(Exit::Done);
    };
    loading::make_folder(folder)?;
    let documents = DocumentKind::ALL.map(|kind| (file_name(kind.name()), kind.schema()));
    let documents = documents.into_iter().map(|(name, schema)| Ok((name, text(&schema)?)));
    let all: Vec<_> = of_files()?.into_iter().map(Ok).chain(documents).collect::<Result<_, Exit>>()?;
    for (name, text) in &all {
        loading::write_whole(&folder.join(name), text.as_bytes())?;
    }
    // `join` leaves an absolute path unchanged.
    let first = path_word(&Path::new(".").join(folder).join(file_name(FileKind::Cell.name())));
    output::talk(&format!("wrote {} schemas into {}", all.len(), path_word(folder)));
    output::talk(&format!("editors use a schema if the first line of a file names it: #:schema {first}"));
    suggest("init");
    Ok(Exit::Done)
}

/// Prints the reference of one kind of file or document, or writes all references into a folder.
fn references(a: &SchemaArguments) -> Result<Exit, Exit> {
    let Some(folder) = &a.out else {
        output::data(&reference_of(&a.kind))?;
        suggest("schema --markdown --out reference");
        return Ok(Exit::Done);
    };
    loading::make_folder(folder)?;
    let names: Vec<_> = kinds().collect();
    for name in &names {
        loading::write_whole(&folder.join(format!("{name}.md")), reference_of(name).as_bytes())?;
    }
    output::talk(&format!("wrote {} references into {}", names.len(), path_word(folder)));
    suggest("init");
    Ok(Exit::Done)
}

/// Returns the reference of the keys of an input file, or of the fields of a written document.
fn reference_of(name: &str) -> String {
    match FileKind::ALL.into_iter().find(|kind| kind.name() == name) {
        Some(kind) => files::reference(kind),
        None => document_reference::markdown(name, &schema_of(name)),
    }
}

/// Returns the schema of the kind of file or document with the given name.
fn schema_of(name: &str) -> Value {
    let document = DocumentKind::ALL.into_iter().find(|kind| kind.name() == name);
    let file = FileKind::ALL.into_iter().find(|kind| kind.name() == name).unwrap_or(FileKind::Cell);
    document.map_or_else(|| files::schema(file), DocumentKind::schema)
}

/// Returns the names and texts of the schemas of all input files.
pub fn of_files() -> Result<Vec<(String, String)>, Exit> {
    FileKind::ALL.into_iter().map(|kind| Ok((file_name(kind.name()), text(&files::schema(kind))?))).collect()
}

fn file_name(kind: &str) -> String {
    format!("{kind}.schema.json")
}

fn text(schema: &Value) -> Result<String, Exit> {
    json_text::pretty(schema).map(|bytes| String::from_utf8_lossy(&bytes).into_owned())
}
