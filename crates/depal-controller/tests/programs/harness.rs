use std::sync::Arc;

use depal_arm::Arm;
use depal_controller::{
    Controller, ControllerEvent, ControllerSpec, ControllerState, Network, NoNetwork, SignalKind,
    SignalSpec,
};
use depal_frames::{JointPositions, Vector};
use depal_rapid::{SignalDefinition, TaskEntry};
use depal_time::{SimTime, TICK};
use depal_vm::system::LogKind;
use depal_vm::{Machine, SourceFile};

const IRB6700: &str = include_str!("../../../../urdf/abb_irb6700_150_320.urdf");

/// Data that the programs share. The start is p0 with tool0: 1500, 0, 1500, tool down.
pub const DATA: &str = "
    CONST jointtarget j0 := [[0,0,0,0,90,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
    PERS tooldata tTool := [TRUE,[[0,0,200],[1,0,0,0]],[5,[0,0,50],[1,0,0,0],0,0,0]];
    VAR robtarget p0;
    VAR robtarget pFound;
    VAR triggdata trigg;
    VAR triggdata other;
    VAR clock watch;
    VAR intnum iPassed;
";

/// What a program did.
pub struct Told {
    pub state: ControllerState,
    pub lines: Vec<String>,
    pub events: Vec<ControllerEvent>,
    /// TCP of the flange after each cycle, metres in the base.
    pub trace: Vec<Vector>,
    pub joints: Vec<JointPositions>,
    pub waits_for_ever: bool,
    pub files: std::collections::BTreeMap<String, Vec<u8>>,
}

impl Told {
    /// Instants at which an output changed, with its new value.
    pub fn edges(&self, signal: &str) -> Vec<(f64, f64)> {
        let edge = |event: &ControllerEvent| match event {
            ControllerEvent::SignalEdge { at, name, value } if name == signal => {
                Some((at.as_secs_f64(), *value))
            }
            _ => None,
        };
        self.events.iter().filter_map(edge).collect()
    }

    pub fn edge(&self, signal: &str) -> f64 {
        let edges = self.edges(signal);
        assert!(
            !edges.is_empty(),
            "{signal} never changed: {:?}",
            self.state
        );
        edges[0].0
    }

    /// When the move of a line was over.
    pub fn reached(&self, line: u32) -> f64 {
        self.events
            .iter()
            .find_map(|event| match event {
                ControllerEvent::MoveReached { at, location, .. } if location.line == line => {
                    Some(at.as_secs_f64())
                }
                _ => None,
            })
            .unwrap_or_else(|| panic!("the move of line {line} never ended: {:?}", self.state))
    }

    /// Flange at a time, metres.
    pub fn at(&self, seconds: f64) -> Vector {
        let ticks = seconds / TICK.as_secs_f64();
        let before = (ticks.floor() as usize).min(self.trace.len() - 2);
        self.trace[before].lerp(&self.trace[before + 1], ticks - before as f64)
    }

    pub fn end(&self) -> Vector {
        self.trace[self.trace.len() - 1]
    }

    /// Highest speed of the flange, m/s.
    pub fn top_speed(&self) -> f64 {
        self.trace
            .windows(2)
            .map(|w| (w[1] - w[0]).norm() / TICK.as_secs_f64())
            .fold(0.0, f64::max)
    }

    pub fn finished(self) -> Self {
        assert_eq!(
            self.state,
            ControllerState::Finished,
            "{:?}, for ever {}, {} cycles, {:#?}",
            self.lines,
            self.waits_for_ever,
            self.trace.len(),
            self.events
        );
        self
    }

    /// Name and line of the error that ended the program.
    pub fn failure(&self) -> (String, u32) {
        match &self.state {
            ControllerState::Failed(error) => (error.name.clone(), error.call_stack[0].line),
            other => panic!("expected a failure, found {other:?}"),
        }
    }
}

pub fn arm() -> Arc<Arm> {
    let accelerations = [180.0, 180.0, 180.0, 400.0, 400.0, 500.0].map(f64::to_radians);
    Arc::new(Arm::from_urdf(IRB6700, "abb_irb6700_150_320.urdf", &accelerations).expect("an arm"))
}

pub fn signals() -> Vec<SignalSpec> {
    vec![
        SignalSpec::new("di1", SignalKind::DigitalInput),
        SignalSpec::new("di2", SignalKind::DigitalInput),
        SignalSpec::new("do1", SignalKind::DigitalOutput),
        SignalSpec::new("do2", SignalKind::DigitalOutput),
        SignalSpec::new("go1", SignalKind::GroupOutput { bits: 8 }),
        SignalSpec::new("ao1", SignalKind::AnalogOutput),
        SignalSpec::new("ai1", SignalKind::AnalogInput),
    ]
}

/// Statements in a main that begins at `j0` with `p0` set; they begin on line 1 of the text as given.
pub fn program(statements: &str, more: &str) -> String {
    // One line in front, so that the first statement stands on line 2.
    let data = DATA.replace('\n', " ");
    format!(
        "MODULE m {data} PROC main() p0 := CRobT(\\Tool:=tTool);\n{statements}\nENDPROC\n{more}\nENDMODULE\n"
    )
}

pub fn machine(text: &str) -> Machine {
    machine_of("T_ROB1", text, &TaskEntry::new("main")).single_cycle()
}

/// The machine of a task.
pub fn machine_of(task: &str, text: &str, entry: &TaskEntry<'_>) -> Machine {
    let known: Vec<_> = signals()
        .iter()
        .map(|spec| SignalDefinition {
            name: spec.name.clone(),
            kind: match spec.kind {
                SignalKind::DigitalInput => depal_rapid::SignalKind::Di,
                SignalKind::DigitalOutput => depal_rapid::SignalKind::Do,
                SignalKind::GroupInput { .. } => depal_rapid::SignalKind::Gi,
                SignalKind::GroupOutput { .. } => depal_rapid::SignalKind::Go,
                SignalKind::AnalogInput => depal_rapid::SignalKind::Ai,
                SignalKind::AnalogOutput => depal_rapid::SignalKind::Ao,
            },
        })
        .collect();
    let source = SourceFile::new("m.mod", text);
    let loaded = depal_rapid::load_task(std::slice::from_ref(&source), &known, entry);
    let shown: Vec<_> = loaded
        .diagnostics
        .iter()
        .map(|d| d.plain(std::slice::from_ref(&source)))
        .collect();
    let program = loaded
        .program
        .unwrap_or_else(|| panic!("{}\n{text}", shown.join("\n")));
    Machine::new(program, task)
}

/// Runs statements, with inputs that change at given seconds, for at most a minute of simulated time.
pub fn run_with(statements: &str, more: &str, inputs: &[(f64, &str, f64)]) -> Told {
    run_in(statements, more, inputs, |_| {})
}

/// As `run_with`, in a cabinet that is changed before.
pub fn run_in(
    statements: &str,
    more: &str,
    inputs: &[(f64, &str, f64)],
    change: impl Fn(&mut ControllerSpec),
) -> Told {
    let text = program(statements, more);
    let home = JointPositions::from_degrees(&[0.0, 0.0, 0.0, 0.0, 90.0, 0.0]);
    let mut spec = ControllerSpec::new("rob1", arm(), home);
    spec.signals = signals();
    change(&mut spec);
    let mut controller = Controller::new(spec).expect("a cabinet");
    controller.set_task(Box::new(machine(&text)));
    drive(controller, inputs)
}

pub fn drive(controller: Controller, inputs: &[(f64, &str, f64)]) -> Told {
    drive_on(controller, inputs, &mut NoNetwork, 60.0)
}

/// As `drive`, with something behind the sockets, for so many simulated seconds.
pub fn drive_on(
    mut controller: Controller,
    inputs: &[(f64, &str, f64)],
    network: &mut dyn Network,
    limit: f64,
) -> Told {
    let flange = |controller: &Controller, joints: &JointPositions| match controller.arm() {
        Some(arm) => arm.base_from_flange(joints).translation.vector,
        None => Vector::new(joints[0], joints[1], joints[2]),
    };
    let mut told = Told {
        state: ControllerState::Idle,
        lines: Vec::new(),
        events: Vec::new(),
        trace: Vec::new(),
        joints: Vec::new(),
        waits_for_ever: false,
        files: std::collections::BTreeMap::new(),
    };
    let mut inputs = inputs.to_vec();
    let mut now = SimTime::ZERO;
    while now.as_secs_f64() < limit {
        let joints = controller.commanded_joints();
        told.joints.push(joints);
        told.trace.push(flange(&controller, &joints));
        inputs.retain(|(at, name, value)| {
            let due = *at <= now.as_secs_f64() + 1e-9;
            if due {
                controller.set_input(name, *value).expect("an input");
            }
            !due
        });
        controller.tick(now, network);
        now += TICK;
        while let Some(event) = controller.poll_event() {
            if let ControllerEvent::Log {
                kind: LogKind::Operator,
                text,
                ..
            } = &event
            {
                told.lines.push(text.clone());
            }
            told.events.push(event);
        }
        if *controller.state() != ControllerState::Running && controller.is_standing() {
            break;
        }
        if controller.waits_for_ever() && inputs.is_empty() {
            told.waits_for_ever = true;
            break;
        }
    }
    let joints = controller.commanded_joints();
    told.joints.push(joints);
    told.trace.push(flange(&controller, &joints));
    told.state = controller.state().clone();
    told.files.clone_from(controller.files());
    told
}

pub fn run(statements: &str) -> Told {
    run_with(statements, "", &[])
}
