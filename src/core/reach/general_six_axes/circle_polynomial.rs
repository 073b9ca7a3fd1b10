//! Trigonometric polynomials of degree 8, computed from samples on the circle.

/// Degree of the polynomials.
const DEGREE: usize = 8;

/// Number of samples, 15 degrees apart.
///
/// A polynomial of degree 8 has 17 coefficients, so 17 samples define it. The other samples show the rounding
/// error.
const SAMPLES: usize = 24;

/// Cosines of the multiples of 15 degrees up to 90 degrees.
const COSINES: [f64; 7] = [
    1.0,
    0.965_925_826_289_068_3,
    0.866_025_403_784_438_6,
    std::f64::consts::FRAC_1_SQRT_2,
    0.5,
    0.258_819_045_102_520_74,
    0.0,
];

/// Rounding error of a value of the polynomial. The error is a share of the sum of the absolute real and
/// imaginary parts of all coefficients.
const ROUNDING: f64 = 1e-16;

/// The roots of a polynomial are defined if its noise is below this threshold. The threshold is a share of
/// the greatest absolute real or imaginary part of a coefficient.
const MAX_NOISE: f64 = 1e-10;

/// Trigonometric polynomial: the real part of the sum of `c[k] exp(i k t)` for k from 0 to 8.
#[derive(Clone, Debug)]
pub(super) struct CirclePolynomial {
    real: [f64; DEGREE + 1],
    imaginary: [f64; DEGREE + 1],
    /// Estimated rounding error of a value of the polynomial.
    ///
    /// The estimate follows from two quantities: the harmonics above degree 8, and the coefficients.
    noise: f64,
    /// Upper bound of the absolute value of the sixth derivative.
    sixth_derivative: f64,
    /// Least absolute value of a sample, as a share of the greatest absolute value.
    least_sample: f64,
}

impl CirclePolynomial {
    /// Samples `value`, a function of the cosine and the sine of an angle, and returns it as a polynomial.
    pub fn through(mut value: impl FnMut(f64, f64) -> f64) -> Self {
        let table: [f64; SAMPLES] = std::array::from_fn(cosine);
        let samples: [f64; SAMPLES] = std::array::from_fn(|j| value(table[j], table[(j + 18) % SAMPLES]));
        let harmonic = |k: usize| {
            let (mut real, mut imaginary) = (0.0, 0.0);
            for (j, sample) in samples.iter().enumerate() {
                real += sample * table[j * k % SAMPLES];
                imaginary -= sample * table[(j * k + 18) % SAMPLES];
            }
            let factor = if k == 0 { 1.0 } else { 2.0 } / SAMPLES as f64;
            (factor * real, factor * imaginary)
        };
        let coefficients: [(f64, f64); DEGREE + 1] = std::array::from_fn(harmonic);
        let above = (DEGREE + 1..SAMPLES / 2).map(harmonic).map(|(x, y)| x * x + y * y);
        let mean_square = above.sum::<f64>() / (SAMPLES / 2 - 1 - DEGREE) as f64;
        let sum: f64 = coefficients.iter().map(|(x, y)| x.abs() + y.abs()).sum();
        let sixth = coefficients.iter().enumerate().map(|(k, (x, y))| (k as f64).powi(6) * x.hypot(*y));
        let sizes = samples.map(f64::abs);
        let (least, greatest) = sizes
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), size| (low.min(*size), high.max(*size)));
        Self {
            real: coefficients.map(|c| c.0),
            imaginary: coefficients.map(|c| c.1),
            noise: (mean_square * (DEGREE as f64 + 0.5)).sqrt() + ROUNDING * sum,
            sixth_derivative: sixth.sum(),
            least_sample: least / greatest,
        }
    }

    /// Returns whether the coefficients exceed the noise, so that the roots are defined.
    pub fn is_regular(&self) -> bool {
        let all = self.real.iter().chain(&self.imaginary);
        self.noise < MAX_NOISE * all.fold(0.0_f64, |greatest, c| greatest.max(c.abs()))
    }

    /// Returns whether all coefficients are finite.
    pub fn is_finite(&self) -> bool {
        self.sixth_derivative.is_finite() && self.noise.is_finite()
    }

    /// Returns the least absolute value of a sample, as a share of the greatest absolute value; NaN if all
    /// samples are 0.
    pub fn least_sample(&self) -> f64 {
        self.least_sample
    }

    /// Returns the estimated rounding error of a value of the polynomial.
    pub fn noise(&self) -> f64 {
        self.noise
    }

    /// Returns an upper bound of the absolute value of the sixth derivative.
    pub fn sixth_derivative(&self) -> f64 {
        self.sixth_derivative
    }

    /// Returns the value and the first `COUNT - 1` derivatives at an angle (rad).
    #[inline]
    pub fn derivatives<const COUNT: usize>(&self, angle: f64) -> [f64; COUNT] {
        let (sin, cos) = angle.sin_cos();
        let (mut x, mut y) = (cos, sin);
        let mut sums = [0.0; COUNT];
        sums[0] = self.real[0];
        for (k, (a, b)) in self.real.iter().zip(&self.imaginary).enumerate().skip(1) {
            // Differentiation rotates the complex term by a right angle and multiplies it by k.
            let (mut real, mut imaginary) = (a * x - b * y, a * y + b * x);
            for sum in &mut sums {
                *sum += real;
                (real, imaginary) = (-(k as f64) * imaginary, k as f64 * real);
            }
            (x, y) = (x * cos - y * sin, x * sin + y * cos);
        }
        sums
    }
}

/// Returns the cosine of `step` times 15 degrees.
fn cosine(step: usize) -> f64 {
    match step % SAMPLES {
        k @ 0..=6 => COSINES[k],
        k @ 7..=12 => -COSINES[12 - k],
        k @ 13..=18 => -COSINES[k - 12],
        k => COSINES[24 - k],
    }
}
