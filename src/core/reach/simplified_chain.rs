//! Copy of a chain whose nearly parallel, perpendicular or intersecting axes are exactly so.
//!
//! The axes are lines while all joint coordinates are 0. They are visited from base to flange. Each axis is
//! rotated and moved by the least amount that makes its angle to the axis before a multiple of a right angle,
//! its common normal vanish, or its common normal meet the one before, where it nearly does so already. All
//! axes behind it and the flange move along. So each simplification changes only one relation of two
//! neighbouring axes, and errors do not accumulate. The rows of the copy follow from its lines (J. Denavit, R.
//! S. Hartenberg, 1955). The rows of the chain would not do: the offsets r of nearly parallel axes can be as
//! long as a kilometre, because the common normal is far away.

use super::numeric::least_turn;
use crate::cell::MAX_JOINTS;
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Number of sampled postures at which the two chains are compared.
const SAMPLES: usize = 24;

/// A chain with simple relations of its axes, and what connects it with the chain that it resembles.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SimplifiedChain {
    /// Rows from frame 0 of the original chain, without mount.
    pub chain: Chain,
    /// Pose of the last frame of the original chain in the last frame of the simplified chain, inverted.
    from_flange: Pose,
    /// Cosine and sine of theta, and r (m), of the original chain at coordinates 0, minus those of the
    /// simplified chain.
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
    /// Simplifies a chain. Angles up to `tolerance` (rad) and lengths up to `tolerance` (m) become 0.
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

    /// Returns the pose of the last frame of the simplified chain for a pose of the last frame of the
    /// original chain.
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

/// Row that leads from a frame to the next axis, and the shift (m) of the axis that makes the row simple.
struct SimpleRow {
    theta: f64,
    r: f64,
    l: f64,
    alpha: f64,
    shift: Vector3<f64>,
}

/// Returns the direction of the next axis, and the rotation vector that leads to it from the direction of
/// `line`. The new direction is parallel or perpendicular to axis z of `frame` if the old one nearly is.
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

/// Returns the row from `frame` to the axis `line`. Its l, and its r if `simplifies_r`, are 0 if they are
/// below `tolerance` (m). Between parallel axes r is 0.
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

/// Returns a link with another twist (rad).
fn twisted(link: &Link, alpha: f64) -> Link {
    let (sin_alpha, cos_alpha) = crate::pose::exact_sin_cos(alpha);
    Link { alpha, sin_alpha, cos_alpha, ..*link }
}
