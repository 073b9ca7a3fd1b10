//! Assumptions: values for the quantities that a cell file leaves out, chosen so that the layout can be
//! built.

use super::choices::Assumption;
use super::coordinate::Coordinate;
use super::model::{Cell, PlacementTolerance};
use super::robot_model::JointKind;
use crate::safe_text::shown;
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg, rounded};

/// Assumed clearance, mm.
const CLEARANCE_MM: f64 = 10.0;
/// Assumed distance from the limits of revolute joints, degrees.
const TURN_MARGIN_DEG: f64 = 2.0;
/// Assumed distance from the limits of prismatic joints, mm.
const SLIDE_MARGIN_MM: f64 = 2.0;
/// Assumed lower limit of the smallest singular value of the Jacobian, with lengths divided by the arm reach.
///
/// At this value, the joints move by up to 0.05 rad (2.9 degrees) if the TCP is displaced by 0.1 % of the
/// reach. Below this value, an operation is no longer a precision operation: small corrections become large
/// motions.
const SINGULARITY: f64 = 0.02;
/// Assumed placement tolerance of every body that the search places: x, y and z, mm.
const PLACE_MM: f64 = 2.0;
/// Assumed tolerance of the yaw of every body that the search places, degrees.
const PLACE_YAW_DEG: f64 = 0.2;
/// Largest assumed margin at each end of a joint, as a share of the travel of the joint.
const MARGIN_SHARE: f64 = 0.1;

/// Record of the quantities that the cell file states. [`Cell::assuming`] assumes only the other quantities.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StatedKeys {
    /// Whether the file has search settings other than the seed alone. The seed also selects Monte Carlo
    /// samples, so it does not show that the layout is to be built.
    pub search: bool,
    pub clearance: bool,
    pub turn_margin: bool,
    pub slide_margin: bool,
    pub singularity: bool,
    pub base_tolerance: bool,
    /// For each piece of equipment, whether its placement tolerance is stated.
    pub placement_tolerances: Vec<bool>,
}

impl Cell {
    /// Returns this cell with assumed values for quantities that its file leaves out ([`StatedKeys`]).
    ///
    /// The function assumes nothing if the search ignores placement tolerances
    /// ([`crate::cell::SearchSettings::ideal`]). Otherwise, clearance and margins are assumed if the cell has
    /// search settings or a placement that the search may change. Attitude angles that the search may change
    /// have no influence on these assumptions. The clearance is assumed only if collisions are checked.
    /// Tolerances are assumed for bodies whose placement the search may change.
    pub fn assuming(mut self, stated: &StatedKeys) -> Self {
        let is_searched = |placement: &[Coordinate; 4]| placement.iter().any(Coordinate::is_free);
        let searches = is_searched(&self.base) || self.equipment.iter().any(|e| is_searched(&e.placement));
        if self.search.ideal || !(searches || stated.search) {
            return self;
        }
        let mut assumed = Vec::new();
        let mut assume = |key: &str, value: String| assumed.push(Assumption { key: key.into(), value });
        if self.collision && !stated.clearance {
            self.clearance = m_from_mm(CLEARANCE_MM);
            assume("clearance_mm", number(CLEARANCE_MM));
        }
        if let Some(travel) = self.least_travel(JointKind::Revolute).filter(|_| !stated.turn_margin) {
            let margin = TURN_MARGIN_DEG.min(rounded(deg_from_rad(travel) * MARGIN_SHARE, 3));
            self.margins.turn = rad_from_deg(margin);
            assume("margins.joint_deg", number(margin));
        }
        if let Some(travel) = self.least_travel(JointKind::Prismatic).filter(|_| !stated.slide_margin) {
            let margin = SLIDE_MARGIN_MM.min(rounded(mm_from_m(travel) * MARGIN_SHARE, 3));
            self.margins.slide = m_from_mm(margin);
            assume("margins.joint_mm", number(margin));
        }
        if !stated.singularity {
            self.margins.singularity = SINGULARITY;
            assume("margins.singularity", number(SINGULARITY));
        }
        let place = m_from_mm(PLACE_MM);
        let tolerance = PlacementTolerance([place, place, place, rad_from_deg(PLACE_YAW_DEG)]);
        let mm = number(PLACE_MM);
        let text = format!("{{ x_mm = {mm}, y_mm = {mm}, z_mm = {mm}, yaw_deg = {PLACE_YAW_DEG} }}");
        if is_searched(&self.base) && !stated.base_tolerance {
            self.base_tolerance = tolerance;
            assume("robot.base_tolerance", text.clone());
        }
        for (k, equipment) in self.equipment.iter_mut().enumerate() {
            let is_stated = stated.placement_tolerances.get(k).copied().unwrap_or(false);
            if is_searched(&equipment.placement) && !is_stated {
                equipment.tolerance = tolerance;
                let name = shown(&equipment.name);
                assume(&format!("equipment.{name}.placement_tolerance"), text.clone());
            }
        }
        self.assumed = assumed;
        self
    }

    /// Returns the least travel, rad or m, among the joints of the given kind that have an actuator. Returns
    /// None if there is no such joint.
    fn least_travel(&self, kind: JointKind) -> Option<f64> {
        let moving = self.robot.joints.iter().filter(|joint| joint.kind == kind && !joint.is_passive());
        moving.map(|joint| joint.limits.1 - joint.limits.0).reduce(f64::min)
    }
}

/// Formats a number, rounded to six decimal places, without trailing zeros.
fn number(value: f64) -> String {
    rounded(value, 6).to_string()
}
