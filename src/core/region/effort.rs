//! Resolution of regions: the longer the check of a placement takes, the coarser the lattice.

use crate::layout::Workcell;

/// Resolution of a region, and of an estimate of the room of a piece (the largest displacement in every
/// direction).
#[derive(Debug, Clone, Copy)]
pub struct RegionEffort {
    /// Spacing of the fine lattice, and step of a scan along z, mm.
    pub fine_mm: f64,
    /// Least number of spacings of the coarse lattice, along the longer side of the rectangle in which the
    /// region is traced. If the fine lattice has fewer spacings, the coarse lattice equals the fine lattice.
    pub divisions: f64,
    /// Step of a scan of the yaw, degrees.
    pub scan_deg: f64,
    /// Number of directions in which the room is checked.
    pub directions: usize,
    /// Number of directions in which the piece is displaced to estimate its room.
    pub estimated: usize,
    /// Largest number of layouts that a search evaluates to find a layout with a large room.
    pub evaluations: u64,
    /// Largest number of layouts whose rooms a search compares accurately.
    pub compared: usize,
}

impl RegionEffort {
    /// Resolution if the check of a placement takes microseconds.
    const LOW: Self = Self {
        fine_mm: 5.0,
        divisions: 150.0,
        scan_deg: 0.5,
        directions: 64,
        estimated: 16,
        evaluations: 5000,
        compared: 32,
    };
    /// Resolution if the check of a placement includes paths or all nodes, and takes milliseconds.
    const PATHS: Self = Self {
        fine_mm: 20.0,
        divisions: 40.0,
        scan_deg: 2.0,
        directions: 16,
        estimated: 8,
        evaluations: 150,
        compared: 4,
    };
    /// Resolution for an arm whose branches do not keep their indices. At a neighbouring target, the same
    /// index may belong to another branch. Each posture is therefore computed numerically, starting from a
    /// known posture at a neighbouring target.
    const NUMERIC: Self = Self { fine_mm: 40.0, divisions: 24.0, evaluations: 60, ..Self::PATHS };

    /// Returns whether the check of a placement takes milliseconds, not microseconds.
    pub fn is_dear(&self) -> bool {
        self.fine_mm > Self::LOW.fine_mm
    }

    /// Returns the resolution for a cell. The resolution is coarser if the check of a placement takes longer.
    pub fn of(workcell: &Workcell) -> Self {
        let cell = &workcell.cell;
        let is_dear =
            |o: &crate::cell::Operation| o.approach.max(o.retract) > 0.0 || o.over.needs_every_node();
        match workcell.inverse().keeps_branches() {
            false => Self::NUMERIC,
            true if cell.transfer.is_some() || cell.operations.iter().any(is_dear) => Self::PATHS,
            true => Self::LOW,
        }
    }
}
