//! Floor, pallet and conveyor as solids in the world frame.

use depal_frames::nalgebra::Translation3;
use depal_frames::{PlacedShape, Pose, Rotation, Vector};
use depal_world::{ConveyorSpec, FixedBody};

use crate::scene::Scene;
use crate::solid::Solid;
use crate::stack::{Conveyor, Pallet, SupportForm};

/// Pose from a position in mm and a turn about Z in degrees.
pub(super) fn pose_mm_yaw(xyz_mm: [f64; 3], yaw_deg: f64) -> Pose {
    Pose::from_parts(
        Translation3::from(Vector::from(xyz_mm) * 1e-3),
        Rotation::from_euler_angles(0.0, 0.0, yaw_deg.to_radians()),
    )
}

/// The floor: its upper face is at height 0.
pub(super) fn floor() -> PlacedShape {
    PlacedShape::cuboid(
        Pose::translation(0.0, 0.0, -0.05),
        Vector::new(12.0, 12.0, 0.1),
    )
}

/// A flat pallet of boards, in the proportions of EN 13698-1: five deck boards along the long side,
/// three stringer boards across, nine blocks, three skids.
///
/// Heights are 22, 22, 78 and 22 mm of 144; board widths 145 and 100 mm of 800, blocks 145 or 100 by 145 mm.
pub(super) fn pallet_boards(pallet: &Pallet) -> Vec<PlacedShape> {
    let world_from_pallet = pose_mm_yaw(pallet.xyz_mm, pallet.yaw_deg);
    let [x, y, z] = pallet.size_mm.map(|side| side * 1e-3);
    let (short, long) = (x.min(y), x.max(y));
    let is_long_y = y >= x;
    let mut boards = Vec::new();
    let mut add = |across: f64, along: f64, bottom: f64, top: f64, wide: f64, deep: f64| {
        // `across` runs over the pallet's short side, `along` over the long one.
        let (centre, size) = if is_long_y {
            ([across, along], [wide, deep])
        } else {
            ([along, across], [deep, wide])
        };
        let middle = Pose::translation(centre[0], centre[1], 0.5 * (bottom + top));
        let size = Vector::new(size[0], size[1], top - bottom);
        boards.push(PlacedShape::cuboid(world_from_pallet * middle, size));
    };
    let level = |mm: f64| mm / 144.0 * z;
    let width = |mm: f64| mm / 800.0 * short;
    let depth = |mm: f64| mm / 1200.0 * long;
    let outer = 0.5 * (short - width(145.0));
    let inner = outer * 0.5;
    for (across, wide) in [
        (-outer, 145.0),
        (-inner, 100.0),
        (0.0, 145.0),
        (inner, 100.0),
        (outer, 145.0),
    ] {
        add(across, 0.0, level(122.0), z, width(wide), long);
    }
    let end = 0.5 * (long - depth(145.0));
    for along in [-end, 0.0, end] {
        add(0.0, along, level(100.0), level(122.0), short, depth(145.0));
        for (across, wide) in [(-outer, 100.0), (0.0, 145.0), (outer, 100.0)] {
            add(
                across,
                along,
                level(22.0),
                level(100.0),
                width(wide),
                depth(145.0),
            );
        }
    }
    for (across, wide) in [(-outer, 100.0), (0.0, 145.0), (outer, 100.0)] {
        add(across, 0.0, 0.0, level(22.0), width(wide), long);
    }
    boards
}

/// The belt with its speed; the carton is delivered when its centre reaches the end.
pub(super) fn conveyor(conveyor: &Conveyor) -> ConveyorSpec {
    let world_from_top = pose_mm_yaw(conveyor.xyz_mm, conveyor.yaw_deg);
    let size = Vector::from(conveyor.size_mm) * 1e-3;
    ConveyorSpec {
        name: "conveyor".to_owned(),
        belt: PlacedShape::cuboid(
            world_from_top * Pose::translation(0.0, 0.0, -0.5 * size.z),
            size,
        ),
        direction: world_from_top.rotation * Vector::x(),
        speed: conveyor.speed_mm_s * 1e-3,
        delivered_at: 0.5 * size.x,
        friction: conveyor.friction,
    }
}

/// Four legs from the belt body to the floor.
fn conveyor_legs(conveyor: &Conveyor) -> Vec<PlacedShape> {
    let world_from_top = pose_mm_yaw(conveyor.xyz_mm, conveyor.yaw_deg);
    let size = Vector::from(conveyor.size_mm) * 1e-3;
    let height = world_from_top.translation.z - size.z;
    if height <= 0.0 {
        return Vec::new();
    }
    let mut legs = Vec::new();
    for x in [-0.4, 0.4] {
        for y in [-0.4, 0.4] {
            let pose =
                world_from_top * Pose::translation(x * size.x, y * size.y, -size.z - 0.5 * height);
            legs.push(PlacedShape::cuboid(pose, Vector::new(0.08, 0.08, height)));
        }
    }
    legs
}

/// Pallet or platform as one block.
fn pallet_block(pallet: &Pallet) -> PlacedShape {
    let size = Vector::from(pallet.size_mm) * 1e-3;
    let middle = Pose::translation(0.0, 0.0, 0.5 * size.z);
    PlacedShape::cuboid(pose_mm_yaw(pallet.xyz_mm, pallet.yaw_deg) * middle, size)
}

/// Everything that stands still, floor first.
pub(super) fn fixed_bodies(scene: &Scene) -> Vec<FixedBody> {
    let solids = match scene.pallet.form {
        SupportForm::Boards => pallet_boards(&scene.pallet),
        SupportForm::Block => vec![pallet_block(&scene.pallet)],
    };
    let mut pallet = FixedBody::standing("pallet", solids);
    pallet.friction = scene.pallet.friction;
    let mut bodies = vec![FixedBody::floor(vec![floor()]), pallet];
    let legs = conveyor_legs(&scene.conveyor);
    if !legs.is_empty() {
        bodies.push(FixedBody::standing("conveyor legs", legs));
    }
    for solid in scene.solid.iter().filter(|solid| solid.body) {
        bodies.push(FixedBody::standing(&solid.name, vec![block(solid)]));
    }
    bodies
}

fn block(solid: &Solid) -> PlacedShape {
    let size = Vector::from(solid.size_mm) * 1e-3;
    let middle = Pose::translation(0.0, 0.0, 0.5 * size.z);
    PlacedShape::cuboid(pose_mm_yaw(solid.xyz_mm, solid.yaw_deg) * middle, size)
}

/// What a planner is told about the cell, world frame: floor, the pallet as one block, the belt down
/// to the floor.
pub(super) fn known_obstacles(scene: &Scene) -> Vec<PlacedShape> {
    let belt_size = Vector::from(scene.conveyor.size_mm) * 1e-3;
    let world_from_top = pose_mm_yaw(scene.conveyor.xyz_mm, scene.conveyor.yaw_deg);
    let height = world_from_top.translation.z;
    let belt = world_from_top * Pose::translation(0.0, 0.0, -0.5 * height);
    let mut obstacles = vec![
        floor(),
        pallet_block(&scene.pallet),
        PlacedShape::cuboid(belt, Vector::new(belt_size.x, belt_size.y, height)),
    ];
    obstacles.extend(scene.solid.iter().filter(|solid| solid.known).map(block));
    obstacles
}
