//! Random numbers without a state: a hash of seed and position, so order and threads do not matter.

use std::sync::LazyLock;

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Bijective 64-bit finaliser (SplitMix64, Steele, Lea and Flood 2014).
pub(crate) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// A stream of words addressed by number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Counter {
    key: u64,
}

impl Counter {
    /// Streams of different `lane` under one seed are independent.
    pub fn new(seed: u64, lane: u64) -> Self {
        Self {
            key: mix(seed.wrapping_add(GOLDEN) ^ mix(lane.wrapping_mul(GOLDEN).wrapping_add(1))),
        }
    }

    pub fn word(self, n: u64) -> u64 {
        mix(self.key.wrapping_add(n.wrapping_mul(GOLDEN)))
    }
}

/// 16 bits of a word as a number in 0..1.
pub(crate) fn uniform(word: u64, lane: u32) -> f32 {
    f32::from((word >> (16 * lane)) as u16) * (1.0 / 65536.0)
}

const CELLS: usize = 4096;

/// Quantiles of the standard normal distribution at k / CELLS; the ends stand for the tails.
static QUANTILES: LazyLock<[f32; CELLS + 1]> = LazyLock::new(|| {
    const STEP: f64 = 1e-3;
    let density = |x: f64| (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let mut table = [0.0; CELLS + 1];
    let (mut x, mut below) = (-8.0, 0.0);
    let mut next = 0;
    while next <= CELLS {
        let wanted = (next as f64).clamp(0.2, CELLS as f64 - 0.2) / CELLS as f64;
        let slice = 0.5 * STEP * (density(x) + density(x + STEP));
        if below + slice >= wanted || x > 8.0 {
            table[next] = (x + STEP * (wanted - below) / slice) as f32;
            next += 1;
        } else {
            below += slice;
            x += STEP;
        }
    }
    table
});

/// The table for [`normal`]; fetch it once per image, not once per pixel.
pub(crate) fn normal_table() -> &'static [f32] {
    &*QUANTILES
}

/// A standard normal number from 16 bits of a word; cut off at about four sigma.
pub(crate) fn normal(table: &[f32], word: u64, lane: u32) -> f32 {
    let bits = (word >> (16 * lane)) as u16;
    let cell = usize::from(bits >> 4);
    let part = (f32::from(bits & 15) + 0.5) * (1.0 / 16.0);
    table[cell] + (table[cell + 1] - table[cell]) * part
}

/// Whole steps of `sigma` times a normal number, by the upper 12 of 16 bits of a word.
pub(crate) fn step_table(table: &[f32], sigma: f32) -> Vec<i8> {
    table
        .windows(2)
        .map(|cell| {
            (sigma * f32::midpoint(cell[0], cell[1]))
                .round()
                .clamp(-127.0, 127.0) as i8
        })
        .collect()
}

/// A number of steps from a [`step_table`].
pub(crate) fn steps(table: &[i8], word: u64, lane: u32) -> i32 {
    i32::from(table[usize::from((word >> (16 * lane)) as u16 >> 4)])
}

/// Nearest integer, half to even, by pushing the fraction out of the mantissa; |x| < 2^51.
/// Much faster than `round` where the processor baseline has no instruction for it.
pub(crate) fn nearest_integer(x: f64) -> f64 {
    const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
    (x + SHIFT) - SHIFT
}

/// Smooth normal noise of variance one: normal numbers on a lattice, blended between the nodes
/// with weights whose squares add up to one.
pub(crate) struct SmoothNoise {
    counter: Counter,
    spacing: usize,
    weights: Vec<[f32; 2]>,
    nodes: usize,
}

impl SmoothNoise {
    pub fn new(counter: Counter, spacing: usize, width: usize) -> Self {
        let weights = (0..spacing)
            .map(|k| {
                let t = k as f32 / spacing as f32;
                let norm = ((1.0 - t) * (1.0 - t) + t * t).sqrt();
                [(1.0 - t) / norm, t / norm]
            })
            .collect();
        Self {
            counter,
            spacing,
            weights,
            nodes: width / spacing + 2,
        }
    }

    /// Node values of lattice row `n`; image row v lies between lattice rows v / spacing and the next.
    pub fn lattice_row(&self, table: &[f32], n: usize) -> Vec<f32> {
        (0..self.nodes)
            .map(|k| normal(table, self.counter.word((n * self.nodes + k) as u64), 0))
            .collect()
    }

    /// Writes the noise of image row `v` from the lattice rows above and below it.
    pub fn image_row(&self, v: usize, above: &[f32], below: &[f32], out: &mut [f32]) {
        let [wa, wb] = self.weights[v % self.spacing];
        let node = |k: usize| wa * above[k] + wb * below[k];
        for (k, cell) in out.chunks_mut(self.spacing).enumerate() {
            let (left, right) = (node(k), node(k + 1));
            for (value, [wl, wr]) in cell.iter_mut().zip(&self.weights) {
                *value = wl * left + wr * right;
            }
        }
    }
}
