//! Table of the sums of a few generators with all combinations of signs.

use nalgebra::SVector;

/// Number of generators in a table.
pub(super) const WIDTH: usize = 6;

/// Sums of up to six generators with all combinations of signs, in blocks of four.
///
/// Each stored sum also represents its negative.
pub(super) struct SignTable<const M: usize> {
    blocks: [SignBlock<M>; 1 << (WIDTH - 3)],
    used: usize,
}

#[derive(Clone, Copy)]
struct SignBlock<const M: usize> {
    sum: [[f64; 4]; M],
    square: [f64; 4],
}

impl<const M: usize> Default for SignTable<M> {
    fn default() -> Self {
        SignTable { blocks: [SignBlock { sum: [[0.0; 4]; M], square: [0.0; 4] }; 1 << (WIDTH - 3)], used: 1 }
    }
}

impl<const M: usize> SignTable<M> {
    pub(super) fn fill(&mut self, generators: &[SVector<f64, M>]) {
        let (zero, get) = (SVector::zeros(), |k: usize| generators.get(k));
        let (a, b, c) = (get(0).unwrap_or(&zero), get(1).unwrap_or(&zero), get(2).unwrap_or(&zero));
        for d in 0..M {
            let (more, less) = (a[d] + b[d], a[d] - b[d]);
            self.blocks[0].sum[d] = [more + c[d], less + c[d], more - c[d], less - c[d]];
        }
        self.used = 1;
        for g in generators.iter().skip(3) {
            let (plus, minus) = self.blocks.split_at_mut(self.used);
            for (plus, minus) in plus.iter_mut().zip(minus) {
                for d in 0..M {
                    minus.sum[d] = plus.sum[d].map(|x| x - g[d]);
                    plus.sum[d] = plus.sum[d].map(|x| x + g[d]);
                }
            }
            self.used *= 2;
        }
        for block in &mut self.blocks[..self.used] {
            block.square = [0.0; 4];
            for d in 0..M {
                for (q, x) in block.square.iter_mut().zip(block.sum[d]) {
                    *q += x * x;
                }
            }
        }
    }

    /// Returns the maximum of `|v + w|^2 - |v|^2` over the sums `w` in the table and their negatives.
    #[inline]
    pub(super) fn most(&self, v: &SVector<f64, M>) -> f64 {
        let mut top = [0.0; 4];
        for block in &self.blocks[..self.used] {
            for (t, gain) in top.iter_mut().zip(block.gains(v)) {
                *t = if gain > *t { gain } else { *t };
            }
        }
        top[0].max(top[1]).max(top[2]).max(top[3])
    }

    /// Writes the signs of the sum `w` that attains the maximum [`Self::most`].
    pub(super) fn write(&self, v: &SVector<f64, M>, signs: &mut [f64]) {
        let (mut best, mut place, mut overall) = (-1.0, 0, 1.0);
        for (b, block) in self.blocks[..self.used].iter().enumerate() {
            for (lane, gain) in block.gains(v).into_iter().enumerate() {
                if gain > best {
                    let dot: f64 = (0..M).map(|d| v[d] * block.sum[d][lane]).sum();
                    (best, place, overall) = (gain, 4 * b + lane, 1f64.copysign(dot));
                }
            }
        }
        for (k, s) in signs.iter_mut().enumerate() {
            *s = if (2 * place) >> k & 1 == 0 { overall } else { -overall };
        }
    }
}

impl<const M: usize> SignBlock<M> {
    #[inline]
    fn gains(&self, v: &SVector<f64, M>) -> [f64; 4] {
        let mut dot = [0.0; 4];
        for d in 0..M {
            for (p, x) in dot.iter_mut().zip(self.sum[d]) {
                *p += v[d] * x;
            }
        }
        let mut gain = self.square;
        for (g, p) in gain.iter_mut().zip(dot) {
            *g += 2.0 * p.abs();
        }
        gain
    }
}

/// Tries all combinations of signs: the last six generators with the table, the other generators in Gray code
/// order.
pub(super) fn try_all<const M: usize>(g: &[SVector<f64, M>], table: &mut SignTable<M>, signs: &mut [f64]) {
    if g.is_empty() {
        return;
    }
    let (head, tail) = g.split_at(g.len() - (g.len() - 1).min(WIDTH));
    table.fill(tail);
    let mut v: SVector<f64, M> = head.iter().sum();
    let (mut best, mut best_v, mut best_code, mut code) = (-1.0, v, 0_usize, 0_usize);
    for step in 1..=1_usize << (head.len() - 1) {
        let value = v.norm_squared() + table.most(&v);
        if value > best {
            (best, best_v, best_code) = (value, v, code);
        }
        let flip = step.trailing_zeros() as usize + 1;
        if let Some(g) = head.get(flip) {
            v += if code >> flip & 1 == 0 { g * -2.0 } else { g * 2.0 };
            code ^= 1 << flip;
        }
    }
    for (k, s) in signs[..head.len()].iter_mut().enumerate() {
        *s = if best_code >> k & 1 == 0 { 1.0 } else { -1.0 };
    }
    table.write(&best_v, &mut signs[head.len()..g.len()]);
}
