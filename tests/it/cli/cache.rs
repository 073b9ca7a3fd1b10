//! Tests convex parts cached between runs: used, repaired when damaged, and done without.

use crate::cli::sandbox::{CELL, Sandbox, ran};

/// Angle of two bars on the forearm.
const ANGLE: &str = "from = \"hitachi_cell.toml\"\n[robot]\n\
    solid = [{ name = \"angle\", link = 3, mesh = { file = \"equipment/machine.stl\", units = \"mm\", centre_mm = [0, 0, 0] } }]\n";

#[test]
fn the_cache_changes_nothing_but_the_time() {
    let shop = Sandbox::new();
    shop.write("cells/angle.toml", ANGLE);
    let map = |cache: &str| {
        let mut command = shop.command(&["map", "cells/angle.toml", "--json"]);
        let ran = ran(command.env("SWEETSPOT_CACHE", cache).output().unwrap());
        assert!(ran.code.is_some_and(|code| code < 2), "{}", ran.err);
        ran.no_panic();
        ran.out
    };
    let without = map("off");
    assert_eq!(map("kept"), without);
    let files = shop.files("kept");
    assert_eq!(files.len(), 1);
    let path = format!("kept/{}", files[0]);
    let kept = shop.read(&path);
    // A damaged entry is computed again and repaired.
    let longer = [&kept[..], b"x"].concat();
    let mut changed = kept.clone();
    changed[100] ^= 1;
    for damaged in [Vec::new(), vec![0xff; 50], kept[..kept.len() / 2].to_vec(), longer, changed] {
        std::fs::write(shop.path(&path), damaged).unwrap();
        assert_eq!(map("kept"), without);
        assert_eq!(shop.read(&path), kept, "not mended");
    }
    // Without a usable folder, or without a link mesh, nothing is cached.
    assert_eq!(map("cells/angle.toml/below"), without);
    let mut command = shop.command(&["check", CELL]);
    assert_eq!(ran(command.env("SWEETSPOT_CACHE", "other").output().unwrap()).code, Some(0));
    assert!(!shop.path("other").exists());
}
