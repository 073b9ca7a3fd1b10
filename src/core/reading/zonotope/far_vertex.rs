//! Far vertex of a zonotope, found by ascent in little computing time. It may not be the farthest vertex.
//!
//! For each direction d, the vertex `sum_k sign(d . g_k) g_k` has the largest component along d. This
//! component is `sum_k |d . g_k|`. The search evaluates it for [`DIRECTIONS`] directions that cover half of
//! the circle (2-D) or half of the sphere (3-D). It starts at the direction with the largest component, and
//! then goes from each vertex to the vertex in the direction of this vertex. The distance from the origin
//! never decreases. In more dimensions, the search starts at the longest generator.

use nalgebra::Vector6;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Number of directions among which the search chooses its start.
const DIRECTIONS: usize = 16;
/// Largest number of vertices that the search visits.
const MAX_STEPS: usize = 6;

/// Components of the start directions: one array per axis, for 2-D and for 3-D.
static STARTS: LazyLock<[[[f64; DIRECTIONS]; 3]; 2]> = LazyLock::new(|| {
    let share = |k: usize| (k as f64 + 0.5) / DIRECTIONS as f64;
    let plane = |k: usize| (PI * share(k)).sin_cos();
    // Points of equal areas along a spiral on the upper half of the sphere.
    let golden = PI * (3.0 - 5f64.sqrt());
    let level = |k: usize| (1.0 - share(k).powi(2)).sqrt();
    let turned = |k: usize| (golden * k as f64).sin_cos();
    let of = |component: &dyn Fn(usize) -> f64| std::array::from_fn(component);
    [
        [of(&|k| plane(k).1), of(&|k| plane(k).0), [0.0; DIRECTIONS]],
        [of(&|k| level(k) * turned(k).1), of(&|k| level(k) * turned(k).0), of(&share)],
    ]
});

/// Returns a vertex of the zonotope that is far from the origin: a sum of all generators, each with the sign
/// +1 or -1.
///
/// The components of the generators after the first `rows` components must be 0.
pub fn far_vertex(generators: &[Vector6<f64>], rows: usize) -> Vector6<f64> {
    let mut direction = match rows {
        0 | 1 => Vector6::x(),
        2 => best_start(generators, &STARTS[0]),
        3 => best_start(generators, &STARTS[1]),
        _ => {
            let by_length =
                |a: &&Vector6<f64>, b: &&Vector6<f64>| a.norm_squared().total_cmp(&b.norm_squared());
            generators.iter().max_by(by_length).copied().unwrap_or_default()
        }
    };
    let (mut farthest, mut distance) = (Vector6::zeros(), 0.0);
    for _ in 0..MAX_STEPS {
        let mut sum = Vector6::zeros();
        for g in generators {
            sum += if g.dot(&direction) < 0.0 { -g } else { *g };
        }
        let reached = sum.norm_squared();
        if reached <= distance {
            break;
        }
        (farthest, distance, direction) = (sum, reached, sum);
    }
    farthest
}

/// Returns the start direction with the largest component.
fn best_start(generators: &[Vector6<f64>], starts: &[[f64; DIRECTIONS]; 3]) -> Vector6<f64> {
    let [x, y, z] = starts;
    let mut components = [0.0; DIRECTIONS];
    for g in generators {
        for k in 0..DIRECTIONS {
            components[k] += (g[0] * x[k] + g[1] * y[k] + g[2] * z[k]).abs();
        }
    }
    let best = (0..DIRECTIONS).max_by(|a, b| components[*a].total_cmp(&components[*b])).unwrap_or(0);
    Vector6::new(x[best], y[best], z[best], 0.0, 0.0, 0.0)
}
