use depal_frames::{DepthFrame, Pose};

use crate::{CameraSpec, RenderShape, render, sense};

/// Id of a pixel where no solid was.
pub const NOTHING: u32 = u32::MAX;

/// One shot: what the camera delivers and what was really there.
#[derive(Debug, Clone, PartialEq)]
pub struct Capture {
    /// All that vision may see.
    pub frame: DepthFrame,
    /// Per pixel the id of the solid that was really there, [`NOTHING`] for none. Truth, for the score only.
    pub ids: Vec<u32>,
    /// Per pixel the exact depth, metres, 0 for nothing, also outside near and far. Truth, for the score only.
    pub ideal_depth: Vec<f32>,
}

/// Takes one picture. `noise_seed` changes from frame to frame; the same arguments give the same bits.
/// [`render`] and [`sense`] are its two halves.
pub fn capture(
    spec: &CameraSpec,
    world_from_camera: &Pose,
    shapes: &[RenderShape],
    noise_seed: u64,
) -> Capture {
    sense(spec, &render(spec, world_from_camera, shapes), noise_seed)
}
