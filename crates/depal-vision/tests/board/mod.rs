//! The board of the calibration tests as a body with its print, and the camera that looks at it.
#![allow(dead_code)]

use depal_camera::{CameraSpec, Decal, Material, RenderShape, SensorSpec};
use depal_frames::{Intrinsics, Pose, Shape};
use depal_vision::calibration::CircleBoard;

#[path = "../rendered/cameras.rs"]
mod cameras;

pub const BOARD: CircleBoard = CircleBoard {
    columns: 9,
    rows: 7,
    pitch: 0.040,
    disc_diameter: 0.020,
};

pub const BOARD_ID: u32 = 77;
/// Thickness, metres.
const PLATE: f64 = 0.01;

/// That of the layers, its axis half a pixel farther right and down.
pub fn camera(sensor: SensorSpec) -> CameraSpec {
    let spec = cameras::camera(sensor);
    CameraSpec {
        intrinsics: Intrinsics {
            cx: 640.0,
            cy: 512.0,
            ..spec.intrinsics
        },
        ..spec
    }
}

pub fn solid(pose: Pose, shape: Shape, id: u32, material: Material) -> RenderShape {
    RenderShape {
        world_from_shape: pose,
        shape,
        id,
        material,
        edge_radius: 0.0,
    }
}

/// The plate, and its print.
pub fn board_bodies(board: &CircleBoard, base_from_board: &Pose) -> (RenderShape, Decal) {
    let [x, y] = board.plate_size();
    let plate = solid(
        base_from_board * Pose::translation(0.0, 0.0, -PLATE / 2.0),
        Shape::cuboid(x, y, PLATE),
        BOARD_ID,
        Material::LABEL,
    );
    let discs = board
        .nodes()
        .map(|(c, r)| {
            let centre = board.centre(c, r);
            ([centre.x, centre.y], board.diameter(c, r) / 2.0)
        })
        .collect();
    let print = Decal {
        world_from_decal: *base_from_board,
        id: BOARD_ID,
        discs,
        bare: Material::LABEL.albedo,
        ink: 0.06,
    };
    (plate, print)
}
