//! Moments of a random TCP position and of its error, and how motions of the robot change them.

use crate::cell::Model;
use crate::kinematic_error::{FrameError, Turn};
use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3};

/// Moments of the error d of a random position p: the means `E[d]` (m) and `E[d p^T]` (m2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorMoments {
    pub mean: Vector3<f64>,
    pub product: Matrix3<f64>,
}

impl ErrorMoments {
    /// Moments of an error that is always 0.
    pub const NONE: Self = Self {
        mean: Vector3::new(0.0, 0.0, 0.0),
        product: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    };

    /// Returns the moments of the product of a matrix and the error.
    fn times(&self, matrix: &Matrix3<f64>) -> Self {
        Self { mean: matrix * self.mean, product: matrix * self.product }
    }
}

impl std::ops::Add for ErrorMoments {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { mean: self.mean + other.mean, product: self.product + other.product }
    }
}

impl std::ops::Mul<f64> for ErrorMoments {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, product: self.product * factor }
    }
}

/// Moments of a random position p and of the error of p, both in one frame, m and m2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PositionMoments {
    /// Mean `E[p]`.
    pub mean: Vector3<f64>,
    /// Second moment `E[p p^T]`.
    pub square: Matrix3<f64>,
    /// Moments of the error. In the second-order model, this field covers only the first-order terms of the
    /// error.
    pub error: ErrorMoments,
    /// Moments of the second-order terms of the error; 0 in the other models.
    pub second: ErrorMoments,
}

impl PositionMoments {
    /// Moments of a point that is always at the origin and has no error.
    pub const ORIGIN: Self = Self {
        mean: ErrorMoments::NONE.mean,
        square: ErrorMoments::NONE.product,
        error: ErrorMoments::NONE,
        second: ErrorMoments::NONE,
    };

    /// Returns the moments in another frame; the argument is the pose of the present frame in the other
    /// frame.
    pub fn placed(&self, Pose { rotation, translation }: &Pose) -> Self {
        let placed = |error: &ErrorMoments| {
            let mean = rotation * error.mean;
            let product = rotation * error.product * rotation.transpose() + mean * translation.transpose();
            ErrorMoments { mean, product }
        };
        let turned = rotation * self.mean;
        let mean = turned + translation;
        let square = rotation * self.square * rotation.transpose()
            + turned * translation.transpose()
            + translation * mean.transpose();
        Self { mean, square, error: placed(&self.error), second: placed(&self.second) }
    }

    /// Returns the moments after a random rotation about the z axis.
    pub fn turned(&self, rotation: &Harmonics) -> Self {
        let error = |error: &ErrorMoments| ErrorMoments {
            mean: rotation.mean_of_vector(&error.mean),
            product: rotation.mean_of_matrix(&error.product),
        };
        Self {
            mean: rotation.mean_of_vector(&self.mean),
            square: rotation.mean_of_matrix(&self.square),
            error: error(&self.error),
            second: error(&self.second),
        }
    }

    /// Returns the moments after a random translation along the z axis.
    ///
    /// The translation has the mean `mean` (m) and the mean square `square` (m2).
    pub fn slid(&self, mean: f64, square: f64) -> Self {
        let z = Vector3::z();
        let along = |v: &Vector3<f64>| v * z.transpose() * mean;
        let slid =
            |error: &ErrorMoments| ErrorMoments { product: error.product + along(&error.mean), ..*error };
        Self {
            mean: self.mean + z * mean,
            square: self.square
                + along(&self.mean)
                + along(&self.mean).transpose()
                + z * z.transpose() * square,
            error: slid(&self.error),
            second: slid(&self.second),
        }
    }

    /// Adds a translation `by` (m) to the error.
    pub fn add_slide(&mut self, by: &Vector3<f64>) {
        self.error.mean += by;
        self.error.product += by * self.mean.transpose();
    }

    /// Adds a small rotation to the error: by the angle `by`, about the axis `axis` through the point
    /// `through`.
    ///
    /// The rotation acts after all errors that were added before.
    pub fn add_turn(&mut self, model: Model, axis: &Vector3<f64>, through: &Vector3<f64>, by: &Turn) {
        if by.angle == 0.0 {
            return;
        }
        let cross = axis.cross_matrix();
        let arm = ErrorMoments {
            mean: self.mean - through,
            product: self.square - through * self.mean.transpose(),
        };
        if model == Model::Nonlinear {
            // Rodrigues' formula for R - 1, which is applied to the point after its earlier errors.
            let turn = cross * by.sin + cross * cross * by.versine;
            self.error = self.error + (arm + self.error).times(&turn);
            return;
        }
        let turn = cross * by.angle;
        if model == Model::SecondOrder {
            self.second = self.second + (self.error + arm.times(&turn) * 0.5).times(&turn);
        }
        self.error = self.error + arm.times(&turn);
    }

    /// Adds the frame error `error` to the position error; `frame` gives the axes and the origin of the
    /// frame.
    ///
    /// The frame error acts after all errors that were added before.
    pub fn add_frame(&mut self, model: Model, frame: &Pose, error: &FrameError) {
        for (k, by) in error.turns.iter().enumerate() {
            self.add_turn(model, &frame.rotation.column(k).into_owned(), &frame.translation, by);
        }
        self.add_slide(&(frame.rotation * Vector3::from(error.slides)));
    }
}

impl std::ops::Add for PositionMoments {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            mean: self.mean + other.mean,
            square: self.square + other.square,
            error: self.error + other.error,
            second: self.second + other.second,
        }
    }
}

impl std::ops::Mul<f64> for PositionMoments {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            mean: self.mean * factor,
            square: self.square * factor,
            error: self.error * factor,
            second: self.second * factor,
        }
    }
}

/// First two Fourier coefficients of a random angle a: the means of cos a and sin a, and of cos 2a and sin
/// 2a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonics {
    first: (f64, f64),
    second: (f64, f64),
}

impl Harmonics {
    /// Returns the coefficients of one angle, rad.
    pub fn of_angle(angle: f64) -> Self {
        let (s, c) = angle.sin_cos();
        Self { first: (c, s), second: (c * c - s * s, 2.0 * s * c) }
    }

    /// Returns the coefficients of an angle that is uniform from `low` to `high`, rad.
    pub fn of_range((low, high): (f64, f64)) -> Self {
        let (middle, half) = (Self::of_angle((low + high) / 2.0), (high - low) / 2.0);
        let sinc = |x: f64| if x == 0.0 { 1.0 } else { x.sin() / x };
        let scaled = |(c, s): (f64, f64), by: f64| (c * by, s * by);
        Self { first: scaled(middle.first, sinc(half)), second: scaled(middle.second, sinc(2.0 * half)) }
    }

    /// Returns the coefficients of the sum of two independent random angles.
    pub fn plus(&self, other: &Self) -> Self {
        let product = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
        Self { first: product(self.first, other.first), second: product(self.second, other.second) }
    }

    /// Returns the mean of `R v`, where R is the rotation by the random angle about the z axis.
    fn mean_of_vector(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let (c, s) = self.first;
        Vector3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
    }

    /// Returns the mean of `R M R^T`, where R is the rotation by the random angle about the z axis.
    ///
    /// The trace and the antisymmetric part of the xy block do not change. The traceless symmetric part of
    /// this block rotates by twice the angle.
    fn mean_of_matrix(&self, m: &Matrix3<f64>) -> Matrix3<f64> {
        let (c, s) = self.first;
        let (trace, skew) = ((m.m11 + m.m22) / 2.0, (m.m21 - m.m12) / 2.0);
        let (along, across) = ((m.m11 - m.m22) / 2.0, (m.m12 + m.m21) / 2.0);
        let (c2, s2) = self.second;
        let (along, across) = (along * c2 - across * s2, along * s2 + across * c2);
        Matrix3::new(
            trace + along,
            across - skew,
            c * m.m13 - s * m.m23,
            across + skew,
            trace - along,
            s * m.m13 + c * m.m23,
            c * m.m31 - s * m.m32,
            s * m.m31 + c * m.m32,
            m.m33,
        )
    }
}
