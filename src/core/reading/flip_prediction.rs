//! Prediction of the error at neighbouring corners of the tolerance box, with an upper bound of the
//! prediction error.
//!
//! Reversing the signs of some sources changes the sizes `a_i` of small motions by `d_i`. In the second-order
//! model ([`crate::kinematic_error`]), the displacement of the point that a sense measures changes by
//!
//! ```text
//! sum_i d_i G_i + 1/2 sum_i d_i^2 w_i x g_i + sum_(i<j) d_i d_j w_i x g_j
//! G_i = g_i + (sum_(j<i) a_j w_j) x g_i + w_i x (sum_(j>i) a_j g_j) + a_i w_i x g_i
//! ```
//!
//! Here `g_i` is the effect of one unit of motion i on the position of the point. The vector `w_i` is the
//! axis of the motion if the motion is a rotation, and otherwise 0. The rotation vector changes likewise. For
//! the rotation vector, `w_j / 2` replaces `g_j` in the cross products of two different motions. There is no
//! cross product of a motion with itself. One pass from the base to the tool and back gives every `G_i`. The
//! prediction leaves out products of three and more errors. Let A be the largest sum of the sizes of all
//! rotations, and B the same sum over motion i and the motions before it. Let D be the largest sum of the
//! sizes of the displacements by motion i and the motions after it. A product of k errors is the effect `g_l`
//! of one motion, multiplied by the axes of k - 1 rotations that do not come after it. So the products of k
//! errors change by at most `|d_i| (|g_i| B^(k-1) / (k-1)! + |w_i| D A^(k-2) / (k-2)!)`. The sum over all k
//! from 3 is `|d_i| (|g_i| (exp(B) - 1 - B) + |w_i| D (exp(A) - 1))`. For a measured point at a distance r
//! from the TCP, this bound grows by `2 |d_i| |w_i| A^2 r`. The growth bounds the effect of the truncated
//! rotation vector on the point.

use super::corner::ToleranceCorner;
use super::error_sources::{ErrorSources, MAX_SOURCES};
use super::sense_rows::SenseRows;
use crate::cell::Parameter;
use crate::kinematic_error::{Expansion, MotionTerm};
use crate::pose::{Displacement, Pose};
use nalgebra::{Vector3, Vector6};

/// Largest sum of all rotations, rad, for which products of four and more errors are smaller than products of
/// three errors.
const MAX_ROTATION: f64 = 0.25;
/// Share of the largest sum of all displacements that counts as a rounding error.
const ROUNDING: f64 = 1e-14;

/// Part of the cell to which a small motion belongs.
#[derive(Debug, Clone, Copy)]
enum Owner {
    /// Motion of the robot, by its index in [`Expansion::term`].
    Robot(usize),
    /// Component of the frame error of the equipment, by its index.
    Equipment(usize),
}

/// Small motion of the TCP or the equipment at the latest posture and the latest corner.
#[derive(Debug, Clone, Copy)]
struct CornerMotion {
    owner: Owner,
    /// Effect of one unit of the motion on the position of the measured point.
    g: Vector3<f64>,
    /// Axis of a rotation; 0 for a translation.
    w: Vector3<f64>,
    /// Size at the corner, m or rad.
    size: f64,
    /// Largest sum of the rotations by this motion and the motions before it, rad.
    turned_before: f64,
    /// Largest sum of the displacements by this motion and the motions after it, m.
    moved_after: f64,
    /// Derivative `G_i` of the position of the measured point with respect to the size of the motion.
    moves: Vector3<f64>,
    /// Derivative of the rotation vector with respect to the size of the motion.
    turns: Vector3<f64>,
}

impl CornerMotion {
    fn of(owner: Owner) -> Self {
        let none = Vector3::zeros();
        let (size, turned_before, moved_after) = (0.0, 0.0, 0.0);
        Self { owner, g: none, w: none, size, turned_before, moved_after, moves: none, turns: none }
    }
}

/// Change of the error along the rows of a sense if the sign of one source is reversed.
#[derive(Debug, Clone, Copy)]
pub struct PredictedFlip {
    /// Predicted change of the error along the rows, m or rad.
    pub change: Vector6<f64>,
    /// Upper bound of the size of the terms that `change` neglects, m or rad.
    pub margin: f64,
    /// Sum of the absolute rotations that the flip causes, rad.
    pub rotation: f64,
    /// Sum of the absolute displacements that the flip causes, m.
    pub displacement: f64,
}

impl PredictedFlip {
    const NONE: Self = Self {
        change: Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        margin: 0.0,
        rotation: 0.0,
        displacement: 0.0,
    };
}

/// Upper bounds of the sum of all products of two and more errors, measured along the rows of a sense, m or
/// rad. The bounds hold at every corner of the tolerance box.
#[derive(Debug, Clone, Copy, Default)]
pub struct ProductBounds {
    pub all: f64,
    /// Bound of the products of three, five, seven and so on errors.
    pub odd: f64,
}

/// Predictor of how a flip of the sign of one source changes the error at a corner of the tolerance box.
#[derive(Debug, Clone)]
pub struct FlipPrediction {
    /// Motions in the order from base to tool.
    motions: Vec<CornerMotion>,
    /// Motions of each source: index in `motions`, and size per unit of the source.
    sources: Vec<Vec<(usize, f64)>>,
    /// Change of each source if its sign at the latest corner is reversed, m or rad.
    changes: [f64; MAX_SOURCES],
    /// Parts of the flips that are equal at all corners. The field `change` holds the terms that are
    /// quadratic in the change of the source.
    fixed: [PredictedFlip; MAX_SOURCES],
    /// Bit set of the sources whose fixed parts are computed for the latest posture.
    fixed_known: u128,
    flips: [PredictedFlip; MAX_SOURCES],
    /// Bit set of the sources whose flips are computed for the latest corner.
    computed: u128,
    /// The latest corner; None if the posture is new.
    corner: Option<ToleranceCorner>,
    /// Largest component sizes along the rows, per unit of displacement and of rotation
    /// ([`SenseRows::weights`]).
    weights: [f64; 2],
    /// Largest sum of all rotations at any corner, rad.
    rotations: f64,
    /// Largest sum of all displacements at any corner, m.
    displacements: f64,
    /// Largest sum of the displacements that products of two errors cause at any corner, m.
    pairs: f64,
    /// Distance from the TCP to the measured point, m.
    arm: f64,
}

impl FlipPrediction {
    /// Returns a predictor for the sources of an operation on `equipment`; `expansion` must have the same
    /// sources.
    pub fn new(sources: &ErrorSources, expansion: &Expansion, equipment: usize) -> Self {
        let of_robot = |k: usize| sources.robot_index(k).into_iter().flat_map(|p| expansion.motions(p));
        let of_work = |k: usize| match sources.list[k].parameter {
            Parameter::Equipment(e, component) if e == equipment => Some(component),
            _ => None,
        };
        let n = sources.list.len();
        let mut robot: Vec<usize> = (0..n).flat_map(of_robot).map(|(index, _)| index).collect();
        robot.sort_unstable_by_key(|&index| expansion.place(index));
        robot.dedup();
        // The motions of the equipment come first, with reversed signs: rotations about x, y and z, then
        // translations.
        let work = [3, 4, 5, 0, 1, 2].into_iter().filter(|c| (0..n).any(|k| of_work(k) == Some(*c)));
        let work: Vec<usize> = work.collect();
        let robot_place = |index: usize| work.len() + robot.iter().position(|&i| i == index).unwrap_or(0);
        let work_place = |c: usize| work.iter().position(|&i| i == c).unwrap_or(0);
        let motions_of = |k: usize| match of_work(k) {
            Some(component) => vec![(work_place(component), -1.0)],
            None => of_robot(k).map(|(index, size)| (robot_place(index), size)).collect(),
        };
        let owners = work.iter().map(|&c| Owner::Equipment(c)).chain(robot.iter().map(|&i| Owner::Robot(i)));
        Self {
            motions: owners.map(CornerMotion::of).collect(),
            sources: (0..n).map(motions_of).collect(),
            changes: [0.0; MAX_SOURCES],
            fixed: [PredictedFlip::NONE; MAX_SOURCES],
            fixed_known: 0,
            flips: [PredictedFlip::NONE; MAX_SOURCES],
            computed: 0,
            corner: None,
            weights: [0.0; 2],
            rotations: 0.0,
            displacements: 0.0,
            pairs: 0.0,
            arm: 0.0,
        }
    }

    /// Sets the posture, the sense and the work frame. Returns false if the errors are too large for a bound.
    pub fn set_posture(
        &mut self,
        sources: &ErrorSources,
        expansion: &Expansion,
        measure: &SenseRows,
        work: &Pose,
        tcp: &Vector3<f64>,
    ) -> bool {
        for (k, own) in self.sources.iter_mut().enumerate() {
            if let Some(parameter) = sources.robot_index(k) {
                own.iter_mut().zip(expansion.motions(parameter)).for_each(|(own, (_, size))| own.1 = size);
            }
        }
        let arm = measure.arm();
        for motion in &mut self.motions {
            let MotionTerm { g, w } = match motion.owner {
                Owner::Robot(index) => *expansion.term(index),
                Owner::Equipment(component) => {
                    let axis = work.rotation.column(component % 3).into_owned();
                    MotionTerm::along(axis, &(tcp - work.translation), component >= 3)
                }
            };
            (motion.g, motion.w, motion.size) = (g + w.cross(arm), w, 0.0);
        }
        // For now, every motion has its largest size.
        for (own, source) in self.sources.iter().zip(&sources.list) {
            let largest = source.mean.abs() + source.plus_minus;
            own.iter().for_each(|&(i, unit)| self.motions[i].size += unit.abs() * largest);
        }
        // A rotation also displaces the effects of all motions nearer to the tool.
        (self.rotations, self.displacements, self.pairs) = (0.0, 0.0, 0.0);
        for motion in self.motions.iter_mut().rev() {
            let (turned, moved) = (motion.size * motion.w.norm(), motion.size * motion.g.norm());
            self.pairs += turned * (moved / 2.0 + self.displacements);
            // For now, this is the sum over the motions after this one.
            motion.turned_before = self.rotations;
            self.rotations += turned;
            self.displacements += moved;
            motion.moved_after = self.displacements;
        }
        let all = self.rotations;
        self.motions.iter_mut().for_each(|motion| motion.turned_before = all - motion.turned_before);
        (self.weights, self.arm, self.corner) = (measure.weights(), arm.norm(), None);
        self.fixed_known = 0;
        self.rotations <= MAX_ROTATION
    }

    /// Returns upper bounds of the products of errors. Call [`Self::set_posture`] first.
    ///
    /// Products of order k are at most `D A^(k-1) / (k-1)!`. For products of two errors, the sum over all
    /// pairs of motions is a sharper bound.
    pub fn products(&self) -> ProductBounds {
        let [by_position, by_rotation] = [self.weights[0], self.weights[1] * self.rotations];
        let (all, odd) = (self.rotations.exp_m1(), self.rotations.cosh() - 1.0);
        let of_position = self.pairs + self.displacements * (all - self.rotations);
        ProductBounds {
            all: by_position * of_position + by_rotation * all,
            odd: by_position * self.displacements * odd + by_rotation * odd,
        }
    }

    /// Sets the corner. Call [`Self::set_posture`] first.
    pub fn set_corner(&mut self, sources: &ErrorSources, corner: ToleranceCorner) {
        if self.corner == Some(corner) {
            return;
        }
        self.corner = Some(corner);
        // The change of the rotation vector matters only for rows that measure the rotation.
        let has_rotation = self.weights[1] > 0.0;
        self.motions.iter_mut().for_each(|motion| motion.size = 0.0);
        for (k, (own, source)) in self.sources.iter().zip(&sources.list).enumerate() {
            let value = source.at(corner.sign(k));
            own.iter().for_each(|&(i, unit)| self.motions[i].size += unit * value);
        }
        let mut turned = Vector3::zeros();
        for motion in &mut self.motions {
            let own = motion.w * motion.size;
            motion.moves = motion.g + (turned + own).cross(&motion.g);
            if has_rotation {
                motion.turns = motion.w + turned.cross(&motion.w) / 2.0;
            }
            turned += own;
        }
        let (mut moved, mut turned) = (Vector3::zeros(), Vector3::zeros());
        for motion in self.motions.iter_mut().rev() {
            motion.moves += motion.w.cross(&moved);
            moved += motion.g * motion.size;
            if has_rotation {
                motion.turns += motion.w.cross(&turned) / 2.0;
                turned += motion.w * motion.size;
            }
        }
        for (k, (change, source)) in self.changes.iter_mut().zip(&sources.list).enumerate() {
            *change = -2.0 * source.plus_minus * corner.sign(k);
        }
        self.computed = 0;
    }

    /// Returns the part of the prediction for a flip of the sign of source `k` that is equal at all corners.
    fn fixed_part(&self, k: usize, measure: &SenseRows) -> PredictedFlip {
        let (change, growth) = (self.changes[k], self.rotations.exp_m1());
        let mut sum = Displacement::NONE;
        let (mut rotation, mut displacement, mut of_position) = (0.0, 0.0, 0.0);
        let own = &self.sources[k];
        for (at, &(i, unit)) in own.iter().enumerate() {
            let (motion, change_i) = (&self.motions[i], change * unit);
            sum.position += motion.w.cross(&motion.g) * (change_i * change_i / 2.0);
            for &(j, unit) in &own[at + 1..] {
                sum = sum + self.product(i, j) * (change_i * change * unit);
            }
            let (turned, moved) = (change_i.abs() * motion.w.norm(), change_i.abs() * motion.g.norm());
            let before = motion.turned_before;
            // The factor of `moved` is at least exp(before) - 1 - before.
            of_position += moved * before * before / (2.0 - before) + turned * motion.moved_after * growth;
            rotation += turned;
            displacement += moved;
        }
        let of_rotation = 2.0 * rotation * self.rotations * self.rotations;
        let margin = self.weights[0] * (of_position + of_rotation * self.arm) + self.weights[1] * of_rotation;
        PredictedFlip { change: measure.components(&sum), margin, rotation, displacement }
    }

    /// Returns the bit set of the sources that leave the error unchanged at every corner of the latest
    /// posture, except for rounding errors. An example is a rotation of the tool about an axis through the
    /// TCP.
    pub fn idle(&self, sources: &ErrorSources) -> u128 {
        let least = ROUNDING * self.displacements;
        let is_idle = |k: usize| {
            let change = 2.0 * sources.list[k].plus_minus;
            self.sources[k].iter().all(|&(i, unit)| {
                let motion = &self.motions[i];
                let by = motion.g.norm() + motion.w.norm() * (motion.moved_after + self.arm);
                2.0 * (change * unit).abs() * by <= least
            })
        };
        let idle = (0..self.sources.len()).filter(|k| self.weights[1] == 0.0 && is_idle(*k));
        idle.fold(0, |set, k| set | 1 << k)
    }

    /// Returns the prediction for a flip of the sign of source `k`.
    fn flip(&mut self, k: usize, measure: &SenseRows) -> PredictedFlip {
        if self.fixed_known >> k & 1 == 0 {
            self.fixed[k] = self.fixed_part(k, measure);
            self.fixed_known |= 1 << k;
        }
        let mut sum = Displacement::NONE;
        for &(i, unit) in &self.sources[k] {
            let change = self.changes[k] * unit;
            sum.position += self.motions[i].moves * change;
            sum.rotation += self.motions[i].turns * change;
        }
        PredictedFlip { change: self.fixed[k].change + measure.components(&sum), ..self.fixed[k] }
    }

    /// Returns the second derivative of the point's displacement with respect to two motions.
    fn product(&self, i: usize, j: usize) -> Displacement {
        let (near, far) = (&self.motions[i.min(j)], &self.motions[i.max(j)]);
        let rotation = if i == j { Vector3::zeros() } else { near.w.cross(&far.w) / 2.0 };
        Displacement { position: near.w.cross(&far.g), rotation }
    }

    /// Returns the predicted flip of source `k` at the corner of [`Self::set_corner`]; None if there is no
    /// such source. The flip is computed when it is first needed.
    pub fn flip_of(&mut self, k: usize, measure: &SenseRows) -> Option<&PredictedFlip> {
        if k >= self.sources.len() {
            return None;
        }
        if self.computed >> k & 1 == 0 {
            self.flips[k] = self.flip(k, measure);
            self.computed |= 1 << k;
        }
        self.flips.get(k)
    }

    /// Returns the predicted flips of all sources at the corner of [`Self::set_corner`].
    pub fn flips(&mut self, measure: &SenseRows) -> &[PredictedFlip] {
        let count = self.sources.len();
        (0..count).for_each(|k| {
            self.flip_of(k, measure);
        });
        &self.flips[..count]
    }

    /// Returns the result of [`SenseRows::weights`].
    pub fn weights(&self) -> [f64; 2] {
        self.weights
    }

    /// Returns an upper bound of the interaction of a flip with earlier flips.
    ///
    /// The interaction is the change that all flips together cause, minus the sum of the changes that each
    /// flip alone causes. `rotation` (rad) and `displacement` (m) are the sums over the earlier flips.
    pub fn product_bound(&self, (rotation, displacement): (f64, f64), flip: &PredictedFlip) -> f64 {
        let of_position = rotation * flip.displacement + displacement * flip.rotation;
        self.weights[0] * of_position + self.weights[1] * rotation * flip.rotation / 2.0
    }

    /// Returns the interaction of flips of the sources `k` and `l`.
    ///
    /// The interaction is the change that both flips together cause, minus the sum of the changes that each
    /// flip alone causes.
    pub fn product_of(
        &self,
        sources: &ErrorSources,
        corner: ToleranceCorner,
        (k, l): (usize, usize),
        measure: &SenseRows,
    ) -> Vector6<f64> {
        let change = |k: usize| -2.0 * sources.list[k].plus_minus * corner.sign(k);
        let mut sum = Displacement::NONE;
        for &(i, unit_i) in &self.sources[k] {
            for &(j, unit_j) in &self.sources[l] {
                sum = sum + self.product(i, j) * (unit_i * unit_j);
            }
        }
        measure.components(&(sum * (change(k) * change(l))))
    }
}
