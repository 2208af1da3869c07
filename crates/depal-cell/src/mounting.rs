//! Where the camera is: on a stand, or on the robot's flange.
//!
//! The truth goes through the flange as it stands at the exposure. Vision and planner go through the
//! calibrated pose, and through the flange pose that the robot has told; they never see the truth.

use depal_camera::Mounting;
use depal_frames::Pose;

use crate::spec::CellSpec;

impl CellSpec {
    /// Whether the camera moves with the flange.
    pub fn is_eye_in_hand(&self) -> bool {
        matches!(self.mounting, Mounting::EyeInHand { .. })
    }

    /// What the camera hangs on, as a pose in the robot base: the base itself, or the flange.
    ///
    /// # Panics
    /// A camera on the flange has no place without the flange's: [`depal_interface::ServerSettings`] has runs
    /// refused that do not tell it.
    fn base_from_carrier(&self, base_from_flange: Option<&Pose>) -> Pose {
        match self.mounting {
            Mounting::EyeToHand { .. } => Pose::identity(),
            Mounting::EyeInHand { .. } => {
                *base_from_flange.expect("every run with a camera on the flange knows the flange")
            }
        }
    }

    /// Where calibration says that the camera is, with the flange where the robot says that it is.
    /// A camera on a stand needs no flange.
    pub fn base_from_camera(&self, base_from_flange: Option<&Pose>) -> Pose {
        self.base_from_carrier(base_from_flange) * self.carrier_from_camera
    }

    /// Where the camera really is with the flange really there. A camera on a stand needs no flange.
    pub fn world_from_camera(&self, base_from_flange: Option<&Pose>) -> Pose {
        let world_from_flange = self.world_from_base * self.base_from_carrier(base_from_flange);
        self.mounting.world_from_camera(&world_from_flange)
    }

    /// Where the camera really is on what carries it: in the robot base, or on the flange.
    pub fn true_carrier_from_camera(&self) -> Pose {
        match self.mounting {
            Mounting::EyeToHand { world_from_camera } => {
                self.world_from_base.inverse() * world_from_camera
            }
            Mounting::EyeInHand { flange_from_camera } => flange_from_camera,
        }
    }

    /// Takes over what a calibration has found. The projects' regions stay where they are in the base.
    pub fn recalibrate(&mut self, carrier_from_camera: Pose) {
        self.carrier_from_camera = carrier_from_camera;
    }
}
