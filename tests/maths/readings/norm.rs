//! Tests `reading::norm` against closed forms, mpmath and Monte Carlo.
//!
//! The tables come from `mpmath` (17 to 25 digits) in real space, without a Laplace transform. The integral
//! `P(|e| <= c) = int phi((c sin t - mu)/sd)/sd c cos t P'(c cos t) dt` adds one component after the other.
//! The probability of the last component is an `erf`. Far from zero, 120 Gauss-Legendre points along each
//! axis replace this integral in three dimensions. Means are the `quad` of `1 - P`. Eigenvalues are squares
//! of `sd`.

use crate::common::cases;
use nalgebra::{Matrix6, Vector6};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::Quantity;
use sweetspot::reading::norm::{CentredBound, NormDistribution};

pub fn vector(values: &[f64]) -> Vector6<f64> {
    Vector6::from_fn(|i, _| values.get(i).copied().unwrap_or(0.0))
}

/// Returns the norm of independent normal components with these standard deviations and means.
fn diagonal(sd: &[f64], mu: &[f64]) -> NormDistribution {
    let columns: Vec<_> =
        (0..sd.len()).map(|i| Vector6::from_fn(|j, _| if i == j { sd[i] } else { 0.0 })).collect();
    NormDistribution::new(sd.len(), &columns, &[], &vector(mu))
}

#[track_caller]
fn close(value: f64, wanted: f64, relative: f64) {
    assert!((value - wanted).abs() <= relative * wanted.abs(), "{value} instead of {wanted}");
}

#[track_caller]
pub fn near(value: f64, wanted: f64, absolute: f64) {
    assert!((value - wanted).abs() <= absolute, "{value} instead of {wanted}");
}

/// Returns `erf(x)` by its series, which is accurate to 1e-15 up to x = 3.
fn erf(x: f64) -> f64 {
    let (mut term, mut sum) = (x, x);
    for n in 1..80 {
        term *= -x * x / n as f64;
        sum += term / (2 * n + 1) as f64;
    }
    sum * 2.0 / std::f64::consts::PI.sqrt()
}

pub fn normal_cdf(x: f64) -> f64 {
    0.5 * (1.0 + erf(x / 2.0_f64.sqrt()))
}

fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt()
}

#[test]
fn the_norm_of_one_component_is_the_folded_normal() {
    let plain = diagonal(&[1.0], &[]);
    // mpmath: sqrt(2) erfinv(p)
    close(plain.quantile(0.5), 0.674489750196082, 1e-10);
    close(plain.quantile(0.95), 1.95996398454005, 1e-10);
    close(plain.quantile(0.99), 2.5758293035489, 1e-10);
    close(plain.mean(), 0.797884560802865, 1e-9);
    for mu in [0.0, 0.1, 0.5, 1.0, 2.0] {
        let norm = diagonal(&[1.0], &[-mu]);
        for c in [0.05, 0.5, 1.0, 1.7, 2.5] {
            near(norm.cdf(c), normal_cdf(c - mu) - normal_cdf(-c - mu), 1e-10);
        }
        close(norm.rms(), (1.0 + mu * mu).sqrt(), 1e-15);
    }
}

#[test]
fn equal_components_give_rayleigh_maxwell_and_chi() {
    for c in [0.01, 0.3, 1.0, 2.0, 3.5] {
        let (u, e) = (0.5 * c * c, (-0.5_f64 * c * c).exp());
        near(diagonal(&[1.0; 2], &[]).cdf(c), -(-u).exp_m1(), 1e-10);
        let maxwell = 2.0 * normal_cdf(c) - 1.0 - 2.0 * c * density(c);
        near(diagonal(&[1.0; 3], &[]).cdf(c), maxwell, 1e-10);
        near(diagonal(&[1.0; 6], &[]).cdf(c), 1.0 - e * (1.0 + u + 0.5 * u * u), 1e-10);
    }
    let rayleigh = diagonal(&[2.0; 2], &[]);
    for p in [1e-6, 0.01, 0.3, 0.5, 0.9, 0.95, 0.99, 0.9999] {
        close(
            rayleigh.quantile(p),
            2.0 * (-2.0 * f64::ln_1p(-p)).sqrt(),
            if p < 0.999 { 1e-10 } else { 1e-8 },
        );
    }
    // sqrt(2) Gamma((m + 1)/2) / Gamma(m/2)
    for (m, mean) in [(2, 1.2533141373155), (3, 1.59576912160573), (6, 2.34996400746656)] {
        close(diagonal(&vec![1.0; m], &[]).mean(), mean, 1e-9);
    }
}

/// Case of a table: sd, mu, then c and P(|e| <= c).
type Case = (&'static [f64], &'static [f64], &'static [(f64, f64)]);

const TABLE: &[Case] = &[
    (
        &[1.0, 1.0],
        &[0.0, 0.0],
        &[
            (0.1, 0.0049875208073),
            (0.5, 0.1175030974154),
            (1.0, 0.3934693402873),
            (2.0, 0.8646647167633),
            (3.0, 0.9888910034617),
        ],
    ),
    (
        &[1.0, 0.31622776601683794],
        &[0.0, 0.0],
        &[
            (0.1, 0.0155966144270),
            (0.5, 0.2922033606730),
            (1.0, 0.6532482538896),
            (2.0, 0.9515141238871),
            (3.0, 0.9971388693999),
        ],
    ),
    (
        &[1.0, 0.03162277660168379],
        &[0.0, 0.0],
        &[
            (0.1, 0.0752474368162),
            (0.5, 0.3822181258786),
            (1.0, 0.6824471575453),
            (2.0, 0.9544727152836),
            (3.0, 0.9972987254217),
        ],
    ),
    (
        &[1.0, 0.001],
        &[0.0, 0.0],
        &[
            (0.1, 0.0796517047278),
            (0.5, 0.3829242184147),
            (1.0, 0.6826892501659),
            (2.0, 0.9544997091081),
            (3.0, 0.9973002024594),
        ],
    ),
    (
        &[1.0, 0.0],
        &[0.0, 0.0],
        &[
            (0.1, 0.0796556745540),
            (0.5, 0.3829249225480),
            (1.0, 0.6826894921370),
            (2.0, 0.9544997361036),
            (3.0, 0.9973002039367),
        ],
    ),
    (
        &[1.0, 1.0],
        &[0.5, 0.3],
        &[
            (0.1, 0.0042095829031),
            (0.5, 0.1001682025605),
            (1.0, 0.3450701849782),
            (2.0, 0.8187215223063),
            (3.0, 0.9794957622066),
        ],
    ),
    (
        &[1.0, 0.1],
        &[0.2, 0.05],
        &[
            (0.1, 0.0394783394883),
            (0.5, 0.3668266110715),
            (1.0, 0.6699949081474),
            (2.0, 0.9498046489314),
            (3.0, 0.9967360614902),
        ],
    ),
    (
        &[1.0, 0.01],
        &[0.5, 0.3],
        &[
            (0.1, 0.0),
            (0.5, 0.2759766655025),
            (1.0, 0.6020516004569),
            (2.0, 0.9235901057204),
            (3.0, 0.9932752913194),
        ],
    ),
    (
        &[1.0],
        &[2.4],
        &[(1.4, 0.1585829058875), (2.0, 0.3445728458457), (2.9, 0.6914624033726), (4.4, 0.9772498680465)],
    ),
    (
        &[1.0],
        &[2.6],
        &[(1.6, 0.1586419081824), (2.2, 0.3445774650615), (3.1, 0.6914624552836), (4.6, 0.9772498680515)],
    ),
    (
        &[1.0],
        &[3.5],
        &[(2.5, 0.1586552529448), (3.1, 0.3445782583691), (4.0, 0.6914624612739), (5.5, 0.9772498680518)],
    ),
    (
        &[1.0],
        &[4.4],
        &[(3.4, 0.1586552539314), (4.0, 0.3445782583896), (4.9, 0.6914624612740), (6.4, 0.9772498680518)],
    ),
    (
        &[1.0],
        &[30.0],
        &[(29.0, 0.1586552539314), (29.6, 0.3445782583896), (30.5, 0.6914624612740), (32.0, 0.9772498680518)],
    ),
    (
        &[1.0, 1.0, 1.0],
        &[0.0, 0.0, 0.0],
        &[(0.892, 0.1494961360568), (1.8, 0.6439187918909), (2.58, 0.9163056060746), (3.4, 0.990947051123)],
    ),
    (
        &[1.0, 0.3, 0.1],
        &[0.0, 0.0, 0.0],
        &[(0.469, 0.2639138334177), (1.11, 0.7105782223387), (1.8, 0.9233268945555), (2.46, 0.9852528823118)],
    ),
    (
        &[1.0, 0.1, 0.001],
        &[0.0, 0.0, 0.0],
        &[
            (0.449, 0.3381181494735),
            (1.07, 0.7132468742674),
            (1.77, 0.9227975149472),
            (2.44, 0.9852286794944),
        ],
    ),
    (
        &[1.0, 1.0, 0.001],
        &[0.0, 0.0, 0.0],
        &[(0.447, 0.0950757134020), (1.48, 0.665527127046), (2.24, 0.9186341396525), (3.0, 0.9888909979073)],
    ),
    (
        &[1.0, 0.5, 0.0],
        &[0.0, 0.0, 0.0],
        &[(0.5, 0.2152887160413), (1.18, 0.6974379891442), (1.85, 0.9223962870827), (2.52, 0.9861250700169)],
    ),
    (
        &[1.0, 0.3, 0.1],
        &[0.1, -0.05, 0.02],
        &[
            (0.472, 0.2628948808126),
            (1.12, 0.7122105587299),
            (1.81, 0.9234007727937),
            (2.48, 0.9855520239024),
        ],
    ),
    (
        &[1.0, 1.0, 1.0],
        &[0.6, 0.3, 0.2],
        &[
            (0.975, 0.1527501086705),
            (1.94, 0.6416444949758),
            (2.78, 0.9168075207965),
            (3.66, 0.9913650436004),
        ],
    ),
    (
        &[1.0, 0.5, 0.2],
        &[1.0, 1.0, 1.0],
        &[(1.36, 0.135366581159), (2.14, 0.6519665080106), (2.89, 0.9190317180376), (3.71, 0.9903971299757)],
    ),
    (
        &[1.0, 0.001, 0.1],
        &[0.3, 2.0, 0.1],
        &[(1.93, 0.0), (2.29, 0.710133082485), (2.72, 0.9217158056653), (3.24, 0.9853984806691)],
    ),
    (
        &[1.0, 0.5, 0.0],
        &[0.2, 0.1, 0.4],
        &[(0.6, 0.171114242593), (1.2, 0.657849912028), (2.0, 0.934279802762), (2.8, 0.992278532291)],
    ),
    (
        &[0.1, 0.05, 0.02],
        &[1.0, 1.0, 1.0],
        &[(1.6, 0.0171273290213), (1.7, 0.3034207915478), (1.75, 0.5996448142641), (1.85, 0.9581526635701)],
    ),
    (
        &[0.03, 0.02, 0.01],
        &[4.0, 0.0, 3.0],
        &[(4.95, 0.0213109389033), (5.0, 0.4991177849665), (5.03, 0.886680457656), (5.06, 0.9921868502487)],
    ),
];

#[test]
fn the_cdf_of_the_norm_agrees_with_the_table() {
    for (sd, mu, values) in TABLE {
        let norm = diagonal(sd, mu);
        for &(c, p) in *values {
            let found = norm.cdf(c);
            assert!((found - p).abs() < 2e-10, "sd {sd:?} mu {mu:?} c {c}: {found} instead of {p}");
            if (0.01..=0.999).contains(&p) {
                close(norm.quantile(p), c, 2e-9);
            }
        }
    }
}

#[test]
fn the_mean_of_the_norm_agrees_with_the_table() {
    let table: [(&[f64], &[f64], f64); 7] = [
        (&[1.0], &[0.0], 0.79788456080287),
        (&[1.0], &[0.5], 0.89559311480261),
        (&[1.0], &[3.0], 3.0007643086341),
        (&[0.1, 1.0], &[0.0, 0.0], 0.810645563451),
        (&[0.001, 1.0], &[0.0, 0.0], 0.79788767017988),
        (&[0.1, 1.0], &[0.05, 0.2], 0.82902081999571),
        (&[0.2, 0.3], &[1.0, 2.0], 2.2473820210247),
    ];
    for (sd, mu, mean) in table {
        close(diagonal(sd, mu).mean(), mean, 1e-9);
    }
    // Far from zero, the mean is |mu| + sd^2 (m - 1) / (2 |mu|); the next term is of order sd^4.
    close(diagonal(&[1e-3; 3], &[0.6, 0.8, 0.0]).mean(), 1.0 + 1e-6, 1e-9);
}

/// Returns random columns.
fn random(rng: &mut ChaCha8Rng, m: usize, count: usize) -> Vec<Vector6<f64>> {
    (0..count)
        .map(|_| Vector6::from_fn(|i, _| if i < m { rng.random_range(-1.0..1.0) } else { 7.0 }))
        .collect()
}

#[test]
fn the_quantile_inverts_the_cdf() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for round in 0..3000 {
        let m = 1 + round % 6;
        let columns = random(&mut rng, m, 1 + round % 9);
        let kurtosis = vec![if round % 4 == 0 { -0.6 } else { 0.0 }; if columns.len() > 4 { 9 } else { 0 }];
        let mean = random(&mut rng, m, 1)[0] * [0.0, 0.1, 1.0, 10.0][round % 4];
        let norm = NormDistribution::new(m, &columns, &kurtosis, &mean);
        for p in [0.003, 0.2, 0.5, 0.95, 0.99] {
            let c = norm.quantile(p);
            near(norm.cdf(c), p, 1e-9);
        }
    }
}

#[test]
fn the_quantile_is_that_of_a_normal_variable_where_one_direction_varies() {
    let norm =
        NormDistribution::new(3, &[vector(&[1.0, 2.0, 2.0]), vector(&[-2.0, -4.0, -4.0])], &[], &vector(&[]));
    close(norm.quantile(0.95), 1.95996398454005 * 45.0_f64.sqrt(), 1e-10);
}

#[test]
fn the_figures_of_the_norm_do_not_depend_on_units_and_axes() {
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    for m in 1..=6 {
        let columns = random(&mut rng, m, 8);
        let mean = random(&mut rng, m, 1)[0] * 0.1;
        let kurtosis = [0.0, -1.2, -0.6, 0.0, -1.2, 0.0, 0.0, -1.2];
        let here = NormDistribution::new(m, &columns, &kurtosis, &mean);
        for scale in [1e-9, 1e-6, 1e3, 1e-200, 1e200] {
            let scaled: Vec<_> = columns.iter().map(|g| g * scale).collect();
            let there = NormDistribution::new(m, &scaled, &kurtosis, &(mean * scale));
            close(there.quantile(0.95), here.quantile(0.95) * scale, 1e-12);
            close(there.mean(), here.mean() * scale, 1e-12);
            close(there.rms(), here.rms() * scale, 1e-12);
            near(there.cdf(1.3 * scale), here.cdf(1.3), 1e-12);
        }
        // A Householder reflection maps the first m axes to other axes.
        let v = vector(&[1.0, -2.0, 0.5, 3.0, 1.5, 0.7][..m]);
        let turn = Matrix6::identity() - v * v.transpose() * (2.0 / v.norm_squared());
        let cut = |g: &Vector6<f64>| Vector6::from_fn(|i, _| if i < m { g[i] } else { 0.0 });
        let turned: Vec<_> = columns.iter().map(|g| turn * cut(g)).collect();
        let there = NormDistribution::new(m, &turned, &kurtosis, &(turn * cut(&mean)));
        close(there.quantile(0.95), here.quantile(0.95), 1e-11);
        close(there.mean(), here.mean(), 1e-11);
    }
}

/// The correction of one component is Edgeworth's series: densities times Hermite polynomials. The sixth
/// cumulant of a sum of uniform parameters is the sum of `100/21 gamma_k^2 g_k^6`.
#[test]
fn the_kurtosis_of_one_component_follows_edgeworths_series() {
    let columns = [vector(&[0.6]), vector(&[0.64]), vector(&[0.48])];
    let four = -1.2 * 0.6_f64.powi(4) - 0.6 * 0.48_f64.powi(4);
    let six = 100.0 / 21.0 * (1.44 * 0.6_f64.powi(6) + 0.36 * 0.48_f64.powi(6));
    let norm = NormDistribution::new(1, &columns, &[-1.2, 0.0, -0.6], &vector(&[]));
    for c in [0.1, 0.5, 1.0, 1.5, 2.0, 2.5] {
        let u: f64 = c * c;
        let he = [u - 3.0, (u - 10.0) * u + 15.0, ((u - 21.0) * u + 105.0) * u - 105.0].map(|he| c * he);
        let sum = four / 24.0 * he[0] + six / 720.0 * he[1] + four * four / 1152.0 * he[2];
        near(norm.cdf(c), 2.0 * normal_cdf(c) - 1.0 - 2.0 * density(c) * sum, 1e-9);
    }
    // With a mean, only the first order of the correction is complete.
    let small = [-1.2e-3, 0.0, -0.6e-3];
    for mu in [0.2, 1.0, 2.0, 5.0, 50.0] {
        let norm = NormDistribution::new(1, &columns, &small, &vector(&[mu]));
        let f = |x: f64| normal_cdf(x) - four * 1e-3 / 24.0 * (x * x * x - 3.0 * x) * density(x);
        for d in [-1.5, -0.3, 0.4, 1.2, 2.2] {
            let c: f64 = mu + d;
            // The series of erf is accurate up to 3, and the far side is negligible beyond 6.5 deviations.
            if c > 0.0 && (c + mu < 4.2 || c + mu > 6.5) {
                let far_side = if c + mu < 4.2 { f(-c - mu) } else { 0.0 };
                near(norm.cdf(c), f(d) - far_side, 2e-8);
            }
        }
    }
}

/// A parameter is a mixture of normal laws with the variances 1 - a, 1 and 1 + a and the weights 1/6, 4/6 and
/// 1/6. The fourth cumulant of this parameter is a^2, and the cumulants six to ten are 0. The exact
/// distribution is the weighted mean of three laws.
#[test]
fn the_kurtosis_of_several_components_follows_a_mixture() {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for round in 0..60 {
        let m = 2 + round % 5;
        // With a mean, the second order of the correction is incomplete.
        let size = [0.0, 0.5, 5.0][round % 3];
        let (a, tolerance): (f64, f64) = if size == 0.0 { (0.3, 1.5e-5) } else { (0.05, 1e-7) };
        let mut columns = random(&mut rng, m, m + 2);
        (columns[0], columns[1]) = (columns[0] * 2.0, columns[1] * 2.0);
        let mean = random(&mut rng, m, 1)[0] * size;
        let normal = NormDistribution::new(m, &columns, &[], &mean);
        let corrected = NormDistribution::new(m, &columns, &[a * a, a * a], &mean);
        let cases = [(1.0 - a, 1.0), (1.0, 4.0), (1.0 + a, 1.0)];
        let mut parts = Vec::new();
        for (first, p) in cases {
            for (second, q) in cases {
                let mut columns = columns.clone();
                (columns[0], columns[1]) = (columns[0] * first.sqrt(), columns[1] * second.sqrt());
                parts.push((p * q / 36.0, NormDistribution::new(m, &columns, &[], &mean)));
            }
        }
        let mut largest = 0.0_f64;
        for p in [0.1, 0.3, 0.6, 0.9, 0.97] {
            let c = normal.quantile(p);
            let exact = parts.iter().map(|(weight, part)| weight * part.cdf(c)).sum::<f64>();
            near(corrected.cdf(c), exact, tolerance);
            largest = largest.max((exact - p).abs());
        }
        assert!(largest > 30.0 * tolerance, "nothing to see in round {round}: {largest}");
    }
}

/// Returns P(|sum_k w_k u_k| <= c) with `u_k` uniform on -1..1: the box spline of three.
pub fn three_uniforms(w: [f64; 3], c: f64) -> f64 {
    let mut sum = 0.0;
    for signs in 0..8 {
        let sign = |k: usize| if signs >> k & 1 == 1 { 1.0 } else { -1.0 };
        let reach = c + (0..3).map(|k| sign(k) * w[k]).sum::<f64>();
        sum += sign(0) * sign(1) * sign(2) * reach.max(0.0).powi(3);
    }
    2.0 * sum / (6.0 * 8.0 * w[0] * w[1] * w[2]) - 1.0
}

#[test]
fn three_uniform_parameters_are_nearly_exact() {
    let w = [1.0, 0.8, 0.6];
    near(three_uniforms(w, 2.4), 1.0, 1e-12);
    let columns = w.map(|w| vector(&[w / 3.0_f64.sqrt()]));
    let corrected = NormDistribution::new(1, &columns, &[-1.2; 3], &vector(&[]));
    let normal = NormDistribution::new(1, &columns, &[], &vector(&[]));
    let worst = |norm: &NormDistribution| {
        let off = |k: u32| (norm.cdf(0.05 * f64::from(k)) - three_uniforms(w, 0.05 * f64::from(k))).abs();
        (1..60).map(off).fold(0.0, f64::max)
    };
    assert!(worst(&corrected) < 0.004, "{}", worst(&corrected));
    assert!(worst(&normal) > 0.012, "{}", worst(&normal));
}

#[test]
fn ten_uniform_parameters_agree_with_monte_carlo() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let columns = random(&mut rng, 3, 10);
    let mean = vector(&[0.2, -0.3, 0.1]);
    let norm = NormDistribution::new(3, &columns, &[-1.2; 10], &mean);
    let mut lengths: Vec<f64> = (0..2_000_000)
        .map(|_| {
            let mut e = mean;
            for g in &columns {
                e += g * rng.random_range(-1.0..1.0) * 3.0_f64.sqrt();
            }
            (e.x * e.x + e.y * e.y + e.z * e.z).sqrt()
        })
        .collect();
    let count = lengths.len() as f64;
    close(lengths.iter().sum::<f64>() / count, norm.mean(), 0.002);
    close((lengths.iter().map(|c| c * c).sum::<f64>() / count).sqrt(), norm.rms(), 0.002);
    for p in [0.5, 0.9, 0.95, 0.99] {
        let at = (p * count) as usize;
        let (_, c, _) = lengths.select_nth_unstable_by(at, f64::total_cmp);
        close(norm.quantile(p), *c, 0.002);
    }
    let normal = NormDistribution::new(3, &columns, &[], &mean);
    assert!((normal.quantile(0.99) / norm.quantile(0.99) - 1.0).abs() > 0.01, "kurtosis does not show");
}

#[test]
fn the_norm_without_covariance_is_the_mean() {
    for columns in [vec![], vec![vector(&[0.0; 6]); 5]] {
        let norm = NormDistribution::new(3, &columns, &[], &vector(&[3.0, 0.0, 4.0]));
        for value in [norm.rms(), norm.mean(), norm.quantile(0.01), norm.quantile(0.99)] {
            close(value, 5.0, 1e-15);
        }
        assert_eq!((norm.cdf(4.999), norm.cdf(5.001)), (0.0, 1.0));
        let nothing = NormDistribution::new(2, &columns, &[], &vector(&[]));
        assert_eq!([nothing.rms(), nothing.mean(), nothing.quantile(0.5)], [0.0; 3]);
        assert_eq!((nothing.cdf(0.0), nothing.cdf(-1.0)), (1.0, 0.0));
    }
}

/// The norm far from zero is normal about `|mu| + sd^2 (m - 1)/(2 |mu|)`, up to terms of third order.
#[test]
fn the_norm_far_from_zero_is_normal() {
    for sd in [1e-4, 1e-6, 1e-8] {
        let norm = diagonal(&[sd; 3], &[6.0, 0.0, -8.0]);
        for (p, z) in
            [(0.05, -1.64485362695147), (0.5, 0.0), (0.95, 1.64485362695147), (0.99, 2.32634787404084)]
        {
            near((norm.quantile(p) - 10.0 - sd * sd / 10.0) / sd, z, 20.0 * sd + 1e-14 / sd);
        }
        for (c, p) in [(0.0, 0.0), (9.99, 0.0), (10.01, 1.0), (1e9, 1.0)] {
            near(norm.cdf(c), p, 1e-12);
        }
    }
}

/// The figures have no jump at the transition from the parabola to the hyperbola.
#[test]
fn the_figures_of_the_norm_are_continuous_in_the_mean() {
    for m in 1..=6 {
        let sd: Vec<f64> = (0..m).map(|i| [1.0, 0.5, 0.1, 0.7, 0.02, 0.3][i]).collect();
        let at = |t: f64| diagonal(&sd, &sd.iter().map(|s| s * t).collect::<Vec<_>>());
        let step = 1e-3;
        for k in 1..4000 {
            let t = step * f64::from(k);
            let [a, b, c] = [t - step, t, t + step].map(|t| at(t).cdf(1.0));
            assert!((a - 2.0 * b + c).abs() < 12.0 * step * step * m as f64, "m {m} t {t}: {a} {b} {c}");
        }
    }
}

#[test]
fn the_figures_of_the_norm_are_finite_and_ordered() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    for round in 0..cases(10_000, 100_000) {
        let m = rng.random_range(1..=6);
        let count = rng.random_range(0..8);
        let size = |rng: &mut ChaCha8Rng| match rng.random_range(0..4) {
            0 => 0.0,
            1 => 1.0,
            _ => 10.0_f64.powf(rng.random_range(-12.0..3.0)),
        };
        let mut columns = random(&mut rng, m, count);
        for g in &mut columns {
            *g *= size(&mut rng);
            g[rng.random_range(0..6)] *= size(&mut rng);
        }
        let kurtosis: Vec<f64> = columns.iter().map(|_| [0.0, -1.2, -0.6][rng.random_range(0..3)]).collect();
        let mean = random(&mut rng, m, 1)[0] * size(&mut rng);
        let norm = NormDistribution::new(m, &columns, if round % 2 == 0 { &kurtosis } else { &[] }, &mean);
        let (rms, low, high) = (norm.rms(), norm.quantile(0.5), norm.quantile(0.99));
        assert!(rms.is_finite() && low.is_finite() && high.is_finite(), "{rms} {low} {high}");
        assert!(0.0 <= low && low <= high * (1.0 + 1e-9), "{low} {high}");
        assert!(high <= 10.0 * rms * (1.0 + 1e-9), "{high} {rms}");
        let c = rms * 10.0_f64.powf(rng.random_range(-3.0..1.5));
        assert!((0.0..=1.0).contains(&norm.cdf(c)));
        if round % 10 == 0 {
            let mean = norm.mean();
            assert!(mean.is_finite() && mean <= rms * (1.0 + 1e-9), "{mean} > {rms}");
        }
    }
}

/// The lower bound of a figure is below the exact figure for random covariances, with and without a mean.
/// Without a mean, the bound is close to the figure.
#[test]
fn the_bound_of_a_centred_vector_is_below_the_exact_figure() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    for rows in 1..=3 {
        let (mut least, mut least_of_mean) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..2000 {
            let flat = 10f64.powf(rng.random_range(-4.0..0.0));
            let columns: Vec<Vector6<f64>> = (0..rng.random_range(rows..=6))
                .map(|_| {
                    let mut column = Vector6::zeros();
                    (0..rows).for_each(|k| column[k] = rng.random_range(-1.0..1.0));
                    column[rows - 1] *= flat;
                    column
                })
                .collect();
            let entry = |i: usize, j: usize| columns.iter().map(|c| c[i] * c[j]).sum::<f64>();
            let entries = [entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)];
            let mut mean = Vector6::zeros();
            (0..rows).for_each(|k| mean[k] = rng.random_range(-0.5..0.5));
            for quantity in [Quantity::Rms, Quantity::Mean, Quantity::P95, Quantity::P99] {
                let figure = |mean: &Vector6<f64>| {
                    let norm = NormDistribution::new(rows, &columns, &[], mean);
                    match quantity {
                        Quantity::Rms => norm.rms(),
                        Quantity::Mean => norm.mean(),
                        Quantity::P99 => norm.quantile(0.99),
                        _ => norm.quantile(0.95),
                    }
                };
                let bound = CentredBound::new(quantity, rows).unwrap().of(&entries);
                let centred = figure(&Vector6::zeros());
                assert!(bound <= centred && bound <= figure(&mean), "{quantity:?} {columns:?} {mean:?}");
                if quantity == Quantity::Mean {
                    least_of_mean = least_of_mean.min(bound / centred);
                } else {
                    least = least.min(bound / centred);
                }
            }
        }
        let near = if rows == 1 { 0.999_999 } else { 0.999_8 };
        assert!(least > near, "{rows} rows: {least}");
        assert!(least_of_mean > near - 0.002, "{rows} rows: {least_of_mean}");
    }
}

/// The bounds of a figure enclose the exact figure between the samples of the table.
#[test]
fn the_bounds_of_a_centred_vector_hold_at_every_ratio_of_variances() {
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    for rows in 2..=3 {
        let bounds = [Quantity::Mean, Quantity::P95, Quantity::P99]
            .map(|quantity| (quantity, CentredBound::new(quantity, rows).unwrap()));
        for k in 0..cases(5000, 100_000) {
            let mut ratio = || match k % 2 {
                0 => rng.random_range(0.0..1.0),
                _ => 10f64.powf(rng.random_range(-5.0..0.0)),
            };
            let variances = [1.0, ratio(), if rows == 3 { ratio() } else { 0.0 }];
            let deviations = variances.map(f64::sqrt);
            let norm = diagonal(&deviations[..rows], &[]);
            for (quantity, bound) in &bounds {
                let figure = match quantity {
                    Quantity::Mean => norm.mean(),
                    Quantity::P99 => norm.quantile(0.99),
                    _ => norm.quantile(0.95),
                };
                let [x, y, z] = variances;
                let entries = [x, y, z, 0.0, 0.0, 0.0];
                let (least, most) = (bound.of(&entries), bound.most(&entries));
                assert!(
                    least <= figure && figure <= most,
                    "{quantity:?} {variances:?}: {least} {figure} {most}"
                );
                let gap = if *quantity == Quantity::Mean { 0.04 } else { 0.0003 };
                assert!(most - least < gap * figure, "{quantity:?} {variances:?}: {least} {figure} {most}");
            }
        }
    }
}
