use depal_frames::{Intrinsics, Pose};
use rayon::prelude::*;

use crate::raster::{EMPTY, Grid, Row, draw_row};
use crate::surface::{Surface, push_surfaces};
use crate::{CameraSpec, RenderShape};

/// Rows that are worked on together; small enough for the second-level cache.
const BAND: usize = 8;
/// Something this far before a point hides it from the projector, metres.
const SHADOW_DEPTH: f32 = 0.002;
/// The projector's picture is at most this many times wider than the camera's.
const MAX_PROJECTOR_WIDTHS: f64 = 8.0;

/// What is there, seen without a sensor: the exact image of the solids and their light.
#[derive(Debug, Clone)]
pub struct Rendering {
    pub(crate) intrinsics: Intrinsics,
    /// 1/z, 1/m; 0 = nothing.
    pub(crate) inverse_depth: Vec<f32>,
    /// Index into `shape_of_surface`, or `EMPTY`.
    pub(crate) surface: Vec<u32>,
    /// Cosine of the incidence to the camera.
    pub(crate) cos_view: Vec<f32>,
    /// Cosine of the incidence to the projector, 0 where its light does not reach.
    pub(crate) cos_light: Vec<f32>,
    /// Grey value before lens and noise.
    pub(crate) grey: Vec<f32>,
    pub(crate) albedo_of_surface: Vec<f32>,
    pub(crate) id_of_surface: Vec<u32>,
}

/// Draws the shapes from the camera and, if the sensor has shadows, from the projector.
pub fn render(spec: &CameraSpec, world_from_camera: &Pose, shapes: &[RenderShape]) -> Rendering {
    let mut rendering = Rendering {
        intrinsics: spec.intrinsics,
        inverse_depth: Vec::new(),
        surface: Vec::new(),
        cos_view: Vec::new(),
        cos_light: Vec::new(),
        grey: Vec::new(),
        albedo_of_surface: Vec::new(),
        id_of_surface: Vec::new(),
    };
    rendering.redraw(spec, world_from_camera, shapes);
    rendering
}

impl Rendering {
    /// The same as [`render`] into the buffers of an earlier rendering, whatever it showed:
    /// at 1.3 million pixels fetching new memory costs as much as drawing.
    pub fn redraw(&mut self, spec: &CameraSpec, world_from_camera: &Pose, shapes: &[RenderShape]) {
        draw(self, spec, world_from_camera, shapes);
    }
}

fn draw(out: &mut Rendering, spec: &CameraSpec, world_from_camera: &Pose, shapes: &[RenderShape]) {
    let i = spec.intrinsics;
    let pixels = i.width * i.height;
    let camera_from_world = world_from_camera.inverse();
    let projector_from_camera = Pose::translation(-spec.baseline, 0.0, 0.0);
    let mut seen = Vec::new();
    let mut lit = Vec::new();
    for (index, item) in shapes.iter().enumerate() {
        let camera_from_shape = camera_from_world * item.world_from_shape;
        push_surfaces(&mut seen, index as u32, &camera_from_shape, &item.shape);
        if spec.sensor.shadow {
            let projector_from_shape = projector_from_camera * camera_from_shape;
            push_surfaces(&mut lit, index as u32, &projector_from_shape, &item.shape);
        }
    }
    let material = |s: &Surface| &shapes[s.shape as usize];
    out.intrinsics = i;
    // What is left of an earlier picture is overwritten band by band, while it is in the cache.
    for buffer in [
        &mut out.inverse_depth,
        &mut out.cos_view,
        &mut out.cos_light,
        &mut out.grey,
    ] {
        buffer.resize(pixels, 0.0);
    }
    out.surface.resize(pixels, EMPTY);
    out.albedo_of_surface = seen
        .iter()
        .map(|s| material(s).material.albedo as f32)
        .collect();
    out.id_of_surface = seen.iter().map(|s| material(s).id).collect();
    if pixels == 0 {
        return;
    }
    let scene = Scene {
        spec,
        grid: Grid {
            width: i.width,
            fx: i.fx,
            fy: i.fy,
            cx: i.cx,
            cy: i.cy,
        },
        seen: with_rows(&seen, &i),
        lit: with_rows(&lit, &i),
        albedo: &out.albedo_of_surface,
        columns: (0..i.width)
            .map(|u| ((u as f64 - i.cx) / i.fx) as f32)
            .collect(),
    };
    let band = BAND * i.width;
    out.inverse_depth
        .par_chunks_mut(band)
        .zip(out.surface.par_chunks_mut(band))
        .zip(out.cos_view.par_chunks_mut(band))
        .zip(out.cos_light.par_chunks_mut(band))
        .zip(out.grey.par_chunks_mut(band))
        .enumerate()
        .for_each_init(ProjectorBand::default, |projector, (n, band)| {
            let ((((inverse_depth, surface), cos_view), cos_light), grey) = band;
            scene.draw_band(
                n * BAND,
                projector,
                inverse_depth,
                surface,
                cos_view,
                cos_light,
                grey,
            );
        });
}

/// A surface with the image rows that it can touch (last excluded).
struct RowSurface {
    rows: (usize, usize),
    surface: Surface,
}

fn with_rows(surfaces: &[Surface], i: &Intrinsics) -> Vec<RowSurface> {
    let grid = Grid {
        width: i.width,
        fx: i.fx,
        fy: i.fy,
        cx: i.cx,
        cy: i.cy,
    };
    surfaces
        .iter()
        .map(|surface| RowSurface {
            rows: grid
                .rows(surface.bounds.y, i.height)
                .map_or((0, 0), |(first, last)| (first, last + 1)),
            surface: *surface,
        })
        .collect()
}

struct Scene<'a> {
    spec: &'a CameraSpec,
    grid: Grid,
    seen: Vec<RowSurface>,
    lit: Vec<RowSurface>,
    albedo: &'a [f32],
    /// X of the ray of each column.
    columns: Vec<f32>,
}

impl Scene<'_> {
    fn draw_band(
        &self,
        first_row: usize,
        projector: &mut ProjectorBand,
        inverse_depth: &mut [f32],
        surface: &mut [u32],
        cos_view: &mut [f32],
        cos_light: &mut [f32],
        grey: &mut [f32],
    ) {
        let width = self.grid.width;
        inverse_depth.fill(0.0);
        surface.fill(EMPTY);
        draw_surfaces(&self.seen, &self.grid, first_row, inverse_depth, surface);
        let shadow = self.spec.sensor.shadow;
        if shadow {
            self.draw_projector_band(first_row, inverse_depth, projector);
        }
        for (k, v) in (first_row..).take(inverse_depth.len() / width).enumerate() {
            let range = k * width..(k + 1) * width;
            let shadow_row = shadow.then(|| projector.row(k));
            let drawn = (&inverse_depth[range.clone()], &surface[range.clone()]);
            self.light_row(
                v,
                drawn,
                shadow_row,
                &mut cos_view[range.clone()],
                &mut cos_light[range.clone()],
                &mut grey[range],
            );
        }
    }

    /// The same rows from the projector: it stands on the camera's X axis, so rows correspond
    /// and a point at (u, z) lies in column u - fx * baseline / z.
    fn draw_projector_band(
        &self,
        first_row: usize,
        inverse_depth: &[f32],
        band: &mut ProjectorBand,
    ) {
        let width = self.grid.width;
        let nearest = inverse_depth.iter().fold(0.0_f32, |a, b| a.max(*b));
        let reach =
            f64::from(nearest).min(1.0 / self.spec.near) * self.grid.fx * self.spec.baseline;
        let extra = reach.abs().ceil().min(MAX_PROJECTOR_WIDTHS * width as f64) as usize + 1;
        let left = if self.spec.baseline > 0.0 { extra } else { 0 };
        let grid = Grid {
            width: width + extra,
            cx: self.grid.cx + left as f64,
            ..self.grid
        };
        let pixels = inverse_depth.len() / width * grid.width;
        band.width = grid.width;
        band.left = left;
        band.inverse_depth.clear();
        band.inverse_depth.resize(pixels, 0.0);
        band.surface.clear();
        band.surface.resize(pixels, EMPTY);
        draw_surfaces(
            &self.lit,
            &grid,
            first_row,
            &mut band.inverse_depth,
            &mut band.surface,
        );
    }

    fn light_row(
        &self,
        v: usize,
        (inverse_depth, surface): (&[f32], &[u32]),
        shadow: Option<ShadowRow>,
        cos_view: &mut [f32],
        cos_light: &mut [f32],
        grey: &mut [f32],
    ) {
        let y = ((v as f64 - self.grid.cy) / self.grid.fy) as f32;
        let disparity = (self.grid.fx * self.spec.baseline) as f32;
        let sensor = &self.spec.sensor;
        let ambient = sensor.ambient as f32;
        let beam = Beam {
            baseline: self.spec.baseline as f32,
            reference: (sensor.exposure_distance * sensor.exposure_distance) as f32,
        };
        let mut end = 0;
        while end < surface.len() {
            let index = surface[end];
            let start = end;
            end += surface[start..].iter().take_while(|s| **s == index).count();
            if index == EMPTY {
                cos_view[start..end].fill(0.0);
                cos_light[start..end].fill(0.0);
                grey[start..end].fill(0.0);
                continue;
            }
            let Surface { shape, kind, .. } = &self.seen[index as usize].surface;
            let run = inverse_depth[start..end]
                .iter()
                .zip(&self.columns[start..end])
                .zip(&mut cos_view[start..end])
                .zip(&mut cos_light[start..end])
                .zip(&mut grey[start..end]);
            // Grey holds the beam's strength until shadows are known.
            if let Some(normal) = kind.constant_normal() {
                let normal = normal.cast::<f32>();
                for ((((w, x), view), light), strength) in run {
                    (*view, *light, *strength) = beam.light(&normal, *x, y, 1.0 / *w);
                }
            } else {
                for ((((w, x), view), light), strength) in run {
                    let z = 1.0 / *w;
                    let point = nalgebra::Vector3::new(*x, y, 1.0) * z;
                    let normal = kind.normal_at(&point.cast::<f64>()).cast::<f32>();
                    (*view, *light, *strength) = beam.light(&normal, *x, y, z);
                }
            }
            if let Some(shadow) = &shadow {
                for u in start..end {
                    let w = inverse_depth[u];
                    if !shadow.reaches(u, disparity * w, w, *shape, &self.lit) {
                        cos_light[u] = 0.0;
                    }
                }
            }
            let white = 255.0 * self.albedo[index as usize];
            for (value, light) in grey[start..end].iter_mut().zip(&cos_light[start..end]) {
                *value = white * (ambient + (1.0 - ambient) * *light * *value);
            }
        }
    }
}

/// The projector's light.
struct Beam {
    baseline: f32,
    /// Square of the distance at which its strength is 1.
    reference: f32,
}

impl Beam {
    /// Cosines of the incidence to camera and projector (0 when turned away), and the beam's strength,
    /// at the point of depth `z` on the ray (x, y, 1).
    #[inline]
    fn light(&self, normal: &nalgebra::Vector3<f32>, x: f32, y: f32, z: f32) -> (f32, f32, f32) {
        let along = normal.x * x + normal.y * y + normal.z;
        let view = -along / (x * x + y * y + 1.0).sqrt();
        let to_x = self.baseline - x * z;
        let distance2 = to_x * to_x + (y * y + 1.0) * z * z;
        let facing = (normal.x * self.baseline - z * along) / distance2.sqrt();
        let clip = |c: f32| c.clamp(0.0, 1.0);
        (clip(view), clip(facing), self.reference / distance2)
    }
}

fn draw_surfaces(
    list: &[RowSurface],
    grid: &Grid,
    first_row: usize,
    inverse_depth: &mut [f32],
    surface: &mut [u32],
) {
    let end_row = first_row + inverse_depth.len() / grid.width;
    for (index, item) in list.iter().enumerate() {
        for v in item.rows.0.max(first_row)..item.rows.1.min(end_row) {
            let range = (v - first_row) * grid.width..(v - first_row + 1) * grid.width;
            let mut row = Row {
                inverse_depth: &mut inverse_depth[range.clone()],
                surface: &mut surface[range],
            };
            draw_row(&mut row, grid, v, index as u32, &item.surface);
        }
    }
}

/// The projector's picture of a band of rows; a worker's scratch memory.
#[derive(Default)]
struct ProjectorBand {
    width: usize,
    left: usize,
    inverse_depth: Vec<f32>,
    surface: Vec<u32>,
}

impl ProjectorBand {
    fn row(&self, k: usize) -> ShadowRow<'_> {
        let range = k * self.width..(k + 1) * self.width;
        ShadowRow {
            left: self.left as f32,
            inverse_depth: &self.inverse_depth[range.clone()],
            surface: &self.surface[range],
        }
    }
}

struct ShadowRow<'a> {
    left: f32,
    inverse_depth: &'a [f32],
    surface: &'a [u32],
}

impl ShadowRow<'_> {
    /// Whether light reaches the point at column `u` with inverse depth `w` on solid `shape`.
    /// A convex solid does not hide its own lit side, so its own surfaces do not count.
    fn reaches(&self, u: usize, disparity: f32, w: f32, shape: u32, lit: &[RowSurface]) -> bool {
        let column = (u as f32 + self.left - disparity + 0.5).max(0.0) as usize;
        let Some(other) = self.inverse_depth.get(column) else {
            return true;
        };
        // 1/w - 1/other > depth, without the divisions.
        if *other - w <= SHADOW_DEPTH * w * *other {
            return true;
        }
        lit[self.surface[column] as usize].surface.shape == shape
    }
}
