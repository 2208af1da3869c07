//! The vision computer: the server's brain, the planning project's engine, and the work they ask for.
//! Each result is handed over when its simulated time has come.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use depal_frames::{BoxSize, JointPositions, Pose};
use depal_interface::{Direction, FrameFaults, JobId, PortId, Server, ServerSettings, Status};
use depal_time::{SimTime, TICK};
use depal_workflow::Engine;

use crate::calibration_desk::CalibrationDesk;
use crate::computing::{Computing, Elsewhere};
use crate::error::CellError;
use crate::event::{EventKind, FailureReason};
use crate::link::{Link, ToServer};
use crate::observer::Observer;
use crate::picture::{Picture, Seen, take_picture};
use crate::planning::{Planned, PlannedPick};
use crate::score::Score;
use crate::spec::{CellSpec, VisionProject};
use crate::standing::Aim;

mod jobs;
pub(crate) mod results;
mod steps;

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

impl Owner {
    fn job_id(self) -> JobId {
        let (Self::Vision(job_id) | Self::Viz(job_id)) = self;
        job_id
    }
}

/// Work whose simulated time runs.
pub(crate) enum Work {
    /// The shutter opens at its due time.
    Exposure {
        owner: Owner,
        project: Box<VisionProject>,
        /// The flange in the base as the robot has told it.
        reported: Option<Pose>,
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
    /// The flange in the base as the robot has told it.
    reported: Option<Pose>,
    box_sizes: Vec<(i32, BoxSize)>,
    recipes: Vec<(i32, i32)>,
    picture: Option<Picture>,
    /// Reports of the picture that have their path.
    taken: BTreeSet<usize>,
}

/// The vision computer of a cell.
pub(crate) struct VisionSide {
    pub(crate) server: Server,
    /// The planning project before its runs, as 208 and 502 have left it.
    engine: Engine<PlannedPick>,
    /// The path steps of vision projects before their runs.
    path_engines: BTreeMap<i32, Engine<PlannedPick>>,
    runs: Vec<StepRun>,
    work: Vec<(SimTime, Work)>,
    frames: u32,
    frame_faults: FrameFaults,
    /// Cartons planned so far, by vision project; 0 is the planning project.
    picked: BTreeMap<i32, i32>,
    /// What the path sent last aims at, by round; the first round is the next one.
    aims: VecDeque<Aim>,
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
            server: Server::new(ServerSettings {
                needs_robot_pose: spec.is_eye_in_hand(),
                ..spec.interface.clone()
            })?,
            engine: engine(&spec.workflow)?,
            path_engines,
            runs: Vec::new(),
            work: Vec::new(),
            frames: 0,
            frame_faults: FrameFaults::new(&spec.interface.faults),
            picked: BTreeMap::new(),
            aims: VecDeque::new(),
            last_failure: None,
            last_status: None,
            stopwatch,
            elsewhere: None,
            calibration: CalibrationDesk::default(),
        })
    }

    /// The cartons that the next pick aims at, by truth.
    pub(crate) fn targets(&self) -> &[u32] {
        self.aims.front().map_or(&[], |aim| aim.cartons.as_slice())
    }

    /// What the pick that begins now aims at; the last round stays, for a program that tries it again.
    pub(crate) fn next_aim(&mut self) -> Aim {
        match self.aims.len() {
            0 | 1 => self.aims.front().cloned().unwrap_or_default(),
            _ => self.aims.pop_front().unwrap_or_default(),
        }
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
            if reply.closes {
                link.close_from_server(now, reply.connection);
            }
        }
        while let Some(entry) = self.server.poll_log() {
            score.faults.extend(entry.faults);
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

    fn expose(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        project: VisionProject,
        reported: Option<Pose>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        self.frames += 1;
        score.first_exposure.get_or_insert(now);
        events.push(EventKind::Exposure { frame: self.frames });
        let due = now + spec.latencies.exposure;
        let exposure = Work::Exposure {
            owner,
            project: Box::new(project),
            reported,
        };
        self.work.push((due, exposure));
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

    /// The camera does not answer.
    fn lose_camera(&mut self, now: SimTime, owner: Owner, events: &mut Vec<EventKind>) {
        let lost = Status::CameraNotConnected;
        self.last_failure = Some(FailureReason::NoDetection);
        events.push(EventKind::Message {
            text: "fault camera_lost: no picture can be taken".to_owned(),
        });
        match owner {
            Owner::Viz(_) => self.refuse(now, owner, lost.seen_from_viz()),
            Owner::Vision(job_id) => {
                self.end(owner);
                self.server.finish_vision(now, job_id, Err(lost));
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
                Work::Exposure { owner, .. } if self.frame_faults.camera_is_lost(now) => {
                    score.faults.insert("camera_lost".to_owned());
                    self.lose_camera(now, owner, events);
                }
                Work::Exposure {
                    owner,
                    project,
                    reported,
                } => {
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
                                reported.as_ref(),
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
                        reported.as_ref(),
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
}
