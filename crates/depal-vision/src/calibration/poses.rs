//! Where to take the pictures.

use depal_frames::{Intrinsics, Point, Pose, Rotation, Vector};

use super::board::{CircleBoard, Mounting};
use super::problem::PoseProblem;

/// Candidates tried for each wanted pose.
const TRIES_PER_POSE: usize = 150;
/// Usable candidates gathered for each wanted pose before the most different ones are taken.
const CHOICE_PER_POSE: usize = 6;
/// Steepest view of the board, radians: beyond, discs get narrow and depth gets noisy.
const MOST_INCIDENCE: f64 = 45.0 * std::f64::consts::PI / 180.0;
/// The plate's corners stay this share of the image away from its border.
const BORDER: f64 = 0.02;

/// What poses are planned from: rough figures, as a user would measure them.
#[derive(Debug, Clone, PartialEq)]
pub struct PosePlan {
    /// The board.
    pub board: CircleBoard,
    /// Who carries what.
    pub mounting: Mounting,
    /// Lens of the camera.
    pub intrinsics: Intrinsics,
    /// About where the camera is: `base_from_camera` (fixed) or `flange_from_camera` (on the flange).
    pub camera: Pose,
    /// About where the board is: `flange_from_board` (camera fixed) or `base_from_board`.
    pub board_pose: Pose,
    /// `base_from_region`: middle and axes of the volume in which the board's middle (camera fixed)
    /// or the camera (on the flange) is spread.
    pub region: Pose,
    /// Half of that volume's sides, metres.
    pub half_extents: Vector,
    /// Largest tilt of the board against the camera's view, radians. More tilt fixes the camera's
    /// direction and distance better; beyond 35 degrees the discs get too narrow.
    pub max_tilt: f64,
    /// How many poses.
    pub count: usize,
}

/// Whether the whole plate is in the picture and turned to the camera.
pub fn sees_board(intrinsics: &Intrinsics, camera_from_board: &Pose, board: &CircleBoard) -> bool {
    let (width, height) = (intrinsics.width as f64, intrinsics.height as f64);
    let (left, top) = (BORDER * width, BORDER * height);
    let inside = |corner: &Point| {
        let p = camera_from_board * corner;
        if p.z <= 0.05 {
            return false;
        }
        let (u, v) = intrinsics.project(&p);
        u >= left && u <= width - 1.0 - left && v >= top && v <= height - 1.0 - top
    };
    let at = camera_from_board.translation.vector;
    let facing = camera_from_board.rotation * Vector::z();
    board.corners().iter().all(inside) && facing.angle(&-at) <= MOST_INCIDENCE
}

/// Flange poses spread over the volume in position, tilt and turn.
///
/// `is_usable` is asked with `base_from_flange`: is it within reach, free of collision, is nothing
/// in the line of sight? Deterministic: the candidates are a Halton sequence, and of those that pass
/// the ones that differ most are taken, each next one farthest from all before.
///
/// # Errors
/// [`PoseProblem::TooFew`] with what stood in the way.
pub fn plan_poses(
    plan: &PosePlan,
    mut is_usable: impl FnMut(&Pose) -> bool,
) -> Result<Vec<Pose>, PoseProblem> {
    let mut usable: Vec<(Pose, [f64; 6])> = Vec::new();
    let (mut tried, mut unseen, mut unreachable) = (0, 0, 0);
    while tried < plan.count * TRIES_PER_POSE && usable.len() < plan.count * CHOICE_PER_POSE {
        tried += 1;
        let features = features(tried);
        let (base_from_flange, camera_from_board) = plan.candidate(&features);
        if !sees_board(&plan.intrinsics, &camera_from_board, &plan.board) {
            unseen += 1;
        } else if is_usable(&base_from_flange) {
            usable.push((base_from_flange, features));
        } else {
            unreachable += 1;
        }
    }
    if usable.len() < plan.count {
        return Err(PoseProblem::TooFew {
            expected: plan.count,
            found: usable.len(),
            tried,
            unseen,
            unreachable,
        });
    }
    let distance = |a: &[f64; 6], b: &[f64; 6]| -> f64 {
        // The turn about the view counts least: tilts and positions carry the information.
        let weights = [1.0, 1.0, 1.0, 1.0, 1.0, 0.5];
        (0..6).map(|k| weights[k] * (a[k] - b[k]).powi(2)).sum()
    };
    let mut chosen: Vec<usize> = Vec::new();
    let mut gaps = vec![f64::INFINITY; usable.len()];
    let mut next = 0;
    for _ in 0..plan.count {
        chosen.push(next);
        for (gap, (_, features)) in gaps.iter_mut().zip(&usable) {
            *gap = gap.min(distance(features, &usable[next].1));
        }
        next = (0..gaps.len())
            .max_by(|a, b| gaps[*a].total_cmp(&gaps[*b]).then(b.cmp(a)))
            .expect("some poses");
    }
    Ok(chosen.into_iter().map(|k| usable[k].0).collect())
}

impl PosePlan {
    /// `base_from_flange` and `camera_from_board` of a candidate.
    fn candidate(&self, features: &[f64; 6]) -> (Pose, Pose) {
        let [x, y, z, tilt_x, tilt_y, turn] = *features;
        let offset = self.half_extents.component_mul(&Vector::new(x, y, z));
        let place = self.region * Point::from(offset);
        let tilt =
            Rotation::new(Vector::new(tilt_x, tilt_y, 0.0) * (self.max_tilt / 2.0_f64.sqrt()));
        let turn = Rotation::from_axis_angle(&Vector::z_axis(), turn * std::f64::consts::PI);
        // X of the camera along X of the board, Z towards each other: a half turn about X.
        let facing = Rotation::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI);
        match self.mounting {
            Mounting::EyeToHand => {
                let rotation = self.camera.rotation * facing * tilt * turn;
                let base_from_board = Pose::from_parts(place.coords.into(), rotation);
                (
                    base_from_board * self.board_pose.inverse(),
                    self.camera.inverse() * base_from_board,
                )
            }
            Mounting::EyeInHand => {
                // The camera looks at the board's middle from its place, then tilts a little beside it:
                // the tilt of the view comes from the place, the rest from the tilt's own share.
                let line = self.board_pose.translation.vector - place.coords;
                let board_x = self.board_pose.rotation * Vector::x();
                let looking = Rotation::face_towards(&line, &board_x.cross(&line));
                let aside = Rotation::slerp(&Rotation::identity(), &tilt, 0.25);
                let base_from_camera =
                    Pose::from_parts(place.coords.into(), looking * turn * aside);
                (
                    base_from_camera * self.camera.inverse(),
                    base_from_camera.inverse() * self.board_pose,
                )
            }
        }
    }
}

/// The n-th point of a Halton sequence in -1..1, six dimensions
/// (J. H. Halton, Numerische Mathematik 2, 1960, 84-90).
fn features(n: usize) -> [f64; 6] {
    [2, 3, 5, 7, 11, 13].map(|base| {
        let (mut value, mut share, mut rest) = (0.0, 1.0, n);
        while rest > 0 {
            share /= base as f64;
            value += share * (rest % base) as f64;
            rest /= base;
        }
        2.0 * value - 1.0
    })
}
