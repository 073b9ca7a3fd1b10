//! Simplified copy of a chain: relations that nearly hold between neighbouring axes hold exactly in the copy.
//!
//! Each axis is treated as a line, with all joint coordinates at 0. The axes are processed from base to
//! flange. Each axis is rotated and moved as little as possible. If one of the following relations nearly
//! holds, this change makes the relation exact:
//!
//! - The angle between the axis and the previous axis is a multiple of 90 degrees.
//! - The axis intersects the previous axis.
//! - The common normal of the two axes intersects the previous common normal.
//!
//! All later axes and the flange move along with the axis. So a simplification changes only the relation
//! between two neighbouring axes, and errors do not accumulate.
//!
//! The D-H rows of the copy follow from the simplified lines (J. Denavit, R. S. Hartenberg, 1955). Rounding
//! the D-H rows of the chain instead would not work. The offset r between nearly parallel axes can be a
//! kilometre long, because their common normal is far away.

use super::numeric::least_turn;
use crate::cell::MAX_JOINTS;
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Number of sampled postures at which the two chains are compared.
const SAMPLES: usize = 24;

/// Simplified chain, and its relation to the original chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SimplifiedChain {
    /// Simplified chain without mount and tool, which starts at frame 0 of the original chain.
    pub chain: Chain,
    /// Pose of the last frame of the simplified chain in the last frame of the original chain.
    from_flange: Pose,
    /// For each joint at coordinate 0: cosine and sine of the difference of theta, and the difference of r
    /// (m).
    ///
    /// A difference is the value of the original chain minus the value of the simplified chain.
    offsets: [(f64, f64, f64); MAX_JOINTS],
    /// Largest distance (m) between the flanges of both chains at sampled postures.
    pub distance: f64,
    /// Largest angle (rad) between the flanges of both chains at sampled postures.
    pub angle: f64,
}

/// Line of a joint axis: a unit vector, and a point on the line (m).
#[derive(Clone, Copy)]
struct Line {
    along: Vector3<f64>,
    point: Vector3<f64>,
}

impl SimplifiedChain {
    /// Simplifies a chain: removes angular deviations below `tolerance` (rad) and lengths below `tolerance`
    /// (m).
    ///
    /// Returns None for a chain without joints.
    pub fn new(chain: &Chain, tolerance: f64) -> Option<Self> {
        let mut original = chain.clone();
        (original.mount, original.tool) = (Pose::identity(), Pose::identity());
        let zero = original.zero_posture();
        let frames = original.frames(&zero).links;
        let (mut links, mut frame, mut moved) = (original.links.clone(), Pose::identity(), Pose::identity());
        let (last, inner) = links.split_last_mut()?;
        for (k, (link, next)) in inner.iter_mut().zip(&frames[1..]).enumerate() {
            let line = Line {
                along: moved.rotation * next.rotation.column(2),
                point: moved.transform(&next.translation),
            };
            let (along, turn) = simplified_direction(&frame, &line, tolerance);
            let near = line.near(&frame.translation);
            moved = Pose::rotation_about(&near, &turn) * moved;
            let row = row_to(&frame, &Line { along, point: near }, tolerance, k > 0);
            moved.translation += row.shift;
            *link = Link { theta: row.theta, r: row.r, l: row.l, ..twisted(link, row.alpha) };
            let (sin, cos) = row.theta.sin_cos();
            frame = frame * link.pose(cos, sin, row.r);
        }
        *last = Link { theta: 0.0, r: 0.0, l: 0.0, ..twisted(last, 0.0) };
        let offsets = std::array::from_fn(|k| match (original.links.get(k), links.get(k)) {
            (Some(a), Some(b)) => ((a.theta - b.theta).cos(), (a.theta - b.theta).sin(), a.r - b.r),
            _ => (1.0, 0.0, 0.0),
        });
        let flange = frame.inverse() * moved * frames[original.axes()];
        let mut simplified = original.clone();
        simplified.links = links;
        let mut found =
            Self { chain: simplified, from_flange: flange.inverse(), offsets, distance: 0.0, angle: 0.0 };
        (found.distance, found.angle) = found.deviation(&original);
        Some(found)
    }

    /// Converts a pose of the original chain's last frame to the pose of the simplified chain's last frame.
    pub fn flange(&self, original: &Pose) -> Pose {
        *original * self.from_flange
    }

    /// Returns the posture of the original chain with the joint coordinates of a posture of the simplified
    /// chain.
    pub fn original(&self, simplified: &Posture) -> Posture {
        let mut posture = *simplified;
        for (k, (cos, sin, r)) in self.offsets.iter().enumerate() {
            (posture.cos[k], posture.sin[k]) = (
                simplified.cos[k] * cos - simplified.sin[k] * sin,
                simplified.sin[k] * cos + simplified.cos[k] * sin,
            );
            posture.r[k] += r;
        }
        posture
    }

    /// Returns the largest distance (m) and the largest angle (rad) between the flanges of both chains at
    /// sampled postures. For a small angle, the Frobenius norm of the difference of the rotation matrices is
    /// the angle times the root of 2.
    fn deviation(&self, original: &Chain) -> (f64, f64) {
        let (mut distance, mut angle) = (0.0_f64, 0.0_f64);
        for q in (0..SAMPLES).map(|k| original.halton_sample(k)) {
            let wanted = self.flange(&original.frames(&original.posture(&q)).tcp);
            let reached = self.chain.frames(&self.chain.posture(&q)).tcp;
            distance = distance.max((wanted.translation - reached.translation).norm());
            angle = angle.max((wanted.rotation - reached.rotation).norm() / SQRT_2);
        }
        (distance, angle)
    }
}

impl Line {
    /// Returns the point of the line nearest to another point.
    fn near(&self, to: &Vector3<f64>) -> Vector3<f64> {
        self.point + self.along * (to - self.point).dot(&self.along)
    }
}

/// D-H row from a frame to the next axis, where this axis is already shifted by the vector `shift` (m). The
/// shift makes small values of l and r exactly 0.
struct SimpleRow {
    theta: f64,
    r: f64,
    l: f64,
    alpha: f64,
    shift: Vector3<f64>,
}

/// Returns the simplified direction of the axis `line`, and the rotation vector (rad) from the actual to the
/// simplified direction. If `line` is nearly parallel or perpendicular to axis z of `frame`, the simplified
/// direction is exactly parallel or perpendicular.
fn simplified_direction(frame: &Pose, line: &Line, tolerance: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (z, w) = (frame.rotation.column(2).into_owned(), line.along);
    let (cosine, sine) = (w.dot(&z), z.cross(&w).norm());
    let along = if sine < tolerance {
        z * cosine.signum()
    } else if cosine.abs() < tolerance {
        (w - z * cosine).normalize()
    } else {
        w
    };
    (along, least_turn(&w, &along))
}

/// Returns the D-H row from `frame` to the axis `line`.
///
/// A length l below `tolerance` (m) becomes 0. If `simplifies_r` is true, an offset r below `tolerance` (m)
/// becomes 0, too. Between parallel axes, r is always 0.
fn row_to(frame: &Pose, line: &Line, tolerance: f64, simplifies_r: bool) -> SimpleRow {
    let (x, y, z) = (frame.rotation.column(0), frame.rotation.column(1), frame.rotation.column(2));
    let offset = line.point - frame.translation;
    let normal = z.cross(&line.along);
    let sine = normal.norm();
    let (mut r, mut l, normal) = if sine > 0.0 {
        let normal = normal / sine;
        (offset.cross(&line.along).dot(&normal) / sine, offset.dot(&normal), normal)
    } else {
        let beside = offset - z * offset.dot(&z);
        let l = beside.norm();
        (0.0, l, if l < tolerance { x.into_owned() } else { beside / l })
    };
    let mut shift = Vector3::zeros();
    if l.abs() < tolerance {
        shift -= normal * l;
        l = 0.0;
    }
    if simplifies_r && r.abs() < tolerance {
        shift -= z * r;
        r = 0.0;
    }
    let alpha = (-line.along.dot(&z.cross(&normal))).atan2(line.along.dot(&z));
    let right = (alpha / FRAC_PI_2).round() * FRAC_PI_2;
    let alpha = if (alpha - right).abs() < 1e-12 { right } else { alpha };
    SimpleRow { theta: normal.dot(&y).atan2(normal.dot(&x)), r, l, alpha, shift }
}

/// Returns the link with its twist replaced by `alpha` (rad).
fn twisted(link: &Link, alpha: f64) -> Link {
    let (sin_alpha, cos_alpha) = crate::pose::exact_sin_cos(alpha);
    Link { alpha, sin_alpha, cos_alpha, ..*link }
}
