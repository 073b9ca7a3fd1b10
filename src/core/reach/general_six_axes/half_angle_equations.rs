//! Six equations for the angles 2, 3 and 4, and their determinant as a polynomial of angle 2.

use super::circle_polynomial::CirclePolynomial;
use super::elimination::{determinant_of_six, eliminate_three};

/// Six equations at one angle 2: the coefficients of nine products of half-angle terms of the angles 3 and 4.
///
/// The products are `cc`, `cs`, `ss` of angle 3, each times `cc`, `cs`, `ss` of angle 4. Here `c` and `s` are
/// the cosine and the sine of half the angle.
pub(super) type HalfAngleRows = [[f64; 9]; 6];

/// Six equations that are linear in 1, cosine and sine of angle 2, and in nine half-angle products.
pub(super) struct HalfAngleEquations {
    one: HalfAngleRows,
    cos: HalfAngleRows,
    sin: HalfAngleRows,
}

impl HalfAngleEquations {
    /// Returns the equations of six rows. The first nine coefficients of a row multiply 1. The next nine
    /// multiply the cosine of angle 2, and the last nine multiply the sine.
    ///
    /// Every row is scaled to the norm 1.
    pub fn new(mut rows: [[f64; 27]; 6]) -> Self {
        for row in &mut rows {
            let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.0 {
                row.iter_mut().for_each(|x| *x *= norm.recip());
            }
        }
        let part = |from: usize| rows.map(|row| std::array::from_fn(|j| row[from + j]));
        Self { one: part(0), cos: part(9), sin: part(18) }
    }

    /// Returns the coefficients at one angle 2, given by cosine and sine.
    pub fn at(&self, cos: f64, sin: f64) -> HalfAngleRows {
        let mut rows = self.one;
        for ((row, by_cos), by_sin) in rows.iter_mut().zip(&self.cos).zip(&self.sin) {
            for ((entry, by_cos), by_sin) in row.iter_mut().zip(by_cos).zip(by_sin) {
                *entry += cos * by_cos + sin * by_sin;
            }
        }
        rows
    }

    /// Returns the determinant of twelve rows. These are the six equations, and the six equations times the
    /// tangent of half of angle 3.
    ///
    /// Both sets of six equations have the same coefficients, shifted by three columns. So both sets share
    /// the elimination of three columns. This elimination leaves the rows `[A0 A1 A2]` and `[0 B1 B2]` of
    /// 3 x 3 blocks. The remaining eliminations need only matrices of six rows.
    fn determinant(&self, cos: f64, sin: f64) -> f64 {
        let mut first = self.at(cos, sin);
        // A change of sign occurs in both sets of six rows, so it cancels.
        let (product, _) = eliminate_three(&mut first);
        let mut second = [[0.0; 9]; 6];
        for i in 0..3 {
            second[i] = first[i];
            second[i + 3][..6].copy_from_slice(&first[i + 3][3..]);
        }
        let (next, sign) = eliminate_three(&mut second);
        let mut third = [[0.0; 6]; 6];
        for i in 0..3 {
            third[i].copy_from_slice(&second[i + 3][3..]);
            third[i + 3].copy_from_slice(&first[i + 3][3..]);
        }
        sign * product * next * determinant_of_six(third)
    }

    /// Returns the determinant as a polynomial of angle 2.
    pub fn polynomial(&self) -> CirclePolynomial {
        CirclePolynomial::through(|cos, sin| self.determinant(cos, sin))
    }

    /// Returns the determinant, times a positive factor, as a polynomial of a new angle.
    ///
    /// The new angle magnifies the vicinity of `middle` (rad). Let d be angle 2 minus `middle`. The tangent
    /// of half of d is `scale` times the tangent of half of the new angle.
    ///
    /// The determinant is a form of degree 16 in cosine and sine of half of angle 2. The factor makes it a
    /// form of degree 16 in cosine and sine of half of the new angle. The result is therefore a
    /// trigonometric polynomial of degree 8 in the new angle.
    pub fn polynomial_near(&self, middle: f64, scale: f64) -> CirclePolynomial {
        let (s, c) = middle.sin_cos();
        CirclePolynomial::through(|cos, sin| {
            let (x, y) = (0.5 * (1.0 + cos), 0.5 * scale * scale * (1.0 - cos));
            let norm = x + y;
            let (cos, sin) = ((x - y) / norm, scale * sin / norm);
            norm.powi(8) * self.determinant(c * cos - s * sin, s * cos + c * sin)
        })
    }
}

/// Returns `cc`, `cs` and `ss`, where c and s are cosine and sine of half of `angle` (rad).
pub(super) fn half_angle_terms(angle: f64) -> [f64; 3] {
    let (s, c) = (0.5 * angle).sin_cos();
    [c * c, c * s, s * s]
}

/// Returns the greatest absolute value of the six equations at the angles 3 and 4 (rad).
pub(super) fn residual(rows: &HalfAngleRows, angle3: f64, angle4: f64) -> f64 {
    let (third, fourth) = (half_angle_terms(angle3), half_angle_terms(angle4));
    let products: [f64; 9] = std::array::from_fn(|k| third[k / 3] * fourth[k % 3]);
    let value =
        |row: &[f64; 9]| row.iter().zip(&products).map(|(entry, product)| entry * product).sum::<f64>();
    rows.iter().fold(0.0, |greatest, row| greatest.max(value(row).abs()))
}
