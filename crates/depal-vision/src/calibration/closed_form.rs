//! First values for the joint estimation.

use depal_frames::{Point, Pose, Rotation, Vector};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3};

/// Rotation that best takes vectors `from` to vectors `to` in the least-squares sense, by singular
/// value decomposition (K. S. Arun, T. S. Huang, S. D. Blostein, "Least-squares fitting of two 3-D
/// point sets", IEEE PAMI 9(5), 1987, 698-700). Both in the same order; vectors need no common length.
pub fn best_rotation(pairs: impl Iterator<Item = (Vector, Vector)>) -> Rotation {
    let mut correlation = Matrix3::zeros();
    for (from, to) in pairs {
        correlation += to * from.transpose();
    }
    nearest_rotation(&correlation)
}

/// The rotation `R` with the largest trace of `matrix^T R`.
pub fn nearest_rotation(matrix: &Matrix3<f64>) -> Rotation {
    let svd = matrix.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Rotation::identity();
    };
    let mut flip = Matrix3::identity();
    // Singular values come sorted, so the last column is the one to mirror.
    flip[(2, 2)] = (u.determinant() * v_t.determinant()).signum();
    let rotation = u * flip * v_t;
    Rotation::from_rotation_matrix(&Rotation3::from_matrix_unchecked(rotation))
}

/// `a_from_b` that best takes points in b to points in a, and the root mean square distance left.
pub fn best_pose(points_in_b: &[Point], points_in_a: &[Point]) -> (Pose, f64) {
    let count = points_in_b.len().max(1) as f64;
    let mean = |points: &[Point]| points.iter().fold(Vector::zeros(), |s, p| s + p.coords) / count;
    let (mean_a, mean_b) = (mean(points_in_a), mean(points_in_b));
    let pairs = || points_in_b.iter().zip(points_in_a);
    let rotation = best_rotation(pairs().map(|(b, a)| (b.coords - mean_b, a.coords - mean_a)));
    let pose = Pose::from_parts((mean_a - rotation * mean_b).into(), rotation);
    let squares: f64 = pairs().map(|(b, a)| (pose * b - a).norm_squared()).sum();
    (pose, (squares / count).sqrt())
}

/// Pairs of rotation vectors of the same motion, seen in the hub and in the camera frame.
/// With C = X M Y the motion from pose i to pose j is B = M_j M_i^-1 there and A = C_j C_i^-1 here.
pub fn motions(
    hub_from_carrier: &[Pose],
    camera_from_board: &[Pose],
) -> impl Iterator<Item = (Vector, Vector)> {
    let count = hub_from_carrier.len();
    (0..count)
        .flat_map(move |i| (i + 1..count).map(move |j| (i, j)))
        .map(|(i, j)| {
            let motion = |p: &[Pose]| (p[j].rotation * p[i].rotation.inverse()).scaled_axis();
            (motion(hub_from_carrier), motion(camera_from_board))
        })
}

/// Rotation `camera_from_hub` from the rotation vectors of all motions.
/// Source: F. C. Park, B. J. Martin, "Robot sensor calibration: solving AX = XB on the Euclidean
/// group", IEEE Transactions on Robotics and Automation 10(5), 1994, 717-721,
/// doi:10.1109/70.326576: the rotation vectors of A and B differ by the rotation of X.
pub fn rotation_from_motions(hub_from_carrier: &[Pose], camera_from_board: &[Pose]) -> Rotation {
    best_rotation(motions(hub_from_carrier, camera_from_board))
}

/// With `camera_from_hub`'s rotation known, all else is linear:
/// `c_i = R_X R_i t_Y + t_X + R_X t_i`, in the least-squares sense of smallest norm, so that what is
/// not observable stays zero. A touched point adds `point_in_camera = R_X point_in_hub + t_X`.
pub fn complete(
    rotation: Rotation,
    hub_from_carrier: &[Pose],
    camera_from_board: &[Pose],
    touched: &[(Point, Point)],
) -> Option<(Pose, Pose)> {
    let rows = 3 * (hub_from_carrier.len() + touched.len());
    let mut matrix = DMatrix::zeros(rows, 6);
    let mut right = DVector::zeros(rows);
    let turn = rotation.to_rotation_matrix();
    let mut averaged = Matrix3::zeros();
    for (i, (m, c)) in hub_from_carrier.iter().zip(camera_from_board).enumerate() {
        let turn_i = turn * m.rotation.to_rotation_matrix();
        matrix.view_mut((3 * i, 0), (3, 3)).fill_with_identity();
        matrix
            .view_mut((3 * i, 3), (3, 3))
            .copy_from(turn_i.matrix());
        let offset = c.translation.vector - turn * m.translation.vector;
        right.rows_mut(3 * i, 3).copy_from(&offset);
        averaged += (turn_i.inverse() * c.rotation.to_rotation_matrix()).matrix();
    }
    for (k, (in_camera, in_hub)) in touched.iter().enumerate() {
        let row = 3 * (hub_from_carrier.len() + k);
        matrix.view_mut((row, 0), (3, 3)).fill_with_identity();
        let offset = in_camera.coords - turn * in_hub.coords;
        right.rows_mut(row, 3).copy_from(&offset);
    }
    let svd = matrix.svd(true, true);
    let largest = svd.singular_values.max();
    let unknown = svd.solve(&right, 1e-4 * largest).ok()?;
    let position = |at: usize| Vector::new(unknown[at], unknown[at + 1], unknown[at + 2]);
    Some((
        Pose::from_parts(position(0).into(), rotation),
        Pose::from_parts(position(3).into(), nearest_rotation(&averaged)),
    ))
}
