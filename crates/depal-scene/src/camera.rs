//! The depth camera: what carries it, where it hangs there, its lens and its faults.

use depal_frames::nalgebra::{Matrix3, Rotation3, Translation3};
use depal_frames::{Pose, Rotation, Vector};

use crate::choice::{choice, one_of};
use crate::reader::{Checker, section};
use crate::rules::{
    ANGLE_DEG, COORDINATE_MM, Flag, LENGTH_MM, Maybe, Numbers, Text, above, number, whole,
};

choice! {
    /// Which faults a depth picture has.
    pub enum SensorPreset {
        /// Structured laser light seen past a baseline: shadow, axial noise, edge dropout, 0.1 mm steps.
        Laser = "laser",
        /// Structured laser light for the middle range: 0.1 mm at 2 m; noise_mm does not apply.
        Laser2m = "laser-2m",
        /// Structured laser light for the long range: 0.5 mm at 3 m; noise_mm does not apply.
        Laser3m = "laser-3m",
        /// A small stereo camera with its own pattern: 10 mm at 2 m, smeared edges; noise_mm does not apply.
        ActiveStereo = "active-stereo",
        /// Time of flight: no shadow, 3 mm at 3 m, flying pixels at edges; noise_mm does not apply.
        TimeOfFlight = "time-of-flight",
        /// The exact distance at every pixel.
        Ideal = "ideal",
    }
}

choice! {
    /// What carries the camera.
    pub enum CameraMount {
        /// A stand: it stays where it is in the world.
        World = "world",
        /// The arm's flange: it is wherever the arm is when a picture is taken.
        Flange = "flange",
    }
}

section! {
    /// The depth camera. Its frame: X right in the picture, Y down, Z forward.
    pub struct Camera {
        /// Name that vision projects refer to.
        /// Default overhead: what the projects' own default names.
        name: String, Text, default("overhead".to_owned());
        /// What carries it: `xyz_mm`, `look_at_mm`, `image_x_along`, `rpy_deg` and `mounting_error_mm` are in the
        /// frame of the world, or of the flange. With `flange`, the robot must tell its pose with every picture.
        /// Default world: most cells have the camera on a stand, where it never waits for the arm.
        mount: CameraMount, one_of(), default(CameraMount::World);
        /// Optical centre in that frame, mm.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Point in that frame that lies in the middle of the picture, mm. Either this or `rpy_deg`.
        look_at_mm: Option<[f64; 3]>, Maybe(Numbers::<3>(COORDINATE_MM)), default(None);
        /// With `look_at_mm`: the direction in that frame that runs to the right in the picture, as far as
        /// the line of sight allows.
        /// Default [0, 1, 0]: the long side of a pallet that lies along Y fills the wider side of the picture.
        image_x_along: [f64; 3], Numbers::<3>(number(-1.0, 1.0)), default([0.0, 1.0, 0.0]);
        /// Roll, pitch and yaw of the camera frame about the fixed axes of that frame, degrees.
        rpy_deg: Option<[f64; 3]>, Maybe(Numbers::<3>(ANGLE_DEG)), default(None);
        /// Width of the picture, pixels.
        /// Default 1280: 1.3 mm per pixel two metres away with the default focal length.
        width: u32, whole(16, 4096), default(1280);
        /// Height of the picture, pixels.
        /// Default 1024: with the width, the 5:4 of common image sensors.
        height: u32, whole(16, 4096), default(1024);
        /// Focal lengths along X and Y, pixels.
        /// Default [1600, 1600]: 1.6 m x 1.3 m two metres away, an EUR pallet with a margin.
        focal_px: [f64; 2], Numbers::<2>(above(0.0, 100_000.0)), default([1600.0, 1600.0]);
        /// Principal point, pixels.
        /// Default: the middle of the picture.
        center_px: Option<[f64; 2]>, Maybe(Numbers::<2>(number(0.0, 4096.0))), default(None);
        /// Distance from the optical centre to the projector along the camera's X, mm.
        /// Default 300: the class of long-range laser cameras; a longer one throws wider shadows.
        baseline_mm: f64, number(0.0, 2000.0), default(300.0);
        /// Time from the trigger to the end of the exposure, s; the arm must not be in the way for so long.
        /// Default 0.6: long-range laser cameras need 0.5 to 0.9 s.
        exposure_s: f64, number(0.0, 10.0), default(0.6);
        /// Which faults the picture has.
        /// Default laser: an ideal picture makes every detector look good.
        sensor: SensorPreset, one_of(), default(SensorPreset::Laser);
        /// Axial noise of a face seen squarely from 3 m, mm, one standard deviation; it grows with the
        /// square of the distance.
        /// Default 0.5: the repeatability given for long-range laser cameras at 3 m.
        noise_mm: f64, number(0.0, 100.0), default(0.5);
        /// Nearest distance along Z that is measured, mm.
        /// Default 500: a carton in the gripper above the pallet is still seen.
        near_mm: f64, LENGTH_MM, default(500.0);
        /// Farthest distance along Z that is measured, mm.
        /// Default 5000: the floor below a camera at 3.7 m.
        far_mm: f64, LENGTH_MM, default(5000.0);
        /// How far the camera really hangs from where calibration says, along the axes of that frame, mm.
        /// Default [0, 0, 0]; a wrong one shows what a bad calibration costs.
        mounting_error_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), default([0.0; 3]);
        /// How far it is really turned from what calibration says: roll, pitch and yaw about the axes of that
        /// frame, through the optical centre, degrees.
        /// Default [0, 0, 0]: as for `mounting_error_mm`.
        mounting_error_rpy_deg: [f64; 3], Numbers::<3>(ANGLE_DEG), default([0.0; 3]);
        /// The lens is covered: every picture is empty.
        /// Default false; for tests of what happens when nothing is seen.
        blackout: bool, Flag, default(false);
    }
    check check_camera;
}

/// Shortest cross product of unit vectors that still gives a picture a direction.
const PARALLEL: f64 = 1e-3;

impl Camera {
    /// The camera's pose in the world or on the flange, as `mount` says, metres. Right-handed, X right in the
    /// picture, Z along the line of sight.
    pub fn carrier_from_camera(&self) -> Pose {
        let at = Vector::from(self.xyz_mm) * 1e-3;
        let rotation = match (self.rpy_deg, self.sight_axes()) {
            (Some(rpy), _) => {
                let [roll, pitch, yaw] = rpy.map(f64::to_radians);
                Rotation::from_euler_angles(roll, pitch, yaw)
            }
            (None, Some(axes)) => {
                Rotation::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
            }
            (None, None) => Rotation::identity(),
        };
        Pose::from_parts(Translation3::from(at), rotation)
    }

    /// Where the camera really is on that carrier, metres: its pose with the errors of its mounting.
    pub fn true_carrier_from_camera(&self) -> Pose {
        let calibrated = self.carrier_from_camera();
        let [roll, pitch, yaw] = self.mounting_error_rpy_deg.map(f64::to_radians);
        Pose::from_parts(
            (Vector::from(self.mounting_error_mm) * 1e-3 + calibrated.translation.vector).into(),
            Rotation::from_euler_angles(roll, pitch, yaw) * calibrated.rotation,
        )
    }

    /// Principal point, pixels.
    pub fn principal_point_px(&self) -> [f64; 2] {
        self.center_px
            .unwrap_or([f64::from(self.width) / 2.0, f64::from(self.height) / 2.0])
    }

    /// Columns: the camera's axes in its carrier's frame; `None` where the line of sight gives none.
    fn sight_axes(&self) -> Option<Matrix3<f64>> {
        let line = Vector::from(self.look_at_mm?) - Vector::from(self.xyz_mm);
        let forward = line.try_normalize(1e-6)?;
        let wanted = Vector::from(self.image_x_along).try_normalize(1e-6)?;
        let down = forward.cross(&wanted).try_normalize(PARALLEL)?;
        let right = down.cross(&forward);
        Some(Matrix3::from_columns(&[right, down, forward]))
    }
}

fn check_camera(camera: &Camera, checker: &mut Checker<'_, '_>) {
    match (camera.look_at_mm, camera.rpy_deg) {
        (None, None) => checker.problem(
            "look_at_mm",
            "missing key".to_owned(),
            Some("give look_at_mm, or rpy_deg instead"),
        ),
        (Some(_), Some(_)) => checker.problem(
            "rpy_deg",
            "expected either look_at_mm or rpy_deg, found both".to_owned(),
            None,
        ),
        (Some(_), None) if camera.sight_axes().is_none() => checker.problem(
            "look_at_mm",
            "expected a line of sight that is not along image_x_along and not zero, found one"
                .to_owned(),
            None,
        ),
        _ => {}
    }
    if camera.near_mm >= camera.far_mm {
        checker.problem(
            "far_mm",
            format!(
                "expected more than near_mm = {}, found {}",
                camera.near_mm, camera.far_mm
            ),
            None,
        );
    }
}
