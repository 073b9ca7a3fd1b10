//! Conversion of joint axes to standard Denavit-Hartenberg rows (Denavit and Hartenberg 1955).
//!
//! The joint axes are fixed lines while all joint coordinates are 0. Row k has the angle theta, the axial
//! offset r, the common normal l and the twist alpha. The row leads from a frame with z along axis k to
//! a frame with z along the next axis. The x axis of the second frame lies along the common normal of
//! the two axes. If this definition leaves a choice, the following rules apply:
//!
//! - frame 0: its origin is the point of axis 1 nearest to the origin of the base. If axis 2 is parallel to
//!   axis 1, the origin of frame 0 is the origin of joint 1 instead. The x axis of frame 0 is
//!   the projection of the base x axis onto the plane perpendicular to axis 1. If axis 1 is within 26 degrees
//!   of the base x axis, the base y axis is projected instead;
//! - parallel axes: r = 0. If the two axes lie on the same line, theta and l are also 0;
//! - direction of x: a row rotates x by at most a right angle. So l may be negative, as in many data sheets.
//!   If the rotation is a right angle, l > 0. If the axes also intersect (l = 0), theta = +90 degrees;
//! - the last row leads from the last joint axis to the z axis of the tip link. If the two axes are parallel,
//!   this row ends at the origin of the tip link. If they are almost but not exactly parallel, the row is
//!   empty: theta = r = l = alpha = 0. [`Derived::tip`] is then the pose of the tip link in the frame of the
//!   last joint axis.

use crate::cell::JointKind;
use crate::low_discrepancy::richtmyer_steps;
use crate::pose::Pose;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Moving joint at coordinate 0.
///
/// `origin` is the frame of the joint in the frame of the joint before it. `direction` is a unit vector along
/// the joint axis, in the frame of the joint.
pub struct Axis {
    pub kind: JointKind,
    pub origin: Pose,
    pub direction: Vector3<f64>,
}

/// One D-H row, rad and m, with the symbols of [`crate::cell::Joint`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UrdfDhRow {
    pub theta: f64,
    pub r: f64,
    pub l: f64,
    pub alpha: f64,
}

pub struct Derived {
    /// Pose of frame 0 in the base link.
    pub mount: Pose,
    pub rows: Vec<UrdfDhRow>,
    /// Pose of the tip link in the last frame.
    pub tip: Pose,
    /// Frames 0 to n in the base link with all coordinates at 0.
    pub frames: Vec<Pose>,
    /// Frame of joint k in frame k - 1.
    pub joint_frames: Vec<Pose>,
    /// Largest difference, m, between the tip poses of the rows and of the URDF over sampled postures. The
    /// Frobenius norm of the difference of the rotation matrices counts as a length in m. A rotation by a
    /// small angle counts as 1.4 m per rad.
    pub gap: f64,
}

/// The rows count as an exact copy of the URDF if [`Derived::gap`] is below this value, m.
pub const MAX_EXACT_GAP: f64 = 1e-12;

/// Largest deviation, rad or m, at which a value is rounded to a multiple of a right angle or to 0.
const MAX_ROUNDING: f64 = 1e-9;

/// Shortest common normal, m, that defines a direction.
const SHORTEST: f64 = 1e-13;

/// Angles, rad, below which two axes count as parallel. The angles are tried in this order until the rows are
/// exact.
const PARALLEL: [f64; 9] = [1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6];

/// Least sine of the angle between two slanted axes that the last row connects. The two axes are the last
/// joint axis and the z axis of the tip link. If the sine is smaller but the axes are not parallel, all
/// values of the last row are 0.
const SLANTED: f64 = 0.01;

/// Number of postures at which rows and URDF are compared.
const POSTURES: usize = 24;

/// Returns the D-H rows of a chain. `flange` is the pose of the tip link in the frame of the last joint.
pub fn derive(axes: &[Axis], flange: &Pose) -> Derived {
    let model = ArmModel { axes, flange };
    let mut best: Option<Derived> = None;
    for parallel in PARALLEL {
        let derived = model.rows(parallel);
        let better = best.as_ref().is_none_or(|b| derived.gap < b.gap);
        let done = derived.gap < MAX_EXACT_GAP;
        best = if better { Some(derived) } else { best };
        if done {
            break;
        }
    }
    model.rounded(best.unwrap_or_else(|| model.rows(MAX_ROUNDING)))
}

/// Returns the angle between two axes, in [0, pi/2], rad. A reversed axis gives the same angle.
pub fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b).abs())
}

/// Returns the directions of the axes in the base link with all coordinates at 0.
pub fn directions(axes: &[Axis]) -> Vec<Vector3<f64>> {
    joint_poses(axes).iter().zip(axes).map(|(pose, axis)| pose.rotation * axis.direction).collect()
}

/// Returns the frames of the joints in the base link with all coordinates at 0.
pub fn joint_poses(axes: &[Axis]) -> Vec<Pose> {
    let step = |t: &mut Pose, axis: &Axis| {
        *t = *t * axis.origin;
        Some(*t)
    };
    axes.iter().scan(Pose::identity(), step).collect()
}

struct ArmModel<'a> {
    axes: &'a [Axis],
    flange: &'a Pose,
}

impl ArmModel<'_> {
    fn rows(&self, parallel: f64) -> Derived {
        let poses = joint_poses(self.axes);
        let directions = directions(self.axes);
        let mut mount = first_frame(&directions[0], &poses[0].translation);
        // The axes of a SCARA are parallel. Their frames then lie at the height of the arm, not of the base
        // link.
        if directions.get(1).is_some_and(|second| angle(&directions[0], second) <= parallel) {
            mount.translation = poses[0].translation;
        }
        let mut frame = mount;
        let mut rows = Vec::new();
        for k in 0..self.axes.len() {
            let local = frame.inverse();
            let row = match poses.get(k + 1) {
                Some(next) => between(
                    &(local.rotation * directions[k + 1]),
                    &local.transform(&next.translation),
                    parallel,
                ),
                None => last(&(local * self.tip())),
            };
            frame = frame * pose_of(&row, 0.0, 0.0);
            rows.push(row);
        }
        self.derived(mount, rows)
    }

    /// Returns the pose of the tip link in the base link with all coordinates at 0.
    fn tip(&self) -> Pose {
        joint_poses(self.axes).last().map_or(*self.flange, |last| *last * *self.flange)
    }

    /// Computes frames, tip and gap from the mount and the rows.
    fn derived(&self, mount: Pose, rows: Vec<UrdfDhRow>) -> Derived {
        let mut frames = vec![mount];
        for row in &rows {
            frames.push(frames[frames.len() - 1] * pose_of(row, 0.0, 0.0));
        }
        let tip = tidy(frames[frames.len() - 1].inverse() * self.tip());
        let inside = |(frame, joint): (&Pose, Pose)| tidy(frame.inverse() * joint);
        let joint_frames = frames.iter().zip(joint_poses(self.axes)).map(inside).collect();
        let mut derived = Derived { mount, rows, tip, frames, joint_frames, gap: 0.0 };
        derived.gap = self.gap(&derived);
        derived
    }

    /// Rounds lengths near 0 to 0, and angles near a multiple of a right angle to that multiple. Rounding is
    /// kept only if the new gap is below [`MAX_EXACT_GAP`] or below the old gap.
    fn rounded(&self, derived: Derived) -> Derived {
        let mut best = self.derived(tidy(derived.mount), derived.rows);
        for k in 0..best.rows.len() {
            let numbers: [fn(&mut UrdfDhRow); 4] = [
                |row| row.theta = right_angle(row.theta),
                |row| row.r = zero(row.r),
                |row| row.l = zero(row.l),
                |row| row.alpha = right_angle(row.alpha),
            ];
            for round in numbers {
                let mut rows = best.rows.clone();
                round(&mut rows[k]);
                if rows[k] != best.rows[k] {
                    let tried = self.derived(best.mount, rows);
                    best = if tried.gap < MAX_EXACT_GAP.max(best.gap) { tried } else { best };
                }
            }
        }
        best
    }

    fn gap(&self, derived: &Derived) -> f64 {
        let gaps = (0..POSTURES).map(|i| {
            let (mut urdf, mut rows) = (Pose::identity(), derived.mount);
            for ((axis, row), step) in self.axes.iter().zip(&derived.rows).zip(richtmyer_steps()) {
                let share = 2.0 * ((i + 1) as f64 * step).fract() - 1.0;
                let q = share * if axis.kind == JointKind::Revolute { PI } else { 1.0 };
                urdf = urdf * axis.origin * moved(axis, q);
                rows = rows
                    * match axis.kind {
                        JointKind::Revolute => pose_of(row, q, 0.0),
                        JointKind::Prismatic => pose_of(row, 0.0, q),
                    };
            }
            let (urdf, rows) = (urdf * *self.flange, rows * derived.tip);
            let turn = (urdf.rotation - rows.rotation).norm();
            (urdf.translation - rows.translation).norm().max(turn)
        });
        // `f64::max` would ignore a NaN.
        gaps.fold(0.0, |most, gap| if gap > most || gap.is_nan() { gap } else { most })
    }
}

/// Returns the displacement of a joint at the coordinate `q`, in the frame of the joint.
fn moved(axis: &Axis, q: f64) -> Pose {
    match axis.kind {
        JointKind::Revolute => {
            let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(axis.direction), q);
            Pose { rotation: turn.into_inner(), translation: Vector3::zeros() }
        }
        JointKind::Prismatic => Pose { translation: axis.direction * q, ..Pose::identity() },
    }
}

/// Returns the transform of a row: `Rz(theta + turn) Tz(r + slide) Tx(l) Rx(alpha)`, where R rotates about an
/// axis and T translates along an axis. The coordinate of the joint is `turn` (rad) if the joint is revolute,
/// `slide` (m) if it is prismatic.
fn pose_of(row: &UrdfDhRow, turn: f64, slide: f64) -> Pose {
    let (s, c) = (row.theta + turn).sin_cos();
    let (sa, ca) = exact(row.alpha);
    let rotation = Matrix3::new(c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca);
    Pose { rotation, translation: Vector3::new(row.l * c, row.l * s, row.r + slide) }
}

/// Returns sine and cosine of an angle. Magnitudes below 1e-15 become 0. The kinematic chain treats its
/// twists in the same way.
fn exact(angle: f64) -> (f64, f64) {
    let zero = |v: f64| if v.abs() < 1e-15 { 0.0 } else { v };
    (zero(angle.sin()), zero(angle.cos()))
}

fn first_frame(z: &Vector3<f64>, point: &Vector3<f64>) -> Pose {
    let towards = if z.x.abs() > 0.9 { Vector3::y() } else { Vector3::x() };
    let x = (towards - z * z.dot(&towards)).normalize();
    Pose { rotation: Matrix3::from_columns(&[x, z.cross(&x), *z]), translation: point - z * z.dot(point) }
}

/// Returns the D-H row that leads to the axis through `p` along the unit vector `d`; `p` and `d` are in the
/// frame before the row. The axis counts as parallel to z if the sine of its angle to z is at most
/// `parallel`.
fn between(d: &Vector3<f64>, p: &Vector3<f64>, parallel: f64) -> UrdfDhRow {
    let s = d.x.hypot(d.y);
    if s <= parallel {
        let (x, y) = (p.x - d.x * p.z / d.z, p.y - d.y * p.z / d.z);
        return beside(d.z, (x, y), 0.0, (1.0, 0.0));
    }
    let normal = Vector3::new(-d.y / s, d.x / s, 0.0);
    // Offset along z to the foot of the common normal.
    let r = p.cross(d).dot(&normal) / s;
    in_sense(r, p.dot(&normal), s.atan2(d.z), (normal.x, normal.y))
}

/// Returns the D-H row that leads to an axis parallel to z through `(x, y)`, with the axial offset `r`.
///
/// The axis points along -z if `up` is negative. If the axis is the z axis itself, `along` is the x axis of
/// the new frame.
fn beside(up: f64, (x, y): (f64, f64), r: f64, along: (f64, f64)) -> UrdfDhRow {
    let alpha = if up < 0.0 { PI } else { 0.0 };
    let l = x.hypot(y);
    if l <= SHORTEST {
        return UrdfDhRow { theta: along.1.atan2(along.0), r, l: 0.0, alpha };
    }
    in_sense(r, l, alpha, (x / l, y / l))
}

/// Returns a D-H row with the axial offset `r`, the common normal `l` and the twist `alpha`.
///
/// `(x, y)` is the direction of the new x axis in the frame before the row. If the row would rotate x by more
/// than a right angle, the new x axis, `l` and `alpha` are reversed. The module documentation gives the rule
/// for right angles.
fn in_sense(r: f64, l: f64, alpha: f64, (x, y): (f64, f64)) -> UrdfDhRow {
    let square = x.abs() <= MAX_ROUNDING;
    let turn_round = if !square {
        x < 0.0
    } else if l.abs() > MAX_ROUNDING {
        l < 0.0
    } else {
        y < 0.0
    };
    let (l, alpha, x, y) = if turn_round { (-l, -alpha, -x, -y) } else { (l, alpha, x, y) };
    UrdfDhRow { theta: y.atan2(x), r, l, alpha: if alpha == -PI { PI } else { alpha } }
}

/// Returns the D-H row after the last joint axis. `tip` is the pose of the tip link in the frame before the
/// row.
fn last(tip: &Pose) -> UrdfDhRow {
    let (x, d, p) = (tip.rotation.column(0), tip.rotation.column(2).into_owned(), tip.translation);
    let s = d.x.hypot(d.y);
    if s <= MAX_ROUNDING {
        beside(d.z, (p.x, p.y), p.z, (x[0], x[1]))
    } else if s < SLANTED {
        UrdfDhRow::default()
    } else {
        between(&d, &p, 0.0)
    }
}

/// Rounds entries of a pose that differ from 0, 1 or -1 only by rounding errors.
fn tidy(pose: Pose) -> Pose {
    let near = |v: f64| if (v - v.round()).abs() < 1e-14 { v.round() + 0.0 } else { v };
    let zero = |v: f64| if v.abs() < 1e-14 { 0.0 } else { v };
    Pose { rotation: pose.rotation.map(near), translation: pose.translation.map(zero) }
}

fn right_angle(angle: f64) -> f64 {
    let exact = (angle / FRAC_PI_2).round() * FRAC_PI_2 + 0.0;
    if (angle - exact).abs() < MAX_ROUNDING { exact } else { angle }
}

fn zero(length: f64) -> f64 {
    if length.abs() < MAX_ROUNDING { 0.0 } else { length }
}
