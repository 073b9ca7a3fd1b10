#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::*;
use crate::compare::Assessment;
use crate::drawing::Detail;
use crate::layout::Workcell;

fn workcell(name: &str) -> Workcell {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/cells/");
    let mut read = |path: &str| std::fs::read(format!("{folder}{path}")).map_err(|e| e.to_string());
    Workcell::new(crate::cell::load(name, &mut read).unwrap().cell).unwrap()
}
