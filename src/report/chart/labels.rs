//! Labels that do not cover each other.

/// Boxes taken so far: left, top, right, bottom, px.
#[derive(Default)]
pub struct Taken(Vec<[f64; 4]>);

impl Taken {
    /// Takes a box if nothing is in it yet.
    pub fn take(&mut self, [left, top, right, bottom]: [f64; 4]) -> bool {
        let free = self.0.iter().all(|[l, t, r, b]| right <= *l || left >= *r || bottom <= *t || top >= *b);
        if free {
            self.0.push([left, top, right, bottom]);
        }
        free
    }

    /// Takes it whatever is there.
    pub fn keep(&mut self, place: [f64; 4]) {
        self.0.push(place);
    }
}

/// Rows for labels of these left and right ends, in the order given: each in the first row in which it
/// is free.
pub fn rows(spans: &[(f64, f64)]) -> Vec<usize> {
    let mut taken = Taken::default();
    let row = |(left, right): &(f64, f64)| {
        (0..spans.len())
            .find(|&k| taken.take([*left, k as f64 + 0.1, *right, k as f64 + 0.9]))
            .unwrap_or_default()
    };
    spans.iter().map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn labels_in_one_row_are_apart() {
        assert_eq!(rows(&[(0.0, 5.0), (4.0, 9.0), (6.0, 8.0), (4.5, 7.0)]), [0, 1, 0, 2]);
    }
}
