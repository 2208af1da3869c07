//! What is wrong with one camera in every picture that it takes.

use crate::CameraSpec;
use crate::noise::Counter;

/// Stream of random words that is the device's own.
const LANE: u64 = 3;
/// Least curvature along an image axis, of a greatest of one.
const LEAST_CURVATURE: f64 = 0.5;
/// Greatest slope of the tilt in the same measure.
const MOST_TILT: f64 = 0.5;

/// Systematic depth errors of a device.
pub(super) struct Device {
    /// Depth is multiplied by this.
    pub scale: f32,
    /// Share of the bowl that each column adds, metres.
    pub columns: Vec<f32>,
    /// Share of the bowl that each row adds, and the bias of distance, metres.
    pub rows: Vec<f32>,
}

impl Device {
    pub fn new(spec: &CameraSpec) -> Self {
        let (i, s) = (&spec.intrinsics, &spec.sensor);
        let words = Counter::new(s.device_seed, LANE);
        // From 0 up to 1.
        let drawn = |n: u64| (words.word(n) >> 11) as f64 / (1_u64 << 53) as f64;
        let sign = |n: u64| if drawn(n) < 0.5 { -1.0 } else { 1.0 };
        let bend = sign(1);
        let curve = |n: u64, length: usize| {
            let curvature = bend * (LEAST_CURVATURE + (1.0 - LEAST_CURVATURE) * drawn(n));
            let tilt = MOST_TILT * (2.0 * drawn(n + 1) - 1.0);
            let half = (length as f64 - 1.0) / 2.0;
            let values: Vec<f64> = (0..length)
                .map(|k| (k as f64 - half) / half.max(0.5))
                .map(|x| curvature * x * x + tilt * x)
                .collect();
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (values, least, most)
        };
        let (columns, c0, c1) = curve(2, i.width);
        let (rows, r0, r1) = curve(4, i.height);
        // Peaks of a sum of one of each are the sums of their peaks.
        let height = (c1 - c0) + (r1 - r0);
        let unit = if height > 0.0 { s.bowl / height } else { 0.0 };
        let levelled = |values: Vec<f64>, least: f64, most: f64, bias: f64| {
            let level = f64::midpoint(least, most);
            let value = |x: &f64| ((x - level) * unit + bias) as f32;
            values.iter().map(value).collect()
        };
        Self {
            scale: 1.0 + (sign(0) * s.scale_error) as f32,
            columns: levelled(columns, c0, c1, 0.0),
            rows: levelled(rows, r0, r1, sign(6) * s.distance_bias),
        }
    }
}
