//! `depal run` and the demo.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

use depal_cell::cell::{Cell, EndState, RunOutcome};
use depal_cell::observer::Observer;
use depal_interface::FaultScript;
use depal_record::{JsonLines, Recording};
use depal_report::{AcceptLimits, Report, RunTotals, summary};
use depal_scene::{BuildError, Scene};
use depal_vm::Severity;

use crate::RunArgs;
use crate::diagnostics::draw;
use crate::failure::Failure;
use crate::output::OutFolder;
use crate::progress::Progress;
use crate::replay_setup::recording_setup;

/// The demo: the built-in scene with everything left as it is, and what to try next.
pub fn demo() -> Result<(), Failure> {
    tell!(
        "depal {}: the built-in demo, a full pallet emptied by a RAPID program",
        env!("CARGO_PKG_VERSION")
    );
    let folder = run_scene(&RunArgs::default())?;
    tell!("next, try:");
    tell!("  depal replay {}", folder.join("run.rrd").display());
    tell!("  depal run --seed 7");
    tell!("  depal run --set gripper.vacuum_kpa=2      # see it fail, and why");
    Ok(())
}

/// One run of a scene.
pub fn run(args: &RunArgs) -> Result<(), Failure> {
    run_scene(args).map(|_| ())
}

fn run_scene(args: &RunArgs) -> Result<PathBuf, Failure> {
    let scene = load_scene(args.scene.as_deref(), &args.set, args.seed)?;
    let mut built = scene
        .build()
        .map_err(|error| Failure::Input(explain(&error)))?;
    built.spec.interface.faults.extend(faults(&args.inject)?);
    for warning in &built.warnings {
        tell!("{}", draw(warning, &built.sources));
    }
    let time_limit = built.spec.time_limit;
    let setup = recording_setup(&built.spec);
    let limits = accept_limits(&scene);
    let total = built.spec.cartons.len();
    let cell = Cell::new(built.spec, built.task, wall_seconds)
        .map_err(|error| Failure::Input(error.to_string()))?;

    let default_folder = || PathBuf::from(format!("out/{}-{}", scene.name, scene.seed));
    let folder = OutFolder::open(args.out.clone().unwrap_or_else(default_folder))?;
    let environment = |error: depal_record::RecordError| Failure::Environment(error.to_string());
    let mut events = JsonLines::create(&folder.file("events.jsonl")).map_err(environment)?;
    let mut recording = if args.no_recording {
        None
    } else {
        Some(Recording::create(&folder.file("run.rrd"), setup).map_err(environment)?)
    };

    let started = wall_seconds();
    let progress = Progress::start(total, time_limit);
    let outcome = {
        let mut observers: Vec<&mut dyn Observer> = vec![&mut events];
        if let Some(recording) = &mut recording {
            observers.push(recording);
        }
        cell.run(&mut observers, |cell| progress.update(cell))
    };
    progress.finish();
    events.finish().map_err(environment)?;
    if let Some(recording) = recording {
        recording.finish().map_err(environment)?;
    }

    let wall_time = wall_seconds() - started;
    let report = Report::new(
        &RunTotals::of(&scene.name, scene.seed, &outcome, wall_time),
        &limits,
    );
    folder.write("report.json", &report.to_json())?;
    if args.json {
        say!("{}", report.to_json());
    } else {
        print_summary(&report, &outcome, folder.path());
    }
    verdict(&report, &outcome).map(|()| folder.into_path())
}

/// Loads a scene file, or the built-in demo, with overrides as KEY=VALUE.
pub fn load_scene(
    file: Option<&Path>,
    set: &[String],
    seed: Option<u64>,
) -> Result<Scene, Failure> {
    let overrides = set
        .iter()
        .map(|text| {
            text.split_once('=')
                .map(|(key, value)| (key.trim().to_owned(), value.trim().to_owned()))
                .ok_or_else(|| {
                    Failure::Input(format!(
                        "--set {text}: expected KEY=VALUE, as in camera.noise_mm=1.2"
                    ))
                })
        })
        .collect::<Result<Vec<_>, _>>()?;
    let scene = match file {
        None => Scene::demo(&overrides, seed),
        Some(path) => Scene::load_file(&path.to_string_lossy(), &overrides, seed),
    };
    scene.map_err(|errors| {
        let told: Vec<String> = errors.problems.iter().map(ToString::to_string).collect();
        let mut page = told.join("\nerror: ");
        if file.is_some_and(|path| !path.exists()) {
            page += "\nhelp: without a file the built-in demo runs; `depal init DIR` writes a scene to start from";
        }
        Failure::Input(page)
    })
}

/// The faults of `--inject`.
pub fn faults(texts: &[String]) -> Result<FaultScript, Failure> {
    FaultScript::parse(texts).map_err(|error| Failure::Input(format!("--inject: {error}")))
}

/// A build error with the source lines, where there are some.
pub fn explain(error: &BuildError) -> String {
    match error {
        BuildError::Program {
            diagnostics,
            sources,
        } => {
            let errors = diagnostics
                .iter()
                .filter(|diagnostic| diagnostic.severity == Severity::Error)
                .count();
            let drawn: Vec<String> = diagnostics.iter().map(|d| draw(d, sources)).collect();
            format!(
                "the robot program has {errors} error(s)\n{}",
                drawn.join("\n\n")
            )
        }
        other => other.to_string(),
    }
}

/// A seed on the command line.
pub fn seed(text: &str) -> Result<u64, String> {
    text.parse()
        .map_err(|_| format!("expected a whole number of 0 to {}", u64::MAX))
}

fn accept_limits(scene: &Scene) -> AcceptLimits {
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

fn print_summary(report: &Report, outcome: &RunOutcome, folder: &Path) {
    tell!("{}", summary(report).trim_end());
    if let Some((reason, detail)) = &outcome.score.run_failure {
        tell!("gave up      {}: {detail}", reason.name());
    }
    tell!("results      {}", folder.display());
}

fn verdict(report: &Report, outcome: &RunOutcome) -> Result<(), Failure> {
    if outcome.end == EndState::TimeLimit {
        Err(Failure::TimeLimit)
    } else if report.accept.passed && outcome.score.run_failure.is_none() {
        Ok(())
    } else {
        Err(Failure::NotAccepted)
    }
}

/// Wall seconds since the first call. Feeds the report's computing times and nothing else.
pub fn wall_seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}
