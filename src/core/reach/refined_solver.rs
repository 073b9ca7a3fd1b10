//! Inverse kinematics of chains that nearly belong to a family with a closed form, such as calibrated arms.
//!
//! A simplified copy of the chain has the closed form. Each solution of the copy is a start posture for
//! Newton's method on the chain itself.
//!
//! At the edge of the reach and near singular postures, the chain can have solutions where its copy has none.
//! So the copy is also solved for six neighbouring poses, each shifted along one axis and rotated about
//! another. The shift and the rotation are somewhat larger than the deviation between the two chains.

use super::exact_solver::ExactSolver;
use super::general_six_axes::solve_six;
use super::numeric::{dh_jacobian, rotation_vector};
use super::simplified_chain::SimplifiedChain;
use crate::cell::{JointKind, MAX_JOINTS};
use crate::pose::{Displacement, Pose};
use crate::robot::{Chain, Frames, Posture};
use nalgebra::{Matrix6, Vector3, Vector6};

/// Tolerances (rad and m) of the simplified copy. The solver tries the tolerances in this order until the
/// copy has a closed form.
const TOLERANCES: [f64; 9] = [1e-8, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.02];

/// Number of sampled postures on which the solver is tested.
const TRIALS: usize = 48;

/// Largest number of sampled postures that the solver may miss, because they are nearly singular.
const MAX_MISSED: usize = 2;

/// Largest number of solutions of one pose.
const MAX_SOLUTIONS: usize = 16;

/// Number of solutions after which no more neighbouring poses are solved.
const ENOUGH: usize = 8;

/// Shift and rotation of the neighbouring poses, as a multiple of the largest deviation between the flanges
/// of both chains.
const MARGIN: f64 = 2.0;

/// Largest error of a solution, m and rad.
const REACHED: f64 = 1e-10;

/// Another step of Newton's method gains nothing if the error (m and rad) is below this value.
const EXACT: f64 = 1e-13;

/// Largest number of Newton steps from one start posture.
const STEPS: usize = 24;

/// Largest change of a joint in one step, rad or m.
const LONGEST_STEP: f64 = 0.5;

/// Two postures are the same solution if the sines and cosines of their joint angles differ by less than this
/// value.
const SAME: f64 = 1e-6;

/// Closed form of a simplified chain, refined by Newton's method.
#[derive(Debug, Clone)]
pub struct RefinedSolver {
    /// Chain without mount and tool.
    chain: Chain,
    simplified: SimplifiedChain,
    solver: ExactSolver,
    template: Posture,
}

/// Distinct solutions of one pose.
struct Solutions {
    postures: [Posture; MAX_SOLUTIONS],
    count: usize,
    /// Bit k is set if a solution has the branch index k.
    numbers: u16,
}

impl RefinedSolver {
    /// Returns the solver of a six-axis chain whose simplified copy has a closed form.
    ///
    /// Returns None for other chains, or if the solver misses too many sampled postures.
    pub fn new(chain: &Chain) -> Option<Self> {
        if chain.axes() != 6 {
            return None;
        }
        let found = TOLERANCES.into_iter().find_map(|tolerance| {
            let simplified = SimplifiedChain::new(chain, tolerance)?;
            let solver = ExactSolver::closed_form(&simplified.chain)?;
            Some((simplified, solver))
        });
        let (simplified, solver) = found?;
        let mut chain = chain.clone();
        (chain.mount, chain.tool) = (Pose::identity(), Pose::identity());
        let template = simplified.chain.zero_posture();
        let refined = Self { chain, simplified, solver, template };
        refined.finds_samples().then_some(refined)
    }

    /// Returns a phrase that names the family of the arm.
    pub fn family(&self) -> &'static str {
        match &self.solver {
            ExactSolver::ThreeParallel(_) => {
                "six axes with three nearly parallel ones (closed form and Newton's method)"
            }
            _ => "six axes with three that nearly meet in a point (closed form and Newton's method)",
        }
    }

    /// Returns a phrase that names the family of a redundant arm. This solver solves for all joints of the
    /// arm except the redundant joint.
    ///
    /// The redundant joint is the first joint if `first_is_free` is true, otherwise the last joint.
    pub fn redundant_family(&self, first_is_free: bool) -> &'static str {
        match (&self.solver, first_is_free) {
            (ExactSolver::ThreeParallel(_), true) => {
                "three nearly parallel axes, redundant first joint (closed form and Newton's method)"
            }
            (ExactSolver::ThreeParallel(_), false) => {
                "three nearly parallel axes, redundant last joint (closed form and Newton's method)"
            }
            (_, true) => "nearly a spherical wrist, redundant first joint (closed form and Newton's method)",
            (_, false) => {
                "nearly a spherical shoulder, redundant last joint (closed form and Newton's method)"
            }
        }
    }

    /// Returns a faster variant of the solver. For a target out of reach, [`Self::solve`] of the variant
    /// returns only a lower bound in place of the distance.
    pub fn fast(&self) -> Self {
        Self { solver: self.solver.fast(), ..self.clone() }
    }

    /// Returns a lower bound of the distance, m, by which a target is out of reach.
    #[inline]
    pub fn bound(&self, flange: &Pose) -> f64 {
        (self.solver.bound(&self.simplified.flange(flange)) - self.slack()).max(0.0)
    }

    /// Calls `found` with every solution for the pose `flange` of the last D-H frame in frame 0.
    ///
    /// Newton's method starts at the solutions of the simplified chain. A refined solution keeps the branch
    /// index of its start. If another solution already has this index, the function takes an unused index.
    ///
    /// Returns the distance by which the target is out of reach of the simplified chain, m; 0 if there is a
    /// solution.
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        let goal = self.simplified.flange(flange);
        let mut solutions = Solutions { postures: [self.template; MAX_SOLUTIONS], count: 0, numbers: 0 };
        let mut start = self.template;
        let mut refine = |branch: u8, start: &Posture, solutions: &mut Solutions| {
            *posture = self.simplified.original(start);
            if self.refine(flange, posture)
                && let Some(number) = solutions.take(branch, posture)
            {
                found(number, posture);
            }
        };
        let by = self.solver.solve(&goal, &mut start, &mut |branch, start| {
            refine(branch, start, &mut solutions);
        });
        let slack = self.slack();
        if by > slack {
            return by;
        }
        for beside in self.neighbours(&goal) {
            if solutions.count >= ENOUGH {
                break;
            }
            self.solver.solve(&beside, &mut start, &mut |branch, start| {
                if solutions.numbers & 1 << branch == 0 {
                    refine(branch, start, &mut solutions);
                }
            });
        }
        if solutions.count > 0 { 0.0 } else { by }
    }

    /// Returns the distance (m) by which the neighbouring poses are shifted from the required pose.
    fn slack(&self) -> f64 {
        MARGIN * self.simplified.distance
    }

    /// Returns the neighbouring poses for which the simplified chain is also solved.
    fn neighbours(&self, pose: &Pose) -> impl Iterator<Item = Pose> {
        let (pose, shift, turn) = (*pose, self.slack(), MARGIN * self.simplified.angle);
        (0..6).map(move |k| {
            let sign = if k & 1 == 0 { 1.0 } else { -1.0 };
            let along = Vector3::ith(k / 2, sign);
            let about = Vector3::ith((k / 2 + 1) % 3, sign);
            let turned = Pose::rotation_about(&pose.translation, &(about * turn)) * pose;
            Pose { translation: pose.translation + along * shift, ..turned }
        })
    }

    /// Moves a posture by Newton's method until its last frame is at `flange`. Returns whether the method
    /// converges.
    fn refine(&self, flange: &Pose, posture: &mut Posture) -> bool {
        let (mut frames, mut before) = (Frames::default(), f64::INFINITY);
        for _ in 0..STEPS {
            self.chain.place(posture, &mut frames);
            let twist = twist_to(&frames.tcp, flange);
            let size = twist.amax();
            // Near the solution, rounding prevents further progress.
            if size < EXACT || size < REACHED && size >= before {
                return true;
            }
            before = size;
            let Some(step) = newton_step(&dh_jacobian(&self.chain, &frames), &twist) else { return false };
            for (k, (by, link)) in step.iter().zip(&self.chain.links).enumerate() {
                match link.kind {
                    JointKind::Revolute => {
                        let (sin, cos) = small_sin_cos(*by);
                        (posture.cos[k], posture.sin[k]) = (
                            posture.cos[k] * cos - posture.sin[k] * sin,
                            posture.sin[k] * cos + posture.cos[k] * sin,
                        );
                    }
                    JointKind::Prismatic => posture.r[k] += by,
                }
            }
        }
        before < REACHED
    }

    /// Returns whether the solver finds the sampled postures of the chain from their poses. A few nearly
    /// singular postures may be missed.
    fn finds_samples(&self) -> bool {
        let mut scratch = self.template;
        let found = (0..TRIALS).filter(|&k| {
            let wanted = self.chain.posture(&self.chain.halton_sample(k));
            let flange = self.chain.frames(&wanted).tcp;
            let mut is_found = false;
            self.solve(&flange, &mut scratch, &mut |_, found| is_found |= is_same(found, &wanted));
            is_found
        });
        found.count() + MAX_MISSED >= TRIALS
    }
}

impl Solutions {
    /// Adds a posture and returns its branch index: `branch`, or an unused index if another solution has the
    /// index `branch`.
    ///
    /// Returns None if the posture is already known, or if there are too many solutions.
    fn take(&mut self, branch: u8, posture: &Posture) -> Option<u8> {
        let known = &self.postures[..self.count];
        if self.count == MAX_SOLUTIONS || known.iter().any(|known| is_same(known, posture)) {
            return None;
        }
        let free = (self.numbers.trailing_ones() as u8).min(15);
        let number = if self.numbers & 1 << branch == 0 { branch } else { free };
        self.numbers |= 1 << number;
        self.postures[self.count] = *posture;
        self.count += 1;
        Some(number)
    }
}

/// Returns whether two postures have the same joint coordinates, up to rounding.
fn is_same(a: &Posture, b: &Posture) -> bool {
    let near =
        |a: &[f64; MAX_JOINTS], b: &[f64; MAX_JOINTS]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < SAME);
    near(&a.cos, &b.cos) && near(&a.sin, &b.sin) && near(&a.r, &b.r)
}

/// Returns the twist from one pose to another: the translation (m) and the rotation vector (rad).
fn twist_to(from: &Pose, to: &Pose) -> Vector6<f64> {
    let (p, r) =
        (to.translation - from.translation, rotation_vector(&(to.rotation * from.rotation.transpose())));
    Vector6::new(p.x, p.y, p.z, r.x, r.y, r.z)
}

/// Returns the step of the joint coordinates (rad or m) that reduces a twist to 0 in the linear
/// approximation. If this step is too long, the posture is nearly singular, and the function returns a damped
/// step (C. W. Wampler, 1986). Returns None if the twist is not finite.
fn newton_step(columns: &[Displacement; MAX_JOINTS], twist: &Vector6<f64>) -> Option<[f64; 6]> {
    let mut jacobian = Matrix6::zeros();
    for (mut column, motion) in jacobian.column_iter_mut().zip(columns) {
        column.fixed_rows_mut::<3>(0).copy_from(&motion.position);
        column.fixed_rows_mut::<3>(3).copy_from(&motion.rotation);
    }
    let rows =
        std::array::from_fn(|i| std::array::from_fn(|k| if k < 6 { jacobian[(i, k)] } else { twist[i] }));
    let is_short = |step: &[f64; 6]| step.iter().all(|by| by.abs() < LONGEST_STEP);
    solve_six(rows).filter(is_short).or_else(|| {
        let transposed = jacobian.transpose();
        let damping = Matrix6::from_diagonal_element(twist.norm_squared().max(1e-12));
        let factors = (transposed * jacobian + damping).cholesky()?;
        Some(factors.solve(&(transposed * twist)).into())
    })
}

/// Returns sine and cosine of an angle (rad), by a series if the angle is small.
fn small_sin_cos(angle: f64) -> (f64, f64) {
    let square = angle * angle;
    if square > 1e-4 {
        return angle.sin_cos();
    }
    let sin = angle * (1.0 - square / 6.0 * (1.0 - square / 20.0));
    (sin, 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0)))
}
