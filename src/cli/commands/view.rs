//! `view`: starts the local web server with the layout editor.

use super::{suggest_with, warn_of_hopeless, workcell};
use crate::cell::Cell;
use crate::cli::arguments::ViewArguments;
use crate::cli::output::path_word;
use crate::cli::packages::PackageFolders;
use crate::cli::view::{AccessControl, LiveView, LocalServer, Origin, open_in_browser, secret};
use crate::cli::{Exit, asked, loading, output, results_folder};
use crate::files::Loaded;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempPath;
use tokio::sync::Notify;

/// Runs `sweetspot view`. Ends with exit code 0 at Ctrl-C.
pub fn view(a: &ViewArguments) -> Result<Exit, Exit> {
    asked::refuse_sets(&a.question.settings(), "view")?;
    let file = if a.of.is_dir() { results_folder::best_of(&a.of)? } else { a.of.clone() };
    let Loaded { cell, sources, .. } = asked::load(&file, &a.packages, &a.question)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let sources: Vec<PathBuf> = sources.iter().map(|s| folder.join(&s.path)).collect();
    let cell = if a.of.is_dir() { searched(cell, &sources, &a.packages) } else { cell };
    let workcell = workcell(cell, &file)?;
    warn_of_hopeless(&workcell);
    let view = LiveView::new(workcell, Origin { file: file.clone(), packages: a.packages.clone(), sources });
    let server = LocalServer::bind(a.port).map_err(|e| {
        output::error(&format!("cannot listen on 127.0.0.1:{}: {e}", a.port));
        Exit::Io
    })?;
    let access = AccessControl::new(secret().map_err(failed)?, server.port());
    let over = end_at_signals();
    output::data(&format!("{}\n", access.url()))?;
    output::talk("open this address in a browser on this machine; press Ctrl-C here to stop");
    // The temporary file that redirects the browser to the page is deleted when the session ends.
    let _redirect = if a.open { opened(&access.url()) } else { None };
    server.serve(view, access, &over);
    suggest_with(&format!("check {}", path_word(&file)), &a.packages);
    Ok(Exit::Done)
}

fn failed(why: String) -> Exit {
    output::error(&why);
    Exit::Io
}

/// Returns the cell of a search result with the search ranges of the original cell file. The page can thus
/// search again.
fn searched(cell: Cell, sources: &[PathBuf], packages: &PackageFolders) -> Cell {
    // The first source is best.toml. The second is the cell file from which best.toml was made.
    let wide = sources.get(1).and_then(|file| loading::read_cell(file, packages).ok());
    match wide {
        Some(wide) => cell.with_ranges_of(&wide.cell),
        None => cell,
    }
}

/// Returns a `Notify` that Ctrl-C or SIGTERM triggers.
fn end_at_signals() -> Arc<Notify> {
    let over = Arc::new(Notify::new());
    let asked = over.clone();
    let _ = ctrlc::set_handler(move || asked.notify_one());
    over
}

/// Opens the page in a browser through a temporary file. Returns this file, which must exist until the
/// session ends; None if no browser could be started.
fn opened(url: &str) -> Option<TempPath> {
    let opened = open_in_browser(url);
    if let Err(why) = &opened {
        output::talk(&format!("note: no browser could be started ({why}): copy the address into a browser"));
    }
    opened.ok()
}
