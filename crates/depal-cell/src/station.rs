//! The vision side of a cell without a robot program: robots come over a network.
//!
//! A station is the cell at rest: settled cartons, the arm standing at its start, and one session a port.
//! Each session has a vision computer of its own, so that no session ever waits for another.
//! Bytes go in, replies come out; time is told with [`Station::advance`].
//! Nothing moves, so that a tick in which nothing is due costs nothing and is skipped.
//!
//! Pictures and plans are computed by [`Errands`], beside the clock. A result is handed over at the tick
//! at which its latency has passed. If it is not there by then, the clock stands still just before that
//! tick, and bytes are answered meanwhile. So the same input at the same ticks gives the same replies,
//! whatever the computer needed.

use std::collections::VecDeque;
use std::sync::Arc;

use depal_camera::RenderShape;
use depal_interface::{ConnectionId, Encoding, LogEntry, PortId, Profile};
use depal_time::{SimTime, TICK};
use depal_world::World;

use crate::cell::{render_shapes, scenery_shapes};
use crate::computing::Elsewhere;
pub use crate::computing::{Errand, Errands};
use crate::error::CellError;
use crate::event::{Event, EventKind};
use crate::picture::Seen;
use crate::score::Score;
use crate::spec::CellSpec;
use crate::truth::TrueCarton;
use crate::vision_side::VisionSide;

/// One reply on its way to a client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StationReply {
    /// Tick at which it was given.
    pub tick: u64,
    /// The port.
    pub port: PortId,
    /// The client.
    pub connection: ConnectionId,
    /// One whole reply, to be sent in one write.
    pub bytes: Vec<u8>,
    /// The connection is to be closed after this.
    pub closes: bool,
}

/// The vision computer behind one port.
struct Lane {
    spec: Arc<CellSpec>,
    vision: VisionSide,
    score: Score,
}

impl Lane {
    /// Takes the pictures of a calibration that are due. The client's robot is where it says it is; of it
    /// only the board is drawn.
    fn calibrate(&mut self, now: SimTime, world: &World, events: &mut Vec<EventKind>) {
        let desk = &mut self.vision.calibration;
        if !desk.is_due(now) {
            return;
        }
        let shapes = in_view(&self.spec, world);
        if let Some(found) = desk.advance(now, &self.spec, &shapes, None, events) {
            Arc::make_mut(&mut self.spec).recalibrate(found);
            if let Some(elsewhere) = &mut self.vision.elsewhere {
                elsewhere.spec = Arc::clone(&self.spec);
            }
        }
    }
}

/// A cell at rest with its vision server.
pub struct Station {
    lanes: Vec<Lane>,
    world: World,
    tick: u64,
    replies: VecDeque<StationReply>,
    log: VecDeque<LogEntry>,
    events: VecDeque<(PortId, Event)>,
}

/// The simulated time of a tick.
fn time_of(tick: u64) -> SimTime {
    SimTime::from_nanos(tick * TICK.as_nanos())
}

/// The first tick that is not before `time`.
fn tick_from(time: SimTime) -> u64 {
    time.as_nanos().div_ceil(TICK.as_nanos())
}

impl Station {
    /// Builds the cell, lets the cartons settle and opens one session for each port of `spec.interface`.
    /// `stopwatch` as for [`crate::cell::Cell::new`].
    pub fn new(
        spec: CellSpec,
        stopwatch: fn() -> f64,
        errands: Errands,
    ) -> Result<Self, CellError> {
        // Refuses settings without a port, which no lane would do.
        spec.interface.check()?;
        let world = spec.world_at_rest();

        let lane = |port| {
            let mut spec = spec.clone();
            spec.interface.ports = vec![port];
            let spec = Arc::new(spec);
            let mut vision = VisionSide::new(&spec, stopwatch)?;
            vision.elsewhere = Some(Elsewhere {
                spec: Arc::clone(&spec),
                errands: Arc::clone(&errands),
            });
            Ok(Lane {
                spec,
                vision,
                score: Score::default(),
            })
        };
        let ports = spec.interface.ports.iter().cloned();
        let lanes: Result<Vec<Lane>, CellError> = ports.map(lane).collect();
        Ok(Self {
            lanes: lanes?,
            world,
            tick: 0,
            replies: VecDeque::new(),
            log: VecDeque::new(),
            events: VecDeque::new(),
        })
    }

    /// How each port speaks.
    pub fn encodings(&self) -> Vec<Encoding> {
        let port = |lane: &Lane| lane.spec.interface.ports[0].encoding;
        self.lanes.iter().map(port).collect()
    }

    /// The output rules of each port.
    pub fn profiles(&self) -> Vec<Profile> {
        let port = |lane: &Lane| lane.spec.interface.ports[0].profile.clone();
        self.lanes.iter().map(port).collect()
    }

    /// Ticks so far.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// A client is there. Calls that name a port which does not exist are ignored.
    pub fn connect(&mut self, port: PortId, connection: ConnectionId) {
        let now = time_of(self.tick);
        if let Some(lane) = self.lanes.get_mut(usize::from(port.0)) {
            lane.vision
                .server
                .handle_connect(now, LANE_PORT, connection);
            self.follow_up(port);
        }
    }

    /// Bytes came from a client. Poll everything afterwards.
    pub fn receive(&mut self, port: PortId, connection: ConnectionId, bytes: &[u8]) {
        let now = time_of(self.tick);
        if let Some(lane) = self.lanes.get_mut(usize::from(port.0)) {
            let server = &mut lane.vision.server;
            server.handle_input(now, LANE_PORT, connection, bytes);
            self.follow_up(port);
        }
    }

    /// A client is gone. What it waited for stays for the next one of its port.
    pub fn disconnect(&mut self, port: PortId, connection: ConnectionId) {
        let now = time_of(self.tick);
        if let Some(lane) = self.lanes.get_mut(usize::from(port.0)) {
            let server = &mut lane.vision.server;
            server.handle_disconnect(now, LANE_PORT, connection);
            self.follow_up(port);
        }
    }

    /// Whether a command of this client waits for a run to end, or for its delayed reply.
    pub fn is_waiting(&self, port: PortId, connection: ConnectionId) -> bool {
        let lane = self.lanes.get(usize::from(port.0));
        lane.is_some_and(|lane| lane.vision.server.is_waiting(LANE_PORT, connection))
    }

    /// Whether a command of this client waits for a run to end.
    pub fn awaits_run(&self, port: PortId, connection: ConnectionId) -> bool {
        let lane = self.lanes.get(usize::from(port.0));
        lane.is_some_and(|lane| lane.vision.server.awaits_run(LANE_PORT, connection))
    }

    /// The next tick at which something is due, always later than [`tick`](Self::tick).
    pub fn next_due(&self) -> Option<u64> {
        self.lanes
            .iter()
            .flat_map(|lane| {
                [
                    lane.vision.server.poll_timeout(),
                    lane.vision.next_due(),
                    lane.vision.calibration.next_due(),
                ]
            })
            .flatten()
            .map(|due| tick_from(due).max(self.tick + 1))
            .min()
    }

    /// Lets time pass up to tick `target`, doing what is due on the way; the tick reached.
    /// It stops just before a tick at which a result is due that is still being computed.
    pub fn advance(&mut self, target: u64) -> u64 {
        while let Some(due) = self.next_due().filter(|due| *due <= target) {
            if self.is_computing(due) {
                self.tick = self.tick.max(due - 1);
                return self.tick;
            }
            self.step(due);
        }
        self.tick = self.tick.max(target);
        self.tick
    }

    /// As [`advance`](Self::advance), but waits for results instead of stopping.
    pub fn advance_waiting(&mut self, target: u64) {
        while let Some(due) = self.next_due().filter(|due| *due <= target) {
            self.step(due);
        }
        self.tick = self.tick.max(target);
    }

    /// The next reply to send.
    pub fn poll_reply(&mut self) -> Option<StationReply> {
        self.replies.pop_front()
    }

    /// The next decoded message.
    pub fn poll_log(&mut self) -> Option<LogEntry> {
        self.log.pop_front()
    }

    /// The next thing that happened, and to whose run.
    pub fn poll_event(&mut self) -> Option<(PortId, Event)> {
        self.events.pop_front()
    }

    fn is_computing(&mut self, tick: u64) -> bool {
        let now = time_of(tick);
        let missing = self
            .lanes
            .iter_mut()
            .map(|lane| lane.vision.is_computing(now));
        // All lanes are asked, so that none is asked in vain at the next call.
        missing.fold(false, |any, one| any | one)
    }

    /// One tick at which something is due.
    fn step(&mut self, tick: u64) {
        self.tick = tick;
        let now = time_of(tick);
        for place in 0..self.lanes.len() {
            let lane = &mut self.lanes[place];
            if lane
                .vision
                .server
                .poll_timeout()
                .is_some_and(|due| due <= now)
            {
                lane.vision.server.handle_timeout(now);
            }
            let seen = lane.vision.is_exposure_due(now).then(|| Seen {
                shapes: in_view(&lane.spec, &self.world),
                base_from_flange: None,
                cartons: cartons(&self.world),
            });
            let mut events = Vec::new();
            let (spec, score) = (Arc::clone(&lane.spec), &mut lane.score);
            let seen = seen.as_ref();
            lane.vision
                .advance(now, &spec, seen, score, &mut events, &mut []);
            lane.calibrate(now, &self.world, &mut events);
            self.keep(PortId(place as u16), events);
            self.follow_up(PortId(place as u16));
        }
    }

    /// Starts what a session asks for, and collects what it says.
    fn follow_up(&mut self, port: PortId) {
        let now = time_of(self.tick);
        let lane = &mut self.lanes[usize::from(port.0)];
        let mut events = Vec::new();
        let spec = Arc::clone(&lane.spec);
        lane.vision
            .take_jobs(now, &spec, &mut lane.score, &mut events);
        while let Some(reply) = lane.vision.server.poll_reply() {
            self.replies.push_back(StationReply {
                tick: self.tick,
                port,
                connection: reply.connection,
                bytes: reply.bytes,
                closes: reply.closes,
            });
        }
        while let Some(entry) = lane.vision.server.poll_log() {
            self.log.push_back(LogEntry { port, ..entry });
        }
        self.keep(port, events);
    }

    fn keep(&mut self, port: PortId, events: Vec<EventKind>) {
        let time = time_of(self.tick);
        let events = events.into_iter().map(|kind| (port, Event { time, kind }));
        self.events.extend(events);
    }
}

/// Each lane's server has one port.
const LANE_PORT: PortId = PortId(0);

/// What a camera sees. The arm of the cell stands at its start; a camera on the flange is on the flange of the
/// client's robot, which is wherever it says it is and is not drawn.
fn in_view(spec: &CellSpec, world: &World) -> Vec<RenderShape> {
    if spec.is_eye_in_hand() {
        scenery_shapes(world, &spec.skins)
    } else {
        render_shapes(world, &spec.skins)
    }
}

/// Every carton lies still and could be asked for.
fn cartons(world: &World) -> Vec<TrueCarton> {
    world
        .cartons()
        .into_iter()
        .map(|carton| TrueCarton {
            id: carton.id.0,
            world_from_centre: carton.world_from_centre,
            size: [carton.size.length, carton.size.width, carton.size.height],
        })
        .collect()
}
