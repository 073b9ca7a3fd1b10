//! Bound of an operation over the placement of its nodes. The nodes have different distances from the base
//! axis, and the arm must reach the surroundings of every node.
//!
//! Consider the least value of a single node over all postures with a given height and radius (distance from
//! the base axis). This value is a lower bound of the value of each node with this height and radius. All
//! nodes of an operation have the same height, and keep their distances from each other. Let the origin of
//! the surface have the distance `rho` from the base axis, and let a node have the polar coordinates (d,
//! delta) on the surface. The radius of the node is then `sqrt(rho^2 + d^2 + 2 rho d cos(phi + delta))`. Here
//! phi is the yaw of the surface relative to the line from the base axis to the origin of the surface.
//!
//! A layout chooses one elevation of the tool for all nodes. Branch and bound over (height, elevation, rho,
//! phi) minimizes the combined value of all nodes. The bounds of single nodes are computed for intervals of
//! height, elevation and radius. The lengths of these intervals are halves, quarters, ... of the whole
//! ranges. The search keeps these bounds and reuses them for other placement cells (ranges of height,
//! elevation, rho and phi). A node whose surroundings are cut off cannot be used ([`Surroundings`]).
//!
//! An operation that happens at its best node is treated like an operation at one node in the origin of the
//! surface. A planar arm keeps the direction in which its tool leans along a line, so the two directions are
//! bounded separately ([`Lean`]).

use super::branch_and_bound;
use super::planar_arm::Lean;
use super::region::{OperationRegion, chosen_elevations, with_tolerance};
use super::surroundings::Surroundings;
use super::task::Task;
use super::{ProofOptions, WhyNot};
use crate::error_map::Grid;
use crate::layout::Workcell;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, Ordering as MemoryOrdering};

/// Largest number of parts into which the search divides the extent of the nodes.
const MAX_PARTS: f64 = 96.0;
/// Least horizontal component of the tool axis with which a tool counts as leaning.
const LEAST_LEAN: f64 = 1e-6;
/// Largest number of joints with a coordinate for which the surroundings of a single node are examined. For
/// arms with more joints, this takes far longer than the bound without the surroundings.
const MOST_FREE_JOINTS: usize = 3;
/// Least extent of a placement cell that is divided, m.
const LEAST_SIZE: f64 = 1e-3;
/// Divisor that converts the length of a height interval to the equivalent length of a radius interval.
const HEIGHT_SHARE: f64 = 4.0;
/// Length, m, by which an interval of the elevation is multiplied to give the equivalent length of a radius
/// interval.
const ELEVATION_LEVER: f64 = 0.5;
/// Largest number of placement cells ([`PlacementCell`]) that the search examines.
const MAX_CELLS: usize = 20_000;
/// Largest number of times that the range of the radius is halved.
const MAX_LEVEL: u32 = 20;
/// Least relative gap at which the bound of a single node is accepted. If [`ProofOptions::gap`] is larger,
/// that gap applies instead.
const NODE_GAP: f64 = 1e-3;

/// Interval as a pair (level, index). Halving a range `level` times gives 2^level intervals of equal length,
/// and `index` counts these intervals from 0.
type Dyadic = (u32, u64);

/// Set of placements of the nodes, with a lower bound of the combined value.
#[derive(Debug, Clone)]
struct PlacementCell {
    height: Dyadic,
    /// Elevation of the tool that the layout chooses for all nodes.
    elevation: Dyadic,
    /// Range of the distance of the origin of the surface from the base axis, m.
    rho: (f64, f64),
    /// Range of the yaw of the surface relative to the line from the base axis to the surface origin, rad.
    phi: (f64, f64),
    bound: f64,
    number: usize,
}

impl Ord for PlacementCell {
    /// Orders placement cells so that the heap returns the one with the least bound first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for PlacementCell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for PlacementCell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for PlacementCell {}

/// Search for the placement of all nodes with the least combined value.
struct NodeRadii<'a> {
    workcell: &'a Workcell,
    region: OperationRegion,
    /// Range of the radius of a node, m.
    radius: (f64, f64),
    /// Whether the two directions in which the tool may lean are bounded separately.
    leans: bool,
    /// Range of the elevation that a layout may choose, rad; None if the arm fixes the elevation.
    elevation: Option<(f64, f64)>,
    /// Targets that the arm must reach in addition to a node.
    surroundings: Surroundings<'a>,
    /// Polar coordinates (m, rad) of the nodes in the frame of the equipment.
    nodes: Vec<(f64, f64)>,
    /// Lower bounds of the value of a single node. Each key holds the intervals of height, elevation and
    /// radius.
    known: HashMap<[Dyadic; 3], f64>,
    boxes: u64,
    options: &'a ProofOptions,
    stop: &'a AtomicBool,
}

/// Returns a lower bound of the combined value of all nodes of an operation, and the number of boxes that the
/// search examined. `start` is the bound of a single node. `known` is a known combined value, or infinity.
///
/// Returns None if the operation happens at one node, or if the radius of a node cannot be limited.
pub(super) fn least_of_all_nodes(
    workcell: &Workcell,
    region: &OperationRegion,
    (start, known): (f64, f64),
    options: &ProofOptions,
    stop: &AtomicBool,
) -> Option<(f64, u64)> {
    let operation = &workcell.cell.operations[region.operation];
    let radius = region.radius?;
    let surroundings = Surroundings::new(workcell, region);
    let grid = Grid::new(operation);
    let polar = |k: usize| {
        let (x, y) = grid.local(k);
        (x.hypot(y), y.atan2(x))
    };
    let nodes: Vec<(f64, f64)> = match operation.over.needs_every_node() {
        true => (0..grid.count()).map(polar).collect(),
        false => vec![(0.0, 0.0)],
    };
    let Task { limits_radius, is_planar, free_joints, .. } = Task::new(workcell, region).ok()?;
    let is_useful = nodes.len() > 1 || !surroundings.is_empty() && free_joints <= MOST_FREE_JOINTS;
    if !limits_radius || !is_useful {
        return None;
    }
    let elevation = region.elevation.map(|_| chosen_elevations(operation));
    let leans = elevation.is_some_and(|(low, high)| low.cos().abs().max(high.cos().abs()) > LEAST_LEAN);
    let mut search = NodeRadii {
        workcell,
        region: *region,
        radius,
        leans: is_planar && leans,
        elevation,
        surroundings,
        nodes,
        known: HashMap::new(),
        boxes: 0,
        options,
        stop,
    };
    let bound = search.least(start, known * (1.0 - options.gap));
    Some((bound.max(start), search.boxes))
}

impl NodeRadii<'_> {
    /// Returns a lower bound of the combined value over all placements. The search ends when the bound
    /// reaches `enough`.
    fn least(&mut self, start: f64, enough: f64) -> f64 {
        let farthest = self.nodes.iter().map(|node| node.0).fold(0.0, f64::max);
        let finest = (2.0 * farthest / MAX_PARTS).max(LEAST_SIZE);
        let rho = ((self.radius.0 - farthest).max(0.0), self.radius.1 + farthest);
        let (height, elevation) = ((0, 0), (0, 0));
        let whole = PlacementCell { height, elevation, rho, phi: (0.0, TAU), bound: start, number: 0 };
        let (mut heap, mut number) = (BinaryHeap::from([whole]), 0);
        while let Some(cell) = heap.pop() {
            let (low, high) = self.heights(cell.height);
            let (least, most) = self.elevations(cell.elevation).unwrap_or_default();
            let sizes = [
                (high - low) / HEIGHT_SHARE,
                (most - least) * ELEVATION_LEVER,
                cell.rho.1 - cell.rho.0,
                farthest * (cell.phi.1 - cell.phi.0),
            ];
            let largest = (0..sizes.len()).fold(0, |a, b| if sizes[b] > sizes[a] { b } else { a });
            let is_done = cell.bound >= enough
                || sizes[largest] <= finest
                || number >= MAX_CELLS
                || self.boxes >= self.options.boxes
                || self.stop.load(MemoryOrdering::Relaxed);
            if is_done {
                return cell.bound;
            }
            for mut half in halves(&cell, largest) {
                number += 1;
                half.number = number;
                half.bound = half.bound.max(self.combined(&half));
                if half.bound.is_finite() {
                    heap.push(half);
                }
            }
        }
        // No placement lets the arm reach every node.
        f64::INFINITY
    }

    /// Converts a height interval from the form (level, index) to its least and greatest height, m.
    fn heights(&self, (level, index): Dyadic) -> (f64, f64) {
        within(self.region.height, (level, index))
    }

    /// Converts an interval of the chosen elevation from the form (level, index) to its ends, rad. Returns
    /// None if the arm fixes the elevation.
    fn elevations(&self, interval: Dyadic) -> Option<(f64, f64)> {
        self.elevation.map(|range| within(range, interval))
    }

    /// Returns a lower bound of the combined value of all nodes in a placement cell. Returns infinity if the
    /// arm cannot reach a node.
    fn combined(&mut self, cell: &PlacementCell) -> f64 {
        let mut values = Vec::with_capacity(self.nodes.len());
        for k in 0..self.nodes.len() {
            let value = self.of_node(cell, self.nodes[k]);
            if value == f64::INFINITY {
                return value;
            }
            values.push(value);
        }
        self.workcell.cell.operations[self.region.operation].over.of(&mut values)
    }

    /// Returns a lower bound of the value of one node in a placement cell.
    fn of_node(&mut self, cell: &PlacementCell, (d, delta): (f64, f64)) -> f64 {
        let (near, far) = radii(cell, d, delta);
        let (low, high) = self.radius;
        let (from, to) = (near.max(low), far.min(high));
        if from > to {
            return f64::INFINITY;
        }
        let mut level = 0;
        while level < MAX_LEVEL && (high - low) / f64::from(1 << level) > (to - from).max(1e-3) {
            level += 1;
        }
        let count = 1u64 << level;
        let index = |r: f64| (((r - low) / (high - low) * count as f64) as u64).min(count - 1);
        // A radius on the border of two intervals belongs to both.
        let (first, last) = (index(from - 1e-9), index(to + 1e-9));
        (first..=last)
            .map(|k| self.of_interval([cell.height, cell.elevation, (level, k)]))
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns a lower bound of the value of a single node whose height, elevation and radius lie in the
    /// given intervals.
    fn of_interval(&mut self, intervals: [Dyadic; 3]) -> f64 {
        if let Some(bound) = self.known.get(&intervals) {
            return *bound;
        }
        let [height, elevation, radius] = intervals;
        let operation = &self.workcell.cell.operations[self.region.operation];
        let elevation = self.elevations(elevation).map(|chosen| with_tolerance(operation, chosen));
        let (low, high) = within(self.radius, radius);
        let region = OperationRegion {
            height: self.heights(height),
            radius: Some((low, high)),
            elevation,
            ..self.region
        };
        let leans: &[_] = if self.leans { &[Some(Lean::Forwards), Some(Lean::Backwards)] } else { &[None] };
        let of_lean = |lean: &Option<Lean>| self.of_region(&OperationRegion { lean: *lean, ..region });
        let bound = leans.iter().map(of_lean).fold(f64::INFINITY, f64::min);
        self.known.insert(intervals, bound);
        bound
    }

    /// Returns a lower bound of the value of a single node in a region. Returns infinity if the node is
    /// certainly not usable.
    fn of_region(&mut self, region: &OperationRegion) -> f64 {
        if self.surroundings.are_cut_off(region) {
            return f64::INFINITY;
        }
        match Task::new(self.workcell, region) {
            Ok(task) => {
                let boxes = (self.options.boxes / 50).max(100);
                let gap = self.options.gap.max(NODE_GAP);
                match branch_and_bound::least(&task, f64::INFINITY, gap, boxes, self.stop) {
                    Some(found) => {
                        self.boxes += found.boxes;
                        found.bound
                    }
                    None => f64::INFINITY,
                }
            }
            Err(WhyNot::Infeasible) => f64::INFINITY,
            Err(_) => 0.0,
        }
    }
}

/// Converts an interval from the form (level, index) to its two ends, within the range from `low` to `high`.
fn within((low, high): (f64, f64), (level, index): Dyadic) -> (f64, f64) {
    let step = (high - low) / (1u64 << level) as f64;
    (low + step * index as f64, low + step * (index + 1) as f64)
}

/// Returns the two halves of a placement cell in one dimension: height (0), elevation (1), rho (2) or phi
/// (3).
fn halves(cell: &PlacementCell, dimension: usize) -> [PlacementCell; 2] {
    let (mut one, mut two) = (cell.clone(), cell.clone());
    let middle = |(low, high): (f64, f64)| (low + high) / 2.0;
    let parts = |(level, index): Dyadic| ((level + 1, 2 * index), (level + 1, 2 * index + 1));
    match dimension {
        0 => (one.height, two.height) = parts(cell.height),
        1 => (one.elevation, two.elevation) = parts(cell.elevation),
        2 => (one.rho.1, two.rho.0) = (middle(cell.rho), middle(cell.rho)),
        _ => (one.phi.1, two.phi.0) = (middle(cell.phi), middle(cell.phi)),
    }
    [one, two]
}

/// Returns the least and the greatest radius, m, of a node in a placement cell. The node has the polar
/// coordinates (d, delta).
fn radii(cell: &PlacementCell, d: f64, delta: f64) -> (f64, f64) {
    let (from, to) = (cell.phi.0 + delta, cell.phi.1 + delta);
    // Returns whether the range of angles contains `at`, or `at` plus or minus whole turns.
    let holds = |at: f64| ((from - at) / TAU).ceil() * TAU + at <= to;
    let (a, b) = (from.cos(), to.cos());
    let least = if holds(std::f64::consts::PI) { -1.0 } else { a.min(b) };
    let most = if holds(0.0) { 1.0 } else { a.max(b) };
    let radius = |rho: f64, cos: f64| (rho * rho + d * d + 2.0 * rho * d * cos).max(0.0).sqrt();
    let near = (-d * least).clamp(cell.rho.0, cell.rho.1);
    (radius(near, least), radius(cell.rho.0, most).max(radius(cell.rho.1, most)))
}
