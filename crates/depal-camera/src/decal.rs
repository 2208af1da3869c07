//! Prints on a flat face, painted into a rendering before the sensor sees it.

use depal_frames::{Point, Pose, Vector};

use crate::raster::EMPTY;
use crate::{CameraSpec, Capture, Material, RenderShape, Rendering, render, sense};

/// A point farther than this from the print's plane does not belong to the printed face, metres.
const FACE_TOLERANCE: f64 = 0.001;
/// Rays per pixel and direction: a disc's edge darkens a pixel by the share of it that is covered.
const SUBPIXELS: usize = 4;

/// Discs printed on a flat face of a solid. The print's frame: origin on the face, Z out of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decal {
    /// Where the print's frame stands in the world, metres.
    pub world_from_decal: Pose,
    /// Id of the solid that carries it, as in [`RenderShape::id`].
    pub id: u32,
    /// Centre (x, y) and radius of each disc in the print's frame, metres.
    pub discs: Vec<([f64; 2], f64)>,
    /// The ink.
    pub material: Material,
}

impl Rendering {
    /// Paints a print onto what [`render`] drew. `world_from_camera` as there.
    ///
    /// Grey is mixed by the covered share of each pixel; a pixel that is covered by more than half
    /// also has the ink's albedo, so that depth is as noisy there as on any surface as dark.
    /// Where something stands before the face nothing is painted.
    pub fn paint(&mut self, world_from_camera: &Pose, decal: &Decal) {
        let i = self.intrinsics;
        let camera_from_decal = world_from_camera.inverse() * decal.world_from_decal;
        let normal = camera_from_decal.rotation * Vector::z();
        let origin = camera_from_decal.translation.vector;
        let plane = normal.dot(&origin);
        if plane >= 0.0 || i.width == 0 {
            return; // seen from behind or edge on
        }
        let Some((columns, rows)) = self.extent(&camera_from_decal, decal) else {
            return;
        };
        let decal_from_camera = camera_from_decal.inverse();
        // Per surface of the face the index of its inked twin.
        let mut inked: Vec<(u32, u32)> = Vec::new();
        for v in rows.0..=rows.1 {
            for u in columns.0..=columns.1 {
                let pixel = v * i.width + u;
                let surface = self.surface[pixel];
                if surface == EMPTY || self.id_of_surface[surface as usize] != decal.id {
                    continue;
                }
                let point = i.ray(u as f64, v as f64) / f64::from(self.inverse_depth[pixel]);
                if (normal.dot(&point) - plane).abs() > FACE_TOLERANCE {
                    continue; // another face of the solid
                }
                let mut covered = 0usize;
                for k in 0..SUBPIXELS * SUBPIXELS {
                    let part = |n: usize| (n as f64 + 0.5) / SUBPIXELS as f64 - 0.5;
                    let ray = i.ray(
                        u as f64 + part(k % SUBPIXELS),
                        v as f64 + part(k / SUBPIXELS),
                    );
                    let on_plane = Point::from(ray * (plane / normal.dot(&ray)));
                    let p = decal_from_camera * on_plane;
                    let inside = |([x, y], radius): &([f64; 2], f64)| {
                        let (dx, dy) = (p.x - x, p.y - y);
                        dx * dx + dy * dy <= radius * radius
                    };
                    covered += usize::from(decal.discs.iter().any(inside));
                }
                if covered == 0 {
                    continue;
                }
                let share = covered as f32 / (SUBPIXELS * SUBPIXELS) as f32;
                let ink = decal.material.albedo as f32;
                let bare = self.albedo_of_surface[surface as usize].max(1e-6);
                self.grey[pixel] *= 1.0 - share + share * ink / bare;
                if share > 0.5 {
                    self.surface[pixel] = self.inked(surface, ink, &mut inked);
                }
            }
        }
    }

    /// The surface of the same solid with the ink's albedo.
    fn inked(&mut self, surface: u32, ink: f32, known: &mut Vec<(u32, u32)>) -> u32 {
        if let Some((_, twin)) = known.iter().find(|(bare, _)| *bare == surface) {
            return *twin;
        }
        let twin = self.albedo_of_surface.len() as u32;
        self.albedo_of_surface.push(ink);
        self.id_of_surface
            .push(self.id_of_surface[surface as usize]);
        known.push((surface, twin));
        twin
    }

    /// First and last column and row that the print can touch; none when it is outside the picture.
    fn extent(
        &self,
        camera_from_decal: &Pose,
        decal: &Decal,
    ) -> Option<((usize, usize), (usize, usize))> {
        let i = self.intrinsics;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for ([x, y], radius) in &decal.discs {
            for (dx, dy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let corner = Point::new(x + dx * radius, y + dy * radius, 0.0);
                let corner = camera_from_decal * corner;
                if corner.z < 1e-3 {
                    return Some(((0, i.width - 1), (0, i.height - 1)));
                }
                let (u, v) = i.project(&corner);
                low = [low[0].min(u), low[1].min(v)];
                high = [high[0].max(u), high[1].max(v)];
            }
        }
        let span = |k: usize, count: usize| {
            let first = (low[k] - 1.0).floor().max(0.0);
            let last = (high[k] + 1.0).ceil().min(count as f64 - 1.0);
            (first <= last).then_some((first as usize, last as usize))
        };
        Some((span(0, i.width)?, span(1, i.height)?))
    }
}

/// As [`capture`](crate::capture), with prints on some of the shapes.
pub fn capture_with_decals(
    spec: &CameraSpec,
    world_from_camera: &Pose,
    shapes: &[RenderShape],
    decals: &[Decal],
    noise_seed: u64,
) -> Capture {
    let mut rendering = render(spec, world_from_camera, shapes);
    for decal in decals {
        rendering.paint(world_from_camera, decal);
    }
    sense(spec, &rendering, noise_seed)
}
