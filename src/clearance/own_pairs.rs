//! Which solids of the robot are checked against each other, and which may touch.

use super::hit::SolidRef;
use super::links::Link;
use crate::cell::{Cell, JointVector, MAX_JOINTS};
use crate::robot::Chain;

/// Postures in which a pair must touch, every one of them, to count as drawn overlapping.
const SAMPLES: usize = 400;

/// Why a pair of solids of the robot may touch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Allowed {
    /// One body.
    SameLink,
    /// They share a joint, where drawings overlap.
    Neighbours,
    /// The robot file says so.
    Given,
    /// They do in every sampled posture: they are drawn overlapping.
    AlwaysTouch,
}

impl Allowed {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::SameLink => "same link",
            Self::Neighbours => "neighbours",
            Self::Given => "allowed in the file",
            Self::AlwaysTouch => "touch in every posture",
        }
    }
}

/// Two solids of the robot, tool and held parts included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OwnPair {
    pub a: SolidRef,
    pub b: SolidRef,
    /// None: a contact is a collision.
    pub allowed: Option<Allowed>,
}

/// Every pair that can meet; none if the robot is not checked against itself.
pub(super) fn find(cell: &Cell, links: &[Link]) -> Vec<OwnPair> {
    if !cell.robot.self_collision.checked {
        return Vec::new();
    }
    let meet = |a: &Link, b: &Link| a.operation.is_none() || a.operation == b.operation;
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
    pairs.into_iter().map(|(i, j, allowed)| OwnPair { a: links[i].id, b: links[j].id, allowed }).collect()
}

fn by_rule(cell: &Cell, a: &Link, b: &Link) -> Option<Allowed> {
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

/// The sample k of the box of joint limits: the additive sequence of M. Roberts, "The unreasonable
/// effectiveness of quasirandom sequences" (2018), whose steps are powers of the root of
/// x^(d + 1) = x + 1.
fn posture(cell: &Cell, k: usize) -> JointVector {
    let joints = &cell.robot.joints;
    let d = joints.len() as f64;
    let mut root: f64 = 1.5;
    for _ in 0..60 {
        root = (1.0 + root).powf(1.0 / (d + 1.0));
    }
    let mut q = [0.0; MAX_JOINTS];
    for (i, joint) in joints.iter().enumerate() {
        let share = (0.5 + (k as f64 + 1.0) * root.powi(-(i as i32 + 1))).fract();
        q[i] = joint.limits.0 + share * (joint.limits.1 - joint.limits.0);
    }
    q
}
