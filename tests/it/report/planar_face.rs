//! Tests the ACIS text of plane faces with an independent reader that follows the pointers of the records.

use sweetspot::report::dxf::planar_face::planar_faces;

/// Returns the corners (mm) of every loop of a scrambled ACIS text. Fails if a pointer leads to a wrong
/// record.
pub fn loops(scrambled: &[&str]) -> Vec<Vec<[f64; 3]>> {
    // Every character above the space is mirrored about 79.5. The space after a caret is not a character.
    let mirrored = |c: char| if c == ' ' { c } else { char::from(159 - c as u8) };
    let plain: Vec<String> =
        scrambled.iter().map(|line| line.replace("^ ", "^").chars().map(mirrored).collect()).collect();
    assert_eq!(plain[0], "700 0 1 0");
    let words: Vec<&str> = plain[1].split(' ').collect();
    assert_eq!((words[0], words[1].len()), ("@9", 9));
    assert_eq!(plain.last().unwrap(), "End-of-ACIS-data");
    let records: Vec<Vec<&str>> =
        plain[3..plain.len() - 1].iter().map(|line| line.split(' ').collect()).collect();
    let follow = |from: usize, field: usize, kind: &str| -> usize {
        let to: usize = records[from][field].strip_prefix('$').unwrap().parse().unwrap();
        assert_eq!(records[to][0], kind, "{:?}", records[from]);
        to
    };
    let numbers = |record: usize, first: usize, count: usize| -> Vec<f64> {
        records[record][first..first + count].iter().map(|w| w.parse().unwrap()).collect()
    };
    let shell = follow(follow(0, 4, "lump"), 5, "shell");
    let face = follow(shell, 6, "face");
    assert_eq!(follow(face, 6, "shell"), shell);
    assert_eq!(records[face][9..], ["forward", "double", "out", "#"]);
    let plane = follow(face, 8, "plane-surface");
    assert_eq!(numbers(plane, 7, 3), [0.0, 0.0, 1.0]);
    let height = numbers(plane, 6, 1)[0];
    let (mut all, mut current) = (Vec::new(), follow(face, 5, "loop"));
    loop {
        assert_eq!(follow(current, 6, "face"), face);
        let first = follow(current, 5, "coedge");
        let (mut corners, mut coedge) = (Vec::new(), first);
        loop {
            let (next, edge) = (follow(coedge, 4, "coedge"), follow(coedge, 7, "edge"));
            assert_eq!((follow(next, 5, "coedge"), follow(coedge, 9, "loop")), (coedge, current));
            assert_eq!((follow(edge, 8, "coedge"), records[coedge][8]), (coedge, "forward"));
            let (start, end) = (follow(edge, 4, "vertex"), follow(edge, 6, "vertex"));
            assert_eq!(follow(follow(next, 7, "edge"), 4, "vertex"), end);
            let at = |vertex| numbers(follow(vertex, 5, "point"), 4, 3);
            let (from, to) = (at(start), at(end));
            // The curve at the parameters of the edge meets its two vertices.
            let line = numbers(follow(edge, 9, "straight-curve"), 4, 6);
            for (parameter, vertex) in [(5, &from), (7, &to)] {
                let t = numbers(edge, parameter, 1)[0];
                let error = (0..3).map(|k| (line[k] + t * line[3 + k] - vertex[k]).abs()).fold(0.0, f64::max);
                assert!(error < 1e-7, "{error}");
            }
            assert_eq!(from[2], height);
            corners.push([from[0], from[1], from[2]]);
            coedge = next;
            if coedge == first {
                break;
            }
        }
        all.push(corners);
        if records[current][4] == "$-1" {
            return all;
        }
        current = follow(current, 4, "loop");
    }
}

/// Returns the signed area of a loop, mm^2, which is positive if the corners run anticlockwise.
pub fn area(corners: &[[f64; 3]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

fn square(x: f64, y: f64, side: f64) -> Vec<(f64, f64)> {
    vec![(x, y), (x, y + side), (x + side, y + side), (x + side, y)]
}

#[test]
fn faces_have_their_holes_and_islands_are_faces_of_their_own() {
    // The region is a square with a hole, an island in the hole, and a part beside the square. The rings have
    // both directions.
    let mut apart = square(20.0, 0.0, 1.0);
    apart.reverse();
    let rings = [square(4.0, 4.0, 2.0), square(0.0, 0.0, 10.0), square(2.0, 2.0, 6.0), apart];
    let faces = planar_faces(&rings);
    let mut areas: Vec<Vec<f64>> = Vec::new();
    for face in &faces {
        let text = face.acis_text(700.0);
        let lines: Vec<&str> = text.iter().map(String::as_str).collect();
        assert!(lines.iter().all(|line| line.is_ascii() && line.len() < 256));
        areas.push(loops(&lines).iter().map(|corners| area(corners)).collect());
    }
    assert_eq!(areas, [vec![4e6], vec![100e6, -36e6], vec![1e6]]);
}

#[test]
fn a_region_that_crosses_itself_or_has_no_area_is_no_face() {
    let bow = vec![(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 2.0)];
    let touching = [square(0.0, 0.0, 4.0), square(0.0, 1.0, 1.0)];
    let flat = vec![(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)];
    let repeated = vec![(0.0, 0.0), (0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)];
    assert!(planar_faces(&[bow]).is_empty());
    assert!(planar_faces(&touching).is_empty());
    assert!(planar_faces(&[flat]).is_empty());
    assert_eq!(planar_faces(&[repeated]).len(), 1);
    assert!(planar_faces(&[]).is_empty());
}
