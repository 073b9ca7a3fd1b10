//! Task of bounding the value of one operation from below. The task holds the chain, the error and the
//! constraints.

use super::WhyNot;
use super::base_rows::{base_rows, grams, turns_with_z};
use super::coordinates::{Coordinates, DIRECTION_ROUNDING, middle};
use super::first_joint::FirstJoint;
use super::last_joint::{LastJoint, ToolAxisRange};
use super::linear_effects::{self, WeightedMotions, effects};
use super::nonlinear_error::ChainDifference;
use super::planar_arm::facing;
use super::refusal::refuse;
use super::region::{ConstrainedQuantity, Constraint, OperationRegion};
use super::self_collision::SelfCollisionCheck;
use super::taylor_model::{ChainGeometry, RigidPieces, Taylor, radius, rates};
use super::value_bound::{EffectSum, ValueSum};
use crate::cell::{JointKind, JointVector, MAX_JOINTS, Model, Reading, Row, Unit};
use crate::kinematic_error::{JointValues, PosedScrews, ScrewMotion, Screws, largest_deflection, motions};
use crate::layout::Workcell;
use crate::pose::Pose;
use crate::reading::{ErrorEvaluator, ErrorSource, EvaluatorScratch, WorkContext, WorkFrame};
use nalgebra::Matrix3;
use std::f64::consts::TAU;

/// Number of angles that are tried for a joint without a coordinate, when the value of a posture is computed.
const WITNESS_ANGLES: usize = 24;

/// Task of bounding the value of one operation from below.
pub(super) struct Task<'a> {
    evaluator: &'a ErrorEvaluator,
    workcell: &'a Workcell,
    situation: WorkContext,
    pub screws: Screws,
    pub coordinates: Coordinates,
    /// Segments of the chain from joint axis to joint axis, and from the last axis to the TCP.
    pub to_tip: RigidPieces,
    /// Segments of the chain from joint axis to joint axis, and from the last axis to the measured point. The
    /// measured point is the point whose error the sense measures.
    to_point: RigidPieces,
    rows: Vec<Row>,
    error: BoundedError,
    /// Upper bound, m, of the amount by which the value computed from the field `error` exceeds the value of
    /// the operation. The value of the operation is computed with the error model of the cell.
    ///
    /// This upper bound is subtracted from the lower bound of the value.
    lost: f64,
    /// Rotations of joints that one unit of each elastic error source causes. The field `factor` of each
    /// rotation is an upper bound of its angle over all postures.
    deflections: Vec<ScrewMotion>,
    pub constraints: Vec<Constraint>,
    /// Errors after the last joint, if this joint needs no coordinate in the boxes.
    last: Option<LastJoint>,
    /// Whether the value depends on the angle of the first joint, although this joint needs no coordinate.
    turned_first: bool,
    /// Whether a constraint can limit the distance of the TCP from the z axis of the base.
    pub limits_radius: bool,
    /// Whether the first joint rotates the arm about the z axis of the base.
    pub starts_at_base_axis: bool,
    /// Whether the bound of the value depends on the coordinate of the first joint.
    pub needs_first_joint: bool,
    pub self_collision: SelfCollisionCheck<'a>,
    /// Number of joints that need a coordinate.
    pub free_joints: usize,
    /// Whether the arm is planar, so that the lean of the tool is constant along a line.
    pub is_planar: bool,
    /// Directions of the tool axis in all postures that satisfy the constraints.
    tool_axis: ToolAxisRange,
}

/// Error whose size is bounded from below.
enum BoundedError {
    /// Nonlinear error of a signed sample: the difference of two chains.
    ChainDifference(Box<ChainDifference>),
    /// Weighted sum of the linear effects of motions in the chain.
    Columns(Vec<ScrewMotion>, EffectSum),
}

impl<'a> Task<'a> {
    /// Prepares the task of bounding the value of an operation over a region.
    ///
    /// # Errors
    /// Returns the reason if no bound is known for this operation, or if the region is empty.
    pub fn new(workcell: &'a Workcell, region: &OperationRegion) -> Result<Self, WhyNot> {
        // In a region without any distance from the base axis, the equipment always overlaps the robot base.
        if region.radius.is_some_and(|(low, high)| low > high) {
            return Err(WhyNot::Infeasible);
        }
        let cell = &workcell.cell;
        let (operation, evaluator) =
            (&cell.operations[region.operation], workcell.evaluator(region.operation));
        let chain = workcell.inverse().chain();
        refuse(cell, region.operation)?;
        if cell.unit() == Unit::Cost {
            return Err(WhyNot::Cost);
        }
        let rows = base_rows(cell, evaluator, region.operation)?;
        let sample = evaluator.reading == Reading::Signed && evaluator.model != Model::Linear;
        let is_corner = evaluator.reading == Reading::WorstCase && evaluator.model != Model::Linear;
        if is_corner && evaluator.has_mean() {
            return Err(WhyNot::Mean);
        }
        if rows.iter().any(|r| r.turns)
            && evaluator.model != Model::Linear
            && evaluator.reading != Reading::Statistical
        {
            return Err(WhyNot::Rotation);
        }
        let frames = chain.frames(&chain.posture(&middle(chain)));
        let screws = Screws::nominal(chain, &frames, &evaluator.sense.point);
        let mut sum = EffectSum::new(evaluator, rows.len())?;
        let sources = evaluator.sources.list.iter().enumerate();
        let mut motions: Vec<ScrewMotion> =
            sources.flat_map(|(k, source)| motions(chain, &frames, source.parameter, k)).collect();
        let free = Coordinates::new(chain, &screws, &[false; MAX_JOINTS]);
        let pieces = RigidPieces::new(&screws, &screws.point, &free);
        let sources = evaluator.sources.list.iter().enumerate();
        let deflection = |(k, source): (usize, &ErrorSource)| {
            largest_deflection(evaluator.chain(), &frames, source.parameter, k)
        };
        let deflections = sources.filter_map(deflection).collect();
        let errors = evaluator.sources.perturbation(chain, &evaluator.sources.signed());
        let errors = errors.rigid();
        let difference =
            sample.then(|| ChainDifference::new(&screws, screws.perturbed(&frames, &errors), &pieces));
        let first_alone = (1..chain.axes()).all(|i| chain.coupling[i][0] == 0.0);
        let first = match (screws.kinds[0], &difference) {
            _ if !first_alone => None,
            (JointKind::Prismatic, _) => {
                let is_level = screws.axes[0].z.abs() < DIRECTION_ROUNDING;
                let is_kept = is_level && motions.iter().all(|m| m.link > 0 || !m.turns);
                is_kept.then(FirstJoint::default)
            }
            _ if screws.axes[0].xy().norm() >= DIRECTION_ROUNDING || !turns_with_z(&rows) => None,
            (JointKind::Revolute, Some(difference)) => {
                difference.keeps_first_axis().then(FirstJoint::default)
            }
            (JointKind::Revolute, None) => FirstJoint::replace(&screws, evaluator, &mut motions, &rows),
        };
        let mut held = [false; MAX_JOINTS];
        held[0] = first.is_some();
        let turned_first = first.as_ref().is_some_and(|first| !first.motions.is_empty());
        if let Some(first) = first {
            sum.add_first_joint(&first);
            motions.extend(first.motions);
        }
        let fixed = workcell.inverse().fixed_elevation();
        let last = LastJoint::new(chain, &screws, evaluator, &motions, &rows);
        held[chain.axes() - 1] |= last.is_some();
        let coordinates = Coordinates::new(chain, &screws, &held);
        let centred =
            screws.kinds[0] == JointKind::Revolute && screws.points[0].xy().norm() < DIRECTION_ROUNDING;
        let site = WorkFrame {
            equipment: operation.equipment,
            work: Pose::identity(),
            world: cell.start().base.from_world(),
            taught: None,
        };
        let facing = facing(&screws, &held);
        let to_tip = RigidPieces::new(&screws, &screws.tip, &coordinates);
        let limits_radius = centred || !held[0];
        let starts_at_base_axis = centred && screws.axes[0].xy().norm() < DIRECTION_ROUNDING;
        let mut task = Self {
            evaluator,
            workcell,
            situation: WorkContext { site, reference: None },
            to_tip,
            to_point: RigidPieces::new(&screws, &screws.point, &coordinates),
            screws,
            coordinates,
            rows,
            error: BoundedError::Columns(motions, sum),
            lost: 0.0,
            deflections,
            constraints: region.constraints(facing),
            last,
            turned_first,
            limits_radius,
            starts_at_base_axis,
            needs_first_joint: !held[0],
            is_planar: facing.is_some(),
            self_collision: SelfCollisionCheck::new(workcell, region.operation, &held),
            free_joints: held[..chain.axes()].iter().filter(|held| !**held).count(),
            tool_axis: ToolAxisRange::of_elevations(region.elevation.or(fixed.map(|e| (e, e)))),
        };
        let reach = task.reach();
        let limits = |c: &Constraint| limits_radius && (c.low > 0.0 || c.high < reach * reach);
        task.constraints.retain(|c| c.of != ConstrainedQuantity::RadiusSquared || limits(c));
        task.lost = task.lost() + task.elastic_part();
        if let (BoundedError::Columns(motions, _), Some(_)) = (&mut task.error, &task.last) {
            motions.retain(|motion| motion.link < chain.axes());
        }
        if let Some(difference) = difference {
            task.error = BoundedError::ChainDifference(Box::new(difference));
        }
        Ok(task)
    }

    /// Returns an upper bound, m, of the amount by which the value computed from the [`BoundedError`] exceeds
    /// the value of the operation.
    ///
    /// The value of the operation is computed with the error model of the cell.
    ///
    /// Let the error at a corner of the tolerance box be L + E + O. Here L is the linear term, and E is the
    /// sum of the terms of even order. O is the sum of the odd terms from third order on. The opposite
    /// corner has the error -L + E - O. The worst case is therefore at least `|L| - |O|`.
    ///
    /// In the second-order model, the error of a signed sample lacks all terms of the nonlinear model from
    /// third order on. Let `a_k` be the angle of motion k, and `b_k` the largest displacement that it
    /// causes. Then `|O|` and the sum of the missing terms are each at most `sum_k b_k (sum_j a_j)^2 / 2`.
    /// The function multiplies this bound by the root sum square of the weights of the sense's components.
    fn lost(&self) -> f64 {
        let sizes: Vec<f64> = match (self.evaluator.reading, self.evaluator.model) {
            (Reading::Signed, Model::SecondOrder) => self.evaluator.sources.signed(),
            (Reading::WorstCase, Model::Nonlinear) => {
                self.evaluator.sources.list.iter().map(|s| s.plus_minus).collect()
            }
            _ => return 0.0,
        };
        let BoundedError::Columns(motions, _) = &self.error else { return 0.0 };
        let size = |m: &ScrewMotion| (m.factor * sizes[m.source]).abs();
        let motions = motions.iter().chain(&self.deflections);
        let (turns, slides): (Vec<&ScrewMotion>, Vec<&ScrewMotion>) = motions.partition(|m| m.turns);
        let (sum, slid): (f64, f64) =
            (turns.iter().map(|m| size(m)).sum(), slides.iter().map(|m| size(m)).sum());
        let moved: f64 = turns.iter().map(|m| size(m) * (self.lever(m) + slid)).sum();
        let rows = self.rows.iter().map(|r| r.direction.norm_squared()).sum::<f64>().sqrt();
        rows * (moved + slid) * sum * sum / 2.0
    }

    /// Returns an upper bound of the distance from the axis of a rotation to the measured point, m.
    fn lever(&self, m: &ScrewMotion) -> f64 {
        let n = self.screws.kinds.len();
        let next = if m.link == n { &self.screws.point } else { &self.screws.points[m.link] };
        (next - m.through).norm() + self.to_point.from(m.link)
    }

    /// Returns an upper bound of the change of the value that the elastic errors of a signed sample cause, m
    /// or rad.
    ///
    /// The lower bound of the value ignores these errors, because their size changes with the posture. A
    /// deflection by an angle moves the measured point by at most the angle times the lever. The lever is the
    /// distance of the point from the axis in the chain with all other errors.
    fn elastic_part(&self) -> f64 {
        if self.evaluator.reading != Reading::Signed || self.deflections.is_empty() {
            return 0.0;
        }
        let sizes = self.evaluator.sources.signed();
        let BoundedError::Columns(motions, _) = &self.error else { return 0.0 };
        let size = |m: &ScrewMotion| (m.factor * sizes[m.source]).abs();
        let slid: f64 = motions.iter().filter(|m| !m.turns).map(size).sum();
        let [along, about] = grams(&self.rows).map(|gram| gram.trace().sqrt());
        // In the second-order model, products of the deflections with other rotations are added.
        let turned: f64 = motions.iter().chain(&self.deflections).filter(|m| m.turns).map(size).sum();
        let deflections = self.deflections.iter();
        let moved = deflections.map(|m| size(m) * (along * (self.lever(m) + slid) + about)).sum::<f64>();
        moved * (1.0 + turned)
    }

    /// Returns the nominal chain at the posture with the [`Coordinates`] `y`.
    pub fn place(&self, y: &JointValues) -> PosedScrews {
        self.screws.place(&self.coordinates.theta(y))
    }

    /// Returns the Taylor model of a lower bound of the value over a box with the half widths `radii` about
    /// `y`.
    ///
    /// Returns None if the value is zero at `y`.
    pub fn worth(&self, y: &JointValues, placed: &PosedScrews, radii: &JointValues) -> Option<Taylor> {
        let (screws, coordinates) = (&self.screws, &self.coordinates);
        let geometry = ChainGeometry { screws, coordinates, pieces: &self.to_point };
        let mut taylor = match &self.error {
            BoundedError::ChainDifference(difference) => {
                let with = difference.screws.place(&self.coordinates.theta(y));
                let gram =
                    self.rows.iter().map(|r| r.direction * r.direction.transpose()).sum::<Matrix3<f64>>();
                let error = with.point - placed.point;
                let size = error.dot(&(gram * error)).sqrt();
                if size < f64::MIN_POSITIVE {
                    return None;
                }
                difference.expand(geometry, placed, &with, &(gram * error / size), radii)
            }
            BoundedError::Columns(motions, sum) => {
                let effects = effects(motions, placed, self.screws.kinds.len());
                let last = self.last.as_ref().map(|last| (last, self.tool_axis(placed, radii)));
                let ValueSum { weights, constant } = sum.weights(&self.rows, motions, &effects, last)?;
                let rates = rates(&self.screws, placed, Some(&placed.point));
                let sum = WeightedMotions { motions, effects: &effects, weights: &weights };
                let mut taylor = linear_effects::expand(geometry, placed, sum, &rates, radii);
                taylor.value += constant;
                taylor
            }
        };
        taylor.value -= self.lost;
        Some(taylor)
    }

    /// Returns the directions of the tool axis over a box with the half widths `radii`, about the posture
    /// `placed`.
    fn tool_axis(&self, placed: &PosedScrews, radii: &JointValues) -> ToolAxisRange {
        let turning = self.coordinates.turning[self.coordinates.count];
        let around = ToolAxisRange { axis: placed.tool, angle: radius(radii, turning) };
        if around.angle < self.tool_axis.angle { around } else { self.tool_axis }
    }

    /// Returns the actuator coordinates (rad or m) of the posture with the [`Coordinates`] `y`.
    pub fn joints(&self, y: &JointValues) -> JointVector {
        let mut q = middle(self.workcell.inverse().chain());
        q.iter_mut().zip(self.coordinates.actuators(y)).for_each(|(q, by)| *q += by);
        q
    }

    /// Returns whether the robot certainly collides with itself in every posture of a box. The box has the
    /// half widths `radii` about the [`Coordinates`] `y`.
    pub fn collides_with_itself(&self, y: &JointValues, radii: &JointValues) -> bool {
        self.self_collision.surrounds(&self.joints(y), self.coordinates.theta_radii(radii))
    }

    /// Returns an upper bound of the distance of the TCP from the origin of the base frame, m.
    pub fn reach(&self) -> f64 {
        self.screws.points[0].norm() + self.to_tip.from(0)
    }

    /// Returns working memory for [`Self::value`].
    pub fn memory(&self) -> EvaluatorScratch {
        self.evaluator.memory()
    }

    /// Computes the value of the operation as the layout search does, in the posture with the [`Coordinates`]
    /// `y`. Returns this value, and the actuator coordinates (rad or m) of the posture.
    ///
    /// If the value depends on a joint that needs no coordinate, the function tries several angles of this
    /// joint. It then returns the least value found.
    pub fn value(&self, y: &JointValues, memory: &mut EvaluatorScratch) -> (f64, JointVector) {
        let chain = self.workcell.inverse().chain();
        let spun = [(0, self.turned_first), (chain.axes() - 1, self.last.is_some())];
        let (evaluator, situation) = (self.evaluator, &self.situation);
        let mut best = (f64::INFINITY, self.joints(y));
        let mut judge = |q: JointVector, best: &mut (f64, JointVector)| {
            let frames = chain.frames(&chain.posture(&q));
            // The value of a posture is not computed if a cheap lower bound of this value reaches the least
            // value found.
            let is_bounded = best.0.is_finite() && evaluator.has_sharp_worst_bound();
            if is_bounded && evaluator.corner_worst(situation, &frames, memory) >= best.0 {
                return;
            }
            let value = evaluator.value(situation, &frames, memory);
            if value < best.0 {
                *best = (value, q);
            }
        };
        judge(best.1, &mut best);
        for (joint, _) in spun.into_iter().filter(|(_, is_spun)| *is_spun) {
            let (low, high) = chain.links[joint].limits;
            let (turn, from) = ((high - low).min(TAU), best.1);
            for k in 0..WITNESS_ANGLES {
                let mut q = from;
                q[joint] = low + turn * k as f64 / WITNESS_ANGLES as f64;
                judge(q, &mut best);
            }
        }
        best
    }
}
