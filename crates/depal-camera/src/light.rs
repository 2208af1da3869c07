//! What the projector's light and the camera's aperture make of each pixel, before chance enters.

use depal_frames::{Pose, Vector};

use crate::raster::{EMPTY, Strip, Tiles, draw};
use crate::view::{Face, Grid, View};
use crate::{CameraSpec, Rendering};

/// Something this far before a point hides it from the projector, metres.
const SHADOW_DEPTH: f32 = 0.002;
/// The projector's picture is at most this many times wider than the camera's.
const MAX_PROJECTOR_WIDTHS: f32 = 8.0;
/// Distance for which `SensorSpec::axial_noise` is given, metres.
const NOISE_DISTANCE: f32 = 3.0;
/// Albedo times projector cosine at which the axial noise is as given (brown board, head on).
const NOISE_SIGNAL: f32 = 0.5;
/// A weak or strong signal changes the axial noise by no more than these factors.
const SIGNAL_FACTORS: (f32, f32) = (0.5, 3.0);
/// Most that oblique sight adds to the axial noise.
const MOST_OBLIQUE: f32 = 20.0;
/// Half of the angle around the mirror direction that is over-exposed, as seen by the half vector.
const LOBE_DEG: f64 = 4.0;

/// Bits for the chance to be kept, below those for the deviation.
pub(crate) const KEEP_BITS: u32 = 12;
/// Always kept.
const KEEP_ALL: u32 = (1 << KEEP_BITS) - 1;
/// Steps of the packed deviation per metre.
const SIGMA_STEPS: f32 = 1e7;

/// Deviation of the axial noise, metres, from a packed word.
#[inline(always)]
pub(crate) fn sigma_of(packed: u32) -> f32 {
    ((packed >> KEEP_BITS) as i32) as f32 * (1.0 / SIGMA_STEPS)
}

/// Deviation of the axial noise, cut off at 0.1 m, and chance to be kept (0..=4095).
#[inline(always)]
fn pack(sigma: f32, keep: u32) -> u32 {
    // Pushes the integer into the low bits of the mantissa; the shift drops the others.
    const SHIFT: f32 = 8_388_608.0; // 2^23
    let steps = (sigma * SIGMA_STEPS).min(1_048_575.0) + SHIFT;
    (steps.to_bits() << KEEP_BITS) | keep
}

/// Rows of lit pixels.
#[derive(Default)]
pub(crate) struct LitRows {
    pub first_row: usize,
    /// Depth, metres; 0 where the sensor gets nothing for sure.
    pub depth: Vec<f32>,
    /// Deviation and chance, see [`sigma_of`].
    pub packed: Vec<u32>,
    /// Grey value before lens and noise.
    pub grey: Vec<f32>,
}

impl LitRows {
    /// Forgets the rows before this one.
    pub fn keep_from(&mut self, row: usize, width: usize) {
        let gone = (row - self.first_row) * width;
        if gone > 0 {
            self.depth.copy_within(gone.., 0);
            self.packed.copy_within(gone.., 0);
            self.grey.copy_within(gone.., 0);
        }
        self.first_row = row;
    }
}

/// Scratch memory of a worker.
#[derive(Default)]
pub(crate) struct LightScratch {
    tiles: Tiles,
    inverse_depth: Vec<f32>,
    surface: Vec<u32>,
    runs: Vec<ShadowRun>,
}

/// Neighbouring pixels of one solid in the projector's picture.
#[derive(Debug, Clone, Copy)]
struct ShadowRun {
    /// Column of the last one, counted from the strip's start.
    last: usize,
    solid: u32,
}

/// Light and optics of one exposure.
pub(crate) struct Lighting<'a> {
    spec: &'a CameraSpec,
    rendering: &'a Rendering,
    /// What the projector sees, when shadows are on.
    projector: Option<View>,
    /// X of the ray of each column.
    columns: Vec<f32>,
}

/// The constants of one run of pixels on one material.
struct Lamp {
    baseline: f32,
    yy: f32,
    near: f32,
    far: f32,
    /// Deviation per z^2, head on.
    sigma: f32,
    /// Least cosine to the projector.
    dark_cos: f32,
    /// sqrt of this times (distance to the projector / c1) is the factor of a weak signal.
    weak: Option<f32>,
    ambient_grey: f32,
    /// Grey of a surface facing the projector at 1 m.
    grey: f32,
    needs_light: bool,
    keep: u32,
}

/// What a lamp makes of one pixel.
struct Lit {
    depth: f32,
    sigma: f32,
    grey: f32,
    cos_view: f32,
    cos_light: f32,
}

impl Lamp {
    /// At the point of 1/z = `w` on the ray (x, y, 1), in a surface whose plane lies `k` before the
    /// camera and `c1` before the projector.
    #[inline(always)]
    fn shine(&self, w: f32, x: f32, k: f32, c1: f32) -> Lit {
        let z = 1.0 / w;
        let ray2 = x * x + self.yy;
        let across = self.baseline - x * z;
        let d = (across * across + self.yy * (z * z)).sqrt();
        let per_d = 1.0 / d;
        let cos_view = (k * w / ray2.sqrt()).max(1e-6);
        let c1 = c1.max(0.0);
        let cos_light = c1 * per_d;
        let oblique = (1.0 / cos_view).min(MOST_OBLIQUE);
        let weak = match self.weak {
            Some(weak) => (weak * d / c1.max(1e-9))
                .sqrt()
                .clamp(SIGNAL_FACTORS.0, SIGNAL_FACTORS.1),
            None => 1.0,
        };
        let lost = (z < self.near)
            | (z > self.far)
            | (cos_light < self.dark_cos)
            | (self.needs_light & (cos_light <= 0.0));
        Lit {
            depth: if lost { 0.0 } else { z },
            sigma: self.sigma * z * z * oblique * weak,
            grey: self.ambient_grey + self.grey * cos_light * per_d * per_d,
            cos_view,
            cos_light,
        }
    }
}

/// Pixels from one node to the next.
const SPACING: usize = 16;
/// Nodes of a piece of a run; what is lit at once.
const NODES: usize = 16;
/// Longest piece of a run.
const PIECE: usize = (NODES - 1) * SPACING;

impl Lamp {
    /// A piece of a row on a plane, not longer than [`PIECE`]. Deviation and grey are smooth along it:
    /// they are worked out at every 16th pixel and at the last one, and are straight in between, which
    /// is right to (16 / f)^2 / 8 of their value. The depth is that of each pixel.
    #[inline(always)]
    fn shine_on_plane(
        &self,
        (w, x): (&[f32], &[f32]),
        (k, c1): (f32, f32),
        depth: &mut [f32],
        packed: &mut [u32],
        grey: &mut [f32],
    ) {
        let last = w.len() - 1;
        let (mut node_w, mut node_x) = ([w[last]; NODES], [x[last]; NODES]);
        for (to, from) in node_w.iter_mut().zip(w.iter().step_by(SPACING)) {
            *to = *from;
        }
        for (to, from) in node_x.iter_mut().zip(x.iter().step_by(SPACING)) {
            *to = *from;
        }
        let (mut sigma, mut shade, mut seen) = ([0.0; NODES], [0.0; NODES], [0.0_f32; NODES]);
        for n in 0..NODES {
            let lit = self.shine(node_w[n], node_x[n], k, c1);
            (sigma[n], shade[n], seen[n]) = (lit.sigma, lit.grey, lit.depth);
        }
        // Range and cosines are least or greatest at the ends: what is seen at two nodes is seen
        // between them.
        if seen.contains(&0.0) {
            let pixels = depth.iter_mut().zip(packed).zip(grey).zip(w.iter().zip(x));
            for (((depth, packed), grey), (w, x)) in pixels {
                let lit = self.shine(*w, *x, k, c1);
                *depth = lit.depth;
                *packed = pack(lit.sigma, self.keep);
                *grey = lit.grey;
            }
            return;
        }
        let (depths, depth_rest) = depth.as_chunks_mut::<SPACING>();
        let (packs, packed_rest) = packed.as_chunks_mut::<SPACING>();
        let (greys, grey_rest) = grey.as_chunks_mut::<SPACING>();
        let (chunks, w_rest) = w.as_chunks::<SPACING>();
        let full = chunks.len();
        let slope = |values: &[f32; NODES], n: usize| {
            let span = ((n + 1) * SPACING)
                .min(last)
                .saturating_sub(n * SPACING)
                .max(1);
            (values[n + 1] - values[n]) / span as f32
        };
        let chunks = depths.iter_mut().zip(packs).zip(greys).zip(chunks);
        for (n, (((depth, packed), grey), w)) in chunks.enumerate() {
            let (s0, s1) = (sigma[n], slope(&sigma, n));
            let (g0, g1) = (shade[n], slope(&shade, n));
            for i in 0..SPACING {
                let t = i as i32 as f32;
                depth[i] = 1.0 / w[i];
                packed[i] = pack(s0 + s1 * t, self.keep);
                grey[i] = g0 + g1 * t;
            }
        }
        if w_rest.is_empty() {
            return;
        }
        let (s0, s1) = (sigma[full], slope(&sigma, full));
        let (g0, g1) = (shade[full], slope(&shade, full));
        let rest = depth_rest.iter_mut().zip(packed_rest).zip(grey_rest);
        for (i, (((depth, packed), grey), w)) in rest.zip(w_rest).enumerate() {
            let t = i as i32 as f32;
            *depth = 1.0 / *w;
            *packed = pack(s0 + s1 * t, self.keep);
            *grey = g0 + g1 * t;
        }
    }
}

/// Where the chance of being lost starts and where it is certain, as cosines.
struct Grazing {
    start: f32,
    end: f32,
}

impl<'a> Lighting<'a> {
    pub fn new(spec: &'a CameraSpec, rendering: &'a Rendering) -> Self {
        let i = rendering.intrinsics;
        let projector = spec.sensor.shadow.then(|| {
            let margin = (MAX_PROJECTOR_WIDTHS * i.width as f32) as i32;
            let grid = Grid {
                columns: (-margin, i.width as i32 + margin),
                rows: i.height,
                fx: i.fx,
                fy: i.fy,
                cx: i.cx,
                cy: i.cy,
            };
            let projector_from_world =
                Pose::translation(-spec.baseline, 0.0, 0.0) * rendering.camera_from_world;
            View::new(
                grid,
                &projector_from_world,
                &rendering.shapes,
                &rendering.meshes,
            )
        });
        Self {
            spec,
            rendering,
            projector,
            columns: (0..i.width)
                .map(|u| ((u as f64 - i.cx) / i.fx) as f32)
                .collect(),
        }
    }

    /// Lights rows `first..end`, behind those that `out` already holds.
    #[inline(always)]
    pub fn rows(&self, first: usize, end: usize, scratch: &mut LightScratch, out: &mut LitRows) {
        let r = self.rendering;
        let width = r.intrinsics.width;
        let length = (end - out.first_row) * width;
        for buffer in [&mut out.depth, &mut out.grey] {
            buffer.resize(length, 0.0);
        }
        out.packed.resize(length, 0);
        // No closure: that would be compiled for the oldest processor.
        let mut shadow = None;
        if let Some(view) = &self.projector {
            shadow = Some(self.draw_projector(view, first, end, scratch));
        }
        for v in first..end {
            let from = (v - out.first_row) * width;
            let at = from..from + width;
            self.light_row(
                v,
                &mut out.depth[at.clone()],
                &mut out.packed[at.clone()],
                &mut out.grey[at],
            );
            if let (Some((first_column, strip_width)), Some(view)) = (shadow, &self.projector) {
                let strip = (v - first) * strip_width..(v - first + 1) * strip_width;
                let shadow_row = ShadowRow {
                    view,
                    first_column,
                    inverse_depth: &scratch.inverse_depth[strip.clone()],
                    surface: &scratch.surface[strip],
                };
                let at = from..from + width;
                self.shade_row(
                    v,
                    &shadow_row,
                    &mut scratch.runs,
                    &mut out.depth[at.clone()],
                    &mut out.grey[at],
                );
            }
        }
    }

    /// The same rows from the projector: it stands on the camera's X axis, so rows correspond and a
    /// point at (u, z) lies in column u - fx * baseline / z. Returns first column and width.
    #[inline(always)]
    fn draw_projector(
        &self,
        view: &View,
        first: usize,
        end: usize,
        scratch: &mut LightScratch,
    ) -> (i32, usize) {
        let width = self.rendering.intrinsics.width;
        let disparity = (self.rendering.intrinsics.fx * self.spec.baseline) as f32;
        // Numbers that are not negative compare like their bits.
        let (mut low, mut high) = ([u32::MAX; 32], [0_u32; 32]);
        let depths = &self.rendering.inverse_depth[first * width..end * width];
        let (chunks, rest) = depths.as_chunks::<32>();
        for chunk in chunks {
            for k in 0..32 {
                low[k] = low[k].min(chunk[k].to_bits());
                high[k] = high[k].max(chunk[k].to_bits());
            }
        }
        let rest = rest.iter().map(|w| w.to_bits());
        let low = f32::from_bits(low.into_iter().chain(rest.clone()).fold(u32::MAX, u32::min));
        let high = f32::from_bits(high.into_iter().chain(rest).fold(0, u32::max));
        let high = high.min(1.0 / self.spec.near as f32);
        let most = MAX_PROJECTOR_WIDTHS * width as f32 - 4.0;
        let (a, b) = (disparity * low, disparity * high.max(low));
        let (least, greatest) = (a.min(b).clamp(-most, most), a.max(b).clamp(-most, most));
        let first_column = (-greatest).floor() as i32 - 1;
        let last_column = (width as f32 - least).ceil() as i32 + 1;
        let strip_width = (last_column - first_column).max(1) as usize;
        let pixels = strip_width * (end - first);
        scratch.inverse_depth.resize(pixels, 0.0);
        scratch.surface.resize(pixels, EMPTY);
        let mut strip = Strip {
            first_row: first,
            first_column,
            width: strip_width,
            inverse_depth: &mut scratch.inverse_depth[..pixels],
            surface: &mut scratch.surface[..pixels],
        };
        draw(view, &mut strip, &mut scratch.tiles);
        (first_column, strip_width)
    }

    fn y(&self, v: usize) -> f32 {
        let i = &self.rendering.intrinsics;
        ((v as f64 - i.cy) / i.fy) as f32
    }

    #[inline(always)]
    fn lamp(&self, face: &Face, y: f32) -> (Lamp, f32) {
        let s = &self.spec.sensor;
        let material = self.rendering.material(face.solid);
        let albedo = material.albedo as f32;
        let ambient = s.ambient as f32;
        let keep = (1.0 - material.dropout).clamp(0.0, 1.0);
        let lamp = Lamp {
            baseline: self.spec.baseline as f32,
            yy: y * y + 1.0,
            near: self.spec.near as f32,
            far: self.spec.far as f32,
            sigma: (s.axial_noise * material.noise_factor) as f32
                / (NOISE_DISTANCE * NOISE_DISTANCE),
            dark_cos: s.dark_limit as f32 / albedo.max(1e-6),
            weak: s.radiometric_noise.then(|| NOISE_SIGNAL / albedo.max(1e-6)),
            ambient_grey: 255.0 * albedo * ambient,
            grey: 255.0
                * albedo
                * (1.0 - ambient)
                * (s.exposure_distance * s.exposure_distance) as f32,
            needs_light: s.shadow,
            keep: (keep * f64::from(KEEP_ALL)).round() as u32,
        };
        (lamp, material.gloss as f32)
    }

    #[inline(always)]
    fn light_row(&self, v: usize, depth: &mut [f32], packed: &mut [u32], grey: &mut [f32]) {
        let r = self.rendering;
        let width = r.intrinsics.width;
        let surface = &r.surface[v * width..(v + 1) * width];
        let inverse_depth = &r.inverse_depth[v * width..(v + 1) * width];
        let y = self.y(v);
        let s = &self.spec.sensor;
        let grazing = (s.grazing_end < std::f64::consts::FRAC_PI_2).then(|| Grazing {
            start: s.grazing_start.cos() as f32,
            end: s.grazing_end.cos() as f32,
        });
        let mut end = 0;
        while end < width {
            let index = surface[end];
            let start = end;
            end += run_length(&surface[start..]);
            let (depth, packed, grey) = (
                &mut depth[start..end],
                &mut packed[start..end],
                &mut grey[start..end],
            );
            if index == EMPTY {
                depth.fill(0.0);
                packed.fill(0);
                grey.fill(0.0);
                continue;
            }
            let face = &r.view.faces[index as usize];
            let (lamp, gloss) = self.lamp(face, y);
            let (w, x) = (&inverse_depth[start..end], &self.columns[start..end]);
            if face.round != Face::FLAT {
                let pixels = depth.iter_mut().zip(packed).zip(grey).zip(w.iter().zip(x));
                let round = &r.view.rounds[face.round as usize];
                for (((depth, packed), grey), (w, x)) in pixels {
                    let point = Vector::new(f64::from(*x), f64::from(y), 1.0) / f64::from(*w);
                    let normal = round.normal_at(&point);
                    let k = -normal.dot(&point) as f32;
                    let c1 = (normal.x * self.spec.baseline) as f32 + k;
                    let lit = lamp.shine(*w, *x, k, c1);
                    self.store(
                        &lamp,
                        gloss,
                        grazing.as_ref(),
                        &lit,
                        *w,
                        *x,
                        (depth, packed, grey),
                    );
                }
                continue;
            }
            let k = face.distance;
            let c1 = face.normal[0] * self.spec.baseline as f32 + k;
            let plain = gloss == 0.0
                && grazing
                    .as_ref()
                    .is_none_or(|g| self.is_steep(&lamp, (w, x), (k, c1), g.start));
            if plain {
                let pieces = depth
                    .chunks_mut(PIECE)
                    .zip(packed.chunks_mut(PIECE))
                    .zip(grey.chunks_mut(PIECE))
                    .zip(w.chunks(PIECE).zip(x.chunks(PIECE)));
                for (((depth, packed), grey), (w, x)) in pieces {
                    lamp.shine_on_plane((w, x), (k, c1), depth, packed, grey);
                }
            } else {
                let pixels = depth.iter_mut().zip(packed).zip(grey).zip(w.iter().zip(x));
                for (((depth, packed), grey), (w, x)) in pixels {
                    let lit = lamp.shine(*w, *x, k, c1);
                    self.store(
                        &lamp,
                        gloss,
                        grazing.as_ref(),
                        &lit,
                        *w,
                        *x,
                        (depth, packed, grey),
                    );
                }
            }
        }
    }

    /// True when no pixel of a flat run is seen or lit at more than the angle of cosine `least`.
    /// Distances to a line are greatest at its ends, so the cosines are least there.
    #[inline(always)]
    fn is_steep(
        &self,
        lamp: &Lamp,
        (w, x): (&[f32], &[f32]),
        (k, c1): (f32, f32),
        least: f32,
    ) -> bool {
        let ends = [0, w.len() - 1].map(|n| {
            let z = 1.0 / w[n];
            let across = lamp.baseline - x[n] * z;
            let light = (across * across + lamp.yy * (z * z)).sqrt();
            (z * (x[n] * x[n] + lamp.yy).sqrt(), light)
        });
        let view = ends[0].0.max(ends[1].0);
        let light = ends[0].1.max(ends[1].1);
        k >= least * view && (!self.spec.sensor.shadow || c1 >= least * light)
    }

    /// Writes a pixel that may be over-exposed or seen at a grazing angle.
    #[inline(always)]
    fn store(
        &self,
        lamp: &Lamp,
        gloss: f32,
        grazing: Option<&Grazing>,
        lit: &Lit,
        w: f32,
        x: f32,
        (depth, packed, grey): (&mut f32, &mut u32, &mut f32),
    ) {
        *depth = lit.depth;
        *grey = lit.grey;
        let mut keep = lamp.keep;
        if let Some(Grazing { start, end }) = grazing {
            let least = if self.spec.sensor.shadow {
                lit.cos_view.min(lit.cos_light)
            } else {
                lit.cos_view
            };
            let share = (least - end) / (start - end).max(1e-6);
            if share <= 0.0 {
                *depth = 0.0;
            }
            keep = (keep as i32 as f32 * share.clamp(0.0, 1.0)) as u32;
        }
        if gloss > 0.0 && lit.cos_light > 0.0 {
            // Between the directions to camera and projector: v . l = (z ray^2 - x b) / (|ray| d).
            let z = 1.0 / w;
            let ray2 = x * x + lamp.yy;
            let across = lamp.baseline - x * z;
            let d = (across * across + lamp.yy * (z * z)).sqrt();
            let between = (z * ray2 - x * lamp.baseline) / (ray2.sqrt() * d);
            let half = (lit.cos_view + lit.cos_light) / (2.0 + 2.0 * between).max(1e-6).sqrt();
            if half > LOBE_DEG.to_radians().cos() as f32 {
                *depth = 0.0;
                *grey += 255.0 * gloss;
            }
        }
        *packed = pack(lit.sigma, keep);
    }

    /// Takes depth and projector light from pixels that the projector does not reach.
    #[inline(always)]
    fn shade_row(
        &self,
        v: usize,
        shadow: &ShadowRow,
        runs: &mut Vec<ShadowRun>,
        depth: &mut [f32],
        grey: &mut [f32],
    ) {
        let r = self.rendering;
        let width = r.intrinsics.width;
        let surface = &r.surface[v * width..(v + 1) * width];
        let inverse_depth = &r.inverse_depth[v * width..(v + 1) * width];
        let disparity = (r.intrinsics.fx * self.spec.baseline) as f32;
        shadow.runs(runs);
        let mut hide = |solid: u32, from: usize, to: usize| {
            let dark = self.ambient_grey(solid);
            for u in from..to {
                if !shadow.reaches(u, disparity, inverse_depth[u], solid) {
                    depth[u] = 0.0;
                    grey[u] = dark;
                }
            }
        };
        let mut end = 0;
        while end < width {
            let index = surface[end];
            let start = end;
            end += run_length(&surface[start..]);
            if index == EMPTY {
                continue;
            }
            let face = &r.view.faces[index as usize];
            if face.round != Face::FLAT {
                hide(face.solid, start, end);
                continue;
            }
            // On a plane the projector's column is affine in the camera's.
            let first = shadow.column(start, disparity * inverse_depth[start]);
            let last = shadow.column(end - 1, disparity * inverse_depth[end - 1]);
            if last < first {
                continue; // turned away from the projector: lit by nothing
            }
            let mut run = runs.partition_point(|run| run.last < first);
            let slope = (last - first + 1) as f32 / (end - start) as f32;
            let per_slope = 1.0 / slope;
            let mut from = first;
            while run < runs.len() && from <= last {
                let ShadowRun { last: stop, solid } = runs[run];
                if solid != face.solid && solid != EMPTY {
                    let to_camera = |column: usize| (column as f32 - first as f32) * per_slope;
                    let u0 = start + (to_camera(from) - 3.0).max(0.0) as usize;
                    let u1 = start + (to_camera(stop.min(last)) + 4.0) as usize;
                    hide(face.solid, u0.min(end), u1.min(end));
                }
                from = stop + 1;
                run += 1;
            }
        }
    }

    fn ambient_grey(&self, solid: u32) -> f32 {
        (255.0 * self.rendering.material(solid).albedo * self.spec.sensor.ambient) as f32
    }
}

/// How many values at the start of a row are the same.
#[inline(always)]
pub(crate) fn run_length(row: &[u32]) -> usize {
    let first = row[0];
    let (chunks, rest) = row.as_chunks::<16>();
    let mut length = 0;
    for chunk in chunks {
        let different = chunk.iter().fold(0, |d, s| d | (s ^ first));
        if different != 0 {
            return length + chunk.iter().take_while(|s| **s == first).count();
        }
        length += 16;
    }
    length + rest.iter().take_while(|s| **s == first).count()
}

/// A row as the projector sees it.
struct ShadowRow<'a> {
    view: &'a View,
    first_column: i32,
    inverse_depth: &'a [f32],
    surface: &'a [u32],
}

impl ShadowRow<'_> {
    #[inline(always)]
    fn column(&self, u: usize, disparity: f32) -> usize {
        let column = (u as i32 - self.first_column) as f32 - disparity + 0.5;
        (column.max(0.0) as usize).min(self.surface.len() - 1)
    }

    #[inline(always)]
    fn solid(&self, index: u32) -> u32 {
        match self.view.faces.get(index as usize) {
            Some(face) => face.solid,
            None => EMPTY,
        }
    }

    #[inline(always)]
    fn runs(&self, runs: &mut Vec<ShadowRun>) {
        runs.clear();
        let mut end = 0;
        while end < self.surface.len() {
            let solid = self.solid(self.surface[end]);
            end += run_length(&self.surface[end..]);
            match runs.last_mut() {
                Some(run) if run.solid == solid => run.last = end - 1,
                _ => runs.push(ShadowRun {
                    last: end - 1,
                    solid,
                }),
            }
        }
    }

    /// Whether light reaches the point at column `u` with inverse depth `w` on a solid.
    /// A convex solid does not hide its own lit side, so its own surfaces do not count.
    #[inline(always)]
    fn reaches(&self, u: usize, disparity: f32, w: f32, solid: u32) -> bool {
        let column = self.column(u, disparity * w);
        let other = self.inverse_depth[column];
        // 1/w - 1/other > depth, without the divisions.
        if other - w <= SHADOW_DEPTH * w * other {
            return true;
        }
        self.solid(self.surface[column]) == solid
    }
}
