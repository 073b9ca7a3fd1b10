//! Motion of the robot for animations: from home through all spots and back to home.

use crate::assess::Assessment;
use crate::cell::{JointKind, JointVector};
use crate::pose::Pose;
use crate::robot::Chain;

/// Mean speed of the fastest joint during a straight move in joint coordinates, rad/s. The travel of a
/// prismatic joint is divided by the reach of the arm and treated as rad.
///
/// Each move is a cubic function of time, so the peak speed is 1.5 times the mean speed. The limit
/// [`MAX_DURATION`] raises the mean speed of a long move. The duration of a move is rounded up to a multiple
/// of [`TICK`].
const SPEED: f64 = 0.8;
/// Duration of a stop at home or at a spot, s.
const REST: f64 = 0.6;
/// Time between two successive pictures of a move, s.
const TICK: f64 = 0.05;
/// Longest duration of a straight move in joint coordinates, s. Longer moves are shown faster.
const MAX_DURATION: f64 = 6.0;

/// Stop of the animation: a posture in which the robot rests for a moment.
#[derive(Debug, Clone, PartialEq)]
pub struct MovementStop {
    /// Operation at whose spot the robot stops; None at home.
    pub operation: Option<usize>,
    pub joints: JointVector,
    /// Time at which the stop begins, s.
    pub time: f64,
}

/// Motion of the robot as an animation: the stops, and the robot's link frames at each time.
#[derive(Debug, Clone, PartialEq)]
pub struct Movement {
    pub stops: Vec<MovementStop>,
    /// Times of the pictures of the animation, s, in ascending order.
    pub times: Vec<f64>,
    /// Operation whose part the gripper holds at each entry of [`Self::times`]; None if the gripper is
    /// empty.
    pub holding: Vec<Option<usize>>,
    /// Poses of the robot base, of the frame after each joint and of the TCP, in the world frame.
    ///
    /// There is one list of these poses per entry of [`Self::times`].
    pub frames: Vec<Vec<Pose>>,
    /// Whether the moves between the spots were checked for collision.
    pub is_checked: bool,
}

impl Movement {
    /// Returns the motion from home via the spots of a layout and back. The spots follow the order of the
    /// operations. Operations without a spot are left out.
    pub fn new(a: &Assessment<'_>) -> Self {
        let chain = Chain::new(&a.cell.robot);
        let base = a.layout.base.pose();
        let is_checked = !a.evaluation.transfers.is_empty();
        let mut way = MovementBuilder {
            chain: &chain,
            base,
            reach: a.cell.robot.reach(),
            movement: Self::empty(is_checked),
        };
        way.halt(None, &a.cell.robot.home);
        let mut before = None;
        for k in 0..a.maps.len() {
            let Some((_, posture)) = a.spot(k) else { continue };
            let transfer = a.evaluation.transfers.iter().find(|t| t.to == k && t.from < k);
            let path = transfer.map_or(&[][..], |t| &t.path);
            let joints = transfer.map_or(posture.joints, |t| t.arrival);
            way.go(path.iter().chain([&joints]), before);
            way.halt(Some(k), &joints);
            before = Some(k);
        }
        if way.movement.stops.len() > 1 {
            way.go([&a.cell.robot.home].into_iter(), None);
            way.halt(None, &a.cell.robot.home);
        }
        way.movement
    }

    fn empty(is_checked: bool) -> Self {
        Self { stops: Vec::new(), times: Vec::new(), holding: Vec::new(), frames: Vec::new(), is_checked }
    }

    /// Returns the link frames and the TCP frame at home, in the world frame.
    pub fn home(&self) -> &[Pose] {
        self.frames.first().map_or(&[], Vec::as_slice)
    }

    /// Returns the link frames and the TCP frame at the spot of an operation; None if the operation has no
    /// spot.
    pub fn at(&self, operation: usize) -> Option<&[Pose]> {
        let stop = self.stops.iter().find(|s| s.operation == Some(operation))?;
        let k = self.times.iter().position(|t| *t >= stop.time)?;
        self.frames.get(k).map(Vec::as_slice)
    }

    /// Returns the link frames and the TCP frame at the spot of an operation, or at home if there is no spot.
    pub fn frames(&self, operation: Option<usize>) -> &[Pose] {
        operation.and_then(|k| self.at(k)).unwrap_or(self.home())
    }

    /// Returns the duration of the whole motion, s.
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

/// Builder of a [`Movement`] that appends moves and stops.
struct MovementBuilder<'a> {
    chain: &'a Chain,
    base: Pose,
    reach: f64,
    movement: Movement,
}

impl MovementBuilder<'_> {
    fn halt(&mut self, operation: Option<usize>, joints: &JointVector) {
        let time = self.movement.times.last().map_or(0.0, |t| t + TICK);
        self.movement.stops.push(MovementStop { operation, joints: *joints, time });
        self.show(time, joints, operation);
        self.show(time + REST, joints, operation);
    }

    /// Appends straight moves in joint coordinates from the last stop through all `knots`. Each move starts
    /// and ends with zero speed.
    fn go<'j>(&mut self, knots: impl Iterator<Item = &'j JointVector>, holding: Option<usize>) {
        let Some(mut from) = self.movement.stops.last().map(|s| s.joints) else { return };
        for to in knots {
            let start = self.movement.times.last().copied().unwrap_or(0.0);
            let duration = (self.way(&from, to) / SPEED).min(MAX_DURATION);
            let ticks = (duration / TICK).ceil() as usize;
            for k in 1..=ticks {
                let share = k as f64 / ticks as f64;
                let eased = share * share * (3.0 - 2.0 * share);
                let mut joints = from;
                joints.iter_mut().zip(to).for_each(|(q, to)| *q += eased * (to - *q));
                self.show(start + k as f64 * TICK, &joints, holding);
            }
            from = *to;
        }
    }

    /// Returns the largest travel of a joint between two postures, rad. The travel of a prismatic joint is
    /// divided by the reach of the arm and treated as rad.
    fn way(&self, from: &JointVector, to: &JointVector) -> f64 {
        let links = self.chain.links.iter().zip(from.iter().zip(to));
        let gone = links.map(|(link, (a, b))| match link.kind {
            JointKind::Revolute => (b - a).abs(),
            JointKind::Prismatic => (b - a).abs() / self.reach,
        });
        gone.fold(0.0, f64::max)
    }

    fn show(&mut self, time: f64, joints: &JointVector, holding: Option<usize>) {
        let frames = self.chain.frames(&self.chain.posture(joints));
        let links = frames.links[..=self.chain.axes()].iter().enumerate();
        // Frame 0 of the chain may differ from the base frame by a mount. Solids of link 0 are drawn in the
        // base frame.
        let mut world: Vec<Pose> =
            links.map(|(k, link)| if k == 0 { self.base } else { self.base * *link }).collect();
        world.push(self.base * frames.tcp);
        self.movement.times.push(time);
        self.movement.holding.push(holding);
        self.movement.frames.push(world);
    }
}
