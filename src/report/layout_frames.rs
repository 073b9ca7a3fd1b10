//! Frames of a layout for use in other programs: robot base, equipment and spots.

use crate::cell::Role;
use crate::drawing::Drawing;
use crate::pose::Pose;

/// Frames of a layout in the world frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutFrames {
    pub cell: String,
    pub robot: String,
    /// Name of the layout, such as "best layout".
    pub layout: String,
    /// Warning if the layout is not feasible or misses a limit.
    pub warning: Option<&'static str>,
    /// Pose of the robot base.
    pub base: Pose,
    /// Frames of the equipment; obstacles are left out.
    pub equipment: Vec<NamedFrame>,
    /// Frames of the TCP at the spots of the operations.
    pub spots: Vec<SpotFrame>,
    /// Names of the operations without a spot.
    pub spotless: Vec<String>,
}

/// Frame with a name, in the world frame, m.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFrame {
    pub name: String,
    pub pose: Pose,
}

/// Frame of the TCP at the spot of an operation.
#[derive(Debug, Clone, PartialEq)]
pub struct SpotFrame {
    /// Name of the operation.
    pub operation: String,
    /// Index into [`LayoutFrames::equipment`] of the equipment on which the operation happens.
    pub equipment: usize,
    /// Pose of the TCP in the world frame, m.
    pub tcp: Pose,
}

impl LayoutFrames {
    /// Collects the frames of the layout in `drawing`.
    pub fn new(drawing: &Drawing<'_>) -> Self {
        let cell = drawing.cell;
        let placed = cell.equipment.iter().zip(&drawing.layout.placements);
        let equipment = placed
            .filter(|(e, _)| e.role == Role::Equipment)
            .map(|(e, at)| NamedFrame { name: e.name.clone(), pose: at.pose() });
        let mut frames = Self {
            cell: cell.name.clone(),
            robot: cell.robot.name.clone(),
            layout: drawing.name.clone(),
            warning: match (drawing.is_feasible, drawing.meets_limits) {
                (false, _) => Some(
                    "WARNING: this layout is NOT FEASIBLE. Do not build it, and do not use these frames.",
                ),
                (true, false) => Some("WARNING: this layout does not meet every limit."),
                (true, true) => None,
            },
            base: drawing.base,
            equipment: equipment.collect(),
            spots: Vec::new(),
            spotless: Vec::new(),
        };
        for (k, operation) in cell.operations.iter().enumerate() {
            let on = &cell.equipment[operation.equipment].name;
            let equipment = frames.equipment.iter().position(|frame| frame.name == *on);
            let tcp = drawing.movement.at(k).and_then(|links| links.last());
            match (equipment, tcp) {
                (Some(equipment), Some(&tcp)) => {
                    frames.spots.push(SpotFrame { operation: operation.name.clone(), equipment, tcp });
                }
                _ => frames.spotless.push(operation.name.clone()),
            }
        }
        frames
    }

    /// Returns the frames of the equipment in the frame of the robot base.
    pub fn in_base(&self) -> impl Iterator<Item = NamedFrame> {
        let from_world = self.base.inverse();
        self.equipment.iter().map(move |frame| NamedFrame { pose: from_world * frame.pose, ..frame.clone() })
    }

    /// Returns the pose of the TCP at a spot, in the frame of the equipment.
    pub fn on_equipment(&self, spot: &SpotFrame) -> Pose {
        self.equipment[spot.equipment].pose.inverse() * spot.tcp
    }
}
