//! Volume and extent of a working envelope.

use super::outline::{Lattice, Outline};
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
    /// By the midpoint rule from line to line, the ends of each line found: over (r, z) times the angle that can be reached there, where the envelope
    /// [is symmetric](Self::is_symmetric); over (x, y, z) otherwise.
    pub fn size(&self, fine: &Fineness<'_>) -> Size {
        if self.is_symmetric() { self.turned_size(fine) } else { self.counted_size(fine) }
    }

    pub(super) fn size_work(&self, step: f64) -> u64 {
        let upright = |step: f64| self.upright(0.0, step).count();
        if self.is_symmetric() {
            return upright(step) * 3 / 2 + upright(2.0 * step) / 2;
        }
        let cube = |step: f64| self.cubes(step).map(|(_, lattice)| lattice.count()).sum::<u64>();
        cube(step) + cube(2.0 * step)
    }

    fn turned_size(&self, fine: &Fineness<'_>) -> Size {
        let opened = (!turns_whole(self.inverse)).then(|| Opened::new(self.inverse));
        let angle = |r: f64, z: f64| self.angle(opened.as_ref(), &Vector3::new(r, 0.0, z));
        let [volume, coarse] = [1.0, 2.0].map(|factor| {
            let step = factor * fine.step;
            let lattice = self.upright(0.0, step);
            let row = |j: usize| {
                let z = lattice.coordinate(1, j);
                let radii = (0..lattice.size[0]).map(|i| lattice.coordinate(0, i)).filter(|r| *r > 0.0);
                let radii: Vec<f64> = radii.collect();
                let moment = |r: f64| r * r / 2.0;
                let line = along(&radii, fine.tolerance, |r| angle(r, z), moment, |_| ());
                (fine.asked)(radii.len() as u64);
                line * step
            };
            // In order: the same sum on any number of threads.
            let rows: Vec<f64> = (0..lattice.size[1]).into_par_iter().map(row).collect();
            rows.iter().sum::<f64>()
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

    fn cubes(&self, step: f64) -> impl Iterator<Item = (f64, Lattice)> {
        let rows = self.upright(0.0, step);
        (0..rows.size[1]).map(move |j| {
            let z = rows.coordinate(1, j);
            (z, self.level(z, step))
        })
    }

    fn counted_size(&self, fine: &Fineness<'_>) -> Size {
        let [(volume, extent), (coarse, _)] = [1.0, 2.0].map(|factor| {
            let step = factor * fine.step;
            let layers: Vec<(f64, Lattice)> = self.cubes(step).collect();
            let layer = |(z, lattice): &(f64, Lattice)| {
                let xs: Vec<f64> = (0..lattice.size[0]).map(|i| lattice.coordinate(0, i)).collect();
                let (mut sum, mut seen) = (0.0, Vec::new());
                for y in (0..lattice.size[1]).map(|j| lattice.coordinate(1, j)) {
                    let held = |x: f64| f64::from(u8::from(self.has(&Vector3::new(x, y, *z))));
                    let see = |x: f64| seen.push((x.hypot(y), *z));
                    sum += along(&xs, fine.tolerance, held, |x| x, see) * step * step;
                }
                (fine.asked)(lattice.count());
                (sum, seen)
            };
            let layers: Vec<(f64, Vec<(f64, f64)>)> = layers.par_iter().map(layer).collect();
            let points = layers.iter().flat_map(|(_, seen)| seen.iter().copied());
            (layers.iter().map(|(sum, _)| sum).sum::<f64>(), Extent::of(points, step))
        });
        Size { volume, error: (volume - coarse).abs(), symmetric: false, extent }
    }
}

/// The integral of `value` over a line of points, times the derivative of `moment`. Where the value
/// jumps, the place is found to `tolerance`; `seen` is told where it is more than 0.
fn along(
    line: &[f64],
    tolerance: f64,
    value: impl Fn(f64) -> f64,
    moment: impl Fn(f64) -> f64,
    mut seen: impl FnMut(f64),
) -> f64 {
    let values: Vec<f64> = line.iter().map(|u| value(*u)).collect();
    let mut sum = 0.0;
    // From 0 to the first point of a line of radii; nothing is there on a line that begins outside.
    sum += values.first().zip(line.first()).map_or(0.0, |(w, u)| w * moment(*u));
    for (ends, w) in line.windows(2).zip(values.windows(2)) {
        let (mut low, mut high) = (ends[0], ends[1]);
        while (w[0] - w[1]).abs() > JUMP && high - low > tolerance {
            let middle = (low + high) / 2.0;
            let between = value(middle);
            if (between - w[0]).abs() < (between - w[1]).abs() { low = middle } else { high = middle }
        }
        let split = (low + high) / 2.0;
        sum += w[0] * (moment(split) - moment(ends[0])) + w[1] * (moment(ends[1]) - moment(split));
        (0..2).filter(|k| w[*k] > 0.0).for_each(|k| {
            seen(ends[k]);
            seen(split);
        });
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
