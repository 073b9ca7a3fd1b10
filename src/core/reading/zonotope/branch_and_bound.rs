//! Branch and bound over the signs of the generators, for more than three dimensions.
//!
//! The generators are sorted by size, the largest first. A table holds the sums of the last six generators
//! with all combinations of signs. Let `v` be the sum of the generators whose signs are chosen. Let `w` be a
//! sum of the other generators, `g_j, g_j+1, ..`, with any signs. Then
//!
//! ```text
//! |v + w|^2 <= |v|^2 + 2 sum |v . g_k| + K_j,     K_j = max |w|^2
//! ```
//!
//! The maximum `K_j` of `|w|^2` over all signs is known, because the smaller problem of the other generators
//! alone is solved first. This is Russian doll search (G. Verfaillie, M. Lemaitre, T. Schiex, AAAI 1996). The
//! bound is tight: 64 random generators in 6-D take about ten thousand nodes.

use super::MAX_GENERATORS;
use super::climb;
use super::sign_table::{SignTable, WIDTH, try_all};
use nalgebra::Vector6;

/// Largest number of generators for which all combinations of signs are tried.
const MAX_EXHAUSTIVE: usize = 11;
/// Largest number of nodes in the search of a subproblem. A subproblem leaves out the largest generators.
const MAX_SUBPROBLEM_NODES: usize = 20_000;
/// Largest number of nodes in the search over all generators.
const MAX_NODES: usize = 200_000;
/// Ratio up to which the squared norms of two sums count as equal.
const EQUAL_RATIO: f64 = 1.0 + 1e-14;

/// Branch and bound with its working memory.
pub(super) struct BranchAndBound {
    table: SignTable<6>,
    sorted: [Vector6<f64>; MAX_GENERATORS],
    /// Original index of each sorted generator.
    from: [usize; MAX_GENERATORS],
    /// Proven upper bounds `K_j` of the squared norm of any sum of the sorted generators from index j on.
    rest: [f64; MAX_GENERATORS],
    trial: [f64; MAX_GENERATORS],
    best: [f64; MAX_GENERATORS],
    search: BranchState,
}

/// State of one search.
#[derive(Default)]
struct BranchState {
    count: usize,
    /// Largest squared norm found so far.
    square: f64,
    /// Largest bound of a node that was not visited because of the node limit.
    open: f64,
    /// Number of nodes that the search may still visit.
    nodes: usize,
}

impl Default for BranchAndBound {
    fn default() -> Self {
        BranchAndBound {
            table: SignTable::default(),
            sorted: [Vector6::zeros(); MAX_GENERATORS],
            from: [0; MAX_GENERATORS],
            rest: [0.0; MAX_GENERATORS],
            trial: [1.0; MAX_GENERATORS],
            best: [1.0; MAX_GENERATORS],
            search: BranchState::default(),
        }
    }
}

impl BranchAndBound {
    /// Writes the signs of the longest sum found to `corner`.
    ///
    /// Returns a proven upper bound of the norm over all signs; None if the signs found are proven to be the
    /// best.
    pub(super) fn farthest(&mut self, generators: &[Vector6<f64>], corner: &mut [f64]) -> Option<f64> {
        let n = generators.len();
        if n <= MAX_EXHAUSTIVE {
            try_all(generators, &mut self.table, corner);
            return None;
        }
        self.sort(generators);
        let head = n - WIDTH;
        self.table.fill(&self.sorted[head..n]);
        self.table.write(&Vector6::zeros(), &mut self.best[head..n]);
        self.rest[head] = self.table.most(&Vector6::zeros());
        for from in (0..head).rev() {
            self.start(from, n);
            self.search.nodes = if from == 0 { MAX_NODES } else { MAX_SUBPROBLEM_NODES };
            self.trial[from] = 1.0;
            self.visit(from + 1, self.sorted[from]);
            self.rest[from] = self.search.square.max(self.search.open) * EQUAL_RATIO;
        }
        for (s, from) in self.best.iter().zip(&self.from[..n]) {
            corner[*from] = *s;
        }
        (self.search.open > self.search.square).then(|| self.search.open.sqrt())
    }

    fn sort(&mut self, generators: &[Vector6<f64>]) {
        let n = generators.len();
        for (k, from) in self.from[..n].iter_mut().enumerate() {
            *from = k;
        }
        let size = |k: &usize| generators[*k].norm_squared();
        self.from[..n].sort_unstable_by(|a, b| size(b).total_cmp(&size(a)).then(a.cmp(b)));
        for (sorted, from) in self.sorted.iter_mut().zip(&self.from[..n]) {
            *sorted = generators[*from];
        }
    }

    /// Starts a search over the sorted generators from index `from` on, with good initial signs.
    ///
    /// The generators after `from` get the signs of the longest sum of these generators alone, and generator
    /// `from` gets +1. Flips of single signs then improve the start.
    fn start(&mut self, from: usize, n: usize) {
        let (generators, signs) = (&self.sorted[from..n], &mut self.best[from..n]);
        signs[0] = 1.0;
        climb(generators, signs);
        let sum: Vector6<f64> = generators.iter().zip(&*signs).map(|(g, s)| g * *s).sum();
        self.search = BranchState { count: n, square: sum.norm_squared(), ..BranchState::default() };
    }

    /// Returns an upper bound of the squared norm of `v` plus the sorted generators from index `j` on, with
    /// any signs.
    fn bound(&self, j: usize, v: &Vector6<f64>) -> f64 {
        let mut sum = 0.0;
        for g in &self.sorted[j..self.search.count] {
            sum += g.dot(v).abs();
        }
        v.norm_squared() + 2.0 * sum + self.rest[j]
    }

    /// Searches all combinations of signs whose first `j` signs are the signs in `trial`.
    ///
    /// `v` is the sum of the first `j` generators with these signs.
    fn visit(&mut self, j: usize, v: Vector6<f64>) {
        let n = self.search.count;
        if j == n - WIDTH {
            let square = v.norm_squared() + self.table.most(&v);
            if square > self.search.square {
                self.search.square = square;
                self.best[..j].copy_from_slice(&self.trial[..j]);
                self.table.write(&v, &mut self.best[j..n]);
            }
            return;
        }
        let first = 1f64.copysign(v.dot(&self.sorted[j]));
        for sign in [first, -first] {
            let child = v + self.sorted[j] * sign;
            let bound = self.bound(j + 1, &child);
            let promising = bound > self.search.square * EQUAL_RATIO;
            if promising && self.search.nodes > 0 {
                self.search.nodes -= 1;
                self.trial[j] = sign;
                self.visit(j + 1, child);
            } else if promising {
                self.search.open = self.search.open.max(bound);
            }
        }
    }
}
