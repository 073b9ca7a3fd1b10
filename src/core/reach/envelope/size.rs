//! Volume of a working envelope by line integrals, and extent by searches from sampled points.

use super::extent::{EnvelopeExtent, RefinementEffort, SampledEnvelope};
use super::{Envelope, Fineness};
use crate::reach::{Cost, Inverse};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// The integrand counts as discontinuous if it changes by more than this value between neighbouring points.
///
/// For a symmetric envelope, the integrand is the reachable angle (rad). For any other envelope, the
/// integrand is 1 at reachable points and 0 at other points.
const JUMP: f64 = 0.05;

/// Volume and extent of an envelope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Volume of the envelope, m^3.
    pub volume: f64,
    /// Estimated error of the volume, m^3: the difference from the volume computed with twice the step.
    pub error: f64,
    /// Whether the integration used the symmetry of the envelope about the base axis.
    pub symmetric: bool,
    /// Extent of the envelope; None if no point is reachable.
    pub extent: Option<EnvelopeExtent>,
}

/// Returns whether joint 1 has a range of at least one turn.
pub(super) fn turns_whole(inverse: &Inverse) -> bool {
    inverse.chain.links.first().is_some_and(|link| link.limits.1 - link.limits.0 >= TAU)
}

/// Arm whose joint 1 may rotate without limits, and the actual limits of joint 1 (rad).
struct FreedArm {
    inverse: Inverse,
    limits: (f64, f64),
}

impl Envelope<'_> {
    /// Returns volume and extent. The volume is integrated along lines, and discontinuities of the integrand
    /// are located by bisection.
    ///
    /// If the envelope is [symmetric](Self::is_symmetric), the reachable angle about the base axis is
    /// integrated over radius and height (r, z). Any other envelope is integrated over (x, y, z).
    pub fn size(&self, fine: &Fineness<'_>) -> Size {
        if self.is_symmetric() { self.turned_size(fine) } else { self.counted_size(fine) }
    }

    pub(super) fn size_work(&self, step: f64) -> u64 {
        let upright = |step: f64| self.upright(0.0, step).count();
        if self.is_symmetric() {
            return upright(step) * 3 / 2 + upright(2.0 * step) / 2;
        }
        let heights = |step: f64| self.upright(0.0, step).line(1);
        let cube = |step: f64| heights(step).iter().map(|z| self.level(*z, step).count()).sum::<u64>();
        cube(step) + cube(2.0 * step)
    }

    fn turned_size(&self, fine: &Fineness<'_>) -> Size {
        let opened = (!turns_whole(self.inverse)).then(|| FreedArm::new(self.inverse));
        let angle = |r: f64, z: f64| self.angle(opened.as_ref(), &Vector3::new(r, 0.0, z));
        let [volume, coarse] = [1.0, 2.0].map(|factor| {
            let lattice = self.upright(0.0, factor * fine.step);
            let radii: Vec<f64> = lattice.line(0).into_iter().filter(|r| *r > 0.0).collect();
            let row = |z: f64| {
                let at = |r: f64| angle(r, z);
                let values: Vec<f64> = radii.iter().map(|r| at(*r)).collect();
                let samples =
                    Samples { line: &radii, values: &values, tolerance: fine.tolerance, jump: JUMP };
                integral(samples, at, |r| r * r / 2.0)
            };
            let heights = lattice.line(1);
            let told = |z: &f64| {
                (fine.on_progress)(radii.len() as u64);
                row(*z)
            };
            // The rows are collected in order, so that the sum is the same on any number of threads.
            let rows: Vec<f64> = heights.par_iter().map(told).collect();
            let jump = jump_between_lines(&rows);
            let samples = Samples { line: &heights, values: &rows, tolerance: fine.tolerance, jump };
            integral(samples, row, |z| z)
        });
        let turned = self
            .upright(0.0, fine.step)
            .region(fine.tolerance, fine.on_progress, |[r, z]| angle(r.abs(), z) > 0.0);
        let points: Vec<[f64; 2]> = turned.points().collect();
        let sampled = SampledEnvelope {
            points: &points,
            step: fine.step,
            radius_and_height: |[r, z]| (r.abs(), *z),
            contains: &|[r, z]| angle(r.abs(), *z) > 0.0,
            effort: self.effort(),
        };
        Size { volume, error: (volume - coarse).abs(), symmetric: true, extent: sampled.extent() }
    }

    /// Returns the effort for the refinement of the extent.
    fn effort(&self) -> RefinementEffort {
        match self.inverse.cost() {
            Cost::Low | Cost::Middle => RefinementEffort { starts: 4, failures: 8 },
            Cost::High => RefinementEffort { starts: 2, failures: 6 },
            Cost::Numeric => RefinementEffort { starts: 1, failures: 4 },
        }
    }

    /// Returns the total angle (rad) about the base axis over which the circle through `target` is reachable.
    ///
    /// `opened` is the arm without limits of joint 1; None if joint 1 can make a whole turn.
    fn angle(&self, opened: Option<&FreedArm>, target: &Vector3<f64>) -> f64 {
        let Some(opened) = opened else { return if self.contains(target) { TAU } else { 0.0 } };
        // If the target moves along the circle, joint 1 rotates by the same angle.
        let mut turned: Vec<(f64, f64)> = Vec::new();
        let mut last = (f64::NAN, f64::NAN);
        let inverse = &opened.inverse;
        let zero = inverse.chain.links[0].theta;
        inverse.visit(target, &self.attitudes, &mut inverse.scratch(), |_, posture| {
            // Postures that differ only by the spin follow one another.
            let direction = (posture.cos[0], posture.sin[0]);
            if direction != last {
                last = direction;
                let q = direction.1.atan2(direction.0) - zero;
                turned.push((opened.limits.0 - q, opened.limits.1 - q));
            }
        });
        covered(turned)
    }

    fn counted_size(&self, fine: &Fineness<'_>) -> Size {
        let [(volume, points), (coarse, _)] = [1.0, 2.0].map(|factor| {
            let step = factor * fine.step;
            let heights = self.upright(0.0, step).line(1);
            let told = |z: &f64| {
                (fine.on_progress)(self.level(*z, step).count());
                self.layer(*z, step, fine.tolerance)
            };
            let layers: Vec<(f64, Vec<[f64; 3]>)> = heights.par_iter().map(told).collect();
            let areas: Vec<f64> = layers.iter().map(|(area, _)| *area).collect();
            let area = |z: f64| self.layer(z, step, fine.tolerance).0;
            let jump = jump_between_lines(&areas);
            let samples = Samples { line: &heights, values: &areas, tolerance: fine.tolerance, jump };
            let volume = integral(samples, area, |z| z);
            (volume, layers.into_iter().flat_map(|(_, seen)| seen).collect::<Vec<_>>())
        });
        let sampled = SampledEnvelope {
            points: &points,
            step: fine.step,
            radius_and_height: |[x, y, z]| (x.hypot(*y), *z),
            contains: &|p| self.contains(&Vector3::from(*p)),
            effort: self.effort(),
        };
        Size { volume, error: (volume - coarse).abs(), symmetric: false, extent: sampled.extent() }
    }

    /// Returns the area (m^2) of the envelope at height `z` (m), and the lattice points inside the envelope.
    fn layer(&self, z: f64, step: f64, tolerance: f64) -> (f64, Vec<[f64; 3]>) {
        let lattice = self.level(z, step);
        let (xs, ys) = (lattice.line(0), lattice.line(1));
        let held = |x: f64, y: f64| f64::from(u8::from(self.contains(&Vector3::new(x, y, z))));
        let row = |y: f64| xs.iter().map(|x| held(*x, y)).collect::<Vec<f64>>();
        let width = |y: f64, values: &[f64]| {
            integral(Samples { line: &xs, values, tolerance, jump: JUMP }, |x| held(x, y), |x| x)
        };
        let (mut widths, mut seen) = (Vec::new(), Vec::new());
        for y in &ys {
            let values = row(*y);
            let there = xs.iter().zip(&values).filter(|(_, value)| **value > 0.0);
            seen.extend(there.map(|(x, _)| [*x, *y, z]));
            widths.push(width(*y, &values));
        }
        let samples = Samples { line: &ys, values: &widths, tolerance, jump: jump_between_lines(&widths) };
        (integral(samples, |y| width(y, &row(y)), |y| y), seen)
    }
}

/// Returns the least change from one sample line to the next that counts as a jump of the integrand.
///
/// The integrand jumps where the boundary of the envelope is parallel to the lines. The integrand does not
/// jump at a rounded end of the envelope.
fn jump_between_lines(values: &[f64]) -> f64 {
    0.2 * values.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
}

/// Samples of an integrand along a line, and the parameters for locating its jumps.
struct Samples<'a> {
    /// Coordinates of the samples, m.
    line: &'a [f64],
    values: &'a [f64],
    /// Largest error of the position of a jump, m.
    tolerance: f64,
    /// Least change between two neighbouring samples that counts as a jump.
    jump: f64,
}

/// Returns the integral of `f(u) m'(u)` over the coordinate u. Here f is the sampled function, and m' is the
/// derivative of `moment`.
///
/// The function `value` evaluates f between the samples to locate a jump.
fn integral(
    Samples { line, values, tolerance, jump }: Samples<'_>,
    value: impl Fn(f64) -> f64,
    moment: impl Fn(f64) -> f64,
) -> f64 {
    // The part from 0 to the first point matters only on a line of radii. Any other line begins outside the
    // envelope, where the value is 0.
    let mut sum = values.first().zip(line.first()).map_or(0.0, |(w, u)| w * moment(*u));
    for (ends, w) in line.windows(2).zip(values.windows(2)) {
        let (mut low, mut high) = (ends[0], ends[1]);
        while (w[0] - w[1]).abs() > jump && high - low > tolerance {
            let middle = (low + high) / 2.0;
            let between = value(middle);
            if (between - w[0]).abs() < (between - w[1]).abs() { low = middle } else { high = middle }
        }
        let split = (low + high) / 2.0;
        sum += w[0] * (moment(split) - moment(ends[0])) + w[1] * (moment(ends[1]) - moment(split));
    }
    sum
}

impl FreedArm {
    fn new(inverse: &Inverse) -> Self {
        let mut chain = inverse.chain.clone();
        let limits = chain.links[0].limits;
        chain.links[0].limits = (-PI, PI);
        Self { inverse: Inverse::new(&chain), limits }
    }
}

/// Returns the total angle (rad) that the union of `arcs` covers on a circle.
///
/// An arc runs from its first to its second angle (rad).
fn covered(mut arcs: Vec<(f64, f64)>) -> f64 {
    for arc in &mut arcs {
        let turns = (arc.0 / TAU).floor() * TAU;
        *arc = (arc.0 - turns, arc.1 - turns);
    }
    // An arc that passes 2 pi continues at 0.
    let again: Vec<_> = arcs.iter().filter(|a| a.1 > TAU).map(|a| (0.0, a.1 - TAU)).collect();
    arcs.extend(again);
    arcs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut sum, mut end) = (0.0, 0.0);
    for (from, to) in arcs {
        let to = to.min(TAU);
        sum += (to - f64::max(from, end)).max(0.0);
        end = f64::max(end, to);
    }
    sum
}
