//! Nodes at which a tolerance allocation meets the limits.

use super::posture_context::no_spot;
use crate::error_map::OperationMap;
use crate::layout::Workcell;

/// Index of a node in the list of its map, and its indices (i, j) in the grid.
pub type ChosenNode = (usize, (usize, usize));

/// Choice of the nodes at which every operation must stay within its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AllocatedNodes {
    /// The spot of an operation, or every node if the operation happens at all of its nodes.
    Spots,
    /// Every usable node.
    Usable,
    /// Cheapest node of each operation. The cost of a node is the cost of the cheapest tolerances that meet
    /// the limit at this node alone.
    Cheapest,
    /// The node with these indices.
    Node(usize, usize),
}

/// Returns the nodes of a map at which the operation must stay within its limit, each with its index in the
/// map.
///
/// For [`AllocatedNodes::Cheapest`], the function returns every usable node. The function
/// `keep_cheapest_nodes` of the tolerance allocation later keeps one of these nodes.
pub fn chosen(
    workcell: &Workcell,
    map: &OperationMap,
    nodes: AllocatedNodes,
) -> Result<Vec<ChosenNode>, String> {
    let operation = &workcell.cell.operations[map.operation];
    let usable: Vec<ChosenNode> = map
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, n)| n.usable_posture().is_some())
        .map(|(k, n)| (k, (n.i, n.j)))
        .collect();
    let none = || no_spot(&workcell.cell, map);
    match nodes {
        AllocatedNodes::Spots if !operation.over.needs_every_node() => {
            let spot = map.best.ok_or_else(none)?;
            Ok(usable.into_iter().filter(|(k, _)| *k == spot).collect())
        }
        AllocatedNodes::Node(i, j) => {
            let found: Vec<_> = usable.into_iter().filter(|(_, node)| *node == (i, j)).collect();
            if found.is_empty() {
                return Err(format!(
                    "node ({i}, {j}) cannot be used; `sweetspot explain CELL --at {i},{j}` gives the reason"
                ));
            }
            Ok(found)
        }
        AllocatedNodes::Spots if map.best.is_none() => Err(none()),
        _ if usable.is_empty() => Err(none()),
        _ => Ok(usable),
    }
}
