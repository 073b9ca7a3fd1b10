//! Least-squares fit of base and reflectors to displacements of the measured positions. Errors of the arm
//! cause these displacements. The fit absorbs a part of them.

use nalgebra::{DMatrix, Vector3};

/// Two Jacobians of one position: one for the errors of the arm, and one for the unknowns of base and
/// reflectors.
///
/// Each Jacobian has three rows (m, base frame) and one column for each error or unknown.
pub type PositionJacobians = (DMatrix<f64>, DMatrix<f64>);

/// Returns a Jacobian of one position. Each column, given in `slopes`, is the displacement of the position,
/// m, per unit of one error or unknown.
pub fn jacobian(slopes: impl Iterator<Item = Vector3<f64>>) -> DMatrix<f64> {
    let columns: Vec<_> = slopes.collect();
    DMatrix::from_fn(3, columns.len(), |i, k| columns[k][i])
}

/// Returns the changes of base and reflectors that best reproduce the displacements caused by each error
/// (least squares). Each column of the result belongs to one error of the arm.
///
/// Each entry of `columns` belongs to one position. Returns None if `columns` is empty, or if the Cholesky
/// factorization of the normal matrix fails.
pub fn taken_up(columns: &[PositionJacobians]) -> Option<DMatrix<f64>> {
    let (of_chain, of_frames) = columns.first()?;
    let (unknowns, frames) = (of_chain.ncols(), of_frames.ncols());
    let mut normal = DMatrix::identity(frames, frames) * 1e-12;
    let mut right = DMatrix::zeros(frames, unknowns);
    for (of_chain, of_frames) in columns {
        normal += of_frames.transpose() * of_frames;
        right += of_frames.transpose() * of_chain;
    }
    Some(normal.cholesky()?.solve(&right))
}
