//! Recall, false reports and pose errors on synthetic frames with all noise terms on.

use depal_frames::{BoxSize, DepthFrame, Point};
use depal_vision::{Detection, RegionOfInterest, VisionSettings, detect};
use synthetic::{Scene, Score, Solid, carton, layer, pallet, stack};

mod synthetic;

fn settings() -> VisionSettings {
    VisionSettings::new(vec![carton()])
}

fn score(detection: &Detection, scene: &Scene) -> Score {
    let mut score = Score::default();
    score.add(scene, detection.boxes.iter().map(|b| &b.camera_from_box));
    score
}

/// All cartons of the layers found, nothing else, errors within the bars.
fn check(layers: &[usize], gap_mm: f64, seeds: std::ops::Range<u64>, xy_p95_mm: f64) {
    let mut score = Score::default();
    for &number in layers {
        for seed in seeds.clone() {
            let scene = stack(number, gap_mm * 1e-3, seed);
            let detection = detect(&scene.frame(seed), &settings());
            score.add(&scene, detection.boxes.iter().map(|b| &b.camera_from_box));
        }
    }
    let line = score.line();
    assert_eq!(score.false_positives, 0, "gap {gap_mm} mm: {line}");
    assert_eq!(score.found, score.wanted, "gap {gap_mm} mm: {line}");
    assert!(
        score.quantile(0.95, |e| e.xy_mm) <= xy_p95_mm,
        "gap {gap_mm} mm: {line}"
    );
    assert!(
        score.quantile(0.95, |e| e.z_mm) <= 1.5,
        "gap {gap_mm} mm: {line}"
    );
    assert!(
        score.quantile(0.95, |e| e.yaw_deg) <= 0.3,
        "gap {gap_mm} mm: {line}"
    );
    assert!(
        score.quantile(0.95, |e| e.tilt_deg) <= 0.2,
        "gap {gap_mm} mm: {line}"
    );
}

#[test]
fn gap_6_mm() {
    check(&[6, 4, 1], 6.0, 10..12, 1.0);
}

#[test]
fn gap_4_mm() {
    check(&[6, 3, 1], 4.0, 20..22, 1.0);
}

#[test]
fn gap_3_mm() {
    check(&[6, 5, 1], 3.0, 30..32, 1.2);
}

#[test]
fn gap_2_mm() {
    check(&[6, 2, 1], 2.0, 40..42, 1.5);
}

#[test]
fn gap_1_mm() {
    check(&[6, 1], 1.0, 50..53, 1.5);
}

#[test]
fn gap_0_mm() {
    check(&[6, 1], 0.0, 60..63, 1.5);
}

#[test]
fn a_partly_emptied_layer_shows_two_heights() {
    let mut r = depal_time::RandomStreams::new(70).stream("cartons");
    let mut solids = pallet();
    solids.push(Solid::block(
        0.0,
        0.0,
        1.2,
        0.8,
        synthetic::PALLET_TOP - 0.5,
        synthetic::PALLET_TOP,
    ));
    // Slots 0, 4, 5 of the upper layer are gone, and with them nothing lies on the lower ones.
    let slots: [usize; 8] = [0, 1, 2, 3, 4, 5, 6, 7];
    solids.extend(layer(3, 0.004, &slots[1..4], true, &mut r));
    solids.extend(layer(3, 0.004, &slots[6..], true, &mut r));
    for mut solid in layer(3, 0.004, &[0, 4, 5], true, &mut r) {
        solid.top += 0.25;
        solid.bottom += 0.25;
        solids.push(solid);
    }
    for mut solid in layer(3, 0.004, &[1, 2, 3, 6, 7], false, &mut r) {
        solid.top += 0.25;
        solid.bottom += 0.25;
        solids.push(solid);
    }
    // The block below must not fill the gaps of the layer under test.
    solids[synthetic::pallet().len()].top += 0.25;
    let scene = Scene {
        solids,
        floor: synthetic::FLOOR,
        lean: 0.0,
    };
    let detection = detect(&scene.frame(70), &settings());
    let score = score(&detection, &scene);
    assert_eq!(score.false_positives, 0, "{}", score.line());
    assert!(score.found >= 5, "all of the upper layer: {}", score.line());
    let upper = detection
        .boxes
        .iter()
        .filter(|b| b.camera_from_box.translation.z < synthetic::PALLET_TOP - 0.7)
        .count();
    assert_eq!(upper, 5);
    assert!(
        score.found >= 7,
        "lower cartons in the open: {}",
        score.line()
    );
    assert!(score.quantile(1.0, |e| e.xy_mm) < 3.0, "{}", score.line());
    // Nearest first.
    assert!(
        detection
            .boxes
            .windows(2)
            .all(|w| w[0].camera_from_box.translation.z <= w[1].camera_from_box.translation.z)
    );
}

#[test]
fn bare_boards_and_floor_give_nothing() {
    let scene = Scene {
        solids: pallet(),
        floor: synthetic::FLOOR,
        lean: 0.0,
    };
    let detection = detect(&scene.frame(80), &settings());
    assert_eq!(detection.boxes, []);
    assert!(detection.points_in_region > 1_000_000);
    assert!(!detection.obstacle_points.is_empty());
}

#[test]
fn an_arm_over_the_stack_leaves_no_half_boxes() {
    for (seed, y) in [(90, 0.1), (91, 0.25), (92, -0.3)] {
        let mut scene = stack(4, 0.004, seed);
        let arm = Solid {
            yaw: 0.35,
            ..Solid::block(0.5, y, 1.4, 0.16, 1.6, 1.8)
        };
        scene.solids.push(arm);
        let detection = detect(&scene.frame(seed), &settings());
        let score = score(&detection, &scene);
        assert_eq!(score.false_positives, 0, "{}", score.line());
        // Whatever can be seen whole is found.
        let whole = scene
            .solids
            .iter()
            .filter(|s| s.wanted && scene.seen_share(s) > 0.98)
            .count();
        assert!((1..8).contains(&whole), "the arm hides some: {whole}");
        assert!(score.found >= whole, "{whole}: {}", score.line());
        for b in &detection.boxes {
            assert!(b.visible_fraction >= 0.7, "{b:?}");
        }
        assert!(score.quantile(1.0, |e| e.xy_mm) < 3.0, "{}", score.line());
        // The arm itself is something to keep clear of.
        assert!(
            detection
                .obstacle_points
                .iter()
                .any(|p| (p.z - 1.6).abs() < 0.03)
        );
    }
}

#[test]
fn a_covered_lens_gives_nothing() {
    let frame = DepthFrame::blank(synthetic::camera());
    let detection = detect(&frame, &settings());
    assert_eq!(detection, Detection::default());
    assert_eq!(detection.points_in_region, 0);
}

#[test]
fn a_wrong_size_is_never_reported() {
    let frame = stack(3, 0.004, 100).frame(100);
    for wrong in [
        [300.0, 200.0],
        [600.0, 400.0],
        [400.0, 280.0],
        [420.0, 300.0],
    ] {
        let settings = VisionSettings::new(vec![BoxSize::from_mm([wrong[0], wrong[1], 250.0])]);
        assert_eq!(detect(&frame, &settings).boxes, [], "{wrong:?}");
    }
    assert_eq!(detect(&frame, &VisionSettings::new(Vec::new())).boxes, []);
}

#[test]
fn the_label_says_which_size_fits() {
    let frame = stack(3, 0.004, 110).frame(110);
    let settings = VisionSettings::new(vec![BoxSize::from_mm([300.0, 200.0, 200.0]), carton()]);
    let detection = detect(&frame, &settings);
    assert_eq!(detection.boxes.len(), 8);
    assert!(
        detection
            .boxes
            .iter()
            .all(|b| b.label == 1 && b.size == carton())
    );
}

#[test]
fn a_region_keeps_the_rest_out() {
    let scene = stack(3, 0.004, 120);
    let frame = scene.frame(120);
    // Only the half with positive X; the region is turned with the camera's axes.
    let region = RegionOfInterest {
        camera_from_region: depal_frames::Pose::translation(0.5, 0.0, 2.5),
        half_extents: depal_frames::Vector::new(0.5, 0.6, 1.0),
    };
    let settings = VisionSettings {
        region: Some(region.clone()),
        ..settings()
    };
    let detection = detect(&frame, &settings);
    assert_eq!(detection.boxes.len(), 4);
    assert!(detection.obstacle_points.iter().all(|p| p.x > -0.03));
    assert!(region.contains(&Point::new(0.0, 0.6, 1.5)));
    let elsewhere = RegionOfInterest {
        camera_from_region: depal_frames::Pose::translation(9.0, 0.0, 2.5),
        ..region
    };
    let settings = VisionSettings {
        region: Some(elsewhere),
        ..settings
    };
    assert_eq!(detect(&frame, &settings), Detection::default());
}

#[test]
fn reported_cartons_are_no_obstacles() {
    let scene = stack(3, 0.004, 130);
    let detection = detect(&scene.frame(130), &settings());
    let top = synthetic::PALLET_TOP - 0.75;
    let over = |p: &&Point| p.x.abs() < 0.58 && p.y.abs() < 0.38 && p.z < top + 0.2;
    assert_eq!(detection.obstacle_points.iter().filter(over).count(), 0);
    let blind = detect(&scene.frame(130), &VisionSettings::new(Vec::new()));
    assert!(blind.obstacle_points.iter().filter(over).count() > 500);
}

#[test]
fn the_same_frame_gives_the_same_bits() {
    let frame = stack(2, 0.002, 140).frame(140);
    let (a, b) = (detect(&frame, &settings()), detect(&frame, &settings()));
    assert_eq!(a, b);
    assert!(!a.boxes.is_empty());
}
