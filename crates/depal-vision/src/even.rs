//! Stage 5a: whether a piece of the step mask is one carton, or holes run through it along a line.

use crate::{gate::DepthImage, plane::PlaneFrame, resample::int, widest::with_widest_vectors};

/// True when no line of more than a few holes runs through the rectangle of a piece's mask (`range`
/// metres, middle and axes as in `frame`): a seam leaves one, also where it was bridged.
pub fn is_even(
    mask: &[u8],
    image: &DepthImage,
    frame: &PlaneFrame,
    range: [f64; 2],
    pitch: f64,
) -> bool {
    /// Every sixth line is looked at, pixel by pixel.
    const STRIDE: f64 = 6.0;
    /// Cells left out at the rim.
    const RIM: f64 = 4.0;
    /// A seam shows holes on a tenth of its length, and each tears the mask over five pixels.
    const MOST: f64 = 0.15;
    let k = &image.intrinsics;
    let stride = image.width as i32;
    let last = [image.width, image.height].map(|count| (count - 1) as f32);
    let inner = range.map(|r| r - 2.0 * RIM * pitch);
    for axis in 0..2 {
        let across = 1 - axis;
        let cells = (inner[axis] / pitch).floor().max(1.0) as usize;
        let lines = (inner[across] / (STRIDE * pitch)).floor().max(1.0) as usize;
        let mut holes = vec![0u16; cells];
        let mut pixels = vec![0i32; cells];
        let (along, beside) = if axis == 0 {
            (frame.x, frame.y)
        } else {
            (frame.y, frame.x)
        };
        for line in 0..lines {
            let at = ((line as f64 + 0.5) / lines as f64 - 0.5) * inner[across];
            let ends = [-0.5, 0.5]
                .map(|end| k.project(&(frame.origin + along * (inner[axis] * end) + beside * at)));
            // A tenth of a pixel of perspective matters little here.
            let per = 1.0 / cells as f64;
            let (du, dv) = (
                ((ends[1].0 - ends[0].0) * per) as f32,
                ((ends[1].1 - ends[0].1) * per) as f32,
            );
            let (u0, v0) = ((ends[0].0 + 0.5) as f32, (ends[0].1 + 0.5) as f32);
            // First where, then what: the processor does several of the former at once.
            with_widest_vectors(
                #[inline(always)]
                || {
                    for (cell, pixel) in pixels.iter_mut().enumerate() {
                        let s = cell as i32 as f32 + 0.5;
                        let u = (u0 + du * s).max(0.0).min(last[0]);
                        let v = (v0 + dv * s).max(0.0).min(last[1]);
                        *pixel = int(v) * stride + int(u);
                    }
                },
            );
            for (&pixel, holes) in pixels.iter().zip(&mut holes) {
                *holes += u16::from(1 - mask[pixel as usize]);
            }
        }
        let most = (MOST * lines as f64).max(1.0) as u16;
        if holes.iter().any(|&h| h > most) {
            return false;
        }
    }
    true
}
