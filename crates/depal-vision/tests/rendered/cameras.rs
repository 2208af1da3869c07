//! The cameras that take the layers.

use depal_camera::{CameraSpec, SensorSpec};
use depal_frames::Intrinsics;

/// 1280 x 1024, 1.25 mm per pixel at 2 m.
pub fn camera(sensor: SensorSpec) -> CameraSpec {
    CameraSpec {
        intrinsics: Intrinsics {
            width: 1280,
            height: 1024,
            fx: 1600.0,
            fy: 1600.0,
            cx: 639.5,
            cy: 511.5,
        },
        near: 0.5,
        far: 5.0,
        baseline: 0.3,
        sensor,
    }
}

/// Active stereo with a picture of its own class: 1280 x 720, 640 px, projector at 50 mm; 3.1 mm per pixel at 2 m.
pub fn small_stereo() -> CameraSpec {
    CameraSpec {
        intrinsics: Intrinsics {
            width: 1280,
            height: 720,
            fx: 640.0,
            fy: 640.0,
            cx: 639.5,
            cy: 359.5,
        },
        baseline: 0.05,
        ..camera(SensorSpec::active_stereo())
    }
}
