//! `depal`: a robot cell on your laptop. See the README for what it simulates and what it does not.
// The comments of commands and flags are their help texts: shown as they stand, not as Markdown.
#![allow(rustdoc::broken_intra_doc_links, rustdoc::invalid_html_tags)]

#[macro_use]
mod speak;

mod check;
mod check_language;
mod cloud_picture;
mod detect;
mod diagnostics;
mod exec;
mod exec_network;
mod exec_output;
mod exec_tasks;
mod explain;
mod failure;
mod false_colour;
mod image_file;
mod init;
mod kinematics;
mod listen;
mod output;
mod overlay;
mod plan;
mod progress;
mod render;
mod replay;
mod replay_setup;
mod robot_files;
mod run;
mod sandbox;
mod serve;
mod serve_log;
mod task_folder;
mod task_plan;

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
    /// Check scenes (.toml), arms (.urdf), robot programs (.mod, .sys, .prg, .pgf), configurations (.cfg) and folders
    /// of a task without running them.
    Check {
        /// Files to check. RAPID modules given together are one task.
        #[arg(required = true, value_name = "FILE")]
        files: Vec<PathBuf>,
        /// Print the verdicts and all diagnostics as one JSON document on stdout.
        #[arg(long)]
        json: bool,
        /// Only read robot programs, each file for itself: no names, no types.
        #[arg(long)]
        syntax_only: bool,
    },
    /// Run a robot program on the virtual controller alone, with real sockets, in simulated time.
    ///
    /// stdout has the lines of TPWrite, nothing else. Exit codes: 0 the program ended, stopped, or --max-sim-s
    /// was reached; 1 it stopped on a run-time error; 2 bad input, nothing ran.
    Exec(exec::ExecArgs),
    /// Tell what a message about a robot program means, with an example and its mend.
    Explain {
        /// The code in the message, as in RAPID0104 or 104; without one all codes are listed.
        #[arg(value_name = "CODE")]
        code: Option<String>,
    },
    /// Write sample programs, the interface modules and a scene that runs a sample.
    Init(init::InitArgs),
    /// Take one picture with a scene's camera, cartons at rest, and write what it saw and what was there.
    ///
    /// Writes depth.png (16 bit, 0.1 mm, 0 = invalid), intensity.png, intrinsics.json, truth.json and
    /// cloud.ply (camera frame, metres).
    Render(render::RenderArgs),
    /// Find cartons in a depth image, of any camera: 16-bit PNG, 0 = invalid.
    ///
    /// The pose of a box is the centre of its top face in the camera frame (X right, Y down, Z forward):
    /// Z out of the face, X along the longer side. Exit codes: 0 done, whatever was found; 2 bad input;
    /// 3 a file cannot be written.
    Detect(detect::DetectArgs),
    /// Open a recording in the rerun viewer, or picture it without a display.
    Replay {
        /// The recording, out/<scene>-<seed>/run.rrd.
        #[arg(value_name = "RUN.rrd")]
        recording: PathBuf,
        /// Write a picture of the last instant to this file instead of opening a window.
        #[arg(long, value_name = "FILE")]
        png: Option<PathBuf>,
    },
    /// Be the vision server of a scene: robots and other clients connect over TCP.
    ///
    /// Try it with netcat: depal serve --listen ascii=127.0.0.1:50000, then nc 127.0.0.1 50000 and type 901.
    /// Ends at Ctrl-C or SIGTERM. Exit codes: 0 ended as told, or the replay is equal; 1 the replay differs;
    /// 2 bad input; 3 the machine does not let us (port in use, disk full).
    Serve(ServeArgs),
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
        #[arg(long, value_name = "S", default_value_t = 1, value_parser = run::seed, allow_negative_numbers = true)]
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
    #[arg(long, value_name = "N", value_parser = run::seed, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Folder for the results; out/<scene>-<seed> if left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Override a key of the scene, as in camera.noise_mm=1.2. May be given many times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Make something go wrong: no_points@pick=4, camera_lost@t=10s, status=1019@command=102,n=2,
    /// delay=12s@command=205, drop_connection@reply=7, split_replies. Several with ; or several times.
    #[arg(long, value_name = "FAULT")]
    inject: Vec<String>,
    /// Print the report as one JSON document on stdout.
    #[arg(long)]
    json: bool,
    /// Leave run.rrd out: a third faster, nothing to replay.
    #[arg(long)]
    no_recording: bool,
}

#[derive(Args)]
struct ServeArgs {
    /// Scene file; the built-in demo if left out.
    scene: Option<PathBuf>,
    /// A port: KIND is ascii, hex-le or hex-be; s7-server offers a PLC's data block, s7 works on that of the
    /// PLC at ADDR:PORT?db=1&rack=0&slot=1&poll_ms=20. ADDR may be left out: then only this computer can connect.
    /// May be given many times; each is a session of its own. If left out, the scene's own port.
    #[arg(long, value_name = "KIND=ADDR:PORT")]
    listen: Vec<String>,
    /// Print one line of JSON on stdout when ready: which kind listens where.
    #[arg(long)]
    json: bool,
    /// Override a key of the scene, as in interface.brand=fanuc. May be given many times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Make something go wrong: no_points@pick=4, camera_lost@t=10s, status=1019@command=102,n=2,
    /// delay=12s@command=205, drop_connection@reply=7, split_replies. Several with ; or several times.
    #[arg(long, value_name = "FAULT")]
    inject: Vec<String>,
    /// Show the raw bytes next to what they mean.
    #[arg(short, long)]
    verbose: bool,
    /// Record everything received and sent to this file, as JSON lines.
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
    /// Answer a journal again, without sockets, and tell the first difference.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["listen", "journal"])]
    replay: Option<PathBuf>,
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        None => run::demo(),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Check {
            files,
            json,
            syntax_only,
        }) => check::check(&files, json, syntax_only),
        Some(Command::Exec(args)) => exec::exec(&args),
        Some(Command::Explain { code }) => explain::explain(code.as_deref()),
        Some(Command::Init(args)) => init::init(&args),
        Some(Command::Render(args)) => render::render(&args),
        Some(Command::Detect(args)) => detect::detect(&args),
        Some(Command::Plan { problem, json }) => plan::plan(&problem, json),
        Some(Command::Kinematics {
            urdf,
            samples,
            seed,
            json,
        }) => kinematics::kinematics(&urdf, samples, seed, json),
        Some(Command::Replay { recording, png }) => replay::replay(&recording, png.as_deref()),
        Some(Command::Serve(args)) => serve::serve(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
