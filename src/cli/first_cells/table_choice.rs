//! Choice of places for a table within the reach of an arm.

use super::own_cell::TablePlace;
use crate::cell::{Attitude, JointKind, Robot};
use crate::reach::{Envelope, Inverse};
use crate::units::{deg_from_rad, m_from_mm, mm_from_m, rad_from_deg};
use nalgebra::Vector3;

/// Number of heights at which the reach is sampled.
const HEIGHTS: usize = 13;

/// Number of radii at which the reach is sampled at every height.
const RADII: usize = 25;

/// Least height of the TCP above the base, as a share of the longest reach.
const LOWEST: f64 = -0.4;

/// Largest height of the TCP above the base, as a share of the longest reach.
const HIGHEST: f64 = 0.8;

/// Least reach, m, of an arm whose table may be lower or higher than a workbench. The table of an arm with
/// less reach has the height of a workbench, and a pedestal lifts the arm if necessary.
const BENCH_ARM: f64 = 1.5;

/// Height of a workbench, mm.
const BENCH: f64 = 800.0;

/// Least height of the top of a table above the floor, mm.
const LEAST_TOP: f64 = 300.0;

/// Largest number of places in one direction from the arm for which a map is computed.
const MAX_PLACES: usize = 12;

/// Range of radii within which an arm reaches every sampled point at one height. Radii and height are in m.
struct ReachableStretch {
    height: f64,
    from: f64,
    to: f64,
}

/// Returns places for a table, the most promising first. `bend` is the elevation of the tool axis, rad, and
/// `standoff` the height of the TCP above the table, mm.
pub fn table_places(robot: &Robot, inverse: &Inverse, bend: f64, standoff: i32) -> Vec<TablePlace> {
    let attitude = Attitude::elevation(bend);
    if inverse.refusal(&attitude).is_some() {
        return Vec::new();
    }
    let envelope = Envelope::new(inverse, &attitude, 0.0);
    // A multiple of a quarter turn is as good as any other angle, and easier to read.
    let azimuth = (deg_from_rad(envelope.middle()) / 90.0).round() * 90.0;
    let reach = robot.reach();
    // The rail of a linear axis may occupy the place in front of the arm, but not the places beside it.
    let has_rail = robot.joints.first().is_some_and(|joint| joint.kind == JointKind::Prismatic);
    let azimuths = if has_rail { vec![azimuth, azimuth + 90.0, azimuth - 90.0] } else { vec![azimuth] };
    let places = |azimuth: f64| {
        let mut stretches: Vec<ReachableStretch> = (0..HEIGHTS)
            .filter_map(|k| {
                let height = reach * (LOWEST + (HIGHEST - LOWEST) * k as f64 / (HEIGHTS - 1) as f64);
                longest_stretch(&envelope, rad_from_deg(azimuth), reach, height)
            })
            .collect();
        stretches.sort_by(|a, b| (b.to - b.from).total_cmp(&(a.to - a.from)));
        let places = stretches.iter().flat_map(|stretch| {
            [0.7, 0.5, 0.35].map(|share| place(stretch, share, reach, (azimuth, bend, standoff)))
        });
        places.take(MAX_PLACES).collect::<Vec<_>>()
    };
    azimuths.into_iter().flat_map(places).collect()
}

fn longest_stretch(
    envelope: &Envelope<'_>,
    azimuth: f64,
    reach: f64,
    height: f64,
) -> Option<ReachableStretch> {
    let (sin, cos) = azimuth.sin_cos();
    let step = reach / RADII as f64;
    let mut best: Option<ReachableStretch> = None;
    let mut from = None;
    for k in 1..=RADII + 1 {
        let r = step * k as f64;
        if k <= RADII && envelope.contains(&Vector3::new(r * cos, r * sin, height)) {
            from.get_or_insert(r);
        } else if let Some(from) = from.take() {
            let to = r - step;
            let longer = best.as_ref().is_none_or(|best| to - from > best.to - best.from);
            best = if longer && to > from { Some(ReachableStretch { height, from, to }) } else { best };
        }
    }
    best
}

/// Returns the place of a table in the range of radii `stretch`. The depth of the table is the fraction
/// `share` of this range, but at most 0.4 times the reach.
fn place(
    stretch: &ReachableStretch,
    share: f64,
    reach: f64,
    (azimuth, bend, standoff): (f64, f64, i32),
) -> TablePlace {
    let ten = |m: f64| (mm_from_m(m) / 10.0).round() as i32 * 10;
    let fifty = |mm: f64| (mm / 50.0).round() as i32 * 50;
    let depth = (share * (stretch.to - stretch.from)).min(0.4 * reach);
    // The far corners must be within reach, so the table lies in the nearer half of the remaining range.
    let middle = stretch.from + 0.45 * (stretch.to - stretch.from);
    let far = middle + depth / 2.0;
    let across = (0.9 * stretch.to).powi(2) - far.powi(2);
    let width = (2.0 * across.max(0.0).sqrt()).clamp(depth.min(m_from_mm(100.0)), 1.5 * depth);
    let below = mm_from_m(stretch.height) - f64::from(standoff);
    let wanted = if reach < BENCH_ARM { BENCH } else { LEAST_TOP.max(below) };
    let pedestal = fifty(wanted - below).max(0);
    TablePlace {
        pedestal,
        top: (pedestal + fifty(below)).max(LEAST_TOP as i32),
        radius: ten(middle),
        azimuth: azimuth as i32,
        size: (ten(depth).max(100), ten(width).max(100)),
        standoff,
        bend: deg_from_rad(bend).round() as i32,
    }
}
