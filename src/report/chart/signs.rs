//! Signs on a map: one for each thing that can be the matter with a node, and for the spots.

use super::canvas::{Entry, Ink};

/// What can be the matter, as [`crate::error_map::Status::name`] calls it, and what a legend says.
pub const TROUBLES: [(&str, &str); 9] = [
    ("out-of-reach", "out of reach"),
    ("joint-limit", "beyond a joint limit"),
    ("attitude", "attitude not to be had"),
    ("not-converged", "no answer found"),
    ("collision", "collides"),
    ("singular", "nearly singular"),
    ("approach", "no way in"),
    ("retract", "no way out"),
    ("unjudged", "cannot be judged"),
];

/// The sign of an unusable node round a point, about `2 r` wide.
pub fn sign(status: &str, at: (f64, f64), r: f64) -> String {
    let faint = Ink::Faint.line(1.3);
    match status {
        "out-of-reach" => ring(at, r, &faint),
        "joint-limit" => ring(at, r, &format!("{faint} stroke-dasharray=\"2 1.6\"")),
        // The tool is held askew.
        "attitude" => ring(at, r, &faint) + &path(at, &[(-r, r), (r, -r)], &faint),
        "not-converged" => path(at, &[(-r, -r), (r, -r), (r, r), (-r, r), (-r, -r)], &faint),
        "collision" => {
            let red = Ink::Vermilion.line(1.6);
            path(at, &[(-r, -r), (r, r)], &red) + &path(at, &[(-r, r), (r, -r)], &red)
        }
        "singular" => {
            let orange = Ink::Orange.line(1.8);
            path(at, &[(-r, 0.0), (r, 0.0)], &orange) + &path(at, &[(0.0, -r), (0.0, r)], &orange)
        }
        "approach" => path(at, &[(-r, -0.6 * r), (0.0, 0.7 * r), (r, -0.6 * r)], &Ink::Vermilion.line(1.6)),
        "retract" => path(at, &[(-r, 0.6 * r), (0.0, -0.7 * r), (r, 0.6 * r)], &Ink::Vermilion.line(1.6)),
        _ => path(at, &[(-r, 0.0), (r, 0.0)], &Ink::Faint.line(1.8)),
    }
}

/// The spot chosen.
pub fn spot(at: (f64, f64)) -> String {
    ring(at, 8.0, &Ink::Paper.line(5.0)) + &ring(at, 8.0, &Ink::Spot.line(2.4))
}

/// The spot between the nodes.
pub fn refined(at: (f64, f64)) -> String {
    let corners = [(-5.0, 0.0), (0.0, 5.0), (5.0, 0.0), (0.0, -5.0), (-5.0, 0.0), (0.0, 5.0)];
    path(at, &corners, &Ink::Paper.line(4.5)) + &path(at, &corners, &Ink::Spot.line(2.0))
}

/// The spot under another reading than that of the cell.
pub fn other_spot(at: (f64, f64)) -> String {
    let dashed = format!("{} stroke-dasharray=\"4 3\"", Ink::Text.line(2.0));
    ring(at, 8.0, &Ink::Paper.line(5.0)) + &ring(at, 8.0, &dashed)
}

/// Entries for exactly the troubles that there are, each with its number of nodes.
pub fn entries<'a>(statuses: impl Iterator<Item = &'a str>) -> Vec<Entry> {
    let all: Vec<&str> = statuses.collect();
    let entry = |(name, words): &(&str, &str)| {
        let count = all.iter().filter(|s| *s == name).count();
        let mark = sign(name, (0.0, 0.0), 5.0);
        (count > 0).then(|| Entry { mark, said: format!("{words} ({count})") })
    };
    TROUBLES.iter().filter_map(entry).collect()
}

fn ring((x, y): (f64, f64), r: f64, paint: &str) -> String {
    format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" {paint}/>")
}

fn path((x, y): (f64, f64), points: &[(f64, f64)], paint: &str) -> String {
    let d = super::canvas::path(points.iter().map(|(dx, dy)| (x + dx, y + dy)), "");
    format!("<path d=\"{d}\" {paint}/>")
}
