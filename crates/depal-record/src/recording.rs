use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use depal_cell::event::{Event, EventKind, FailureReason};
use depal_cell::observer::{CaptureView, CartonViewState, Observer, Snapshot};
use depal_frames::{JointPositions, Pose};
use depal_time::SimTime;
use rerun::{
    Boxes3D, Clear, Color, FillMode, LineStrips3D, Points3D, RecordingStream,
    RecordingStreamBuilder, RecordingStreamResult, Scalars, StateChange, TextLog, TextLogLevel,
    TimeColumn, Transform3D,
};

use crate::RecordError;
use crate::blueprint::blueprint;
use crate::picture::log_capture;
use crate::scenery::{RecordingSetup, log_setup};
use crate::shapes::{color, position, quaternion, transform};

/// A carton is drawn again when it moved this far, metres, or turned this far, radians.
const CARTON_STEP: f64 = 1e-3;

const KRAFT: [u8; 3] = [186, 142, 93];
const TARGET: [u8; 3] = [240, 200, 60];
const GRIPPED: [u8; 3] = [70, 160, 240];
const PLACED: [u8; 3] = [120, 180, 110];
const LOST: [u8; 3] = [220, 60, 50];

/// A run as a rerun recording. Draws as the run goes, sends the dense tracks as columns at the end.
pub struct Recording {
    stream: RecordingStream,
    path: PathBuf,
    partial: PathBuf,
    setup: RecordingSetup,
    failure: Option<String>,
    times: Vec<SimTime>,
    link_tracks: Vec<Vec<Pose>>,
    tcp_track: Vec<Pose>,
    joint_track: Vec<JointPositions>,
    vacuum_track: Vec<Vec<f64>>,
    cartons: BTreeMap<u32, (Pose, CartonViewState)>,
    cycle: &'static str,
    tool: [f32; 3],
}

impl Recording {
    /// Begins `path` under a temporary name beside it and draws what stands still.
    pub fn create(path: &Path, setup: RecordingSetup) -> Result<Self, RecordError> {
        let partial = path.with_extension("rrd.partial");
        let failed = |message: String| RecordError::Recording {
            path: path.to_owned(),
            message,
        };
        let stream = RecordingStreamBuilder::new("depal")
            .recording_name(setup.title.clone())
            .with_blueprint(blueprint())
            .save(&partial)
            .map_err(|error| failed(error.to_string()))?;
        log_setup(&stream, &setup).map_err(|error| failed(error.to_string()))?;
        let links = setup.arm_links.len();
        Ok(Self {
            stream,
            path: path.to_owned(),
            partial,
            setup,
            failure: None,
            times: Vec::new(),
            link_tracks: vec![Vec::new(); links],
            tcp_track: Vec::new(),
            joint_track: Vec::new(),
            vacuum_track: Vec::new(),
            cartons: BTreeMap::new(),
            cycle: "",
            tool: [0.0; 3],
        })
    }

    /// Sends the tracks, flushes, and gives the file its name.
    pub fn finish(mut self) -> Result<(), RecordError> {
        let failed = |message: String| RecordError::Recording {
            path: self.path.clone(),
            message,
        };
        if let Some(message) = self.failure.take() {
            return Err(failed(message));
        }
        self.send_tracks()
            .map_err(|error| failed(error.to_string()))?;
        self.stream
            .flush_blocking()
            .map_err(|error| failed(error.to_string()))?;
        let (partial, path) = (self.partial.clone(), self.path.clone());
        drop(self.stream);
        std::fs::rename(&partial, &path).map_err(|source| RecordError::Write { path, source })
    }

    fn send_tracks(&self) -> RecordingStreamResult<()> {
        let index = || {
            TimeColumn::new_duration_nanos(
                "sim_time",
                self.times.iter().map(|time| time.as_nanos() as i64),
            )
        };
        let send_poses = |entity: String, poses: &[Pose]| {
            let columns = Transform3D::update_fields()
                .with_many_translation(poses.iter().map(position))
                .with_many_quaternion(poses.iter().map(|pose| quaternion(&pose.rotation)))
                .columns_of_unit_batches()?;
            self.stream.send_columns(entity, [index()], columns)
        };
        for ((name, _), track) in self.setup.arm_links.iter().zip(&self.link_tracks) {
            send_poses(format!("world/robot/{name}"), track)?;
        }
        send_poses("world/robot/gripper".into(), &self.tcp_track)?;
        let send_scalars = |entity: String, values: Vec<f64>| {
            let columns = Scalars::update_fields()
                .with_scalars(values)
                .columns_of_unit_batches()?;
            self.stream.send_columns(entity, [index()], columns)
        };
        for (joint, name) in self.setup.joint_names.iter().enumerate() {
            let degrees = self.joint_track.iter().map(|q| q[joint].to_degrees());
            send_scalars(format!("robot/joints/{name}"), degrees.collect())?;
        }
        for section in 0..self.setup.section_areas.len() {
            let kpa = self
                .vacuum_track
                .iter()
                .map(|vacuum| vacuum[section] * 1e-3);
            send_scalars(
                format!("gripper/vacuum/section_{}", section + 1),
                kpa.collect(),
            )?;
        }
        Ok(())
    }

    fn keep(&mut self, result: RecordingStreamResult<()>) {
        if let Err(error) = result {
            self.failure.get_or_insert(error.to_string());
        }
    }

    fn set_time(&self, time: SimTime) {
        self.stream.set_time(
            "sim_time",
            rerun::TimeCell::from_duration_nanos(time.as_nanos() as i64),
        );
    }

    fn set_cycle(&mut self, state: &'static str) -> RecordingStreamResult<()> {
        if self.cycle == state {
            return Ok(());
        }
        self.cycle = state;
        self.stream.log("cycle", &StateChange::single(state))
    }

    fn log_event(&mut self, event: &Event) -> RecordingStreamResult<()> {
        self.set_time(event.time);
        let say = |stream: &RecordingStream, level: &'static str, text: String| {
            stream.log("log", &TextLog::new(text).with_level(level))
        };
        match &event.kind {
            EventKind::Protocol {
                from, text, status, ..
            } => {
                let failed = status.is_some_and(|code| !(100..=199).contains(&(code % 1000)));
                let level = if failed {
                    TextLogLevel::WARN
                } else {
                    TextLogLevel::INFO
                };
                self.stream.log(
                    format!("protocol/{from}"),
                    &TextLog::new(text.as_str()).with_level(level),
                )?;
            }
            EventKind::ProgramLine {
                module,
                routine,
                line,
            } => self.stream.log(
                "program",
                &TextLog::new(format!("{module}/{routine}:{line}")).with_level(TextLogLevel::TRACE),
            )?,
            EventKind::Message { text } => say(&self.stream, TextLogLevel::INFO, text.clone())?,
            EventKind::Signal { name, value } => {
                self.stream
                    .log(format!("signals/{name}"), &Scalars::new([*value]))?;
            }
            EventKind::Exposure { frame } => {
                self.stream.set_time_sequence("frame", i64::from(*frame));
                self.set_cycle("capture")?;
            }
            EventKind::Plan {
                waypoints,
                pick_index,
                ..
            } => {
                self.set_cycle("plan")?;
                let path: Vec<[f32; 3]> = waypoints
                    .iter()
                    .map(|w| w.world_from_tcp.xyz_mm.map(|v| (v * 1e-3) as f32))
                    .collect();
                let colors = (0..path.len()).map(|i| {
                    if i == *pick_index {
                        Color::from_rgb(255, 80, 60)
                    } else {
                        Color::from_rgb(90, 200, 250)
                    }
                });
                self.stream.log(
                    "plan/waypoints",
                    &Points3D::new(path.clone())
                        .with_colors(colors)
                        .with_radii([0.018f32]),
                )?;
                self.stream.log(
                    "plan/path",
                    &LineStrips3D::new([path])
                        .with_colors([Color::from_rgb(90, 200, 250)])
                        .with_radii([0.005f32]),
                )?;
            }
            EventKind::PlanRefused { reasons } => {
                say(
                    &self.stream,
                    TextLogLevel::WARN,
                    format!("no plan: {}", reasons.join("; ")),
                )?;
            }
            EventKind::PickStarted { pick, .. } => {
                self.stream.set_time_sequence("pick", i64::from(*pick));
                self.set_cycle("grip")?;
            }
            EventKind::Gripped { pick, carton } => {
                self.set_cycle("transfer")?;
                say(
                    &self.stream,
                    TextLogLevel::DEBUG,
                    format!("pick {pick}: carton {carton} hangs"),
                )?;
            }
            EventKind::PickFinished {
                pick,
                reason,
                detail,
                cycle_s,
                ..
            } => match reason {
                None => {
                    self.set_cycle("return")?;
                    say(
                        &self.stream,
                        TextLogLevel::INFO,
                        format!("pick {pick} ok, {cycle_s:.2} s"),
                    )?;
                }
                // Nothing failed where the arm happens to be: no marker.
                Some(FailureReason::Timeout) => {
                    let text = format!("pick {pick}: {detail}");
                    say(&self.stream, TextLogLevel::WARN, text)?;
                }
                Some(reason) => self.log_failure(&format!("pick_{pick}"), reason.name(), detail)?,
            },
            EventKind::Lost {
                carton,
                reason,
                detail,
            } => {
                self.log_failure(&format!("carton_{carton}"), reason.name(), detail)?;
            }
            EventKind::Collision { a, b, force_n } => {
                self.log_failure(
                    "collision",
                    "collision",
                    &format!("{a} hit {b} with {force_n:.0} N"),
                )?;
            }
            EventKind::RunEnded { state, detail } => {
                say(
                    &self.stream,
                    TextLogLevel::INFO,
                    format!("run {state}: {detail}"),
                )?;
            }
            EventKind::Vision { detections, .. } => {
                let errors: Vec<f64> = detections.iter().filter_map(|d| d.error_mm).collect();
                let worst = errors.iter().copied().fold(0.0, f64::max);
                self.stream
                    .log("vision/error/worst_mm", &Scalars::new([worst]))?;
                let angles = detections.iter().filter_map(|d| d.error_deg);
                self.stream.log(
                    "vision/error/worst_deg",
                    &Scalars::new([angles.fold(0.0, f64::max)]),
                )?;
            }
            _ => {}
        }
        Ok(())
    }

    fn log_failure(&mut self, name: &str, reason: &str, detail: &str) -> RecordingStreamResult<()> {
        self.set_cycle("FAULT")?;
        self.stream.log(
            format!("failures/{name}"),
            &Points3D::new([self.tool])
                .with_colors([Color::from_rgb(255, 30, 30)])
                .with_radii([0.06f32])
                .with_labels([reason]),
        )?;
        self.stream.log(
            "log",
            &TextLog::new(format!("{name}: {reason}: {detail}")).with_level(TextLogLevel::ERROR),
        )
    }

    fn log_snapshot(&mut self, snapshot: &Snapshot) -> RecordingStreamResult<()> {
        self.times.push(snapshot.time);
        for (track, pose) in self.link_tracks.iter_mut().zip(&snapshot.world_from_links) {
            track.push(*pose);
        }
        self.tcp_track.push(snapshot.world_from_tcp);
        self.tool = position(&snapshot.world_from_tcp);
        self.joint_track.push(snapshot.joints);
        self.vacuum_track.push(snapshot.section_vacuum.clone());
        self.set_time(snapshot.time);
        let gone: Vec<u32> = self
            .cartons
            .keys()
            .copied()
            .filter(|id| !snapshot.cartons.iter().any(|carton| carton.id == *id))
            .collect();
        for id in gone {
            self.cartons.remove(&id);
            self.stream
                .log(format!("world/cartons/{id}"), &Clear::flat())?;
        }
        for carton in &snapshot.cartons {
            let entity = format!("world/cartons/{}", carton.id);
            let before = self.cartons.get(&carton.id).copied();
            if before.is_none_or(|(_, state)| state != carton.state) {
                let half = carton.size.map(|side| (side * 0.5) as f32);
                self.stream.log(
                    entity.as_str(),
                    &Boxes3D::from_half_sizes([half])
                        .with_colors([color(carton_color(carton.state))])
                        .with_fill_mode(FillMode::Solid),
                )?;
            }
            let moved = before.is_none_or(|(pose, _)| {
                let shift = pose.translation.vector - carton.world_from_centre.translation.vector;
                shift.norm() > CARTON_STEP
                    || pose.rotation.angle_to(&carton.world_from_centre.rotation) > CARTON_STEP
            });
            if moved {
                self.stream
                    .log(entity, &transform(&carton.world_from_centre))?;
            }
            let drawn = if moved {
                carton.world_from_centre
            } else {
                before.map_or(carton.world_from_centre, |b| b.0)
            };
            self.cartons.insert(carton.id, (drawn, carton.state));
        }
        Ok(())
    }
}

impl Observer for Recording {
    fn on_event(&mut self, event: &Event) {
        let result = self.log_event(event);
        self.keep(result);
    }

    fn on_snapshot(&mut self, snapshot: &Snapshot) {
        let result = self.log_snapshot(snapshot);
        self.keep(result);
    }

    fn on_capture(&mut self, capture: &CaptureView<'_>) {
        self.set_time(capture.time);
        if self.setup.world_from_camera.is_none() {
            let at = transform(&capture.world_from_camera);
            let result = self.stream.log("world/camera", &at);
            self.keep(result);
        }
        let result = log_capture(&self.stream, capture);
        self.keep(result);
    }
}

fn carton_color(state: CartonViewState) -> [u8; 3] {
    match state {
        CartonViewState::Waiting => KRAFT,
        CartonViewState::Target => TARGET,
        CartonViewState::Gripped => GRIPPED,
        CartonViewState::Placed => PLACED,
        CartonViewState::Lost => LOST,
    }
}
