//! Tests the cache of convex parts between runs: valid entries are used, damaged entries are repaired, and
//! the cache is not required.

use crate::cli::sandbox::{CELL, Sandbox, ran, sha256};

/// Cell with an L-shaped mesh of two bars on the forearm.
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
        assert_eq!(shop.read(&path), kept, "the entry is not repaired");
    }
    // Without a usable folder or without a link mesh, nothing is cached.
    assert_eq!(map("cells/angle.toml/below"), without);
    let mut command = shop.command(&["check", CELL]);
    assert_eq!(ran(command.env("SWEETSPOT_CACHE", "other").output().unwrap()).code, Some(0));
    assert!(!shop.path("other").exists());
}

/// The test forges an entry with the right hash. The entry is used if only the user can write it, otherwise
/// it is computed again.
#[cfg(unix)]
#[test]
fn a_cache_entry_that_others_may_write_is_computed_again() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let shop = Sandbox::new();
    shop.write("cells/angle.toml", ANGLE);
    let map = || {
        let mut command = shop.command(&["map", "cells/angle.toml", "--json"]);
        ran(command.env("SWEETSPOT_CACHE", "kept").output().unwrap())
    };
    map().no_panic();
    let name = shop.files("kept").remove(0);
    let path = shop.path(&format!("kept/{name}"));
    let kept = std::fs::read(&path).unwrap();
    let content = vec![1; kept.len() - 64];
    let seal = sha256(&[name.as_bytes(), b"\n", &content].concat());
    let forged = [seal.as_bytes(), &content].concat();
    assert_ne!(forged, kept);
    let now = |mode: u32| {
        std::fs::write(&path, &forged).unwrap();
        std::fs::set_permissions(&path, PermissionsExt::from_mode(mode)).unwrap();
        map().no_panic();
        std::fs::read(&path).unwrap()
    };
    assert_eq!(now(0o600), forged, "an entry that only the user can write is used");
    assert_eq!(now(0o644), forged);
    assert_eq!(now(0o666), kept, "everybody may write it");
    assert_eq!(now(0o620), kept, "the group may write it");
    // Under another name, the hash of an entry is wrong.
    let other = shop.path("kept").join("a".repeat(64));
    std::fs::rename(&path, &other).unwrap();
    symlink(&other, &path).unwrap();
    map().no_panic();
    assert!(!path.symlink_metadata().unwrap().is_symlink());
    std::fs::remove_file(&path).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    map().no_panic();
    assert_eq!(std::fs::read(&path).unwrap(), kept, "a pipe is replaced");
}
