//! Faults on demand in a run of the cell: each with its effect on the robot program, and the run without.

use depal_cell::cell::EndState;
use depal_scene::Scene;

use crate::runner::{Finished, root, run_scene};

/// The interface scene: its program asks for what lies there, and stops at the first refusal.
fn run(faults: &str) -> Finished {
    let path = root().join("scenes/interface.toml");
    let inject = ("interface.inject".to_owned(), format!("[{faults:?}]"));
    let set: Vec<_> = (!faults.is_empty()).then_some(inject).into_iter().collect();
    let scene = Scene::load_file(&path.to_string_lossy(), &set, None);
    run_scene(&scene.unwrap_or_else(|errors| panic!("{errors}")))
}

fn status_count(finished: &Finished, status: i32) -> u64 {
    let statuses = &finished.outcome.score.statuses;
    statuses.get(&status).copied().unwrap_or(0)
}

fn seconds(finished: &Finished) -> f64 {
    finished.outcome.sim_time.as_secs_f64()
}

#[test]
fn without_faults_the_program_comes_to_its_end() {
    let finished = run("");
    assert_eq!(finished.outcome.end, EndState::Finished);
    assert_eq!(status_count(&finished, 1100), 1);
}

#[test]
fn a_refusal_reaches_the_program() {
    for (faults, status) in [
        ("no_points@pick=1", 1002),
        ("camera_lost@t=0s", 1023),
        ("status=1019@command=102", 1019),
    ] {
        let finished = run(faults);
        assert_eq!(finished.outcome.end, EndState::Stopped, "{faults}");
        let said = format!("no points, status {status}");
        let detail = &finished.outcome.end_detail;
        assert!(detail.contains(&said), "{faults}: {detail}");
        assert_eq!(status_count(&finished, 1100), 0, "{faults}");
        assert_eq!(status_count(&finished, status), 1, "{faults}");
        let told: Vec<&String> = finished.outcome.score.faults.iter().collect();
        assert!(
            matches!(told.as_slice(), [only] if faults.starts_with(only.as_str())),
            "{faults}: {told:?}"
        );
    }
    // A fault whose occasion does not come changes nothing.
    let finished = run("no_points@pick=2; status=1019@command=102,n=2; camera_lost@t=2min");
    assert_eq!(finished.outcome.end, EndState::Finished);
    assert!(finished.outcome.score.faults.is_empty());
}

#[test]
fn a_late_reply_is_waited_for_in_simulated_time() {
    let more = seconds(&run("delay=12s@command=102")) - seconds(&run(""));
    assert!((more - 12.0).abs() < 0.02, "{more} s longer");
}

#[test]
fn a_lost_connection_is_seen_by_the_program() {
    let finished = run("drop_connection@command=102");
    assert_eq!(finished.outcome.end, EndState::Stopped);
    let detail = &finished.outcome.end_detail;
    assert!(detail.contains("no points, status 309"), "{detail}");
    assert_eq!(status_count(&finished, 1100), 0);
}

#[test]
fn a_program_that_gathers_its_replies_takes_them_in_pieces() {
    let (split, whole) = (run("split_replies"), run(""));
    assert_eq!(split.outcome.end, EndState::Finished);
    assert_eq!(status_count(&split, 1100), 1);
    // Five replies, the rest of each up to two ticks late.
    let more = seconds(&split) - seconds(&whole);
    assert!((0.02..0.05).contains(&more), "{more} s longer");
}
