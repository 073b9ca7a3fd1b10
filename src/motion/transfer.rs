//! The way from one operation to the next.

use super::guard::{Guard, Hindrance};
use super::line::straight;
use crate::cell::{JointKind, JointVector};
use crate::clearance::{Load, Placed, Scene};
use crate::robot::Chain;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// A way from one posture to another, in the order in which they are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// One move in joint coordinates.
    Direct,
    /// The TCP straight up at both ends, one move between.
    Lift,
    /// Through a posture of the cell, by its number.
    Via(usize),
    /// Lifted at both ends, and through a posture between.
    LiftVia(usize),
}

/// An operation at its spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stance {
    pub operation: usize,
    /// rad, m.
    pub joints: JointVector,
}

/// A free way from where one operation has retracted to where the next begins its approach.
#[derive(Debug, Clone, PartialEq)]
pub struct Transfer {
    /// Indices of the operations.
    pub from: usize,
    pub to: usize,
    pub way: Way,
    /// Joint vectors with straight moves between them; rad, m.
    pub path: Vec<JointVector>,
    /// For the time it takes: the sum over the moves of how far the joint goes that goes farthest, as
    /// when all joints of a point-to-point move start and stop together with equal top speeds. rad; a
    /// slide by the arm's reach counts as 1.
    pub travel: f64,
    /// The next operation's joint vector at its spot, in the turns of the joints that are nearest.
    pub arrival: JointVector,
}

/// No way is free: what stands in each that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocked {
    pub from: usize,
    pub to: usize,
    pub tries: Vec<(Way, Hindrance)>,
}

impl Guard {
    /// Whether the moves between operations are checked.
    pub fn asks_transfers(&self) -> bool {
        self.transfer.is_some()
    }

    /// The ways between consecutive operations at their spots, back to the first in a cycle; none if the
    /// cell does not ask for them.
    ///
    /// # Errors
    /// The first that is blocked.
    pub fn transfers(
        &self,
        scene: &Scene,
        placed: &Placed,
        stances: &[Stance],
    ) -> Result<Vec<Transfer>, Blocked> {
        let mut found: Vec<Transfer> = Vec::new();
        let (Some(rules), Some(first)) = (&self.transfer, stances.first()) else { return Ok(found) };
        let mut here = *first;
        for stance in &stances[1..] {
            let next = Stance { joints: nearest_turns(&self.chain, &here.joints, &stance.joints), ..*stance };
            found.push(self.transfer(scene, placed, &here, &next)?);
            here = next;
        }
        if rules.cycle && stances.len() > 1 {
            // Back in the very turns of the start: the cycle must not wind up.
            found.push(self.transfer(scene, placed, &here, first)?);
        }
        Ok(found)
    }

    /// The first free way between two operations, checked with what either of them holds.
    ///
    /// # Errors
    /// What stands in each way.
    pub fn transfer(
        &self,
        scene: &Scene,
        placed: &Placed,
        from: &Stance,
        to: &Stance,
    ) -> Result<Transfer, Blocked> {
        let mut tries = Vec::new();
        let blocked = |tries| Blocked { from: from.operation, to: to.operation, tries };
        let (away, towards) = (self.lengths[from.operation].1, self.lengths[to.operation].0);
        let ends = (self.end_of(from, away), self.end_of(to, towards));
        let (start, end) = match ends {
            (Ok(start), Ok(end)) => (start, end),
            (Err(why), _) | (_, Err(why)) => return Err(blocked(vec![(Way::Direct, why)])),
        };
        // Without a retract a part still rests where it was put.
        let load = Load::between((from.operation, away == 0.0), (to.operation, towards == 0.0));
        for way in self.ways() {
            let path = match self.path(way, &start, &end) {
                Ok(path) => path,
                Err(why) => {
                    tries.push((way, why));
                    continue;
                }
            };
            match self.first_hit(scene, placed, &path, load) {
                Some(hit) => tries.push((way, Hindrance::Hit(hit))),
                None => {
                    let (travel, arrival) = (travel(&self.chain, &path, self.reach), to.joints);
                    let (from, to) = (from.operation, to.operation);
                    return Ok(Transfer { from, to, way, path, travel, arrival });
                }
            }
        }
        Err(blocked(tries))
    }

    /// Where the straight way from a spot ends.
    fn end_of(&self, stance: &Stance, length: f64) -> Result<JointVector, Hindrance> {
        let knots = self.back(&stance.joints, length).map_err(Hindrance::Stopped)?;
        Ok(knots.last().copied().unwrap_or(stance.joints))
    }

    fn ways(&self) -> Vec<Way> {
        let (lift, via) = self.transfer.as_ref().map_or((0.0, 0), |r| (r.lift, r.via.len()));
        let lifted = lift > 0.0;
        let mut ways = vec![Way::Direct];
        ways.extend(lifted.then_some(Way::Lift));
        ways.extend((0..via).map(Way::Via));
        ways.extend((0..via).filter(|_| lifted).map(Way::LiftVia));
        ways
    }

    fn path(&self, way: Way, start: &JointVector, end: &JointVector) -> Result<Vec<JointVector>, Hindrance> {
        let Some(rules) = &self.transfer else { return Ok(vec![*start, *end]) };
        let up = Vector3::z() * rules.lift;
        let raised = |q: &JointVector| straight(&self.chain, q, &up, self.reach).map_err(Hindrance::Stopped);
        let (mut path, last) = match way {
            Way::Direct | Way::Via(_) => (vec![*start], vec![*end]),
            Way::Lift | Way::LiftVia(_) => {
                let mut down = raised(end)?;
                down.reverse();
                (raised(start)?, down)
            }
        };
        if let Way::Via(k) | Way::LiftVia(k) = way {
            path.push(rules.via[k]);
        }
        path.extend(last);
        Ok(path)
    }
}

/// See [`Transfer::travel`]; `reach`: a length of the size of the arm, m.
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

/// The travel of direct moves from posture to posture, see [`Transfer::travel`], every joint in the turn
/// nearest to where it comes from.
pub fn direct_travel(chain: &Chain, stops: &[JointVector], reach: f64) -> f64 {
    let mut path: Vec<JointVector> = Vec::with_capacity(stops.len());
    for stop in stops {
        path.push(path.last().map_or(*stop, |here| nearest_turns(chain, here, stop)));
    }
    travel(chain, &path, reach)
}

/// The same posture with every joint in the turn nearest to where it comes from, inside its limits.
fn nearest_turns(chain: &Chain, from: &JointVector, to: &JointVector) -> JointVector {
    let mut near = *to;
    for j in 0..chain.axes() {
        let link = &chain.links[j];
        // What it turns by whole factors comes back to the same angle.
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
