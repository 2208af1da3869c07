//! Falls made up from known radii.

use super::*;

/// A mean profile of falls, `pixels` in each bin up to where the surface ends (metres from the side's known place),
/// with noise of a deviation, metres, that is a fifth of that on the mean of a bin.
fn profile(fall: impl Fn(f64) -> f64, end: f64, deviation: f64) -> [Bin; BINS] {
    const PIXELS: f64 = 25.0;
    std::array::from_fn(|n| {
        let outward = (n as f64 + 0.5) * BIN - INSIDE;
        if outward > end {
            return Bin::default();
        }
        let mean = fall(outward) + deviation * (n as f64 * 2.4).sin() / PIXELS.sqrt();
        Bin {
            count: PIXELS,
            sum: PIXELS * mean,
            squares: PIXELS * (mean * mean + deviation * deviation),
        }
    })
}

#[test]
fn a_sharp_edge_is_no_fold() {
    for end in [-0.0006, 0.0, 0.001] {
        for deviation in [0.0, 0.0002, 0.0006] {
            let flat = profile(|_| 0.0, end, deviation);
            assert!(
                fold_of_profile(&flat, 5).is_none(),
                "{end} m, {deviation} m"
            );
        }
    }
}

#[test]
fn the_radius_is_that_of_the_fall() {
    for radius in [0.0015, 0.002, 0.003, 0.005, 0.008] {
        let fold = Fold { radius };
        let shape = |outward: f64| fold.fall((outward + radius).min(radius)).0;
        let found = fold_of_profile(&profile(shape, -0.0004, 0.0002), 5)
            .unwrap_or_else(|| panic!("{radius} m is round"));
        assert!(
            (found.radius - radius).abs() < 0.15 * radius,
            "{radius} m: {found:?}"
        );
    }
}

#[test]
fn a_few_pixels_tell_nothing() {
    let fold = Fold { radius: 0.003 };
    let shape = |outward: f64| fold.fall((outward + 0.003).min(0.003)).0;
    let few = profile(shape, 0.0, 0.0).map(|bin| Bin {
        count: bin.count / 25.0,
        sum: bin.sum / 25.0,
        squares: bin.squares / 25.0,
    });
    assert!(fold_of_profile(&few, 5).is_none());
}

#[test]
fn the_fall_is_followed_to_less_than_45_degrees() {
    for radius in [0.0008, 0.002, 0.005, 0.015] {
        let fold = Fold { radius };
        let (fall, slope) = fold.fall(fold.followed());
        assert!(fall <= DEEPEST + 1e-12, "{radius} m: {fall} m");
        assert!(slope <= 1.0, "{radius} m: {slope}");
    }
}
