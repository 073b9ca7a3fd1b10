//! Transfers: collision-free paths from one operation to the next.

use super::guard::{Guard, Hindrance, LineEnds};
use super::straight_line::straight;
use crate::cell::{JointKind, JointVector};
use crate::clearance::{Load, PlacedSolids, Scene};
use crate::robot::Chain;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Route from one posture to another. The variants are in the order in which they are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransferRoute {
    /// One move in joint coordinates.
    Direct,
    /// Straight lifts of the TCP at both ends, and one move between them.
    Lift,
    /// Moves through a via posture, given by its index in the cell.
    Via(usize),
    /// Straight lifts of the TCP at both ends, and moves through a via posture between them.
    LiftVia(usize),
}

/// Posture of an operation at its spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperationPosture {
    pub operation: usize,
    /// Actuator coordinates, rad or m.
    pub joints: JointVector,
}

/// Collision-free path from the end of one operation's retract to the start of the next operation's approach.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Index of the operation that precedes the transfer.
    pub from: usize,
    /// Index of the operation that follows the transfer.
    pub to: usize,
    pub way: TransferRoute,
    /// Joint vectors (rad or m) of the path; straight moves in joint coordinates lie between them.
    pub path: Vec<JointVector>,
    /// Indices of the joint vectors at which the arm stops, including both ends of the path.
    ///
    /// Between two successive stops lies one straight move in joint coordinates, or one straight line of
    /// the TCP.
    pub corners: Vec<usize>,
    /// Measure of the transfer time, rad: the largest joint travel of each move, summed over all moves.
    ///
    /// The measure is proportional to the time if all joints start and stop together with equal top speeds.
    /// The travel of a prismatic joint is divided by the reach of the arm and treated as rad.
    pub travel: f64,
    /// Joint vector of the next operation at its spot.
    ///
    /// Joint angles may be changed by whole turns, so that they are nearest to the angles at the previous
    /// operation. At the end of a cycle, the joint angles are the angles at which the cycle started.
    pub arrival: JointVector,
}

/// Failure of a transfer, with the hindrance on every route that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocked {
    pub from: usize,
    pub to: usize,
    pub tries: Vec<(TransferRoute, Hindrance)>,
}

/// Check of a path from one operation to the next. The check must refuse every path with a collision.
///
/// The arguments are the indices of the two operations, the joint vectors of the path, and the held parts.
/// The check returns the hindrance if the path cannot be used.
pub type PathCheck<'a> = &'a dyn Fn([usize; 2], &[JointVector], Load) -> Result<(), Hindrance>;

/// Returns the ends of the straight lines at a posture; None if they were not computed before.
pub type KnownLines<'a> = &'a dyn Fn(&OperationPosture) -> Option<LineEnds>;

impl Guard {
    /// Returns whether transfers between operations are checked.
    pub fn asks_transfers(&self) -> bool {
        self.transfer.is_some()
    }

    /// Returns the transfers between consecutive operations. In a cycle, the transfer from the last
    /// operation to the first is added.
    ///
    /// The list is empty if the cell has no transfer rules. `known` returns the ends of the lines at a
    /// posture if they were computed before.
    ///
    /// # Errors
    /// Returns the first transfer that is blocked.
    pub fn transfers(
        &self,
        scene: &Scene,
        placed: &PlacedSolids,
        stances: &[OperationPosture],
        known: KnownLines<'_>,
        check: Option<PathCheck<'_>>,
    ) -> Result<Vec<Transfer>, Blocked> {
        let mut found: Vec<Transfer> = Vec::new();
        let (Some(rules), Some(first)) = (&self.transfer, stances.first()) else { return Ok(found) };
        let mut here = *first;
        for context in &stances[1..] {
            let next = OperationPosture {
                joints: nearest_turns(&self.chain, &here.joints, &context.joints),
                ..*context
            };
            found.push(self.transfer(scene, placed, [&here, &next], known, check)?);
            here = next;
        }
        if rules.cycle && stances.len() > 1 {
            // The last transfer ends at the joint angles of the start, so that repeated cycles add no whole
            // turns.
            found.push(self.transfer(scene, placed, [&here, first], known, check)?);
        }
        Ok(found)
    }

    /// Returns the first collision-free transfer between two operations.
    ///
    /// The collision check includes the held parts of both operations. If `check` is given, the transfer uses
    /// a path that `check` accepts. Otherwise, the transfer uses a path without collisions.
    ///
    /// # Errors
    /// Returns the hindrances on all routes if no route can be used.
    pub fn transfer(
        &self,
        scene: &Scene,
        placed: &PlacedSolids,
        [from, to]: [&OperationPosture; 2],
        known: KnownLines<'_>,
        check: Option<PathCheck<'_>>,
    ) -> Result<Transfer, Blocked> {
        let mut tries = Vec::new();
        let blocked = |tries| Blocked { from: from.operation, to: to.operation, tries };
        let (away, towards) = (self.lengths[from.operation].1, self.lengths[to.operation].0);
        let retracted = known(from).and_then(|ends| ends.retract);
        let start = retracted.map_or_else(|| self.end_of(from, away), Ok);
        let approached = known(to).and_then(|ends| ends.approach);
        let ends = (start, approached.map_or_else(|| self.end_of(to, towards), Ok));
        let (start, end) = match ends {
            (Ok(start), Ok(end)) => (start, end),
            (Err(why), _) | (_, Err(why)) => return Err(blocked(vec![(TransferRoute::Direct, why)])),
        };
        // Without a retract or an approach, a part rests on the surface at that end of the transfer.
        let load = Load::between((from.operation, away == 0.0), (to.operation, towards == 0.0));
        for way in self.ways() {
            let (path, corners) = match self.path(way, &start, &end) {
                Ok(found) => found,
                Err(why) => {
                    tries.push((way, why));
                    continue;
                }
            };
            let first_hit = || self.first_hit(scene, placed, &path, load).map(Hindrance::Hit);
            let hindrance = match check {
                None => first_hit(),
                Some(check) => match check([from.operation, to.operation], &path, load) {
                    Ok(()) => None,
                    Err(why) => Some(first_hit().unwrap_or(why)),
                },
            };
            match hindrance {
                Some(hindrance) => tries.push((way, hindrance)),
                None => {
                    let (travel, arrival) = (travel(&self.chain, &path, self.reach), to.joints);
                    let (from, to) = (from.operation, to.operation);
                    return Ok(Transfer { from, to, way, path, corners, travel, arrival });
                }
            }
        }
        Err(blocked(tries))
    }

    /// Returns the posture at the end of the straight line back from a spot.
    fn end_of(&self, context: &OperationPosture, length: f64) -> Result<JointVector, Hindrance> {
        let knots = self.back(&context.joints, length).map_err(Hindrance::Stopped)?;
        Ok(knots.last().copied().unwrap_or(context.joints))
    }

    fn ways(&self) -> Vec<TransferRoute> {
        let (lift, via) = self.transfer.as_ref().map_or((0.0, 0), |r| (r.lift, r.via.len()));
        let lifted = lift > 0.0;
        let mut ways = vec![TransferRoute::Direct];
        ways.extend(lifted.then_some(TransferRoute::Lift));
        ways.extend((0..via).map(TransferRoute::Via));
        ways.extend((0..via).filter(|_| lifted).map(TransferRoute::LiftVia));
        ways
    }

    /// Returns the joint vectors of a route, and the indices of the joint vectors at which the arm stops.
    fn path(
        &self,
        way: TransferRoute,
        start: &JointVector,
        end: &JointVector,
    ) -> Result<(Vec<JointVector>, Vec<usize>), Hindrance> {
        let Some(rules) = &self.transfer else { return Ok((vec![*start, *end], vec![0, 1])) };
        let up = Vector3::z() * rules.lift;
        let raised = |q: &JointVector| straight(&self.chain, q, &up, self.reach).map_err(Hindrance::Stopped);
        let (mut path, last) = match way {
            TransferRoute::Direct | TransferRoute::Via(_) => (vec![*start], vec![*end]),
            TransferRoute::Lift | TransferRoute::LiftVia(_) => {
                let mut down = raised(end)?;
                down.reverse();
                (raised(start)?, down)
            }
        };
        let mut corners = vec![0, path.len() - 1];
        if let TransferRoute::Via(k) | TransferRoute::LiftVia(k) = way {
            corners.push(path.len());
            path.push(rules.via[k]);
        }
        corners.extend([path.len(), path.len() + last.len() - 1]);
        path.extend(last);
        // Without a lift, the line at an end of the path has no length, and its two corners coincide.
        corners.dedup();
        Ok((path, corners))
    }
}

/// Returns the [`Transfer::travel`] of a path. `reach` is a characteristic length of the arm, m.
fn travel(chain: &Chain, path: &[JointVector], reach: f64) -> f64 {
    let farthest = |ends: &[JointVector]| {
        let each =
            chain.links.iter().zip(ends[0].iter().zip(&ends[1])).map(|(link, (a, b))| match link.kind {
                JointKind::Revolute => (b - a).abs(),
                JointKind::Prismatic => (b - a).abs() / reach,
            });
        each.fold(0.0, f64::max)
    };
    path.windows(2).map(farthest).sum()
}

/// Returns the [`Transfer::travel`] of direct moves from posture to posture.
///
/// Before that, joint angles are changed by whole turns, so that they are nearest to the angles of the
/// previous posture.
pub fn direct_travel(chain: &Chain, stops: &[JointVector], reach: f64) -> f64 {
    let mut path: Vec<JointVector> = Vec::with_capacity(stops.len());
    for stop in stops {
        path.push(path.last().map_or(*stop, |here| nearest_turns(chain, here, stop)));
    }
    travel(chain, &path, reach)
}

/// Returns the joint vector `to` with angles changed by whole turns. The new angles are the nearest to `from`
/// within the joint limits.
pub fn nearest_turns(chain: &Chain, from: &JointVector, to: &JointVector) -> JointVector {
    let mut near = *to;
    for j in 0..chain.axes() {
        let link = &chain.links[j];
        // After a whole turn of joint j, a revolute joint i returns to its position if its coupling factor is
        // an integer. A prismatic joint i must not move at all.
        let comes_back = |i: usize| match chain.links[i].kind {
            JointKind::Revolute => chain.coupling[i][j].fract() == 0.0,
            JointKind::Prismatic => chain.coupling[i][j] == 0.0,
        };
        if link.kind == JointKind::Prismatic || !(j + 1..chain.axes()).all(comes_back) {
            continue;
        }
        let turned = to[j] + TAU * ((from[j] - to[j]) / TAU).round();
        if (link.limits.0..=link.limits.1).contains(&turned) {
            near[j] = turned;
        }
    }
    near
}
