//! Sizes that are not given: what is reported is one whole carton, and what cannot be told apart is refused.

use depal_vision::RejectReason;
use rendered::Layout;
use unsized_scenes::{
    Case, Sensor, measured, scene,
    verdict::{Verdict, judge},
};

mod generator;
mod rendered;
mod unsized_scenes;

const SENSORS: [Sensor; 2] = [Sensor::Camera, Sensor::Second];

fn score(case: Case, gap: f64, sensor: Sensor, seeds: std::ops::Range<u64>) -> Verdict {
    let mut total = Verdict::default();
    for seed in seeds {
        let scene = scene(case, gap, seed, sensor);
        total.absorb(judge(&scene, &measured(&scene, sensor, seed).boxes));
    }
    total
}

/// Two or more that touch are parted by their heights, or refused beside one of their size.
#[test]
fn touching_cartons_are_not_measured_as_one() {
    for sensor in SENSORS {
        for case in [
            Case::TwoClusters,
            Case::RandomGaps,
            Case::MixedRandomGaps,
            Case::Staggered,
        ] {
            let score = score(case, 0.0, sensor, 71_000..71_006);
            assert_eq!(score.bad(), 0, "{case:?} {sensor:?}: {:?}", score.notes);
        }
    }
}

/// A single cluster without a gap is refused by its heights; where those are level nothing is left to tell, and the
/// confidence says so.
#[test]
fn a_block_without_a_gap() {
    for sensor in SENSORS {
        let mut ambiguous = 0;
        for seed in 71_100..71_112 {
            let scene = scene(Case::Cluster, 0.0, seed, sensor);
            let detection = measured(&scene, sensor, seed);
            let score = judge(&scene, &detection.boxes);
            assert!(
                score.bad() == 0 || detection.boxes.iter().all(|b| b.confidence <= 0.75),
                "{:?}",
                score.notes
            );
            assert!(score.bad() == 0 || sensor == Sensor::Camera);
            let refused = detection.rejected.iter();
            ambiguous += refused
                .filter(|r| r.reason == RejectReason::Ambiguous)
                .count();
        }
        assert!(ambiguous >= 5, "{sensor:?}: {ambiguous}");
    }
}

/// What gaps show is found, and none of it is refused for being as large as two of another size, if it is there twice.
#[test]
fn nothing_is_lost_where_gaps_are_seen() {
    for sensor in SENSORS {
        for case in [Case::Cluster, Case::MixedRows, Case::Layer(Layout::Mixed)] {
            let score = score(case, 0.006, sensor, 71_200..71_204);
            assert_eq!(
                (score.found, score.bad()),
                (score.wanted, 0),
                "{case:?} {sensor:?}: {:?}",
                score.notes
            );
            assert!(score.off_mm.iter().all(|off| off.abs() < 2.0));
        }
    }
}
