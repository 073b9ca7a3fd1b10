//! Volume and extent of a working envelope.

use super::outline::Lattice;
use super::{Envelope, Fineness};
use crate::reach::{Inverse, Reach};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

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
            let e =
                extent.get_or_insert(Self { radius: (r, r), height: (z, z), widest: z, within });
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
    /// By the midpoint rule: over (r, z) times the angle that can be reached there, where the envelope
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
        let [volume, coarse] = [1.0, 2.0].map(|factor| {
            let step = factor * fine.step;
            let lattice = self.upright(0.0, step);
            let row = |j: usize| {
                let z = lattice.coordinate(1, j);
                let radii = (0..lattice.size[0]).map(|i| lattice.coordinate(0, i)).filter(|r| *r > 0.0);
                let (sum, count) = radii.fold((0.0, 0), |(sum, count), r| {
                    (sum + r * self.angle(opened.as_ref(), &Vector3::new(r, 0.0, z)), count + 1)
                });
                (fine.asked)(count);
                sum * step * step
            };
            // In order: the same sum on any number of threads.
            let rows: Vec<f64> = (0..lattice.size[1]).into_par_iter().map(row).collect();
            rows.iter().sum::<f64>()
        });
        let turned = self.upright(0.0, fine.step).region(fine.tolerance, fine.asked, |[r, z]| {
            self.angle(opened.as_ref(), &Vector3::new(r.abs(), 0.0, z)) > 0.0
        });
        // An outline on both sides of the axis crosses it.
        let crosses = turned.outlines.iter().any(|o| {
            o.points.iter().any(|p| p[0] < 0.0) && o.points.iter().any(|p| p[0] > 0.0)
        });
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
        let [fine_count, coarse] = [1.0, 2.0].map(|factor| {
            let step = factor * fine.step;
            let layers: Vec<(f64, Lattice)> = self.cubes(step).collect();
            let layer = |(z, lattice): &(f64, Lattice)| {
                let nodes = (0..lattice.size[1]).flat_map(|j| (0..lattice.size[0]).map(move |i| (i, j)));
                let points = nodes.map(|(i, j)| (lattice.coordinate(0, i), lattice.coordinate(1, j)));
                let held = points.filter(|(x, y)| self.has(&Vector3::new(*x, *y, *z)));
                let radii: Vec<(f64, f64)> = held.map(|(x, y)| (x.hypot(y), *z)).collect();
                (fine.asked)(lattice.count());
                radii
            };
            let points: Vec<(f64, f64)> = layers.par_iter().flat_map_iter(layer).collect();
            (points.len() as f64 * step.powi(3), Extent::of(points.into_iter(), step))
        });
        let (volume, extent) = fine_count;
        Size { volume, error: (volume - coarse.0).abs(), symmetric: false, extent }
    }
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
