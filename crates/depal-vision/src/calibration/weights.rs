//! What disturbs all disc centres of a picture together.
//!
//! An arm that stands 0.05 mm beside its reported pose moves the whole board, and so does a plane fit
//! that is off; 63 discs do not average that away. Each picture therefore has the covariance
//! `disc^2 * (1 + K K^T)` with the shared disturbances in the columns of K, and its inverse
//! `(1 - K (1 + K^T K)^-1 K^T) / disc^2` (Woodbury's identity) is applied without being written out.

use depal_frames::{Point, Vector};
use nalgebra::{Matrix3, SMatrix};

/// Noise of a disc centre by itself, metres. Of all figures here only the ratios matter.
const DISC: f64 = 0.03e-3;
/// Repeatability of the arm's position, metres.
const ARM_SHIFT: f64 = 0.05e-3;
/// Repeatability of the arm's direction, radians (0.01 degrees).
const ARM_TURN: f64 = 0.000_17;
/// Error of the plane's depth, metres: the unevenness of a camera's depth over its field of view.
const PLANE: f64 = 0.1e-3;
/// Error of the plane's tilt, radians, for the same reason.
const PLANE_TILT: f64 = 0.000_3;
/// Error of a touched point, metres.
const TOUCH: f64 = 0.3e-3;

/// Shift and turn of the flange, depth and tilt of the plane.
pub const SHARED: usize = 9;

/// Weights of one picture.
pub struct PoseWeights {
    /// Per disc: what one standard deviation of each shared disturbance does to it, in `DISC`s.
    pub shared: Vec<SMatrix<f64, 3, SHARED>>,
    /// `(1 + K^T K)^-1`.
    pub inverse: SMatrix<f64, SHARED, SHARED>,
}

/// Weights of all residuals.
pub struct Weights {
    /// By picture.
    pub poses: Vec<PoseWeights>,
    /// Weight of a touched point against a disc centre.
    pub touched: f64,
}

impl Weights {
    /// From the measured disc centres and the flange's origin in each picture, camera frame.
    pub fn new(in_camera: &[&[Point]], flange_in_camera: &[Point]) -> Self {
        let poses = in_camera
            .iter()
            .zip(flange_in_camera)
            .map(|(discs, flange)| PoseWeights::new(discs, flange))
            .collect();
        Self {
            poses,
            touched: (DISC / TOUCH).powi(2),
        }
    }

    /// Every disc centre by itself, a touched point as `touched` of them.
    pub fn equal(in_camera: &[&[Point]], touched: f64) -> Self {
        let poses = in_camera
            .iter()
            .map(|discs| PoseWeights {
                shared: vec![SMatrix::zeros(); discs.len()],
                inverse: SMatrix::identity(),
            })
            .collect();
        Self { poses, touched }
    }
}

impl PoseWeights {
    fn new(discs: &[Point], flange: &Point) -> Self {
        let count = discs.len().max(1) as f64;
        let middle = discs.iter().fold(Vector::zeros(), |s, p| s + p.coords) / count;
        let mut gram = SMatrix::<f64, SHARED, SHARED>::identity();
        let shared: Vec<SMatrix<f64, 3, SHARED>> = discs
            .iter()
            .map(|p| {
                let mut columns = SMatrix::<f64, 3, SHARED>::zeros();
                columns
                    .fixed_view_mut::<3, 3>(0, 0)
                    .copy_from(&(Matrix3::identity() * (ARM_SHIFT / DISC)));
                columns
                    .fixed_view_mut::<3, 3>(0, 3)
                    .copy_from(&((p - flange).cross_matrix() * (ARM_TURN / DISC)));
                // Depth moves a point along its ray.
                let ray = p.coords / p.z;
                let from_middle = p.coords - middle;
                columns.set_column(6, &(ray * (PLANE / DISC)));
                columns.set_column(7, &(ray * (from_middle.x * PLANE_TILT / DISC)));
                columns.set_column(8, &(ray * (from_middle.y * PLANE_TILT / DISC)));
                gram += columns.transpose() * columns;
                columns
            })
            .collect();
        let inverse = gram
            .cholesky()
            .expect("one and a Gram matrix is positive definite")
            .inverse();
        Self { shared, inverse }
    }
}
