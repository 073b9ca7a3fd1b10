//! Groups of nearly equal points.

/// Returns groups of points, as indices. The coordinates of every member differ from those of the first
/// member by at most `tolerance`.
///
/// The first point without a group, in the order of the list, begins a group. All points near this point that
/// have no group yet join its group. The groups and their members are in the order of the list. All points
/// must have the same number of coordinates.
pub fn clusters<P: AsRef<[f64]>>(points: &[P], tolerance: f64) -> Vec<Vec<usize>> {
    let spread = |k: usize| {
        let all = points.iter().filter_map(|p| p.as_ref().get(k));
        let (low, high) = all.fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        high - low
    };
    let dimensions = points.first().map_or(0, |p| p.as_ref().len());
    // Candidates for neighbours are found by the coordinate with the greatest range.
    let widest = (0..dimensions).max_by(|a, b| spread(*a).total_cmp(&spread(*b))).unwrap_or(0);
    let along = |i: usize| points[i].as_ref().get(widest).copied().unwrap_or(0.0);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|a, b| along(*a).total_cmp(&along(*b)));
    let is_near = |i: usize, j: usize| {
        let pairs = points[i].as_ref().iter().zip(points[j].as_ref());
        pairs.into_iter().all(|(a, b)| (a - b).abs() <= tolerance)
    };
    let mut is_free = vec![true; points.len()];
    let mut groups = Vec::new();
    for first in 0..points.len() {
        if !is_free[first] {
            continue;
        }
        let from = order.partition_point(|i| along(*i) < along(first) - tolerance);
        let near = order[from..].iter().take_while(|i| along(**i) <= along(first) + tolerance);
        let mut members: Vec<usize> =
            near.copied().filter(|&i| i == first || is_free[i] && is_near(first, i)).collect();
        members.sort_unstable();
        members.iter().for_each(|&i| is_free[i] = false);
        groups.push(members);
    }
    groups
}
