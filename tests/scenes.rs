//! Every scene is a test: it runs and keeps its own thresholds.

use depal_cell::score::CartonFate;
use depal_report::{AcceptLimits, Report, RunTotals, summary};
use depal_scene::Scene;

use crate::runner::{Finished, root, run_demo, run_scene};

fn limits(scene: &Scene) -> AcceptLimits {
    let accept = &scene.accept;
    AcceptLimits {
        delivered_min: accept.delivered_min,
        dropped_max: accept.dropped_max,
        pick_success_min: accept.pick_success_min,
        boxes_per_hour_min: accept.boxes_per_hour_min,
        vision_recall_min: accept.vision_recall_min,
        false_picks_max: accept.false_picks_max,
        pose_err_mm_p95_max: accept.pose_err_mm_p95_max,
        pose_err_deg_p95_max: accept.pose_err_deg_p95_max,
    }
}

/// All of them, or the one that `DEPAL_SCENE=name` asks for.
#[test]
fn every_scene_is_accepted() {
    let mut paths: Vec<_> = std::fs::read_dir(root().join("scenes"))
        .expect("scenes/ is there")
        .map(|entry| entry.expect("readable entry").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .collect();
    paths.sort();
    if let Ok(name) = std::env::var("DEPAL_SCENE") {
        paths.retain(|path| path.file_stem().is_some_and(|stem| *stem == *name));
    }
    assert!(!paths.is_empty(), "no scenes found");
    for path in paths {
        let scene = Scene::load_file(&path.to_string_lossy(), &[], None)
            .unwrap_or_else(|errors| panic!("{errors}"));
        let finished = run_scene(&scene);
        let totals = RunTotals::of(&scene.name, scene.seed, &finished.outcome, 0.0);
        let report = Report::new(&totals, &limits(&scene));
        assert!(
            report.accept.passed,
            "{}: {}\n{}",
            path.display(),
            finished.outcome.end_detail,
            summary(&report)
        );
        println!("{}\n{}", path.display(), summary(&report));
    }
}

/// The scenes that promise it, twenty pallets each; behind `DEPAL_SLOW=1`, for it takes a quarter of an hour.
#[test]
fn scenes_are_accepted_over_twenty_seeds() {
    if std::env::var_os("DEPAL_SLOW").is_none() {
        return;
    }
    for name in ["irb460", "mixed", "rollcage", "two_pallets", "multipick"] {
        let path = root().join(format!("scenes/{name}.toml"));
        for seed in 1..=20 {
            let scene = Scene::load_file(&path.to_string_lossy(), &[], Some(seed))
                .unwrap_or_else(|errors| panic!("{errors}"));
            let finished = run_scene(&scene);
            let totals = RunTotals::of(&scene.name, seed, &finished.outcome, 0.0);
            let report = Report::new(&totals, &limits(&scene));
            assert!(report.accept.passed, "{name} {seed}:\n{}", summary(&report));
        }
    }
}

/// The numbers of vision's replies to a command that begin so.
fn replies(finished: &Finished, command: i32, start: &str) -> Vec<Vec<f64>> {
    let lines = finished.log.iter().filter_map(|line| {
        let event: serde_json::Value = serde_json::from_str(line).ok()?;
        let is_it = event["event"] == "protocol"
            && event["command"] == command
            && event["from"] == "vision";
        let text = event["text"]
            .as_str()
            .filter(|text| is_it && text.starts_with(start))?;
        let message = text.split(' ').next()?;
        let cells = message.split(',').filter_map(|cell| cell.parse().ok());
        Some(cells.collect())
    });
    lines.collect()
}

/// The 21 plan values of every Vision Move that went out: ten labels, how many in all and now, edge or corner,
/// offset, turn of the group and of its cartons, size of the group.
fn plan_data(finished: &Finished) -> Vec<Vec<f64>> {
    let points = replies(finished, 210, "210,2100,").into_iter();
    let moves = points.filter(|cells| cells[3] == 1.0);
    moves.map(|cells| cells[13..34].to_vec()).collect()
}

/// One layer beside a wall: where the plate would meet it, the outer sections take the carton, the robot is told which
/// edge of the gripper is flush and how far off the tool is, and nothing is lost. Without the wall all are in the middle.
#[test]
fn beside_a_wall_the_robot_is_told_of_the_edge_and_the_offset() {
    let wall = "[{ name = \"wall\", xyz_mm = [1700, 720, 0], size_mm = [900, 30, 900] }]";
    let layer = [
        ("cartons.layers", "1"),
        ("cartons.count", "8"),
        ("accept.delivered_min", "8"),
    ];
    for (walls, at_edge) in [("[]", 0), (wall, 2)] {
        let finished = run_demo(1, &[layer[0], layer[1], layer[2], ("solid", walls)]);
        let score = &finished.outcome.score;
        assert_eq!(score.count(|fate| fate == CartonFate::Delivered), 8);
        let plans = plan_data(&finished);
        let lists = replies(&finished, 206, "206,2102,");
        assert_eq!((plans.len(), lists.len()), (8, 8));
        let mut found = 0;
        for (plan, list) in plans.iter().zip(&lists) {
            // The carton's long side lies across the gripper; it is a group of its own.
            assert_eq!(plan[16..18], [1.0, 0.0]);
            // The middle pair of sections; or the pair at +X, one section farther out; or that at -X.
            let (offset_mm, outputs) = match plan[12] {
                0.0 => (0.0, [3.0, 5.0]),
                1.0 => (150.0, [5.0, 6.0]),
                3.0 => (-150.0, [1.0, 3.0]),
                other => panic!("edge {other}"),
            };
            found += usize::from(plan[12] != 0.0);
            assert_eq!(plan[13..16], [offset_mm, 0.0, 0.0]);
            assert_eq!(list[2..5], [outputs[0], outputs[1], -1.0]);
        }
        assert_eq!(found, at_edge, "walls {walls}");
    }
}

/// Two cartons on the wire: the plan data of 210 and one output for each section.
#[test]
fn a_group_is_told_with_its_size_and_turn() {
    let path = root().join("scenes/multipick.toml");
    let overrides = [("run.max_sim_s".to_owned(), "12".to_owned())];
    let scene = Scene::load_file(&path.to_string_lossy(), &overrides, Some(1))
        .unwrap_or_else(|errors| panic!("{errors}"));
    let finished = run_scene(&scene);
    let plans = plan_data(&finished);
    assert!(plans.len() >= 2);
    for (round, plan) in plans.iter().enumerate() {
        assert_eq!(
            plan[10..13],
            [2.0 * (round + 1) as f64, 2.0, 0.0],
            "total, now, edge"
        );
        assert_eq!(plan[13..16], [0.0; 3], "in the middle of the gripper");
        assert_eq!(
            plan[16..18],
            [0.0, 1.0],
            "the group along the gripper, its cartons across"
        );
        assert!((600.0..613.0).contains(&plan[18]) && (399.0..406.0).contains(&plan[19]));
        assert_eq!(plan[20], 250.0);
    }
    let lists = replies(&finished, 206, "206,2102,");
    assert_eq!(lists[0][2..7], [1.0, 3.0, 5.0, 6.0, -1.0]);
}

/// Twenty pallets; behind `DEPAL_SLOW=1`, for it takes minutes.
#[test]
fn twenty_seeds_lose_at_most_one_carton_each() {
    if std::env::var_os("DEPAL_SLOW").is_none() {
        return;
    }
    for seed in 1..=20 {
        let finished = run_demo(seed, &[]);
        let score = &finished.outcome.score;
        let delivered = score.count(|fate| fate == CartonFate::Delivered);
        assert!(delivered >= 47, "seed {seed}: {delivered} delivered");
        assert!(
            delivered == 48 || !score.failures_by_reason().is_empty(),
            "seed {seed}: a loss without a reason"
        );
    }
}
