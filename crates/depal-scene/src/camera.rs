//! The depth camera: what carries it, where it hangs there, its lens and its faults.

use depal_frames::nalgebra::{Matrix3, Rotation3, Translation3};
use depal_frames::{Pose, Rotation, Vector};

use crate::choice::{choice, one_of, words_of};
use crate::reader::{Checker, section};
use crate::rules::{
    ANGLE_DEG, COORDINATE_MM, Flag, LENGTH_MM, Maybe, Numbers, Text, above, number, whole,
};
use crate::sensor::{DepthFilter, SensorPreset, SensorTerm};

/// Distance that the noise of the plain `laser` holds for, mm.
pub(crate) const LASER_NOISE_AT_MM: f64 = 3000.0;

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
        /// Which faults the picture has; with ideal none, whatever the keys below say.
        /// Default laser: an ideal picture makes every detector look good.
        sensor: SensorPreset, one_of(), default(SensorPreset::Laser);
        /// Terms of the sensor's model that are left out, each by itself, a list or one word; what the sensor
        /// does not have may be left out too. In the depth: shadow, grazing (loss on oblique faces),
        /// darkness (loss on dark ones), weak_signal (noise on dark ones), falloff (less light from farther
        /// away), axial_noise, correlated_noise (left out, all noise is each pixel's own), bowl,
        /// scale_error, distance_bias, lateral_jitter, edge_dropout, mixed_pixels (flying pixels),
        /// random_dropout, quantisation, disparity_steps; in the intensity: lens_blur, intensity_noise.
        /// Over-exposure by gloss is what `hdr` takes away. The same word twice is refused.
        /// Default []: the whole model, as in `--set camera.without=[]` over a scene that leaves some out.
        without: Vec<SensorTerm>, words_of(), default(Vec::new());
        /// Axial noise of a brown, opaque face seen squarely from `noise_at_mm`, mm, one standard deviation;
        /// it grows with the square of the distance.
        /// Default 0.5: the repeatability given for long-range laser cameras at 3 m.
        noise_mm: f64, number(0.0, 100.0), default(0.5);
        /// Distance that `noise_mm` holds for, mm: with both, the noise of any sensor but ideal is a data
        /// sheet's.
        /// Default: 3000 for laser; the others keep the noise of their class, whatever `noise_mm` says.
        noise_at_mm: Option<f64>, Maybe(LENGTH_MM), default(None);
        /// Which camera of its kind this is: the shape of its bowl and the signs of its scale error and
        /// distance bias are drawn from this number alone, and not from the seed of the run.
        /// Default 1: the same camera in every scene and on every seed; any other number is another camera.
        device_seed: u64, whole(0, i64::MAX), default(1);
        /// Filters that the camera runs over the finished depth, a list or one word: outlier_removal (takes
        /// pixels with which fewer than three of eight neighbours agree), then median (3x3, fills nothing).
        /// Their order here does not matter.
        /// Default []: what is behind shows what the sensor saw.
        filters: Vec<DepthFilter>, words_of(), default(Vec::new());
        /// Several exposures: what the mirror image of the projector on a glossy face over-exposes in one is
        /// measured in another. All that stands in a scene so far is matt, and looks the same either way.
        /// Default false: one exposure.
        hdr: bool, Flag, default(false);
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

/// Refuses what the command line asks of a sensor that would not heed it. In a file it is no mistake: who
/// takes the ideal sensor for a moment need not take the keys of the other one out.
fn check_sensor(camera: &Camera, checker: &mut Checker<'_, '_>) {
    let sensor = camera.sensor;
    if camera.noise_at_mm.is_some() && !checker.table.contains_key("noise_mm") {
        checker.problem(
            "noise_at_mm",
            "expected noise_mm beside it, found none".to_owned(),
            Some("give the noise that holds at this distance"),
        );
    }
    if sensor == SensorPreset::Ideal {
        for (key, is_set) in [
            ("noise_mm", camera.noise_mm > 0.0),
            ("filters", !camera.filters.is_empty()),
        ] {
            if is_set && checker.is_override(key) {
                checker.problem(
                    key,
                    format!("expected no {key} with sensor ideal, which is exact, found some"),
                    Some("take another sensor, or leave the key out"),
                );
            }
        }
    } else if sensor != SensorPreset::Laser
        && camera.noise_at_mm.is_none()
        && checker.is_override("noise_mm")
    {
        checker.problem(
            "noise_mm",
            format!(
                "expected noise_at_mm beside it for sensor {}, found none",
                sensor.word()
            ),
            Some("give the distance at which the noise is that, or leave noise_mm out for that of the class"),
        );
    }
}

fn check_camera(camera: &Camera, checker: &mut Checker<'_, '_>) {
    check_sensor(camera, checker);
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
