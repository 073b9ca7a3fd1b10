//! Guess of the link that carries the tool, and of the working direction of the tool.

use super::dh;
use super::model::*;
use super::motion::Motion;
use super::tree::Tree;
use crate::pose::Pose;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Least number of moving joints before a branching into the fingers of a gripper.
const ARM: usize = 3;

/// Largest number of moving joints of a finger.
const FINGER: usize = 3;

/// Least number of moving joints before a gripper jaw: a short prismatic joint that is the last moving joint.
const ARM_BEFORE_JAW: usize = 5;

/// Largest travel of a jaw, m.
const JAW: f64 = 0.15;

/// Words in the names of links that carry a tool, the preferred word first.
const TOOL_WORDS: [&str; 9] =
    ["tcp", "tool0", "tool_frame", "tool", "end_effector", "eef", "ee_link", "flange", "mounting_plate"];

/// Words in the names of links that are fixed to the flange but do not carry the tool.
const ASIDE_WORDS: [&str; 4] = ["camera", "sensor", "optical", "cable"];

/// Length, m, below which two points count as one.
const SAME_POINT: f64 = 1e-3;

/// Largest distance between a unit vector and a coordinate axis at which the vector counts as that axis.
const ON_AXIS: f64 = 1e-3;

/// Returns the guessed tip link below `base`. The link is the end of the longest chain of moving joints, or
/// is fixed to that end. The chain ends before the fingers or the jaw of a gripper.
pub fn guess(urdf: &Urdf, tree: &Tree<'_>, base: usize) -> usize {
    let end = end_of_arm(urdf, tree, base);
    let fixed = fixed_below(urdf, tree, end);
    let has = |link: usize, word: &str| urdf.links[link].name.name.to_ascii_lowercase().contains(word);
    let named = TOOL_WORDS.iter().find_map(|word| fixed.iter().copied().find(|&link| has(link, word)));
    if let Some(link) = named {
        return link;
    }
    // A palm is also an end: only moving fingers are below it.
    let is_end = |link: usize| tree.below[link].iter().all(|&j| urdf.joints[j].kind != UrdfJointKind::Fixed);
    let leaves: Vec<_> = fixed.iter().copied().filter(|&link| is_end(link)).collect();
    if let [leaf] = leaves[..] {
        return leaf;
    }
    let is_mount = |link: usize| !ASIDE_WORDS.iter().any(|word| has(link, word));
    let length = |link: usize| distance(urdf, tree, end, link);
    let far =
        leaves.into_iter().filter(|&link| is_mount(link)).max_by(|&a, &b| length(a).total_cmp(&length(b)));
    far.filter(|&link| length(link) > SAME_POINT).unwrap_or(end)
}

/// Returns the distance, m, of the link `link` from the link `from`. `from` is above `link` in the tree, and
/// the two links are fixed to each other.
fn distance(urdf: &Urdf, tree: &Tree<'_>, from: usize, link: usize) -> f64 {
    let (mut pose, mut at) = (Pose::identity(), link);
    while at != from {
        let Some((joint, parent)) = tree.joint_above(at) else { break };
        pose = urdf.joints[joint].origin * pose;
        at = parent;
    }
    pose.translation.norm()
}

/// Returns the link after the last moving joint of the arm.
fn end_of_arm(urdf: &Urdf, tree: &Tree<'_>, base: usize) -> usize {
    let most = moving_below(urdf, tree, base);
    let moves = |j: usize| usize::from(urdf.joints[j].kind != UrdfJointKind::Fixed);
    let child = |j: usize| tree.child(j);
    let through = |j: usize| moves(j) + child(j).map_or(0, |link| most[link]);
    let (mut at, mut end, mut moved) = (base, base, 0);
    loop {
        let branches: Vec<usize> = tree.below[at].iter().copied().filter(|&j| through(j) > 0).collect();
        // If several branches are equally long, the first one in the file is chosen.
        let Some(next) = branches.iter().copied().rev().max_by_key(|&j| through(j)) else { return end };
        let is_hand = branches.len() > 1 && through(next) <= FINGER && are_fingers(urdf, tree, &branches);
        let is_jaw = moved >= ARM_BEFORE_JAW && through(next) == 1 && is_short_slide(&urdf.joints[next]);
        if moved >= ARM && is_hand || is_jaw {
            return end;
        }
        let Some(link) = child(next) else { return end };
        moved += moves(next);
        at = link;
        if moves(next) > 0 {
            end = link;
        }
    }
}

fn is_short_slide(joint: &UrdfJoint) -> bool {
    let travel = joint.limits.map_or(f64::INFINITY, |(lower, upper, _)| upper - lower);
    joint.kind == UrdfJointKind::Prismatic && travel <= JAW
}

/// Returns whether branches of the tree are fingers of a gripper. Branches are fingers if several of them are
/// driven, or if one of their joints mimics another one. A driven branch has a moving joint that mimics no
/// joint.
///
/// The passive bars of a parallelogram are no fingers: they mimic joints that come before the branching.
fn are_fingers(urdf: &Urdf, tree: &Tree<'_>, branches: &[usize]) -> bool {
    let inside: Vec<Vec<&UrdfJoint>> = branches.iter().map(|&j| moving_of_branch(urdf, tree, j)).collect();
    let is_driven = |joints: &&Vec<&UrdfJoint>| joints.iter().any(|joint| joint.mimic.is_none());
    let names: HashSet<&str> = inside.iter().flatten().map(|joint| &*joint.name.name).collect();
    let mut mimics = inside.iter().flatten().filter_map(|joint| joint.mimic.as_ref());
    inside.iter().filter(is_driven).count() > 1 || mimics.any(|mimic| names.contains(&*mimic.joint.name))
}

/// Returns the moving joints of the branch that begins with joint `j`.
fn moving_of_branch<'u>(urdf: &'u Urdf, tree: &Tree<'_>, j: usize) -> Vec<&'u UrdfJoint> {
    let (mut open, mut found) = (vec![j], Vec::new());
    while let Some(j) = open.pop() {
        found.extend(Some(&urdf.joints[j]).filter(|joint| joint.kind != UrdfJointKind::Fixed));
        open.extend(tree.child(j).into_iter().flat_map(|link| &tree.below[link]));
    }
    found
}

/// Returns, for every link, the greatest number of moving joints on a chain below it.
fn moving_below(urdf: &Urdf, tree: &Tree<'_>, base: usize) -> Vec<usize> {
    let (mut open, mut order) = (vec![base], Vec::new());
    while let Some(link) = open.pop() {
        order.push(link);
        open.extend(tree.below[link].iter().filter_map(|&j| tree.child(j)));
    }
    let mut most = vec![0; urdf.links.len()];
    for link in order.into_iter().rev() {
        let below = tree.below[link].iter().filter_map(|&j| {
            Some(most[tree.child(j)?] + usize::from(urdf.joints[j].kind != UrdfJointKind::Fixed))
        });
        most[link] = below.max().unwrap_or(0);
    }
    most
}

/// Returns a link, then all links below this link in the tree that are fixed to it. Every parent link
/// precedes its child links.
fn fixed_below(urdf: &Urdf, tree: &Tree<'_>, link: usize) -> Vec<usize> {
    let mut all = vec![link];
    let mut next = 0;
    while let Some(&link) = all.get(next) {
        let fixed = tree.below[link].iter().filter(|&&j| urdf.joints[j].kind == UrdfJointKind::Fixed);
        all.extend(fixed.filter_map(|&j| tree.child(j)));
        next += 1;
    }
    all
}

/// Returns the guessed working direction of the tool in the frame of the tip link, a unit vector.
///
/// The direction lies along the axis of the last joint and points away from the arm. If the tip lies beside
/// that axis, the direction points from the joint to the tip.
pub fn working_direction(motion: &Motion) -> Vector3<f64> {
    let poses = dh::joint_poses(&motion.axes);
    let (Some(last), Some(axis)) = (poses.last(), dh::directions(&motion.axes).last().copied()) else {
        return Vector3::z();
    };
    let tip = *last * motion.flange;
    let arm = tip.translation - last.translation;
    let is_beside = arm.norm() > SAME_POINT && arm.dot(&axis).abs() < 0.5 * arm.norm();
    let along = |point: &Pose| (tip.translation - point.translation).dot(&axis);
    let ahead = poses.iter().rev().map(along).find(|along| along.abs() > SAME_POINT);
    let direction = match ahead {
        _ if is_beside => arm.normalize(),
        Some(ahead) if ahead < 0.0 => -axis,
        _ => axis,
    };
    let direction = tip.rotation.transpose() * direction;
    let nearest = direction.map(f64::round);
    if (direction - nearest).norm() < ON_AXIS { nearest + Vector3::zeros() } else { direction }
}
