//! `init`.

use super::{schema, suggest};
use crate::cli::init::{SKETCHES, Sketch, find};
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, library, loading, output, overrides};
use crate::files;
use crate::files::shown;
use clap::Args;
use std::path::{Path, PathBuf};

/// The file that commands are given.
const CELL: &str = "cell.toml";

#[derive(Args)]
pub struct InitArguments {
    /// Which: one of the list, or a robot of the library [default: list them]
    pub name: Option<String>,
    /// Write into this folder, new or empty [default: one of that name]
    #[arg(long, value_name = "DIR", requires = "name")]
    pub out: Option<PathBuf>,
}

/// `sweetspot init`
pub fn init(a: &InitArguments) -> Result<Exit, Exit> {
    let Some(name) = &a.name else {
        output::data(&list())?;
        suggest(&format!("init {}", SKETCHES[0].name));
        return Ok(Exit::Done);
    };
    let Some(sketch) = find(name) else {
        let names = SKETCHES.iter().flat_map(|s| [s.name, s.robot]);
        let exit = overrides::unknown(&format!("there is no first cell `{}`", shown(name)), name, names);
        output::talk(
            "  help: sweetspot init lists them; copy a cell and change its robot for one of your own",
        );
        return Err(exit);
    };
    // Read as it will be read: what it takes in is what is written, and a slip is told here.
    let text = sketch.text();
    let read: &mut files::ReadFile<'_> = &mut |path: &str| match path {
        CELL => Ok(text.clone().into_bytes()),
        _ => {
            library::file(path).map(|text| text.as_bytes().to_vec()).ok_or_else(|| "no such file".to_string())
        }
    };
    let loaded = files::load(CELL, read).map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })?;
    let folder = loading::new_folder(Some(a.out.as_deref().unwrap_or(Path::new(name))), "")?;
    let sources = loaded.sources.into_iter().map(|source| (source.path, source.bytes));
    let schemas =
        schema::all()?.into_iter().map(|(name, text)| (format!("schemas/{name}"), text.into_bytes()));
    // The cell last: where it stands, all that it needs stands.
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

fn tell(folder: &Path, sketch: &Sketch, count: usize) {
    let cell = path_word(&folder.join(CELL));
    output::talk(&format!("wrote {cell}: {}", sketch.about));
    output::talk(&format!("with robot, equipment and schemas beside it: {count} files, yours to change"));
    suggest(&format!("map {cell} --svg map.svg"));
}

fn list() -> String {
    let wide = |f: fn(&Sketch) -> &str| SKETCHES.iter().map(|s| f(s).len()).max().unwrap_or(0);
    let (name, robot) = (wide(|s| s.name), wide(|s| s.robot));
    let line = |s: &Sketch| format!("{:name$}  {:robot$}  {}\n", word(s.name), s.robot, s.about);
    SKETCHES.iter().map(line).collect()
}
