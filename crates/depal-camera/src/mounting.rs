use depal_frames::Pose;

/// What carries the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mounting {
    /// On a stand: it sees the hand from outside.
    EyeToHand {
        /// Where it stands, metres.
        world_from_camera: Pose,
    },
    /// On the robot's flange: it moves with the hand.
    EyeInHand {
        /// Where it sits on the flange, metres.
        flange_from_camera: Pose,
    },
}

impl Mounting {
    /// Pose of the camera while the flange is at `world_from_flange`: the pose at exposure, not at the
    /// time when the picture is used.
    pub fn world_from_camera(&self, world_from_flange: &Pose) -> Pose {
        match self {
            Self::EyeToHand { world_from_camera } => *world_from_camera,
            Self::EyeInHand { flange_from_camera } => world_from_flange * flange_from_camera,
        }
    }
}
