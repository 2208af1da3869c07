//! The vision computer: the server's brain, the planning project's engine, and the work they ask for.
//! Each result is handed over when its simulated time has come.

use std::collections::{BTreeMap, BTreeSet};

use depal_frames::{BoxSize, JointPositions};
use depal_interface::{
    Direction, Job, JobId, PortId, RobotPose, Server, Status, VisionPoint, VizPath,
};
use depal_time::{SimTime, TICK};
use depal_workflow::{Ask, Engine, Piece};

use crate::calibration_desk::CalibrationDesk;
use crate::computing::{Computing, Elsewhere};
use crate::error::CellError;
use crate::event::{EventKind, FailureReason};
use crate::link::{Link, ToServer};
use crate::observer::Observer;
use crate::picture::{Picture, Seen, take_picture};
use crate::planning::{Planned, PlannedPick, Situation, plan};
use crate::score::Score;
use crate::spec::{CellSpec, VisionProject};
use crate::waypoints::{Joined, end_of, join};

/// The one port of the in-process link.
const PORT: PortId = PortId(0);

/// Who waits for a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Owner {
    /// A run of a vision project (command 101).
    Vision(JobId),
    /// The run of the planning project (command 201).
    Viz(JobId),
}

/// Work whose simulated time runs.
pub(crate) enum Work {
    /// The shutter opens at its due time.
    Exposure {
        owner: Owner,
        project: VisionProject,
    },
    /// The poses are there at their due time.
    Poses { owner: Owner, picture: Picture },
    /// The path is there at its due time.
    Path { owner: Owner, planned: Planned },
    /// Poses or a path that are computed elsewhere meanwhile.
    Computing { owner: Owner, result: Computing },
}

/// A run of steps: the planning project's, or those of a vision project that plans a path.
struct StepRun {
    owner: Owner,
    engine: Engine<PlannedPick>,
    start: JointPositions,
    box_sizes: Vec<(i32, BoxSize)>,
    recipes: Vec<(i32, i32)>,
    picture: Option<Picture>,
    /// Reports of the picture that have their path.
    taken: BTreeSet<usize>,
}

/// The vision computer of a cell.
pub(crate) struct VisionSide {
    pub(crate) server: Server,
    /// The planning project before its runs.
    engine: Engine<PlannedPick>,
    /// The path steps of vision projects before their runs.
    path_engines: BTreeMap<i32, Engine<PlannedPick>>,
    runs: Vec<StepRun>,
    work: Vec<(SimTime, Work)>,
    frames: u32,
    picks_planned: i32,
    target: Option<u32>,
    last_failure: Option<FailureReason>,
    /// Status codes of the replies to the last exchange: what a program that stops has heard.
    last_status: Option<i32>,
    stopwatch: fn() -> f64,
    /// Where long computing is done; absent: here and now.
    pub(crate) elsewhere: Option<Elsewhere>,
    /// The calibration with command 701.
    pub(crate) calibration: CalibrationDesk,
}

impl VisionSide {
    pub(crate) fn new(spec: &CellSpec, stopwatch: fn() -> f64) -> Result<Self, CellError> {
        let projects: Vec<i32> = spec.projects.keys().copied().collect();
        let engine = |project: &depal_workflow::Project| {
            Engine::new(project.clone(), &projects)
                .map_err(|error| CellError::Workflow(error.to_string()))
        };
        let mut path_engines = BTreeMap::new();
        for (id, project) in &spec.projects {
            if let Some(path) = &project.path {
                path_engines.insert(*id, engine(path)?);
            }
        }
        Ok(Self {
            server: Server::new(spec.interface.clone())?,
            engine: engine(&spec.workflow)?,
            path_engines,
            runs: Vec::new(),
            work: Vec::new(),
            frames: 0,
            picks_planned: 0,
            target: None,
            last_failure: None,
            last_status: None,
            stopwatch,
            elsewhere: None,
            calibration: CalibrationDesk::default(),
        })
    }

    /// The carton that the path sent last aims at, by truth.
    pub(crate) fn target_carton(&self) -> Option<u32> {
        self.target
    }

    /// Why the last run of the planning project gave no path.
    pub(crate) fn last_failure(&self) -> Option<FailureReason> {
        self.last_failure
    }

    /// The dialogue's share in a program's stop: an error of the wire, or what kept a path from being planned.
    pub(crate) fn dialogue_failure(&self) -> Option<FailureReason> {
        match self.last_status {
            Some(3000..=3099) => Some(FailureReason::ProtocolError),
            Some(1019 | 2025) => Some(FailureReason::Timeout),
            Some(status) if (1000..1100).contains(&status) || (2000..2100).contains(&status) => {
                self.last_failure.or(Some(FailureReason::ProtocolError))
            }
            _ => None,
        }
    }

    /// Messages both ways, then the jobs that follow from them.
    pub(crate) fn exchange(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        link: &mut Link,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        while let Some((connection, message)) = link.next_for_server(now) {
            match message {
                ToServer::Connect => self.server.handle_connect(now, PORT, connection),
                ToServer::Bytes(bytes) => self.server.handle_input(now, PORT, connection, &bytes),
                ToServer::Disconnect => self.server.handle_disconnect(now, PORT, connection),
            }
        }
        if self.server.poll_timeout().is_some_and(|due| due <= now) {
            self.server.handle_timeout(now);
        }
        self.take_jobs(now, spec, score, events);
        while let Some(reply) = self.server.poll_reply() {
            link.send_to_robot(now, reply.connection, reply.bytes);
        }
        while let Some(entry) = self.server.poll_log() {
            let from = match entry.direction {
                Direction::Received => {
                    *score.commands.entry(entry.command).or_insert(0) += 1;
                    "robot"
                }
                Direction::Sent => {
                    self.last_status = entry.status.or(self.last_status);
                    if let Some(status) = entry.status {
                        *score.statuses.entry(status).or_insert(0) += 1;
                    }
                    "vision"
                }
            };
            events.push(EventKind::Protocol {
                from,
                command: entry.command,
                status: entry.status,
                text: entry.text,
            });
        }
    }

    /// Starts the work that the server asks for.
    pub(crate) fn take_jobs(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        while let Some(job) = self.server.poll_job() {
            match job {
                Job::RunVision {
                    job_id,
                    project,
                    recipe,
                    box_size,
                    pose,
                } => {
                    let owner = Owner::Vision(job_id);
                    if let Some(engine) = self.path_engines.get(&project) {
                        let run = StepRun {
                            owner,
                            engine: engine.clone(),
                            start: start_of(spec, &pose),
                            box_sizes: box_size.map(|size| (project, size)).into_iter().collect(),
                            recipes: recipe.map(|recipe| (project, recipe)).into_iter().collect(),
                            picture: None,
                            taken: BTreeSet::new(),
                        };
                        self.begin(now, spec, run, score, events);
                    } else {
                        let project = configured(spec, project, recipe, box_size);
                        self.expose(now, spec, owner, project, score, events);
                    }
                }
                Job::StartViz {
                    job_id,
                    start,
                    box_sizes,
                    recipes,
                } => {
                    let home = JointPositions::zeros(spec.arm.joint_count());
                    let run = StepRun {
                        owner: Owner::Viz(job_id),
                        engine: self.engine.clone(),
                        start: start.unwrap_or(home),
                        box_sizes,
                        recipes,
                        picture: None,
                        taken: BTreeSet::new(),
                    };
                    self.begin(now, spec, run, score, events);
                }
                Job::StopViz { job_id } => self.stop_viz(job_id),
                // The workflow has no step yet that takes one of these, and the settings register none:
                // the server refuses their commands, except 502, whose pose nothing uses.
                Job::SetIndex { .. }
                | Job::WriteParameter { .. }
                | Job::SetOuterPose { .. }
                | Job::SetInputPose { .. }
                | Job::SetVariable { .. }
                | Job::SwitchSolution { .. } => {}
                Job::CaptureCalibration {
                    number,
                    base_from_flange,
                    ..
                } => self.calibration.ask(now, number, base_from_flange),
                Job::SetBranch { job_id, exit, .. } => {
                    let owner = Owner::Viz(job_id);
                    if let Some(run) = self.run_of(owner) {
                        let ask = run.engine.branch(exit);
                        self.follow(now, spec, owner, ask, score, events);
                    }
                }
            }
        }
    }

    fn run_of(&mut self, owner: Owner) -> Option<&mut StepRun> {
        self.runs.iter_mut().find(|run| run.owner == owner)
    }

    fn begin(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        mut run: StepRun,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let (owner, ask) = (run.owner, run.engine.start());
        self.runs.push(run);
        self.follow(now, spec, owner, ask, score, events);
    }

    fn end(&mut self, owner: Owner) -> Option<StepRun> {
        let place = self.runs.iter().position(|run| run.owner == owner)?;
        Some(self.runs.remove(place))
    }

    fn stop_viz(&mut self, job_id: JobId) {
        let stopped = Owner::Viz(job_id);
        if self.end(stopped).is_some() {
            self.work.retain(|(_, work)| match work {
                Work::Exposure { owner, .. }
                | Work::Poses { owner, .. }
                | Work::Computing { owner, .. }
                | Work::Path { owner, .. } => *owner != stopped,
            });
        }
    }

    /// Does what a run's engine asks for until it has to wait.
    fn follow(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        mut ask: Ask<PlannedPick>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let (picks_planned, stopwatch) = (self.picks_planned, self.stopwatch);
        let elsewhere = self.elsewhere.clone();
        loop {
            let Some(run) = self.run_of(owner) else {
                return;
            };
            ask = match ask {
                Ask::Recognise {
                    may_reuse: true, ..
                } if run.picture.is_some() => {
                    let seen = run.picture.as_ref().map_or(0, |p| p.detection.boxes.len());
                    let status = Status::VizNoVisionResult.code();
                    let is_left = run.taken.len() < seen;
                    run.engine.recognised(is_left.then_some(()).ok_or(status))
                }
                Ask::Recognise { project, .. } => {
                    let value_of = |list: &[(i32, i32)]| {
                        list.iter().find(|(id, _)| *id == project).map(|(_, v)| *v)
                    };
                    let recipe = value_of(&run.recipes);
                    let size = run
                        .box_sizes
                        .iter()
                        .find(|(id, _)| *id == project)
                        .map(|(_, size)| *size);
                    let project = configured(spec, project, recipe, size);
                    return self.expose(now, spec, owner, project, score, events);
                }
                Ask::PlanPick { pick, place } => {
                    let Some(picture) = &run.picture else {
                        return;
                    };
                    let planned = match end_of(spec, &run.start, run.engine.pieces()) {
                        Ok(start) if let Some(elsewhere) = &elsewhere => {
                            let (picture, taken) = (picture.clone(), run.taken.clone());
                            let result = elsewhere.compute(move |spec, score, events| {
                                let situation = Situation {
                                    picture: &picture,
                                    taken: &taken,
                                    start,
                                    picked_before: picks_planned,
                                };
                                let planned =
                                    plan(spec, &situation, &pick, place, stopwatch, score, events);
                                Work::Path { owner, planned }
                            });
                            let due = (now + spec.latencies.planning).max(now + TICK);
                            self.work.push((due, Work::Computing { owner, result }));
                            return;
                        }
                        Ok(start) => {
                            let situation = Situation {
                                picture,
                                taken: &run.taken,
                                start,
                                picked_before: picks_planned,
                            };
                            plan(spec, &situation, &pick, place, stopwatch, score, events)
                        }
                        Err(status) => Planned::Refused {
                            status,
                            reason: FailureReason::IkUnreachable,
                        },
                    };
                    let due = now + spec.latencies.planning;
                    self.work.push((due, Work::Path { owner, planned }));
                    return;
                }
                Ask::WaitBranch { step, .. } => {
                    if let Owner::Viz(job_id) = owner {
                        self.server.viz_waiting_at_branch(now, job_id, step);
                    }
                    return;
                }
                Ask::Notify { step, message } => {
                    events.push(EventKind::Message {
                        text: format!("step {step} notifies {message}"),
                    });
                    run.engine.notified()
                }
                Ask::Done(pieces) => return self.finish(now, spec, owner, &pieces),
                Ask::Failed(failure) => {
                    let status =
                        Status::from_code(failure.status_code()).unwrap_or(Status::VizRuntimeError);
                    return self.refuse(now, owner, status);
                }
            };
        }
    }

    /// Hands a run's path to the server.
    fn finish(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        pieces: &[Piece<PlannedPick>],
    ) {
        let Some(run) = self.run_of(owner) else {
            return;
        };
        let Joined {
            points,
            rounds,
            carton,
        } = match join(spec, &run.start, pieces) {
            Ok(joined) => joined,
            Err(status) => {
                self.last_failure = Some(FailureReason::IkUnreachable);
                return self.refuse(now, owner, status);
            }
        };
        let picks = points.iter().filter(|p| p.vision_move.is_some()).count();
        let run = self.end(owner);
        match owner {
            Owner::Viz(job_id) => {
                if picks > 0 {
                    self.picks_planned += picks as i32;
                    self.last_failure = None;
                    self.target = carton;
                }
                let path = VizPath {
                    points,
                    digital_outputs: rounds.into_iter().next().unwrap_or_default(),
                };
                self.server.finish_viz(now, job_id, Ok(path));
            }
            Owner::Vision(job_id) => {
                // The server takes points from vision projects; the points of this path are the cartons that it picks.
                let picture = run.and_then(|run| run.picture);
                let points = picture.map(|picture| vision_points(&picture));
                self.server
                    .finish_vision(now, job_id, Ok(points.unwrap_or_default()));
            }
        }
    }

    /// Ends a run without a path.
    fn refuse(&mut self, now: SimTime, owner: Owner, status: Status) {
        self.end(owner);
        match owner {
            Owner::Viz(job_id) => self.server.finish_viz(now, job_id, Err(status)),
            Owner::Vision(job_id) => {
                self.server
                    .finish_vision(now, job_id, Err(seen_from_vision(status)));
            }
        }
    }

    fn expose(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        project: VisionProject,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        self.frames += 1;
        score.first_exposure.get_or_insert(now);
        events.push(EventKind::Exposure { frame: self.frames });
        let due = now + spec.latencies.exposure;
        self.work.push((due, Work::Exposure { owner, project }));
    }

    /// Whether the shutter opens now: the cell then shows what is in view.
    pub(crate) fn is_exposure_due(&self, now: SimTime) -> bool {
        self.work
            .iter()
            .any(|(due, work)| *due <= now && matches!(work, Work::Exposure { .. }))
    }

    /// When the next work is due, if any runs.
    pub(crate) fn next_due(&self) -> Option<SimTime> {
        self.work.iter().map(|(due, _)| *due).min()
    }

    /// Whether a result that has to be handed over by `now` is still being computed elsewhere.
    pub(crate) fn is_computing(&mut self, now: SimTime) -> bool {
        let mut is_missing = false;
        for (due, work) in &mut self.work {
            if let (true, Work::Computing { result, .. }) = (*due <= now, work) {
                is_missing |= !result.is_there();
            }
        }
        is_missing
    }

    /// The computing for a run came to nothing: the robot hears it, and the server goes on.
    fn give_up(&mut self, now: SimTime, owner: Owner) {
        match owner {
            Owner::Viz(_) => self.refuse(now, owner, Status::VizRuntimeError),
            Owner::Vision(job_id) => {
                self.end(owner);
                self.server
                    .finish_vision(now, job_id, Err(Status::VisionExecutionError));
            }
        }
    }

    /// Carries out the work that is due. Waits for what is still being computed elsewhere.
    pub(crate) fn advance(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        seen: Option<&Seen>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
        observers: &mut [&mut dyn Observer],
    ) {
        while let Some(index) = self.work.iter().position(|(due, _)| *due <= now) {
            let (_, mut work) = self.work.remove(index);
            if let Work::Computing { owner, result } = work {
                let Some(computed) = result.wait() else {
                    self.give_up(now, owner);
                    continue;
                };
                events.extend(computed.events);
                work = computed.work;
            }
            match work {
                Work::Computing { .. } => {}
                Work::Exposure { owner, project } => {
                    let Some(seen) = seen else {
                        continue;
                    };
                    if let Some(elsewhere) = &self.elsewhere {
                        let (seen, frame) = (seen.clone(), self.frames);
                        let stopwatch = self.stopwatch;
                        let result = elsewhere.compute(move |spec, score, events| {
                            let picture = take_picture(
                                spec,
                                &project,
                                frame,
                                now,
                                &seen,
                                stopwatch,
                                score,
                                events,
                                &mut [],
                            );
                            Work::Poses { owner, picture }
                        });
                        let due = (now + spec.latencies.vision).max(now + TICK);
                        self.work.push((due, Work::Computing { owner, result }));
                        continue;
                    }
                    let picture = take_picture(
                        spec,
                        &project,
                        self.frames,
                        now,
                        seen,
                        self.stopwatch,
                        score,
                        events,
                        observers,
                    );
                    let due = now + spec.latencies.vision;
                    self.work.push((due, Work::Poses { owner, picture }));
                }
                Work::Poses { owner, picture } => {
                    self.hand_over(now, spec, owner, picture, score, events);
                }
                Work::Path { owner, planned } => {
                    let Some(run) = self.run_of(owner) else {
                        continue;
                    };
                    let mut refused = None;
                    let outcome = match planned {
                        Planned::Path(pick) => {
                            run.taken.extend(&pick.detections);
                            Ok(pick)
                        }
                        Planned::Refused { status, reason } => {
                            refused = Some(reason);
                            Err(status.code())
                        }
                    };
                    let ask = run.engine.planned(outcome);
                    self.last_failure = refused.or(self.last_failure);
                    self.follow(now, spec, owner, ask, score, events);
                }
            }
        }
    }

    fn hand_over(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        picture: Picture,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let is_blind = picture.detection.points_in_region == 0;
        let is_empty = picture.detection.boxes.is_empty();
        if is_empty {
            self.last_failure = Some(FailureReason::NoDetection);
        }
        if let Some(run) = self.run_of(owner) {
            run.picture = Some(picture);
            run.taken.clear();
            let outcome = if is_blind {
                Err(Status::VizNoPointsInRegion.code())
            } else if is_empty {
                Err(Status::VizNoVisionResult.code())
            } else {
                Ok(())
            };
            let ask = run.engine.recognised(outcome);
            self.follow(now, spec, owner, ask, score, events);
        } else if let Owner::Vision(job_id) = owner {
            let outcome = if is_blind {
                Err(Status::NoPointsInRegion)
            } else {
                Ok(vision_points(&picture))
            };
            self.server.finish_vision(now, job_id, outcome);
        }
    }
}

fn vision_points(picture: &Picture) -> Vec<VisionPoint> {
    let points = picture.detection.boxes.iter().zip(&picture.base_from_boxes);
    points
        .map(|(found, base_from_object)| VisionPoint {
            base_from_object: *base_from_object,
            label: found.label as i32,
        })
        .collect()
}

/// Where a path of a vision project starts: where the robot says it is, or the planner's home.
fn start_of(spec: &CellSpec, pose: &RobotPose) -> JointPositions {
    match pose {
        RobotPose::PathStart(joints)
        | RobotPose::Current {
            joints: Some(joints),
            ..
        } => *joints,
        _ => JointPositions::zeros(spec.arm.joint_count()),
    }
}

/// What a vision project reports where the planning project reports this.
fn seen_from_vision(status: Status) -> Status {
    let codes = Status::ALL.iter().copied();
    codes
        .filter(|code| (1001..1100).contains(&code.code()) && *code != Status::VisionTimeout)
        .find(|code| code.seen_from_viz() == status)
        .unwrap_or(Status::PathPlanningError)
}

/// A project as recipe (103) and box size (501) leave it: the size wins.
fn configured(
    spec: &CellSpec,
    project: i32,
    recipe: Option<i32>,
    size: Option<BoxSize>,
) -> VisionProject {
    let mut project = spec
        .projects
        .get(&project)
        .expect("server and workflow know the same projects")
        .clone();
    if let Some(sizes) = recipe.and_then(|recipe| project.recipes.get(&recipe)) {
        project.settings.sizes.clone_from(sizes);
    }
    if let Some(size) = size {
        project.settings.sizes = vec![size];
    }
    project
}
