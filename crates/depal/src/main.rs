//! `depal`: a robot cell on your laptop. See the README for what it simulates and what it does not.

mod check;
mod diagnostics;
mod failure;
mod kinematics;
mod output;
mod plan;
mod progress;
mod replay;
mod replay_setup;
mod run;
mod totals;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

/// A robot cell: cartons on a pallet, an arm with a vacuum gripper, a depth camera, a vision system
/// that speaks the standard interface, and the robot's own program. Headless and repeatable.
///
/// Without a command it runs the built-in demo: a full pallet, emptied by a RAPID program.
#[derive(Parser)]
#[command(version, disable_help_subcommand = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene from start to end and write report.json, events.jsonl and run.rrd.
    ///
    /// Exit codes: 0 accepted; 1 a threshold of [accept] was missed; 2 bad input; 3 the machine does not
    /// let us (disk, permissions); 4 the scene's time limit passed.
    Run(RunArgs),
    /// Check scenes (.toml), arms (.urdf) and robot programs (.mod, .sys, .prg) without running them.
    Check {
        /// Files to check. RAPID modules given together are one task.
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
    },
    /// Open a recording in the rerun viewer, or picture it without a display.
    Replay {
        /// The recording, out/<scene>-<seed>/run.rrd.
        #[arg(value_name = "RUN.rrd")]
        recording: PathBuf,
        /// Write a picture of the last instant to this file instead of opening a window.
        #[arg(long, value_name = "FILE")]
        png: Option<PathBuf>,
    },
    /// Plan ways from posture to posture among boxes.
    ///
    /// Exit codes: 0 all solved; 1 some not, each with its reason; 2 bad input.
    Plan {
        /// Robot, obstacles and problems as JSON.
        #[arg(value_name = "PROBLEM.json")]
        problem: PathBuf,
        /// Print the results as one JSON document on stdout.
        #[arg(long)]
        json: bool,
    },
    /// Random postures of an arm inside its limits: poses of its links, and all postures with the same flange pose.
    Kinematics {
        /// The arm.
        #[arg(value_name = "ARM.urdf")]
        urdf: PathBuf,
        /// How many postures.
        #[arg(long, value_name = "N", default_value_t = 10)]
        samples: usize,
        /// Seed of the postures.
        #[arg(long, value_name = "S", default_value_t = 1)]
        seed: u64,
        /// Print one JSON document on stdout.
        #[arg(long)]
        json: bool,
    },
}

#[derive(Args, Default)]
struct RunArgs {
    /// Scene file; the built-in demo if left out.
    scene: Option<PathBuf>,
    /// Seed of everything random; the scene's own if left out.
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Folder for the results; out/<scene>-<seed> if left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Override a key of the scene, as in camera.noise_mm=1.2. May be given many times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print the report as one JSON document on stdout.
    #[arg(long)]
    json: bool,
    /// Leave run.rrd out: a third faster, nothing to replay.
    #[arg(long)]
    no_recording: bool,
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        None => run::demo(),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Check { files }) => check::check(&files),
        Some(Command::Plan { problem, json }) => plan::plan(&problem, json),
        Some(Command::Kinematics {
            urdf,
            samples,
            seed,
            json,
        }) => kinematics::kinematics(&urdf, samples, seed, json),
        Some(Command::Replay { recording, png }) => replay::replay(&recording, png.as_deref()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
