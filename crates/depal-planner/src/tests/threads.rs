//! The same bits whatever the number of threads; [`Cell::plan`] compares all plans of these tests.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::{Cell, THREADS, cuboid, pallet, seen, visible, with_threads};
use crate::{Refusal, RejectReason, Rejection, in_order::first_in_order};

/// The nearest cartons lie under a beam, two under a low roof, one leans: the winner is not the first, and all reasons
/// before it are told in their order.
#[test]
fn the_history_of_rejected_candidates_is_the_same_too() {
    let mut cell = Cell::new();
    let boxes = visible(&pallet(4));
    let beam = cuboid(1.5, 0.3, 1.3, 0.5, 0.9, 0.1);
    cell.known.push(beam.clone());
    let plan = cell.plan(&boxes).unwrap();
    let blocked = |r: &Rejection| matches!(r.reason, RejectReason::Collision { .. });
    assert!(plan.rejected.len() >= 2, "{:?}", plan.rejected);
    assert!(plan.rejected.iter().all(blocked), "{:?}", plan.rejected);
    assert!(plan.rejected.iter().all(|r| r.box_index != plan.box_index));

    // Nothing can be had: as many reasons as boxes, one beyond reach.
    cell.known.push(cuboid(1.7, 0.0, 1.3, 1.0, 1.4, 0.1));
    let mut boxes = boxes;
    boxes.push(seen(4.5, 0.0, 1.144, 0.0));
    let Err(Refusal::NothingFits(rejected)) = cell.plan(&boxes) else {
        panic!("a plan through the roof");
    };
    assert_eq!(rejected.len(), boxes.len());
    assert!(!rejected.iter().all(blocked));
}

/// Candidates that fail and succeed as told: how many were tried, what came out.
fn tried(threads: usize, succeeds: &[bool]) -> (usize, Vec<usize>, Option<usize>) {
    let count = AtomicUsize::new(0);
    let (failures, success) = with_threads(threads, || {
        first_in_order((0..succeeds.len()).collect(), |i: usize| {
            count.fetch_add(1, Ordering::Relaxed);
            // Late ones are quick.
            let work: f64 = (0..(20 - i) * 2000).map(|k| (k as f64).sqrt()).sum();
            if succeeds[i] && work >= 0.0 {
                Ok(i)
            } else {
                Err(i)
            }
        })
    });
    (count.into_inner(), failures, success)
}

#[test]
fn the_first_success_in_order_wins_and_costs_nothing_beside_it() {
    for threads in THREADS {
        // The first one wins: nobody looks at another.
        assert_eq!(tried(threads, &[true; 12]), (1, vec![], Some(0)));
        assert_eq!(tried(threads, &[]), (0, vec![], None));
        for first in 1..12 {
            let mut succeeds = [false; 12];
            succeeds[first..].fill(true);
            let (count, failures, success) = tried(threads, &succeeds);
            assert_eq!(success, Some(first), "{threads} threads");
            assert_eq!(failures, (0..first).collect::<Vec<_>>());
            // To the end of its batch of four at most, and no farther than needed with one thread.
            let batch_end = 1 + first.div_ceil(4) * 4;
            assert!((first + 1..=batch_end).contains(&count), "{count}");
            assert!(threads > 1 || count == first + 1);
        }
        assert_eq!(tried(threads, &[false; 6]).1, [0, 1, 2, 3, 4, 5]);
    }
}
