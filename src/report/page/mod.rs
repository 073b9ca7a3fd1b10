//! Pages for the browser.

mod assets;
mod live;

pub use live::live;
