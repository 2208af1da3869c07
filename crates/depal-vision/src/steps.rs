//! Stage 2: the step mask. A pixel is surface when nothing within two pixels is much nearer.

/// Half of the window: 5 x 5 pixels, so that a line of gap pixels parts two surfaces even where
/// noise has closed it for up to four pixels.
const REACH: usize = 2;

/// 1 for surface pixels at least two pixels away from every step, hole and border of the region.
pub fn surface_mask(
    depth: &[f32],
    inside: &[u8],
    width: usize,
    height: usize,
    step: f64,
) -> Vec<u8> {
    let step = step as f32;
    let far: Vec<f32> = depth
        .iter()
        .map(|&z| if z > 0.0 { z } else { f32::MAX })
        .collect();
    let nearest = windowed(&far, width, height, f32::MAX);
    let surface: Vec<u8> = depth
        .iter()
        .zip(&nearest)
        .zip(inside)
        .map(|((&z, &low), &inside)| inside & u8::from(z - low < step))
        .collect();
    windowed(&surface, width, height, 0)
}

/// Running minimum over the square window; `outside` stands for pixels beyond the image.
fn windowed<T: Copy + PartialOrd>(image: &[T], width: usize, height: usize, outside: T) -> Vec<T> {
    let min = |a: T, b: T| if b < a { b } else { a };
    let mut rows = image.to_vec();
    let mut padded = vec![outside; width + 2 * REACH];
    for (source, target) in image.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        padded[REACH..REACH + width].copy_from_slice(source);
        for (window, out) in padded.windows(2 * REACH + 1).zip(target) {
            *out = min(
                min(min(window[0], window[1]), min(window[2], window[3])),
                window[4],
            );
        }
    }
    let mut result = rows.clone();
    let blank = vec![outside; width];
    let row = |v: Option<usize>| match v {
        Some(v) if v < height => &rows[v * width..(v + 1) * width],
        _ => &blank[..],
    };
    for (v, target) in result.chunks_exact_mut(width).enumerate() {
        let others = [v.checked_sub(2), v.checked_sub(1), Some(v + 1), Some(v + 2)].map(row);
        for other in others {
            for (out, &value) in target.iter_mut().zip(other) {
                *out = min(*out, value);
            }
        }
    }
    result
}
