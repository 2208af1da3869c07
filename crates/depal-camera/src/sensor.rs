use std::cell::RefCell;

use depal_frames::DepthFrame;
use rayon::prelude::*;

use crate::capture::{Capture, NOTHING};
use crate::light::{KEEP_BITS, LightScratch, Lighting, LitRows, run_length, sigma_of};
use crate::noise::{
    Counter, LatticeRows, RowBits, SmoothNoise, add_steps, nearest_integer, normal, step_thresholds,
};
use crate::raster::EMPTY;
use crate::{CameraSpec, Rendering};

/// Rows that are one job for a thread.
const ROWS: usize = 128;
/// Rows that are lit together: they stay in the second-level cache until depth is measured.
const LIT_ROWS: usize = 32;

thread_local! {
    /// Kept from frame to frame: fetching new memory costs as much as a tenth of the frame.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// What the sensor makes of a rendering. `noise_seed` should differ from frame to frame.
///
/// Order of effects: sideways jitter picks the source pixel; range, shadow, grazing, darkness,
/// over-exposure, chance and depth steps take pixels away; bowl, scale and axial noise move the depth;
/// rounding last.
pub fn sense(spec: &CameraSpec, rendering: &Rendering, noise_seed: u64) -> Capture {
    let mut capture = Capture {
        frame: DepthFrame {
            intrinsics: rendering.intrinsics,
            depth: Vec::new(),
            intensity: Vec::new(),
        },
        ids: Vec::new(),
        ideal_depth: Vec::new(),
    };
    sense_into(spec, rendering, noise_seed, &mut capture);
    capture
}

/// The same as [`sense`] into the buffers of an earlier capture, whatever it showed.
pub fn sense_into(
    spec: &CameraSpec,
    rendering: &Rendering,
    noise_seed: u64,
    capture: &mut Capture,
) {
    sense_frame(spec, rendering, noise_seed, &mut capture.frame);
    let i = rendering.intrinsics;
    let pixels = i.width * i.height;
    capture.ids.resize(pixels, NOTHING);
    capture.ideal_depth.resize(pixels, 0.0);
    if pixels == 0 {
        return;
    }
    let faces = &rendering.view.faces;
    let id_of_face: Vec<u32> = faces.iter().map(|face| rendering.id(face.solid)).collect();
    let band = ROWS * i.width;
    capture
        .ids
        .par_chunks_mut(band)
        .zip(capture.ideal_depth.par_chunks_mut(band))
        .zip(rendering.surface.par_chunks(band))
        .zip(rendering.inverse_depth.par_chunks(band))
        .for_each(|(((ids, ideal_depth), surface), inverse_depth)| {
            truth(&id_of_face, surface, inverse_depth, ids, ideal_depth);
        });
}

/// Only what the camera delivers, without the truth, into the buffers of an earlier frame.
pub fn sense_frame(
    spec: &CameraSpec,
    rendering: &Rendering,
    noise_seed: u64,
    frame: &mut DepthFrame,
) {
    let i = rendering.intrinsics;
    let pixels = i.width * i.height;
    frame.intrinsics = i;
    frame.depth.resize(pixels, 0.0);
    frame.intensity.resize(pixels, 0);
    if pixels == 0 {
        return;
    }
    if spec.sensor.blackout {
        frame.depth.fill(0.0);
        frame.intensity.fill(0);
        return;
    }
    let s = &spec.sensor;
    let sensor = Sensor {
        spec,
        rendering,
        lighting: Lighting::new(spec, rendering),
        jitter: step_thresholds(s.lateral_jitter_px),
        pixel_noise: Counter::new(noise_seed, 0),
        step_noise: Counter::new(noise_seed, 2),
        smooth: SmoothNoise::new(
            Counter::new(noise_seed, 1),
            s.correlation_px.max(2),
            i.width,
        ),
        bowl: Bowl::new(spec),
    };
    let band = ROWS * i.width;
    let arch = pulp::Arch::new();
    frame
        .depth
        .par_chunks_mut(band)
        .zip(frame.intensity.par_chunks_mut(band))
        .enumerate()
        .for_each(|(n, (depth, intensity))| {
            SCRATCH.with_borrow_mut(|scratch| {
                scratch.fit(i.width);
                let first = n * ROWS;
                arch.dispatch(BandJob {
                    sensor: &sensor,
                    rows: (first, (first + ROWS).min(i.height)),
                    scratch,
                    depth,
                    intensity,
                });
            });
        });
}

/// Ids and exact depths of a band.
fn truth(
    id_of_face: &[u32],
    surface: &[u32],
    inverse_depth: &[f32],
    ids: &mut [u32],
    ideal_depth: &mut [f32],
) {
    let mut at = 0;
    while at < surface.len() {
        let index = surface[at];
        let end = at + run_length(&surface[at..]);
        let id = match index {
            EMPTY => NOTHING,
            _ => id_of_face[index as usize],
        };
        ids[at..end].fill(id);
        at = end;
    }
    for (z, w) in ideal_depth.iter_mut().zip(inverse_depth) {
        let exact = 1.0 / *w;
        *z = if *w > 0.0 { exact } else { 0.0 };
    }
}

/// Nearest whole number of 0..=255, by pushing the fraction out of the mantissa.
#[inline(always)]
fn rounded_byte(x: f32) -> u8 {
    const SHIFT: f32 = 8_388_608.0; // 2^23
    (x + SHIFT).to_bits() as u8
}

/// One band of rows, compiled once for each instruction set that the processor may have.
struct BandJob<'a> {
    sensor: &'a Sensor<'a>,
    rows: (usize, usize),
    scratch: &'a mut Scratch,
    depth: &'a mut [f32],
    intensity: &'a mut [u8],
}

impl pulp::WithSimd for BandJob<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let (first, end) = self.rows;
        self.sensor
            .band(first, end, self.scratch, self.depth, self.intensity);
    }
}

/// Buffers of one worker.
#[derive(Default)]
struct Scratch {
    light: LightScratch,
    lit: LitRows,
    lattice: LatticeRows,
    row: RowScratch,
}

#[derive(Default)]
struct RowScratch {
    smooth: Vec<f32>,
    blend: Vec<f32>,
    border: Vec<u8>,
    turns: Vec<u8>,
    depth: Vec<f32>,
    packed: Vec<u32>,
    /// Index of the lit pixel that each one looks at.
    places: Vec<i32>,
    /// Three random words for each pixel.
    words: [Vec<u32>; 3],
}

impl Scratch {
    /// Makes room for rows of this width and forgets what belongs to an earlier frame.
    fn fit(&mut self, width: usize) {
        self.lattice.forget();
        let row = &mut self.row;
        for buffer in [&mut row.smooth, &mut row.blend, &mut row.depth] {
            buffer.resize(width, 0.0);
        }
        row.border.resize(width, 0);
        // One more at each end, which stays empty.
        row.turns.clear();
        row.turns.resize(width + 2, 0);
        row.packed.resize(width, 0);
        row.places.resize(width, 0);
        for words in &mut row.words {
            words.resize(width, 0);
        }
    }
}

/// Depth error that grows with the square of the distance from the image centre.
struct Bowl {
    /// -height/2 in the centre, +height/2 in the corners: share of the column.
    columns: Vec<f32>,
    height: f32,
    v: f32,
    scale: f32,
}

impl Bowl {
    fn new(spec: &CameraSpec) -> Self {
        let i = &spec.intrinsics;
        let (u, v) = ((i.width as f32 - 1.0) * 0.5, (i.height as f32 - 1.0) * 0.5);
        let height = spec.sensor.bowl as f32;
        let scale = height / (u * u + v * v).max(1.0);
        Self {
            columns: (0..i.width)
                .map(|k| (k as f32 - u) * (k as f32 - u) * scale)
                .collect(),
            height,
            v,
            scale,
        }
    }

    /// What the row adds to its columns.
    fn row(&self, v: usize) -> f32 {
        let y = v as f32 - self.v;
        y * y * self.scale - 0.5 * self.height
    }
}

struct Sensor<'a> {
    spec: &'a CameraSpec,
    rendering: &'a Rendering,
    lighting: Lighting<'a>,
    jitter: Vec<i32>,
    pixel_noise: Counter,
    step_noise: Counter,
    smooth: SmoothNoise,
    bowl: Bowl,
}

impl Sensor<'_> {
    #[inline(always)]
    fn band(
        &self,
        first: usize,
        end: usize,
        scratch: &mut Scratch,
        depth: &mut [f32],
        intensity: &mut [u8],
    ) {
        let i = &self.rendering.intrinsics;
        // Jitter and lens look at rows beside this band.
        let reach = self.jitter.len().max(1);
        let lit_end = (end + reach).min(i.height);
        let mut lit_to = first.saturating_sub(reach);
        scratch.lit.first_row = lit_to;
        let rows = depth.chunks_mut(i.width).zip(intensity.chunks_mut(i.width));
        for (v, (depth_row, intensity_row)) in (first..end).zip(rows) {
            while lit_to < (v + reach + 1).min(lit_end) {
                let from = lit_to;
                lit_to = ((from / LIT_ROWS + 1) * LIT_ROWS).min(lit_end);
                // The last few may be too few for a round of their own.
                if lit_end - lit_to < LIT_ROWS / 2 {
                    lit_to = lit_end;
                }
                let Scratch { light, lit, .. } = scratch;
                lit.keep_from(v.saturating_sub(reach).min(from), i.width);
                self.lighting.rows(from, lit_to, light, lit);
            }
            let mut bits = RowBits::new(self.pixel_noise, v);
            for words in &mut scratch.row.words {
                bits.fill(words);
            }
            self.smooth
                .image_row(v, &mut scratch.lattice, &mut scratch.row.smooth);
            self.depth_row(v, &scratch.lit, &mut scratch.row, depth_row);
            self.intensity_row(v, &scratch.lit, &mut scratch.row, intensity_row);
        }
    }

    #[inline(always)]
    fn depth_row(&self, v: usize, lit: &LitRows, scratch: &mut RowScratch, out: &mut [f32]) {
        let s = &self.spec.sensor;
        self.fetch_sources(v, lit, scratch);
        if s.edge_dropout + s.mixed_pixels > 0.0 {
            self.blur_steps(v, scratch);
        }
        let (near, far) = (self.spec.near as f32, self.spec.far as f32);
        let random_dropout = (s.random_dropout * f64::from(1 << (32 - KEEP_BITS))) as i32;
        let (white, smooth) = (
            (1.0 - s.correlated_share).sqrt() as f32,
            s.correlated_share.sqrt() as f32,
        );
        let scale = 1.0 + s.scale_error as f32;
        let bowl = self.bowl.row(v);
        let keep_mask = (1_u32 << KEEP_BITS) - 1;
        let measure = |z: f32, packed: u32, chance: u32, word: u32, soft: f32, bow: f32| {
            let noise = white * normal(word) + smooth * soft;
            let measured = z * scale + (bow + bowl) + sigma_of(packed) * noise;
            let kept = (chance & keep_mask) <= (packed & keep_mask);
            let lucky = (chance >> KEEP_BITS) as i32 >= random_dropout;
            (measured, (z > 0.0) & kept & lucky)
        };
        let (chances, words) = (&scratch.words[1], &scratch.words[2]);
        let sources = scratch
            .depth
            .iter()
            .zip(&scratch.packed)
            .zip(chances.iter().zip(words))
            .zip(scratch.smooth.iter().zip(&self.bowl.columns));
        if s.quantum > 0.0 {
            let steps_per_metre = 1.0 / s.quantum;
            for (out, (((z, packed), (chance, word)), (soft, bow))) in out.iter_mut().zip(sources) {
                let (measured, seen) = measure(*z, *packed, *chance, *word, *soft, *bow);
                let rounded =
                    (nearest_integer(f64::from(measured) * steps_per_metre) * s.quantum) as f32;
                let seen = seen & (rounded >= near) & (rounded <= far);
                *out = if seen { rounded } else { 0.0 };
            }
        } else {
            for (out, (((z, packed), (chance, word)), (soft, bow))) in out.iter_mut().zip(sources) {
                let (measured, seen) = measure(*z, *packed, *chance, *word, *soft, *bow);
                let seen = seen & (measured >= near) & (measured <= far);
                *out = if seen { measured } else { 0.0 };
            }
        }
        if s.disparity_step_px > 0.0 {
            self.round_disparity(out);
        }
    }

    /// Rounds depths to whole steps of disparity, fx * baseline / z.
    #[inline(always)]
    fn round_disparity(&self, row: &mut [f32]) {
        let i = &self.rendering.intrinsics;
        let steps = i.fx * self.spec.baseline.abs() / self.spec.sensor.disparity_step_px;
        for z in row {
            if *z > 0.0 {
                let disparity = nearest_integer(steps / f64::from(*z));
                *z = (steps / disparity.max(1.0)) as f32;
            }
        }
    }

    /// Fetches what each pixel of row `v` looks at: itself, or a neighbour by the sideways jitter.
    #[inline(always)]
    fn fetch_sources(&self, v: usize, lit: &LitRows, scratch: &mut RowScratch) {
        let i = &self.rendering.intrinsics;
        let (width, height) = (i.width, i.height);
        let at = (v - lit.first_row) * width;
        if self.jitter.is_empty() {
            scratch.depth.copy_from_slice(&lit.depth[at..at + width]);
            scratch.packed.copy_from_slice(&lit.packed[at..at + width]);
            return;
        }
        // Beside the image there is nothing to look at: such a pixel looks at itself.
        let reach = self.jitter.len();
        let places = &mut scratch.places;
        for (u, place) in places.iter_mut().enumerate() {
            *place = (at + u) as i32;
        }
        add_steps(&self.jitter, &scratch.words[0], 16, 1, places);
        for u in (0..reach).chain(width - reach.min(width)..width) {
            places[u.min(width - 1)] = (at + u.min(width - 1)) as i32;
        }
        if v >= reach && v + reach < height {
            add_steps(&self.jitter, &scratch.words[0], 0, width as i32, places);
        }
        let (depths, packs) = (&lit.depth[..], &lit.packed[..]);
        for (place, depth) in places.iter().zip(&mut scratch.depth) {
            *depth = depths[*place as usize];
        }
        for (place, packed) in places.iter().zip(&mut scratch.packed) {
            *packed = packs[*place as usize];
        }
    }

    /// At depth steps some pixels are lost and some land between both surfaces.
    #[inline(always)]
    fn blur_steps(&self, v: usize, scratch: &mut RowScratch) {
        let s = &self.spec.sensor;
        self.mark_borders(v, &mut scratch.turns, &mut scratch.border);
        let dropout = (s.edge_dropout * 4_294_967_296.0) as u64;
        let mixed = (s.mixed_pixels * 4_294_967_296.0) as u64;
        let width = self.rendering.intrinsics.width;
        for (block, marks) in scratch.border.chunks(16).enumerate() {
            if marks.iter().all(|m| *m == 0) {
                continue;
            }
            let first = block * 16;
            let steps = self.steps(first, marks.len(), v);
            for (k, _) in marks.iter().enumerate().filter(|(_, m)| **m != 0) {
                let u = first + k;
                if !steps[k] || scratch.depth[u] == 0.0 {
                    continue;
                }
                let chance = self.step_noise.word((v * width + u) as u64) >> 32;
                if chance < dropout {
                    scratch.depth[u] = 0.0;
                } else if chance < dropout + mixed {
                    let (nearest, farthest) = self.depth_range(u, v);
                    scratch.depth[u] = 0.5 * (nearest + farthest);
                }
            }
        }
    }

    /// Which of the pixels from column `first` on have a depth step or nothing within 3x3.
    #[inline(always)]
    fn steps(&self, first: usize, count: usize, v: usize) -> [bool; 16] {
        let i = &self.rendering.intrinsics;
        let step = self.spec.sensor.step as f32;
        let rows = [v.saturating_sub(1), v, (v + 1).min(i.height - 1)]
            .map(|v| &self.rendering.inverse_depth[v * i.width..(v + 1) * i.width]);
        // The pixels and one more on each side.
        let windows: [[f32; 18]; 3] = if first > 0 && first + 17 <= i.width {
            rows.map(|row| std::array::from_fn(|k| row[first - 1..first + 17][k]))
        } else {
            rows.map(|row| {
                std::array::from_fn(|k| row[(first + k).clamp(1, i.width.min(first + count)) - 1])
            })
        };
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let most = |a: f32, b: f32| if a > b { a } else { b };
        let (mut low, mut high) = ([0.0_f32; 18], [0.0_f32; 18]);
        for k in 0..18 {
            let [a, b, c] = [windows[0][k], windows[1][k], windows[2][k]];
            low[k] = least(least(a, b), c);
            high[k] = most(most(a, b), c);
        }
        let mut steps = [false; 16];
        for k in 0..16 {
            let low = least(least(low[k], low[k + 1]), low[k + 2]);
            let high = most(most(high[k], high[k + 1]), high[k + 2]);
            // 1/low - 1/high > step, without the divisions; 1/z = 0 is nothing.
            steps[k] = (low <= 0.0) | (high - low > step * low * high);
        }
        steps
    }

    /// Marks the pixels of row `v` with more than one surface within 3x3.
    #[inline(always)]
    fn mark_borders(&self, v: usize, turns: &mut [u8], border: &mut [u8]) {
        let width = self.rendering.intrinsics.width;
        let row = |v: usize| &self.rendering.surface[v * width..(v + 1) * width];
        let middle = row(v);
        let above = row(v.saturating_sub(1));
        let below = row((v + 1).min(self.rendering.intrinsics.height - 1));
        // Bit 0: the next pixel is another surface; bit 1: one above or below is. One more at each end.
        let inner = &mut turns[1..=width];
        for (((mark, m), a), b) in inner.iter_mut().zip(middle).zip(above).zip(below) {
            *mark = u8::from((a ^ m) | (b ^ m) != 0) * 2;
        }
        for ((mark, a), b) in inner.iter_mut().zip(middle).zip(&middle[1..]) {
            *mark |= u8::from(a != b);
        }
        let (before, here, after) = (&turns[..width], &turns[1..=width], &turns[2..]);
        for (((mark, before), here), after) in border.iter_mut().zip(before).zip(here).zip(after) {
            *mark = before | here | (after & 2);
        }
    }

    /// Nearest and farthest depth within 3x3.
    #[inline(always)]
    fn depth_range(&self, u: usize, v: usize) -> (f32, f32) {
        let i = &self.rendering.intrinsics;
        let (mut low, mut high) = (f32::INFINITY, 0.0_f32);
        let (left, right) = (u.saturating_sub(1), (u + 1).min(i.width - 1));
        for y in v.saturating_sub(1)..=(v + 1).min(i.height - 1) {
            for w in &self.rendering.inverse_depth[y * i.width + left..=y * i.width + right] {
                if *w > 0.0 {
                    low = low.min(*w);
                    high = high.max(*w);
                }
            }
        }
        (1.0 / high, 1.0 / low)
    }

    #[inline(always)]
    fn intensity_row(&self, v: usize, lit: &LitRows, scratch: &mut RowScratch, out: &mut [u8]) {
        let i = &self.rendering.intrinsics;
        let s = &self.spec.sensor;
        let width = i.width;
        let row = |v: usize| {
            let at = (v - lit.first_row) * width;
            &lit.grey[at..at + width]
        };
        let middle = row(v);
        // The blurred row goes where the smooth noise was: depth is done with it.
        let grey = &mut scratch.smooth;
        if s.blur {
            let above = row(v.saturating_sub(1));
            let below = row((v + 1).min(i.height - 1));
            let rows = above.iter().zip(middle).zip(below);
            for (blend, ((a, m), b)) in scratch.blend.iter_mut().zip(rows) {
                *blend = 0.0625 * (a + b) + 0.125 * m;
            }
            let blend = &scratch.blend;
            for (grey, near) in grey[1..].iter_mut().zip(blend.windows(3)) {
                *grey = near[0] + 2.0 * near[1] + near[2];
            }
            let last = width - 1;
            grey[0] = 3.0 * blend[0] + blend[1.min(last)];
            grey[last] = blend[last.saturating_sub(1)] + 3.0 * blend[last];
        } else {
            grey.copy_from_slice(middle);
        }
        let noise = s.intensity_noise as f32;
        let words = scratch.words[1].iter().zip(&scratch.words[2]);
        for ((value, grey), (a, b)) in out.iter_mut().zip(grey.iter()).zip(words) {
            // Independent of either word alone, so of the depth noise and of the dropout.
            let word = a.rotate_left(9) ^ b;
            let grey = (grey + noise * normal(word)).clamp(0.0, 255.0);
            *value = rounded_byte(grey);
        }
    }
}
