//! The tasks of a program that `depal exec` runs, in whichever language it is written.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use depal_controller::{
    ConfigurationData, EioConfiguration, SignalFamily, SignalKind, SignalSpec, TaskRole,
};
use depal_rapid::SignalDefinition;
use depal_scene::Language;
use depal_vm::execution::RobotTask;
use depal_vm::{Diagnostic, Machine, Program, Severity, SourceFile};

use crate::diagnostics::tell_all;
use crate::exec::ExecArgs;
use crate::failure::Failure;
use crate::task_folder::{ControllerFiles, TaskFiles, extension, read};
use crate::task_plan::plan;

/// Bits of a group signal that `--auto-signals` makes: as many as RAPID's num holds exactly.
const AUTO_GROUP_BITS: u8 = 23;

/// What the cabinet is to run.
pub struct Tasks {
    /// Each task with what it is to the cabinet.
    pub tasks: Vec<(TaskRole, Box<dyn RobotTask>)>,
    /// Signals and cross connections.
    pub io: EioConfiguration,
    /// Signals that need no definition.
    pub families: Vec<SignalFamily>,
    /// Files of the program's folder, with their path in it.
    pub home: Vec<(String, PathBuf)>,
    /// What the controller's configuration files say.
    pub configuration: ConfigurationData,
    /// The registers of a TP program, if they are to be shown.
    pub registers: Option<depal_tp::RegisterView>,
}

/// The one language of all files; folders and configurations are those of RAPID controllers.
pub fn language(programs: &[PathBuf]) -> Result<Language, Failure> {
    let mut found: Option<(Language, &Path)> = None;
    for path in programs {
        let Some(language) = Language::of(&path.to_string_lossy()) else {
            continue;
        };
        match found {
            Some((first, other)) if first != language => {
                return Err(Failure::Input(format!(
                    "{} is {}, {} is {}: the files of one task have one language",
                    other.display(),
                    first.name(),
                    path.display(),
                    language.name()
                )));
            }
            _ => found = Some((language, path)),
        }
    }
    Ok(found.map_or(Language::Rapid, |(language, _)| language))
}

/// Loads everything; the messages are told on the way.
pub fn load(args: &ExecArgs, language: Language) -> Result<Tasks, Failure> {
    match language {
        Language::Rapid => {
            refuse(args, "--eki", !args.eki.is_empty(), language)?;
            refuse(args, "--set-r", !args.set_r.is_empty(), language)?;
            refuse(args, "--print-registers", args.print_registers, language)?;
            rapid(args)
        }
        Language::Krl => {
            refuse(args, "--set-r", !args.set_r.is_empty(), language)?;
            refuse(args, "--print-registers", args.print_registers, language)?;
            krl(args)
        }
        Language::Tp => {
            refuse(args, "--eki", !args.eki.is_empty(), language)?;
            tp(args)
        }
    }
}

fn refuse(args: &ExecArgs, flag: &str, given: bool, language: Language) -> Result<(), Failure> {
    if !given {
        return Ok(());
    }
    let belongs_to = if flag == "--eki" {
        "KRL (.src)"
    } else {
        "TP (.ls)"
    };
    Err(Failure::Input(format!(
        "{flag} belongs to {belongs_to}, and {} is {}",
        args.programs[0].display(),
        language.name()
    )))
}

fn rapid(args: &ExecArgs) -> Result<Tasks, Failure> {
    let mut files = TaskFiles::find(&args.programs, args.task)?;
    if let Some(other) = files.others.first() {
        let advice = match extension(other).as_str() {
            "toml" => "; a scene runs with `depal run`",
            _ => "",
        };
        return Err(Failure::Input(format!(
            "{}: expected a module (.mod, .sys, .prg, .modx, .sysx), a program list (.pgf), a configuration (.cfg), \
             a folder, KRL (.src, .dat) or TP (.ls){advice}",
            other.display()
        )));
    }
    files.configurations.extend(args.io.clone());
    let ControllerFiles {
        mut io,
        system,
        data,
        ..
    } = ControllerFiles::read(&files.configurations)?;
    let mut plans = plan(&files, &system, args.task)?;
    if let (Some(entry), Some(first)) = (&args.entry, plans.first_mut()) {
        first.entry.clone_from(entry);
    }
    let mut programs = Vec::new();
    let mut problems = 0;
    for plan in &plans {
        let known: Vec<_> = io.signals.iter().map(definition).collect();
        let (loaded, added) = plan.load(&system, &known, args.auto_signals);
        io.signals.extend(added.iter().map(auto_signal));
        plan.tell(&loaded);
        match loaded.program {
            Some(program) => programs.push(with_retry_limit(program, system.retry_limit)),
            None => problems += loaded.diagnostics.len(),
        }
    }
    if problems > 0 {
        return Err(not_started(problems));
    }
    let tasks = plans
        .iter()
        .zip(programs)
        .map(|(plan, program)| {
            let machine: Box<dyn RobotTask> = Box::new(plan.machine(program));
            (plan.role.clone(), machine)
        })
        .collect();
    Ok(Tasks {
        tasks,
        io,
        families: Vec::new(),
        home: files.home,
        configuration: data,
        registers: None,
    })
}

/// All files with the text of each, and the signals of the file of `--io`.
fn texts(
    args: &ExecArgs,
    decode: fn(&[u8]) -> String,
) -> Result<(Vec<SourceFile>, EioConfiguration), Failure> {
    let sources = args.programs.iter().map(|path| {
        if path.is_dir() {
            return Err(Failure::Input(format!(
                "{}: expected the files themselves, found a folder",
                path.display()
            )));
        }
        Ok(SourceFile::new(
            path.to_string_lossy(),
            decode(&read(path)?),
        ))
    });
    let sources = sources.collect::<Result<_, Failure>>()?;
    let configurations: Vec<_> = args.io.clone().into_iter().collect();
    Ok((sources, ControllerFiles::read(&configurations)?.io))
}

fn krl(args: &ExecArgs) -> Result<Tasks, Failure> {
    let (mut sources, io) = texts(args, depal_krl::decode)?;
    for path in &args.eki {
        let text = depal_krl::decode(&read(path)?);
        sources.push(SourceFile::new(path.to_string_lossy(), text));
    }
    let is_channel = |source: &SourceFile| source.name.to_ascii_lowercase().ends_with(".xml");
    sources.sort_by_key(is_channel);
    let (programs, channels) = sources.split_at(sources.partition_point(|s| !is_channel(s)));
    let is_code = |source: &&SourceFile| source.name.to_ascii_lowercase().ends_with(".src");
    let entry = args.entry.clone().unwrap_or_else(|| {
        let first = programs.iter().find(is_code).or(programs.first());
        first.map_or_else(|| "main".to_owned(), |source| stem(&source.name))
    });
    let load = |entry: &str| {
        let loaded = depal_krl::load_with_any_signals(programs, entry);
        depal_krl::with_channels(loaded, programs.len(), channels)
    };
    let robot = load(&entry);
    let mut tasks = vec![krl_task(robot, TaskRole::motion("ROBOT"), &sources)?];
    // Every .sub file runs beside the robot, unless it is itself what is started.
    let submits = programs.iter().filter(|source| is_submit(source));
    let submits = submits.map(|source| stem(&source.name));
    for name in submits.filter(|name| !name.eq_ignore_ascii_case(&entry)) {
        let role = TaskRole::background(&format!("SUBMIT {}", name.to_uppercase()));
        tasks.push(krl_task(load(&name), role, &sources)?);
    }
    Ok(Tasks {
        tasks,
        io,
        families: Language::Krl.signal_families(),
        home: Vec::new(),
        configuration: ConfigurationData::default(),
        registers: None,
    })
}

fn is_submit(source: &SourceFile) -> bool {
    source.name.to_ascii_lowercase().ends_with(".sub")
}

/// A task of a program, after all messages about it were told. Those of a task in the background were told with
/// the robot's, but for what is wrong with its entry.
fn krl_task(
    mut loaded: depal_krl::Loaded,
    role: TaskRole,
    sources: &[SourceFile],
) -> Result<(TaskRole, Box<dyn RobotTask>), Failure> {
    if role.is_background {
        let is_error = |diagnostic: &Diagnostic| diagnostic.severity == Severity::Error;
        loaded.diagnostics.retain(is_error);
    }
    let program = good(loaded.program, &loaded.diagnostics, sources)?;
    let machine = Machine::new(program, &role.name).single_cycle();
    Ok((role, Box::new(machine)))
}

fn tp(args: &ExecArgs) -> Result<Tasks, Failure> {
    let (sources, io) = texts(args, depal_tp::decode)?;
    let entry = args
        .entry
        .clone()
        .unwrap_or_else(|| stem(&sources[0].name).to_uppercase());
    let options = depal_tp::Options {
        registers: args.set_r.clone(),
        byte_order: if args.little_endian {
            depal_tp::ByteOrder::LittleEndian
        } else {
            depal_tp::ByteOrder::BigEndian
        },
        ..depal_tp::Options::default()
    };
    let loaded = depal_tp::load(&sources, &options, &entry);
    let program = good(loaded.program, &loaded.diagnostics, &sources)?;
    let mut tasks = depal_tp::Tasks::new(program, "MAIN");
    let registers = args.print_registers.then(|| tasks.view());
    Ok(Tasks {
        tasks: vec![(TaskRole::motion("MAIN"), Box::new(tasks))],
        io,
        families: Language::Tp.signal_families(),
        home: Vec::new(),
        configuration: ConfigurationData::default(),
        registers,
    })
}

/// The program, after all messages about it were told.
fn good(
    program: Option<Arc<Program>>,
    diagnostics: &[Diagnostic],
    sources: &[SourceFile],
) -> Result<Arc<Program>, Failure> {
    tell_all(diagnostics, sources);
    program.ok_or_else(|| not_started(diagnostics.len()))
}

fn stem(path: &str) -> String {
    let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
    name.rsplit_once('.')
        .map_or(name, |(stem, _)| stem)
        .to_owned()
}

fn not_started(problems: usize) -> Failure {
    Failure::Input(format!(
        "the program was not started: {problems} problem(s) found"
    ))
}

/// A signal as programs are checked against it.
pub fn definition(spec: &SignalSpec) -> SignalDefinition {
    use depal_rapid::SignalKind as Rapid;
    SignalDefinition {
        name: spec.name.clone(),
        kind: match spec.kind {
            SignalKind::DigitalInput => Rapid::Di,
            SignalKind::DigitalOutput => Rapid::Do,
            SignalKind::GroupInput { .. } => Rapid::Gi,
            SignalKind::GroupOutput { .. } => Rapid::Go,
            SignalKind::AnalogInput => Rapid::Ai,
            SignalKind::AnalogOutput => Rapid::Ao,
        },
    }
}

fn auto_signal(definition: &SignalDefinition) -> SignalSpec {
    use depal_rapid::SignalKind as Rapid;
    let bits = AUTO_GROUP_BITS;
    let kind = match definition.kind {
        Rapid::Di => SignalKind::DigitalInput,
        Rapid::Do => SignalKind::DigitalOutput,
        Rapid::Gi => SignalKind::GroupInput { bits },
        Rapid::Go => SignalKind::GroupOutput { bits },
        Rapid::Ai => SignalKind::AnalogInput,
        Rapid::Ao => SignalKind::AnalogOutput,
    };
    SignalSpec::new(&definition.name, kind)
}

/// The program with the number of retries that the controller is configured for.
fn with_retry_limit(program: Arc<Program>, limit: Option<u32>) -> Arc<Program> {
    let Some(limit) = limit else {
        return program;
    };
    let mut program = Arc::unwrap_or_clone(program);
    program.rules.retry_limit = limit;
    Arc::new(program)
}
