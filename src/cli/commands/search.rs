//! `search`: with one seed, a job that can be stopped and resumed, or with several seeds on many machines.

mod islands;
mod one;
mod outcome;
mod session;

use crate::cli::Exit;
use crate::cli::arguments::SearchArguments;

/// Runs `sweetspot search`.
pub fn search(a: &SearchArguments) -> Result<Exit, Exit> {
    if islands::are_asked(a) { islands::search_islands(a) } else { one::search_once(a) }
}
