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

#[cfg(test)]
mod tests {
    use super::Taken;

    #[test]
    fn a_place_is_taken_once() {
        let mut taken = Taken::default();
        assert!(taken.take([0.0, 0.0, 5.0, 2.0]) && taken.take([5.0, 0.0, 9.0, 2.0]));
        assert!(!taken.take([4.0, 1.0, 6.0, 3.0]) && taken.take([4.0, 2.0, 6.0, 3.0]));
    }
}
