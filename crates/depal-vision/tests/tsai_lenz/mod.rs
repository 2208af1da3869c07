//! The plain closed form to compare with: R. Y. Tsai, R. K. Lenz, "A new technique for fully autonomous
//! and efficient 3D robotics hand/eye calibration", IEEE Transactions on Robotics and Automation 5(3),
//! 1989, 345-358. Each picture gives the board's pose, pairs of pictures give the motions.

use depal_frames::nalgebra::{DMatrix, DVector, Matrix3, Rotation3};
use depal_frames::{Point, Pose, Rotation, Vector};
use depal_vision::calibration::{Capture, CircleBoard, Mounting};

/// Pose of the camera in the base (fixed) or in the flange.
pub fn camera(board: &CircleBoard, mounting: Mounting, captures: &[Capture]) -> Pose {
    let in_board = board.centres();
    let camera_from_board: Vec<Pose> = captures
        .iter()
        .map(|c| rigid(&in_board, &c.centres_in_camera))
        .collect();
    // AX = XB with X = hub_from_camera: A moves the hub, B the camera.
    let hub: Vec<Pose> = captures
        .iter()
        .map(|c| match mounting {
            Mounting::EyeToHand => c.base_from_flange,
            Mounting::EyeInHand => c.base_from_flange.inverse(),
        })
        .collect();
    let mut pairs = Vec::new();
    for i in 0..captures.len() {
        for j in i + 1..captures.len() {
            pairs.push((
                hub[j] * hub[i].inverse(),
                camera_from_board[j] * camera_from_board[i].inverse(),
            ));
        }
    }
    // Rotation: skew(Pa + Pb) P' = Pb - Pa with P = 2 sin(angle / 2) axis.
    let mut matrix = DMatrix::zeros(3 * pairs.len(), 3);
    let mut right = DVector::zeros(3 * pairs.len());
    for (k, (a, b)) in pairs.iter().enumerate() {
        let (pa, pb) = (modified(&a.rotation), modified(&b.rotation));
        matrix
            .view_mut((3 * k, 0), (3, 3))
            .copy_from(&(pa + pb).cross_matrix());
        right.rows_mut(3 * k, 3).copy_from(&(pb - pa));
    }
    let solved = matrix.svd(true, true).solve(&right, 1e-12).unwrap();
    let half = Vector::new(solved[0], solved[1], solved[2]);
    let p = half * 2.0 / (1.0 + half.norm_squared()).sqrt();
    let n = p.norm_squared();
    let turn: Matrix3<f64> = Matrix3::identity() * (1.0 - n / 2.0)
        + (p * p.transpose() + p.cross_matrix() * (4.0 - n).sqrt()) * 0.5;
    let rotation = Rotation3::from_matrix_unchecked(turn);
    // Translation: (Ra - 1) t = R tb - ta.
    let mut matrix = DMatrix::zeros(3 * pairs.len(), 3);
    for (k, (a, b)) in pairs.iter().enumerate() {
        let turn = a.rotation.to_rotation_matrix().into_inner();
        matrix
            .view_mut((3 * k, 0), (3, 3))
            .copy_from(&(turn - Matrix3::identity()));
        let offset = rotation * b.translation.vector - a.translation.vector;
        right.rows_mut(3 * k, 3).copy_from(&offset);
    }
    let t = matrix.svd(true, true).solve(&right, 1e-12).unwrap();
    Pose::from_parts(
        Vector::new(t[0], t[1], t[2]).into(),
        Rotation::from_rotation_matrix(&rotation),
    )
}

fn modified(rotation: &Rotation) -> Vector {
    let vector = rotation.scaled_axis();
    let angle = vector.norm();
    if angle < 1e-12 {
        return Vector::zeros();
    }
    vector * (2.0 * (angle / 2.0).sin() / angle)
}

/// Least-squares rigid motion between point lists (Kabsch).
fn rigid(from: &[Point], to: &[Point]) -> Pose {
    let n = from.len() as f64;
    let mean = |p: &[Point]| p.iter().fold(Vector::zeros(), |s, p| s + p.coords) / n;
    let (mean_from, mean_to) = (mean(from), mean(to));
    let mut correlation = Matrix3::zeros();
    for (a, b) in from.iter().zip(to) {
        correlation += (b.coords - mean_to) * (a.coords - mean_from).transpose();
    }
    let svd = correlation.svd(true, true);
    let (u, v_t) = (svd.u.unwrap(), svd.v_t.unwrap());
    let mut flip = Matrix3::identity();
    flip[(2, 2)] = (u * v_t).determinant().signum();
    let rotation =
        Rotation::from_rotation_matrix(&Rotation3::from_matrix_unchecked(u * flip * v_t));
    Pose::from_parts((mean_to - rotation * mean_from).into(), rotation)
}
