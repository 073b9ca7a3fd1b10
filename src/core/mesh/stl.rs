//! Reader of binary and text STL files, and writer of binary STL files. Both use coordinates in single
//! precision.
//!
//! At a distance of 3 m, single precision resolves 0.2 um. The normals are not used: the order of the corners
//! defines which side is outside.

use super::triangles::{BEYOND, MAX_TRIANGLES, MeshFault, Triangles, Vertices, is_beyond, too_many};
use crate::safe_text::shown;
use nalgebra::Vector3;
use std::io::Cursor;

/// Number of bytes before the triangles of a binary file: 80 for the title and 4 for the number of triangles.
const HEADER: usize = 84;
/// Number of bytes of one triangle of a binary file.
const TRIANGLE: usize = 50;

/// Returns the vertices (scaled to m, three per triangle) and the triangles of an STL file.
pub fn parse(bytes: &[u8], scale: f64) -> Result<(Vertices, Triangles), MeshFault> {
    let promised = bytes.get(80..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let promised = promised.map(|count| count as usize);
    // The title of a binary file may begin like the title of a text file, so the size is checked first.
    if promised.is_some_and(|n| n.checked_mul(TRIANGLE).is_some_and(|size| HEADER + size == bytes.len())) {
        return triangles_of(binary(bytes)?, scale, |k| (None, format!(", in triangle {}", k + 1)));
    }
    let start = bytes.trim_ascii_start();
    if start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        let text = plain(bytes)?;
        let line = |k: usize| (facet_line(&text, k), String::new());
        return triangles_of(text.clone().into_bytes(), scale, line);
    }
    let has = bytes.len().saturating_sub(HEADER) / TRIANGLE;
    Err((
        None,
        match promised {
            Some(n) => {
                format!("the header states {n} triangles, but the file is large enough for only {has}")
            }
            None => format!("a file of {} bytes is not an STL file", bytes.len()),
        },
    ))
}

/// Returns a binary STL file of triangles. The coordinates in the file are in the unit of `vertices`, in
/// single precision.
///
/// # Errors
/// Returns the message of the STL writer if the writer fails. The writer writes to memory, so no failure is
/// expected.
pub fn to_stl(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Result<Vec<u8>, String> {
    let single = |v: Vector3<f64>| stl_io::Vector::new(v.cast::<f32>().into());
    let facet = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| vertices[i as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        stl_io::Triangle { normal: single(normal), vertices: [a, b, c].map(single) }
    };
    let mut bytes = Vec::new();
    stl_io::write_stl(&mut bytes, triangles.iter().map(facet)).map_err(|e| e.to_string())?;
    Ok(bytes)
}

/// Returns the bytes of a binary file with a blank title, so that the STL reader cannot mistake them for
/// text.
fn binary(bytes: &[u8]) -> Result<Vec<u8>, MeshFault> {
    if bytes.len() > HEADER + TRIANGLE * MAX_TRIANGLES {
        return Err((None, too_many()));
    }
    let mut blank = bytes.to_vec();
    blank.iter_mut().take(80).for_each(|b| *b = 0);
    Ok(blank)
}

/// Returns the triangles of a file that [`binary`] or [`plain`] has prepared.
///
/// The function `place` locates a triangle, given by its index, for an error message. For a text file,
/// `place` returns a line (counted from 0). For a binary file, `place` returns a text with the number of the
/// triangle.
fn triangles_of(
    file: Vec<u8>,
    scale: f64,
    place: impl Fn(usize) -> (Option<usize>, String),
) -> Result<(Vertices, Triangles), MeshFault> {
    let mut file = Cursor::new(file);
    let refused = |e: std::io::Error| shown(&e.to_string());
    let reader = stl_io::create_stl_reader(&mut file).map_err(|e| (None, refused(e)))?;
    let mut vertices: Vertices = Vec::new();
    let mut triangles = Vec::new();
    for (k, triangle) in reader.enumerate() {
        let wrong = |why: &str| {
            let (line, which) = place(k);
            (line, format!("{why}{which}"))
        };
        let triangle =
            triangle.map_err(|e| wrong(&format!("a facet does not have three points: {}", refused(e))))?;
        let corners = triangle.vertices.map(|c| Vector3::from(c.0).cast::<f64>() * scale);
        if corners.iter().any(|c| c.iter().any(|c| is_beyond(*c))) {
            return Err(wrong(BEYOND));
        }
        let first = vertices.len() as u32;
        vertices.extend(corners);
        triangles.push([first, first + 1, first + 2]);
    }
    Ok((vertices, triangles))
}

/// Returns a text file line by line in the form that the STL reader expects.
///
/// The result is in lower case, with short lines, without a title, and with one solid for all triangles. All
/// normals are 0, because some exporters write `nan` as a normal.
fn plain(bytes: &[u8]) -> Result<String, MeshFault> {
    let mut text = String::with_capacity(bytes.len());
    let (mut facets, mut last) = (0, None);
    for (k, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
        let first = words.next().unwrap_or_default().to_ascii_lowercase();
        text.push_str(if k == 0 { "solid " } else { "" });
        match &first[..] {
            b"facet" => {
                facets += 1;
                text.push_str("facet normal 0 0 0");
            }
            b"solid" | b"endsolid" => {}
            other => {
                for word in std::iter::once(other).chain(words.take(4)) {
                    let word = std::str::from_utf8(word)
                        .map_err(|_| (Some(k), "this line is not text".to_string()))?;
                    text.extend(word.chars().map(|c| c.to_ascii_lowercase()).chain([' ']));
                }
            }
        }
        text.push('\n');
        if facets > MAX_TRIANGLES {
            return Err((None, too_many()));
        }
        last = if first.is_empty() { last } else { Some(first) };
    }
    if last.as_deref() != Some(b"endsolid") {
        return Err((None, "the file is truncated: its last line is not `endsolid`".into()));
    }
    text.push_str("endsolid\n");
    Ok(text)
}

/// Returns the line of facet `k`. Lines and facets are counted from 0.
fn facet_line(text: &str, k: usize) -> Option<usize> {
    let facets = text.lines().enumerate().filter(|(_, line)| line.starts_with("facet"));
    facets.map(|(line, _)| line).nth(k)
}
