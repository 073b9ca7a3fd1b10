//! Tests the texts of the charts: wrapped, formatted, and placed without covering each other.

use sweetspot::report::chart::histogram::rows;
use sweetspot::report::chart::labels::OccupiedBoxes;
use sweetspot::report::chart::words::{figure, number, shortened, width, wrapped};

#[test]
fn wrapped_lines_fit_their_room_and_lose_no_text() {
    let text = "a rather long name of a workcell 溶接ロボットと作業台の配置 Donaudampfschiffahrtsgesellschaftskapitaen end";
    for room in [60.0, 130.0, 400.0] {
        let lines = wrapped(text, 13.0, room, 99);
        assert!(lines.iter().all(|l| width(l, 13.0) <= room), "{lines:?}");
        let joined: String = lines.concat().replace(' ', "");
        assert_eq!(joined, text.replace(' ', ""));
    }
    let cut = wrapped(text, 13.0, 130.0, 2);
    assert!(cut.len() == 2 && cut[1].ends_with('\u{2026}') && width(&cut[1], 13.0) <= 130.0);
    assert_eq!(shortened("short", 13.0, 100.0), "short");
    assert!(width("配置", 13.0) > 1.9 * width("ab", 13.0));
}

#[test]
fn numbers_have_the_digits_of_their_step() {
    assert_eq!([number(0.25, 0.05), number(-0.0, 0.1), number(1500.0, 500.0)], ["0.25", "0", "1500"]);
    assert_eq!([figure(3.7685694), figure(0.001234567), figure(0.0)], ["3.769", "0.001235", "0"]);
}

#[test]
fn histogram_labels_cover_neither_lines_nor_labels() {
    // Each label is right of its line and so wide that the next line crosses it. The last label stands alone.
    let marks: Vec<(f64, f64, f64)> =
        [100.0, 140.0, 150.0, 400.0].iter().map(|x| (*x, x + 5.0, x + 80.0)).collect();
    assert_eq!(rows(&marks), [2, 1, 0, 0]);
    // The last label is left of its line and overlaps the label before it.
    assert_eq!(rows(&[(100.0, 105.0, 180.0), (240.0, 160.0, 235.0)]), [1, 0]);
    assert!(rows(&[]).is_empty());
}

#[test]
fn a_label_place_is_taken_only_once() {
    let mut taken = OccupiedBoxes::default();
    assert!(taken.take([0.0, 0.0, 5.0, 2.0]) && taken.take([5.0, 0.0, 9.0, 2.0]));
    assert!(!taken.take([4.0, 1.0, 6.0, 3.0]) && taken.take([4.0, 2.0, 6.0, 3.0]));
}
