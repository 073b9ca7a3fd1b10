//! Maps from the joint columns of a file to actuator coordinates.

use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::Chain;
use crate::units::rad_from_deg;
use std::f64::consts::{FRAC_PI_2, PI};

/// Largest number of couplings of a hypothesis.
const MAX_COUPLINGS: usize = 4;

/// Map from the joint columns of a file to actuator coordinates.
///
/// Joint i has the value `v_i = sign_i column_i + offset_i`. The coordinate of the joint is `v_i` plus the
/// coupled values of earlier joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointMap {
    /// Column of every joint, counted from 0.
    pub columns: [usize; MAX_JOINTS],
    /// Sign of every joint: 1 or -1.
    pub signs: [f64; MAX_JOINTS],
    /// Offset of every revolute joint, rad: a multiple of 90 degrees.
    pub offsets: [f64; MAX_JOINTS],
    /// Couplings: joint, earlier joint, and factor (1 or -1). The coordinate of the joint includes the value
    /// of the earlier joint, multiplied by the factor.
    pub couplings: [Option<(usize, usize, f64)>; MAX_COUPLINGS],
}

const fn in_order() -> [usize; MAX_JOINTS] {
    let mut columns = [0; MAX_JOINTS];
    let mut k = 0;
    while k < MAX_JOINTS {
        columns[k] = k;
        k += 1;
    }
    columns
}

impl JointMap {
    /// Map of the plain reading: each column is the coordinate of its joint.
    pub const PLAIN: Self = Self {
        columns: in_order(),
        signs: [1.0; MAX_JOINTS],
        offsets: [0.0; MAX_JOINTS],
        couplings: [None; MAX_COUPLINGS],
    };

    /// Returns the actuator coordinates, rad or m, for the joint columns of one row, given in `raw`. The flag
    /// `degrees` is true if angles are in degrees. `unit` is the size in m of the file's unit of length. A
    /// passive joint, whose limits are equal, keeps its only coordinate.
    pub fn applied(&self, chain: &Chain, raw: &JointVector, degrees: bool, unit: f64) -> JointVector {
        let mut values = [0.0; MAX_JOINTS];
        for (i, link) in chain.links.iter().enumerate() {
            let column = self.signs[i] * raw[self.columns[i]];
            values[i] = match link.kind {
                JointKind::Revolute if degrees => rad_from_deg(column) + self.offsets[i],
                JointKind::Revolute => column + self.offsets[i],
                JointKind::Prismatic => column * unit,
            };
        }
        let mut joints = values;
        for (joint, earlier, factor) in self.couplings.iter().flatten() {
            joints[*joint] += factor * values[*earlier];
        }
        let passive = chain.links.iter().enumerate().filter(|(_, link)| link.is_passive());
        passive.for_each(|(i, link)| joints[i] = link.limits.0);
        joints
    }

    /// Returns the complexity of the map: a weighted count of its differences from [`Self::PLAIN`].
    pub fn complexity(&self) -> usize {
        let flips = self.signs.iter().filter(|s| **s < 0.0).count();
        let offsets = self.offsets.iter().filter(|o| **o != 0.0).count();
        let moved = self.columns.iter().enumerate().filter(|(k, column)| k != *column).count();
        flips + 2 * offsets + 2 * self.couplings.iter().flatten().count() + moved
    }

    /// Returns the map with other signs: bit i of `bits` flips the sign and the offset of joint i.
    pub fn flipped(mut self, bits: u32) -> Self {
        for (i, sign) in self.signs.iter_mut().enumerate().filter(|(i, _)| bits >> i & 1 == 1) {
            *sign = -*sign;
            self.offsets[i] = -self.offsets[i];
        }
        self
    }

    /// Returns the maps that differ from [`Self::PLAIN`] only by the order of the columns, one for each order
    /// that is tried. Two columns are swapped, all columns are shifted by one, or the order is reversed.
    pub fn orders(axes: usize) -> Vec<Self> {
        let with = |column: &dyn Fn(usize) -> usize| {
            let mut map = Self::PLAIN;
            map.columns.iter_mut().take(axes).enumerate().for_each(|(k, place)| *place = column(k));
            map
        };
        let mut all =
            vec![with(&|k| axes - 1 - k), with(&|k| (k + 1) % axes), with(&|k| (k + axes - 1) % axes)];
        for i in 0..axes {
            let swapped = |j: usize| {
                with(&|k| match k {
                    k if k == i => j,
                    k if k == j => i,
                    k => k,
                })
            };
            all.extend((i + 1..axes).map(swapped));
        }
        all
    }

    /// Returns the maps that differ from [`Self::PLAIN`] only by offsets. In each map, one or two of the
    /// inner revolute joints have an offset of 90, -90 or 180 degrees.
    ///
    /// Offsets of the first and the last joint are equivalent to other poses of base and reflector.
    pub fn turns(chain: &Chain) -> Vec<Self> {
        let inner = 1..chain.axes().saturating_sub(1);
        let inner: Vec<usize> = inner.filter(|&i| chain.links[i].kind == JointKind::Revolute).collect();
        let angles = [FRAC_PI_2, -FRAC_PI_2, PI];
        let turn = |map: &Self, i: usize, angle: f64| {
            let mut map = *map;
            map.offsets[i] = angle;
            map
        };
        let mut all = Vec::new();
        for (k, &i) in inner.iter().enumerate() {
            for angle in angles {
                let one = turn(&Self::PLAIN, i, angle);
                all.push(one);
                for &j in &inner[k + 1..] {
                    all.extend(angles.map(|angle| turn(&one, j, angle)));
                }
            }
        }
        all
    }

    /// Returns the maps that differ from [`Self::PLAIN`] only by couplings, one for each set that is tried.
    ///
    /// Joint 3 may be measured from the horizontal instead of from link 2. Joints 2 and 3 may drive joint 4
    /// of an arm with four or five axes, such as a palletizer. In the wrist of an arm with six or more axes,
    /// joint 4 may drive joints 5 and 6. Joint 5 may drive joint 6 in such a wrist.
    pub fn couplings(axes: usize) -> Vec<Self> {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        if axes >= 3 {
            pairs.push((2, 1));
        }
        match axes {
            4 | 5 => pairs.extend([(3, 1), (3, 2)]),
            6.. => pairs.extend([(4, 3), (5, 3), (5, 4)]),
            _ => {}
        }
        let sets = 3_usize.pow(pairs.len() as u32);
        let set = |code: usize| {
            let mut map = Self::PLAIN;
            for (k, (joint, earlier)) in pairs.iter().enumerate() {
                map.couplings[k] = match code / 3_usize.pow(k as u32) % 3 {
                    0 => None,
                    1 => Some((*joint, *earlier, 1.0)),
                    _ => Some((*joint, *earlier, -1.0)),
                };
            }
            map
        };
        (1..sets).map(set).collect()
    }

    /// Returns the combination of this map and `other`. Column orders and signs of both maps apply. If an
    /// offset of `other` is not 0, it replaces the offset of this map. If `other` has couplings, they replace
    /// all couplings of this map.
    pub fn with(&self, other: &Self) -> Self {
        let mut map = *self;
        for i in 0..MAX_JOINTS {
            map.columns[i] = self.columns[other.columns[i]];
            map.signs[i] *= other.signs[i];
            if other.offsets[i] != 0.0 {
                map.offsets[i] = other.offsets[i];
            }
        }
        if other.couplings.iter().any(Option::is_some) {
            map.couplings = other.couplings;
        }
        map
    }
}
