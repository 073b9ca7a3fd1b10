//! Cycle time of a layout: approaches, dwells, retracts and the moves between the operations.

use super::line_time::{line_time, path_of_legs_time};
use super::rate_bounds::RateBounds;
use super::straight_move::straight_move_time;
use crate::cell::{Cell, JointVector};
use crate::motion::{Guard, OperationPosture, Transfer, nearest_turns};
use crate::robot::Chain;

/// Activity of the robot in one part of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CyclePhase {
    /// Straight approach to the spot of an operation.
    Approach,
    /// Operation itself, with the robot at rest at the spot.
    Dwell,
    /// Straight retract from the spot of an operation.
    Retract,
    /// Collision-free move to the next operation.
    Transfer,
    /// Direct move to the next operation; the move is not checked for collision.
    DirectMove,
}

/// Time of one part of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CycleStep {
    pub phase: CyclePhase,
    /// Index of the operation. For a move between operations, this is the operation before the move.
    pub operation: usize,
    /// Index of the operation after the move; None if the step is not a move between operations.
    pub next: Option<usize>,
    /// Time, s.
    pub time: f64,
}

/// Least time in which the robot completes the operations of a layout, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleTime {
    /// Steps in the order in which they happen.
    pub steps: Vec<CycleStep>,
    /// Whether the robot returns to the first operation, so that the total is the time of a cycle.
    pub is_cycle: bool,
    /// Whether an acceleration is assumed, so that the times are estimates.
    pub is_assumed: bool,
}

impl CycleTime {
    /// Returns the sum of all times, s.
    pub fn total(&self) -> f64 {
        self.steps.iter().map(|step| step.time).sum()
    }
}

/// Motion whose time is computed: postures of the operations, and the checked moves between them.
#[derive(Clone, Copy)]
pub struct MotionSequence<'a> {
    pub cell: &'a Cell,
    pub chain: &'a Chain,
    /// Motion rules of the cell; None if the cell has no such rules.
    pub guard: Option<&'a Guard>,
    /// Postures at the spots, in the order in which the robot visits the spots.
    pub stops: &'a [OperationPosture],
    /// Moves from each stop to the next, and in a cycle also from the last stop to the first. The list is
    /// empty if the cell does not require checked moves.
    pub transfers: &'a [Transfer],
}

impl MotionSequence<'_> {
    /// Computes the least time of the motion under the speed and acceleration limits of the joints.
    ///
    /// Every straight-line motion of the TCP begins and ends at rest. Every straight move in joint
    /// coordinates also begins and ends at rest. The robot must stop at these points, because the direction
    /// of the motion changes abruptly. Without checked moves, the robot moves directly from the end of each
    /// retract to the next approach.
    ///
    /// Returns None if the arm cannot follow an approach or a retract.
    pub fn time(&self, bounds: &RateBounds) -> Option<CycleTime> {
        let Self { cell, chain, stops, transfers, .. } = *self;
        let mut steps = Vec::with_capacity(4 * stops.len());
        let is_cycle = transfers.len() == stops.len() && stops.len() > 1;
        // Joint vectors at the spots. They include the whole revolutions that joints have made on the way to
        // a spot.
        let mut joints: Vec<JointVector> = Vec::with_capacity(stops.len());
        for (k, stop) in stops.iter().enumerate() {
            let arrival = match (k.checked_sub(1), joints.last()) {
                (Some(before), Some(here)) => transfers
                    .get(before)
                    .map_or_else(|| nearest_turns(chain, here, &stop.joints), |transfer| transfer.arrival),
                _ => stop.joints,
            };
            joints.push(arrival);
        }
        for (k, stop) in stops.iter().enumerate() {
            let operation = stop.operation;
            let mut add = |phase, next, time: f64| steps.push(CycleStep { phase, operation, next, time });
            let (approach, retract) = self.lengths(operation);
            let speed = cell.operations[operation].line_speed.unwrap_or(f64::INFINITY);
            if approach > 0.0 {
                let mut line = self.back(&joints[k], stop, approach)?;
                line.reverse();
                add(CyclePhase::Approach, None, line_time(chain, &line, bounds, speed));
            }
            add(CyclePhase::Dwell, None, cell.operations[operation].dwell);
            if retract > 0.0 {
                let line = self.back(&joints[k], stop, retract)?;
                add(CyclePhase::Retract, None, line_time(chain, &line, bounds, speed));
            }
            if let Some(transfer) = transfers.get(k) {
                let time = path_of_legs_time(chain, &transfer.path, &transfer.corners, bounds);
                add(CyclePhase::Transfer, Some(transfer.to), time);
            } else if let Some(next) = stops.get(k + 1) {
                let start = *self.back(&joints[k], stop, retract)?.last()?;
                let end = *self.back(&joints[k + 1], next, self.lengths(next.operation).0)?.last()?;
                let time = straight_move_time(&start, &end, bounds);
                add(CyclePhase::DirectMove, Some(next.operation), time);
            }
        }
        Some(CycleTime { steps, is_cycle, is_assumed: bounds.is_assumed })
    }

    fn lengths(&self, operation: usize) -> (f64, f64) {
        self.guard.map_or((0.0, 0.0), |guard| guard.approach_and_retract(operation))
    }

    /// Returns the joint vectors of the line back from a spot along the tool axis; None if the arm cannot
    /// follow the line.
    ///
    /// The joint vector `joints` may contain whole revolutions from earlier moves. Such a revolution may
    /// leave a joint too little range for the line. The line then begins at the posture of the stop itself,
    /// which was checked. Whole revolutions do not change the time of the line.
    fn back(&self, joints: &JointVector, stop: &OperationPosture, length: f64) -> Option<Vec<JointVector>> {
        match self.guard {
            Some(guard) => guard.back(joints, length).or_else(|_| guard.back(&stop.joints, length)).ok(),
            None => Some(vec![*joints]),
        }
    }
}
