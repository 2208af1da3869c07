//! Sides made up with known insets.

use super::*;

const PITCH: f64 = 0.001_4;

/// Twenty cartons in four sorts: both sides lit, one of each, half of one side lit, both dark.
fn seen(insets: Insets) -> Vec<Opposite> {
    (0..20)
        .map(|n| {
            let lit = [[1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [0.0, 0.0]][n % 4];
            Opposite {
                found: n,
                direction: Vector::x(),
                pitch: PITCH,
                lit,
                // Where between two pixels a side lies is known to some tenths.
                short: insets.of(lit[0]) + insets.of(lit[1]) + [0.1, -0.1][n / 4 % 2],
            }
        })
        .collect()
}

#[test]
fn known_insets_come_back() {
    for (lit, dark) in [(0.4, 1.2), (0.9, 0.0), (0.0, 0.6)] {
        let found = insets_of(&seen(Insets { lit, dark }));
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
fn equal_insets_move_nothing() {
    for inset in [0.0, 0.4, 0.9] {
        let found = insets_of(&seen(Insets {
            lit: inset,
            dark: inset,
        }));
        assert!(!found.differ(), "{found:?}");
    }
    assert!(!insets_of(&[]).differ());
}

#[test]
fn sizes_that_are_all_wrong_move_nothing() {
    let mut sides = seen(Insets::USUAL);
    for pair in &mut sides {
        pair.short += 0.8;
    }
    assert!(!insets_of(&sides).differ());
}

#[test]
fn one_wrong_pair_counts_little() {
    let told = Insets {
        lit: 0.4,
        dark: 1.2,
    };
    let clean = insets_of(&seen(told));
    let mut sides = seen(told);
    sides[0].short += 5.0;
    let found = insets_of(&sides);
    assert!((found.lit - clean.lit).abs() < 0.1, "{found:?} {clean:?}");
    assert!((found.dark - clean.dark).abs() < 0.1, "{found:?} {clean:?}");
}

#[test]
fn a_carton_moves_to_its_real_middle() {
    // The side at larger x loses 1.2 pixels, the other 0.4: the seen middle lies 0.4 pixels too far at smaller x.
    let insets = Insets {
        lit: 0.4,
        dark: 1.2,
    };
    let pair = |lit| Opposite {
        found: 0,
        direction: Vector::x(),
        pitch: PITCH,
        lit,
        short: 1.6,
    };
    let shift = pair([1.0, 0.0]).shift(&insets);
    assert!((shift - Vector::x() * (0.4 * PITCH)).norm() < 1e-12);
    assert!((pair([0.0, 1.0]).shift(&insets) + shift).norm() < 1e-12);
    assert!(pair([1.0, 1.0]).shift(&insets).norm() < 1e-12);
}
