use depal_frames::DepthFrame;
use rayon::prelude::*;

use crate::capture::{Capture, NOTHING};
use crate::noise::{
    Counter, SmoothNoise, nearest_integer, normal, normal_table, step_table, steps, uniform,
};
use crate::raster::EMPTY;
use crate::{CameraSpec, Rendering};

/// Distance for which `SensorSpec::axial_noise` is given, metres.
const NOISE_DISTANCE: f32 = 3.0;
/// Albedo times projector cosine at which the axial noise is as given (brown board, head on).
const NOISE_SIGNAL: f32 = 0.5;
/// A weak or strong signal changes the axial noise by no more than these factors.
const SIGNAL_FACTORS: (f32, f32) = (0.5, 3.0);

/// What the sensor makes of a rendering. `noise_seed` should differ from frame to frame.
///
/// Order of effects: sideways jitter picks the source pixel; range, shadow, grazing, darkness,
/// depth steps and chance take pixels away; bowl, scale and axial noise move the depth; rounding last.
pub fn sense(spec: &CameraSpec, rendering: &Rendering, noise_seed: u64) -> Capture {
    let i = rendering.intrinsics;
    let mut capture = Capture {
        frame: DepthFrame::blank(i),
        ids: rendering
            .surface
            .iter()
            .map(|s| {
                if *s == EMPTY {
                    NOTHING
                } else {
                    rendering.id_of_surface[*s as usize]
                }
            })
            .collect(),
        ideal_depth: rendering
            .inverse_depth
            .iter()
            .map(|w| if *w > 0.0 { 1.0 / w } else { 0.0 })
            .collect(),
    };
    if spec.sensor.blackout || i.width == 0 {
        return capture;
    }
    let spacing = spec.sensor.correlation_px.max(2);
    let sensor = Sensor {
        spec,
        rendering,
        table: normal_table(),
        jitter: step_table(normal_table(), spec.sensor.lateral_jitter_px as f32),
        pixel_noise: Counter::new(noise_seed, 0),
        smooth: SmoothNoise::new(Counter::new(noise_seed, 1), spacing, i.width),
        bowl: Bowl::new(spec),
    };
    let band = spacing * i.width;
    capture
        .frame
        .depth
        .par_chunks_mut(band)
        .zip(capture.frame.intensity.par_chunks_mut(band))
        .enumerate()
        .for_each(|(n, (depth, intensity))| {
            let (above, below) = (
                sensor.smooth.lattice_row(sensor.table, n),
                sensor.smooth.lattice_row(sensor.table, n + 1),
            );
            let mut scratch = Scratch::new(i.width);
            let rows = depth.chunks_mut(i.width).zip(intensity.chunks_mut(i.width));
            for (v, (depth_row, intensity_row)) in (n * spacing..).zip(rows) {
                sensor
                    .smooth
                    .image_row(v, &above, &below, &mut scratch.smooth);
                sensor.depth_row(v, &mut scratch, depth_row);
                sensor.intensity_row(v, &mut scratch, intensity_row);
            }
        });
    capture
}

/// Row buffers of one worker.
struct Scratch {
    smooth: Vec<f32>,
    blend: Vec<f32>,
    border: Vec<bool>,
}

impl Scratch {
    fn new(width: usize) -> Self {
        Self {
            smooth: vec![0.0; width],
            blend: vec![0.0; width],
            border: vec![false; width],
        }
    }
}

/// Depth error that grows with the square of the distance from the image centre.
struct Bowl {
    height: f32,
    u: f32,
    v: f32,
    scale: f32,
}

impl Bowl {
    fn new(spec: &CameraSpec) -> Self {
        let i = &spec.intrinsics;
        let (u, v) = ((i.width as f32 - 1.0) * 0.5, (i.height as f32 - 1.0) * 0.5);
        Self {
            height: spec.sensor.bowl as f32,
            u,
            v,
            scale: 1.0 / (u * u + v * v).max(1.0),
        }
    }

    /// -height/2 in the centre, +height/2 in the corners.
    fn at(&self, u: usize, v: usize) -> f32 {
        let (x, y) = (u as f32 - self.u, v as f32 - self.v);
        self.height * ((x * x + y * y) * self.scale - 0.5)
    }
}

struct Sensor<'a> {
    spec: &'a CameraSpec,
    rendering: &'a Rendering,
    table: &'a [f32],
    jitter: Vec<i8>,
    pixel_noise: Counter,
    smooth: SmoothNoise,
    bowl: Bowl,
}

impl Sensor<'_> {
    fn depth_row(&self, v: usize, scratch: &mut Scratch, out: &mut [f32]) {
        let r = self.rendering;
        let s = &self.spec.sensor;
        let (width, height) = (r.intrinsics.width, r.intrinsics.height);
        let (near, far) = (self.spec.near as f32, self.spec.far as f32);
        let jitter = s.lateral_jitter_px > 0.0;
        let steps_per_metre = 1.0 / s.quantum.max(1e-12);
        let (grazing_start, grazing_end) =
            (s.grazing_start.cos() as f32, s.grazing_end.cos() as f32);
        let grazing = s.grazing_end < std::f64::consts::FRAC_PI_2;
        let grazing_scale = 1.0 / (grazing_start - grazing_end).max(1e-6);
        let dark_limit = s.dark_limit as f32;
        let random_dropout = s.random_dropout as f32;
        let (edge_dropout, mixed_pixels) = (s.edge_dropout as f32, s.mixed_pixels as f32);
        let edges = edge_dropout + mixed_pixels > 0.0;
        let base_sigma = s.axial_noise as f32 / (NOISE_DISTANCE * NOISE_DISTANCE);
        let (white, smooth) = (
            (1.0 - s.correlated_share).sqrt() as f32,
            s.correlated_share.sqrt() as f32,
        );
        let scale = 1.0 + s.scale_error as f32;
        if edges {
            self.mark_borders(v, &mut scratch.border);
        }
        for (u, depth) in out.iter_mut().enumerate() {
            let pixel = v * width + u;
            let first = self.pixel_noise.word(2 * pixel as u64);
            let second = self.pixel_noise.word(2 * pixel as u64 + 1);
            let source = if jitter {
                let shift = |lane, at: usize, count: usize| {
                    (at as i32 + steps(&self.jitter, first, lane)).clamp(0, count as i32 - 1)
                        as usize
                };
                shift(1, v, height) * width + shift(0, u, width)
            } else {
                pixel
            };
            let w = r.inverse_depth[source];
            if w <= 0.0 {
                continue;
            }
            let mut z = 1.0 / w;
            if z < near || z > far {
                continue;
            }
            let (cos_view, cos_light) = (r.cos_view[source], r.cos_light[source]);
            let signal = r.albedo_of_surface[r.surface[source] as usize] * cos_light;
            if s.shadow && cos_light <= 0.0 || signal < dark_limit {
                continue;
            }
            if grazing {
                let least = if s.shadow {
                    cos_view.min(cos_light)
                } else {
                    cos_view
                };
                if uniform(first, 2) >= (least - grazing_end) * grazing_scale {
                    continue;
                }
            }
            if uniform(first, 3) < random_dropout {
                continue;
            }
            if edges && scratch.border[u] {
                let (nearest, farthest, gap) = self.depth_range(u, v);
                if gap || farthest - nearest > s.step as f32 {
                    let chance = uniform(second, 2);
                    if chance < edge_dropout {
                        continue;
                    }
                    if chance < edge_dropout + mixed_pixels {
                        z = 0.5 * (nearest + farthest);
                    }
                }
            }
            let noise = white * normal(self.table, second, 0) + smooth * scratch.smooth[u];
            let weak = (NOISE_SIGNAL / signal.max(1e-6))
                .sqrt()
                .clamp(SIGNAL_FACTORS.0, SIGNAL_FACTORS.1);
            let weak = if s.radiometric_noise { weak } else { 1.0 };
            let sigma = base_sigma * z * z / cos_view.max(0.05) * weak;
            let measured = z * scale + self.bowl.at(u, v) + sigma * noise;
            *depth = if s.quantum > 0.0 {
                (nearest_integer(f64::from(measured) * steps_per_metre) * s.quantum) as f32
            } else {
                measured
            };
            if *depth < near || *depth > far {
                *depth = 0.0;
            }
        }
    }

    /// Marks the pixels of row `v` with more than one surface within 3x3.
    fn mark_borders(&self, v: usize, border: &mut [bool]) {
        let width = self.rendering.intrinsics.width;
        let row = |v: usize| &self.rendering.surface[v * width..(v + 1) * width];
        let middle = row(v);
        let above = row(v.saturating_sub(1));
        let below = row((v + 1).min(self.rendering.intrinsics.height - 1));
        border.fill(false);
        for u in 0..width {
            let turns = above[u] != middle[u] || below[u] != middle[u];
            let changes = u + 1 < width && middle[u] != middle[u + 1];
            if turns || changes {
                border[u.saturating_sub(1)] |= turns;
                border[u] = true;
                if u + 1 < width {
                    border[u + 1] = true;
                }
            }
        }
    }

    /// Nearest and farthest depth within 3x3, and whether there is nothing at one of the pixels.
    fn depth_range(&self, u: usize, v: usize) -> (f32, f32, bool) {
        let i = &self.rendering.intrinsics;
        let (mut low, mut high) = (f32::INFINITY, 0.0_f32);
        let mut gap = false;
        for y in v.saturating_sub(1)..=(v + 1).min(i.height - 1) {
            for x in u.saturating_sub(1)..=(u + 1).min(i.width - 1) {
                let w = self.rendering.inverse_depth[y * i.width + x];
                if w > 0.0 {
                    low = low.min(w);
                    high = high.max(w);
                } else {
                    gap = true;
                }
            }
        }
        (1.0 / high, 1.0 / low, gap)
    }

    fn intensity_row(&self, v: usize, scratch: &mut Scratch, out: &mut [u8]) {
        let i = &self.rendering.intrinsics;
        let s = &self.spec.sensor;
        let row = |v: usize| &self.rendering.grey[v * i.width..(v + 1) * i.width];
        let middle = row(v);
        if s.blur {
            let above = row(v.saturating_sub(1));
            let below = row((v + 1).min(i.height - 1));
            for (u, blend) in scratch.blend.iter_mut().enumerate() {
                *blend = 0.0625 * (above[u] + below[u]) + 0.125 * middle[u];
            }
        }
        let noise = s.intensity_noise as f32;
        let blend = &scratch.blend;
        for (u, value) in out.iter_mut().enumerate() {
            let grey = if s.blur {
                blend[u.saturating_sub(1)] + 2.0 * blend[u] + blend[(u + 1).min(i.width - 1)]
            } else {
                middle[u]
            };
            let grey = if noise > 0.0 {
                let word = self.pixel_noise.word(2 * (v * i.width + u) as u64 + 1);
                grey + noise * normal(self.table, word, 3)
            } else {
                grey
            };
            *value = (grey + 0.5).clamp(0.0, 255.0) as u8;
        }
    }
}
