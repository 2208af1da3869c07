//! One port: its connections, its runs, and what waits to be sent.

use std::collections::{BTreeMap, VecDeque};

use depal_time::SimTime;
use depal_wire::{Encoding, Frame, Framer, Reply, Request, Status};

use crate::calibration::Calibration;
use crate::dispatch::{Answer, Asked};
use crate::faults::DialogueFaults;
use crate::job::{Job, JobId, PlannedPath};
use crate::log::{Direction, LogEntry};
use crate::notify::Message;
use crate::outbox::{Held, Outgoing};
use crate::property_config::{PropertyConfig, PropertyConfigError};
use crate::settings::{
    CalibrationPose, PortId, PortSettings, ServerSettings, StepParameter, Variable, VisionProject,
    VizProject,
};
use crate::vision_run::{VisionOutput, VisionRun};
use crate::viz_run::VizRun;

/// Characters of a message in the log.
pub(crate) const LOG_TEXT_LEN: usize = 200;
/// Bytes that a client may send ahead of the replies; more is no client of this protocol.
const MAX_AHEAD: usize = 65_536;

/// A client of a port; the number is chosen by the transport and never used twice on a port.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ConnectionId(pub u64);

/// The state of one port. It outlives connections: results wait for the next client.
#[derive(Debug, Clone)]
pub struct Session {
    pub(crate) port: PortId,
    pub(crate) settings: PortSettings,
    pub(crate) projects: BTreeMap<i32, VisionProject>,
    pub(crate) viz_project: Option<VizProject>,
    pub(crate) vision: BTreeMap<i32, VisionRun>,
    pub(crate) viz: VizRun,
    pub(crate) solutions: Vec<i32>,
    pub(crate) variables: Vec<Variable>,
    pub(crate) property_config: PropertyConfig,
    /// Values of step parameters by step and key, as 208 left them.
    pub(crate) parameters: BTreeMap<(i32, String), StepParameter>,
    pub(crate) calibration_poses: Vec<CalibrationPose>,
    pub(crate) calibration: Calibration,
    pub(crate) needs_robot_pose: bool,
    pub(crate) message: Option<Message>,
    pub(crate) has_camera: bool,
    pub(crate) faults: DialogueFaults,
    pub(crate) connections: BTreeMap<ConnectionId, Framer>,
    /// Requests whose run is not over, in order of arrival; at most one a connection.
    waiting: Vec<Waiting>,
    /// Replies, or pieces of them, whose time has not come; a connection is held up by its own.
    pub(crate) held: Vec<Held>,
    job_count: u32,
    pub(crate) jobs: VecDeque<Job>,
    pub(crate) replies: VecDeque<Outgoing>,
    pub(crate) log: VecDeque<LogEntry>,
}

#[derive(Debug, Clone)]
struct Waiting {
    connection: ConnectionId,
    request: Request,
    deadline: SimTime,
    on_timeout: Reply,
}

impl Session {
    pub(crate) fn new(
        port: PortId,
        settings: PortSettings,
        server: &ServerSettings,
    ) -> Result<Self, PropertyConfigError> {
        let projects: BTreeMap<_, _> = server
            .projects
            .iter()
            .map(|project| (project.id, project.clone()))
            .collect();
        let parameters = server.viz.iter().flat_map(|viz| &viz.parameters);
        Ok(Self {
            port,
            settings,
            vision: projects
                .keys()
                .map(|id| (*id, VisionRun::default()))
                .collect(),
            projects,
            viz_project: server.viz.clone(),
            viz: VizRun::default(),
            solutions: server.solutions.clone(),
            variables: server.variables.clone(),
            property_config: PropertyConfig::parse(&server.property_config)?,
            parameters: parameters
                .map(|p| ((p.step, p.key.clone()), p.clone()))
                .collect(),
            calibration_poses: server.calibration.clone(),
            calibration: Calibration::default(),
            needs_robot_pose: server.needs_robot_pose,
            message: None,
            has_camera: true,
            faults: DialogueFaults::new(&server.faults),
            connections: BTreeMap::new(),
            waiting: Vec::new(),
            held: Vec::new(),
            job_count: 0,
            jobs: VecDeque::new(),
            replies: VecDeque::new(),
            log: VecDeque::new(),
        })
    }

    /// A client is there.
    pub fn handle_connect(&mut self, _now: SimTime, connection: ConnectionId) {
        let length = self.settings.profile.hex_request_len;
        let framer = if self.settings.detects_encoding {
            Framer::detecting(length)
        } else {
            Framer::new(self.settings.encoding, length)
        };
        self.connections.insert(connection, framer);
    }

    /// A client is gone. What it waited for stays for the next one.
    pub fn handle_disconnect(&mut self, _now: SimTime, connection: ConnectionId) {
        self.connections.remove(&connection);
        self.waiting.retain(|w| w.connection != connection);
        self.held.retain(|h| h.outgoing.connection != connection);
        self.replies.retain(|r| r.connection != connection);
    }

    /// Bytes came. Unknown connections are ignored.
    pub fn handle_input(&mut self, now: SimTime, connection: ConnectionId, bytes: &[u8]) {
        if let Some(framer) = self.connections.get_mut(&connection) {
            framer.push(now, bytes);
            self.serve(now, connection);
        }
        let ahead = self
            .connections
            .get(&connection)
            .map_or(0, Framer::buffered);
        if ahead > MAX_AHEAD {
            self.cut(
                now,
                connection,
                format!("{ahead} bytes sent ahead; closing"),
            );
        }
    }

    /// Time passed; call it when [`poll_timeout`](Self::poll_timeout) is due, or in every tick.
    pub fn handle_timeout(&mut self, now: SimTime) {
        while let Some(place) = self.waiting.iter().position(|w| w.deadline <= now) {
            let late = self.waiting.remove(place);
            self.send(now, late.connection, &late.on_timeout, false);
        }
        self.release(now);
        self.serve_all(now);
    }

    /// The next reply to send.
    pub fn poll_reply(&mut self) -> Option<Outgoing> {
        self.replies.pop_front()
    }

    /// The next job to do.
    pub fn poll_job(&mut self) -> Option<Job> {
        self.jobs.pop_front()
    }

    /// The next log entry.
    pub fn poll_log(&mut self) -> Option<LogEntry> {
        self.log.pop_front()
    }

    /// When [`handle_timeout`](Self::handle_timeout) has something to do.
    pub fn poll_timeout(&self) -> Option<SimTime> {
        let deadlines = self.waiting.iter().map(|w| w.deadline);
        let silences = self
            .connections
            .iter()
            .filter(|(id, _)| !self.is_waiting(**id))
            .filter_map(|(_, framer)| framer.poll_timeout());
        let held = self.held.iter().map(|h| h.due);
        deadlines.chain(held).chain(silences).min()
    }

    pub(crate) fn finish_vision(
        &mut self,
        now: SimTime,
        job_id: JobId,
        outcome: Result<VisionOutput, Status>,
    ) {
        self.take_vision_outcome(job_id, outcome);
        self.answer_waiting(now);
    }

    pub(crate) fn finish_viz(
        &mut self,
        now: SimTime,
        job_id: JobId,
        outcome: Result<PlannedPath, Status>,
    ) {
        self.take_viz_outcome(job_id, outcome);
        self.answer_waiting(now);
    }

    pub(crate) fn notify(&mut self, now: SimTime, job_id: JobId, message: i32) {
        self.take_message(now, job_id, message);
        self.answer_waiting(now);
    }

    pub(crate) fn next_job_id(&mut self) -> JobId {
        self.job_count += 1;
        JobId {
            port: self.port,
            number: self.job_count,
        }
    }

    pub(crate) fn is_waiting(&self, connection: ConnectionId) -> bool {
        let is_held = |held: &Held| held.outgoing.connection == connection;
        self.awaits_run(connection) || self.held.iter().any(is_held)
    }

    pub(crate) fn awaits_run(&self, connection: ConnectionId) -> bool {
        self.waiting.iter().any(|w| w.connection == connection)
    }

    /// Asks again for every request that waits, in order of arrival.
    fn answer_waiting(&mut self, now: SimTime) {
        let mut still_waiting = Vec::new();
        for waiting in std::mem::take(&mut self.waiting) {
            match self.dispatch(now, &waiting.request, Asked::Again) {
                Answer::Reply(reply) => self.send(now, waiting.connection, &reply, false),
                Answer::Wait { .. } => still_waiting.push(waiting),
            }
        }
        self.waiting = still_waiting;
        self.serve_all(now);
    }

    fn serve_all(&mut self, now: SimTime) {
        let connections: Vec<_> = self.connections.keys().copied().collect();
        for connection in connections {
            self.serve(now, connection);
        }
    }

    /// Carries out the requests of a connection until one has to wait.
    fn serve(&mut self, now: SimTime, connection: ConnectionId) {
        while !self.is_waiting(connection) {
            let framer = self.connections.get_mut(&connection);
            let Some(frame) = framer.and_then(|framer| framer.poll_frame(now)) else {
                return;
            };
            match frame {
                Frame::Request(bytes) => self.handle_request(now, connection, &bytes),
                Frame::Dropped(count) => {
                    let text = format!("{count} bytes that make no request were dropped");
                    self.record(now, connection, Direction::Received, 0, None, text);
                }
                Frame::TooLong(count) => {
                    let text = format!("line of {count} bytes without an end; closing");
                    self.cut(now, connection, text);
                    return;
                }
            }
        }
    }

    /// Says 3002 and lets the transport close the connection.
    fn cut(&mut self, now: SimTime, connection: ConnectionId, text: String) {
        self.record(now, connection, Direction::Received, 0, None, text);
        self.waiting.retain(|w| w.connection != connection);
        self.send(
            now,
            connection,
            &Reply::status(0, Status::WrongFormat),
            true,
        );
        self.connections.remove(&connection);
    }

    fn handle_request(&mut self, now: SimTime, connection: ConnectionId, bytes: &[u8]) {
        let encoding = self.encoding_of(connection);
        let request = match Request::decode(encoding, bytes) {
            Ok(request) => request,
            Err(error) => {
                let command = error.command;
                self.record(
                    now,
                    connection,
                    Direction::Received,
                    command,
                    None,
                    format!("refused: {}", error.reason),
                );
                let reply = Reply::status(command, error.status);
                self.send(now, connection, &reply, false);
                return;
            }
        };
        let text = match &request {
            Request::Unknown { code } => text_of_unknown(encoding, *code),
            known => format!("{} ({})", known.text(), known.name()),
        };
        self.record(
            now,
            connection,
            Direction::Received,
            request.code(),
            None,
            text,
        );
        if let Some((status, cause)) = self.faults.on_command(request.code()) {
            let reply = Reply::status(request.code(), status);
            self.send_because(now, connection, &reply, false, vec![cause]);
            return;
        }
        let runs_before = self.job_count;
        match self.dispatch(now, &request, Asked::First) {
            Answer::Reply(reply) => self.send(now, connection, &reply, false),
            Answer::Wait { on_timeout } => self.waiting.push(Waiting {
                connection,
                request: request.clone(),
                deadline: now + self.settings.timeout,
                on_timeout,
            }),
        }
        // A new run or a stop may answer what other connections wait for.
        if self.job_count != runs_before || matches!(request, Request::StopViz(_)) {
            self.answer_waiting(now);
        }
    }

    /// What the connection speaks; the port's own encoding until that is found out.
    pub(crate) fn encoding_of(&self, connection: ConnectionId) -> Encoding {
        let framer = self.connections.get(&connection);
        framer
            .and_then(Framer::encoding)
            .unwrap_or(self.settings.encoding)
    }

    pub(crate) fn record(
        &mut self,
        at: SimTime,
        connection: ConnectionId,
        direction: Direction,
        command: i32,
        status: Option<i32>,
        text: String,
    ) {
        let text = if text.chars().count() > LOG_TEXT_LEN {
            let head: String = text.chars().take(LOG_TEXT_LEN).collect();
            format!("{head}...")
        } else {
            text
        };
        self.log.push_back(LogEntry {
            at,
            port: self.port,
            connection,
            direction,
            command,
            status,
            faults: Vec::new(),
            text,
        });
    }
}

fn text_of_unknown(encoding: Encoding, code: i32) -> String {
    let swapped = code.swap_bytes();
    if encoding.is_hex() && Request::is_known(swapped) {
        format!(
            "unknown command {code}; byte order? Swapped it is {swapped}, and this port reads {}",
            encoding.name()
        )
    } else {
        format!("unknown command {code}")
    }
}
