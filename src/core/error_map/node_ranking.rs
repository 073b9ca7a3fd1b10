//! Nodes of an operation in ascending order of lower bounds of their values.

/// Number of nodes in a group. [`NodeRanking::pop`] finds the best group first, then the best node in this
/// group.
pub const GROUP: usize = 16;

/// Lower bounds of the values at the nodes in one layout, in memory that is reused from layout to layout.
#[derive(Default)]
pub struct NodeRanking {
    /// One bound per node, m or rad; infinite if no posture reaches the node. The last group is filled with
    /// infinite bounds.
    bounds: Vec<f64>,
    /// Least bound in each group of nodes.
    groups: Vec<f64>,
}

impl NodeRanking {
    /// Removes all nodes.
    pub fn clear(&mut self) {
        self.bounds.clear();
        self.groups.clear();
    }

    /// Sets the bounds of `count` nodes. The function `write` writes the bound of every node. The slice that
    /// it receives is longer than `count` if the last group is not full.
    pub fn set(&mut self, count: usize, write: impl FnOnce(&mut [f64])) {
        self.bounds.resize(count.next_multiple_of(GROUP), f64::INFINITY);
        write(&mut self.bounds);
        self.bounds[count..].fill(f64::INFINITY);
        self.groups.clear();
        self.groups.extend(self.bounds.chunks(GROUP).map(least));
    }

    /// Returns the least bound of the nodes that were not removed yet; infinite if no node is left.
    pub fn bound(&self) -> f64 {
        least(&self.groups)
    }

    /// Removes and returns the node with the least bound, or the first of several nodes with equal bounds.
    /// Returns None if no reachable node is left.
    pub fn pop(&mut self) -> Option<usize> {
        let bound = self.bound();
        let group = self.groups.iter().position(|b| *b == bound && *b < f64::INFINITY)?;
        let nodes = &mut self.bounds[group * GROUP..][..GROUP];
        let node = nodes.iter().position(|b| *b == bound)?;
        nodes[node] = f64::INFINITY;
        self.groups[group] = least(nodes);
        Some(group * GROUP + node)
    }
}

fn least(bounds: &[f64]) -> f64 {
    bounds.iter().fold(f64::INFINITY, |a, &b| if b < a { b } else { a })
}
