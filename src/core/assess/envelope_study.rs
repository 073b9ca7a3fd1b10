//! Working envelope of an arm (sections and dimensions), and the data sheet of a robot.

use crate::cell::{Attitude, Operation, Robot};
use crate::pose::Pose;
use crate::reach::{Cost, Envelope, EnvelopeSection, Fineness, Inverse, Size};
use crate::robot::Chain;
use crate::units::m_from_mm;
use nalgebra::Vector3;

/// Working envelope in the base frame of the robot, m.
pub struct Reachable<'a> {
    pub robot: &'a Robot,
    /// Operation for whose tool attitude the envelope is computed; None if the attitude was given directly.
    pub operation: Option<&'a Operation>,
    pub family: &'static str,
    pub attitude: Attitude,
    /// Distance between sampled points, m.
    pub step: f64,
    /// Azimuth of the vertical section, rad.
    pub azimuth: f64,
    /// Vertical section through the base axis, with points (r, z), m. The distance r from the axis is
    /// negative on the side opposite to [`Self::azimuth`].
    pub section: EnvelopeSection,
    /// Horizontal sections, each with its height (m) and its points (x, y), m.
    pub plans: Vec<(f64, EnvelopeSection)>,
    pub size: Size,
    /// Points of the arm in a posture near its greatest reach, base frame, m. The points are the base, the
    /// origins of the link frames and the TCP.
    pub arm: Vec<Vector3<f64>>,
}

/// Request for a working envelope: attitude, sections and resolution.
pub struct EnvelopeQuery<'a> {
    pub operation: Option<&'a Operation>,
    pub attitude: Attitude,
    /// Yaw of the work surface in the base frame, rad; azimuths of the attitude are measured from the x axis
    /// of the surface.
    pub yaw: f64,
    /// Heights of the horizontal sections, m. If the list is empty, there is a single section, at the height
    /// of the greatest reach.
    pub heights: Vec<f64>,
    /// Distance between sampled points, m. If it is None, [`step_of`] determines the distance.
    pub step: Option<f64>,
}

impl EnvelopeQuery<'_> {
    fn step(&self, robot: &Robot, inverse: &Inverse) -> f64 {
        self.step.unwrap_or_else(|| step_of(robot, inverse))
    }

    /// Returns the number of points that are sampled for the envelope. The points that refine a boundary by
    /// bisection are not included.
    pub fn work(&self, robot: &Robot, inverse: &Inverse) -> u64 {
        let envelope = Envelope::new(inverse, &self.attitude, self.yaw);
        // The height of the section is not known yet; the section at height 0 is counted instead.
        let heights = if self.heights.is_empty() { &[0.0][..] } else { &self.heights };
        envelope.work(1, heights, true, self.step(robot, inverse))
    }
}

impl<'a> Reachable<'a> {
    /// Computes an envelope. `progress` receives the number of points sampled so far and the total number
    /// of points.
    pub fn new(
        robot: &'a Robot,
        inverse: &Inverse,
        asked: EnvelopeQuery<'a>,
        progress: &(dyn Fn(u64, u64) + Sync),
    ) -> Self {
        let envelope = Envelope::new(inverse, &asked.attitude, asked.yaw);
        let (step, work) = (asked.step(robot, inverse), asked.work(robot, inverse));
        let told = |count: u64| progress(count, work);
        let fine = Fineness { step, tolerance: tolerance_of(inverse, step), on_progress: &told };
        let size = envelope.size(&fine);
        let azimuth = envelope.middle();
        let section = envelope.section(azimuth, &fine);
        let mut heights = asked.heights;
        if heights.is_empty() {
            heights.extend(size.extent.map(|extent| extent.widest));
        }
        let plans = heights.into_iter().map(|z| (z, envelope.plan(z, &fine))).collect();
        let arm = drawn_arm(&envelope, inverse, &size, azimuth);
        let (family, attitude) = (inverse.family(), asked.attitude);
        let operation = asked.operation;
        Self { robot, operation, family, attitude, step, azimuth, section, plans, size, arm }
    }
}

/// Returns points of the arm in a posture near the greatest reach, base frame, m. The points are the base,
/// the origins of the link frames and the TCP.
///
/// The TCP is in the vertical section.
///
/// The list is empty if the arm reaches none of the points that are tried.
fn drawn_arm(envelope: &Envelope<'_>, inverse: &Inverse, size: &Size, azimuth: f64) -> Vec<Vector3<f64>> {
    let Some(extent) = &size.extent else { return Vec::new() };
    let far = [0.9, 0.8, 0.7, 0.6].map(|share| {
        let r = extent.radius.0 + share * (extent.radius.1 - extent.radius.0);
        envelope.posture(&Vector3::new(r * azimuth.cos(), r * azimuth.sin(), extent.widest))
    });
    let Some(posture) = far.into_iter().flatten().next() else { return Vec::new() };
    let chain = inverse.chain();
    let frames = chain.frames(&posture);
    let links = frames.links[..=chain.axes()].iter().chain([&frames.tcp]);
    let mut arm = vec![Vector3::zeros()];
    arm.extend(links.map(|pose| pose.translation));
    arm.dedup_by(|b, a| (*b - *a).norm() < 1e-6);
    arm
}

/// Returns a distance between sampled points, m, for which the envelope takes about a second to compute.
pub fn step_of(robot: &Robot, inverse: &Inverse) -> f64 {
    let parts = match inverse.cost() {
        Cost::Low => 200.0,
        Cost::Middle => 60.0,
        Cost::High => 20.0,
        Cost::Numeric => 10.0,
    };
    let steps = [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0].map(m_from_mm);
    let wanted = robot.reach() / parts;
    steps.into_iter().find(|step| *step >= wanted).unwrap_or(wanted)
}

/// Returns the tolerance with which a boundary of the envelope is located, m.
///
/// The tolerance is 0.1 mm, or a twentieth of `step` if the inverse kinematics is expensive.
pub fn tolerance_of(inverse: &Inverse, step: f64) -> f64 {
    match inverse.cost() {
        Cost::Low | Cost::Middle => m_from_mm(0.1),
        Cost::High | Cost::Numeric => step / 20.0,
    }
}

/// Data sheet of a robot alone, without a cell: home pose and size of the working envelope.
pub struct RobotDataSheet<'a> {
    pub robot: &'a Robot,
    pub family: &'static str,
    /// Pose of the TCP at the home position.
    pub pose: Pose,
    /// Working envelope; None if the inverse kinematics is slow ([`Cost::High`] or [`Cost::Numeric`]). The
    /// computation of such an envelope would take many seconds.
    pub envelope: Option<SheetEnvelope>,
}

/// Working envelope on the data sheet of a robot.
pub struct SheetEnvelope {
    /// Elevation of the tool axis for which the envelope is computed, rad. Some arms hold the tool axis at
    /// one elevation in every posture, and the envelope uses this elevation. For any other arm, the tool axis
    /// points straight down.
    pub elevation: f64,
    pub size: Size,
    /// Distance between sampled points, m.
    pub step: f64,
}

impl<'a> RobotDataSheet<'a> {
    /// Computes the data sheet of a robot.
    pub fn new(robot: &'a Robot) -> Self {
        let chain = Chain::new(robot);
        let inverse = Inverse::new(&chain);
        let envelope = match inverse.cost() {
            Cost::Low | Cost::Middle => Some(SheetEnvelope::new(robot, &inverse)),
            Cost::High | Cost::Numeric => None,
        };
        let pose = chain.forward(&chain.posture(&robot.home));
        Self { robot, family: inverse.family(), pose, envelope }
    }
}

impl SheetEnvelope {
    fn new(robot: &Robot, inverse: &Inverse) -> Self {
        let elevation = inverse.fixed_elevation().unwrap_or(-std::f64::consts::FRAC_PI_2);
        let attitude = Attitude::elevation(elevation);
        let step = step_of(robot, inverse);
        let fine = Fineness { step, tolerance: tolerance_of(inverse, step), on_progress: &|_| () };
        Self { elevation, size: Envelope::new(inverse, &attitude, 0.0).size(&fine), step }
    }
}
