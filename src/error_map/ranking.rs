//! The nodes of a surface by the least error they can have: found for many nodes at once, to rank them.
//!
//! What is ranked is a lower bound, below the value of [`ErrorEvaluator::value`] by no more than [`SURE`] allows:
//! nodes are judged in this order by the code for one node until the least value judged is below all
//! bounds that are left. So the spot is the same, to the bit, as if every node had been judged.

use super::grid::Grid;
use crate::cell::{MAX_ROWS, Placement};
use crate::kinematic_error::WrongChain;
use crate::lanes::{Arch, CosSin, Lanes, MOST_LANES, Simd, WithSimd};
use crate::pose::Pose;
use crate::reach::{Inverse, Level, PlanarLanes, ToolAttitudes};
use crate::reading::ErrorEvaluator;
use crate::robot::Chain;
use nalgebra::{Matrix3, Vector3};

/// By so much (m, and as a share) a bound is taken lower than it was found. Rounding makes 1e-14 m of a
/// posture, and 1e-10 m next to a singular one.
const SURE: f64 = 1e-9;

/// Nodes of one group: the least bound is looked for among groups, then in its group.
const GROUP: usize = 2 * MOST_LANES;

/// An operation whose nodes can be ranked.
#[derive(Debug, Clone)]
pub struct Ranker {
    arm: PlanarLanes,
    chain: WrongChain,
    /// Directions of the sense, world frame.
    rows: Vec<Vector3<f64>>,
    /// Nodes in the frame of the surface, m; the last is repeated to fill the last group.
    xs: Vec<f64>,
    ys: Vec<f64>,
    count: usize,
    standoff: f64,
}

/// One row of the sense: `built . p + offset - wanted . target` is the error in it, with p the TCP in the
/// frame behind the first motion of the chain.
#[derive(Debug, Clone, Copy)]
struct Row {
    built: Vector3<f64>,
    offset: f64,
    wanted: Vector3<f64>,
}

/// Bounds of the nodes of one layout; memory kept from layout to layout.
#[derive(Default)]
pub struct Ranking {
    /// Of every node, m; infinite where nothing is in reach.
    bounds: Vec<f64>,
    /// Of every group.
    groups: Vec<f64>,
}

impl Ranker {
    /// None where the code for one node must do: it depends on arm, reading, model and sense.
    pub fn new(chain: &Chain, inverse: &Inverse, gauge: &ErrorEvaluator, grid: &Grid) -> Option<Self> {
        let (errors, rows) = gauge.plain()?;
        if rows.is_empty() {
            return None;
        }
        let (mut xs, mut ys) = grid.locals();
        let count = xs.len();
        for line in [&mut xs, &mut ys] {
            line.resize(count.next_multiple_of(GROUP), line.last().copied().unwrap_or(0.0));
        }
        let (arm, chain) = (inverse.lanes()?, WrongChain::new(chain, errors)?);
        Some(Self { arm, chain, rows, xs, ys, count, standoff: grid.standoff() })
    }

    /// Whether an approach can be ranked.
    pub fn takes(&self, approach: &ToolAttitudes) -> bool {
        self.arm.takes(approach)
    }

    /// Ranks the nodes of the surface placed at `at` (base frame); `world` turns world axes into the base
    /// frame.
    pub fn rank(
        &self,
        at: &Placement,
        world: &Matrix3<f64>,
        approach: &ToolAttitudes,
        ranking: &mut Ranking,
    ) {
        let Ranking { bounds, groups } = ranking;
        bounds.resize(self.xs.len(), f64::INFINITY);
        let (sin, cos) = at.yaw.sin_cos();
        let row = |k: usize| self.row(&(world * self.rows[k.min(self.rows.len() - 1)]));
        let rows = &std::array::from_fn::<_, MAX_ROWS, _>(row)[..self.rows.len()];
        Arch::new().dispatch(Walk { ranker: self, at, turn: (cos, sin), approach, rows, bounds });
        bounds[self.count..].fill(f64::INFINITY);
        groups.clear();
        groups.extend(bounds.chunks(GROUP).map(least));
    }
}

impl Ranking {
    /// The least bound of the nodes that are left.
    pub fn bound(&self) -> f64 {
        least(&self.groups)
    }

    /// Takes the node with the least bound out; the first of them.
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

/// All nodes of one layout.
struct Walk<'a> {
    ranker: &'a Ranker,
    at: &'a Placement,
    /// Cosine and sine of the yaw.
    turn: (f64, f64),
    approach: &'a ToolAttitudes,
    rows: &'a [Row],
    bounds: &'a mut [f64],
}

impl WithSimd for Walk<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { ranker, at, turn: (cos, sin), approach, rows, bounds } = self;
        let z = at.z + ranker.standoff;
        let (xs, _) = S::as_simd_f64s(&ranker.xs);
        let (ys, _) = S::as_simd_f64s(&ranker.ys);
        let (bounds, _) = S::as_mut_simd_f64s(bounds);
        // A long direction is a weight: it weighs what rounding makes, too.
        let sure = SURE * rows.iter().map(|row| row.wanted.norm()).sum::<f64>();
        for ((x, y), bound) in xs.iter().zip(ys).zip(bounds) {
            let (x, y) = (Lanes::new(simd, *x), Lanes::new(simd, *y));
            // In the order of [`Grid::targets`].
            let target = Level { x: x * cos + at.x - y * sin, y: x * sin + at.y + y * cos, z };
            *bound = ranker.bound(target, rows, sure, approach).get();
        }
    }
}

impl Ranker {
    /// The square of the error of the postures. What is no number cannot be ranked: it is judged first.
    #[inline(always)]
    fn size2<S: Simd>(&self, turns: &[CosSin<S>; 4], rows: &[Row], wanted: &[Lanes<S>]) -> Lanes<S> {
        let [x, y, z] = self.chain.tip(turns);
        let mut size2 = x.like(0.0);
        for (wanted, row) in wanted.iter().zip(rows) {
            let part = x * row.built.x + y * row.built.y + z * row.built.z - *wanted;
            size2 = part.times_plus(part, size2);
        }
        size2.is_above(-1.0).choose(size2, x.like(0.0))
    }

    /// A direction, base frame.
    fn row(&self, wanted: &Vector3<f64>) -> Row {
        let Pose { rotation, translation } = &self.chain.base;
        Row { built: rotation.transpose() * wanted, offset: wanted.dot(translation), wanted: *wanted }
    }

    /// The least error of the targets over all branches, less what rounding may have added.
    #[inline(always)]
    fn bound<S: Simd>(
        &self,
        target: Level<S>,
        rows: &[Row],
        sure: f64,
        approach: &ToolAttitudes,
    ) -> Lanes<S> {
        let Level { x, y, z } = target;
        let mut wanted = [x; MAX_ROWS];
        for (wanted, row) in wanted.iter_mut().zip(rows) {
            *wanted = x * row.wanted.x + y * row.wanted.y + (row.wanted.z * z - row.offset);
        }
        let targets = self.arm.targets(&target);
        let mut least = x.like(f64::INFINITY);
        for way in approach.planar() {
            for back in [false, true] {
                let Some(wrist) = self.arm.wrist(&targets, way, back) else { continue };
                for up in [false, true] {
                    let (turns, out) = self.arm.branch(&wrist, up);
                    if !out.is_all() {
                        let size2 = self.size2(&turns, rows, &wanted);
                        least = (out | least.is_below(size2)).choose(least, size2);
                    }
                }
            }
        }
        least.sqrt() * (1.0 - SURE) - sure
    }
}
