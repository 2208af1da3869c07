//! Pixels that are lost by chance hide no carton, and what is put in for them hides no gap.

use depal_camera::{Material, RenderShape, SensorSpec};
use depal_frames::DepthFrame;
use depal_vision::{Detection, VisionSettings, detect};
use disturbed::Disturbance;
use rendered::{Carton, Layout, Score, block, camera, layer, looking_down, picture, stacked};

mod disturbed;
mod rendered;

const TOP: f64 = 0.75;
const LAYOUTS: [Layout; 3] = [Layout::Regular20, Layout::Brick20, Layout::Pinwheel21];

fn taken(layout: Layout, gap_mm: f64, seed: u64) -> (Vec<Carton>, DepthFrame) {
    let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
    let spec = camera(SensorSpec::laser_3m());
    let frame = picture(
        &spec,
        &looking_down(TOP + 2.0),
        &stacked(&cartons, TOP),
        seed,
    );
    (cartons, frame)
}

fn seen(layout: Layout, frame: &DepthFrame) -> Detection {
    detect(frame, &VisionSettings::new(layout.sizes()).suited_to(frame))
}

fn score(cartons: &[Carton], detection: &Detection) -> Score {
    let mut score = Score::default();
    score.add(&looking_down(TOP + 2.0), cartons, &detection.boxes);
    score
}

/// All layouts and gaps in pictures so disturbed.
fn of_all(disturbance: Disturbance, seed: u64) -> Score {
    let mut total = Score::default();
    for layout in LAYOUTS {
        for gap_mm in [5.0, 3.0, 1.0, 0.0] {
            let (cartons, frame) = taken(layout, gap_mm, seed);
            let frame = disturbance.of(&frame, seed);
            total.absorb(score(&cartons, &seen(layout, &frame)));
        }
    }
    total
}

#[test]
fn all_cartons_are_found_with_pixels_lost_one_by_one() {
    for (n, share) in [0.002, 0.01, 0.02, 0.05, 0.1].into_iter().enumerate() {
        let score = of_all(Disturbance::Lost(share), 40 + n as u64);
        assert_eq!(score.false_positives, 0, "{share}: {}", score.line());
        assert_eq!(score.found, score.wanted, "{share}: {}", score.line());
        assert!(
            rendered::quantile(&score.xy_mm, 0.95) < 1.0,
            "{share}: {}",
            score.line()
        );
    }
}

/// Where clusters lie so close that they look like a line they stay, and may hide a carton.
#[test]
fn cartons_with_gaps_are_found_with_pixels_lost_in_clusters() {
    for (share, least) in [(0.01, 1.0), (0.02, 1.0), (0.05, 0.95)] {
        let mut total = Score::default();
        for layout in LAYOUTS {
            for gap_mm in [5.0, 3.0, 1.0] {
                let (cartons, frame) = taken(layout, gap_mm, 50);
                let frame = Disturbance::Clusters(share).of(&frame, 50);
                total.absorb(score(&cartons, &seen(layout, &frame)));
            }
        }
        let case = format!("{share}: {}", total.line());
        assert_eq!(total.false_positives, 0, "{case}");
        assert!(total.found as f64 >= least * total.wanted as f64, "{case}");
    }
}

/// Where no gap shows, heights alone part cartons: what was lost there must not make two of one.
#[test]
fn level_seams_with_pixels_lost_in_clusters_make_no_other_cartons() {
    for (share, least) in [(0.02, 0.98), (0.03, 0.98), (0.05, 0.9)] {
        let mut total = Score::default();
        for layout in LAYOUTS {
            for seed in 100..106 {
                let (cartons, frame) = taken(layout, 0.0, seed);
                let frame = Disturbance::Clusters(share).of(&frame, seed);
                total.absorb(score(&cartons, &seen(layout, &frame)));
            }
        }
        let case = format!("{share}: {}", total.line());
        let most_false = if share < 0.05 {
            0.0
        } else {
            0.01 * total.wanted as f64
        };
        assert!(total.false_positives as f64 <= most_false, "{case}");
        assert!(total.found as f64 >= least * total.wanted as f64, "{case}");
    }
}

#[test]
fn single_wrong_depths_and_cameras_own_filters_hide_no_carton() {
    for disturbance in [Disturbance::Outliers(0.005), Disturbance::Median] {
        let score = of_all(disturbance, 60);
        assert_eq!(
            score.false_positives,
            0,
            "{disturbance:?}: {}",
            score.line()
        );
        assert_eq!(
            score.found,
            score.wanted,
            "{disturbance:?}: {}",
            score.line()
        );
    }
}

/// Where gaps and shadows were put in by the camera, cartons are missed; but none is invented.
#[test]
fn what_a_camera_puts_in_invents_no_carton() {
    for disturbance in [
        Disturbance::Interpolated,
        Disturbance::FilledFarther,
        Disturbance::Steps(0.001),
    ] {
        let score = of_all(disturbance, 70);
        assert_eq!(
            score.false_positives,
            0,
            "{disturbance:?}: {}",
            score.line()
        );
    }
}

/// A rim narrower than a smear, around a stack over a floor far below, lies between two levels.
#[test]
fn the_rim_below_sharp_steps_is_no_smear() {
    const TOP_PX: usize = 60;
    for rim in [4, 8, 12] {
        let intrinsics = camera(SensorSpec::laser_3m()).intrinsics;
        let mut frame = DepthFrame::blank(intrinsics);
        for (at, z) in frame.depth.iter_mut().enumerate() {
            // Tops and floor by turns; rims along the rows, the shadow of the projector along the columns.
            let [u, v] = [at % intrinsics.width, at / intrinsics.width].map(|p| p % (2 * TOP_PX));
            *z = if u < TOP_PX && v < TOP_PX {
                2.0
            } else if (TOP_PX..TOP_PX + 14).contains(&u) {
                0.0
            } else if (TOP_PX..TOP_PX + rim).contains(&v) || v >= 2 * TOP_PX - rim {
                2.2
            } else {
                3.0
            };
        }
        let settings = VisionSettings::new(Layout::Brick20.sizes()).suited_to(&frame);
        assert_eq!(settings.smear_px, 0, "a rim of {rim} px");
    }
}

/// Film takes a seventh of the pixels and trebles the noise; its mirror image of the projector takes a piece of the
/// middle as a whole.
#[test]
fn cartons_under_film_are_found_where_gaps_can_be_seen() {
    let mut total = Score::default();
    for layout in LAYOUTS {
        for gap_mm in [5.0, 3.0, 1.0] {
            let cartons = layer(layout, gap_mm * 1e-3, TOP, 80);
            let mut shapes = stacked(&cartons, TOP);
            for shape in &mut shapes[..cartons.len()] {
                shape.material = Material::FILM;
            }
            let spec = camera(SensorSpec::laser_3m());
            let frame = picture(&spec, &looking_down(TOP + 2.0), &shapes, 80);
            total.absorb(score(&cartons, &seen(layout, &frame)));
        }
    }
    assert_eq!(total.false_positives, 0, "{}", total.line());
    assert!(total.found * 10 >= total.wanted * 9, "{}", total.line());
}

/// A strip of tape along the middle of each carton, from side to side, in the mirror image as a whole.
#[test]
fn cartons_with_glossy_tape_are_found() {
    let mut total = Score::default();
    for layout in LAYOUTS {
        for gap_mm in [5.0, 3.0] {
            for across in [false, true] {
                let cartons = layer(layout, gap_mm * 1e-3, TOP, 85);
                let mut shapes = stacked(&cartons, TOP);
                shapes.extend((2000..).zip(&cartons).map(|(id, c)| tape(id, c, across)));
                let spec = camera(SensorSpec::laser_3m());
                let frame = picture(&spec, &looking_down(TOP + 2.0), &shapes, 85);
                total.absorb(score(&cartons, &seen(layout, &frame)));
            }
        }
    }
    assert_eq!(total.false_positives, 0, "{}", total.line());
    assert!(total.found * 10 >= total.wanted * 9, "{}", total.line());
}

fn tape(id: u32, carton: &Carton, across: bool) -> RenderShape {
    let along = usize::from(across);
    let mut size = [0.04, 0.04, 0.000_2];
    size[along] = carton.size[along] - 0.004;
    let centre = [carton.x, carton.y, carton.top + 0.000_1];
    block(id, centre, size, carton.yaw, Material::GLOSSY_TAPE)
}

/// A carton of twice the size would lie over two of these: only the gap says that it is none of them.
#[test]
fn a_gap_is_not_filled() {
    let layout = Layout::Regular20;
    for gap_mm in [5.0, 3.0, 1.0] {
        for share in [0.0, 0.05, 0.1] {
            let (_, frame) = taken(layout, gap_mm, 90);
            let frame = Disturbance::Lost(share).of(&frame, 90);
            let mut sizes = layout.sizes();
            for size in &mut sizes {
                // Two side by side, and the gap between them.
                (size.length, size.width) = (2.0 * size.width + gap_mm * 1e-3, size.length);
            }
            let found = detect(&frame, &VisionSettings::new(sizes).suited_to(&frame));
            assert_eq!(found.boxes, [], "{gap_mm} mm, {share}");
        }
    }
}

#[test]
fn a_covered_lens_with_some_chance_depths_shows_nothing() {
    let (_, mut frame) = taken(Layout::Regular20, 3.0, 95);
    frame.depth.fill(0.0);
    assert_eq!(seen(Layout::Regular20, &frame).boxes, []);
    for share in [0.005, 0.5] {
        let frame = Disturbance::Outliers(share).of(&frame, 95);
        assert_eq!(seen(Layout::Regular20, &frame).boxes, [], "{share}");
    }
}

/// NaN means lost as 0 does.
#[test]
fn lost_pixels_may_be_no_number() {
    let (_, frame) = taken(Layout::Brick20, 3.0, 97);
    let zero = Disturbance::Lost(0.05).of(&frame, 97);
    let mut nan = zero.clone();
    for z in nan.depth.iter_mut().filter(|z| **z == 0.0) {
        *z = f32::NAN;
    }
    assert_eq!(
        seen(Layout::Brick20, &zero).boxes,
        seen(Layout::Brick20, &nan).boxes
    );
}
