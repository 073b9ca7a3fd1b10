//! Rigid factors: independent random factors of the rigid error sources. A source is called rigid if it is
//! correlated with other sources and not elastic. The factors exclude the part of the rigid sources that
//! correlates with elastic sources.

use crate::reading::ErrorSources;
use nalgebra::DMatrix;

/// An eigenvalue of a correlation matrix counts as a rounding error if it is below this value.
const ROUNDING: f64 = 1e-12;

/// Returns independent normal factors of the correlated sources that are not elastic. A factor is a list of
/// pairs (index of a source, value at one standard deviation).
///
/// The factors describe the part of these sources that is independent of the elastic sources: the
/// conditional covariance `C_rr - C_re C_ee^+ C_er`. Without elastic sources, the factors are
/// [`ErrorSources::factors`].
///
/// Let x be the rigid sources, y the elastic sources, and `A x + B y` the error. Let M be `C_re C_ee^+`. The
/// error then equals `A (x - M y) + (A M + B) y`. The two terms are independent. Every statistic of the error
/// is therefore at least the statistic of the first term (T. W. Anderson, Proc. Amer. Math. Soc. 6 (1955)
/// 170-176).
pub(super) fn rigid_factors(sources: &ErrorSources) -> Vec<Vec<(usize, f64)>> {
    let is_elastic = |k: usize| sources.list[k].parameter.is_elastic();
    let mut correlated: Vec<usize> = sources.factors.iter().flatten().map(|&(k, _)| k).collect();
    correlated.sort_unstable();
    correlated.dedup();
    if !correlated.iter().any(|&k| is_elastic(k)) {
        return sources.factors.clone();
    }
    let (elastic, rigid): (Vec<usize>, Vec<usize>) = correlated.iter().partition(|&&k| is_elastic(k));
    // The entries are in units of the standard deviations, because parameters have different units.
    let value = |factor: &Vec<(usize, f64)>, k: usize| -> f64 {
        factor.iter().filter(|(source, _)| *source == k).map(|(_, value)| value).sum()
    };
    let part = |list: &[usize]| {
        DMatrix::from_fn(list.len(), sources.factors.len(), |i, f| {
            let deviation = sources.list[list[i]].deviation;
            if deviation > 0.0 { value(&sources.factors[f], list[i]) / deviation } else { 0.0 }
        })
    };
    let (of_rigid, of_elastic) = (part(&rigid), part(&elastic));
    let across = &of_rigid * of_elastic.transpose();
    let own = &of_elastic * of_elastic.transpose();
    let Ok(inverse) = own.pseudo_inverse(ROUNDING) else { return Vec::new() };
    let left = &of_rigid * of_rigid.transpose() - &across * inverse * across.transpose();
    let eigen = ((&left + left.transpose()) / 2.0).symmetric_eigen();
    let axes = (0..rigid.len()).filter(|&f| eigen.eigenvalues[f] > ROUNDING);
    let factor = |f: usize| {
        let size = eigen.eigenvalues[f].sqrt();
        let entry =
            |(row, &k): (usize, &usize)| (k, eigen.eigenvectors[(row, f)] * size * sources.list[k].deviation);
        rigid.iter().enumerate().map(entry).collect()
    };
    axes.map(factor).collect()
}
