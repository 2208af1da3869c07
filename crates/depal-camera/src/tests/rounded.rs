//! Boxes with rounded edges against the signed distance of such a box.

use depal_frames::{Point, Pose, Rotation, Shape, Vector};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::{Capture, NOTHING, capture};

fn rounded(item: RenderShape, edge_radius: f64) -> RenderShape {
    RenderShape {
        edge_radius,
        ..item
    }
}

/// Distance of a point from a rounded box, negative inside.
fn signed_distance(p: &Point, half: &Vector, radius: f64) -> f64 {
    let beyond = Vector::from_fn(|k, _| p[k].abs() - (half[k] - radius));
    beyond.map(|d| d.max(0.0)).norm() + beyond.max().min(0.0) - radius
}

/// Depth of the first hit and the normal there, by marching along the signed distance (Hart 1996): of a
/// ray that passes closer than a nanometre it says that it hits.
fn march(item: &RenderShape, direction: &Vector) -> Option<(f64, Vector)> {
    let Shape::Cuboid { half_extents: half } = &item.shape else {
        panic!("boxes only");
    };
    let radius = item.edge_radius.min(half.min());
    let distance = |p: &Point| signed_distance(p, half, radius);
    let shape_from_world = item.world_from_shape.inverse();
    let eye = shape_from_world * Point::origin();
    let ray = shape_from_world * direction;
    let end = eye.coords.norm() + half.norm();
    let mut z = 0.0;
    while z * ray.norm() < end {
        let here = distance(&(eye + ray * z));
        if here < 1e-9 {
            // The gradient, by differences.
            let point = eye + ray * z;
            let step = 1e-6;
            let slope = |k: usize| {
                let aside = Vector::from_fn(|n, _| if n == k { step } else { 0.0 });
                distance(&(point + aside)) - distance(&(point - aside))
            };
            let normal = Vector::new(slope(0), slope(1), slope(2)).normalize();
            return Some((z, item.world_from_shape.rotation * normal));
        }
        z += here / ray.norm();
    }
    None
}

fn nearest(scene: &[RenderShape], ray: &Vector) -> Option<(f64, u32)> {
    scene
        .iter()
        .filter_map(|item| march(item, ray).map(|(z, _)| (z, item.id)))
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Whether rays up to one pixel beside this one meet another solid, or the same far away.
fn at_silhouette(scene: &[RenderShape], spec: &CameraSpec, u: usize, v: usize) -> bool {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    let mut seen = Vec::new();
    for (du, dv) in (-4..=4).flat_map(|a| (-4..=4).map(move |b| (a, b))) {
        let aside = |at: usize, by: i32| at as f64 + 0.25 * f64::from(by);
        let hit = nearest(scene, &spec.intrinsics.ray(aside(u, du), aside(v, dv)));
        let (z, id) = hit.unwrap_or((0.0, NOTHING));
        (low, high) = (low.min(z), high.max(z));
        seen.push(id);
    }
    high - low > 0.002 || seen.iter().any(|id| *id != seen[0])
}

fn any_box() -> impl Strategy<Value = (Vector, Pose, f64)> {
    (
        prop::array::uniform3(0.02..0.3_f64),
        prop::array::uniform2(-0.6..0.6_f64),
        0.7..2.5_f64,
        prop::array::uniform3(-3.0..3.0_f64),
        prop_oneof![1 => Just(0.0), 4 => 0.0..0.02_f64, 1 => 0.02..0.4_f64],
    )
        .prop_map(|(half, [x, y], z, turn, radius)| {
            let turn = Rotation::new(Vector::from(turn));
            let pose = Pose::from_parts(Vector::new(x, y, z).into(), turn);
            (Vector::from(half), pose, radius)
        })
}

fn scene_of(boxes: Vec<(Vector, Pose, f64)>) -> Vec<RenderShape> {
    let item = |(n, (half_extents, world_from_shape, edge_radius))| RenderShape {
        world_from_shape,
        shape: Shape::Cuboid { half_extents },
        id: n as u32,
        material: Material::KRAFT,
        edge_radius,
    };
    boxes.into_iter().enumerate().map(item).collect()
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 48,
        rng_seed: RngSeed::Fixed(3),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    /// Long focal length, so that edges are many pixels wide.
    #[test]
    fn rounded_boxes_agree_with_marched_rays(boxes in prop::collection::vec(any_box(), 1..6)) {
        let scene = scene_of(boxes);
        let mut spec = camera(200, 150, SensorSpec::ideal());
        (spec.intrinsics.fx, spec.intrinsics.fy) = (240.0, 240.0);
        let shot = capture(&spec, &Pose::identity(), &scene, 0);
        let mut wrong = 0;
        for pixel in 0..200 * 150 {
            let (u, v) = (pixel % 200, pixel / 200);
            let (z, id) = nearest(&scene, &spec.intrinsics.ray(u as f64, v as f64))
                .unwrap_or((0.0, NOTHING));
            let off = (f64::from(shot.ideal_depth[pixel]) - z).abs();
            if off < 2e-6 && shot.ids[pixel] == id {
                continue;
            }
            wrong += 1;
            let agrees = off < 1e-4 && shot.ids[pixel] == id;
            prop_assert!(
                agrees || at_silhouette(&scene, &spec, u, v),
                "pixel {u},{v}: raster {} (id {}), ray {z} (id {id})",
                shot.ideal_depth[pixel], shot.ids[pixel],
            );
        }
        prop_assert!(wrong <= 3, "{wrong} pixels differ");
    }
}

fn carton(edge_radius: f64, turn: [f64; 3]) -> RenderShape {
    let shape = Shape::cuboid(0.4, 0.3, 0.25);
    rounded(solid(7, shape, [0.05, -0.03, 1.2], turn), edge_radius)
}

fn count(shot: &Capture, id: u32) -> usize {
    shot.ids.iter().filter(|seen| **seen == id).count()
}

/// A quarter of a disk is missing at each of the four sides of a face seen head on.
#[test]
fn a_rounded_face_falls_away_as_a_circle_does() {
    let spec = camera(1280, 1024, SensorSpec::ideal());
    let radius = 0.02;
    let shot = capture(&spec, &Pose::identity(), &[carton(radius, [0.0; 3])], 0);
    let (near, mut rows) = (1.2 - 0.125, 0);
    // Down the middle of the face, where x is that of the box and the ray lies in the plane of Y and Z.
    let i = spec.intrinsics;
    let (u, _) = i.project(&Point::new(0.05, -0.03, near));
    for v in 0..1024 {
        let at = v * 1280 + u.round() as usize;
        if shot.ids[at] != 7 {
            continue;
        }
        let z = f64::from(shot.ideal_depth[at]);
        let y = ((v as f64 - i.cy) / i.fy * z + 0.03).abs() - (0.15 - radius);
        if y <= 0.0 {
            assert!((z - near).abs() < 1e-6);
            continue;
        }
        rows += 1;
        let fall = radius - (radius * radius - y * y).max(0.0).sqrt();
        // At the outline the ray grazes the circle.
        let slack = if y < 0.95 * radius { 1e-6 } else { 5e-3 };
        assert!((z - near - fall).abs() < slack, "y {y}: {z}, {fall}");
    }
    assert!(rows > 30, "{rows} rows on the edges");
}

/// The box keeps its size: what it covers shrinks by no more than its edges do.
#[test]
fn the_outline_shrinks_with_the_radius_and_never_grows() {
    let spec = camera(640, 480, SensorSpec::ideal());
    let shot = |radius: f64| {
        let item = carton(radius, [0.7, 0.4, 0.2]);
        capture(&spec, &Pose::identity(), &[item], 0)
    };
    let sharp = shot(0.0);
    let mut before = count(&sharp, 7);
    for radius in [0.002, 0.005, 0.02, 0.1] {
        let round = shot(radius);
        for pixel in 0..sharp.ids.len() {
            if round.ids[pixel] == 7 {
                assert_eq!(sharp.ids[pixel], 7);
                assert!(round.ideal_depth[pixel] >= sharp.ideal_depth[pixel] - 1e-6);
            }
        }
        assert!(count(&round, 7) < before, "radius {radius}");
        before = count(&round, 7);
    }
}

/// All of a cube is rounded away: a ball.
#[test]
fn a_cube_rounded_by_half_its_side_is_a_ball() {
    let spec = camera(320, 240, SensorSpec::laser_structured_light());
    let cube = solid(
        4,
        Shape::cuboid(0.3, 0.3, 0.3),
        [0.1, 0.05, 1.0],
        [0.5, 0.3, 0.1],
    );
    let ball = solid(
        4,
        Shape::Sphere { radius: 0.15 },
        [0.1, 0.05, 1.0],
        [0.0; 3],
    );
    let cube = capture(
        &spec,
        &Pose::identity(),
        &[wall(1, 1.6), rounded(cube, 1.0)],
        3,
    );
    let ball = capture(&spec, &Pose::identity(), &[wall(1, 1.6), ball], 3);
    let (mut ids, mut depths, mut greys) = (0, 0, 0);
    let shown = count(&ball, 4);
    for pixel in 0..ball.ids.len() {
        ids += usize::from(cube.ids[pixel] != ball.ids[pixel]);
        let off = |a: &[f32], b: &[f32]| (a[pixel] - b[pixel]).abs();
        // Normals, and so light and noise, are those of the ball. Where sight grazes it the last bit of
        // the normal decides whether a pixel is lost.
        depths += usize::from(off(&cube.frame.depth, &ball.frame.depth) > 2e-4);
        greys += usize::from(cube.frame.intensity[pixel].abs_diff(ball.frame.intensity[pixel]) > 1);
    }
    assert!(ids <= 2 && greys <= 20, "{ids} {greys}");
    assert!(100 * depths < shown, "{depths} of {shown} depths");
}

/// The light on an edge is that of a plane which touches it there: neither that of the face before nor
/// that of the face behind it.
#[test]
fn an_edge_is_lit_by_its_own_normal() {
    let mut spec = camera(
        640,
        480,
        SensorSpec {
            ambient: 0.0,
            ..SensorSpec::ideal()
        },
    );
    spec.baseline = 0.0;
    let item = carton(0.06, [0.7, 0.4, 0.2]);
    let shot = capture(&spec, &Pose::identity(), std::slice::from_ref(&item), 0);
    let (mut compared, mut worst) = (0, 0.0_f64);
    for pixel in (0..shot.ids.len()).filter(|pixel| shot.ids[*pixel] == 7) {
        let (u, v) = (pixel % 640, pixel / 640);
        let ray = spec.intrinsics.ray(u as f64, v as f64);
        let Some((z, normal)) = march(&item, &ray) else {
            continue;
        };
        let cosine = -normal.dot(&ray.normalize());
        let reach = spec.sensor.exposure_distance / (ray * z).norm();
        let grey = 255.0 * Material::KRAFT.albedo * cosine * reach * reach;
        worst = worst.max((f64::from(shot.frame.intensity[pixel]) - grey.min(255.0)).abs());
        compared += 1;
    }
    assert!(
        compared > 20_000 && worst < 1.01,
        "{compared} pixels, worst {worst}"
    );
}

/// Where rounded edges meet there is a notch: through two touching boxes it shows what is behind.
#[test]
fn between_touching_boxes_lies_a_notch_and_at_four_corners_a_hole() {
    let spec = camera(640, 480, SensorSpec::ideal());
    let corner = |x: f64, y: f64, id| {
        let shape = Shape::cuboid(0.2, 0.2, 0.2);
        rounded(solid(id, shape, [x, y, 0.9], [0.0; 3]), 0.02)
    };
    let scene = [
        wall(1, 1.5),
        corner(-0.1, -0.1, 2),
        corner(0.1, -0.1, 3),
        corner(-0.1, 0.1, 4),
        corner(0.1, 0.1, 5),
    ];
    let shot = capture(&spec, &Pose::identity(), &scene, 0);
    let mut sharp = scene.clone();
    for item in &mut sharp {
        item.edge_radius = 0.0;
    }
    let sharp = capture(&spec, &Pose::identity(), &sharp, 0);
    let inside = |pixel: usize| {
        let (u, v) = (pixel % 640, pixel / 640);
        u.abs_diff(319) < 100 && v.abs_diff(239) < 100
    };
    let holes = |shot: &Capture| {
        (0..640 * 480)
            .filter(|p| inside(*p) && shot.ids[*p] == 1)
            .count()
    };
    assert_eq!(holes(&sharp), 0);
    assert!(holes(&shot) > 20, "{} pixels", holes(&shot));
    // Half way along the seam two boxes touch, and the notch goes as deep as a pixel lets one look.
    let seam: Vec<f32> = (310..330)
        .map(|u| shot.ideal_depth[180 * 640 + u])
        .collect();
    let deepest = seam.iter().copied().fold(0.0, f32::max);
    assert!((0.810..0.8201).contains(&deepest), "{seam:?}");
    assert!((300..340).all(|u| shot.ids[180 * 640 + u] != 1));
}

/// A box thrown away by its rim must not hide what stands behind it.
#[test]
fn what_is_behind_a_rounded_corner_shows() {
    let spec = camera(320, 240, SensorSpec::ideal());
    for turn in [[0.0; 3], [0.3, 0.2, 0.1], [0.7, 0.4, 0.2], [1.2, -0.6, 0.9]] {
        let front = carton(0.08, turn);
        let back = wall(1, 1.9);
        let alone = capture(&spec, &Pose::identity(), std::slice::from_ref(&front), 0);
        let both = capture(&spec, &Pose::identity(), &[front, back], 0);
        for pixel in 0..both.ids.len() {
            let expected = if alone.ids[pixel] == 7 { 7 } else { 1 };
            assert_eq!(both.ids[pixel], expected);
        }
    }
}

#[test]
fn rounded_pictures_have_the_same_bits_on_any_number_of_threads() {
    let spec = camera(333, 222, SensorSpec::laser_structured_light());
    let scene: Vec<RenderShape> = (0..12)
        .map(|n| {
            let at = [
                f64::from(n % 4) * 0.2 - 0.3,
                f64::from(n / 4) * 0.2 - 0.2,
                1.3,
            ];
            let shape = Shape::cuboid(0.199, 0.199, 0.2);
            rounded(solid(n, shape, at, [0.1, 0.05, 0.02 * f64::from(n)]), 0.004)
        })
        .chain([wall(99, 1.6)])
        .collect();
    let on = |threads: usize| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool")
            .install(|| capture(&spec, &Pose::identity(), &scene, 9))
    };
    let one = on(1);
    for threads in [2, 8] {
        assert!(one == on(threads), "{threads} threads");
    }
    let sharp = |mut scene: Vec<RenderShape>| {
        for item in &mut scene {
            item.edge_radius = 0.0;
        }
        capture(&spec, &Pose::identity(), &scene, 9)
    };
    assert!(one != sharp(scene.clone()));
}

/// What a radius does not apply to, or cannot be, is drawn as before.
#[test]
fn no_radius_is_a_sharp_box() {
    let spec = camera(160, 120, SensorSpec::laser_structured_light());
    let shot = |shape: &Shape, radius: f64| {
        let item = solid(7, shape.clone(), [0.05, -0.03, 1.2], [0.7, 0.4, 0.2]);
        capture(&spec, &Pose::identity(), &[rounded(item, radius)], 1)
    };
    let cuboid = Shape::cuboid(0.4, 0.3, 0.25);
    for radius in [1e-6, -0.1, f64::NAN] {
        assert!(shot(&cuboid, 0.0) == shot(&cuboid, radius), "{radius}");
    }
    let ball = Shape::Sphere { radius: 0.2 };
    assert!(shot(&ball, 0.0) == shot(&ball, 0.05));
}
