use std::collections::BTreeMap;

use proptest::prelude::*;

use crate::*;

fn limits() -> AcceptLimits {
    AcceptLimits {
        delivered_min: Some(48.0),
        dropped_max: Some(0.0),
        pick_success_min: Some(0.97),
        boxes_per_hour_min: Some(400.0),
        vision_recall_min: Some(0.99),
        false_picks_max: Some(0.0),
        pose_err_mm_p95_max: Some(3.0),
        pose_err_deg_p95_max: Some(0.5),
    }
}

fn good_run() -> RunTotals {
    RunTotals {
        scene: "demo".to_owned(),
        seed: 1,
        version: "0.1.0".to_owned(),
        sim_time_s: 400.0,
        wall_time_s: 16.0,
        state_hash: "0123456789abcdef".to_owned(),
        ended_because: "the program finished: the pallet is empty (2037)".to_owned(),
        boxes_total: 48,
        boxes_delivered: 48,
        last_delivery_s: Some(384.0),
        picks_attempted: 49,
        picks_succeeded: 48,
        pick_failures: BTreeMap::from([("no_seal".to_owned(), 1)]),
        cycle_s: (0..47)
            .map(|pick| 7.5 + f64::from(pick % 10) * 0.1)
            .collect(),
        frames: 49,
        visible_boxes: 200,
        found_boxes: 199,
        pose_err_mm: (0..199).map(|index| f64::from(index) * 0.01).collect(),
        pose_err_deg: (0..199).map(|index| f64::from(index) * 0.002).collect(),
        vision_ms: vec![9.0, 10.0, 11.0],
        planning_ms: vec![4.0, 5.0, 6.0, 30.0],
        min_clearance_mm: Some(12.5),
        commands: BTreeMap::from([(201, 49), (205, 49)]),
        statuses: BTreeMap::from([(2103, 49), (2100, 48), (2037, 1)]),
        ..RunTotals::default()
    }
}

/// The vacuum of the good run is gone: everything slips off.
fn failing_run() -> RunTotals {
    RunTotals {
        boxes_delivered: 1,
        boxes_dropped: 3,
        picks_attempted: 8,
        picks_succeeded: 1,
        pick_failures: BTreeMap::from([("dropped".to_owned(), 3), ("no_seal".to_owned(), 4)]),
        ended_because: "the simulated time ran out".to_owned(),
        ..good_run()
    }
}

fn nothing_happened() -> RunTotals {
    RunTotals {
        scene: "demo".to_owned(),
        boxes_total: 48,
        ..RunTotals::default()
    }
}

#[test]
fn json_of_a_good_run() {
    insta::assert_snapshot!(Report::new(&good_run(), &limits()).to_json());
}

#[test]
fn json_of_a_failing_run() {
    insta::assert_snapshot!(Report::new(&failing_run(), &limits()).to_json());
}

#[test]
fn json_of_a_run_without_samples() {
    insta::assert_snapshot!(Report::new(&nothing_happened(), &limits()).to_json());
}

#[test]
fn pages_for_people() {
    let pages: Vec<String> = [good_run(), failing_run(), nothing_happened()]
        .iter()
        .map(|totals| summary(&Report::new(totals, &limits())))
        .collect();
    insta::assert_snapshot!(pages.join("\n"));
}

/// A program that stops because the server timed out is not helped by a longer run, nor is one that was made to fail.
#[test]
fn a_timeout_is_told_by_its_cause() {
    let stopped = |statuses: &[(u32, u64)], faults: &[&str]| {
        let totals = RunTotals {
            pick_failures: BTreeMap::from([("timeout".to_owned(), 1)]),
            statuses: statuses.iter().copied().collect(),
            faults: faults.iter().map(|fault| (*fault).to_owned()).collect(),
            ..nothing_happened()
        };
        summary(&Report::new(&totals, &limits()))
    };
    let slow = stopped(&[], &[]);
    assert!(
        slow.contains("raise run.max_sim_s") && !slow.contains("faults"),
        "{slow}"
    );
    let late = stopped(&[(1019, 1)], &[]);
    assert!(late.contains("raise interface.timeout_s"), "{late}");
    assert!(!late.contains("max_sim_s"), "{late}");
    let injected = stopped(&[(1019, 1)], &["status=1019@command=102"]);
    assert!(
        injected.contains("  faults      status=1019@command=102, as injected\n"),
        "{injected}"
    );
    assert!(
        injected.contains("without the injected faults"),
        "{injected}"
    );
    assert!(!injected.contains("raise"), "{injected}");
}

#[test]
fn a_percentile_is_a_sample_by_nearest_rank() {
    // The worked example of the nearest-rank method: 30th, 40th, 50th, 100th percentile.
    let samples = [50.0, 15.0, 40.0, 20.0, 35.0];
    let at = |share| percentile(&samples, share).unwrap();
    assert_eq!(
        [at(0.05), at(0.3), at(0.4), at(0.5), at(1.0)],
        [15.0, 20.0, 20.0, 35.0, 50.0]
    );
    let twenty: Vec<f64> = (1..=20).map(f64::from).collect();
    assert_eq!(percentile(&twenty, 0.95), Some(19.0));
    assert_eq!(percentile(&[], 0.5), None);
    assert_eq!(percentile(&[f64::NAN], 0.5), None);
}

#[test]
fn every_threshold_can_be_missed_alone() {
    let worse: [(&str, fn(&mut RunTotals)); 8] = [
        ("delivered_min", |run| run.boxes_delivered = 47),
        ("dropped_max", |run| run.boxes_dropped = 1),
        ("pick_success_min", |run| run.picks_succeeded = 40),
        ("boxes_per_hour_min", |run| {
            run.last_delivery_s = Some(433.0);
        }),
        ("vision_recall_min", |run| run.found_boxes = 190),
        ("false_picks_max", |run| run.false_picks = 1),
        ("pose_err_mm_p95_max", |run| run.pose_err_mm = vec![3.1]),
        ("pose_err_deg_p95_max", |run| run.pose_err_deg = vec![0.51]),
    ];
    assert!(Report::new(&good_run(), &limits()).accept.passed);
    for (name, spoil) in worse {
        let mut totals = good_run();
        spoil(&mut totals);
        let accept = Report::new(&totals, &limits()).accept;
        let missed: Vec<&str> = accept
            .checks
            .iter()
            .filter(|check| !check.passed)
            .map(|check| check.name.as_str())
            .collect();
        assert!(!accept.passed);
        assert_eq!(missed, [name]);
    }
}

#[test]
fn what_was_not_measured_misses_its_threshold() {
    let accept = Report::new(&nothing_happened(), &limits()).accept;
    let recall = accept
        .checks
        .iter()
        .find(|check| check.name == "vision_recall_min")
        .unwrap();
    assert_eq!((recall.value, recall.passed), (None, false));
    assert!(
        Report::new(&nothing_happened(), &AcceptLimits::default())
            .accept
            .passed
    );
}

#[test]
fn the_rate_counts_to_the_end_when_cartons_are_left() {
    let rate = |totals: &RunTotals| Report::new(totals, &limits()).boxes_per_hour.unwrap();
    assert_eq!(rate(&good_run()), 48.0 * 3600.0 / 384.0);
    let one_left = RunTotals {
        boxes_delivered: 47,
        ..good_run()
    };
    assert_eq!(rate(&one_left), 47.0 * 3600.0 / 400.0);
}

proptest! {
    #[test]
    fn a_percentile_leaves_the_right_share_below(
        samples in prop::collection::vec(-1e6_f64..1e6, 1..60),
        share in 0.0_f64..=1.0,
    ) {
        let value = percentile(&samples, share).unwrap();
        let not_above = samples.iter().filter(|sample| **sample <= value).count() as f64;
        let below = samples.iter().filter(|sample| **sample < value).count() as f64;
        let wanted = share * samples.len() as f64;
        prop_assert!(samples.contains(&value));
        prop_assert!(not_above + 1e-6 >= wanted);
        prop_assert!(below <= wanted.max(0.0) + 1e-6);
    }

    #[test]
    fn any_numbers_make_valid_json(
        times in prop::collection::vec(prop::num::f64::ANY, 0..5),
        sim in prop::num::f64::ANY,
        wall in prop::num::f64::ANY,
    ) {
        let totals = RunTotals {
            sim_time_s: sim,
            wall_time_s: wall,
            cycle_s: times.clone(),
            pose_err_mm: times.clone(),
            min_clearance_mm: times.first().copied(),
            ..nothing_happened()
        };
        let json = Report::new(&totals, &limits()).to_json();
        let parsed: serde_json::Value = serde_json::from_str(&json).unwrap();
        prop_assert_eq!(&parsed["schema"], 1);
        prop_assert!(parsed["cycle_s"].get("mean").is_some());
    }
}
