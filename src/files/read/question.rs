//! Checks of settings that depend on each other: errors, reading, quantity, senses and limits.

use crate::cell::{About, Cell};
use crate::files::toml::document::Library;
use crate::files::toml::tree::Node;

/// Records a fault for every combination of settings that cannot be evaluated. The fault is at the key of one
/// of these settings.
pub fn check(cell: &Cell, root: &Node, lib: &mut Library<'_>) {
    for fault in cell.interpretation_faults() {
        let at = match fault.about {
            About::Reading => {
                ["reading", "errors"].into_iter().find_map(|key| root.value.get(key)).map(|n| n.at)
            }
            About::Objective => {
                let search = root.value.get("search");
                let keys = ["robust", "objective", "pareto"].into_iter();
                search.and_then(|s| keys.filter_map(|key| s.value.get(key)).next()).map(|n| n.at)
            }
            About::Goals => {
                root.value.get("search").and_then(|search| search.value.get("pareto")).map(|n| n.at)
            }
            About::Operation(k) => {
                let flag = root.value.get("quantity").map(|node| node.at).filter(|at| lib.is_flag(*at));
                flag.or_else(|| operation(cell, root, k).map(|node| node.at))
            }
            About::Sense(k) => operation(cell, root, k).and_then(|o| o.value.get("sense")).map(|n| n.at),
        };
        lib.error(at.unwrap_or(root.at), fault.message, fault.help);
    }
}

fn operation<'n>(cell: &Cell, root: &'n Node, k: usize) -> Option<&'n Node> {
    root.value.get("operation")?.value.get(&cell.operations[k].name)
}
