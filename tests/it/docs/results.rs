//! Committed folders of results/: their commands write what the folders contain.

use super::{REMAKE, same, writes};
use crate::cli::sandbox::{Sandbox, copy_folder, list};
use crate::common::root;

/// Folder that one command writes, and the arguments before `--out`.
const STUDIES: [(&str, &[&str]); 6] = [
    ("results/hitachi_cell", &["search", "cells/hitachi_cell.toml"]),
    ("results/paper", &["figures", "cells/hitachi_paper.toml", "results/hitachi_cell", "--width", "1200"]),
    ("results/readings/paper", &["readings", "cells/hitachi_paper.toml"]),
    ("results/readings/hitachi_cell", &["readings", "cells/hitachi_cell.toml"]),
    ("results/discrepancy/serial", &["map", "cells/hitachi_paper.toml"]),
    ("results/discrepancy/parallelogram", &["map", "cells/hitachi_paper_parallelogram.toml"]),
];

/// File with hashes of the other files, whose last digits may differ between processors.
const MANIFEST: &str = "manifest.json";

#[test]
fn the_committed_results_are_those_of_their_commands() {
    let shop = Sandbox::new();
    let mut faults = Vec::new();
    for (folder, args) in STUDIES {
        shop.done(&[args, &["--out", folder]].concat());
        let (made, kept) = (shop.path(folder), root().join(folder));
        if writes() {
            copy_folder(&made, &kept);
            continue;
        }
        let mut files = Vec::new();
        list(&made, "", &mut files);
        assert!(files.iter().any(|file| file == MANIFEST), "{folder}: {files:?}");
        for file in files.iter().filter(|file| *file != MANIFEST) {
            let why = same::pictures(&kept.join(file), &made.join(file));
            faults.extend(why.map(|why| format!("{folder}/{file} is stale:\n{why}")));
        }
    }
    assert!(faults.is_empty(), "{}\n{REMAKE}", faults.join("\n"));
}
