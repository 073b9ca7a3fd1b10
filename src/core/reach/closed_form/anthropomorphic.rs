//! Closed form of the first three joints of most industrial arms: a yaw axis, then two parallel axes
//! perpendicular to it. The arm may have offsets along its axes and between them.
//!
//! M. Brandstoetter, A. Angerer, M. Hofbaur, "An analytical solution of the inverse kinematics problem of
//! industrial serial manipulators with an ortho-parallel basis and a spherical wrist", 2014.

use super::subproblems::{ALIGNED, Angle, BOUNDARY, TwoLinks, difference};
use crate::cell::JointKind;
use crate::reach::Shell;
use crate::robot::{Link, Posture};
use nalgebra::Vector3;
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// Closed form of the joints up to the wrist centre; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct Anthropomorphic {
    /// Whether [`Self::solve`] returns a lower bound, not the actual distance, for a target out of reach.
    pub fast: bool,
    /// Sine of alpha_1, the D-H twist between axes 1 and 2: 1 or -1.
    side: f64,
    /// Cosine of alpha_2, the D-H twist between axes 2 and 3: 1 or -1.
    flip: f64,
    r1: f64,
    l1: f64,
    /// Coordinate y of the wrist centre in a rotated frame: frame 0 after the rotation by theta_1 about z.
    lateral: f64,
    links: TwoLinks,
    /// Cosine and sine of the angle from axis x of frame 2 to the wrist centre at theta_3 = 0.
    ///
    /// The angle is positive about axis 2, and its vertex is on axis 3.
    forearm: Angle,
}

impl Anthropomorphic {
    /// Returns the closed form of the first three D-H rows; None if the joints have another geometry.
    ///
    /// `tip` is the wrist centre, m, in a rotated frame: frame 2 after the rotation by theta_3 about z.
    pub fn new([a, b, c]: &[Link; 3], tip: &Vector3<f64>) -> Option<Self> {
        let turning = [a, b, c].iter().all(|l| l.kind == JointKind::Revolute);
        let forearm = tip.x.hypot(tip.y);
        let lengths = b.l.abs() > 1e-6 && forearm > 1e-6;
        if !turning || !lengths || a.cos_alpha.abs() > 1e-15 || b.sin_alpha.abs() > 1e-15 {
            return None;
        }
        let (side, flip) = (a.sin_alpha.signum(), b.cos_alpha.signum());
        Some(Self {
            fast: false,
            side,
            flip,
            r1: a.r,
            l1: a.l,
            lateral: -side * (b.r + flip * tip.z),
            links: TwoLinks::new(b.l, forearm),
            forearm: (tip.x / forearm, flip * tip.y / forearm),
        })
    }

    /// Calls `found` with every solution (branch index, theta_1 to theta_3) for the wrist centre `p`.
    ///
    /// `p` is in frame 0, m. Bit 0 of the branch index distinguishes the two elbow solutions. Bit 1 is set if
    /// the arm leans back over its base. If the wrist centre lies on axis 1, theta_1 is free and is set to 0.
    ///
    /// Returns the distance from `p` to the nearest reachable point, m; 0 if there is a solution. If `fast`
    /// is set, the function returns a lower bound of the distance.
    #[inline]
    pub fn solve(
        &self,
        p: &Vector3<f64>,
        posture: &mut Posture,
        found: &mut impl FnMut(u8, &mut Posture),
    ) -> f64 {
        let radius2 = p.x * p.x + p.y * p.y;
        let along2 = radius2 - self.lateral * self.lateral;
        let on_axis = radius2 < ALIGNED * ALIGNED;
        let mut any = false;
        if along2 >= 0.0 || self.lateral.abs() - radius2.sqrt() < BOUNDARY {
            let along2 = along2.max(0.0);
            let per = 1.0 / (radius2 * (along2 + self.lateral * self.lateral)).sqrt();
            let along = along2.sqrt();
            for (back, s) in [(0, along), (2, -along)] {
                let elbows = self.links.solve(s - self.l1, self.side * (p.z - self.r1));
                let (false, Ok(elbows)) = (on_axis && back > 0, elbows) else { continue };
                any = true;
                (posture.cos[0], posture.sin[0]) = match on_axis {
                    true => (1.0, 0.0),
                    false => ((p.x * s + p.y * self.lateral) * per, (p.y * s - p.x * self.lateral) * per),
                };
                for (elbow, (second, third)) in (0..).zip(elbows) {
                    let third = difference(third, self.forearm);
                    (posture.cos[1], posture.sin[1]) = second;
                    (posture.cos[2], posture.sin[2]) = (third.0, self.flip * third.1);
                    found(back | elbow, posture);
                }
            }
        }
        match (any, self.fast) {
            (true, _) => 0.0,
            (false, true) => self.bound(p).max(LEAST_BOUND),
            (false, false) => self.missing(radius2.sqrt(), self.side * (p.z - self.r1)),
        }
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns for a target in frame 0.
    ///
    /// All reachable points are between two spheres about the origin of frame 1, and outside a cylinder about
    /// axis 1.
    pub fn bound(&self, p: &Vector3<f64>) -> f64 {
        let Shell { inner, outer, .. } = self.shell();
        let radius2 = p.x * p.x + p.y * p.y;
        let distance = (radius2 + (p.z - self.r1).powi(2)).sqrt();
        let beside = self.lateral.abs() - radius2.sqrt();
        (distance - outer).max(inner - distance).max(beside) - BOUNDARY
    }

    /// Returns a shell in frame 0 that contains all reachable points.
    pub fn shell(&self) -> Shell {
        let (least, most) = self.links.range();
        Shell {
            centre: Vector3::new(0.0, 0.0, self.r1),
            inner: (least - self.l1.abs()).max(0.0).hypot(self.lateral),
            outer: (most + self.l1.abs()).hypot(self.lateral),
        }
    }

    /// Returns the distance (m) from a target to the nearest point that the arm reaches.
    ///
    /// `radius` is the distance of the target from axis 1. `height` is the height of the target above the
    /// origin of frame 1, negated if alpha_1 is -90 degrees.
    ///
    /// In the plane of the arm, the wrist centre is between two circles. The nearest point is on one of these
    /// circles, or at the least possible distance from axis 1. The inner circle matters only for a target
    /// inside it.
    fn missing(&self, radius: f64, height: f64) -> f64 {
        let (least, most) = self.links.range();
        if self.lateral == 0.0 {
            // The plane of the arm contains axis 1, so it also contains the target.
            let in_plane = |s: f64| {
                let distance = (s - self.l1).hypot(height);
                (distance - distance.clamp(least, most)).abs()
            };
            return in_plane(radius).min(in_plane(-radius));
        }
        let (low, high) =
            ((least * least - self.l1 * self.l1).max(0.0).sqrt(), (most * most - self.l1 * self.l1).sqrt());
        let beside = match high.is_nan() {
            true => f64::INFINITY,
            false => (self.lateral.abs() - radius).hypot(height.abs() - height.abs().clamp(low, high)),
        };
        let along2 = radius * radius - self.lateral * self.lateral;
        let is_inside = |s: f64| (s - self.l1).hypot(height) <= least;
        let asks_inner = along2 < 0.0 || is_inside(along2.sqrt()) || is_inside(-along2.sqrt());
        let outer = beside.min(self.distance_from_circle(most, radius, height));
        if asks_inner { outer.min(self.distance_from_circle(least, radius, height)) } else { outer }
    }

    /// Returns the distance (m) from a target to the nearest position of the wrist centre. Only positions at
    /// the distance `size` (m) from axis 2 count.
    ///
    /// A scan over the angle about axis 2 brackets the local minima, and Newton's method refines each of
    /// them. A bracket always contains a minimum, because the derivative has different signs at its ends.
    fn distance_from_circle(&self, size: f64, radius: f64, height: f64) -> f64 {
        const MAX_STEPS: usize = 60;
        // Components of the distance from the target, then the first and second derivative of half the
        // squared distance with respect to the angle.
        let at = |(c, s): (f64, f64)| {
            let (u, du, up) = (self.l1 + size * c, -size * s, size * s - height);
            let r = (u * u + self.lateral * self.lateral).sqrt().max(f64::MIN_POSITIVE);
            let dr = u * du / r;
            let ddr = (du * du - u * size * c - dr * dr) / r;
            let slope = (r - radius) * dr + up * size * c;
            let curve = dr * dr + (r - radius) * ddr + size * size * c * c - up * size * s;
            (r - radius, up, slope, curve)
        };
        let (mut least, mut falls) = (f64::INFINITY, at(DIRECTIONS[0]).2 < 0.0);
        for k in 1..DIRECTIONS.len() {
            let fell = std::mem::replace(&mut falls, at(DIRECTIONS[k]).2 < 0.0);
            if !fell || falls {
                continue;
            }
            let (mut from, mut to) = (angle(k - 1), angle(k));
            let mut x = (from + to) / 2.0;
            for _ in 0..MAX_STEPS {
                let (s, c) = x.sin_cos();
                let (aside, up, slope, curve) = at((c, s));
                least = least.min(aside.hypot(up));
                (from, to) = if slope < 0.0 { (x, to) } else { (from, x) };
                let next = x - slope / curve;
                let next = if next > from && next < to { next } else { (from + to) / 2.0 };
                if (next - x).abs() < 1e-13 {
                    break;
                }
                x = next;
            }
        }
        least
    }
}

/// Number of directions that [`Anthropomorphic::distance_from_circle`] scans for local minima.
const ANGLES: usize = 32;

/// Cosine and sine of each scanned direction; the first direction is repeated at the end.
static DIRECTIONS: LazyLock<[(f64, f64); ANGLES + 1]> =
    LazyLock::new(|| std::array::from_fn(|k| (angle(k).cos(), angle(k).sin())));

/// Returns the angle of the direction with index `k`, rad.
fn angle(k: usize) -> f64 {
    TAU * k as f64 / ANGLES as f64
}

/// Smallest value, m, that [`Anthropomorphic::solve`] returns for an unreachable target if `fast` is set.
const LEAST_BOUND: f64 = 1e-12;
