//! Cartons that stand alone: two opposite sides tell the middle, however different what is seen beyond them.

use depal_camera::SensorSpec;
use depal_vision::{VisionSettings, detect};
use rendered::{Layout, Score, camera, layer, looking_down, picture, quantile};

mod rendered;

const TOP: f64 = 0.75;

/// The last few cartons of a layer, most of it taken away: the floor is far below, in the shadows of the projector
/// nothing is measured.
fn left_over(sensor: SensorSpec, seeds: std::ops::Range<u64>) -> Score {
    let spec = camera(sensor);
    let at = looking_down(TOP + 2.0);
    let mut score = Score::default();
    for seed in seeds {
        let mut cartons = layer(Layout::Regular20, 0.005, TOP, seed);
        let mut n = 0;
        cartons.retain(|_| {
            n += 1;
            n % 7 == 1
        });
        let mut shapes = rendered::solids(&cartons);
        shapes.push(rendered::floor(TOP - 0.25));
        let frame = picture(&spec, &at, &shapes, seed);
        let detection = detect(&frame, &VisionSettings::new(Layout::Regular20.sizes()));
        score.add(&at, &cartons, &detection.boxes);
    }
    score
}

#[test]
fn a_lone_carton_lies_in_the_middle_between_its_ends() {
    for (name, sensor) in [
        ("laser 3 m", SensorSpec::laser_3m()),
        ("laser 2 m", SensorSpec::laser_2m()),
    ] {
        let score = left_over(sensor, 0..8);
        println!("{name}: {}", score.line());
        assert_eq!(score.found, score.wanted, "{name}: {}", score.line());
        assert_eq!(score.false_positives, 0, "{name}: {}", score.line());
        assert!(
            quantile(&score.xy_mm, 0.5) <= 0.25,
            "{name}: {}",
            score.line()
        );
        assert!(
            quantile(&score.xy_mm, 0.95) <= 0.75,
            "{name}: {}",
            score.line()
        );
    }
}
