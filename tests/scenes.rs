//! Every scene is a test: it runs and keeps its own thresholds.

use depal_report::{AcceptLimits, Report, RunTotals, summary};
use depal_scene::Scene;

use crate::runner::{root, run_demo, run_scene};

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

/// Twenty pallets; behind `DEPAL_SLOW=1`, for it takes minutes.
#[test]
fn twenty_seeds_lose_at_most_one_carton_each() {
    if std::env::var_os("DEPAL_SLOW").is_none() {
        return;
    }
    for seed in 1..=20 {
        let finished = run_demo(seed, &[]);
        let score = &finished.outcome.score;
        let delivered = score.count(|fate| fate == depal_cell::score::CartonFate::Delivered);
        assert!(delivered >= 47, "seed {seed}: {delivered} delivered");
        assert!(
            delivered == 48 || !score.failures_by_reason().is_empty(),
            "seed {seed}: a loss without a reason"
        );
    }
}
