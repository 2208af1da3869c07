//! From pictures to the camera's pose: the board is rendered with all sensor effects, found,
//! and the camera's pose estimated, with the arm's repeatability on.

use depal_camera::{
    CameraSpec, Decal, Material, RenderShape, SensorSpec, capture, capture_with_decals,
};
use depal_frames::{DepthFrame, Intrinsics, Point, Pose, Rotation, Shape, Vector};
use depal_time::{RandomStream, RandomStreams};
use depal_vision::calibration::{
    CaptureProblem, CircleBoard, Mounting, PosePlan, Session, find_board, plan_poses,
};

const BOARD_ID: u32 = 77;
const PLATE: f64 = 0.01;

fn board() -> CircleBoard {
    CircleBoard {
        columns: 9,
        rows: 7,
        pitch: 0.040,
        disc_diameter: 0.020,
    }
}

fn camera(sensor: SensorSpec) -> CameraSpec {
    CameraSpec {
        intrinsics: Intrinsics {
            width: 1280,
            height: 1024,
            fx: 1600.0,
            fy: 1600.0,
            cx: 640.0,
            cy: 512.0,
        },
        near: 0.5,
        far: 5.0,
        baseline: 0.3,
        sensor,
    }
}

/// Above the pallet, looking down, not quite straight.
fn base_from_camera() -> Pose {
    Pose::from_parts(
        Vector::new(1.72, 0.03, 3.68).into(),
        Rotation::from_euler_angles(3.12, 0.02, 1.58),
    )
}

/// The board stands out beside the tool and looks back past the flange.
fn flange_from_board() -> Pose {
    Pose::from_parts(
        Vector::new(0.55, 0.02, 0.25).into(),
        Rotation::from_euler_angles(std::f64::consts::PI + 0.01, 0.02, 0.03),
    )
}

fn solid(pose: Pose, shape: Shape, id: u32, material: Material) -> RenderShape {
    RenderShape {
        world_from_shape: pose,
        shape,
        id,
        material,
        edge_radius: 0.0,
    }
}

/// The plate, and its print.
fn board_bodies(board: &CircleBoard, base_from_board: &Pose) -> (RenderShape, Decal) {
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

/// Floor, pallet with a layer of cartons, and a rough arm with a gripper at the flange.
fn surroundings(base_from_flange: &Pose) -> Vec<RenderShape> {
    let mut shapes = vec![
        solid(
            Pose::translation(1.7, 0.0, -0.05),
            Shape::cuboid(8.0, 8.0, 0.1),
            1,
            Material::CONCRETE,
        ),
        solid(
            Pose::translation(1.7, 0.0, 0.072),
            Shape::cuboid(0.8, 1.2, 0.144),
            2,
            Material::WOOD,
        ),
    ];
    for k in 0..8 {
        let (i, j) = (f64::from(k % 2) - 0.5, f64::from(k / 2) - 1.5);
        shapes.push(solid(
            Pose::translation(1.7 + i * 0.404, j * 0.304, 0.269),
            Shape::cuboid(0.4, 0.3, 0.25),
            10 + k as u32,
            Material::KRAFT,
        ));
    }
    let gripper = base_from_flange * Pose::translation(0.0, 0.0, 0.25);
    shapes.push(solid(
        gripper,
        Shape::cuboid(0.62, 0.4, 0.06),
        30,
        Material::PAINT,
    ));
    let flange = base_from_flange.translation.vector;
    let elbow = Vector::new(0.5, 0.0, 2.0);
    let along = elbow - flange;
    let turn = Rotation::rotation_between(&Vector::z(), &along).unwrap_or_else(Rotation::identity);
    shapes.push(solid(
        Pose::from_parts(((flange + elbow) / 2.0).into(), turn),
        Shape::Capsule {
            half_length: along.norm() / 2.0,
            radius: 0.12,
        },
        31,
        Material::PAINT,
    ));
    shapes
}

fn picture(
    board: &CircleBoard,
    base_from_flange: &Pose,
    spec: &CameraSpec,
    seed: u64,
) -> DepthFrame {
    let (plate, print) = board_bodies(board, &(base_from_flange * flange_from_board()));
    let mut shapes = surroundings(base_from_flange);
    shapes.push(plate);
    capture_with_decals(spec, &base_from_camera(), &shapes, &[print], seed).frame
}

/// A pose as the arm really takes it up: 0.05 mm and 0.005 degrees (0.05 mm at 0.6 m) beside the reported one.
fn repeated(pose: &Pose, random: &mut RandomStream) -> Pose {
    let mut normal = |sigma: f64| {
        Vector::new(
            random.normal(sigma),
            random.normal(sigma),
            random.normal(sigma),
        )
    };
    let shift = normal(0.05e-3);
    let turn = normal(0.005_f64.to_radians());
    Pose::from_parts(
        (pose.translation.vector + shift).into(),
        Rotation::new(turn) * pose.rotation,
    )
}

fn rough(pose: &Pose) -> Pose {
    // What a user measures: 20 mm and a degree off.
    Pose::from_parts(
        (pose.translation.vector + Vector::new(0.02, -0.015, 0.02)).into(),
        Rotation::new(Vector::new(0.015, 0.01, -0.015)) * pose.rotation,
    )
}

fn plan(count: usize) -> PosePlan {
    PosePlan {
        board: board(),
        mounting: Mounting::EyeToHand,
        intrinsics: camera(SensorSpec::ideal()).intrinsics,
        camera: rough(&base_from_camera()),
        board_pose: rough(&flange_from_board()),
        region: Pose::translation(1.7, 0.0, 1.2),
        half_extents: Vector::new(0.35, 0.45, 0.45),
        max_tilt: 30f64.to_radians(),
        count,
    }
}

/// The whole plate is seen: nothing of arm or gripper lies before it.
fn nothing_in_the_way(base_from_flange: &Pose) -> bool {
    let mut spec = camera(SensorSpec::ideal());
    let i = &mut spec.intrinsics;
    (i.width, i.height) = (i.width / 4, i.height / 4);
    (i.fx, i.fy, i.cx, i.cy) = (i.fx / 4.0, i.fy / 4.0, i.cx / 4.0, i.cy / 4.0);
    let (plate, _) = board_bodies(&board(), &(base_from_flange * flange_from_board()));
    let count = |shapes: &[RenderShape]| {
        let shot = capture(&spec, &base_from_camera(), shapes, 0);
        shot.ids.iter().filter(|id| **id == BOARD_ID).count()
    };
    let mut all = surroundings(base_from_flange);
    all.push(plate.clone());
    let flange = base_from_flange.translation.vector;
    count(&all) == count(&[plate]) && flange.xy().norm() < 2.6
}

/// Mean error over the corners of the pallet volume, metres.
fn corner_error(found: &Pose, truth: &Pose) -> f64 {
    let mut sum = 0.0;
    for k in 0..8 {
        let side = |bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
        let corner = Point::new(
            1.7 + 0.8 * side(1),
            1.2 * side(2),
            0.144 + 0.75 + 1.5 * side(4),
        );
        sum += (found * truth.inverse_transform_point(&corner) - corner).norm();
    }
    sum / 8.0
}

#[test]
fn disc_centres_are_found_to_a_fraction_of_a_millimetre() {
    let poses = plan_poses(&plan(6), nothing_in_the_way).unwrap();
    // A camera that reads all distances too long is no fault of the finder.
    let laser = SensorSpec {
        scale_error: 0.0,
        ..SensorSpec::laser_structured_light()
    };
    for (name, sensor, bar) in [
        ("ideal", SensorSpec::ideal(), 0.06e-3),
        ("laser", laser, 0.3e-3),
    ] {
        for (k, pose) in poses.iter().enumerate() {
            let frame = picture(&board(), pose, &camera(sensor), k as u64);
            let view = find_board(&frame, &board()).unwrap_or_else(|e| panic!("{name} {k}: {e}"));
            let truth = base_from_camera().inverse() * pose * flange_from_board();
            let mut squares = 0.0;
            for (b, c) in board().centres().iter().zip(&view.centres) {
                squares += (truth * b - c).norm_squared();
            }
            let rms = (squares / view.centres.len() as f64).sqrt();
            println!(
                "{name} {k}: rms {:.4} mm, rigid {:.4} mm, {:.1} px, incidence {:.1}",
                rms * 1e3,
                view.rms * 1e3,
                view.disc_px,
                view.incidence.to_degrees()
            );
            assert!(rms < bar, "{name} {k}: {} mm", rms * 1e3);
        }
    }
}

#[test]
fn fixed_camera_from_pictures() {
    let spec = camera(SensorSpec::laser_structured_light());
    let poses = plan_poses(&plan(15), nothing_in_the_way).unwrap();
    for seed in 1..=3 {
        let mut random = RandomStreams::new(seed).stream("arm");
        let mut session = Session::new(board(), Mounting::EyeToHand, poses.clone()).unwrap();
        while let Some(pose) = session.next_pose().copied() {
            let really = repeated(&pose, &mut random);
            let frame = picture(&board(), &really, &spec, random.next_u64());
            session.capture(&frame, &pose).unwrap();
        }
        let found = session.finish().unwrap();
        let error = corner_error(&found.camera, &base_from_camera());
        println!(
            "seed {seed}: corners {:.3} mm, rms {:.3} mm, max {:.3} mm",
            error * 1e3,
            found.rms * 1e3,
            found.max * 1e3
        );
        assert!(error < 0.5e-3, "{} mm at the corners", error * 1e3);
        let again = session.finish().unwrap();
        assert_eq!(found, again);
    }
}

#[test]
fn camera_on_the_flange_from_pictures() {
    let spec = camera(SensorSpec::laser_structured_light());
    let flange_from_camera = Pose::from_parts(
        Vector::new(0.15, 0.02, 0.08).into(),
        Rotation::from_euler_angles(0.02, -0.01, 1.6),
    );
    let base_from_board = Pose::from_parts(
        Vector::new(1.7, 0.05, 0.4).into(),
        Rotation::from_euler_angles(0.02, 0.01, 0.3),
    );
    let mut plan = plan(15);
    plan.mounting = Mounting::EyeInHand;
    plan.camera = rough(&flange_from_camera);
    plan.board_pose = rough(&base_from_board);
    plan.region = Pose::translation(1.7, 0.05, 1.8);
    plan.half_extents = Vector::new(0.7, 0.7, 0.3);
    let poses = plan_poses(&plan, |_| true).unwrap();
    let mut random = RandomStreams::new(1).stream("arm");
    let mut session = Session::new(board(), Mounting::EyeInHand, poses).unwrap();
    let (plate, print) = board_bodies(&board(), &base_from_board);
    let mut shapes = surroundings(&Pose::translation(0.5, 2.0, 1.0));
    shapes.push(plate);
    let decals = [print];
    while let Some(pose) = session.next_pose().copied() {
        let base_from_camera = repeated(&pose, &mut random) * flange_from_camera;
        let seed = random.next_u64();
        let frame = capture_with_decals(&spec, &base_from_camera, &shapes, &decals, seed).frame;
        session.capture(&frame, &pose).unwrap();
    }
    let found = session.finish().unwrap();
    // A volume of a pallet before the camera.
    let error = (0..8)
        .map(|k| {
            let side = |bit: usize| if k & bit == 0 { -0.5 } else { 0.5 };
            let corner = Point::new(1.2 * side(1), 0.8 * side(2), 1.7 + 1.0 * side(4));
            (found.camera * corner - flange_from_camera * corner).norm() / 8.0
        })
        .sum::<f64>();
    println!(
        "on the flange: corners {:.3} mm, rms {:.3} mm",
        error * 1e3,
        found.rms * 1e3
    );
    assert!(error < 0.5e-3, "{} mm", error * 1e3);
}

#[test]
fn any_picture_gets_an_answer() {
    let mut random = RandomStreams::new(1).stream("pictures");
    for n in 0..300 {
        let (width, height) = match n {
            0 => (1, 1),
            1 => (16_000, 2),
            2 => (2, 3000),
            _ => (
                random.uniform(1.0, 200.0) as usize,
                random.uniform(1.0, 150.0) as usize,
            ),
        };
        let intrinsics = Intrinsics {
            width,
            height,
            fx: random.uniform(1.0, 3000.0),
            fy: random.uniform(1.0, 3000.0),
            cx: random.uniform(-100.0, 3000.0),
            cy: random.uniform(-100.0, 3000.0),
        };
        let mut frame = DepthFrame::blank(intrinsics);
        let kind = n % 4;
        for k in 0..width * height {
            let (u, v) = (k % width, k / width);
            frame.depth[k] = match (kind, random.next_u64() % 16) {
                (0, 0) => f32::NAN,
                (0, 1) => f32::INFINITY,
                (0, 2) => -1.0,
                (1, _) => 1.0,
                (_, 3) => 0.0,
                _ => random.uniform(0.5, 2.0) as f32,
            };
            // Noise, one value, or spots.
            frame.intensity[k] = match kind {
                0 => random.next_u64() as u8,
                1 => 200,
                _ if u % 20 < 10 && v % 20 < 10 => 10,
                _ => 200,
            };
        }
        assert!(find_board(&frame, &board()).is_err());
    }
    for bad in [0.0, f64::NAN] {
        let mut frame = DepthFrame::blank(camera(SensorSpec::ideal()).intrinsics);
        frame.intrinsics.fx = bad;
        frame.depth.fill(1.0);
        frame.intensity.fill(100);
        assert!(find_board(&frame, &board()).is_err());
    }
}

#[test]
fn refused_pictures_say_why() {
    let spec = camera(SensorSpec::laser_structured_light());
    let pose = plan_poses(&plan(1), nothing_in_the_way).unwrap()[0];
    let frame = picture(&board(), &pose, &spec, 1);
    assert!(find_board(&frame, &board()).is_ok());

    // Other boards.
    let wrong = |other: CircleBoard| find_board(&frame, &other).unwrap_err();
    let fewer = wrong(CircleBoard {
        columns: 8,
        ..board()
    });
    assert!(
        matches!(fewer, CaptureProblem::WrongBoard { .. }),
        "{fewer}"
    );
    let more = wrong(CircleBoard {
        columns: 10,
        ..board()
    });
    assert!(
        matches!(
            more,
            CaptureProblem::Partial {
                expected: 70,
                found: 63
            }
        ),
        "{more}"
    );
    let wider = wrong(CircleBoard {
        pitch: 0.052,
        disc_diameter: 0.026,
        ..board()
    });
    assert!(
        matches!(wider, CaptureProblem::WrongBoard { .. }),
        "{wider}"
    );
    let discs = wrong(CircleBoard {
        disc_diameter: 0.0145,
        ..board()
    });
    assert!(
        matches!(discs, CaptureProblem::WrongBoard { .. }),
        "{discs}"
    );

    // The large discs in other places.
    let (plate, mut print) = board_bodies(&board(), &(pose * flange_from_board()));
    let ordinary = board().disc_diameter / 2.0;
    for (n, (c, r)) in board().nodes().enumerate() {
        let mark = [(0, 0), (2, 0), (0, 2)].contains(&(c, r));
        print.discs[n].1 = if mark { 1.5 * ordinary } else { ordinary };
    }
    let mut shapes = surroundings(&pose);
    shapes.push(plate);
    let moved = capture_with_decals(&spec, &base_from_camera(), &shapes, &[print], 1).frame;
    let problem = find_board(&moved, &board()).unwrap_err();
    assert!(
        matches!(problem, CaptureProblem::WrongBoard { .. }),
        "{problem}"
    );

    // Something lies on a corner of the board.
    let base_from_board = pose * flange_from_board();
    let (plate, print) = board_bodies(&board(), &base_from_board);
    let mut shapes = surroundings(&pose);
    shapes.push(plate);
    shapes.push(solid(
        base_from_board * Pose::translation(0.16, 0.12, 0.05),
        Shape::cuboid(0.12, 0.09, 0.02),
        50,
        Material::PAINT,
    ));
    let covered = capture_with_decals(&spec, &base_from_camera(), &shapes, &[print], 1).frame;
    let problem = find_board(&covered, &board()).unwrap_err();
    assert!(
        matches!(problem, CaptureProblem::Partial { expected: 63, found } if (50..63).contains(&found)),
        "{problem}"
    );

    // No print, no light, no depth, no sense.
    let empty = capture(&spec, &base_from_camera(), &surroundings(&pose), 1).frame;
    assert!(matches!(
        find_board(&empty, &board()),
        Err(CaptureProblem::NoBoard { .. })
    ));
    let mut dark = frame.clone();
    dark.intensity.fill(0);
    assert!(matches!(
        find_board(&dark, &board()),
        Err(CaptureProblem::NoBoard { .. })
    ));
    let mut short = frame.clone();
    short.intensity.clear();
    assert!(matches!(
        find_board(&short, &board()),
        Err(CaptureProblem::BadFrame { .. })
    ));
}
