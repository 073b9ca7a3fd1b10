//! Statistics of the distances between measured and predicted positions.

/// Mean, root mean square, 95th percentile and maximum of distances, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    pub mean: f64,
    pub rms: f64,
    /// Smallest distance that at least 95 % of the distances do not exceed.
    pub p95: f64,
    pub max: f64,
}

impl Accuracy {
    /// Returns the statistics of distances (m); None if the list is empty.
    pub fn of(mut distances: Vec<f64>) -> Option<Self> {
        distances.sort_by(f64::total_cmp);
        let (count, max) = (distances.len(), *distances.last()?);
        let mean = distances.iter().sum::<f64>() / count as f64;
        let rms = (distances.iter().map(|d| d * d).sum::<f64>() / count as f64).sqrt();
        let p95 = distances[(count * 19).div_ceil(20) - 1];
        Some(Self { mean, rms, p95, max })
    }
}
