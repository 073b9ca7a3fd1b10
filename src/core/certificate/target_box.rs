//! Target box: possible positions of a TCP target relative to the robot base, if equipment and base are
//! misplaced.

use crate::cell::{Cell, Layout, Placement, PlacementTolerance};
use nalgebra::Vector3;

/// Axis of a [`TargetBox`]: a coordinate of the target, or the direction from which the azimuth is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoxAxis {
    /// Coordinate x, y or z of the target in the base frame.
    Position(usize),
    /// Heading: horizontal direction from which the azimuth of the tool is measured. The coordinate is the
    /// angle of this direction about the vertical axis.
    Heading,
}

impl BoxAxis {
    /// Number of axes.
    pub const COUNT: usize = 4;
    /// All axes of a target box.
    pub const ALL: [Self; Self::COUNT] =
        [Self::Position(0), Self::Position(1), Self::Position(2), Self::Heading];
}

/// Box of the deviations of one TCP target from its nominal position and heading, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetBox {
    /// Half widths of the position, m.
    pub position: Vector3<f64>,
    /// Half width of the yaw of the surface, rad.
    pub yaw: f64,
    /// Half width of the heading ([`BoxAxis::Heading`]), rad.
    pub heading: f64,
}

impl TargetBox {
    /// Returns the box of a target on a piece of equipment. `target` is the nominal position of the target in
    /// the world frame, m.
    ///
    /// The position of the target depends on the placements of the equipment, of its carriers and of the
    /// robot base. The half widths are the first-order effects of the placement tolerances, plus a bound of
    /// the second-order effects.
    pub fn new(cell: &Cell, layout: &Layout, equipment: usize, target: &Vector3<f64>) -> Self {
        let mut sum = Self { position: Vector3::zeros(), yaw: 0.0, heading: 0.0 };
        let mut second = SecondOrder::default();
        let mut piece = Some(equipment);
        while let Some(k) = piece {
            let under = cell.equipment[k].on;
            let axes = under.map_or(0.0, |under| layout.placements[under].yaw);
            let body = Body { at: &layout.placements[k], axes, tolerance: &cell.equipment[k].tolerance };
            sum.add(&body, &layout.base, target, &mut second);
            piece = under;
        }
        let body = Body { at: &layout.base, axes: 0.0, tolerance: &cell.base_tolerance };
        sum.add(&body, &layout.base, target, &mut second);
        let slack = second.bound();
        sum.position += Vector3::new(slack, slack, 0.0);
        sum.heading = sum.yaw;
        sum
    }

    /// Adds the tolerance of one body; `target` is in the world frame.
    fn add(&mut self, body: &Body<'_>, base: &Placement, target: &Vector3<f64>, second: &mut SecondOrder) {
        let [x, y, z, yaw] = body.tolerance.0;
        let arm = (target.x - body.at.x, target.y - body.at.y);
        let (sin, cos) = (body.axes - base.yaw).sin_cos();
        let (base_sin, base_cos) = base.yaw.sin_cos();
        // A rotation about the vertical displaces the target across the lever arm.
        let across = (-arm.1 * base_cos + arm.0 * base_sin, arm.1 * base_sin + arm.0 * base_cos);
        self.position += Vector3::new(
            cos.abs() * x + sin.abs() * y + across.0.abs() * yaw,
            sin.abs() * x + cos.abs() * y + across.1.abs() * yaw,
            z,
        );
        self.yaw += yaw;
        second.turned += yaw;
        second.slid += x.hypot(y);
        second.levers = f64::max(second.levers, arm.0.hypot(arm.1));
    }

    /// Returns a copy of this box whose heading has the half width that a radial azimuth needs. The
    /// heading of a radial azimuth is the horizontal direction from the base axis to the target.
    ///
    /// `target` is the nominal position of the target in the base frame, m.
    ///
    /// The half width of the heading is infinite if the box reaches the base axis.
    #[must_use]
    pub fn with_radial_heading(mut self, target: &Vector3<f64>) -> Self {
        let (aside, radius) = (self.position.xy().norm(), target.xy().norm());
        self.heading = if aside < radius { (aside / radius).asin() } else { f64::INFINITY };
        self
    }

    /// Returns the box of a point that is up to `length` (m) from the target and rotates with the surface.
    /// The returned box is larger, because a rotation of the surface also displaces the point relative to the
    /// target.
    #[must_use]
    pub fn extended_by(mut self, length: f64) -> Self {
        let by = self.heading * length;
        self.position += Vector3::new(by, by, 0.0);
        self
    }

    /// Returns the half width along one axis, m or rad.
    pub fn half(&self, axis: BoxAxis) -> f64 {
        match axis {
            BoxAxis::Position(k) => self.position[k],
            BoxAxis::Heading => self.heading,
        }
    }
}

/// Body with a placement tolerance: a piece of equipment or the robot base.
struct Body<'a> {
    /// Placement in the world.
    at: &'a Placement,
    /// Yaw of the axes in which the tolerance is given, world frame, rad.
    axes: f64,
    tolerance: &'a PlacementTolerance,
}

/// Sums that bound the terms of second order.
#[derive(Default)]
struct SecondOrder {
    /// Sum of all yaw tolerances, rad.
    turned: f64,
    /// Sum of all horizontal position tolerances, m.
    slid: f64,
    /// Longest lever arm, m.
    levers: f64,
}

impl SecondOrder {
    /// Returns a bound of the displacement (m) that the first-order terms neglect.
    ///
    /// Successive rotations rotate the lever arms and the translations by at most `turned`.
    fn bound(&self) -> f64 {
        self.turned * (self.turned * self.levers / 2.0 + self.slid) * 2.0
    }
}
