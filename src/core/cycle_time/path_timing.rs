//! Time-optimal path parameterization: the least time along a given path under limits of the joints.
//!
//! The path q(s) is given, and s(t) is chosen. Let x be (ds/dt)^2 and u be d2s/dt2. The limits of joint j are
//! then linear in x and u,
//!
//! ```text
//! q_j'^2 x <= v_j^2,        |q_j' u + q_j'' x| <= a_j,
//! ```
//!
//! and along a step h of s, x grows by 2 h u (J. E. Bobrow, S. Dubowsky, J. S. Gibson, "Time-optimal control
//! of robotic manipulators along specified paths", IJRR 4(3), 1985). At every sample, a backward pass
//! computes the greatest x from which the end can be reached at rest. A forward pass then accelerates as much
//! as these bounds allow (reachability analysis: H. Pham, Q.-C. Pham, "A new approach to time-optimal path
//! parameterization based on reachability analysis", IEEE Transactions on Robotics 34(3), 2018). Each bound
//! is a linear program in two variables, which is solved exactly by considering pairs of its constraints.

use super::rate_bounds::RateBounds;
use super::spline::JointSpline;
use crate::cell::{JointVector, MAX_JOINTS};

/// Number of steps into which a path is divided.
const STEPS: usize = 128;

/// Bounds of u = d2s/dt2 at one sample of the path.
///
/// The bounds are `-room - slope x <= u <= room - slope x`, where x is the square of ds/dt.
#[derive(Clone, Copy)]
struct Band {
    slope: f64,
    room: f64,
}

/// Limits at one sample of the path.
struct SampleLimits {
    bands: [Band; MAX_JOINTS],
    count: usize,
    /// Greatest x = (ds/dt)^2 that the speed limits permit. This x also satisfies the acceleration limit of
    /// every joint j with `q_j' = 0`.
    most: f64,
}

impl SampleLimits {
    fn new((first, second): &(JointVector, JointVector), bounds: &RateBounds, speed: f64) -> Self {
        let mut limits =
            Self { bands: [Band { slope: 0.0, room: 0.0 }; MAX_JOINTS], count: 0, most: speed * speed };
        for j in (0..MAX_JOINTS).filter(|&j| bounds.velocity[j].is_finite()) {
            let rate = bounds.velocity[j] / first[j].abs();
            limits.most = limits.most.min(rate * rate);
            if first[j] != 0.0 {
                let band =
                    Band { slope: second[j] / first[j], room: bounds.acceleration[j] / first[j].abs() };
                limits.bands[limits.count] = band;
                limits.count += 1;
            } else if second[j] != 0.0 {
                limits.most = limits.most.min(bounds.acceleration[j] / second[j].abs());
            }
        }
        limits
    }

    fn bands(&self) -> &[Band] {
        &self.bands[..self.count]
    }

    /// Returns the greatest (ds/dt)^2 at this sample from which (ds/dt)^2 <= `next` is reachable at the next
    /// sample.
    ///
    /// From this sample to the next sample, s grows by `step`.
    fn controllable(&self, step: f64, next: f64) -> f64 {
        let own = 1.0 / (2.0 * step);
        let mut most = self.most;
        // A lower and an upper bound of u are consistent if `rise x <= room`. If `rise` is positive, x is at
        // most `room / rise`.
        let mut limit = |rise: f64, room: f64| {
            if rise > 0.0 {
                most = most.min(room / rise);
            }
        };
        for low in self.bands() {
            for high in self.bands() {
                limit(high.slope - low.slope, low.room + high.room);
            }
            limit(own - low.slope, low.room + next * own);
            limit(low.slope - own, low.room);
        }
        most
    }

    /// Returns the greatest (ds/dt)^2 that can be reached from the value `x` while s grows by `step`.
    fn accelerated(&self, x: f64, step: f64) -> f64 {
        let most = self.bands().iter().map(|band| band.room - band.slope * x).fold(f64::INFINITY, f64::min);
        (x + 2.0 * step * most).max(0.0)
    }
}

/// Returns the least time, s, along a path from rest to rest.
///
/// `at` holds the length of the path up to each joint vector, m. `speed` is the maximum speed along the path,
/// m/s.
///
/// Between the joint vectors, the path is a cubic spline. The path is divided into 128 steps, so the result
/// exceeds the exact least time by up to 1 %. This excess is largest if the ramps at the ends are shorter
/// than a step.
pub(super) fn path_time(at: Vec<f64>, values: Vec<JointVector>, bounds: &RateBounds, speed: f64) -> f64 {
    let spline = JointSpline::new(at, values);
    let step = spline.end() / STEPS as f64;
    let limits: Vec<SampleLimits> =
        (0..=STEPS).map(|k| SampleLimits::new(&spline.derivatives(k as f64 * step), bounds, speed)).collect();
    // Greatest x from which the end of the path can be reached at rest.
    let mut most = vec![0.0; STEPS + 1];
    for k in (0..STEPS).rev() {
        most[k] = limits[k].controllable(step, most[k + 1]);
    }
    let (mut x, mut time) = (0.0_f64, 0.0);
    for k in 0..STEPS {
        let next = limits[k].accelerated(x, step).min(most[k + 1]);
        time += 2.0 * step / (x.sqrt() + next.sqrt());
        x = next;
    }
    time
}
