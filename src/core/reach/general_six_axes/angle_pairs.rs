//! Computation of the loop angles 3 and 4 from the null space of twelve linear equations.
//!
//! Angle 2 is a root of the determinant of these equations.
//!
//! The twelve unknowns are the products `ccc`, `ccs`, `css`, `sss` of angle 3, each times `cc`, `cs`, `ss` of
//! angle 4. Here `c` and `s` are the cosine and the sine of half an angle. At a simple root, the null space
//! is one vector, and ratios of its entries give the angles. Several solutions can share angle 2. The null
//! space then has one vector per solution. Let these vectors be the columns of V, with one row per product.
//! The first nine rows of V, multiplied by a square matrix from the right, give the last nine rows. The
//! eigenvalues of this matrix are the tangents of half of angle 3. Beforehand, the code adds `HALF_ROTATION`
//! to half of angle 3. This rotation keeps the tangent finite if angle 3 is 180 degrees.

use super::elimination::triangulate;
use super::half_angle_equations::{HalfAngleRows, half_angle_terms, residual};
use nalgebra::linalg::Schur;
use nalgebra::{Complex, Matrix4, SMatrix, Vector3};

/// Several solutions may share angle 2 if the ratio of the last pivot but one to the first pivot is below
/// this value.
const SMALL_PIVOT: f64 = 2e-3;

/// Largest number of solutions with the same angle 2 that can be distinguished.
const SHARED: usize = 4;

/// Angle (rad) added to half of angle 3, so that the tangent of the sum is finite at 180 degrees.
const HALF_ROTATION: f64 = 0.7;

/// An eigenvalue counts as real if its absolute imaginary part is below this share of its size.
///
/// The size is 1 plus the absolute value of the real part.
const NEARLY_REAL: f64 = 0.1;

/// Two eigenvalues count as equal if their real parts differ by less than this value times a size.
///
/// The size is 1 plus the absolute real part of the eigenvalue that has the greater index. The imaginary
/// parts are not compared.
const SAME_EIGENVALUE: f64 = 1e-4;

/// Accuracy with which the eigenvalues are computed.
const SCHUR_ACCURACY: f64 = 1e-14;

/// Largest number of iterations for the eigenvalues.
const SCHUR_STEPS: usize = 60;

/// The common root for angle 4 is computed from a cross product only if the squared length of the product
/// exceeds this value.
///
/// The factors of the cross product are the coefficient vectors of two equations. The value is a share of the
/// fourth power of the length of the longest vector.
const INDEPENDENT: f64 = 1e-8;

/// Upper limit of the squared length of a cross product. Below this limit, two equations for angle 4 are
/// nearly dependent, and both roots of one of them are computed.
///
/// The value is a share of the fourth power of a length, as in [`INDEPENDENT`].
const DEPENDENT: f64 = 1e-4;

/// Twelve nearly singular equations in upper triangular form.
struct NullSpace {
    rows: [[f64; 12]; 12],
    /// Index of the unknown to which each column of the triangle belongs.
    columns: [usize; 12],
}

impl NullSpace {
    /// Returns the null space of twelve equations. These are the six equations, and the six equations times
    /// the tangent of half of angle 3.
    fn new(equations: &HalfAngleRows) -> Self {
        let mut rows = [[0.0; 12]; 12];
        let (alone, times) = rows.split_at_mut(6);
        for ((alone, times), row) in alone.iter_mut().zip(times).zip(equations) {
            alone[..9].copy_from_slice(row);
            times[3..].copy_from_slice(row);
        }
        let columns = triangulate(&mut rows);
        Self { rows, columns }
    }

    /// Returns the ratio of the last pivot but one to the first pivot.
    fn second_pivot(&self) -> f64 {
        (self.rows[10][10] / self.rows[0][0]).abs()
    }

    /// Returns basis vector `which` of the null space, whose dimension is `dimension`.
    fn vector(&self, which: usize, dimension: usize) -> [f64; 12] {
        let mut solution = [0.0; 12];
        solution[11 - which] = 1.0;
        for (k, row) in self.rows.iter().enumerate().take(12 - dimension).rev() {
            let known: f64 = row.iter().zip(&solution).skip(k + 1).map(|(entry, value)| entry * value).sum();
            solution[k] = if row[k] == 0.0 { 0.0 } else { -known / row[k] };
        }
        let mut vector = [0.0; 12];
        for (column, value) in self.columns.into_iter().zip(solution) {
            vector[column] = value;
        }
        vector
    }
}

/// Calls `found` with the angles 3 and 4 (rad) that satisfy the equations at one angle 2.
///
/// The residual of the equations at these angles is less than `limit`.
pub(super) fn angle_pairs(equations: &HalfAngleRows, limit: f64, found: &mut impl FnMut(f64, f64)) {
    let space = NullSpace::new(equations);
    let mut checked = |angle3: f64, angle4: f64| {
        if residual(equations, angle3, angle4) < limit {
            found(angle3, angle4);
        }
    };
    if space.second_pivot() < SMALL_PIVOT {
        several_pairs(equations, &space, &mut checked);
    }
    let [angle3, angle4] = single_pair(&space.vector(0, 1));
    checked(angle3, angle4);
}

/// Returns the angles 3 and 4 (rad) of a vector of the twelve products.
///
/// The ratio of two neighbouring products is the ratio of cosine to sine of half an angle. Each pair (c, s)
/// of neighbouring products adds `c^2`, `c s` and `s^2` to the sums from which the angle follows. So pairs of
/// large products have more weight.
fn single_pair(vector: &[f64; 12]) -> [f64; 2] {
    let squares = |(c, s): (f64, f64)| Vector3::new(c * c, c * s, s * s);
    let third = (0..9).map(|k| (vector[k], vector[k + 3]));
    let fourth = (0..4).flat_map(|k| (0..2).map(move |j| (vector[3 * k + j], vector[3 * k + j + 1])));
    let sums = [third.map(squares).sum::<Vector3<f64>>(), fourth.map(squares).sum()];
    sums.map(|sums| (2.0 * sums.y).atan2(sums.x - sums.z))
}

/// Calls `found` with the angles 3 and 4 (rad) of up to four solutions that share angle 2.
///
/// If fewer solutions share angle 2, some eigenvalues have no meaning, and the caller rejects their angles.
fn several_pairs(equations: &HalfAngleRows, space: &NullSpace, found: &mut impl FnMut(f64, f64)) {
    let vectors: [[f64; 12]; SHARED] = std::array::from_fn(|k| space.vector(k, SHARED));
    let all = SMatrix::<f64, 12, SHARED>::from_fn(|i, k| vectors[k][i]);
    let (low, high) = (all.fixed_rows::<9>(0), all.fixed_rows::<9>(3));
    let (sin, cos) = HALF_ROTATION.sin_cos();
    let (c, s) = (low * cos - high * sin, low * sin + high * cos);
    let Some(inverse) = (c.transpose() * c).try_inverse() else { return };
    let shift: Matrix4<f64> = inverse * (c.transpose() * s);
    let Some(schur) = Schur::try_new(shift, SCHUR_ACCURACY, SCHUR_STEPS) else { return };
    let values = schur.complex_eigenvalues();
    for (k, value) in values.iter().enumerate() {
        let size = 1.0 + value.re.abs();
        let is_same = |other: &Complex<f64>| (value.re - other.re).abs() < SAME_EIGENVALUE * size;
        if value.im.abs() < NEARLY_REAL * size && !values.iter().take(k).any(is_same) {
            let angle3 = 2.0 * (value.re.atan() - HALF_ROTATION);
            fourth_angles(equations, angle3, &mut |angle4| found(angle3, angle4));
        }
    }
}

/// Calls `found` with the values of angle 4 (rad) that satisfy the equations at one angle 3 (rad).
///
/// An equation is a vector of three coefficients: the weights of `cc`, `cs` and `ss`. The cross product
/// of two independent vectors is proportional to the common root. If all six vectors are nearly dependent,
/// both roots of one equation are used. A least-squares solution is not needed, because Newton's method
/// refines the result.
fn fourth_angles(equations: &HalfAngleRows, angle3: f64, found: &mut impl FnMut(f64)) {
    let [cc, cs, ss] = half_angle_terms(angle3);
    let rows = equations.map(|row| {
        let [low, middle, high] = [0, 3, 6].map(|k| Vector3::new(row[k], row[k + 1], row[k + 2]));
        cc * low + cs * middle + ss * high
    });
    let longest = |vectors: [Vector3<f64>; 6]| {
        vectors.into_iter().fold((0.0, Vector3::zeros()), |(square, longest), vector| {
            let own = vector.norm_squared();
            if own > square { (own, vector) } else { (square, longest) }
        })
    };
    let (square, first) = longest(rows);
    let (cross_square, cross) = longest(rows.map(|row| first.cross(&row)));
    if cross_square > INDEPENDENT * square * square {
        let sign = if cross.x + cross.z < 0.0 { -1.0 } else { 1.0 };
        found((sign * 2.0 * cross.y).atan2(sign * (cross.x - cross.z)));
    }
    if cross_square < DEPENDENT * square * square {
        let (sum, difference) = (first.x + first.z, first.x - first.z);
        let (middle, size) = (first.y.atan2(difference), first.y.hypot(difference));
        let half = if size > 0.0 { (-sum / size).clamp(-1.0, 1.0).acos() } else { 0.0 };
        found(middle + half);
        found(middle - half);
    }
}
