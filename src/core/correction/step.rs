//! One Newton step: first the joint changes for the position, then those for the orientation. The latter are
//! in the null space of the position rows of the Jacobian.

use crate::pose::Displacement;
use nalgebra::{DMatrix, DVector};

/// A direction counts as singular if its singular value is below this share of the Frobenius norm of the
/// matrix.
const LOST: f64 = 1e-9;

/// Returns the changes of the joints (rad or m) that cause the displacement `wanted` of the TCP to first
/// order.
///
/// `columns` holds the motion of the TCP per unit of each joint. If the whole displacement is not possible,
/// the position has priority over the rotation. Among several solutions, the function returns the shortest.
pub fn step(columns: &[Displacement], wanted: &Displacement) -> Vec<f64> {
    let n = columns.len();
    let position = DMatrix::from_fn(3, n, |i, j| columns[j].position[i]);
    let rotation = DMatrix::from_fn(3, n, |i, j| columns[j].rotation[i]);
    let (shift, turn) = (vector(wanted.position.as_slice()), vector(wanted.rotation.as_slice()));
    let inverse = inverted(&position);
    let first = &inverse * shift;
    let free = DMatrix::identity(n, n) - &inverse * &position;
    let left = turn - &rotation * &first;
    let second = inverted(&(&rotation * &free)) * left;
    // Because of rounding, `second` may contain a part that moves the position. The product with `free`
    // removes this part.
    (first + &free * second).iter().copied().collect()
}

fn vector(values: &[f64]) -> DVector<f64> {
    DVector::from_row_slice(values)
}

/// Returns the pseudo-inverse of a matrix. Singular directions are ignored.
///
/// A direction is singular if its singular value is below [`LOST`] times the Frobenius norm of the matrix.
fn inverted(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let size = matrix.norm().max(1e-12);
    matrix
        .clone()
        .pseudo_inverse(LOST * size)
        .unwrap_or_else(|_| DMatrix::zeros(matrix.ncols(), matrix.nrows()))
}
