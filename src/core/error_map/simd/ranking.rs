//! Lower bounds of the error at the nodes of a surface, computed for several nodes at once.
//!
//! A bound is the least error of all branches at a node, lowered by [`BOUND_MARGIN`] for rounding. Therefore
//! no posture at the node has a value ([`ErrorEvaluator::value`]) below this bound. The scalar code judges
//! single nodes in ascending order of their bounds, until the least value is below the bounds of all other
//! nodes. The spot is therefore bit-identical to the spot found by judging every node.

use super::lanes::{CosSin, Lanes, MAX_LANES};
use super::perturbed_chain::PerturbedChain;
use super::planar_arm::{Level, PlanarLanes};
use crate::cell::{MAX_ROWS, Placement};
use crate::error_map::grid::Grid;
use crate::error_map::node_ranking::{GROUP, NodeRanking};
use crate::pose::Pose;
use crate::reach::{Inverse, ToolAttitudes};
use crate::reading::ErrorEvaluator;
use nalgebra::{Matrix3, Vector3};
use pulp::{Arch, Simd, WithSimd};

/// A group of nodes fills whole vectors of the largest number of lanes. Otherwise, this array does not
/// compile.
const _: [(); 0] = [(); GROUP % MAX_LANES];

/// Relative and absolute margin by which a bound is lowered.
///
/// The relative margin is this share of the bound. The absolute margin (m) is this number times the sum of
/// the lengths of the sense's directions. Rounding errors are typically 1e-14 m. Near a singular posture,
/// they are 1e-10 m.
const BOUND_MARGIN: f64 = 1e-9;

/// Ranker of the nodes of one operation by lower bounds of their errors.
#[derive(Debug, Clone)]
pub struct Ranker {
    arm: PlanarLanes,
    chain: PerturbedChain,
    /// Directions of the sense, in the world frame.
    rows: Vec<Vector3<f64>>,
    /// Coordinate x of every node in the frame of the equipment, m. The field `ys` holds the coordinates y.
    /// The last node is repeated to fill the last group.
    xs: Vec<f64>,
    ys: Vec<f64>,
    count: usize,
    standoff: f64,
}

/// One direction of the sense, prepared for one layout.
///
/// The error in this direction is `built . p - (wanted . target - offset)`. Here `p` is the position of the
/// TCP, computed by [`PerturbedChain::tip`]. The vector `wanted` is the direction in the base frame, and
/// `built` is the direction in the frame of `p`. The scalar `offset` is the component of the origin of that
/// frame along the direction, m.
#[derive(Debug, Clone, Copy)]
struct RankingRow {
    built: Vector3<f64>,
    offset: f64,
    wanted: Vector3<f64>,
}

impl Ranker {
    /// Prepares an operation; None if the ranker does not support the arm, or the reading, model or sense
    /// of the operation.
    pub fn new(inverse: &Inverse, evaluator: &ErrorEvaluator, grid: &Grid) -> Option<Self> {
        let (errors, rows) = evaluator.plain()?;
        if rows.is_empty() {
            return None;
        }
        let (mut xs, mut ys) = grid.locals();
        let count = xs.len();
        for line in [&mut xs, &mut ys] {
            line.resize(count.next_multiple_of(GROUP), line.last().copied().unwrap_or(0.0));
        }
        let (arm, chain) = (PlanarLanes::new(inverse)?, PerturbedChain::new(inverse.chain(), errors)?);
        Some(Self { arm, chain, rows, xs, ys, count, standoff: grid.standoff() })
    }

    /// Returns whether the nodes can be ranked for these attitudes of the operation.
    pub fn takes(&self, attitudes: &ToolAttitudes) -> bool {
        !attitudes.is_judged_by_posture()
    }

    /// Ranks the nodes of a surface placed at `at` in the base frame.
    ///
    /// `world` is the rotation from world axes to the base frame.
    pub fn rank(
        &self,
        at: &Placement,
        world: &Matrix3<f64>,
        attitudes: &ToolAttitudes,
        ranking: &mut NodeRanking,
    ) {
        let (sin, cos) = at.yaw.sin_cos();
        let row = |k: usize| self.row(&(world * self.rows[k.min(self.rows.len() - 1)]));
        let rows = &std::array::from_fn::<_, MAX_ROWS, _>(row)[..self.rows.len()];
        ranking.set(self.count, |bounds| {
            Arch::new().dispatch(RankingPass { ranker: self, at, turn: (cos, sin), attitudes, rows, bounds });
        });
    }
}

/// Computation of all bounds of one layout. The code is compiled once for each SIMD instruction set.
struct RankingPass<'a> {
    ranker: &'a Ranker,
    at: &'a Placement,
    /// Cosine and sine of the yaw of the surface in the base frame.
    turn: (f64, f64),
    attitudes: &'a ToolAttitudes,
    rows: &'a [RankingRow],
    bounds: &'a mut [f64],
}

impl WithSimd for RankingPass<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { ranker, at, turn: (cos, sin), attitudes, rows, bounds } = self;
        let z = at.z + ranker.standoff;
        let (xs, _) = S::as_simd_f64s(&ranker.xs);
        let (ys, _) = S::as_simd_f64s(&ranker.ys);
        let (bounds, _) = S::as_mut_simd_f64s(bounds);
        // The length of a direction is a weight, which also scales rounding errors.
        let margin = BOUND_MARGIN * rows.iter().map(|row| row.wanted.norm()).sum::<f64>();
        for ((x, y), bound) in xs.iter().zip(ys).zip(bounds) {
            let (x, y) = (Lanes::new(simd, *x), Lanes::new(simd, *y));
            // The order of the additions and products equals the order in [`Grid::targets`].
            let target = Level { x: x * cos + at.x - y * sin, y: x * sin + at.y + y * cos, z };
            *bound = ranker.bound(target, rows, margin, attitudes).get();
        }
    }
}

impl Ranker {
    /// Computes the squared error of the postures. NaN is replaced by 0, so that the node is judged first.
    #[inline(always)]
    fn size2<S: Simd>(&self, turns: &[CosSin<S>; 4], rows: &[RankingRow], wanted: &[Lanes<S>]) -> Lanes<S> {
        let [x, y, z] = self.chain.tip(turns);
        let mut size2 = x.like(0.0);
        for (wanted, row) in wanted.iter().zip(rows) {
            let part = x * row.built.x + y * row.built.y + z * row.built.z - *wanted;
            size2 = part.times_plus(part, size2);
        }
        size2.is_above(-1.0).choose(size2, x.like(0.0))
    }

    /// Prepares a row from the direction `wanted` in the base frame.
    fn row(&self, wanted: &Vector3<f64>) -> RankingRow {
        let Pose { rotation, translation } = &self.chain.base;
        RankingRow { built: rotation.transpose() * wanted, offset: wanted.dot(translation), wanted: *wanted }
    }

    /// Computes the bound of each target: the least error of all branches, lowered by the share
    /// [`BOUND_MARGIN`] and then by `margin` (m).
    #[inline(always)]
    fn bound<S: Simd>(
        &self,
        target: Level<S>,
        rows: &[RankingRow],
        margin: f64,
        attitudes: &ToolAttitudes,
    ) -> Lanes<S> {
        let Level { x, y, z } = target;
        let mut wanted = [x; MAX_ROWS];
        for (wanted, row) in wanted.iter_mut().zip(rows) {
            *wanted = x * row.wanted.x + y * row.wanted.y + (row.wanted.z * z - row.offset);
        }
        let targets = self.arm.targets(&target);
        let mut least = x.like(f64::INFINITY);
        for attitude in attitudes.planar() {
            for back in [false, true] {
                let Some(wrist) = self.arm.wrist(&targets, attitude, back) else { continue };
                for up in [false, true] {
                    let (turns, out) = self.arm.branch(&wrist, up);
                    if !out.is_all() {
                        let size2 = self.size2(&turns, rows, &wanted);
                        least = (out | least.is_below(size2)).choose(least, size2);
                    }
                }
            }
        }
        least.sqrt() * (1.0 - BOUND_MARGIN) - margin
    }
}
