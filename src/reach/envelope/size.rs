//! Volume and extent of a working envelope.

use super::outline::Outline;
use super::{Envelope, Fineness};
use crate::reach::{Inverse, Reach};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// A greater change (rad, or of yes and no) from point to point is a jump.
const JUMP: f64 = 0.05;

/// Volume and extent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// m^3.
    pub volume: f64,
    /// How far the volume is from that at twice the step, m^3: an estimate of its error.
    pub error: f64,
    /// Whether the symmetry round the base axis was used.
    pub symmetric: bool,
    /// None if nothing can be reached.
    pub extent: Option<Extent>,
}

/// How far the envelope extends, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Least and greatest distance from the base axis.
    pub radius: (f64, f64),
    /// Least and greatest height.
    pub height: (f64, f64),
    /// Height of the greatest distance.
    pub widest: f64,
    /// By how much these may be off.
    pub within: f64,
}

impl Extent {
    fn of(points: impl Iterator<Item = (f64, f64)>, within: f64) -> Option<Self> {
        let mut extent: Option<Self> = None;
        for (r, z) in points {
            let e = extent.get_or_insert(Self { radius: (r, r), height: (z, z), widest: z, within });
            e.widest = if r > e.radius.1 { z } else { e.widest };
            e.radius = (e.radius.0.min(r), e.radius.1.max(r));
            e.height = (e.height.0.min(z), e.height.1.max(z));
        }
        extent
    }
}

/// Whether joint 1 reaches every direction.
pub(super) fn turns_whole(inverse: &Inverse) -> bool {
    inverse.chain.links.first().is_some_and(|link| link.limits.1 - link.limits.0 >= TAU)
}

/// The arm with joint 1 free to turn, and by how much it may turn in fact.
struct Opened {
    inverse: Inverse,
    limits: (f64, f64),
}

impl Envelope<'_> {
    /// Integrated line by line, jumps found by bisection: over (r, z) times the angle that can be reached there, where the envelope
    /// [is symmetric](Self::is_symmetric); over (x, y, z) otherwise.
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
        let opened = (!turns_whole(self.inverse)).then(|| Opened::new(self.inverse));
        let angle = |r: f64, z: f64| self.angle(opened.as_ref(), &Vector3::new(r, 0.0, z));
        let [volume, coarse] = [1.0, 2.0].map(|factor| {
            let lattice = self.upright(0.0, factor * fine.step);
            let radii: Vec<f64> = lattice.line(0).into_iter().filter(|r| *r > 0.0).collect();
            let row = |z: f64| {
                let at = |r: f64| angle(r, z);
                let values: Vec<f64> = radii.iter().map(|r| at(*r)).collect();
                integral((&radii, &values), (fine.tolerance, JUMP), at, |r| r * r / 2.0)
            };
            let heights = lattice.line(1);
            let told = |z: &f64| {
                (fine.asked)(radii.len() as u64);
                row(*z)
            };
            // In order: the same sum on any number of threads.
            let rows: Vec<f64> = heights.par_iter().map(told).collect();
            integral((&heights, &rows), (fine.tolerance, leap(&rows)), row, |z| z)
        });
        let turned =
            self.upright(0.0, fine.step).region(fine.tolerance, fine.asked, |[r, z]| angle(r.abs(), z) > 0.0);
        // An outline on both sides of the axis crosses it.
        let on = |o: &Outline, side: f64| o.points.iter().any(|p| p[0] * side > 0.0);
        let crosses = turned.outlines.iter().any(|o| on(o, 1.0) && on(o, -1.0));
        let mut extent = Extent::of(turned.points().map(|[r, z]| (r.abs(), z)), fine.step);
        extent.iter_mut().filter(|_| crosses).for_each(|e| e.radius.0 = 0.0);
        Size { volume, error: (volume - coarse).abs(), symmetric: true, extent }
    }

    /// The angle (rad) round the base axis in which a point at azimuth 0 can be reached.
    fn angle(&self, opened: Option<&Opened>, target: &Vector3<f64>) -> f64 {
        let Some(opened) = opened else { return if self.has(target) { TAU } else { 0.0 } };
        let Reach::Branches(branches) = opened.inverse.branches(target, &self.approach) else { return 0.0 };
        let usable = branches.iter().filter(|b| b.is_usable());
        // Joint 1 turns with the target.
        let turned = usable.map(|b| (opened.limits.0 - b.joints[0], opened.limits.1 - b.joints[0]));
        covered(turned.collect())
    }

    fn counted_size(&self, fine: &Fineness<'_>) -> Size {
        let [(volume, extent), (coarse, _)] = [1.0, 2.0].map(|factor| {
            let step = factor * fine.step;
            let heights = self.upright(0.0, step).line(1);
            let told = |z: &f64| {
                (fine.asked)(self.level(*z, step).count());
                self.layer(*z, step, fine.tolerance)
            };
            let layers: Vec<(f64, Vec<(f64, f64)>)> = heights.par_iter().map(told).collect();
            let areas: Vec<f64> = layers.iter().map(|(area, _)| *area).collect();
            let area = |z: f64| self.layer(z, step, fine.tolerance).0;
            let volume = integral((&heights, &areas), (fine.tolerance, leap(&areas)), area, |z| z);
            (volume, Extent::of(layers.into_iter().flat_map(|(_, seen)| seen), step))
        });
        Size { volume, error: (volume - coarse).abs(), symmetric: false, extent }
    }

    /// The area at a height, and distance from the base axis and height of the lattice points there.
    fn layer(&self, z: f64, step: f64, tolerance: f64) -> (f64, Vec<(f64, f64)>) {
        let lattice = self.level(z, step);
        let (xs, ys) = (lattice.line(0), lattice.line(1));
        let held = |x: f64, y: f64| f64::from(u8::from(self.has(&Vector3::new(x, y, z))));
        let row = |y: f64| xs.iter().map(|x| held(*x, y)).collect::<Vec<f64>>();
        let width =
            |y: f64, values: &[f64]| integral((&xs, values), (tolerance, JUMP), |x| held(x, y), |x| x);
        let (mut widths, mut seen) = (Vec::new(), Vec::new());
        for y in &ys {
            let values = row(*y);
            let there = xs.iter().zip(&values).filter(|(_, value)| **value > 0.0);
            seen.extend(there.map(|(x, _)| (x.hypot(*y), z)));
            widths.push(width(*y, &values));
        }
        let limits = (tolerance, leap(&widths));
        (integral((&ys, &widths), limits, |y| width(y, &row(y)), |y| y), seen)
    }
}

/// From line to line this is a jump: a wall along the lattice, not the end of something round.
fn leap(values: &[f64]) -> f64 {
    0.2 * values.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
}

/// The integral over a line of points, with the values there, times the derivative of `moment`. Where
/// the value changes by more than `jump` the place is found to `tolerance`.
fn integral(
    (line, values): (&[f64], &[f64]),
    (tolerance, jump): (f64, f64),
    value: impl Fn(f64) -> f64,
    moment: impl Fn(f64) -> f64,
) -> f64 {
    // From 0 to the first point of a line of radii; nothing is there on a line that begins outside.
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

impl Opened {
    fn new(inverse: &Inverse) -> Self {
        let mut chain = inverse.chain.clone();
        let limits = chain.links[0].limits;
        chain.links[0].limits = (-PI, PI);
        Self { inverse: Inverse::new(&chain), limits }
    }
}

/// How much of a circle these arcs cover (rad, from the first to the second angle).
fn covered(mut arcs: Vec<(f64, f64)>) -> f64 {
    for arc in &mut arcs {
        let turns = (arc.0 / TAU).floor() * TAU;
        *arc = (arc.0 - turns, arc.1 - turns);
    }
    // What runs over the end of the circle begins again.
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
