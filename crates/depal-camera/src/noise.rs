//! Random numbers that depend on seed and place only, so order and threads do not matter.

use crate::raster::TILE;

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// Bijective 64-bit finaliser (SplitMix64, Steele, Lea and Flood 2014).
pub(crate) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// Words addressed by number.
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

/// Generators that run side by side: enough that the compiler keeps the loop over them and works on
/// several in one instruction.
const LANES: usize = 64;

/// Generators side by side (xoshiro128++, Blackman and Vigna 2021), started from the
/// counter words of an image row: shifts and sums only, so that several run in one instruction.
pub(crate) struct RowBits {
    state: [[u32; LANES]; 4],
}

impl RowBits {
    pub fn new(counter: Counter, row: usize) -> Self {
        let first = (row * 2 * LANES) as u64;
        let mut state = [[0; LANES]; 4];
        for lane in 0..LANES {
            let low = counter.word(first + 2 * lane as u64);
            let high = counter.word(first + 2 * lane as u64 + 1);
            state[0][lane] = low as u32;
            state[1][lane] = (low >> 32) as u32;
            state[2][lane] = high as u32 | 1; // never all zero
            state[3][lane] = (high >> 32) as u32;
        }
        Self { state }
    }

    /// Fills a row with words.
    #[inline(always)]
    pub fn fill(&mut self, out: &mut [u32]) {
        let mut chunks = out.chunks_exact_mut(LANES);
        for chunk in &mut chunks {
            self.next(chunk);
        }
        let rest = chunks.into_remainder();
        let mut last = [0; LANES];
        self.next(&mut last);
        rest.copy_from_slice(&last[..rest.len()]);
    }

    #[inline(always)]
    fn next(&mut self, out: &mut [u32]) {
        let [s0, s1, s2, s3] = &mut self.state;
        let lanes = out.iter_mut().zip(s0).zip(s1).zip(s2).zip(s3);
        for ((((out, s0), s1), s2), s3) in lanes {
            *out = s0.wrapping_add(*s3).rotate_left(7).wrapping_add(*s0);
            let t = *s1 << 9;
            *s2 ^= *s0;
            *s3 ^= *s1;
            *s1 ^= *s2;
            *s0 ^= *s3;
            *s2 ^= t;
            *s3 = s3.rotate_left(11);
        }
    }
}

/// A near normal number of variance one: the sum of the four bytes, whose flat tails a cubic term
/// pulls out again (Cornish and Fisher 1938). Kurtosis 3.00, cut off at 4.0 sigma.
#[inline(always)]
pub(crate) fn normal(word: u32) -> f32 {
    const PER_BYTE_STEP: f32 = 1.0 / 147.800_54;
    const CUBIC: f32 = 0.0185;
    const UNIT_VARIANCE: f32 = 1.004_95;
    let pairs = (word & 0x00ff_00ff) + ((word >> 8) & 0x00ff_00ff);
    let sum = (pairs & 0xffff) + (pairs >> 16);
    let x = (sum as i32 - 510) as f32 * PER_BYTE_STEP;
    x * (UNIT_VARIANCE * (1.0 - 3.0 * CUBIC) + UNIT_VARIANCE * CUBIC * x * x)
}

/// Whole steps of `sigma` times a normal number, from 16 bits: how many of these thresholds the
/// upper 15 bits stay below. Cut off at a tile's width.
pub(crate) fn step_thresholds(sigma: f64) -> Vec<i32> {
    (0..TILE)
        .map(|k| (two_sided_tail((k as f64 + 0.5) / sigma.max(1e-9)) * 32768.0).round() as i32)
        .take_while(|t| *t > 0)
        .collect()
}

/// Steps for the 16 bits of each word from `shift` on.
#[inline(always)]
pub(crate) fn draw_steps(thresholds: &[i32], words: &[u32], shift: u32, out: &mut [i32]) {
    out.fill(0);
    for threshold in thresholds {
        for (out, word) in out.iter_mut().zip(words) {
            let bits = (word >> shift) as i32;
            let size = (bits >> 1) & 0x7fff;
            // Minus one below the threshold, and with its sign turned by the last bit.
            let below = (size - threshold) >> 31;
            let sign = -(bits & 1);
            *out += (-below ^ sign) - sign;
        }
    }
}

/// Probability that a normal number is more than `x` sigma away from the mean.
fn two_sided_tail(x: f64) -> f64 {
    const STEPS: i32 = 2000;
    let (from, to) = (x.min(8.0), 8.0);
    let density = |x: f64| (-0.5 * x * x).exp();
    let step = (to - from) / f64::from(STEPS);
    let sum: f64 = (0..STEPS)
        .map(|k| density(from + (f64::from(k) + 0.5) * step))
        .sum();
    sum * step * (2.0 / std::f64::consts::PI).sqrt()
}

/// Nearest integer, half to even, by pushing the fraction out of the mantissa; |x| < 2^51.
/// Much faster than `round` where the processor baseline has no instruction for it.
#[inline(always)]
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

/// Two rows of lattice nodes and the row of nodes blended between them.
#[derive(Default)]
pub(crate) struct LatticeRows {
    number: Option<usize>,
    above: Vec<f32>,
    below: Vec<f32>,
    between: Vec<f32>,
}

impl LatticeRows {
    /// What they hold belongs to another frame.
    pub fn forget(&mut self) {
        self.number = None;
    }
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

    #[inline(always)]
    fn lattice_row(&self, n: usize, out: &mut Vec<f32>) {
        out.clear();
        out.extend((0..self.nodes).map(|k| {
            let word = self.counter.word((n * self.nodes + k) as u64);
            normal((word >> 32) as u32)
        }));
    }

    /// Writes the noise of image row `v`, which lies between lattice row v / spacing and the next.
    #[inline(always)]
    pub fn image_row(&self, v: usize, rows: &mut LatticeRows, out: &mut [f32]) {
        let number = v / self.spacing;
        if rows.number != Some(number) {
            if rows.number.is_some_and(|n| n + 1 == number) {
                std::mem::swap(&mut rows.above, &mut rows.below);
            } else {
                self.lattice_row(number, &mut rows.above);
            }
            self.lattice_row(number + 1, &mut rows.below);
            rows.number = Some(number);
        }
        let [wa, wb] = self.weights[v % self.spacing];
        rows.between.clear();
        rows.between.extend(
            rows.above
                .iter()
                .zip(&rows.below)
                .map(|(a, b)| wa * a + wb * b),
        );
        match self.spacing {
            4 => blend::<4>(&self.weights, &rows.between, out),
            8 => blend::<8>(&self.weights, &rows.between, out),
            _ => {
                for (cell, node) in out.chunks_mut(self.spacing).zip(rows.between.windows(2)) {
                    for (value, [wl, wr]) in cell.iter_mut().zip(&self.weights) {
                        *value = wl * node[0] + wr * node[1];
                    }
                }
            }
        }
    }
}

/// The same for a spacing that the compiler knows.
#[inline(always)]
fn blend<const SPACING: usize>(weights: &[[f32; 2]], nodes: &[f32], out: &mut [f32]) {
    let left: [f32; SPACING] = std::array::from_fn(|k| weights[k][0]);
    let right: [f32; SPACING] = std::array::from_fn(|k| weights[k][1]);
    let (cells, rest) = out.as_chunks_mut::<SPACING>();
    let count = cells.len();
    for (cell, node) in cells.iter_mut().zip(nodes.windows(2)) {
        for k in 0..SPACING {
            cell[k] = left[k] * node[0] + right[k] * node[1];
        }
    }
    for (k, value) in rest.iter_mut().enumerate() {
        *value = left[k] * nodes[count] + right[k] * nodes[count + 1];
    }
}
