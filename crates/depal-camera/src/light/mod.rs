//! What the projector's light and the camera's aperture make of each pixel, before chance enters.

mod exposure;
mod lamp;
mod patch;
mod pixels;
mod plan;
mod projector;

pub(crate) use lamp::{KEEP_BITS, NOISE_DISTANCE, SIGNAL_FACTORS, unpack};
pub(crate) use patch::Patch;
pub(crate) use pixels::LitTile;
pub(crate) use plan::Plan;

use crate::raster::TILE;
use crate::view::Face;
use crate::{CameraSpec, Material, Rendering};
use exposure::exposure;
use lamp::Lamp;

/// Light and optics of one exposure.
pub(crate) struct Lighting<'a> {
    spec: &'a CameraSpec,
    rendering: &'a Rendering,
    /// X of the ray of each column, to the end of the last tile.
    columns: Vec<f32>,
    /// One for each material that is there.
    lamps: Vec<Lamp>,
    /// Which of them is that of each solid; shapes come first.
    lamp_of_solid: Vec<u32>,
}

impl<'a> Lighting<'a> {
    pub fn new(spec: &'a CameraSpec, rendering: &'a Rendering) -> Self {
        let i = rendering.intrinsics;
        let shapes = rendering.shapes.iter().map(|shape| &shape.material);
        let meshes = rendering.meshes.iter().map(|mesh| &mesh.material);
        let exposed_for = exposure(spec, rendering);
        let mut materials: Vec<&Material> = Vec::new();
        let lamp_of_solid = shapes
            .chain(meshes)
            .map(|material| {
                let known = materials.iter().position(|other| *other == material);
                let place = known.unwrap_or(materials.len());
                if known.is_none() {
                    materials.push(material);
                }
                place as u32
            })
            .collect();
        Self {
            spec,
            rendering,
            columns: (0..i.width.next_multiple_of(TILE))
                .map(|u| ((u as f64 - i.cx) / i.fx) as f32)
                .collect(),
            lamps: materials
                .into_iter()
                .map(|material| Lamp::new(spec, material, exposed_for))
                .collect(),
            lamp_of_solid,
        }
    }

    /// Y of the ray of a row.
    #[inline(always)]
    fn y(&self, v: usize) -> f32 {
        let i = &self.rendering.intrinsics;
        ((v as f64 - i.cy) / i.fy) as f32
    }

    /// How far a face's plane lies before the camera and before the projector, metres.
    #[inline(always)]
    fn before(&self, face: &Face) -> (f32, f32) {
        let k = face.distance;
        (k, face.normal[0] * self.spec.baseline as f32 + k)
    }
}
