use depal_frames::{Intrinsics, Pose, Vector};
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
    let mut out = Rendering {
        intrinsics: i,
        inverse_depth: vec![0.0; pixels],
        surface: vec![EMPTY; pixels],
        cos_view: vec![0.0; pixels],
        cos_light: vec![0.0; pixels],
        grey: vec![0.0; pixels],
        albedo_of_surface: seen
            .iter()
            .map(|s| material(s).material.albedo as f32)
            .collect(),
        id_of_surface: seen.iter().map(|s| material(s).id).collect(),
    };
    if pixels == 0 {
        return out;
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
    };
    let band = BAND * i.width;
    out.inverse_depth
        .par_chunks_mut(band)
        .zip(out.surface.par_chunks_mut(band))
        .zip(out.cos_view.par_chunks_mut(band))
        .zip(out.cos_light.par_chunks_mut(band))
        .zip(out.grey.par_chunks_mut(band))
        .enumerate()
        .for_each(
            |(n, ((((inverse_depth, surface), cos_view), cos_light), grey))| {
                scene.draw_band(n * BAND, inverse_depth, surface, cos_view, cos_light, grey);
            },
        );
    out
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
}

impl Scene<'_> {
    fn draw_band(
        &self,
        first_row: usize,
        inverse_depth: &mut [f32],
        surface: &mut [u32],
        cos_view: &mut [f32],
        cos_light: &mut [f32],
        grey: &mut [f32],
    ) {
        let width = self.grid.width;
        draw_surfaces(&self.seen, &self.grid, first_row, inverse_depth, surface);
        let shadow = self
            .spec
            .sensor
            .shadow
            .then(|| self.projector_band(first_row, inverse_depth));
        for (k, v) in (first_row..).take(inverse_depth.len() / width).enumerate() {
            let range = k * width..(k + 1) * width;
            let shadow_row = shadow.as_ref().map(|s| s.row(k));
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
    fn projector_band(&self, first_row: usize, inverse_depth: &[f32]) -> ProjectorBand {
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
        let mut band = ProjectorBand {
            width: grid.width,
            left,
            inverse_depth: vec![0.0; pixels],
            surface: vec![EMPTY; pixels],
        };
        draw_surfaces(
            &self.lit,
            &grid,
            first_row,
            &mut band.inverse_depth,
            &mut band.surface,
        );
        band
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
        let baseline = self.spec.baseline;
        let y = (v as f64 - self.grid.cy) / self.grid.fy;
        let disparity = (self.grid.fx * baseline) as f32;
        let sensor = &self.spec.sensor;
        let ambient = sensor.ambient as f32;
        let reference = (sensor.exposure_distance * sensor.exposure_distance) as f32;
        let mut at = 0;
        while at < surface.len() {
            let index = surface[at];
            let run = surface[at..].iter().take_while(|s| **s == index).count();
            let run_start = at;
            at += run;
            if index == EMPTY {
                continue;
            }
            let Surface { shape, kind, .. } = &self.seen[index as usize].surface;
            let albedo = self.albedo[index as usize];
            let fixed = kind.constant_normal().map(nalgebra::Matrix::cast::<f32>);
            for u in run_start..at {
                let w = inverse_depth[u];
                let z = 1.0 / w;
                let x = (u as f32 - self.grid.cx as f32) / self.grid.fx as f32;
                let ray = nalgebra::Vector3::new(x, y as f32, 1.0);
                let point = ray * z;
                let normal = fixed.unwrap_or_else(|| {
                    let exact = Vector::new((u as f64 - self.grid.cx) / self.grid.fx, y, 1.0)
                        / f64::from(w);
                    kind.normal_at(&exact).cast::<f32>()
                });
                cos_view[u] = (-normal.dot(&ray) / ray.norm()).clamp(0.0, 1.0);
                let to_light = nalgebra::Vector3::new(baseline as f32, 0.0, 0.0) - point;
                let distance2 = to_light.norm_squared();
                let facing = normal.dot(&to_light) / distance2.sqrt();
                let reached = facing > 0.0
                    && shadow
                        .as_ref()
                        .is_none_or(|s| s.reaches(u, disparity * w, w, *shape, &self.lit));
                let light = if reached { facing.min(1.0) } else { 0.0 };
                cos_light[u] = light;
                let lamp = light * (reference / distance2);
                grey[u] = 255.0 * albedo * (ambient + (1.0 - ambient) * lamp);
            }
        }
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
