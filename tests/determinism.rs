//! Same scene, seed and binary: the same bytes, for any number of threads.

use depal_scene::Scene;

use crate::runner::{Finished, root, run_demo, run_scene};

/// Long enough for three picks, their pictures, plans and drops onto the belt.
const SHORT: &[(&str, &str)] = &[("run.max_sim_s", "24")];

fn on_threads(threads: usize, seed: u64) -> Finished {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a thread pool")
        .install(|| run_demo(seed, SHORT))
}

fn assert_same(a: &Finished, b: &Finished) {
    for (line, (x, y)) in a.log.iter().zip(&b.log).enumerate() {
        assert_eq!(x, y, "first difference in event {}", line + 1);
    }
    assert_eq!(a.log.len(), b.log.len(), "one log is longer");
    assert_eq!(a.outcome.state_hash, b.outcome.state_hash);
}

#[test]
fn thread_count_changes_nothing() {
    let one = on_threads(1, 3);
    assert!(
        one.log.len() > 100,
        "too short to prove anything: {} events",
        one.log.len()
    );
    assert!(
        one.outcome.score.picks.len() >= 2,
        "too few picks to prove anything"
    );
    assert_same(&one, &on_threads(2, 3));
    assert_same(&one, &on_threads(5, 3));
}

#[test]
fn the_seed_changes_something() {
    let (a, b) = (on_threads(2, 3), on_threads(2, 4));
    assert_ne!(a.outcome.state_hash, b.outcome.state_hash);
    assert_ne!(a.log, b.log);
}

/// Every way to drive the cell: RAPID, KRL over XML-configured sockets, TP, and a data block; and a camera that the
/// arm carries.
#[test]
fn no_language_brings_chance_into_a_run() {
    let run = |name: &str, threads: usize| {
        let file = root().join(format!("scenes/{name}.toml"));
        let overrides = SHORT
            .iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()));
        let overrides: Vec<_> = overrides.collect();
        let scene = Scene::load_file(&file.to_string_lossy(), &overrides, Some(5))
            .unwrap_or_else(|errors| panic!("{errors}"));
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool")
            .install(|| run_scene(&scene))
    };
    for name in ["kuka", "fanuc", "siemens", "multipick", "eye_in_hand"] {
        let one = run(name, 1);
        let picks = one.outcome.score.picks.len();
        assert!(picks >= 2, "{name}: {picks} picks prove nothing");
        assert_same(&one, &run(name, 3));
    }
}
