//! The vision computer: the server's brain, the planning project's engine, and the work they ask for.
//! Each result is handed over when its simulated time has come.

use depal_frames::{BoxSize, JointPositions};
use depal_interface::{
    Direction, Job, JobId, Motion, PathPoint, PortId, Server, Status, VisionPoint, VizPath,
};
use depal_time::{SimTime, TICK};
use depal_workflow::{Ask, Engine, MoveMotion, Piece};

use crate::computing::{Computing, Elsewhere};
use crate::error::CellError;
use crate::event::{EventKind, FailureReason};
use crate::link::{Link, ToServer};
use crate::observer::Observer;
use crate::picture::{Picture, Seen, take_picture};
use crate::planning::{Planned, plan};
use crate::score::Score;
use crate::spec::{CellSpec, VisionProject};

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
    Path { job_id: JobId, planned: Planned },
    /// Poses or a path that are computed elsewhere meanwhile.
    Computing { owner: Owner, result: Computing },
}

/// A run of the planning project.
struct VizRun {
    job_id: JobId,
    start: JointPositions,
    box_sizes: Vec<(i32, BoxSize)>,
    recipes: Vec<(i32, i32)>,
    picture: Option<Picture>,
    branch_told: bool,
}

/// A planned pick as the engine carries it.
#[derive(Debug, Clone)]
struct PlannedPick {
    path: VizPath,
    carton: Option<u32>,
}

/// The vision computer of a cell.
pub(crate) struct VisionSide {
    pub(crate) server: Server,
    engine: Engine<PlannedPick>,
    viz: Option<VizRun>,
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
}

impl VisionSide {
    pub(crate) fn new(spec: &CellSpec, stopwatch: fn() -> f64) -> Result<Self, CellError> {
        let projects: Vec<i32> = spec.projects.keys().copied().collect();
        let engine = Engine::new(spec.workflow.clone(), &projects)
            .map_err(|error| CellError::Workflow(error.to_string()))?;
        Ok(Self {
            server: Server::new(spec.interface.clone())?,
            engine,
            viz: None,
            work: Vec::new(),
            frames: 0,
            picks_planned: 0,
            target: None,
            last_failure: None,
            last_status: None,
            stopwatch,
            elsewhere: None,
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
                    ..
                } => {
                    let project = configured(spec, project, recipe, box_size);
                    self.expose(now, spec, Owner::Vision(job_id), project, score, events);
                }
                Job::StartViz {
                    job_id,
                    start,
                    box_sizes,
                    recipes,
                } => {
                    let home = JointPositions::zeros(spec.arm.joint_count());
                    self.viz = Some(VizRun {
                        job_id,
                        start: start.unwrap_or(home),
                        box_sizes,
                        recipes,
                        picture: None,
                        branch_told: false,
                    });
                    let ask = self.engine.start();
                    self.follow(now, spec, ask, score, events);
                }
                Job::StopViz { job_id } => self.stop_viz(job_id),
                // The workflow has no step yet that takes one of these, and the settings register none:
                // the server refuses their commands, except 502, whose pose nothing uses.
                Job::SetIndex { .. }
                | Job::WriteParameter { .. }
                | Job::SetOuterPose { .. }
                | Job::SetInputPose { .. }
                | Job::SetVariable { .. }
                | Job::SwitchSolution { .. }
                | Job::CaptureCalibration { .. } => {}
                Job::SetBranch { job_id, exit, .. } => {
                    if self.viz.as_ref().is_some_and(|run| run.job_id == job_id) {
                        let ask = self.engine.branch(exit);
                        self.follow(now, spec, ask, score, events);
                    }
                }
            }
        }
    }

    fn stop_viz(&mut self, job_id: JobId) {
        if self.viz.as_ref().is_some_and(|run| run.job_id == job_id) {
            self.viz = None;
            self.engine.stop();
            self.work.retain(|(_, work)| match work {
                Work::Exposure { owner, .. }
                | Work::Poses { owner, .. }
                | Work::Computing { owner, .. } => *owner != Owner::Viz(job_id),
                Work::Path { job_id: other, .. } => *other != job_id,
            });
        }
    }

    /// Does what the engine asks for until it has to wait.
    fn follow(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        ask: Ask<PlannedPick>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let Some(run) = &mut self.viz else {
            return;
        };
        let job_id = run.job_id;
        match ask {
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
                self.expose(now, spec, Owner::Viz(job_id), project, score, events);
            }
            Ask::PlanPick { .. } => {
                let Some(picture) = &run.picture else {
                    return;
                };
                if let Some(elsewhere) = &self.elsewhere {
                    let (picture, start) = (picture.clone(), run.start);
                    let (picked, stopwatch) = (self.picks_planned, self.stopwatch);
                    let result = elsewhere.compute(move |spec, score, events| {
                        let planned = plan(spec, &picture, start, picked, stopwatch, score, events);
                        Work::Path { job_id, planned }
                    });
                    let owner = Owner::Viz(job_id);
                    let due = (now + spec.latencies.planning).max(now + TICK);
                    self.work.push((due, Work::Computing { owner, result }));
                    return;
                }
                let planned = plan(
                    spec,
                    picture,
                    run.start,
                    self.picks_planned,
                    self.stopwatch,
                    score,
                    events,
                );
                let due = now + spec.latencies.planning;
                self.work.push((due, Work::Path { job_id, planned }));
            }
            Ask::WaitBranch { step, .. } => {
                if !run.branch_told {
                    run.branch_told = true;
                    self.server.viz_waiting_at_branch(now, job_id, step);
                }
            }
            Ask::Done(pieces) => {
                let (path, carton) = join(spec, pieces);
                if path.points.iter().any(|point| point.vision_move.is_some()) {
                    self.picks_planned += 1;
                    self.last_failure = None;
                    self.target = carton;
                }
                self.viz = None;
                self.server.finish_viz(now, job_id, Ok(path));
            }
            Ask::Failed(failure) => {
                self.viz = None;
                let status =
                    Status::from_code(failure.status_code()).unwrap_or(Status::VizRuntimeError);
                self.server.finish_viz(now, job_id, Err(status));
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
            Owner::Vision(job_id) => {
                let outcome = Err(Status::VisionExecutionError);
                self.server.finish_vision(now, job_id, outcome);
            }
            Owner::Viz(job_id) => {
                if self.viz.as_ref().is_some_and(|run| run.job_id == job_id) {
                    self.viz = None;
                    self.engine.stop();
                    let outcome = Err(Status::VizRuntimeError);
                    self.server.finish_viz(now, job_id, outcome);
                }
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
                Work::Path { job_id, planned } => {
                    if self.viz.as_ref().is_none_or(|run| run.job_id != job_id) {
                        continue;
                    }
                    let outcome = match planned {
                        Planned::Path { path, detection } => {
                            let run = self.viz.as_ref();
                            let picture = run.and_then(|run| run.picture.as_ref());
                            let carton = picture.and_then(|picture| picture.cartons[detection]);
                            Ok(PlannedPick { path, carton })
                        }
                        Planned::Refused { status, reason } => {
                            self.last_failure = Some(reason);
                            Err(status.code())
                        }
                    };
                    let ask = self.engine.planned(outcome);
                    self.follow(now, spec, ask, score, events);
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
        match owner {
            Owner::Vision(job_id) => {
                let outcome = if is_blind {
                    Err(Status::NoPointsInRegion)
                } else {
                    let points = picture.detection.boxes.iter().zip(&picture.base_from_boxes);
                    Ok(points
                        .map(|(found, base_from_object)| VisionPoint {
                            base_from_object: *base_from_object,
                            label: found.label as i32,
                        })
                        .collect())
                };
                self.server.finish_vision(now, job_id, outcome);
            }
            Owner::Viz(job_id) => {
                let Some(run) = self.viz.as_mut().filter(|run| run.job_id == job_id) else {
                    return;
                };
                run.picture = Some(picture);
                let outcome = if is_blind {
                    Err(Status::VizNoPointsInRegion.code())
                } else if is_empty {
                    Err(Status::VizNoVisionResult.code())
                } else {
                    Ok(())
                };
                let ask = self.engine.recognised(outcome);
                self.follow(now, spec, ask, score, events);
            }
        }
    }
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

/// The pieces of a run as one path, and the carton it aims at.
fn join(spec: &CellSpec, pieces: Vec<Piece<PlannedPick>>) -> (VizPath, Option<u32>) {
    let mut joined = VizPath::default();
    let mut carton = None;
    for piece in pieces {
        match piece {
            Piece::Fixed { point, .. } => joined.points.push(PathPoint {
                joints: point.joints,
                base_from_tcp: spec.arm.base_from_flange(&point.joints)
                    * spec.gripper.flange_from_tcp,
                motion: match point.motion {
                    MoveMotion::Joint => Motion::Joint,
                    MoveMotion::Linear => Motion::Linear,
                },
                tool: crate::planning::TOOL,
                velocity_percent: point.velocity_percent,
                label: 0,
                vision_move: None,
            }),
            Piece::Planned { plan, .. } => {
                joined.points.extend(plan.path.points);
                joined.digital_outputs.extend(plan.path.digital_outputs);
                carton = plan.carton.or(carton);
            }
        }
    }
    (joined, carton)
}
