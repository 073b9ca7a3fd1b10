//! Self-collision: the pairs of robot solids that are checked, and the pairs that may touch.

use super::contact::SolidRef;
use super::robot_solids::RobotSolid;
use crate::cell::{Cell, JointVector, MAX_JOINTS};
use crate::low_discrepancy::RobertsSequence;
use crate::robot::Chain;

/// Number of sampled postures.
///
/// If two solids touch in all sampled postures, the program assumes that they overlap in the model of the
/// robot.
const SAMPLES: usize = 400;

/// Reason why a contact of two solids of the robot is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Allowed {
    /// The two solids belong to one rigid body.
    SameLink,
    /// The two solids belong to links that share a joint; such solids usually overlap in robot files.
    Neighbours,
    /// The robot file allows the contact.
    Given,
    /// The solids touch in every sampled posture, so they probably overlap in the model of the robot.
    AlwaysTouch,
}

impl Allowed {
    /// Returns the reason in words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::SameLink => "same link",
            Self::Neighbours => "links that share a joint",
            Self::Given => "allowed in the robot file",
            Self::AlwaysTouch => "touch in every sampled posture",
        }
    }
}

/// Two solids of the robot. The solids of tool and held parts count as solids of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SelfCollisionPair {
    pub a: SolidRef,
    pub b: SolidRef,
    /// Reason why a contact of the two solids is allowed; None if a contact is a collision.
    pub allowed: Option<Allowed>,
}

/// Returns every pair of robot solids that the robot can carry at the same time. The robot carries a held
/// part only during its operation.
///
/// If self-collision is not checked, only pairs with the pedestal are returned.
pub(super) fn find(cell: &Cell, links: &[RobotSolid]) -> Vec<SelfCollisionPair> {
    let is_checked = |a: &RobotSolid, b: &RobotSolid| {
        cell.robot.self_collision.checked || [a.id, b.id].contains(&SolidRef::Pedestal)
    };
    let meet = |a: &RobotSolid, b: &RobotSolid| {
        is_checked(a, b) && (a.operation.is_none() || b.operation.is_none() || a.operation == b.operation)
    };
    let all = (0..links.len()).flat_map(|j| (0..j).map(move |i| (i, j)));
    let mut pairs: Vec<_> = all
        .filter(|&(i, j)| meet(&links[i], &links[j]))
        .map(|(i, j)| (i, j, by_rule(cell, &links[i], &links[j])))
        .collect();
    let chain = Chain::new(&cell.robot);
    let mut always: Vec<bool> = pairs.iter().map(|p| p.2.is_none()).collect();
    for sample in 0..SAMPLES {
        if !always.contains(&true) {
            break;
        }
        let frames = chain.frames(&chain.posture(&posture(cell, sample))).links;
        for ((i, j, _), always) in pairs.iter().zip(&mut always).filter(|(_, always)| **always) {
            let (a, b) = (&links[*i], &links[*j]);
            *always = a.touches(a.carrier(&frames), b, b.carrier(&frames));
        }
    }
    for (pair, _) in pairs.iter_mut().zip(always).filter(|(_, always)| *always) {
        pair.2 = Some(Allowed::AlwaysTouch);
    }
    pairs
        .into_iter()
        .map(|(i, j, allowed)| SelfCollisionPair { a: links[i].id, b: links[j].id, allowed })
        .collect()
}

fn by_rule(cell: &Cell, a: &RobotSolid, b: &RobotSolid) -> Option<Allowed> {
    let given = |&(x, y): &(usize, usize)| {
        let pair = (SolidRef::Robot(x), SolidRef::Robot(y));
        pair == (a.id, b.id) || pair == (b.id, a.id)
    };
    match a.frame.abs_diff(b.frame) {
        0 => Some(Allowed::SameLink),
        1 => Some(Allowed::Neighbours),
        _ => cell.robot.self_collision.allowed.iter().any(given).then_some(Allowed::Given),
    }
}

/// Returns posture `k` of a sample within the joint limits. The posture is point `k + 1` of the
/// low-discrepancy sequence [`RobertsSequence`].
fn posture(cell: &Cell, k: usize) -> JointVector {
    let joints = &cell.robot.joints;
    let sequence = RobertsSequence::new(joints.len());
    let mut q = [0.0; MAX_JOINTS];
    for (i, joint) in joints.iter().enumerate() {
        let share = sequence.coordinate(k + 1, i);
        q[i] = joint.limits.0 + share * (joint.limits.1 - joint.limits.0);
    }
    q
}
