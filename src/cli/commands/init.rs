//! `init`: writes a first cell.

use super::init_own::{init_own, is_path};
use super::{schema, suggest};
use crate::cli::arguments::InitArguments;
use crate::cli::first_cells::{SKETCHES, Sketch, find};
use crate::cli::output::{path_word, word};
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::{Exit, library, loading, lookup, output};
use crate::files;
use crate::files::shown;
use std::path::Path;

/// Name of the cell file that is written.
const CELL: &str = "cell.toml";

/// Runs `sweetspot init`.
pub fn init(a: &InitArguments) -> Result<Exit, Exit> {
    let Some(name) = &a.name else {
        output::data(&list())?;
        suggest(&format!("init {}", SKETCHES[0].name));
        return Ok(Exit::Done);
    };
    if find(name).is_none() && is_path(name) {
        return init_own(Path::new(name), a);
    }
    refuse_own_options(a)?;
    let Some(sketch) = find(name) else {
        let names = SKETCHES.iter().flat_map(|s| [s.name, s.robot]);
        let exit = lookup::unknown(&format!("unknown first cell `{}`", shown(name)), name, names);
        output::talk(
            "  help: list the names with sweetspot init; for your own robot, give its URDF: sweetspot init \
            robot.urdf",
        );
        return Err(exit);
    };
    // Loading the cell validates it, and finds every file that it refers to.
    let text = sketch.text();
    let read: &mut files::ReadFile<'_> = &mut |path: &str| match path {
        CELL => Ok(text.clone().into_bytes()),
        _ => library::file(path).map(|text| text.as_bytes().to_vec()).ok_or_else(|| "not found".to_string()),
    };
    let loaded = files::load(CELL, read).map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })?;
    let folder = new_folder(Some(a.out.as_deref().unwrap_or(Path::new(name))), "", Sharing::Alone)?;
    let sources = loaded.sources.into_iter().map(|source| (source.path, source.bytes));
    let schemas =
        schema::of_files()?.into_iter().map(|(name, text)| (format!("schemas/{name}"), text.into_bytes()));
    // The cell file is written last, so that every file it refers to exists before it.
    let mut all: Vec<_> = sources.chain(schemas).collect();
    all.rotate_left(1);
    for (path, bytes) in &all {
        let path = folder.join(path);
        path.parent().map_or(Ok(()), loading::make_folder)?;
        loading::write_whole(&path, bytes)?;
    }
    tell(&folder, sketch, all.len());
    Ok(Exit::Done)
}

/// Refuses options that apply only to a URDF.
fn refuse_own_options(a: &InitArguments) -> Result<(), Exit> {
    if a.tip.is_none() && a.arguments.is_empty() && a.packages.folders.is_empty() {
        return Ok(());
    }
    output::error("--tip, --package and arguments of xacro apply only to a URDF or xacro file");
    output::talk("  help: give the path of the file, or leave out these arguments");
    Err(Exit::BadInput)
}

fn tell(folder: &Path, sketch: &Sketch, count: usize) {
    let cell = path_word(&folder.join(CELL));
    output::talk(&format!("wrote {cell}: {}", sketch.about));
    output::talk(&format!(
        "robot, equipment and schemas are beside it, {count} files in all: edit them as you need"
    ));
    suggest(&format!("map {cell} --svg map.svg"));
}

fn list() -> String {
    let wide = |f: fn(&Sketch) -> &str| SKETCHES.iter().map(|s| f(s).len()).max().unwrap_or(0);
    let (name, robot) = (wide(|s| s.name), wide(|s| s.robot));
    let line = |s: &Sketch| format!("{:name$}  {:robot$}  {}\n", word(s.name), s.robot, s.about);
    SKETCHES.iter().map(line).collect()
}
