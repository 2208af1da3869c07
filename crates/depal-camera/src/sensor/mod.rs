//! What the sensor makes of a rendering.

mod band;
mod depth;
mod device;
mod filter;
mod intensity;
mod source;
mod steps;

use depal_frames::DepthFrame;
use rayon::prelude::*;

use crate::capture::{Capture, NOTHING};
use crate::raster::EMPTY;
use crate::row::run_length;
use crate::{CameraSpec, Rendering};
use band::{ROWS, Sensor};

/// What the sensor makes of a rendering. `noise_seed` should differ from frame to frame.
///
/// Order of effects: sideways jitter picks the source pixel; range, shadow, grazing, darkness,
/// over-exposure, chance and depth steps take pixels away; bowl, scale and axial noise move the depth;
/// then rounding; last the vendor's filters.
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
    Sensor::new(spec, rendering, noise_seed).fill(&mut frame.depth, &mut frame.intensity);
    filter::apply(&spec.sensor, i.width, &mut frame.depth);
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
