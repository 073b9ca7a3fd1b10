//! Positions of labels that do not cover each other.

/// Occupied boxes: left, top, right, bottom, px.
#[derive(Default)]
pub struct OccupiedBoxes(Vec<[f64; 4]>);

impl OccupiedBoxes {
    /// Occupies a box if it is free. Returns whether the box was free.
    pub fn take(&mut self, [left, top, right, bottom]: [f64; 4]) -> bool {
        let free = self.0.iter().all(|[l, t, r, b]| right <= *l || left >= *r || bottom <= *t || top >= *b);
        if free {
            self.0.push([left, top, right, bottom]);
        }
        free
    }

    /// Occupies a box, even if it is not free.
    pub fn keep(&mut self, place: [f64; 4]) {
        self.0.push(place);
    }
}
