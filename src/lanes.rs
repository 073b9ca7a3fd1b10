//! One number of several nodes at once: f64 in lanes, as many as the processor has.
//!
//! What is found in lanes ranks nodes and rejects the hopeless ones; the code for one node judges those
//! that are left. So no result depends on the processor.

use std::ops::{Add, BitOr, Mul, Neg, Sub};

pub use pulp::{Arch, Simd, WithSimd};

/// No processor has more lanes of f64, and a multiple of this many fills the lanes of all.
pub const MOST_LANES: usize = 8;

/// A number of every node in the lanes.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    of: S::f64s,
}

/// Yes or no for every node in the lanes.
#[derive(Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    of: S::m64s,
}

/// Cosine and sine of an angle of every node in the lanes.
pub type CosSin<S> = (Lanes<S>, Lanes<S>);

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    pub fn new(simd: S, of: S::f64s) -> Self {
        Self { simd, of }
    }

    /// The same number in every lane.
    #[inline(always)]
    pub fn all(simd: S, value: f64) -> Self {
        Self { simd, of: simd.splat_f64s(value) }
    }

    #[inline(always)]
    pub fn get(self) -> S::f64s {
        self.of
    }

    /// The same number in every lane, beside numbers that are there already.
    #[inline(always)]
    pub fn like(self, value: f64) -> Self {
        Self::all(self.simd, value)
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self { of: self.simd.sqrt_f64s(self.of), ..self }
    }

    #[inline(always)]
    pub fn reciprocal(self) -> Self {
        Self { of: self.simd.div_f64s(self.simd.splat_f64s(1.0), self.of), ..self }
    }

    #[inline(always)]
    pub fn max(self, other: f64) -> Self {
        Self { of: self.simd.max_f64s(self.of, self.simd.splat_f64s(other)), ..self }
    }

    #[inline(always)]
    pub fn clamp(self, low: f64, high: f64) -> Self {
        let up = self.simd.max_f64s(self.of, self.simd.splat_f64s(low));
        Self { of: self.simd.min_f64s(up, self.simd.splat_f64s(high)), ..self }
    }

    /// `self * by + plus`, rounded once where the processor can.
    #[inline(always)]
    pub fn times_plus(self, by: Self, plus: Self) -> Self {
        Self { of: self.simd.mul_add_e_f64s(self.of, by.of, plus.of), ..self }
    }

    /// No where either is no number.
    #[inline(always)]
    pub fn is_above(self, other: f64) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.greater_than_f64s(self.of, self.simd.splat_f64s(other)) }
    }

    /// No where either is no number.
    #[inline(always)]
    pub fn is_below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.less_than_f64s(self.of, other.of) }
    }
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub fn choose(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, of: self.simd.select_f64s(self.of, yes.of, no.of) }
    }

    #[inline(always)]
    pub fn is_all(self) -> bool {
        let no = self.simd.not_m64s(self.of);
        self.simd.first_true_m64s(no) >= S::F64_LANES
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { of: self.simd.or_m64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { of: self.simd.add_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { of: self.simd.sub_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { of: self.simd.mul_f64s(self.of, other.of), ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { of: self.simd.neg_f64s(self.of), ..self }
    }
}

impl<S: Simd> Add<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        self + self.like(other)
    }
}

impl<S: Simd> Sub<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        self - self.like(other)
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        self * self.like(other)
    }
}
