//! A depth image as a picture for people: near is red, far is blue, black is invalid.

use depal_frames::DepthFrame;

/// Wider pictures are made smaller by whole factors.
const MOST_COLUMNS: usize = 800;
/// From far to near.
const RAMP: [[f64; 3]; 7] = [
    [38.0, 32.0, 110.0],
    [42.0, 96.0, 190.0],
    [40.0, 165.0, 180.0],
    [90.0, 195.0, 100.0],
    [225.0, 205.0, 70.0],
    [235.0, 130.0, 45.0],
    [175.0, 35.0, 35.0],
];

/// A picture of at most 256 colours.
pub struct Indexed {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Number of the colour of each pixel, row by row.
    pub pixels: Vec<u8>,
}

/// Red, green, blue of each colour: 0 is black, 1 the farthest, 255 the nearest.
pub fn palette() -> Vec<u8> {
    let mut colours = vec![0; 3];
    for n in 0..255 {
        let place = f64::from(n) / 254.0 * (RAMP.len() - 1) as f64;
        let k = (place as usize).min(RAMP.len() - 2);
        let t = place - k as f64;
        for (a, b) in RAMP[k].iter().zip(&RAMP[k + 1]) {
            colours.push((a + (b - a) * t).round() as u8);
        }
    }
    colours
}

/// The range of colours is that of the depths, without the nearest and farthest hundredth of the pixels.
pub fn false_colour(frame: &DepthFrame) -> Indexed {
    let i = &frame.intrinsics;
    let factor = i.width.div_ceil(MOST_COLUMNS).max(1);
    let (width, height) = (i.width.div_ceil(factor), i.height.div_ceil(factor));
    let mut valid: Vec<f32> = frame.depth.iter().copied().filter(|z| *z > 0.0).collect();
    valid.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| {
        let last = valid.len().saturating_sub(1);
        valid
            .get((share * last as f64).round() as usize)
            .copied()
            .unwrap_or(1.0)
    };
    let (near, far) = (at(0.01), at(0.99));
    let scale = 254.0 / (far - near).max(1e-3);
    let colour = |row: usize, column: usize| {
        // Nearest of the pixels that become one, so that thin things stay.
        let (v, u) = (row * factor, column * factor);
        let rows = v..(v + factor).min(i.height);
        let nearest = rows
            .flat_map(|v| &frame.depth[v * i.width + u..v * i.width + (u + factor).min(i.width)])
            .filter(|z| **z > 0.0)
            .fold(f32::INFINITY, |a, b| a.min(*b));
        if nearest.is_finite() {
            1 + ((far - nearest) * scale).clamp(0.0, 254.0) as u8
        } else {
            0
        }
    };
    Indexed {
        width,
        height,
        pixels: (0..width * height)
            .map(|n| colour(n / width, n % width))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use depal_frames::Intrinsics;

    fn frame(width: usize, height: usize, depth: Vec<f32>) -> DepthFrame {
        DepthFrame {
            intrinsics: Intrinsics {
                width,
                height,
                fx: 100.0,
                fy: 100.0,
                cx: 0.0,
                cy: 0.0,
            },
            depth,
            intensity: Vec::new(),
        }
    }

    #[test]
    fn nearer_is_a_greater_number_and_invalid_is_black() {
        let picture = false_colour(&frame(4, 1, vec![0.0, 1.0, 2.0, 3.0]));
        assert_eq!(picture.pixels[0], 0);
        assert!(picture.pixels[1] > picture.pixels[2] && picture.pixels[2] > picture.pixels[3]);
        assert!(picture.pixels[3] >= 1);
        let palette = palette();
        assert_eq!(palette.len(), 768);
        assert_eq!(palette[..3], [0, 0, 0]);
    }

    #[test]
    fn wide_pictures_become_small_and_keep_thin_things() {
        let mut depth = vec![2.0; 1601 * 3];
        depth[1601 + 800] = 1.0;
        depth[4] = 0.0;
        let picture = false_colour(&frame(1601, 3, depth));
        assert_eq!((picture.width, picture.height), (534, 1));
        assert!(picture.pixels[800 / 3] > picture.pixels[0]);
        // One hole of nine pixels is not a hole in the picture.
        assert!(picture.pixels.iter().all(|n| *n > 0));
    }

    #[test]
    fn empty_and_flat_frames_are_pictures_too() {
        assert_eq!(false_colour(&frame(2, 2, vec![0.0; 4])).pixels, [0; 4]);
        let flat = false_colour(&frame(2, 2, vec![1.5; 4])).pixels;
        assert!(flat.iter().all(|n| *n == flat[0] && *n > 0));
    }
}
