//! Rows of a sense at a posture: the weighted directions along which the error of a point is measured.

use crate::cell::{Frame, MAX_ROWS, Sense};
use crate::pose::Displacement;
use crate::robot::Frames;
use nalgebra::{Matrix3, Vector3, Vector6};

/// Rows of a [`Sense`], and the point whose error they measure. A row is a weighted direction in the base
/// frame, along which the error is measured.
#[derive(Debug, Clone, Copy)]
pub struct SenseRows {
    /// Vector from the TCP to the point whose error the sense measures, base frame, m.
    arm: Vector3<f64>,
    /// Weighted direction of each row (base frame), and whether the row measures the rotation instead of the
    /// position.
    rows: [(bool, Vector3<f64>); MAX_ROWS],
    count: usize,
}

impl SenseRows {
    /// Returns the rows of a sense; `world` and `surface` are the rotations from the world axes and the
    /// surface axes to the base frame.
    pub fn new(sense: &Sense, frames: &Frames, world: &Matrix3<f64>, surface: &Matrix3<f64>) -> Self {
        let axes = match sense.frame {
            Frame::World => world,
            Frame::Surface => surface,
            Frame::Tool => &frames.tcp.rotation,
        };
        let mut rows = [(false, Vector3::zeros()); MAX_ROWS];
        for (row, given) in rows.iter_mut().zip(sense.rows()) {
            *row = (given.turns, axes * given.direction);
        }
        Self { arm: frames.tcp.rotation * sense.point, rows, count: sense.rows().len() }
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.count
    }

    /// Returns a matrix with the directions of the first three rows of the sense; unused rows of the matrix
    /// are 0. The result is valid only if all rows measure the position of the TCP.
    pub fn position_rows(&self) -> Matrix3<f64> {
        let [a, b, c] = [0, 1, 2].map(|k| self.rows[k].1.transpose());
        Matrix3::from_rows(&[a, b, c])
    }

    /// Returns whether the rows measure only the position error of the TCP.
    pub fn is_of_position(&self) -> bool {
        self.arm == Vector3::zeros() && self.rows[..self.count].iter().all(|(turns, _)| !turns)
    }

    /// Returns the root sum square of the components of a TCP position error `e` (base frame, m) along the
    /// rows. The result is valid only if [`Self::is_of_position`] is true.
    pub fn size_of_position(&self, e: &Vector3<f64>) -> f64 {
        self.rows[..self.count].iter().map(|(_, row)| row.dot(e).powi(2)).sum::<f64>().sqrt()
    }

    /// Returns the root sum square of the components of a TCP error along the rows.
    pub fn size(&self, error: &Displacement) -> f64 {
        self.vector(error).norm()
    }

    /// Returns the components of a TCP error along the rows; unused components are 0.
    pub fn vector(&self, error: &Displacement) -> Vector6<f64> {
        self.components(&error.at(&self.arm))
    }

    /// Returns the components of a first-order effect on the TCP along the rows; unused components are 0.
    #[inline]
    pub fn column(&self, effect: &Displacement) -> Vector6<f64> {
        self.components(&effect.linear_at(&self.arm))
    }

    /// Returns the vector from the TCP to the point whose error the sense measures, base frame, m.
    pub fn arm(&self) -> &Vector3<f64> {
        &self.arm
    }

    /// Returns two upper bounds of the root sum square of the components along the rows. The first is per
    /// unit of displacement, over the rows that measure the position. The second is per unit of rotation,
    /// over the rows that measure the rotation.
    ///
    /// The square of each bound is the largest sum of the absolute values in a row of the Gram matrix of
    /// these rows. This sum is at least the largest eigenvalue (S. Gershgorin, 1931).
    pub fn weights(&self) -> [f64; 2] {
        [false, true].map(|turns| {
            let rows = || self.rows[..self.count].iter().filter(|row| row.0 == turns).map(|row| row.1);
            let sum = |row: Vector3<f64>| rows().map(|other| row.dot(&other).abs()).sum::<f64>();
            rows().map(sum).fold(0.0, f64::max).sqrt()
        })
    }

    /// Returns the components of the measured point's displacement along the rows; unused components are 0.
    #[inline]
    pub fn components(&self, at_point: &Displacement) -> Vector6<f64> {
        let mut v = Vector6::zeros();
        for (k, (turns, direction)) in self.rows[..self.count].iter().enumerate() {
            v[k] = direction.dot(if *turns { &at_point.rotation } else { &at_point.position });
        }
        v
    }
}
