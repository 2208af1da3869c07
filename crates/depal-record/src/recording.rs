use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use depal_cell::event::{Event, EventKind, FailureReason};
use depal_cell::observer::{CaptureView, CartonViewState, Observer, Snapshot};
use depal_frames::{Intrinsics, JointPositions, PlacedShape, Pose};
use depal_time::SimTime;
use rerun::{
    Arrows3D, Boxes3D, Clear, Color, EncodedDepthImage, FillMode, LineStrips3D, Pinhole, Points3D,
    RecordingStream, RecordingStreamBuilder, RecordingStreamResult, Scalars, SeriesLines,
    StateChange, TextDocument, TextLog, TextLogLevel, TimeColumn, Transform3D, ViewCoordinates,
};

use crate::RecordError;
use crate::blueprint::blueprint;
use crate::shapes::{color, log_static_shapes, position, quaternion, transform};

/// What does not change during a run and is drawn once.
#[derive(Debug, Clone)]
pub struct RecordingSetup {
    /// Name shown by the viewer: scene and seed.
    pub title: String,
    /// Markdown shown in the Readme tab.
    pub readme: String,
    /// The arm's links with their coloured solids, in link frames.
    pub arm_links: Vec<(String, Vec<(PlacedShape, [u8; 3])>)>,
    /// Joint names, in the order of the joint positions.
    pub joint_names: Vec<String>,
    /// Solids of the gripper, in the tool frame.
    pub gripper_bodies: Vec<PlacedShape>,
    /// Rectangle of each section in the tool frame: min x, max x, min y, max y, metres.
    pub section_areas: Vec<[f64; 4]>,
    /// Everything that stands still: name, solids in the world frame, colour.
    pub fixed: Vec<(String, Vec<PlacedShape>, [u8; 3])>,
    /// The camera.
    pub intrinsics: Intrinsics,
    /// World pose of the camera.
    pub world_from_camera: Pose,
}

/// The depth image is stored at 1 / this resolution.
const IMAGE_STEP: usize = 2;
/// One point of the cloud in this many rows and columns.
const CLOUD_STEP: usize = 9;
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

    fn log_capture(&mut self, capture: &CaptureView<'_>) -> RecordingStreamResult<()> {
        self.set_time(capture.time);
        let intrinsics = &capture.frame.intrinsics;
        let (width, height) = (
            intrinsics.width / IMAGE_STEP,
            intrinsics.height / IMAGE_STEP,
        );
        let mut pixels = Vec::with_capacity(width * height * 2);
        for row in 0..height {
            for column in 0..width {
                let depth = capture
                    .frame
                    .depth_at(column * IMAGE_STEP, row * IMAGE_STEP);
                pixels.extend_from_slice(&((depth * 1e4).round() as u16).to_be_bytes());
            }
        }
        let image = encode_png(&pixels, width as u32, height as u32);
        self.stream.log(
            "world/camera/image/depth",
            &EncodedDepthImage::new(image)
                .with_media_type("image/png")
                .with_meter(1e4)
                .with_colormap(rerun::components::Colormap::Turbo)
                // In stored units, as the meter says: the usual span from a full stack to the floor.
                .with_depth_range([1.8e4, 3.8e4]),
        )?;
        let mut points = Vec::new();
        let mut colors = Vec::new();
        for row in (0..intrinsics.height).step_by(CLOUD_STEP) {
            for column in (0..intrinsics.width).step_by(CLOUD_STEP) {
                let depth = capture.frame.depth_at(column, row);
                if depth > 0.0 {
                    let p = capture.world_from_camera
                        * intrinsics.deproject(column as f64, row as f64, f64::from(depth));
                    points.push([p.x as f32, p.y as f32, p.z as f32]);
                    colors.push(height_color(p.z));
                }
            }
        }
        self.stream.log(
            "world/cloud",
            &Points3D::new(points)
                .with_colors(colors)
                .with_radii([0.004f32]),
        )?;
        self.stream.log(
            "vision/estimates",
            &wireframes(&capture.detections, Color::from_rgb(80, 255, 120), 0.005),
        )?;
        let arrows = capture.detections.iter().map(|(pose, _)| {
            let x = pose.rotation * depal_frames::Vector::x() * 0.15;
            [x.x as f32, x.y as f32, x.z as f32]
        });
        self.stream.log(
            "vision/estimates/x_axis",
            &Arrows3D::from_vectors(arrows)
                .with_origins(capture.detections.iter().map(|(pose, _)| position(pose)))
                .with_colors([Color::from_rgb(255, 90, 90)]),
        )?;
        self.stream.log(
            "vision/truth",
            &wireframes(&capture.truth, Color::from_rgb(255, 255, 255), 0.002),
        )
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
        let result = self.log_capture(capture);
        self.keep(result);
    }
}

/// Draws what stands still, the shapes of what moves, and the names of the plots.
fn log_setup(stream: &RecordingStream, setup: &RecordingSetup) -> RecordingStreamResult<()> {
    stream.log_static("/", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
    stream.log_static(
        "readme",
        &TextDocument::new(setup.readme.as_str()).with_media_type("text/markdown"),
    )?;
    for (name, shapes, rgb) in &setup.fixed {
        let coloured: Vec<_> = shapes.iter().map(|shape| (shape.clone(), *rgb)).collect();
        log_static_shapes(stream, &format!("world/{name}"), &coloured)?;
    }
    for (name, shapes) in &setup.arm_links {
        log_static_shapes(stream, &format!("world/robot/{name}"), shapes)?;
    }
    let mut tool: Vec<_> = setup
        .gripper_bodies
        .iter()
        .map(|body| (body.clone(), [70, 70, 78]))
        .collect();
    for area in &setup.section_areas {
        let centre =
            Pose::translation(0.5 * (area[0] + area[1]), 0.5 * (area[2] + area[3]), -0.004);
        let size = depal_frames::Vector::new(area[1] - area[0], area[3] - area[2], 0.006);
        tool.push((PlacedShape::cuboid(centre, size), [30, 110, 180]));
    }
    log_static_shapes(stream, "world/robot/gripper", &tool)?;
    stream.log_static("world/camera", &transform(&setup.world_from_camera))?;
    let step = IMAGE_STEP as f32;
    let i = &setup.intrinsics;
    stream.log_static(
        "world/camera/image",
        &Pinhole::from_focal_length_and_resolution(
            [i.fx as f32 / step, i.fy as f32 / step],
            [
                (i.width / IMAGE_STEP) as f32,
                (i.height / IMAGE_STEP) as f32,
            ],
        )
        .with_camera_xyz(rerun::components::ViewCoordinates::RDF)
        .with_image_plane_distance(0.3),
    )?;
    for section in 1..=setup.section_areas.len() {
        stream.log_static(
            format!("gripper/vacuum/section_{section}"),
            &SeriesLines::new().with_names([format!("section {section}")]),
        )?;
    }
    Ok(())
}

/// Boxes whose top faces are at the given poses, drawn as lines.
fn wireframes(tops: &[(Pose, [f64; 3])], line: Color, radius: f32) -> Boxes3D {
    let centre =
        |(pose, size): &(Pose, [f64; 3])| pose * Pose::translation(0.0, 0.0, -0.5 * size[2]);
    Boxes3D::from_centers_and_half_sizes(
        tops.iter().map(|top| position(&centre(top))),
        tops.iter()
            .map(|(_, size)| size.map(|side| (side * 0.5) as f32)),
    )
    .with_quaternions(tops.iter().map(|(pose, _)| quaternion(&pose.rotation)))
    .with_colors([line])
    .with_radii([radius])
    .with_fill_mode(FillMode::MajorWireframe)
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

/// Blue on the floor to yellow at two metres.
fn height_color(z: f64) -> Color {
    let t = (z / 2.0).clamp(0.0, 1.0);
    Color::from_rgb(
        (60.0 + 190.0 * t) as u8,
        (90.0 + 130.0 * t) as u8,
        (210.0 - 150.0 * t) as u8,
    )
}

/// 16-bit grey PNG from big-endian pixels.
fn encode_png(pixels: &[u8], width: u32, height: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().expect("a vector takes every byte");
    writer
        .write_image_data(pixels)
        .expect("the buffer has width * height * 2 bytes");
    drop(writer);
    bytes
}
