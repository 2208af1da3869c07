//! The drop limit against the hand calculation, as a figure: searched by halving, not asked for as yes or no.

use super::*;

/// Largest share of the limit by hand that 24 cups keep, when the tool accelerates with `share` times `lift` up and
/// `lateral` sideways; found by halving, at a step of `dt` seconds.
fn limit_found(mass: f64, lift: f64, lateral: f64, dt: f64) -> f64 {
    let holds = |share: f64| {
        let mut hung = Hung::new(GripperSpec::four_sections(), mass, 24, dt);
        hung.run(1.0, &valves(24), 0.0, 0.0);
        // Off the support first: what lies on it does not slide.
        hung.run(0.1, &valves(24), 0.5, 0.0);
        // Hand calculations are static: the acceleration rises slowly, or the carton would swing on its cups.
        for step in 1..=40 {
            let part = share * f64::from(step) / 40.0;
            hung.run(0.02, &valves(24), part * lift, part * lateral);
        }
        hung.run(0.5, &valves(24), share * lift, share * lateral);
        hung.held() && hung.slide[0].abs() < 0.01
    };
    assert!(holds(0.05) && !holds(3.0), "the limit lies between");
    let (mut low, mut high) = (0.05, 3.0);
    for _ in 0..9 {
        let middle = f64::midpoint(low, high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    f64::midpoint(low, high)
}

/// Specific holding force `n dp A / m`, m/s2.
fn specific(mass: f64) -> f64 {
    by_hand(24) / mass
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Load case I: `m (g + a) = n dp A`.
    #[test]
    fn lift(mass in 20.0f64..70.0) {
        let by_hand = specific(mass) - GRAVITY;
        let found = [0.001, 0.002, 0.004].map(|dt| limit_found(mass, by_hand, 0.0, dt));
        for share in found {
            prop_assert!((0.9..=1.1).contains(&share), "{found:?} of {by_hand} m/s2");
            prop_assert!((share - found[0]).abs() < 0.03, "the step shows: {found:?}");
        }
    }

    /// Load case II: `m (g + a / mu) = n dp A`.
    #[test]
    fn lateral(mass in 20.0f64..70.0) {
        let by_hand = 0.5 * (specific(mass) - GRAVITY);
        let found = [0.001, 0.002, 0.004].map(|dt| limit_found(mass, 0.0, by_hand, dt));
        for share in found {
            prop_assert!((0.9..=1.1).contains(&share), "{found:?} of {by_hand} m/s2");
            prop_assert!((share - found[0]).abs() < 0.03, "the step shows: {found:?}");
        }
    }

    /// Both at once: `m (g + a_z + a_h / mu) = n dp A`.
    #[test]
    fn combined(mass in 20.0f64..70.0, slope in 0.3f64..2.0) {
        let lift = (specific(mass) - GRAVITY) / (1.0 + slope / 0.5);
        let found = [0.001, 0.002, 0.004].map(|dt| limit_found(mass, lift, slope * lift, dt));
        for share in found {
            prop_assert!((0.9..=1.1).contains(&share), "{found:?} of {lift} m/s2 and {slope} of it");
            prop_assert!((share - found[0]).abs() < 0.03, "the step shows: {found:?}");
        }
    }
}
