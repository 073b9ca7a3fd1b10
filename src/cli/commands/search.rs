//! `search`: a search with one seed, which can be stopped and resumed, or with several seeds on many
//! machines.

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
