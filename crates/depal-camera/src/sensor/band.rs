//! Rows from light to what is delivered.

use std::cell::RefCell;

use rayon::prelude::*;

use super::device::Device;
use crate::light::{Lighting, LitTile, Plan};
use crate::noise::{Counter, LatticeRows, RowBits, SmoothNoise, step_thresholds};
use crate::raster::TILE;
use crate::row::chunk_mut;
use crate::view::BAND;
use crate::{CameraSpec, Rendering};

/// Rows that are one job for a thread.
pub(super) const ROWS: usize = 128;

thread_local! {
    /// Kept from frame to frame: fetching new memory costs as much as a tenth of the frame.
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

pub(super) struct Sensor<'a> {
    pub spec: &'a CameraSpec,
    pub rendering: &'a Rendering,
    lighting: Lighting<'a>,
    plan: Plan,
    /// Of the sideways jitter; as many as it has pixels of reach.
    pub jitter: Vec<i32>,
    pixel_noise: Counter,
    pub step_noise: Counter,
    smooth: SmoothNoise,
    pub device: Device,
}

/// The last lit rows, in turn: image row v stands where v modulo their number is.
#[derive(Default)]
pub(super) struct LitRows {
    width: usize,
    mask: usize,
    depth: Vec<f32>,
    packed: Vec<u32>,
    grey: Vec<f32>,
}

impl LitRows {
    /// Makes room for at least `rows` rows.
    fn fit(&mut self, width: usize, rows: usize) {
        let rows = rows.next_power_of_two();
        (self.width, self.mask) = (width, rows - 1);
        self.depth.resize(width * rows, 0.0);
        self.packed.resize(width * rows, 0);
        self.grey.resize(width * rows, 0.0);
    }

    #[inline(always)]
    fn place(&self, v: usize) -> std::ops::Range<usize> {
        let slot = v & self.mask;
        slot * self.width..(slot + 1) * self.width
    }

    /// Depth and deviation of a row.
    #[inline(always)]
    pub fn depth(&self, v: usize) -> (&[f32], &[u32]) {
        let at = self.place(v);
        (&self.depth[at.clone()], &self.packed[at])
    }

    #[inline(always)]
    pub fn grey(&self, v: usize) -> &[f32] {
        &self.grey[self.place(v)]
    }

    #[inline(always)]
    fn tile(&mut self, v: usize, tile: usize) -> LitTile<'_> {
        let at = self.place(v).start + tile * TILE;
        LitTile {
            depth: chunk_mut(&mut self.depth, at),
            packed: chunk_mut(&mut self.packed, at),
            grey: chunk_mut(&mut self.grey, at),
        }
    }
}

/// Buffers of one worker.
#[derive(Default)]
struct Scratch {
    lit: LitRows,
    lattice: LatticeRows,
    row: RowScratch,
}

/// One value per pixel of the row at hand, to the end of the last tile.
#[derive(Default)]
pub(super) struct RowScratch {
    /// Correlated noise of variance one.
    pub smooth: Vec<f32>,
    /// Columns and rows by which the pixel looks aside.
    pub across: Vec<i32>,
    pub down: Vec<i32>,
    /// What it looks at: depth in metres, deviation in metres, chance to be kept.
    pub depth: Vec<f32>,
    pub sigma: Vec<f32>,
    pub keep: Vec<u32>,
    /// Grey before noise.
    pub grey: Vec<f32>,
    /// Depth and deviation of what stands above, below or at the pixel, a tile further on.
    pub between: Vec<f32>,
    pub packed: Vec<u32>,
    /// Three random words.
    pub words: [Vec<u32>; 3],
}

impl RowScratch {
    fn fit(&mut self, width: usize) {
        let Self {
            smooth,
            depth,
            sigma,
            grey,
            between,
            ..
        } = self;
        for buffer in [smooth, depth, sigma, grey] {
            buffer.resize(width, 0.0);
        }
        between.resize(width + 2 * TILE, 0.0);
        self.packed.resize(width + 2 * TILE, 0);
        let [a, b, c] = &mut self.words;
        for buffer in [&mut self.keep, a, b, c] {
            buffer.resize(width, 0);
        }
        for buffer in [&mut self.across, &mut self.down] {
            buffer.clear();
            buffer.resize(width, 0);
        }
    }
}

impl<'a> Sensor<'a> {
    pub fn new(spec: &'a CameraSpec, rendering: &'a Rendering, noise_seed: u64) -> Self {
        let s = &spec.sensor;
        let jitter = step_thresholds(s.lateral_jitter_px);
        let lighting = Lighting::new(spec, rendering);
        Self {
            spec,
            rendering,
            // The lens and the depth steps look one pixel aside.
            plan: Plan::new(&lighting, jitter.len().max(1)),
            lighting,
            jitter,
            pixel_noise: Counter::new(noise_seed, 0),
            step_noise: Counter::new(noise_seed, 2),
            smooth: SmoothNoise::new(
                Counter::new(noise_seed, 1),
                s.correlation_px.max(2),
                rendering.intrinsics.width,
            ),
            device: Device::new(spec),
        }
    }

    /// Fills a picture.
    pub fn fill(&self, depth: &mut [f32], intensity: &mut [u8]) {
        let i = &self.rendering.intrinsics;
        let band = ROWS * i.width;
        let arch = pulp::Arch::new();
        depth
            .par_chunks_mut(band)
            .zip(intensity.par_chunks_mut(band))
            .enumerate()
            .for_each(|(n, (depth, intensity))| {
                SCRATCH.with_borrow_mut(|scratch| {
                    scratch.lattice.forget();
                    let width = i.width.next_multiple_of(TILE);
                    scratch.row.fit(width);
                    scratch.lit.fit(width, 2 * self.margin() + 1);
                    let first = n * ROWS;
                    arch.dispatch(BandJob {
                        sensor: self,
                        rows: (first, (first + ROWS).min(i.height)),
                        scratch,
                        depth,
                        intensity,
                    });
                });
            });
    }

    /// How far beside a pixel jitter and lens look.
    fn margin(&self) -> usize {
        self.jitter.len().max(1)
    }

    #[inline(always)]
    fn band(
        &self,
        (first, end): (usize, usize),
        scratch: &mut Scratch,
        depth: &mut [f32],
        intensity: &mut [u8],
    ) {
        let i = &self.rendering.intrinsics;
        let margin = self.margin();
        let mut lit_to = first.saturating_sub(margin);
        let rows = depth.chunks_mut(i.width).zip(intensity.chunks_mut(i.width));
        for (v, (depth_row, intensity_row)) in (first..end).zip(rows) {
            while lit_to < (v + margin + 1).min(i.height) {
                self.light_row(lit_to, &mut scratch.lit);
                lit_to += 1;
            }
            let row = &mut scratch.row;
            let mut bits = RowBits::new(self.pixel_noise, v);
            for words in &mut row.words {
                bits.fill(words);
            }
            self.draw_jitter(row);
            self.smooth
                .image_row(v, &mut scratch.lattice, &mut row.smooth[..i.width]);
            let patches = self.plan.patches(v);
            let mut done = 0;
            for (tile, _) in patches.iter().enumerate().filter(|(_, p)| !p.smooth) {
                self.pick_rows(v, tile, &scratch.lit, &mut done, row);
            }
            for (tile, patch) in patches.iter().enumerate() {
                if patch.smooth {
                    self.look_at_patch(v, tile, patch, row);
                } else {
                    self.pick_columns(tile, row);
                    // Within one face there is no step.
                    if !patch.one_face {
                        self.blur_steps(v, tile, row);
                    }
                    self.blur_grey(v, tile, &scratch.lit, row);
                }
            }
            self.measure(v, row, depth_row);
            self.expose(row, intensity_row);
        }
    }

    /// Lights what rough tiles look at in an image row.
    #[inline(always)]
    fn light_row(&self, v: usize, lit: &mut LitRows) {
        let shade = self.plan.shade(v);
        let looks = Plan::looks(v, self.margin());
        let patches = self.plan.patches(v);
        for (tile, (patch, looked)) in patches.iter().zip(self.plan.looked_at(v)).enumerate() {
            if looked & looks == 0 {
                continue;
            }
            let out = &mut lit.tile(v, tile);
            if patch.smooth {
                self.lighting.patch_pixels((v, v % BAND), tile, patch, out);
            } else {
                self.lighting.pixels(v, tile, shade[tile], out);
            }
        }
    }
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
        self.sensor
            .band(self.rows, self.scratch, self.depth, self.intensity);
    }
}
