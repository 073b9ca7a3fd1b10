//! Comparison of the output on a page with the output of a command. Numbers may differ by one unit of their
//! last digit, because processors round differently. Durations and sizes of files may differ by any amount.

use std::path::Path;

/// Largest share of the bytes of a picture that may differ by more than [`SHADE`].
const MAX_SHARE: f64 = 0.01;

/// Largest difference of a colour component (of 255) that is invisible.
const SHADE: u8 = 8;

/// Units after numbers that differ from run to run: durations and sizes of files.
const VARYING: [&str; 3] = ["s", "kB", "MB"];

/// Mark that stands for a number.
const NUMBER: char = '\u{1}';

/// Returns a line with a mark in place of every number, and the numbers as printed.
fn parted(line: &str) -> (String, Vec<String>) {
    let (mut text, mut numbers) = (String::new(), Vec::<String>::new());
    let mut before = ' ';
    for c in line.split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        let is_inside = text.ends_with(NUMBER);
        let begins = c.is_ascii_digit() && !before.is_ascii_alphabetic();
        if is_inside && (c.is_ascii_digit() || c == '.') {
            numbers.last_mut().unwrap().push(c);
        } else if begins {
            numbers.push(c.into());
            text.push(NUMBER);
        } else {
            text.push(c);
        }
        before = c;
    }
    (text, numbers)
}

fn decimals(number: &str) -> usize {
    number.trim_end_matches('.').split_once('.').map_or(0, |(_, digits)| digits.len())
}

fn are_close(a: &str, b: &str) -> bool {
    let value = |text: &str| text.trim_end_matches('.').parse::<f64>();
    let (Ok(x), Ok(y)) = (value(a), value(b)) else { return a == b };
    let unit = 0.1_f64.powi(decimals(a).min(decimals(b)) as i32);
    a == b || decimals(a) + decimals(b) > 0 && (x - y).abs() < 1.01 * unit
}

fn are_lines_alike(a: &str, b: &str) -> bool {
    let ((text, x), (other, y)) = (parted(a), parted(b));
    if text != other {
        return false;
    }
    let units: Vec<&str> = text.split(NUMBER).skip(1).collect();
    let varies = |k: usize| {
        let unit = units[k].trim_start().split(|c: char| !c.is_alphabetic()).next().unwrap();
        units[k].starts_with(' ') && VARYING.contains(&unit)
    };
    x.len() == y.len() && (0..x.len()).all(|k| varies(k) || are_close(&x[k], &y[k]))
}

/// Returns the first line in which two texts differ.
pub fn difference(shown: &[String], printed: &[String]) -> Option<String> {
    let line = |lines: &[String], k: usize| lines.get(k).cloned().unwrap_or_else(|| "(no line)".into());
    let at = (0..shown.len().max(printed.len())).find(|&k| match (shown.get(k), printed.get(k)) {
        (Some(a), Some(b)) => !are_lines_alike(a, b),
        _ => true,
    })?;
    Some(format!("  the page: {}\n  printed:  {}", line(shown, at), line(printed, at)))
}

/// Returns a description of the visible difference of two pictures; None if there is none.
pub fn pictures(kept: &Path, made: &Path) -> Option<String> {
    if !kept.exists() {
        return Some("it is missing".into());
    }
    if kept.extension().is_some_and(|ending| ending == "png") {
        return pixels(kept, made);
    }
    let lines = |path: &Path| -> Vec<String> {
        std::fs::read_to_string(path).unwrap().lines().map(str::to_string).collect()
    };
    difference(&lines(kept), &lines(made)).map(|text| text.chars().take(400).collect())
}

fn pixels(kept: &Path, made: &Path) -> Option<String> {
    let decoded = |path: &Path| {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        (reader.info().size(), bytes)
    };
    let ((size, a), (other, b)) = (decoded(kept), decoded(made));
    if size != other {
        return Some(format!("{size:?} pixels instead of {other:?}"));
    }
    let count = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > SHADE).count();
    let share = count as f64 / a.len() as f64;
    (share > MAX_SHARE).then(|| format!("{:.1} % of the pixels differ", 100.0 * share))
}

#[test]
fn outputs_differ_in_text_and_key_figures_only() {
    let is = |a: &str, b: &str| are_lines_alike(a, b);
    assert!(is("best 21.6489 mm  in 1.76 s (seed 1)", "best 21.6490 mm in 12 s (seed 1)"));
    assert!(is("wrote page.html (580 kB)", "wrote page.html (9 kB)"));
    assert!(!is("best 21.6489 mm", "best 21.6491 mm"));
    assert!(!is("35 of 35 nodes usable", "34 of 35 nodes usable"));
    assert!(!is("least error 1.0 mm", "least worst case 1.0 mm"));
    assert!(!is("joint q2 at 1.5", "joint q3 at 1.5"));
    assert!(!is("at -2.5 mm", "at 2.5 mm"));
    let lines = |text: &str| text.lines().map(str::to_string).collect::<Vec<_>>();
    assert!(difference(&lines("a\nb"), &lines("a")).is_some());
    assert!(difference(&lines("a\n1.25"), &lines("a\n1.26")).is_none());
}
