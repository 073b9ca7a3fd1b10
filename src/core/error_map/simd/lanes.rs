//! Arithmetic in SIMD lanes: each lane holds one f64 of one node.

use std::ops::{Add, BitOr, Mul, Neg, Sub};

use pulp::Simd;

/// Upper bound on the number of f64 lanes. If the number of nodes is a multiple of this bound, the nodes
/// fill all lanes of every processor.
pub const MAX_LANES: usize = 8;

/// One number per node, in lanes.
#[derive(Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    of: S::f64s,
}

/// One truth value per node, in lanes.
#[derive(Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    of: S::m64s,
}

/// Cosine and sine of one angle per node, in lanes.
pub type CosSin<S> = (Lanes<S>, Lanes<S>);

impl<S: Simd> Lanes<S> {
    /// Wraps one SIMD vector.
    #[inline(always)]
    pub fn new(simd: S, of: S::f64s) -> Self {
        Self { simd, of }
    }

    /// Puts one number into every lane.
    #[inline(always)]
    pub fn all(simd: S, value: f64) -> Self {
        Self { simd, of: simd.splat_f64s(value) }
    }

    /// Returns the SIMD vector.
    #[inline(always)]
    pub fn get(self) -> S::f64s {
        self.of
    }

    /// Puts one number into every lane, with as many lanes as `self`.
    #[inline(always)]
    pub fn like(self, value: f64) -> Self {
        Self::all(self.simd, value)
    }

    /// Returns the square root in every lane.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self { of: self.simd.sqrt_f64s(self.of), ..self }
    }

    /// Returns the reciprocal in every lane.
    #[inline(always)]
    pub fn reciprocal(self) -> Self {
        Self { of: self.simd.div_f64s(self.simd.splat_f64s(1.0), self.of), ..self }
    }

    /// Returns, in every lane, the larger of the number in the lane and `other`.
    #[inline(always)]
    pub fn max(self, other: f64) -> Self {
        Self { of: self.simd.max_f64s(self.of, self.simd.splat_f64s(other)), ..self }
    }

    /// Returns, in every lane, the number limited to the range from `low` to `high`.
    #[inline(always)]
    pub fn clamp(self, low: f64, high: f64) -> Self {
        let up = self.simd.max_f64s(self.of, self.simd.splat_f64s(low));
        Self { of: self.simd.min_f64s(up, self.simd.splat_f64s(high)), ..self }
    }

    /// Computes `self * by + plus`. The result is rounded only once if the processor has a fused
    /// instruction.
    #[inline(always)]
    pub fn times_plus(self, by: Self, plus: Self) -> Self {
        Self { of: self.simd.mul_add_e_f64s(self.of, by.of, plus.of), ..self }
    }

    /// Returns a mask that is true in the lanes whose number is greater than `other`. The mask is false if
    /// either number is NaN.
    #[inline(always)]
    pub fn is_above(self, other: f64) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.greater_than_f64s(self.of, self.simd.splat_f64s(other)) }
    }

    /// Returns a mask that is true in the lanes whose number is less than the number of `other`. The mask is
    /// false if either number is NaN.
    #[inline(always)]
    pub fn is_below(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, of: self.simd.less_than_f64s(self.of, other.of) }
    }
}

impl<S: Simd> Mask<S> {
    /// Returns `yes` in the lanes where the mask is true, and `no` in the other lanes.
    #[inline(always)]
    pub fn choose(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, of: self.simd.select_f64s(self.of, yes.of, no.of) }
    }

    /// Returns whether every lane is true.
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
