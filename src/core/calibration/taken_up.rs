//! Least-squares fit of base and reflectors to random displacements of the measured positions. The fit
//! absorbs a part of these displacements.

use nalgebra::{DMatrix, Vector3};

/// Jacobians of one position: first for the random motions, then for the motions of the fitted frames.
///
/// Each Jacobian has three rows (m, base frame) and one column for each motion.
pub type PositionJacobians = (DMatrix<f64>, DMatrix<f64>);

/// Returns the matrix with the given columns, m per unit of the motion.
pub fn jacobian(slopes: impl Iterator<Item = Vector3<f64>>) -> DMatrix<f64> {
    let columns: Vec<_> = slopes.collect();
    DMatrix::from_fn(3, columns.len(), |i, k| columns[k][i])
}

/// Returns, for each random motion, the steps of the fitted frames that reproduce it best (least squares).
/// Each column of the result belongs to one random motion.
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
