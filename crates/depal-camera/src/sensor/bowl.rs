use crate::CameraSpec;

/// Depth error that grows with the square of the distance from the image centre.
pub(super) struct Bowl {
    /// -height/2 in the centre, +height/2 in the corners: share of the column.
    pub columns: Vec<f32>,
    height: f32,
    v: f32,
    scale: f32,
}

impl Bowl {
    pub fn new(spec: &CameraSpec) -> Self {
        let i = &spec.intrinsics;
        let (u, v) = ((i.width as f32 - 1.0) * 0.5, (i.height as f32 - 1.0) * 0.5);
        let height = spec.sensor.bowl as f32;
        let scale = height / (u * u + v * v).max(1.0);
        Self {
            columns: (0..i.width)
                .map(|k| (k as f32 - u) * (k as f32 - u) * scale)
                .collect(),
            height,
            v,
            scale,
        }
    }

    /// What the row adds to its columns.
    pub fn row(&self, v: usize) -> f32 {
        let y = v as f32 - self.v;
        y * y * self.scale - 0.5 * self.height
    }
}
