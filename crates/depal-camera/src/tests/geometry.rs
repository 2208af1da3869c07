use depal_frames::{Point, Pose, Rotation, Shape, Vector, convert};
use parry3d::math::Vector as ParryVector;
use parry3d::query::{Ray, RayCast};
use parry3d::shape::{Ball, Cuboid};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::{
    Capture, Mounting, NOTHING, RenderMesh, TriangleMesh, capture, render_with_meshes, sense,
};

/// Depth of the first hit along a ray from the origin whose Z is 1.
/// Boxes and balls: parry's closed forms. Capsules and cylinders: marching along the signed
/// distance in f64, since parry's iterative cast is off by up to millimetres at the ends.
fn cast(item: &RenderShape, direction: &Vector) -> Option<f64> {
    let pose = convert::to_glam(&item.world_from_shape);
    let ray = Ray::new(ParryVector::ZERO, convert::vector_to_glam(direction));
    let far = 100.0;
    match &item.shape {
        Shape::Cuboid { half_extents } => Cuboid::new(convert::vector_to_glam(half_extents))
            .cast_ray(&pose, &ray, far, true)
            .map(f64::from),
        Shape::Sphere { radius } => Ball::new(*radius as f32)
            .cast_ray(&pose, &ray, far, true)
            .map(f64::from),
        _ => march(item, direction),
    }
}

/// Sphere tracing (Hart 1996).
fn march(item: &RenderShape, direction: &Vector) -> Option<f64> {
    let length = direction.norm();
    let centre = item.world_from_shape.translation.vector;
    let reach = item.shape.bounding_radius();
    let miss = centre - direction * (centre.dot(direction) / (length * length));
    if miss.norm() > reach {
        return None;
    }
    let shape_from_world = item.world_from_shape.inverse();
    let (mut z, end) = (0.0, centre.norm() + reach);
    while z < end {
        let distance = signed_distance(
            &item.shape,
            &(shape_from_world * Point::from(direction * z)),
        );
        if distance < 1e-8 {
            return Some(z);
        }
        z += distance / length;
    }
    None
}

/// Distance of a point from a solid's surface, negative inside.
fn signed_distance(shape: &Shape, p: &Point) -> f64 {
    match shape {
        Shape::Cuboid { half_extents } => {
            box_distance([0, 1, 2].map(|k| p[k].abs() - half_extents[k]))
        }
        Shape::Sphere { radius } => p.coords.norm() - radius,
        Shape::Cylinder {
            half_length,
            radius,
        } => box_distance([
            p.x.hypot(p.y) - radius,
            p.z.abs() - half_length,
            f64::NEG_INFINITY,
        ]),
        Shape::Capsule {
            half_length,
            radius,
        } => {
            let z = p.z - p.z.clamp(-half_length, *half_length);
            Vector::new(p.x, p.y, z).norm() - radius
        }
    }
}

fn box_distance(beyond: [f64; 3]) -> f64 {
    let outside = Vector::from(beyond.map(|d| d.max(0.0))).norm();
    outside
        + beyond
            .into_iter()
            .fold(f64::NEG_INFINITY, f64::max)
            .min(0.0)
}

fn reference(spec: &CameraSpec, shapes: &[RenderShape]) -> (Vec<f32>, Vec<u32>) {
    let i = spec.intrinsics;
    let mut depth = Vec::new();
    let mut ids = Vec::new();
    for v in 0..i.height {
        for u in 0..i.width {
            let d = i.ray(u as f64, v as f64);
            let hit = shapes
                .iter()
                .filter_map(|s| cast(s, &d).map(|t| (t, s.id)))
                .min_by(|a, b| a.0.total_cmp(&b.0));
            depth.push(hit.map_or(0.0, |h| h.0 as f32));
            ids.push(hit.map_or(NOTHING, |h| h.1));
        }
    }
    (depth, ids)
}

/// Whether the reference shows another solid, or a depth step, within one pixel.
fn at_silhouette(width: usize, pixel: usize, depth: &[f32], ids: &[u32]) -> bool {
    let (u, v) = ((pixel % width) as i64, (pixel / width) as i64);
    let height = (ids.len() / width) as i64;
    let mut low = f32::INFINITY;
    let mut high = 0.0_f32;
    for y in (v - 1).max(0)..=(v + 1).min(height - 1) {
        for x in (u - 1).max(0)..=(u + 1).min(width as i64 - 1) {
            let other = (y * width as i64 + x) as usize;
            if ids[other] != ids[pixel] {
                return true;
            }
            low = low.min(depth[other]);
            high = high.max(depth[other]);
        }
    }
    high - low > 0.005
}

fn any_shape() -> impl Strategy<Value = Shape> {
    let length = 0.02..0.4_f64;
    let radius = 0.02..0.25_f64;
    prop_oneof![
        3 => (length.clone(), length.clone(), length.clone()).prop_map(|(x, y, z)| Shape::cuboid(2.0 * x, 2.0 * y, 2.0 * z)),
        1 => (length.clone(), radius.clone()).prop_map(|(half_length, radius)| Shape::Capsule { half_length, radius }),
        1 => (length, radius.clone()).prop_map(|(half_length, radius)| Shape::Cylinder { half_length, radius }),
        1 => radius.prop_map(|radius| Shape::Sphere { radius }),
    ]
}

fn any_scene() -> impl Strategy<Value = Vec<RenderShape>> {
    let one = (
        any_shape(),
        prop::array::uniform2(-1.2..1.2_f64),
        1.2..3.5_f64,
        prop::array::uniform3(-3.0..3.0_f64),
    );
    prop::collection::vec(one, 1..12).prop_map(|list| {
        list.into_iter()
            .enumerate()
            .map(|(n, (shape, [x, y], z, turn))| solid(n as u32, shape, [x, y, z], turn))
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn depth_agrees_with_ray_casts(mut scene in any_scene(), with_wall in any::<bool>()) {
        if with_wall {
            scene.push(wall(99, 3.3));
        }
        let spec = camera(256, 192, SensorSpec::ideal());
        let shot = capture(&spec, &Pose::identity(), &scene, 0);
        let (depth, ids) = reference(&spec, &scene);
        let mut wrong = 0;
        for pixel in 0..depth.len() {
            if (shot.ideal_depth[pixel] - depth[pixel]).abs() < 1e-4 {
                continue;
            }
            wrong += 1;
            prop_assert!(
                at_silhouette(256, pixel, &depth, &ids),
                "pixel {},{}: raster {} (id {}), ray {} (id {})",
                pixel % 256, pixel / 256, shot.ideal_depth[pixel], shot.ids[pixel], depth[pixel], ids[pixel]
            );
        }
        prop_assert!(wrong as f64 <= 0.0005 * depth.len() as f64, "{wrong} pixels differ");
    }

    #[test]
    fn solids_behind_or_around_the_camera_leave_sound_images(
        shape in any_shape(),
        at in prop::array::uniform3(-0.5..0.5_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
    ) {
        // The solid may be behind, beside, across the camera's plane or around the eye.
        let spec = camera(96, 64, SensorSpec { shadow: true, ..SensorSpec::ideal() });
        let scene = [wall(1, 2.0), solid(2, shape.clone(), at, turn)];
        let shot = capture(&spec, &Pose::identity(), &scene, 0);
        let eye = scene[1].world_from_shape.inverse() * Point::origin();
        let inside = signed_distance(&shape, &eye) < 0.0;
        let (depth, ids) = reference(&spec, &scene);
        for pixel in 0..depth.len() {
            let (z, id) = (shot.ideal_depth[pixel], shot.ids[pixel]);
            prop_assert!(z.is_finite() && z > 0.0 && z < 2.0001);
            prop_assert!(id == 1 || id == 2);
            if id == 1 {
                prop_assert!((z - 2.0).abs() < 1e-5);
            }
            if inside {
                prop_assert_eq!(id, 1); // a solid around the eye is not seen
            } else if id != ids[pixel] {
                prop_assert!(at_silhouette(96, pixel, &depth, &ids));
            }
            // Too near to be measured, yet it hides the wall.
            if id == 2 && z < 0.3 {
                prop_assert_eq!(shot.frame.depth[pixel], 0.0);
            }
        }
    }
}

#[test]
fn a_solid_behind_the_camera_changes_nothing() {
    let spec = camera(80, 60, SensorSpec::laser_structured_light());
    let front = wall(1, 2.0);
    for shape in [
        Shape::cuboid(0.4, 0.3, 0.2),
        Shape::Sphere { radius: 0.2 },
        Shape::Capsule {
            half_length: 0.2,
            radius: 0.1,
        },
        Shape::Cylinder {
            half_length: 0.2,
            radius: 0.1,
        },
    ] {
        let behind = solid(2, shape, [0.1, 0.0, -0.8], [0.4, 0.2, 0.1]);
        let with = capture(&spec, &Pose::identity(), &[front.clone(), behind], 5);
        let without = capture(&spec, &Pose::identity(), std::slice::from_ref(&front), 5);
        assert_eq!(with, without);
    }
}

#[test]
fn the_camera_pose_takes_world_to_camera() {
    let spec = camera(80, 60, SensorSpec::ideal());
    // 2.5 m up, looking straight down, image X along world X.
    let world_from_camera = Pose::from_parts(
        Vector::new(1.0, 0.5, 2.5).into(),
        Rotation::new(Vector::x() * std::f64::consts::PI),
    );
    let mut block = solid(3, Shape::cuboid(0.2, 0.2, 0.5), [1.3, 0.5, 0.25], [0.0; 3]);
    block.material = Material::LABEL;
    let shot: Capture = capture(&spec, &world_from_camera, &[block], 0);
    let (u, v) = spec.intrinsics.project(&Point::new(0.3, 0.0, 2.0));
    let at = v.round() as usize * 80 + u.round() as usize;
    assert_eq!(shot.ids[at], 3);
    assert!((shot.ideal_depth[at] - 2.0).abs() < 1e-5);
    assert_eq!(shot.ids[30 * 80 + 20], NOTHING);
}

/// A capsule around the eye showed its far ball, seen from the inside of the near one.
#[test]
fn a_capsule_around_the_eye_is_not_seen() {
    let spec = camera(80, 60, SensorSpec::ideal());
    let capsule = Shape::Capsule {
        half_length: 0.3,
        radius: 0.1,
    };
    let around = solid(2, capsule, [0.0, 0.0, 0.25], [0.0; 3]);
    let shot = capture(&spec, &Pose::identity(), &[wall(1, 2.0), around], 0);
    assert!(shot.ids.iter().all(|id| *id == 1));
}

/// The mesh of a cuboid, corners counter-clockwise from outside.
fn cuboid_mesh(half: &Vector) -> TriangleMesh {
    let corners = (0..8)
        .map(|k| {
            let side = |bit: usize, h: f64| if k & bit == 0 { -h } else { h };
            Point::new(side(1, half.x), side(2, half.y), side(4, half.z))
        })
        .collect();
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
        .collect();
    TriangleMesh::new(corners, triangles).expect("indices within range")
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        rng_seed: RngSeed::Fixed(2),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_box_of_triangles_looks_like_a_box(
        half in prop::array::uniform3(0.02..0.4_f64),
        at in (prop::array::uniform2(-1.2..1.2_f64), 0.2..3.5_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
    ) {
        let half = Vector::from(half);
        let shape = solid(5, Shape::Cuboid { half_extents: half }, [at.0[0], at.0[1], at.1], turn);
        let mesh = RenderMesh {
            world_from_mesh: shape.world_from_shape,
            mesh: std::sync::Arc::new(cuboid_mesh(&half)),
            id: 5,
            material: Material::KRAFT,
        };
        // 250 columns: the last tile is a narrow one.
        let spec = camera(250, 190, SensorSpec::ideal());
        let back = [wall(1, 4.2)];
        let as_mesh = sense(
            &spec,
            &render_with_meshes(&spec, &Pose::identity(), &back, &[mesh]),
            0,
        );
        let as_shape = capture(&spec, &Pose::identity(), &[back[0].clone(), shape], 0);
        for pixel in 0..as_mesh.ids.len() {
            let same = (as_mesh.ideal_depth[pixel] - as_shape.ideal_depth[pixel]).abs() < 1e-4
                && as_mesh.ids[pixel] == as_shape.ids[pixel];
            prop_assert!(same || at_silhouette(250, pixel, &as_shape.ideal_depth, &as_shape.ids));
        }
    }
}

#[test]
fn meshes_with_wrong_indices_are_refused() {
    assert!(TriangleMesh::new(vec![Point::origin(); 3], vec![[0, 1, 3]]).is_none());
    assert!(TriangleMesh::new(vec![Point::new(f64::NAN, 0.0, 0.0)], Vec::new()).is_none());
}

#[test]
fn a_camera_on_the_flange_moves_with_it() {
    let flange_from_camera = Pose::translation(0.0, 0.1, 0.05);
    let world_from_flange = Pose::translation(1.0, 0.0, 2.0);
    let in_hand = Mounting::EyeInHand { flange_from_camera };
    let at = in_hand.world_from_camera(&world_from_flange);
    assert_eq!(at.translation.vector, Vector::new(1.0, 0.1, 2.05));
    let on_stand = Mounting::EyeToHand {
        world_from_camera: flange_from_camera,
    };
    assert_eq!(
        on_stand.world_from_camera(&world_from_flange),
        flange_from_camera
    );
}
