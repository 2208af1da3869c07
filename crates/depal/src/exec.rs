//! `depal exec`: a robot program on the virtual controller alone, with real sockets.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::Args;
use depal_arm::Arm;
use depal_controller::{Controller, ControllerSpec, ControllerState, SignalKind, SignalSpec};
use depal_frames::JointPositions;
use depal_net::robot_sockets::HostPort;
use depal_scene::Language;
use depal_time::{SimDuration, SimTime, TICK};

use crate::exec_network::ProgramNetwork;
use crate::exec_output::{End, Output, Place};
use crate::exec_tasks::{Tasks, language, load};
use crate::failure::Failure;
use crate::sandbox::Sandbox;
use crate::task_folder::read;

/// Joint accelerations of an arm from a bare URDF, which has none: rad/s^2, a common figure of large arms.
const NOMINAL_ACCELERATION: f64 = 10.0;

/// Arguments of `depal exec`.
#[derive(Args)]
pub struct ExecArgs {
    /// RAPID modules of one task (.mod, .sys, .prg, .modx, .sysx), in any order, a list of them (.pgf), configuration
    /// files (.cfg), or a folder with all of these, as a controller backup is; or KRL files (.src, .dat, and .sub,
    /// each a task beside the robot's); or TP listings (.ls).
    #[arg(required = true, value_name = "PROGRAM")]
    pub(crate) programs: Vec<PathBuf>,
    /// I/O configuration of the controller: its signals and cross connections.
    #[arg(long, value_name = "EIO.cfg")]
    pub(crate) io: Option<PathBuf>,
    /// The arm: six revolute joints, flange at the link tool0. Without it every target is reachable.
    #[arg(long, value_name = "URDF", conflicts_with = "no_kinematics")]
    robot: Option<PathBuf>,
    /// Take every target as reachable; no arm is needed.
    #[arg(long)]
    no_kinematics: bool,
    /// Write every event to this file, one JSON document a line.
    #[arg(long, value_name = "FILE.jsonl")]
    trace: Option<PathBuf>,
    /// End after so many simulated seconds.
    #[arg(long, value_name = "S", value_parser = seconds, allow_negative_numbers = true)]
    max_sim_s: Option<f64>,
    /// Print one JSON document on stdout at the end instead of the lines of TPWrite.
    #[arg(long)]
    json: bool,
    /// Make the signals that the program uses and nobody defined, with value 0.
    #[arg(long)]
    pub(crate) auto_signals: bool,
    /// The procedure to start, of the task that moves the robot. Default: that of the task in a SYS.cfg, else main; in
    /// KRL and TP the program that has the name of the first file.
    #[arg(long, value_name = "PROC")]
    pub(crate) entry: Option<String>,
    /// Folder of the program's files (HOME:): read at the start; what the program writes is written there at the end.
    /// Without it files live in memory only, and a backup's HOME folder is read but never written.
    #[arg(long, value_name = "DIR")]
    home: Option<PathBuf>,
    /// Write what goes over the program's client sockets to this file.
    #[arg(long, value_name = "FILE", conflicts_with = "replay_sockets")]
    pub(crate) record_sockets: Option<PathBuf>,
    /// Play the other side of a file that --record-sockets wrote, without a network. A program that sends something
    /// else than then finds the connection closed, and the difference is told at the end.
    #[arg(long, value_name = "FILE", conflicts_with = "connect")]
    pub(crate) replay_sockets: Option<PathBuf>,
    /// Run only the task of this number of a controller backup (RAPID/TASKn). Default: all that its SYS.cfg names.
    #[arg(long, value_name = "N")]
    pub(crate) task: Option<usize>,
    /// Send connections to the first address to the second. May be given many times.
    #[arg(long, value_name = "HOST:PORT=HOST:PORT", value_parser = route)]
    pub(crate) connect: Vec<(HostPort, HostPort)>,
    /// Set an input at a simulated time. May be given many times.
    #[arg(long, value_name = "NAME=VALUE@SECONDS", value_parser = input_change)]
    set_di: Vec<InputChange>,
    /// Configuration of an Ethernet channel of a KRL program; its name is that of the file. May be given many times.
    #[arg(long, value_name = "FILE.xml")]
    pub(crate) eki: Vec<PathBuf>,
    /// Value of a numeric register of a TP program at the start. May be given many times.
    #[arg(long, value_name = "N=VALUE", value_parser = depal_tp::parse_preset)]
    pub(crate) set_r: Vec<(u32, f64)>,
    /// Print the numeric registers that a TP program wrote, one R[n]=value a line.
    #[arg(long)]
    pub(crate) print_registers: bool,
    /// Let the vision calls of a TP program send the least significant byte first, as controllers of version 10 do.
    #[arg(long)]
    pub(crate) little_endian: bool,
    /// Answers to the operator's instructions, one a line, in order; lines that begin with # are passed over.
    #[arg(long, value_name = "FILE")]
    ui_answers: Option<PathBuf>,
}

/// An input that changes at a time.
#[derive(Debug, Clone)]
struct InputChange {
    name: String,
    value: f64,
    at: SimTime,
}

fn seconds(text: &str) -> Result<f64, String> {
    text.parse()
        .map_err(|_| "expected seconds above 0".to_owned())
}

fn host_port(text: &str) -> Result<HostPort, String> {
    let wrong = || format!("expected HOST:PORT with a port of 0 to 65535, found {text:?}");
    let (host, port) = text.rsplit_once(':').ok_or_else(wrong)?;
    let port = port.parse().map_err(|_| wrong())?;
    Ok((host.to_owned(), port))
}

fn route(text: &str) -> Result<(HostPort, HostPort), String> {
    let (from, to) = text
        .split_once('=')
        .ok_or("expected HOST:PORT=HOST:PORT".to_owned())?;
    Ok((host_port(from)?, host_port(to)?))
}

fn input_change(text: &str) -> Result<InputChange, String> {
    let wrong = || format!("{text:?}: expected NAME=VALUE@SECONDS, as in di_start=1@2.5");
    let (name, rest) = text.split_once('=').ok_or_else(wrong)?;
    let (value, at) = rest.split_once('@').ok_or_else(wrong)?;
    let at: f64 = at.trim().parse().map_err(|_| wrong())?;
    if !(0.0..=1e9).contains(&at) {
        return Err(format!("expected a time of 0 to 1000000000 s, found {at}"));
    }
    Ok(InputChange {
        name: name.trim().to_owned(),
        value: value.trim().parse().map_err(|_| wrong())?,
        at: SimTime::ZERO + SimDuration::from_secs_f64(at),
    })
}

/// Runs the program.
pub fn exec(args: &ExecArgs) -> Result<(), Failure> {
    let begun = Instant::now();
    let language = language(&args.programs)?;
    let mut output = Output::open(args.json, args.trace.as_deref())?;
    output.has_operator_lines = language == Language::Rapid;
    match prepare(args, language) {
        Ok(prepared) => run(args, prepared, output, begun),
        Err(failure) => {
            let message = match &failure {
                Failure::Input(message) => message.clone(),
                _ => String::new(),
            };
            output.invalid(&message, begun.elapsed());
            Err(failure)
        }
    }
}

/// A cabinet that is ready to run.
struct Prepared {
    controller: Controller,
    changes: Vec<InputChange>,
    sandbox: Sandbox,
    /// The registers to be shown at the end.
    registers: Option<depal_tp::RegisterView>,
}

/// Everything that can be wrong before anything runs.
fn prepare(args: &ExecArgs, language: Language) -> Result<Prepared, Failure> {
    if let Some(limit) = args.max_sim_s
        && !(limit > 0.0 && limit <= 1e9)
    {
        return Err(Failure::Input(format!(
            "--max-sim-s is {limit}, expected seconds above 0"
        )));
    }
    let Tasks {
        tasks,
        mut io,
        families,
        home,
        configuration,
        registers,
    } = load(args, language)?;
    let mut changes = args.set_di.clone();
    changes.sort_by_key(|change| change.at);
    if args.auto_signals {
        for change in &changes {
            let defined = |s: &SignalSpec| s.name.eq_ignore_ascii_case(&change.name);
            if !io.signals.iter().any(defined) {
                let kind = SignalKind::DigitalInput;
                io.signals.push(SignalSpec::new(&change.name, kind));
            }
        }
    }
    for change in &changes {
        let found = io
            .signals
            .iter()
            .find(|s| s.name.eq_ignore_ascii_case(&change.name));
        let is_numbered = families
            .iter()
            .any(|family| family.kind.is_input() && family.has(&change.name));
        if !is_numbered && found.is_none_or(|signal| !signal.kind.is_input()) {
            return Err(Failure::Input(format!(
                "--set-di {}: there is no such input; define it in the file of --io",
                change.name
            )));
        }
    }
    let answers = match &args.ui_answers {
        None => VecDeque::new(),
        Some(path) => depal_rapid::decode(&read(path)?)
            .lines()
            .filter(|line| !line.starts_with('#'))
            .map(str::to_owned)
            .collect(),
    };
    let sandbox = Sandbox::read(args.home.as_deref(), &home)?;
    let invalid = |error: depal_controller::ControllerError| Failure::Input(error.to_string());
    let mut controller = match &args.robot {
        None => {
            let mut spec = ControllerSpec::without_arm("ROB_1");
            spec.signals = io.signals;
            spec.families = families;
            spec.connections = io.connections;
            spec.answers = answers;
            spec.files = sandbox.files().clone();
            spec.configuration = configuration;
            Controller::without_arm(spec).map_err(invalid)?
        }
        Some(path) => {
            let text = depal_rapid::decode(&read(path)?);
            let arm = Arm::from_urdf(&text, &path.to_string_lossy(), &[NOMINAL_ACCELERATION; 6])
                .map_err(|error| Failure::Input(error.to_string()))?;
            let start: Vec<f64> = arm
                .limits()
                .iter()
                .map(|limit| 0f64.clamp(limit.lower, limit.upper))
                .collect();
            let start = JointPositions::from_slice(&start);
            let mut spec = ControllerSpec::new("ROB_1", Arc::new(arm), start);
            spec.signals = io.signals;
            spec.families = families;
            spec.connections = io.connections;
            spec.answers = answers;
            spec.files = sandbox.files().clone();
            spec.configuration = configuration;
            Controller::new(spec).map_err(invalid)?
        }
    };
    for (role, task) in tasks {
        controller.add_task(role, task);
    }
    Ok(Prepared {
        controller,
        changes,
        sandbox,
        registers,
    })
}

fn run(
    args: &ExecArgs,
    prepared: Prepared,
    mut output: Output,
    begun: Instant,
) -> Result<(), Failure> {
    let Prepared {
        mut controller,
        changes,
        sandbox,
        registers,
    } = prepared;
    let mut network = ProgramNetwork::open(args)?;
    let limit = args
        .max_sim_s
        .map(|s| SimTime::ZERO + SimDuration::from_secs_f64(s));
    let mut changes = changes.into_iter().peekable();
    let mut now = SimTime::ZERO;
    let end = loop {
        // A change in the middle of a tick is seen from the next tick on.
        while let Some(change) = changes.next_if(|change| change.at <= now) {
            controller
                .set_input(&change.name, change.value)
                .map_err(|fault| Failure::Input(format!("--set-di {}: {fault:?}", change.name)))?;
        }
        controller.tick(now, network.as_network());
        let tick_begin = now;
        now += TICK;
        while let Some(event) = controller.poll_event() {
            output.event(&event)?;
        }
        match controller.state() {
            ControllerState::Running => {}
            // Queued moves are carried out to their end.
            ControllerState::Finished if !controller.is_standing() => continue,
            ControllerState::Finished => break End::Ended,
            ControllerState::Stopped(_) => break End::Stopped,
            ControllerState::Failed(error) => break End::Failed(Place::of(error)),
            ControllerState::Idle => break End::Idle,
        }
        if limit.is_some_and(|limit| now >= limit) {
            break End::TimeLimit;
        }
        if controller.waits_for_ever() && changes.peek().is_none() {
            break End::Idle;
        }
        let ahead = now.saturating_since(tick_begin);
        network.wait(Duration::from_nanos(ahead.as_nanos()));
    };
    network.close(args)?;
    sandbox.write(controller.files())?;
    output.registers = registers.map(|view| view.written_registers());
    output.finish(&end, now, begun.elapsed())?;
    match end {
        End::Failed(_) => Err(Failure::Told(1)),
        _ => Ok(()),
    }
}
