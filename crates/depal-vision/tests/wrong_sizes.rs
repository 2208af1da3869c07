//! Sizes that no carton of the picture has are not found in it, though their sides agree with some of those that are
//! there. Where gaps cannot be seen, heights tell that two are one.

use depal_camera::SensorSpec;
use depal_frames::BoxSize;
use depal_vision::{VisionSettings, detect};
use rendered::{Layout, camera, layer, looking_down, picture, stacked};

mod rendered;

const TOP: f64 = 0.75;

/// Two of the first make up one carton that is there, and so do two of the second; the others share one side with it.
const WRONG_FOR_400_X_300: [[f64; 3]; 5] = [
    [300.0, 200.0, 200.0],
    [400.0, 150.0, 200.0],
    [300.0, 250.0, 200.0],
    [440.0, 300.0, 200.0],
    [400.0, 260.0, 200.0],
];

#[test]
fn a_size_that_is_not_there_is_not_found() {
    let at = looking_down(TOP + 2.0);
    for layout in [Layout::Brick, Layout::Pinwheel] {
        for gap_mm in [10.0, 5.0, 3.0, 1.0, 0.0] {
            for seed in 60..63 {
                let cartons = layer(layout, gap_mm * 1e-3, TOP, seed);
                let spec = camera(SensorSpec::laser_3m());
                let frame = picture(&spec, &at, &stacked(&cartons, TOP), seed);
                for size in WRONG_FOR_400_X_300 {
                    let settings =
                        VisionSettings::new(vec![BoxSize::from_mm(size)]).suited_to(&frame);
                    let found = detect(&frame, &settings).boxes;
                    assert_eq!(found, [], "{layout:?} {gap_mm} mm, seed {seed}, {size:?}");
                }
            }
        }
    }
}
