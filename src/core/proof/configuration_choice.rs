//! Choice of the flags that define the configurations of a value field.
//!
//! The best flags tell apart as many pairs of postures at the same node as possible. Nodes over the whole
//! region of the operation are sampled, and the flags are chosen one after the other.

use super::region::OperationRegion;
use crate::cell::JointKind;
use crate::error_map::{ConfigurationFlag, ConfigurationFlags, MAX_FLAGS};
use crate::layout::Workcell;
use crate::robot::Posture;
use nalgebra::Vector3;

/// Number of sampled heights, and number of sampled radii.
const SAMPLES: usize = 8;
/// Largest number of postures that are compared at one node.
const MAX_POSTURES: usize = 64;
/// A further flag must tell apart at least this share of all pairs of postures.
const LEAST_SHARE: f64 = 0.02;

/// Sampled postures from which the flags are chosen.
pub(super) struct ConfigurationChoice {
    /// Possible flags: signs of sine and cosine of every revolute joint between the first and the last joint.
    flags: Vec<ConfigurationFlag>,
    /// One list per sampled node. It holds one entry per posture: the values of `flags` as a bit mask.
    nodes: Vec<Vec<u32>>,
}

impl ConfigurationChoice {
    /// Samples the postures of an operation over its region. `radius` is the range of the radius of a node,
    /// m.
    pub fn new(workcell: &Workcell, region: &OperationRegion, radius: (f64, f64)) -> Self {
        let inverse = workcell.inverse();
        let links = inverse.chain().links.iter().enumerate();
        let middle = links.skip(1).take(inverse.chain().axes().saturating_sub(2));
        let revolute = middle.filter(|(_, link)| link.kind == JointKind::Revolute);
        let flags: Vec<ConfigurationFlag> = revolute
            .flat_map(|(joint, _)| [true, false].map(|is_sine| ConfigurationFlag { joint, is_sine }))
            .collect();
        let attitude = &workcell.cell.operations[region.operation].attitude;
        let attitudes = inverse.tool_attitudes(attitude, 0.0);
        let mut nodes = Vec::new();
        if !inverse.has_spin_families(&attitudes) {
            return Self { flags: Vec::new(), nodes };
        }
        let at = |(low, high): (f64, f64), k: usize| low + (high - low) * (k as f64 + 0.5) / SAMPLES as f64;
        let mut scratch = inverse.scratch();
        for k in 0..SAMPLES * SAMPLES {
            let target = Vector3::new(at(radius, k / SAMPLES), 0.0, at(region.height, k % SAMPLES));
            let mut postures = Vec::new();
            inverse.visit_families(&target, &attitudes, &mut scratch, |_, posture| {
                if postures.len() < MAX_POSTURES {
                    postures.push(signs(&flags, posture));
                }
            });
            nodes.push(postures);
        }
        Self { flags, nodes }
    }

    /// Returns the best flags.
    pub fn flags(&self) -> ConfigurationFlags {
        let (mut chosen, mut mask, mut told) = (Vec::new(), 0, 0);
        let least = (LEAST_SHARE * self.pairs_told_apart(u32::MAX) as f64).ceil() as usize;
        while chosen.len() < MAX_FLAGS {
            let gains = (0..self.flags.len()).map(|k| (self.pairs_told_apart(mask | 1 << k), k));
            // Among equally good flags, the first is chosen.
            let Some((count, k)) = gains.max_by_key(|&(count, k)| (count, std::cmp::Reverse(k))) else {
                break;
            };
            if count < told + least.max(1) {
                break;
            }
            chosen.push(self.flags[k]);
            (mask, told) = (mask | 1 << k, count);
        }
        ConfigurationFlags::new(chosen)
    }

    /// Returns the number of pairs of postures at the same node that the flags in `mask` tell apart.
    fn pairs_told_apart(&self, mask: u32) -> usize {
        let pairs = |node: &Vec<u32>| {
            let differ = |(k, a): (usize, &u32)| node[..k].iter().filter(|b| (*a ^ **b) & mask != 0).count();
            node.iter().enumerate().map(differ).sum::<usize>()
        };
        self.nodes.iter().map(pairs).sum()
    }
}

/// Returns the values of flags at a posture, as a bit mask.
fn signs(flags: &[ConfigurationFlag], posture: &Posture) -> u32 {
    flags.iter().enumerate().map(|(bit, flag)| u32::from(flag.is_set(posture)) << bit).sum()
}
