//! From pictures to the camera's pose: the board is rendered with all sensor effects, found,
//! and the camera's pose estimated, with the arm's repeatability on.

use depal_camera::{Material, SensorSpec, capture, capture_with_decals};
use depal_frames::{DepthFrame, Intrinsics, Point, Pose, Rotation, Shape, Vector};
use depal_time::RandomStreams;
use depal_vision::calibration::{
    CaptureProblem, CircleBoard, Mounting, Session, find_board, plan_poses,
};

use board::{BOARD, board_bodies, camera, solid};
use pictured_cell::{
    base_from_camera, corner_error, flange_from_board, nothing_in_the_way, picture, plan, repeated,
    rough, surroundings,
};

mod board;
mod pictured_cell;

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
            let frame = picture(&BOARD, pose, &camera(sensor), k as u64);
            let view = find_board(&frame, &BOARD).unwrap_or_else(|e| panic!("{name} {k}: {e}"));
            let truth = base_from_camera().inverse() * pose * flange_from_board();
            let mut squares = 0.0;
            for (b, c) in BOARD.centres().iter().zip(&view.centres) {
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
        let mut session = Session::new(BOARD, Mounting::EyeToHand, poses.clone()).unwrap();
        while let Some(pose) = session.next_pose().copied() {
            let really = repeated(&pose, &mut random);
            let frame = picture(&BOARD, &really, &spec, random.next_u64());
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
    let mut session = Session::new(BOARD, Mounting::EyeInHand, poses).unwrap();
    let (plate, print) = board_bodies(&BOARD, &base_from_board);
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
        assert!(find_board(&frame, &BOARD).is_err());
    }
    for bad in [0.0, f64::NAN] {
        let mut frame = DepthFrame::blank(camera(SensorSpec::ideal()).intrinsics);
        frame.intrinsics.fx = bad;
        frame.depth.fill(1.0);
        frame.intensity.fill(100);
        assert!(find_board(&frame, &BOARD).is_err());
    }
}

#[test]
fn refused_pictures_say_why() {
    let spec = camera(SensorSpec::laser_structured_light());
    let pose = plan_poses(&plan(1), nothing_in_the_way).unwrap()[0];
    let frame = picture(&BOARD, &pose, &spec, 1);
    assert!(find_board(&frame, &BOARD).is_ok());

    // Other boards.
    let wrong = |other: CircleBoard| find_board(&frame, &other).unwrap_err();
    let fewer = wrong(CircleBoard {
        columns: 8,
        ..BOARD
    });
    assert!(
        matches!(fewer, CaptureProblem::WrongBoard { .. }),
        "{fewer}"
    );
    let more = wrong(CircleBoard {
        columns: 10,
        ..BOARD
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
        ..BOARD
    });
    assert!(
        matches!(wider, CaptureProblem::WrongBoard { .. }),
        "{wider}"
    );
    let discs = wrong(CircleBoard {
        disc_diameter: 0.0145,
        ..BOARD
    });
    assert!(
        matches!(discs, CaptureProblem::WrongBoard { .. }),
        "{discs}"
    );

    // The large discs in other places.
    let (plate, mut print) = board_bodies(&BOARD, &(pose * flange_from_board()));
    let ordinary = BOARD.disc_diameter / 2.0;
    for (n, (c, r)) in BOARD.nodes().enumerate() {
        let mark = [(0, 0), (2, 0), (0, 2)].contains(&(c, r));
        print.discs[n].1 = if mark { 1.5 * ordinary } else { ordinary };
    }
    let mut shapes = surroundings(&pose);
    shapes.push(plate);
    let moved = capture_with_decals(&spec, &base_from_camera(), &shapes, &[print], 1).frame;
    let problem = find_board(&moved, &BOARD).unwrap_err();
    assert!(
        matches!(problem, CaptureProblem::WrongBoard { .. }),
        "{problem}"
    );

    // Something lies on a corner of the board.
    let base_from_board = pose * flange_from_board();
    let (plate, print) = board_bodies(&BOARD, &base_from_board);
    let mut shapes = surroundings(&pose);
    shapes.push(plate);
    shapes.push(solid(
        base_from_board * Pose::translation(0.16, 0.12, 0.05),
        Shape::cuboid(0.12, 0.09, 0.02),
        50,
        Material::PAINT,
    ));
    let covered = capture_with_decals(&spec, &base_from_camera(), &shapes, &[print], 1).frame;
    let problem = find_board(&covered, &BOARD).unwrap_err();
    assert!(
        matches!(problem, CaptureProblem::Partial { expected: 63, found } if (50..63).contains(&found)),
        "{problem}"
    );

    // No print, no light, no depth, no sense.
    let empty = capture(&spec, &base_from_camera(), &surroundings(&pose), 1).frame;
    assert!(matches!(
        find_board(&empty, &BOARD),
        Err(CaptureProblem::NoBoard { .. })
    ));
    let mut dark = frame.clone();
    dark.intensity.fill(0);
    assert!(matches!(
        find_board(&dark, &BOARD),
        Err(CaptureProblem::NoBoard { .. })
    ));
    let mut short = frame.clone();
    short.intensity.clear();
    assert!(matches!(
        find_board(&short, &BOARD),
        Err(CaptureProblem::BadFrame { .. })
    ));
}
