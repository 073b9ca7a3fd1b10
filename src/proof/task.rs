//! One operation made ready to be bounded: its chain, what counts of its error, what it must keep.

use super::WhyNot;
use super::columns;
use super::columns::effects;
use super::coordinates::{Coordinates, middle};
use super::difference::Difference;
use super::region::{Constraint, Quantity, Region};
use super::screws::{Motion, Placed, Screws, Values, motions};
use super::taylor::{Pieces, Taylor, along, radius, rates};
use super::worth::Sum;
use crate::cell::{Cell, Frame, JointKind, JointVector, MAX_JOINTS, Model, Reading, Registration, Row};
use crate::layout::Workcell;
use crate::pose::Pose;
use crate::reading::{ErrorEvaluator, EvaluatorScratch, WorkContext, WorkFrame};
use nalgebra::{Matrix3, Vector3};

/// Rounding below which directions agree.
const SAME: f64 = 1e-12;

pub(super) struct Task<'a> {
    gauge: &'a ErrorEvaluator,
    workcell: &'a Workcell,
    situation: WorkContext,
    screws: Screws,
    pub coordinates: Coordinates,
    /// Out to the TCP, and to the point whose error counts.
    to_tip: Pieces,
    to_point: Pieces,
    rows: Vec<Row>,
    error: Error,
    /// What the models may differ by, m: taken off.
    lost: f64,
    pub constraints: Vec<Constraint>,
}

/// How the error is made.
enum Error {
    /// Of a signed sample, nonlinear.
    Difference(Box<Difference>),
    /// Sums of linear effects.
    Columns(Vec<Motion>, Sum),
}

impl<'a> Task<'a> {
    /// # Errors
    /// Why there is no bound.
    pub fn new(workcell: &'a Workcell, region: &Region) -> Result<Self, WhyNot> {
        let cell = &workcell.cell;
        let (operation, gauge) = (&cell.operations[region.operation], workcell.evaluator(region.operation));
        let chain = workcell.inverse().chain();
        refuse(cell, region.operation)?;
        let rows = rows(cell, gauge, region.operation)?;
        let sample = gauge.reading == Reading::Signed && gauge.model != Model::Linear;
        if rows.iter().any(|r| r.turns)
            && gauge.model != Model::Linear
            && gauge.reading != Reading::Statistical
        {
            return Err(WhyNot::Rotation);
        }
        let frames = chain.frames(&chain.posture(&middle(chain)));
        let screws = Screws::nominal(chain, &frames, &gauge.sense.point);
        let sum = Sum::new(gauge, rows.len())?;
        let sources = gauge.sources.list.iter().enumerate();
        let motions: Vec<Motion> =
            sources.flat_map(|(k, source)| motions(chain, &frames, source.parameter, k)).collect();
        let free = Coordinates::new(chain, &screws, &[false; MAX_JOINTS]);
        let pieces = Pieces::new(&screws, &screws.point, &free);
        let errors = gauge.sources.perturbation(chain, &gauge.sources.signed());
        let difference =
            sample.then(|| Difference::new(&screws, screws.perturbed(&frames, &errors), &pieces));
        let turns_along = match &difference {
            Some(difference) => difference.keeps_first_axis(),
            None => motions.iter().all(|m| m.link > 0 || is_of_first_axis(m, &screws)),
        };
        let first_alone = (1..chain.axes()).all(|i| chain.coupling[i][0] == 0.0);
        let mut held = [false; MAX_JOINTS];
        held[0] = first_alone
            && match screws.kinds[0] {
                JointKind::Revolute => {
                    let upright = screws.axes[0].xy().norm() < SAME;
                    upright && turns_along && turns_with_z(&rows)
                }
                JointKind::Prismatic => {
                    screws.axes[0].z.abs() < SAME && motions.iter().all(|m| m.link > 0 || !m.turns)
                }
            };
        let coordinates = Coordinates::new(chain, &screws, &held);
        let mut constraints = region.constraints();
        let centred = screws.kinds[0] == JointKind::Revolute && screws.points[0].xy().norm() < SAME;
        let site = WorkFrame {
            equipment: operation.equipment,
            work: Pose::identity(),
            world: cell.start().base.from_world(),
            taught: None,
        };
        let to_tip = Pieces::new(&screws, &screws.tip, &coordinates);
        let reach = screws.points[0].norm() + to_tip.from(0);
        let limits = |c: &Constraint| (centred || !held[0]) && (c.low > 0.0 || c.high < reach * reach);
        constraints.retain(|c| c.of != Quantity::RadiusSquared || limits(c));
        let mut task = Self {
            gauge,
            workcell,
            situation: WorkContext { site, reference: None },
            to_tip,
            to_point: Pieces::new(&screws, &screws.point, &coordinates),
            screws,
            coordinates,
            rows,
            error: Error::Columns(motions, sum),
            lost: 0.0,
            constraints,
        };
        task.lost = task.lost();
        if let Some(difference) = difference {
            task.error = Error::Difference(Box::new(difference));
        }
        Ok(task)
    }

    /// What a model can be off the one that is bounded. Of a worst case the two opposite corners share
    /// the even orders: `max |+-L + E + O| >= |L| - |O|`; a second-order model lacks the third order of
    /// the nonlinear one. With the turns `a_k` and displacements `b_k` of the motions both are at most
    /// `sum_k b_k (sum_j a_j)^2 / 2`.
    fn lost(&self) -> f64 {
        let sizes: Vec<f64> = match (self.gauge.reading, self.gauge.model) {
            (Reading::Signed, Model::SecondOrder) => self.gauge.sources.signed(),
            (Reading::WorstCase, Model::Nonlinear) => {
                self.gauge.sources.list.iter().map(|s| s.plus_minus).collect()
            }
            _ => return 0.0,
        };
        let Error::Columns(motions, _) = &self.error else { return 0.0 };
        let size = |m: &Motion| (m.factor * sizes[m.source]).abs();
        let (turns, slides): (Vec<&Motion>, Vec<&Motion>) = motions.iter().partition(|m| m.turns);
        let (sum, slid): (f64, f64) =
            (turns.iter().map(|m| size(m)).sum(), slides.iter().map(|m| size(m)).sum());
        let n = self.screws.kinds.len();
        let lever = |m: &Motion| {
            let next = if m.link == n { &self.screws.point } else { &self.screws.points[m.link] };
            (next - m.through).norm() + self.to_point.from(m.link) + slid
        };
        let moved: f64 = turns.iter().map(|m| size(m) * lever(m)).sum();
        let rows = self.rows.iter().map(|r| r.direction.norm_squared()).sum::<f64>().sqrt();
        rows * (moved + slid) * sum * sum / 2.0
    }

    pub fn place(&self, y: &Values) -> Placed {
        self.screws.place(&self.coordinates.theta(y))
    }

    /// Expands a constraint.
    pub fn constraint(&self, constraint: &Constraint, placed: &Placed, radii: &Values) -> Taylor {
        let (gradient, hessian, rest) = match constraint.of {
            Quantity::Height => {
                let (g, h) = along(
                    &self.screws,
                    placed,
                    &rates(&self.screws, placed, Some(&placed.tip)),
                    &Vector3::z(),
                );
                (g, h, self.to_tip.turned(&self.coordinates, radii, 0, 0, 3))
            }
            Quantity::Axis(k) => {
                let (g, h) =
                    along(&self.screws, placed, &rates(&self.screws, placed, None), &Vector3::ith(k, 1.0));
                let last = self.coordinates.turning[self.coordinates.count];
                (g, h, radius(radii, last).powi(3))
            }
            Quantity::RadiusSquared => {
                let rates = rates(&self.screws, placed, Some(&placed.tip));
                let level = Vector3::new(placed.tip.x, placed.tip.y, 0.0);
                let (mut g, mut h) = along(&self.screws, placed, &rates, &(level * 2.0));
                g[self.coordinates.count..].fill(0.0);
                for i in 0..self.coordinates.count {
                    (i..self.coordinates.count)
                        .for_each(|j| h[i][j] += 2.0 * rates[i].xy().dot(&rates[j].xy()));
                }
                let [one, two, three] =
                    [1, 2, 3].map(|power| self.to_tip.turned(&self.coordinates, radii, 0, 0, power));
                let reach = self.screws.points[0].norm() + self.to_tip.from(0);
                (g, h, 2.0 * (reach * three + 3.0 * one * two))
            }
        };
        let (gradient, hessian) = self.coordinates.derivatives(&gradient, &hessian);
        Taylor { value: constraint.value(&placed.tip, &placed.tool), gradient, hessian, rest: rest / 6.0 }
    }

    /// Expands what the value is at least; None where that is zero.
    pub fn worth(&self, y: &Values, placed: &Placed, radii: &Values) -> Option<Taylor> {
        let parts = (&self.screws, &self.coordinates, &self.to_point);
        let mut taylor = match &self.error {
            Error::Difference(difference) => {
                let with = difference.screws.place(&self.coordinates.theta(y));
                let gram =
                    self.rows.iter().map(|r| r.direction * r.direction.transpose()).sum::<Matrix3<f64>>();
                let error = with.point - placed.point;
                let size = error.dot(&(gram * error)).sqrt();
                if size < f64::MIN_POSITIVE {
                    return None;
                }
                difference.expand(parts, (placed, &with), &(gram * error / size), radii)
            }
            Error::Columns(motions, sum) => {
                let effects = effects(motions, placed, self.screws.kinds.len());
                let weights = sum.weights(&self.rows, motions, &effects)?;
                let rates = rates(&self.screws, placed, Some(&placed.point));
                columns::expand(parts, placed, (motions, &effects), &weights, &rates, radii)
            }
        };
        taylor.value -= self.lost;
        Some(taylor)
    }

    /// The joint coordinates of a point.
    pub fn joints(&self, y: &Values) -> JointVector {
        let mut q = middle(self.workcell.inverse().chain());
        q.iter_mut().zip(self.coordinates.actuators(y)).for_each(|(q, by)| *q += by);
        q
    }

    pub fn memory(&self) -> EvaluatorScratch {
        self.gauge.memory()
    }

    /// What the search would make of a point.
    pub fn value(&self, y: &Values, memory: &mut EvaluatorScratch) -> f64 {
        let chain = self.workcell.inverse().chain();
        let frames = chain.frames(&chain.posture(&self.joints(y)));
        self.gauge.value(&self.situation, &frames, memory)
    }
}

/// What no bound is known of.
fn refuse(cell: &Cell, operation: usize) -> Result<(), WhyNot> {
    let asked = &cell.operations[operation];
    if asked.relative_to.is_some() {
        return Err(WhyNot::Relative);
    }
    if cell.registration != Registration::None {
        return Err(WhyNot::Registered);
    }
    if cell.reading == Reading::Signed && cell.equipment[asked.equipment].errors.is_some() {
        return Err(WhyNot::EquipmentErrors);
    }
    Ok(())
}

/// The rows of the sense in the base frame.
fn rows(cell: &Cell, gauge: &ErrorEvaluator, operation: usize) -> Result<Vec<Row>, WhyNot> {
    let sense = &gauge.sense;
    let turned = |by: &Matrix3<f64>| -> Vec<Row> {
        sense.rows().iter().map(|row| Row { direction: by * row.direction, ..*row }).collect()
    };
    let world = turned(&cell.start().base.from_world());
    let turned_base = cell.base[3].is_free();
    match sense.frame {
        Frame::World if !turned_base || turns_with_z(&world) => Ok(world),
        Frame::World => Err(WhyNot::WorldAxes),
        _ if is_isotropic(&world) => Ok(world),
        Frame::Tool => Err(WhyNot::ToolAxes),
        Frame::Surface if turns_with_z(&world) => Ok(world),
        Frame::Surface => {
            let equipment = cell.operations[operation].equipment;
            let under = (0..cell.equipment.len()).filter(|&under| cell.rides_on(equipment, under));
            if turned_base || under.clone().any(|k| cell.equipment[k].placement[3].is_free()) {
                return Err(WhyNot::SurfaceAxes);
            }
            let start = cell.start();
            let (s, c) = (start.placements[equipment].yaw - start.base.yaw).sin_cos();
            Ok(turned(&Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)))
        }
    }
}

/// `sum r r^T` of the rows of position, and of rotation.
fn grams(rows: &[Row]) -> [Matrix3<f64>; 2] {
    let gram = |turns: bool| {
        rows.iter()
            .filter(|r| r.turns == turns)
            .map(|r| r.direction * r.direction.transpose())
            .sum::<Matrix3<f64>>()
    };
    [gram(false), gram(true)]
}

/// Whether sizes do not depend on turns about z.
fn turns_with_z(rows: &[Row]) -> bool {
    grams(rows).iter().all(|g| {
        let off = (g[(0, 0)] - g[(1, 1)]).abs() + g[(0, 1)].abs() + g[(0, 2)].abs() + g[(1, 2)].abs();
        off <= SAME * g.trace()
    })
}

/// Whether they do not depend on any turn.
fn is_isotropic(rows: &[Row]) -> bool {
    turns_with_z(rows) && grams(rows).iter().all(|g| (g[(0, 0)] - g[(2, 2)]).abs() <= SAME * g.trace())
}

/// Whether a motion before the first joint is about or along its axis.
fn is_of_first_axis(motion: &Motion, screws: &Screws) -> bool {
    let (axis, arm) = (&screws.axes[0], motion.through - screws.points[0]);
    motion.axis.cross(axis).norm() < SAME && (!motion.turns || arm.cross(axis).norm() < SAME)
}
