//! The planning project's own moves: what stands in their way refuses them, and nothing is touched.

use depal_cell::cell::EndState;
use depal_cell::event::FailureReason;
use depal_cell::score::CartonFate;
use depal_scene::Scene;

use crate::runner::{Finished, root, run_scene};

/// One layer from pallet to pallet, with a post of a metre and a half somewhere in the cell.
fn with_post_at(x_mm: f64, y_mm: f64) -> Finished {
    let solids = format!(
        "[{{ name = \"second pallet\", xyz_mm = [0, -1750, 0], size_mm = [1200, 800, 144] }}, \
         {{ name = \"post\", xyz_mm = [{x_mm}, {y_mm}, 0], size_mm = [60, 60, 1500] }}]"
    );
    let overrides = [
        ("solid", solids.as_str()),
        ("cartons.count", "8"),
        ("cartons.layers", "1"),
        ("accept.delivered_min", "8"),
    ]
    .map(|(key, value)| (key.to_owned(), value.to_owned()));
    let path = root().join("scenes/two_pallets.toml");
    let scene = Scene::load_file(&path.to_string_lossy(), &overrides, None)
        .unwrap_or_else(|errors| panic!("{errors}"));
    run_scene(&scene)
}

#[test]
fn a_post_in_the_way_of_a_taught_move_is_seen_before_it_is_hit() {
    // Between the pallets, where the arm turns with the carton.
    let blocked = with_post_at(1200.0, -880.0);
    let outcome = &blocked.outcome;
    assert_eq!(outcome.end, EndState::Stopped, "{}", outcome.end_detail);
    assert!(
        outcome.end_detail.contains("no path, status 2031"),
        "{}",
        outcome.end_detail
    );
    assert_eq!(outcome.score.statuses.get(&2031), Some(&1));
    let reasons: Vec<_> = outcome.score.failures_by_reason().into_keys().collect();
    assert_eq!(reasons, [FailureReason::PlanCollision]);
    let refused: Vec<&String> = blocked
        .log
        .iter()
        .filter(|line| line.contains("\"event\":\"plan_refused\""))
        .collect();
    assert_eq!(refused.len(), 1, "{refused:?}");
    assert!(
        refused[0].contains("the move to step ") && refused[0].contains(" meets known obstacle "),
        "{}",
        refused[0]
    );
    let is_collision = |line: &String| line.contains("\"event\":\"collision\"");
    assert!(!blocked.log.iter().any(is_collision));

    // The same post out of the way.
    let free = with_post_at(-1200.0, 900.0);
    let placed = free
        .outcome
        .score
        .count(|fate| fate == CartonFate::Delivered);
    assert_eq!(placed, 8, "{}", free.outcome.end_detail);
}
