//! Tests distributions in which bounded parameters dominate against closed forms and plain random draws.

use crate::common::cases;
use crate::readings::bench::*;
use crate::readings::norm::{near, normal_cdf, three_uniforms, vector};
use nalgebra::Vector6;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use sweetspot::cell::*;
use sweetspot::reading::norm::{ConditionalScratch, NormDistribution, NormLaw, PowerNormal};
use sweetspot::units::rad_from_deg;

/// Largest relative error of a percentile with few and with many parameters. The documented limit is 1 %.
const PERCENTILE: [f64; 2] = [0.006, 0.009];
/// Largest error of a yield here. The documented limit is 0.005, and the draws themselves may be wrong by
/// 0.002.
const SHARE: f64 = 0.003;

/// Returns the half width of a distribution with unit variance.
fn half(distribution: Distribution) -> f64 {
    if distribution == Distribution::Triangular { 6f64.sqrt() } else { 3f64.sqrt() }
}

/// Calls `check` with the law of one component, whose bounded effects have the half widths `widths`.
fn of_one_component(effects: &[(f64, Distribution)], check: impl Fn(&NormLaw<'_>)) {
    let columns: Vec<_> = effects.iter().map(|(effect, _)| vector(&[*effect])).collect();
    let distributions: Vec<_> = effects.iter().map(|e| e.1).collect();
    let mut scratch = ConditionalScratch::default();
    let law = NormLaw::new(1, &columns, &distributions, &vector(&[]), &mut scratch);
    assert!(matches!(law, NormLaw::Bounded(_)), "nothing dominates");
    check(&law);
}

#[test]
fn one_bounded_parameter_has_its_own_distribution() {
    of_one_component(&[(2.0, Distribution::Uniform)], |law| {
        let width = 2.0 * 3f64.sqrt();
        for p in [0.01, 0.3, 0.5, 0.95, 0.99] {
            near(law.quantile(p), p * width, 1e-9 * width);
            near(law.cdf(p * width), p, 1e-9);
        }
        near(law.mean(), 0.5 * width, 1e-6 * width);
        near(law.rms(), 2.0, 1e-12);
        assert_eq!((law.cdf(width * 1.001), law.cdf(-1.0)), (1.0, 0.0));
    });
    of_one_component(&[(-2.0, Distribution::Triangular)], |law| {
        let width = 2.0 * 6f64.sqrt();
        for p in [0.01, 0.3, 0.5, 0.95, 0.99] {
            near(law.quantile(p), width * (1.0 - (1.0f64 - p).sqrt()), 1e-8 * width);
        }
        near(law.mean(), width / 3.0, 1e-5 * width);
    });
}

#[test]
fn sums_of_uniform_parameters_have_piecewise_polynomial_distributions() {
    let w = [1.0, 0.8, 0.6];
    of_one_component(&w.map(|w| (w / 3f64.sqrt(), Distribution::Uniform)), |law| {
        for k in 1..60 {
            near(law.cdf(0.05 * f64::from(k)), three_uniforms(w, 0.05 * f64::from(k)), 0.002);
        }
        for p in [0.95, 0.99] {
            near(three_uniforms(w, law.quantile(p)), p, 0.05 * (1.0 - p));
        }
    });
    // The last of three widths is nearly 0, so the density is nearly a trapezoid.
    let w = [1.0, 0.5, 1e-4];
    of_one_component(&[w[0], w[1]].map(|w| (w / 3f64.sqrt(), Distribution::Uniform)), |law| {
        for p in [0.5, 0.95, 0.99] {
            near(three_uniforms(w, law.quantile(p)), p, 2e-4);
        }
    });
}

/// P(|u + s z| <= c) for u uniform on -1..1 and normal z is the mean of a normal probability over u.
#[test]
fn a_uniform_and_a_normal_parameter_convolve() {
    let parts = 20_000;
    let step = 2.0 / f64::from(parts);
    for s in [0.001, 0.05, 0.2, 0.5, 0.8] {
        let exact = |c: f64| {
            let below = |x: f64| normal_cdf((x / s).clamp(-4.0, 4.0));
            let within = |u: f64| below(c - u) - below(-c - u);
            (0..parts).map(|k| within(-1.0 + step * (f64::from(k) + 0.5))).sum::<f64>() * step / 2.0
        };
        let effects = [(s, Distribution::Normal), (1.0 / 3f64.sqrt(), Distribution::Uniform)];
        of_one_component(&effects, |law| {
            for c in [0.1, 0.5, 0.9, 1.1, 1.4] {
                near(law.cdf(c), exact(c), 5e-4);
            }
        });
    }
}

/// Returns random effects in `m` components, the first of which dominates with a share of 20 to 95 %.
fn dominated(rng: &mut ChaCha8Rng, m: usize, first: Distribution) -> (Vec<Vector6<f64>>, Vec<Distribution>) {
    let count = rng.random_range(1..9);
    let mut columns: Vec<Vector6<f64>> = (0..=count)
        .map(|_| Vector6::from_fn(|i, _| if i < m { rng.random_range(-1.0..1.0) } else { 0.0 }))
        .collect();
    let mut distributions: Vec<_> = (0..=count).map(|_| Distribution::ALL[rng.random_range(0..3)]).collect();
    distributions[0] = first;
    let share = rng.random_range(0.2f64..0.95);
    let others: f64 = columns[1..].iter().map(Vector6::norm_squared).sum();
    let scale = (share / (1.0 - share) * others / columns[0].norm_squared()).sqrt();
    columns[0] *= scale;
    (columns, distributions)
}

/// Returns a standard normal number (Box and Muller).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt() * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}

/// Returns the sorted norms of plain random draws.
fn drawn(
    rng: &mut ChaCha8Rng,
    columns: &[Vector6<f64>],
    distributions: &[Distribution],
    mean: &Vector6<f64>,
    count: usize,
) -> Vec<f64> {
    let mut one = |d: Distribution| match d {
        Distribution::Uniform => half(d) * rng.random_range(-1.0..1.0),
        Distribution::Triangular => half(d) * (rng.random::<f64>() - rng.random::<f64>()),
        Distribution::Normal => normal(rng),
    };
    let mut norms: Vec<f64> = (0..count)
        .map(|_| {
            let terms = columns.iter().zip(distributions).map(|(g, d)| g * one(*d));
            (mean + terms.sum::<Vector6<f64>>()).norm()
        })
        .collect();
    norms.sort_by(f64::total_cmp);
    norms
}

/// Returns 9 to 40 random effects in `m` components, none or a few of which dominate, along axes of unequal
/// length.
fn crowded(rng: &mut ChaCha8Rng, m: usize) -> (Vec<Vector6<f64>>, Vec<Distribution>) {
    let spread = rng.random_range(0.0..1.6);
    let axes: [f64; 6] = std::array::from_fn(|_| 10f64.powf(-rng.random_range(0.0..1.2)));
    let count = rng.random_range(9..40);
    let column = |rng: &mut ChaCha8Rng| {
        let size = (spread * normal(rng)).exp();
        Vector6::from_fn(|i, _| if i < m { size * axes[i] * normal(rng) } else { 0.0 })
    };
    let columns = (0..count).map(|_| column(rng)).collect();
    let bounded = [Distribution::Uniform, Distribution::Triangular];
    let distributions = (0..count).map(|k| match k % 4 {
        3 if count % 2 == 0 => Distribution::Normal,
        _ => bounded[rng.random_range(0..2)],
    });
    (columns, distributions.collect())
}

/// Largest deviations of the percentiles, the shares and the mean of a law from the values of plain random
/// draws.
#[derive(Debug, Default)]
struct Deviations {
    percentile: f64,
    share: f64,
    mean: f64,
}

impl Deviations {
    /// Compares a law with the sorted norms of random draws, allows for the uncertainty of the draws, and
    /// records the deviations.
    fn compare(&mut self, law: &NormLaw<'_>, norms: &[f64], percentile: f64, what: &str) {
        let count = norms.len() as f64;
        for p in [0.5, 0.95, 0.99] {
            // The uncertainty of a percentile of plain draws is one standard deviation of its rank. Four
            // standard deviations are allowed.
            let rank = |by: f64| {
                let at = p * count + by * (p * (1.0 - p) * count).sqrt();
                norms[(at as usize).min(norms.len() - 1)]
            };
            let quantile = law.quantile(p);
            let (low, high) = (rank(-4.0) * (1.0 - percentile), rank(4.0) * (1.0 + percentile));
            self.percentile = self.percentile.max((quantile / rank(0.0) - 1.0).abs());
            assert!((low..=high).contains(&quantile), "{quantile} not in {low}..{high}, p {p}, {what}");
        }
        for p in [0.1, 0.3, 0.5, 0.7, 0.9, 0.98] {
            let c = norms[(p * count) as usize];
            let noise = 4.0 * (p * (1.0 - p) / count).sqrt();
            self.share = self.share.max((law.cdf(c) - p).abs());
            assert!((law.cdf(c) - p).abs() < SHARE + noise, "{} {p} at {c}, {what}", law.cdf(c));
        }
        let sampled = norms.iter().sum::<f64>() / count;
        self.mean = self.mean.max((law.mean() / sampled - 1.0).abs());
        assert!((law.mean() / sampled - 1.0).abs() < 0.004, "{} {sampled}, {what}", law.mean());
    }
}

/// A polynomial of a normal variable has the requested variance and excess kurtosis.
#[test]
fn a_power_normal_variable_has_its_excess_kurtosis() {
    for kurtosis in [0.0, -0.01, -0.1, -0.3, -0.6] {
        let law = PowerNormal::with_excess_kurtosis(kurtosis);
        let (parts, end) = (40_000, 9.0);
        let step = 2.0 * end / f64::from(parts);
        let mut moments = [0.0; 3];
        for k in 0..parts {
            let z = -end + step * (f64::from(k) + 0.5);
            let (density, x) = ((-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt() * step, law.value(z));
            [1.0, x * x, x.powi(4)].iter().zip(&mut moments).for_each(|(x, sum)| *sum += density * x);
        }
        near(moments[0], 1.0, 1e-9);
        near(moments[1], 1.0, 2e-3);
        near(moments[2] - 3.0, kurtosis, 0.02);
    }
    assert_eq!(PowerNormal::with_excess_kurtosis(f64::NAN).value(-2.5), -2.5);
}

/// Every mix of distributions agrees with plain random draws, for every number of components. Each kind of
/// distribution dominates in turn, and some mixes have many parameters of any kind.
#[test]
fn percentiles_and_yields_of_random_mixes_agree_with_random_draws() {
    let mut rng = ChaCha8Rng::seed_from_u64(71);
    let mut scratch = ConditionalScratch::default();
    let (mut bounded, mut normal) = ([0; 2], [0; 2]);
    let mut deviations = Deviations::default();
    for round in 0..cases(30, 600) {
        let is_crowded = round / 6 % 2;
        let m = [1, 2, 3, 1, 2, 6][round / 3 % 6];
        let (columns, distributions) = match is_crowded {
            0 => dominated(&mut rng, m, Distribution::ALL[round % 3]),
            _ => crowded(&mut rng, m),
        };
        let trace: f64 = columns.iter().map(Vector6::norm_squared).sum();
        let mut mean = vector(&[]);
        if round % 2 == 0 {
            (0..m).for_each(|i| mean[i] = 0.3 * trace.sqrt() * rng.random_range(-1.0..1.0));
        }
        let law = NormLaw::new(m, &columns, &distributions, &mean, &mut scratch);
        let of_law = if matches!(law, NormLaw::Bounded(_)) { &mut bounded } else { &mut normal };
        of_law[is_crowded] += 1;
        let norms = drawn(&mut rng, &columns, &distributions, &mean, 1_000_000);
        let what = format!("round {round}: m {m}, {distributions:?} {columns:?} {mean:?}");
        deviations.compare(&law, &norms, PERCENTILE[is_crowded], &what);
    }
    println!("largest {deviations:?}");
    assert!(bounded.iter().chain(&normal).all(|count| *count > 3), "{bounded:?} {normal:?}");
}

/// The two methods agree at the transition from one method to the other.
#[test]
fn the_methods_agree_where_no_bounded_parameter_dominates() {
    let mut rng = ChaCha8Rng::seed_from_u64(72);
    let mut scratch = ConditionalScratch::default();
    for round in 0..40 {
        let m = 1 + round % 3;
        let (columns, distributions) = dominated(&mut rng, m, Distribution::Uniform);
        let kurtosis: Vec<_> = distributions.iter().map(|d| d.excess_kurtosis()).collect();
        let normal = NormDistribution::new(m, &columns, &kurtosis, &vector(&[]));
        let law = NormLaw::new(m, &columns, &distributions, &vector(&[]), &mut scratch);
        near(law.rms(), normal.rms(), 1e-12 * normal.rms());
        if let NormLaw::NearlyNormal(same) = &law {
            assert_eq!(same.quantile(0.99).to_bits(), normal.quantile(0.99).to_bits());
        }
    }
}

/// Parameters that are all normal keep the figures of the normal method, to the bit.
#[test]
fn normal_parameters_do_not_change_method() {
    let mut rng = ChaCha8Rng::seed_from_u64(73);
    let mut scratch = ConditionalScratch::default();
    for round in 0..60 {
        let m = 1 + round % 6;
        let (columns, _) = dominated(&mut rng, m, Distribution::Normal);
        let law =
            NormLaw::new(m, &columns, &vec![Distribution::Normal; columns.len()], &vector(&[]), &mut scratch);
        let normal = NormDistribution::new(m, &columns, &[], &vector(&[]));
        assert_eq!(law.quantile(0.95).to_bits(), normal.quantile(0.95).to_bits());
        assert_eq!(law.cdf(1.0).to_bits(), normal.cdf(1.0).to_bits());
        assert_eq!(law.mean().to_bits(), normal.mean().to_bits());
    }
}

/// A search minimizes the same figure that a map shows. No percentile exceeds the worst case of bounded
/// parameters.
#[test]
fn the_search_and_the_map_use_the_same_figure_below_the_worst_case() {
    let mut rng = ChaCha8Rng::seed_from_u64(74);
    for k in 0..24 {
        let robot = random_robot(&mut rng, 4);
        let sizes = (1e-3, rad_from_deg(0.3));
        let bounded = [Distribution::Uniform, Distribution::Triangular];
        let tolerance = random_tolerance(&mut rng, 4, 1 + k % 4, sizes, &bounded);
        let mut cell = cell_of(robot.clone(), tolerance, Sense::plain(["xyz", "xy", "z"][k % 3]).unwrap());
        (cell.reading, cell.model) = (Reading::Statistical, Model::Nonlinear);
        cell.operations[0].limit = Some(1e-3);
        let frames = frames_at(&robot, &random_joints(&mut rng, &robot));
        for quantity in Quantity::ALL {
            cell.quantity = quantity;
            let evaluator = gauge_of(&cell);
            let mut memory = evaluator.memory();
            let judged = evaluator.judge(&alone(), &frames, &mut memory);
            let value = evaluator.value(&alone(), &frames, &mut memory);
            assert_eq!(value.to_bits(), judged.value.to_bits(), "{k} {quantity:?}");
            for (sense, f) in evaluator.reported.iter().zip(&judged.figures) {
                assert!(f.p95 <= f.p99 && f.p99 <= f.worst, "{k} {}: {f:?}", sense.name);
            }
        }
    }
}
