//! Upper bound of the value of an operation while the arm follows its target through a target box.
//!
//! To first order, the error is a sum of effects. An effect is the size of an error source times the
//! displacement that a unit of this source causes. Let f be such an effect as a function of the position in
//! the target box, and h_t the half width along axis t. Linear interpolation between the corners deviates
//! from f by at most the sum of `h_t^2 / 2 max |d2f/dt2|` over all axes t. Second derivatives of an effect
//! are products of unit axes and one lever arm, so the lever arms bound them.
//!
//! The size of a signed sample, the linear worst case, the RMS and the mean are convex functions of the
//! effects. So the value in the box is at most the largest value at the corners plus a second term. This term
//! is the same function, evaluated for the deviations of the effects from their linear interpolation.
//!
//! A nonlinear worst case is at most the linear worst case plus the largest products of two and more errors.
//! Let A be the sum of all rotations and D the sum of all displacements. Products of order k are at most
//! `D A^(k-1) / (k-1)!`, so all products together are at most `D (e^A - 1)`.
//!
//! A percentile of a normally distributed error is not convex. But such a percentile grows with the
//! covariance S (T. W. Anderson, "The integral of a symmetric unimodal function over a symmetric convex set",
//! Proc. Amer. Math. Soc. 6, 1955). If `S <= (1 + e) S_0` holds for every position, the percentile is at most
//! `sqrt(1 + e)` times the percentile at S_0.

use super::joint_enclosure::JointEnclosure;
use super::target_box::{BoxAxis, TargetBox};
use crate::cell::{
    Cell, Frame, JointKind, JointVector, MAX_JOINTS, Model, Parameter, Quantity, Reading, Registration,
};
use crate::kinematic_error::{ScrewMotion, Screws, motions};
use crate::reading::{ErrorEvaluator, EvaluatorScratch, WorkContext};
use crate::robot::{Chain, Frames, Posture};
use nalgebra::{Matrix3, Matrix6};

/// Two weights count as equal if their relative difference is at most this value.
const ROUNDING: f64 = 1e-12;

/// Reason why the value of an operation has no upper bound over its target box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoValueBound {
    /// A registration removes part of the error. This part also depends on other postures.
    Registered,
    /// The error is measured relative to another operation, which picks the held part.
    Relative,
    /// The sense (error component of the operation) includes rotations.
    Rotation,
    /// The sense is given in tool axes, and does not have the same weight in all directions.
    ToolAxes,
    /// The value is a share of failures.
    Share,
    /// A parameter is not normally distributed, and the quantity is a percentile.
    NotNormal,
    /// The sense has more than three rows, and the value is a worst case or a percentile. For more than three
    /// rows, the computed worst case is an estimate, not a bound.
    ManyRows,
    /// Elastic errors change with the posture.
    Elastic,
    /// The errors have mean values that are not 0.
    Mean,
}

impl NoValueBound {
    /// Returns the reason in words, as a clause about the operation.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Registered => "a registration removes part of its error",
            Self::Relative => "the error is measured relative to the operation that picks the part",
            Self::Rotation => "the sense has rotations",
            Self::ToolAxes => "the sense is given in the axes of the tool",
            Self::Share => "the value is a share of failures",
            Self::NotNormal => "not all parameters are normally distributed",
            Self::ManyRows => "the sense has more than three components",
            Self::Elastic => "the elastic errors change with the posture",
            Self::Mean => "the errors vary about measured means",
        }
    }
}

/// Upper bounds of the value of one operation, prepared once per cell.
#[derive(Debug, Clone)]
pub struct ValueBound {
    /// Small motions that the error sources cause in the chain or at the equipment.
    motions: Vec<SourceMotion>,
    /// Largest factor by which the rows of the sense enlarge a displacement.
    gain: f64,
    /// Whether the value stays the same if the error rotates about the vertical relative to the axes of the
    /// sense.
    is_isotropic: bool,
    /// Sum of the translational errors, m, and sum of the rotational errors, rad. Both sums are 0 for the
    /// linear model and for the statistical reading.
    totals: (f64, f64),
    /// Distance from the TCP to the point whose error the sense measures, m.
    point: f64,
    /// Whether the value is a nonlinear worst case. The bound is then the linear worst case plus the largest
    /// products of two and more errors.
    has_products: bool,
}

/// Small motion that errors cause at one place in the chain or at the equipment.
///
/// Usually, one error source causes the motion. In the signed reading with a nonlinear or second-order model,
/// the motions in the chain combine all robot errors. In that case, `source` equals `link`.
#[derive(Debug, Clone, Copy)]
struct SourceMotion {
    source: usize,
    /// Number of joints that precede the motion; None for a motion of the equipment.
    link: Option<usize>,
    turns: bool,
    /// Size of the motion, rad or m. The reading decides from which errors the size follows: signed values,
    /// tolerances or standard deviations.
    size: f64,
}

/// Posture of an operation with its target box and its joint enclosure.
pub struct BoxedPosture<'a> {
    pub context: &'a WorkContext,
    pub posture: &'a Posture,
    pub frames: &'a Frames,
    pub target: &'a TargetBox,
    pub joints: &'a JointEnclosure,
}

impl ValueBound {
    /// Prepares the bounds of an operation.
    ///
    /// # Errors
    /// Returns the reason if no bound is known.
    pub fn new(
        cell: &Cell,
        operation: usize,
        evaluator: &ErrorEvaluator,
        chain: &Chain,
    ) -> Result<Self, NoValueBound> {
        let sense = &evaluator.sense;
        if sense.rows().iter().any(|row| row.turns) {
            return Err(NoValueBound::Rotation);
        }
        if cell.registration != Registration::None {
            return Err(NoValueBound::Registered);
        }
        if cell.operations[operation].relative_to.is_some() {
            return Err(NoValueBound::Relative);
        }
        let percentile = matches!(evaluator.quantity, Quantity::P95 | Quantity::P99);
        let list = &evaluator.sources.list;
        if list.iter().any(|source| source.parameter.is_elastic()) {
            return Err(NoValueBound::Elastic);
        }
        if evaluator.reading != Reading::Signed && evaluator.has_mean() {
            return Err(NoValueBound::Mean);
        }
        match evaluator.reading {
            Reading::Statistical if evaluator.quantity == Quantity::Yield => return Err(NoValueBound::Share),
            Reading::Statistical if percentile && evaluator.sources.has_bounded() => {
                return Err(NoValueBound::NotNormal);
            }
            Reading::WorstCase if sense.rows().len() > 3 => return Err(NoValueBound::ManyRows),
            Reading::Statistical if percentile && sense.rows().len() > 3 => {
                return Err(NoValueBound::ManyRows);
            }
            _ => {}
        }
        let frames = chain.frames(&chain.zero_posture());
        let size = |source: usize| match evaluator.reading {
            Reading::Signed => list[source].signed.abs(),
            Reading::WorstCase => list[source].plus_minus,
            Reading::Statistical => list[source].deviation,
        };
        let mut all = Vec::new();
        let is_sample = evaluator.reading == Reading::Signed && evaluator.model != Model::Linear;
        if is_sample {
            all.extend(motions_of_sample(evaluator, chain, &frames));
        }
        for (source, given) in list.iter().enumerate() {
            if let Parameter::Equipment(_, c) = given.parameter {
                all.push(SourceMotion { source, link: None, turns: c >= 3, size: size(source) });
            }
            if is_sample {
                continue;
            }
            let in_chain = motions(chain, &frames, given.parameter, source).into_iter();
            all.extend(in_chain.map(|ScrewMotion { link, turns, factor, .. }| SourceMotion {
                source,
                link: Some(link),
                turns,
                size: size(source) * factor.abs(),
            }));
        }
        let total = |turns: bool| -> f64 { all.iter().filter(|m| m.turns == turns).map(|m| m.size).sum() };
        let gram =
            sense.rows().iter().map(|row| row.direction * row.direction.transpose()).sum::<Matrix3<f64>>();
        let is_isotropic = turns_with_z(&gram);
        let is_round = is_isotropic && (gram[(0, 0)] - gram[(2, 2)]).abs() <= ROUNDING * gram.trace();
        if sense.frame == Frame::Tool && !is_round {
            return Err(NoValueBound::ToolAxes);
        }
        let is_linear = evaluator.model == Model::Linear || evaluator.reading == Reading::Statistical;
        Ok(Self {
            gain: gram.symmetric_eigenvalues().max().max(0.0).sqrt(),
            is_isotropic,
            totals: if is_linear { (0.0, 0.0) } else { (total(false), total(true)) },
            point: sense.point.norm(),
            has_products: evaluator.reading == Reading::WorstCase && evaluator.model != Model::Linear,
            motions: all,
        })
    }

    /// Returns an upper bound of the value of the operation over the target box of a posture, m.
    pub fn most(
        &self,
        evaluator: &ErrorEvaluator,
        chain: &Chain,
        boxed: &BoxedPosture<'_>,
        memory: &mut EvaluatorScratch,
    ) -> f64 {
        let levers = self.levers(chain, boxed);
        let rest = self.rest(evaluator, chain, boxed, &levers);
        let percentile = matches!(evaluator.quantity, Quantity::P95 | Quantity::P99);
        if evaluator.reading == Reading::Statistical && percentile {
            return self.percentile(evaluator, chain, boxed, (rest, levers[0]), memory);
        }
        let mut most: f64 = 0.0;
        corners(chain, boxed, |frames| {
            most = most.max(match self.has_products {
                true => evaluator.linear_worst(boxed.context, frames, memory),
                false => evaluator.value(boxed.context, frames, memory),
            });
        });
        let (slid, turned) = self.totals;
        let products = if self.has_products { turned.exp_m1() * (turned * levers[0] + slid) } else { 0.0 };
        let mean = if evaluator.reading == Reading::Statistical { self.mean(boxed, levers[0]) } else { 0.0 };
        most + self.gain * (rest + products + mean)
    }

    /// Returns an upper bound of a percentile, m. `rest` is the result of [`Self::rest`], and `lever` is
    /// the longest lever arm, both in m.
    fn percentile(
        &self,
        evaluator: &ErrorEvaluator,
        chain: &Chain,
        boxed: &BoxedPosture<'_>,
        (rest, lever): (f64, f64),
        memory: &mut EvaluatorScratch,
    ) -> f64 {
        let value = evaluator.value(boxed.context, boxed.frames, memory);
        let (drawn, rows, mean) = evaluator.covariance(boxed.context, boxed.frames, memory);
        let trace = drawn.trace();
        if trace <= 0.0 {
            // Without an error at the nominal posture, no factor can bound the error elsewhere.
            return if rest > 0.0 { f64::INFINITY } else { 0.0 };
        }
        let Some(whitening) = inverse_root(&drawn, rows) else { return f64::INFINITY };
        let mut growth: f64 = 1.0;
        corners(chain, boxed, |frames| {
            let there = evaluator.covariance_alone(boxed.context, frames, memory);
            let seen = whitening * there * whitening.transpose();
            growth = growth.max(seen.symmetric_eigenvalues().max());
        });
        // Let A be the interpolated effects, and R their deviation. The largest singular value of W (A + R)
        // is at most the sum of the largest singular values of W A and W R.
        let spread = growth.sqrt() + whitening.norm() * self.gain * rest;
        spread * value + mean + self.gain * self.mean(boxed, lever)
    }

    /// Returns an upper bound of the change of the mean error over the box, m.
    ///
    /// The mean error is a sum of second-order terms. Each term is a product of two sizes, unit axes and a
    /// lever arm.
    fn mean(&self, boxed: &BoxedPosture<'_>, lever: f64) -> f64 {
        let total: f64 = self.motions.iter().map(|m| m.size).sum();
        let turned: f64 = boxed.joints.half.iter().sum();
        total * total * lever.max(1.0) * turned
    }

    /// Returns, for each link, an upper bound of the distance from its frame to the point whose error is
    /// assessed, m.
    fn levers(&self, chain: &Chain, boxed: &BoxedPosture<'_>) -> [f64; MAX_JOINTS + 1] {
        let frames = boxed.frames;
        let n = chain.axes();
        let mut levers = [0.0; MAX_JOINTS + 1];
        levers[n] =
            (frames.tcp.translation - frames.links[n].translation).norm() + self.point + self.totals.0;
        for j in (0..n).rev() {
            let length = (frames.links[j + 1].translation - frames.links[j].translation).norm();
            let slides = chain.links[j].kind == JointKind::Prismatic;
            levers[j] = levers[j + 1] + length + if slides { boxed.joints.half[j] } else { 0.0 };
        }
        levers
    }

    /// Returns an upper bound, m, of the total deviation of the effects. A deviation is the difference
    /// between an effect and its linear interpolation between the corners. In the statistical reading, the
    /// bound holds for the RMS of the total deviation.
    fn rest(
        &self,
        evaluator: &ErrorEvaluator,
        chain: &Chain,
        boxed: &BoxedPosture<'_>,
        levers: &[f64; MAX_JOINTS + 1],
    ) -> f64 {
        let JointEnclosure { first, bend, .. } = boxed.joints;
        let turned = boxed.target.yaw + boxed.target.heading.min(1.0);
        let moved = boxed.target.position.norm();
        let n = chain.axes();
        let deviation = |motion: &SourceMotion| {
            let Some(link) = motion.link else {
                // The frame of the equipment rotates with the equipment, and the lever arm changes a little.
                return turned + if motion.turns { moved } else { 0.0 };
            };
            // Bound of the length of every derivative of the effect in which `last` is the joint nearest to
            // the tool.
            let length = |last: usize| match (motion.turns, last < link) {
                (true, true) => levers[link],
                (false, true) => 1.0,
                (true, false) if chain.links[last].kind == JointKind::Revolute => levers[last],
                (true, false) => 1.0,
                (false, false) => 0.0,
            };
            let mut sum = 0.0;
            for steps in first.iter().take(BoxAxis::COUNT) {
                // Pairs of joints of which joint j is the last.
                let mut before = 0.0;
                for (j, step) in steps[..n].iter().enumerate() {
                    let with: f64 = before + step.abs();
                    sum += length(j) * (with * with - before * before) / 2.0;
                    before = with;
                }
            }
            sum += (0..n).map(|j| length(j) * bend[j]).sum::<f64>();
            let rotated =
                if self.is_isotropic { 0.0 } else { turned * if motion.turns { levers[link] } else { 1.0 } };
            sum + rotated
        };
        let add_up = evaluator.reading != Reading::Statistical || !evaluator.sources.factors.is_empty();
        let (mut sum, mut squares, mut of_source) = (0.0, 0.0, (usize::MAX, 0.0));
        for motion in &self.motions {
            let by = motion.size * deviation(motion);
            sum += by;
            of_source = (motion.source, if motion.source == of_source.0 { of_source.1 + by } else { by });
            squares += 2.0 * of_source.1 * by - by * by;
        }
        // Independent effects add up as squares. Correlated effects, and the effects of a sample or a corner,
        // may add up without cancelling. Nonlinear terms multiply an effect by at most the total of the
        // rotations.
        if add_up { sum * (1.0 + self.totals.1) } else { squares.sqrt() }
    }
}

/// Returns the motions by which the chain with the signed sample of errors differs from the nominal chain.
fn motions_of_sample(evaluator: &ErrorEvaluator, chain: &Chain, frames: &Frames) -> Vec<SourceMotion> {
    let nominal = Screws::nominal(chain, frames, &evaluator.sense.point);
    let errors = evaluator.sources.perturbation(chain, &evaluator.sources.signed());
    let (turns, shifts) = nominal.motions_to(&nominal.perturbed(frames, &errors));
    let at = |(link, size): (usize, &f64), turns| SourceMotion {
        source: link,
        link: Some(link),
        turns,
        size: *size,
    };
    let links = chain.axes() + 1;
    let turns = turns[..links].iter().enumerate().map(|motion| at(motion, true));
    turns.chain(shifts[..links].iter().enumerate().map(|motion| at(motion, false))).collect()
}

/// Calls `visit` with the frames at every corner of the target box, to first order in the joint coordinates.
fn corners(chain: &Chain, boxed: &BoxedPosture<'_>, mut visit: impl FnMut(&Frames)) {
    let moves = |axis: &usize| boxed.joints.first[*axis].iter().any(|v| *v != 0.0);
    let mut axes = [0; BoxAxis::COUNT];
    let mut count = 0;
    for axis in (0..BoxAxis::COUNT).filter(moves) {
        axes[count] = axis;
        count += 1;
    }
    let mut frames = Frames::default();
    for pattern in 0..1usize << count {
        let mut by: JointVector = [0.0; MAX_JOINTS];
        for (bit, axis) in axes[..count].iter().enumerate() {
            let sign = if pattern >> bit & 1 == 1 { 1.0 } else { -1.0 };
            by.iter_mut().zip(&boxed.joints.first[*axis]).for_each(|(by, step)| *by += sign * step);
        }
        chain.place(&chain.displaced(boxed.posture, &by), &mut frames);
        visit(&frames);
    }
}

/// Returns a matrix W with `W S W^T = 1` for a covariance S of `rows` components; None if S is not positive
/// definite.
fn inverse_root(covariance: &Matrix6<f64>, rows: usize) -> Option<Matrix6<f64>> {
    let mut regular = Matrix6::identity();
    regular.view_mut((0, 0), (rows, rows)).copy_from(&covariance.view((0, 0), (rows, rows)));
    regular.cholesky()?.l().try_inverse()
}

/// Returns whether rotations about z leave the norm with the Gram matrix `gram` unchanged.
fn turns_with_z(gram: &Matrix3<f64>) -> bool {
    let off =
        (gram[(0, 0)] - gram[(1, 1)]).abs() + gram[(0, 1)].abs() + gram[(0, 2)].abs() + gram[(1, 2)].abs();
    off <= ROUNDING * gram.trace()
}
