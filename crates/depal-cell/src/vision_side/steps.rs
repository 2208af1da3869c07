//! Runs of steps: what an engine asks for, and the path that comes of it.

use depal_interface::{PlannedPath, Status};
use depal_time::{SimTime, TICK};
use depal_workflow::{Ask, Piece};

use super::results::{configured, seen_from_vision, vision_result};
use super::{JobId, Owner, StepRun, VisionSide, Work};
use crate::event::{EventKind, FailureReason};
use crate::picture::Picture;
use crate::planning::{Planned, PlannedPick, Situation, plan};
use crate::score::Score;
use crate::spec::CellSpec;
use crate::surroundings::check_path;
use crate::waypoints::{Joined, end_of, join};

impl VisionSide {
    pub(super) fn run_of(&mut self, owner: Owner) -> Option<&mut StepRun> {
        self.runs.iter_mut().find(|run| run.owner == owner)
    }

    pub(super) fn begin(
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

    pub(super) fn end(&mut self, owner: Owner) -> Option<StepRun> {
        let place = self.runs.iter().position(|run| run.owner == owner)?;
        Some(self.runs.remove(place))
    }

    pub(super) fn stop_viz(&mut self, job_id: JobId) {
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
    pub(super) fn follow(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        mut ask: Ask<PlannedPick>,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        let stopwatch = self.stopwatch;
        let picked = self.picked.clone();
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
                    let status = Status::NoVisionResult.code();
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
                    let reported = run.reported;
                    return self.expose(now, spec, owner, project, reported, score, events);
                }
                Ask::PlanPick { pick, place } => {
                    let Some(picture) = &run.picture else {
                        return;
                    };
                    let this_run = run.engine.pieces().iter().map(|piece| match piece {
                        Piece::Planned { plan, .. } => plan.detections.len() as i32,
                        Piece::Move(_) => 0,
                    });
                    let counter = counter_of(owner, picture);
                    let picked_before =
                        picked.get(&counter).copied().unwrap_or(0) + this_run.sum::<i32>();
                    let planned = match end_of(spec, &run.start, run.engine.pieces()) {
                        Ok(start) if let Some(elsewhere) = &elsewhere => {
                            let (picture, taken) = (picture.clone(), run.taken.clone());
                            let result = elsewhere.compute(move |spec, score, events| {
                                let situation = Situation {
                                    picture: &picture,
                                    taken: &taken,
                                    start,
                                    picked_before,
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
                                picked_before,
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
                    let ask = run.engine.notified();
                    self.server.notify(now, owner.job_id(), message);
                    ask
                }
                Ask::Done(pieces) => return self.finish(now, spec, owner, &pieces, events),
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
        events: &mut Vec<EventKind>,
    ) {
        let Some(run) = self.run_of(owner) else {
            return;
        };
        let joined = match join(spec, &run.start, pieces) {
            Ok(joined) => joined,
            Err(status) => {
                self.last_failure = Some(FailureReason::IkUnreachable);
                return self.refuse(now, owner, status);
            }
        };
        let picture = run.picture.as_ref().map(|picture| (picture, &run.taken));
        if let Err(blocked) = check_path(spec, &run.start, pieces, &joined, picture) {
            self.last_failure = Some(blocked.reason);
            events.push(EventKind::PlanRefused {
                reasons: vec![blocked.words],
            });
            return self.refuse(now, owner, blocked.status);
        }
        let Joined {
            points,
            rounds,
            custom_ports,
            aims,
            ..
        } = joined;
        let moves = points.iter().filter_map(|p| p.vision_move.as_ref());
        let picks: i32 = moves.map(|data| data.picked_now).sum();
        let run = self.end(owner);
        if let Some(picture) = run.and_then(|run| run.picture)
            && picks > 0
        {
            *self.picked.entry(counter_of(owner, &picture)).or_insert(0) += picks;
            self.last_failure = None;
            self.aims = aims.into();
        }
        let path = PlannedPath {
            points,
            rounds,
            sections: spec.gripper.sections.len(),
            custom_ports,
        };
        match owner {
            Owner::Viz(job_id) => self.server.finish_viz_path(now, job_id, Ok(path)),
            Owner::Vision(job_id) => self.server.finish_vision_path(now, job_id, Ok(path)),
        }
    }

    /// Ends a run without a path.
    pub(super) fn refuse(&mut self, now: SimTime, owner: Owner, status: Status) {
        self.end(owner);
        match owner {
            Owner::Viz(job_id) => {
                self.server
                    .finish_viz(now, job_id, Err(status.seen_from_viz()));
            }
            Owner::Vision(job_id) => {
                self.server
                    .finish_vision(now, job_id, Err(seen_from_vision(status)));
            }
        }
    }

    pub(super) fn hand_over(
        &mut self,
        now: SimTime,
        spec: &CellSpec,
        owner: Owner,
        mut picture: Picture,
        score: &mut Score,
        events: &mut Vec<EventKind>,
    ) {
        if self.frame_faults.frame_is_empty() {
            score.faults.insert("no_points".to_owned());
            picture.detection.boxes.clear();
            picture.base_from_boxes.clear();
            picture.cartons.clear();
            picture.labels = Err(Status::NoVisionResult);
            events.push(EventKind::Message {
                text: "fault no_points: what vision found in this picture is withheld".to_owned(),
            });
        }
        if picture.detection.boxes.is_empty() {
            self.last_failure = Some(FailureReason::NoDetection);
        }
        if let Some(run) = self.run_of(owner) {
            let outcome = picture.labels.as_ref().map(|_| ()).map_err(|s| s.code());
            run.picture = Some(picture);
            run.taken.clear();
            let ask = run.engine.recognised(outcome);
            self.follow(now, spec, owner, ask, score, events);
        } else if let Owner::Vision(job_id) = owner {
            let outcome = vision_result(spec, &picture);
            self.server.finish_vision_custom(now, job_id, outcome);
        }
    }
}

/// Whose picks are counted together: a vision project's, or the planning project's, which has no number.
fn counter_of(owner: Owner, picture: &Picture) -> i32 {
    match owner {
        Owner::Viz(_) => 0,
        Owner::Vision(_) => picture.project,
    }
}
