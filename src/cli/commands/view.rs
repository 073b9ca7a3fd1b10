//! `view`: starts the local web server with the layout editor.

use super::{suggest, warn_of_hopeless, workcell};
use crate::cell::Cell;
use crate::cli::arguments::ViewArguments;
use crate::cli::output::path_word;
use crate::cli::packages::PackageFolders;
use crate::cli::view::{AccessControl, LiveView, Origin, secret, serve};
use crate::cli::{Exit, asked, loading, output, results_folder};
use crate::files::Loaded;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tiny_http::Server;

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
    let server = Server::http(("127.0.0.1", a.port)).map_err(|e| {
        output::error(&format!("cannot listen on 127.0.0.1:{}: {e}", a.port));
        Exit::Io
    })?;
    let port = server.server_addr().to_ip().map_or(a.port, |address| address.port());
    let access = AccessControl::new(secret().map_err(failed)?, port);
    let server = Arc::new(server);
    let over = end_at_signals(&server);
    output::data(&format!("{}\n", access.url()))?;
    output::talk("open this address in a browser on this machine; press Ctrl-C here to stop");
    if a.open {
        open(&access.url());
    }
    serve(view, &server, access, &over).map_err(failed)?;
    suggest(&format!("check {}", path_word(&file)));
    Ok(Exit::Done)
}

fn failed(why: String) -> Exit {
    output::error(&why);
    Exit::Io
}

/// Returns the cell of a search result with the ranges of that search, in which the page can search again.
fn searched(cell: Cell, sources: &[PathBuf], packages: &PackageFolders) -> Cell {
    // The first source is best.toml, the second the cell file that it is made from.
    let wide = sources.get(1).and_then(|file| loading::read_cell(file, packages).ok());
    match wide {
        Some(wide) => cell.with_ranges_of(&wide.cell),
        None => cell,
    }
}

/// Returns a flag that Ctrl-C or SIGTERM sets. The server then stops waiting for requests.
fn end_at_signals(server: &Arc<Server>) -> Arc<AtomicBool> {
    let over = Arc::new(AtomicBool::new(false));
    let (asked, server) = (over.clone(), server.clone());
    let _ = ctrlc::set_handler(move || {
        asked.store(true, Ordering::Relaxed);
        server.unblock();
    });
    over
}

/// Asks the desktop to open the page.
fn open(url: &str) {
    let mut command = if cfg!(target_os = "macos") {
        Command::new("open")
    } else if cfg!(windows) {
        let mut command = Command::new("cmd");
        command.args(["/C", "start", ""]);
        command
    } else {
        Command::new("xdg-open")
    };
    let spawned = command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    if spawned.is_err() {
        output::talk("note: no browser could be started: copy the address into one");
    }
}
