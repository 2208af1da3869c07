//! Sides made up with known insets.

use super::*;

/// Twenty rows with their two ends in four sorts: both lit, one of each, half of one lit, both dark.
fn solved(insets: Insets) -> Insets {
    let mut sums = InsetSums::new();
    for n in 0..20 {
        let [a, b] = [[1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [0.0, 0.0]][n % 4];
        // Where between two pixels a side lies is known to some tenths.
        let pixels = insets.of(a) + insets.of(b) + [0.1, -0.1][n / 4 % 2];
        sums.add(
            a + b,
            2.0 - a - b,
            pixels,
            1.0 / (2.0 * SIDE_PIXELS.powi(2)),
        );
    }
    sums.solve()
}

#[test]
fn known_insets_come_back() {
    for (lit, dark) in [(0.4, 1.2), (0.9, 0.0), (0.0, 0.6)] {
        let found = solved(Insets { lit, dark });
        // Drawn to the usual ones by a fifth part or less.
        let allowed = |inset: f64| 0.05 + 0.2 * (inset - INSET_PIXELS).abs();
        assert!((found.lit - lit).abs() < allowed(lit), "{found:?} {lit}");
        assert!(
            (found.dark - dark).abs() < allowed(dark),
            "{found:?} {dark}"
        );
        assert!(found.differ());
    }
}

#[test]
fn equal_insets_do_not_differ() {
    for inset in [0.0, 0.4, 0.9] {
        let found = solved(Insets {
            lit: inset,
            dark: inset,
        });
        assert!(!found.differ(), "{found:?}");
    }
    assert!(!InsetSums::new().solve().differ());
}
