//! The tool attitudes that an operation allows, for one arm and one yaw of the surface.

use crate::cell::{Attitude, Azimuth, Spin, ToolDirection, held};
use crate::pose::exact_sin_cos;
use crate::units::wrapped;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Largest attitude error, rad, that counts as rounding error and therefore as 0.
const ROUNDING: f64 = 1e-9;

/// Two tool axes count as equal if the distance between their unit vectors is at most this value.
const SAME_AXIS: f64 = 1e-12;

/// Rotation of the tool about its axis, from the attitude `first` to another attitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SpinTurn {
    /// Index of the attitude from which the rotation starts.
    pub first: usize,
    /// Cosine and sine of the angle of rotation.
    pub cos: f64,
    pub sin: f64,
}

/// Tool attitudes that an operation allows, for one arm and one yaw of the surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AttitudeSet {
    /// Elevations of the tool axis to try, rad; the nominal elevation comes first.
    pub(super) elevations: Vec<f64>,
    pub(super) vertical: bool,
    /// Rotation matrix of the tool for every attitude, with the columns r, d x r and d.
    ///
    /// The vector d is the tool axis, and r is the reference axis of the tool.
    ///
    /// The function [`crate::cell::held`] defines both axes. If `radial` is false, the matrices are in the
    /// base frame. If `radial` is true, they are in a frame whose x axis points horizontally from the base
    /// axis to the target.
    pub(super) columns: Vec<Matrix3<f64>>,
    pub(super) radial: bool,
    pub(super) spin_is_free: bool,
    pub(super) azimuth_is_free: bool,
    /// Azimuth, rad, from which the spin angles of a vertical tool are measured.
    pub(super) zero: f64,
    /// Cosine and sine of `zero`.
    zero_direction: (f64, f64),
    pub(super) spins: Vec<f64>,
    /// Cosine and sine of each spin.
    pub(super) spin_directions: Vec<(f64, f64)>,
    /// Cosine and sine of the angle from the first spin to each spin.
    pub(super) spin_rotations: Vec<(f64, f64)>,
    /// Required azimuth, rad; None for a free or radial azimuth and for a vertical tool.
    heading: Option<f64>,
    /// One entry per attitude: the rotation of the last joint from a solved attitude to this attitude.
    pub(super) spin_turns: Vec<SpinTurn>,
    pub(super) tolerance: f64,
    tilts_sideways: bool,
}

impl AttitudeSet {
    /// Sets all fields that do not need the rotation matrices, for a surface rotated by `yaw` (rad) in the
    /// base frame.
    ///
    /// [`Self::update_columns`] adds the matrices. `fixed_elevation` is the elevation of the tool (rad) if
    /// the arm cannot change the elevation; otherwise None.
    pub fn update(&mut self, attitude: &Attitude, yaw: f64, fixed_elevation: Option<f64>) {
        self.vertical = attitude.is_vertical();
        self.radial = attitude.azimuth == Azimuth::Radial;
        self.spin_is_free = attitude.spin == Spin::Free;
        self.azimuth_is_free = attitude.azimuth == Azimuth::Free && !self.vertical;
        self.tolerance = attitude.tolerance;
        let turned = if self.radial { 0.0 } else { yaw };
        self.zero = turned + if let Azimuth::Surface(angle) = attitude.azimuth { angle } else { 0.0 };
        self.zero_direction = cos_sin(self.zero);
        self.heading = match attitude.azimuth {
            Azimuth::Surface(_) if !self.vertical => Some(self.zero),
            _ => None,
        };
        self.elevations.clear();
        match fixed_elevation {
            Some(fixed) => self.elevations.push(fixed),
            None => self.elevations.extend(tilted(attitude.elevation, attitude.tolerance)),
        }
        self.tilts_sideways = attitude.tolerance > 0.0 && fixed_elevation.is_none();
        match &attitude.spin {
            Spin::Free => self.update_spins(Attitude::free_spins()),
            Spin::At(spins) => self.update_spins(spins.iter().copied()),
        }
        self.columns.clear();
        self.spin_turns.clear();
    }

    /// Sets the spins (rad) and their directions, unless the spins are the same as before.
    fn update_spins(&mut self, spins: impl Iterator<Item = f64> + Clone) {
        if self.spins.iter().copied().eq(spins.clone()) {
            return;
        }
        self.spins.clear();
        self.spins.extend(spins);
        self.spin_directions.clear();
        self.spin_directions.extend(self.spins.iter().map(|spin| cos_sin(*spin)));
        self.spin_rotations.clear();
        let first = self.spins.first().copied().unwrap_or(0.0);
        self.spin_rotations.extend(self.spins.iter().map(|spin| cos_sin(spin - first)));
    }

    /// Sets the rotation matrices of all attitudes, for a solver that needs the full pose of the flange.
    ///
    /// [`Self::update`] must be called first.
    pub fn update_columns(&mut self, attitude: &Attitude, yaw: f64) {
        let turned = if self.radial { 0.0 } else { yaw };
        let tilts = self.tilts();
        for azimuth in attitude.azimuths() {
            let azimuth = turned + azimuth;
            let first = self.columns.len();
            self.columns.resize(first + self.columns_per_azimuth(), Matrix3::zeros());
            let columns = &mut self.columns[first..];
            for (k, &elevation) in self.elevations.iter().enumerate() {
                let direction = ToolDirection::new(elevation, azimuth);
                for (columns, (cos, sin)) in columns[k..].iter_mut().step_by(tilts).zip(&self.spin_directions)
                {
                    *columns = direction.spun(*cos, *sin);
                }
            }
            if self.tilts_sideways {
                let direction = ToolDirection::new(attitude.elevation, azimuth);
                for (columns, (cos, sin)) in columns.chunks_exact_mut(tilts).zip(&self.spin_directions) {
                    let wanted = direction.spun(*cos, *sin);
                    let sides = [1.0, -1.0].map(|side| sideways(&wanted, side * attitude.tolerance));
                    columns[tilts - 2..].copy_from_slice(&sides);
                }
            }
        }
    }

    /// Finds the attitudes that differ only by a rotation of the tool about its axis. `spins` is true if the
    /// last joint alone can rotate the tool about its axis.
    ///
    /// [`Self::update_columns`] must be called first.
    pub fn update_spin_turns(&mut self, spins: bool) {
        let (per_azimuth, tilts) = (self.columns_per_azimuth(), self.tilts());
        let turn = |k: usize| {
            let first = k / per_azimuth * per_azimuth + k % tilts;
            let (from, to) = (&self.columns[first], &self.columns[k]);
            let has_same_axis = (from.column(2) - to.column(2)).norm() <= SAME_AXIS;
            match spins && first != k && has_same_axis {
                true => {
                    let [cos, sin] = [0, 1].map(|axis| from.column(axis).dot(&to.column(0)));
                    SpinTurn { first, cos, sin }
                }
                false => SpinTurn { first: k, cos: 1.0, sin: 0.0 },
            }
        };
        self.spin_turns.extend((0..self.columns.len()).map(turn));
    }

    /// Returns the indices of the attitudes that the solver must solve. The other attitudes follow from these
    /// by a rotation of the last joint.
    pub(super) fn solved(&self) -> impl Iterator<Item = usize> + '_ {
        self.spin_turns.iter().enumerate().filter(|(k, turn)| turn.first == *k).map(|(k, _)| k)
    }

    /// Returns index and rotation of each attitude that follows from the solved attitude `first`, beginning
    /// with `first`.
    pub(super) fn spun(&self, first: usize) -> impl Iterator<Item = (usize, SpinTurn)> + '_ {
        let of_same_tilt = (0..self.spins.len()).map(move |spin| first + spin * self.tilts());
        let turns = of_same_tilt.filter_map(|k| Some((k, *self.spin_turns.get(k)?)));
        turns.filter(move |(_, turn)| turn.first == first)
    }

    /// Returns the index of the attitude that differs from attitude `k` by having the first spin, and the
    /// index of the spin of attitude `k`.
    pub(super) fn spin_index(&self, k: usize) -> (usize, usize) {
        let spin = k % self.columns_per_azimuth() / self.tilts();
        (k - spin * self.tilts(), spin)
    }

    /// Returns the index of the attitude with the spin `spin` (an index). `first` is the index of the same
    /// attitude with the first spin.
    pub(super) fn with_spin(&self, first: usize, spin: usize) -> usize {
        first + spin * self.tilts()
    }

    /// Returns the angle between two neighbouring free spins, rad.
    pub(super) fn spin_step(&self) -> f64 {
        TAU / self.spins.len() as f64
    }

    /// Returns the number of directions of the tool axis per azimuth.
    fn tilts(&self) -> usize {
        self.elevations.len() + if self.tilts_sideways { 2 } else { 0 }
    }

    /// Returns the azimuth in the base frame, rad, from which the attitudes at a target are measured. For a
    /// radial azimuth, the result is the direction from the base axis to the target.
    pub(super) fn heading(&self, target: &Vector3<f64>) -> f64 {
        if self.radial { target.y.atan2(target.x) } else { self.zero }
    }

    /// Returns the number of rotation matrices per azimuth.
    pub(super) fn columns_per_azimuth(&self) -> usize {
        self.spins.len() * self.tilts()
    }

    /// Returns the rotation matrix of the tool in attitude `k` at a target, in the base frame. See
    /// [`Self::columns`] for the columns of the matrix.
    #[inline]
    pub(super) fn columns_at(&self, k: usize, target: &Vector3<f64>) -> Matrix3<f64> {
        if !self.radial {
            return self.columns[k];
        }
        let (cos, sin) = heading_of(target);
        Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0) * self.columns[k]
    }

    /// Returns how far the attitude error of the tool exceeds the tolerance, rad; 0 within the tolerance.
    ///
    /// `columns` is the rotation matrix of the tool in the base frame, with the columns that
    /// [`Self::columns`] describes. Only planar arms need this check. The target determines the azimuth of
    /// the tool of a planar arm, and some planar arms cannot choose the spin. `rolls` is true if the arm can
    /// choose the spin.
    pub(super) fn off(&self, columns: &Matrix3<f64>, target: &Vector3<f64>, rolls: bool) -> f64 {
        let [r, d] = [0, 2].map(|k| columns.column(k).into_owned());
        let actual = d.y.atan2(d.x);
        let heading = self.heading.map_or(0.0, |wanted| wrapped(actual - wanted).abs());
        let mut spin = 0.0;
        if !self.spin_is_free && !rolls {
            let azimuth = match self.vertical {
                false => actual,
                true if self.radial => target.y.atan2(target.x),
                true => self.zero,
            };
            let elevation = d.z.clamp(-1.0, 1.0).asin();
            let apart = |&spin: &f64| {
                let wanted = held(elevation, azimuth, spin);
                (wanted.column(0).dot(&r)).clamp(-1.0, 1.0).acos()
            };
            spin = self.spins.iter().map(apart).fold(f64::INFINITY, f64::min);
        }
        let off = heading.max(spin) - self.tolerance;
        if off > ROUNDING { off } else { 0.0 }
    }

    /// Returns whether every posture must be checked by [`Self::off`].
    ///
    /// The check is needed if the attitude requires a fixed azimuth of a tool that is not vertical. It is
    /// also needed if the attitude requires a spin that the arm cannot choose.
    pub(super) fn is_checked(&self, rolls: bool) -> bool {
        self.heading.is_some() || !self.spin_is_free && !rolls
    }

    /// Returns the horizontal unit vector (x, y) from which the spin angles of a vertical tool are measured.
    #[inline]
    pub(super) fn zero_heading(&self, target: &Vector3<f64>) -> (f64, f64) {
        if self.radial { heading_of(target) } else { self.zero_direction }
    }
}

/// Returns cosine and sine of an angle (rad).
fn cos_sin(angle: f64) -> (f64, f64) {
    let (sin, cos) = exact_sin_cos(angle);
    (cos, sin)
}

/// Returns the elevations to try (rad): the nominal elevation, then this elevation minus and plus the
/// tolerance.
fn tilted(elevation: f64, tolerance: f64) -> impl Iterator<Item = f64> {
    let around = [-tolerance, tolerance].map(|by| (elevation + by).clamp(-FRAC_PI_2, FRAC_PI_2));
    let around = around.into_iter().filter(move |e| *e != elevation);
    std::iter::once(elevation).chain(around)
}

/// Returns the rotation matrix `columns`, tilted by the angle `by` (rad) out of the vertical plane through
/// the tool axis.
fn sideways(columns: &Matrix3<f64>, by: f64) -> Matrix3<f64> {
    let d = columns.column(2).into_owned();
    let level = Vector3::new(-d.y, d.x, 0.0).try_normalize(1e-9);
    let upright = level.map_or_else(|| columns.column(0).into_owned(), |level| d.cross(&level));
    nalgebra::Rotation3::from_scaled_axis(upright * by).into_inner() * columns
}

/// Returns the horizontal unit vector (x, y) from the base axis to the target.
///
/// For a target on the base axis, the result is the x axis.
fn heading_of(target: &Vector3<f64>) -> (f64, f64) {
    let radius = target.x.hypot(target.y);
    if radius > 0.0 { (target.x / radius, target.y / radius) } else { (1.0, 0.0) }
}
