//! Hand-eye calibration in the cell: the board before the camera, its pictures, and their result.
//!
//! The board is on its holder only while a calibration runs; it is drawn for the camera and touches nothing.
//! Poses and residuals are worked out by [`depal_vision::calibration`], which sees the pictures alone.

use depal_camera::{CameraSpec, Decal, Material, RenderShape, capture_with_decals};
use depal_frames::{DepthFrame, Pose, Rotation, Shape, Vector};
use depal_time::{RandomStream, RandomStreams};
use depal_vision::calibration::{
    Calibration, CalibrationProblem, CaptureProblem, CaptureReport, CircleBoard, Mounting, Session,
};

use crate::spec::CellSpec;

/// Id of the board in the camera's pictures: below the world's own scenery, above any carton.
pub const BOARD_ID: u32 = 0x7fff_ff00;
/// Thickness of the plate, metres.
const PLATE: f64 = 0.01;
/// Matt white paint, and matt black ink: dark enough for a sharp edge, light enough for the laser.
const PLATE_MATERIAL: Material = Material::LABEL;
const INK_ALBEDO: f64 = 0.06;
/// The arm turns by as much as its repeatability is at this distance, metres: about a tool's length.
const TURN_DISTANCE: f64 = 0.5;

/// How a calibration is set up.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationSpec {
    /// The board.
    pub board: CircleBoard,
    /// What the arm carries.
    pub mounting: Mounting,
    /// Where the board really is: `flange_from_board` (camera fixed) or `base_from_board`.
    pub board_pose: Pose,
    /// How far the arm stands from the pose that it reports, one standard deviation along each axis, metres.
    pub repeatability: f64,
}

impl CalibrationSpec {
    /// The board's face in the base, with the flange there.
    pub fn base_from_board(&self, base_from_flange: &Pose) -> Pose {
        match self.mounting {
            Mounting::EyeToHand => base_from_flange * self.board_pose,
            Mounting::EyeInHand => self.board_pose,
        }
    }

    /// Plate and print for the camera; `world_from_board` is the middle of the printed face, Z out of it.
    pub fn bodies(&self, world_from_board: &Pose) -> (RenderShape, Decal) {
        let [x, y] = self.board.plate_size();
        let plate = RenderShape {
            world_from_shape: world_from_board * Pose::translation(0.0, 0.0, -0.5 * PLATE),
            shape: Shape::cuboid(x, y, PLATE),
            id: BOARD_ID,
            material: PLATE_MATERIAL,
            edge_radius: 0.0,
        };
        let disc = |(column, row)| {
            let centre = self.board.centre(column, row);
            ([centre.x, centre.y], self.board.diameter(column, row) / 2.0)
        };
        let print = Decal {
            world_from_decal: *world_from_board,
            id: BOARD_ID,
            discs: self.board.nodes().map(disc).collect(),
            bare: PLATE_MATERIAL.albedo,
            ink: INK_ALBEDO,
        };
        (plate, print)
    }

    /// A picture of the board and all else in view.
    pub fn picture(
        &self,
        camera: &CameraSpec,
        world_from_camera: &Pose,
        world_from_board: &Pose,
        mut shapes: Vec<RenderShape>,
        noise_seed: u64,
    ) -> DepthFrame {
        let (plate, print) = self.bodies(world_from_board);
        shapes.push(plate);
        capture_with_decals(camera, world_from_camera, &shapes, &[print], noise_seed).frame
    }

    /// Where the flange really is when the arm means to be at `base_from_flange`.
    fn taken_up(&self, base_from_flange: &Pose, random: &mut RandomStream) -> Pose {
        let mut normal = |sigma: f64| {
            let [x, y, z] = [(); 3].map(|()| random.normal(sigma));
            Vector::new(x, y, z)
        };
        let shift = normal(self.repeatability);
        let turn = Rotation::new(normal(self.repeatability / TURN_DISTANCE));
        Pose::from_parts(
            (base_from_flange.translation.vector + shift).into(),
            turn * base_from_flange.rotation,
        )
    }
}

/// A calibration that runs: one picture for each pose that the robot has taken up.
#[derive(Debug, Clone)]
pub struct CalibrationRun {
    spec: CalibrationSpec,
    session: Session,
    pictures: u32,
}

impl CalibrationRun {
    /// Begins one.
    ///
    /// # Errors
    /// [`CalibrationProblem::Board`].
    pub fn new(spec: &CalibrationSpec) -> Result<Self, CalibrationProblem> {
        Ok(Self {
            spec: spec.clone(),
            session: Session::new(spec.board, spec.mounting, Vec::new())?,
            pictures: 0,
        })
    }

    /// Takes a picture. `shapes` is what else is in view, `standing` where the arm means to stand (base from
    /// flange), `reported` where the robot says that it stands. Board or camera go with the flange.
    ///
    /// # Errors
    /// The picture is of no use; the calibration goes on without it.
    pub fn capture(
        &mut self,
        cell: &CellSpec,
        shapes: Vec<RenderShape>,
        standing: &Pose,
        reported: &Pose,
    ) -> Result<CaptureReport, CaptureProblem> {
        self.pictures += 1;
        let mut random =
            RandomStreams::new(cell.seed).stream(&format!("calibration/{}", self.pictures));
        let flange = self.spec.taken_up(standing, &mut random);
        let world_from_board = cell.world_from_base * self.spec.base_from_board(&flange);
        let frame = self.spec.picture(
            &cell.camera,
            &cell.world_from_camera(Some(&flange)),
            &world_from_board,
            shapes,
            random.next_u64(),
        );
        self.session.capture(&frame, reported)
    }

    /// Pictures so far, the useless ones included.
    pub fn pictures(&self) -> u32 {
        self.pictures
    }

    /// The result of all usable pictures.
    ///
    /// # Errors
    /// See [`CalibrationProblem`].
    pub fn finish(&self) -> Result<Calibration, CalibrationProblem> {
        self.session.finish()
    }
}
