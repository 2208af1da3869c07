//! Take away what the result rests on, and the result goes away, for the true reason.

use depal_cell::cell::EndState;
use depal_cell::event::FailureReason;

use crate::runner::{Finished, root, run_demo, run_scene, scene};

fn reasons(finished: &Finished) -> Vec<FailureReason> {
    finished
        .outcome
        .score
        .failures_by_reason()
        .into_keys()
        .collect()
}

fn has(finished: &Finished, needle: &str) -> bool {
    finished.log.iter().any(|line| line.contains(needle))
}

#[test]
fn without_vacuum_nothing_is_lifted() {
    let finished = run_demo(1, &[("gripper.vacuum_kpa", "2")]);
    assert_eq!(finished.delivered(), 0);
    assert_eq!(reasons(&finished), [FailureReason::NoSeal]);
    assert!(!has(&finished, "\"event\":\"gripped\""));
}

#[test]
fn with_the_lens_covered_nothing_is_found_and_nothing_tried() {
    let finished = run_demo(1, &[("camera.blackout", "true")]);
    assert_eq!(finished.outcome.score.picks.len(), 0);
    assert_eq!(reasons(&finished), [FailureReason::NoDetection]);
    assert_eq!(finished.outcome.score.statuses.get(&2038), Some(&1));
    assert_eq!(finished.outcome.end, EndState::Finished);
}

#[test]
fn too_heavy_cartons_fall() {
    let finished = run_demo(1, &[("cartons.mass_kg", "150")]);
    assert_eq!(finished.delivered(), 0);
    assert_eq!(reasons(&finished), [FailureReason::Dropped]);
}

#[test]
fn with_the_wrong_byte_order_nothing_is_understood_and_nothing_moves() {
    let finished = run_demo(1, &[("interface.encoding", "hex-be")]);
    assert_eq!(reasons(&finished), [FailureReason::ProtocolError]);
    assert_eq!(finished.outcome.end, EndState::Stopped);
    assert_eq!(finished.outcome.score.statuses.get(&3001), Some(&1));
    assert!(!has(&finished, "\"event\":\"move_started\""));
}

#[test]
fn driving_through_the_stack_is_a_collision_that_stops_the_arm() {
    let program = root().join("tests/programs/through_the_stack.mod");
    let finished = run_demo(1, &[("robot.program", &program.to_string_lossy())]);
    assert_eq!(reasons(&finished), [FailureReason::Collision]);
    assert_eq!(finished.outcome.end, EndState::Failed);
    assert!(finished.outcome.end_detail.contains("ERR_MOTIONSUP"));
    assert!(!has(&finished, "through\""), "the program went on");
}

#[test]
fn a_camera_that_hangs_elsewhere_than_calibrated_spoils_picks() {
    // The camera really looks from 60 mm farther along the pallet; nobody is told.
    let good = run_demo(2, &[("run.max_sim_s", "20")]);
    let shifted = run_demo(
        2,
        &[
            ("run.max_sim_s", "20"),
            ("camera.mounting_error_mm", "[0, 60, 0]"),
        ],
    );
    let median = |finished: &Finished| {
        let mut errors = finished.outcome.score.pose_errors_mm.clone();
        errors.sort_by(f64::total_cmp);
        errors.get(errors.len() / 2).copied()
    };
    assert!(median(&good).expect("reports in the good run") < 1.0);
    assert!(shifted.outcome.score.false_picks > 0);
}

/// Every carton as heavy as the planner takes it to be, two at a time. The percentages that the planner asks for are
/// what holds them: the same ways in half the time shake most of them off.
#[test]
fn twice_as_fast_as_planned_heavy_cartons_drop() {
    let run = |scale: &str| {
        let overrides = [("cartons.mass_kg", "20"), ("robot.velocity_scale", scale)];
        run_scene(&scene("multipick", &overrides, Some(1)))
    };
    let planned = run("1");
    assert_eq!(planned.delivered(), 48);
    assert!(reasons(&planned).is_empty());

    let doubled = run("2");
    let picks = &doubled.outcome.score.picks;
    let lost = |reason: &Option<FailureReason>| {
        matches!(
            reason,
            Some(FailureReason::Dropped | FailureReason::SealLost)
        )
    };
    let dropped = picks.iter().filter(|(_, reason)| lost(reason)).count();
    assert!(
        2 * dropped > picks.len(),
        "{dropped} of {} picks lost their cartons",
        picks.len()
    );
}
