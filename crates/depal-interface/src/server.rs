use depal_time::SimTime;
use depal_wire::Status;

use crate::job::{Job, JobId, PlannedPath, VisionOutcome, VisionResult, VizOutcome};
use crate::log::LogEntry;
use crate::outbox::Outgoing;
use crate::session::{ConnectionId, Session};
use crate::settings::{InterfaceError, PortId, ServerSettings};
use crate::vision_run::VisionOutput;

/// All ports together. Sessions never touch one another.
///
/// Calls that name a port which does not exist are ignored.
#[derive(Debug, Clone)]
pub struct Server {
    sessions: Vec<Session>,
}

impl Server {
    /// Sets up one session a port.
    pub fn new(settings: ServerSettings) -> Result<Self, InterfaceError> {
        settings.check()?;
        let sessions = settings
            .ports
            .iter()
            .enumerate()
            .map(|(place, port)| Session::new(PortId(place as u16), port.clone(), &settings))
            .collect::<Result<_, _>>()?;
        Ok(Self { sessions })
    }

    /// A client connected to a port.
    pub fn handle_connect(&mut self, now: SimTime, port: PortId, connection: ConnectionId) {
        if let Some(session) = self.session(port) {
            session.handle_connect(now, connection);
        }
    }

    /// Bytes came from a client. Poll everything afterwards.
    pub fn handle_input(
        &mut self,
        now: SimTime,
        port: PortId,
        connection: ConnectionId,
        bytes: &[u8],
    ) {
        if let Some(session) = self.session(port) {
            session.handle_input(now, connection, bytes);
        }
    }

    /// A client is gone.
    pub fn handle_disconnect(&mut self, now: SimTime, port: PortId, connection: ConnectionId) {
        if let Some(session) = self.session(port) {
            session.handle_disconnect(now, connection);
        }
    }

    /// Time passed. Poll everything afterwards.
    pub fn handle_timeout(&mut self, now: SimTime) {
        for session in &mut self.sessions {
            session.handle_timeout(now);
        }
    }

    /// The result of a [`Job::RunVision`] of a project with plain vision points.
    pub fn finish_vision(&mut self, now: SimTime, job_id: JobId, outcome: VisionOutcome) {
        let outcome = outcome.map(|points| VisionResult {
            points,
            ..VisionResult::default()
        });
        self.finish_vision_custom(now, job_id, outcome);
    }

    /// The result of a [`Job::RunVision`] of a project with custom ports.
    pub fn finish_vision_custom(
        &mut self,
        now: SimTime,
        job_id: JobId,
        outcome: Result<VisionResult, Status>,
    ) {
        if let Some(session) = self.session(job_id.port) {
            session.finish_vision(now, job_id, outcome.map(VisionOutput::Points));
        }
    }

    /// The result of a [`Job::RunVision`] of a project that plans a path.
    pub fn finish_vision_path(
        &mut self,
        now: SimTime,
        job_id: JobId,
        outcome: Result<PlannedPath, Status>,
    ) {
        if let Some(session) = self.session(job_id.port) {
            session.finish_vision(now, job_id, outcome.map(VisionOutput::Path));
        }
    }

    /// A run of a [`Job::RunVision`] or [`Job::StartViz`] comes to a notify step: the robot may fetch its
    /// message, a positive number, for as long as the port holds it.
    pub fn notify(&mut self, now: SimTime, job_id: JobId, message: i32) {
        if let Some(session) = self.session(job_id.port) {
            session.notify(now, job_id, message);
        }
    }

    /// Whether a camera answers; 901 tells it from version 2.2. True at the start.
    pub fn set_camera_connected(&mut self, is_connected: bool) {
        for session in &mut self.sessions {
            session.has_camera = is_connected;
        }
    }

    /// A counting step has other places than before, as a [`Job::WriteParameter`] may bring about.
    pub fn set_places(&mut self, port: PortId, step: i32, places: i32) {
        let viz = self.session(port).and_then(|s| s.viz_project.as_mut());
        for known in viz.into_iter().flat_map(|viz| &mut viz.index_steps) {
            if known.step == step {
                known.places = places;
            }
        }
    }

    /// The run of a [`Job::StartViz`] stands at a branch step; the answer is a [`Job::SetBranch`],
    /// at once if the robot has already chosen.
    pub fn viz_waiting_at_branch(&mut self, _now: SimTime, job_id: JobId, step: i32) {
        if let Some(session) = self.session(job_id.port) {
            session.take_branch_wait(job_id, step);
        }
    }

    /// The result of a [`Job::StartViz`]: one round, no custom values.
    pub fn finish_viz(&mut self, now: SimTime, job_id: JobId, outcome: VizOutcome) {
        self.finish_viz_path(now, job_id, outcome.map(PlannedPath::from));
    }

    /// The result of a [`Job::StartViz`] with rounds and custom values.
    pub fn finish_viz_path(
        &mut self,
        now: SimTime,
        job_id: JobId,
        outcome: Result<PlannedPath, Status>,
    ) {
        if let Some(session) = self.session(job_id.port) {
            session.finish_viz(now, job_id, outcome);
        }
    }

    /// The next reply to send, ports in order.
    pub fn poll_reply(&mut self) -> Option<Outgoing> {
        self.sessions.iter_mut().find_map(Session::poll_reply)
    }

    /// The next job to do.
    pub fn poll_job(&mut self) -> Option<Job> {
        self.sessions.iter_mut().find_map(Session::poll_job)
    }

    /// The next decoded message for the event log.
    pub fn poll_log(&mut self) -> Option<LogEntry> {
        self.sessions.iter_mut().find_map(Session::poll_log)
    }

    /// When [`handle_timeout`](Self::handle_timeout) has something to do; ask again after every call.
    pub fn poll_timeout(&self) -> Option<SimTime> {
        self.sessions.iter().filter_map(Session::poll_timeout).min()
    }

    /// Whether a command of this client waits for a run to end, or for its delayed reply; what it sends meanwhile waits, too.
    pub fn is_waiting(&self, port: PortId, connection: ConnectionId) -> bool {
        let session = self.sessions.get(usize::from(port.0));
        session.is_some_and(|session| session.is_waiting(connection))
    }

    /// Whether a command of this client waits for a run to end.
    pub fn awaits_run(&self, port: PortId, connection: ConnectionId) -> bool {
        let session = self.sessions.get(usize::from(port.0));
        session.is_some_and(|session| session.awaits_run(connection))
    }

    fn session(&mut self, port: PortId) -> Option<&mut Session> {
        self.sessions.get_mut(usize::from(port.0))
    }
}
