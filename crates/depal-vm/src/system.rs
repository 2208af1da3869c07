//! What a robot program may ask of the cabinet it runs in. Languages know only this trait;
//! the controller implements it, tests use a fake.
//!
//! Nothing here blocks: what is not ready yet answers [`Pending`](std::task::Poll::Pending), and the
//! machine asks again later.

use std::task::Poll;

use depal_frames::{JointPositions, Point, Pose};
use depal_time::{SimDuration, SimTime};

pub use crate::path_length::path_length;
pub use crate::signal_check::{Relation, SignalCheck};
pub use moves::{
    MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, PathAction, PathEvent, PathPlace,
};

mod moves;

/// Where in the user's program something was asked for.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct ProgramLocation {
    /// Task name, `T_ROB1`.
    pub task: String,
    /// Module name as spelled in the source.
    pub module: String,
    /// Routine name as spelled in the source.
    pub routine: String,
    /// Line in the module's file, from 1.
    pub line: u32,
}

/// A socket of a program, valid until closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SocketId(pub u32);

/// A move that was accepted into the motion queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MoveId(pub u64);

/// What the cabinet refuses or reports; a language maps it to its own error values.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Fault {
    /// No signal of this name.
    UnknownSignal(String),
    /// The value does not fit the signal (group width, digital 0/1, input).
    SignalValue {
        /// The signal.
        signal: String,
        /// What is wrong.
        message: String,
    },
    /// No joint solution: out of reach, or a joint limit.
    OutOfReach {
        /// Which target or joint, with numbers.
        message: String,
    },
    /// The target can be reached, but not in the arm configuration that it asks for.
    Configuration {
        /// Which joint, with numbers.
        message: String,
    },
    /// The motion supervision stopped the arm (collision).
    MotionSupervision {
        /// What was hit, how hard.
        message: String,
    },
    /// The peer closed, refused or was never there.
    SocketClosed,
    /// The socket is in the wrong state (not connected, already connected).
    SocketState {
        /// What was expected and found.
        message: String,
    },
    /// The port of this cabinet is taken.
    AddressInUse {
        /// Address and port.
        address: String,
    },
    /// A file of the program's folder: not there, not allowed, not readable.
    File {
        /// The path as the program spells it, and why.
        message: String,
    },
    /// The cabinet has no such thing.
    NotThere {
        /// What was asked for.
        message: String,
    },
}

/// What an operator is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// The instruction, `UINumEntry`.
    pub instruction: &'static str,
    /// The text that the operator would read.
    pub text: String,
}

/// What arrived on a socket.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Received {
    /// At least one byte, at most as many as asked for.
    Data(Vec<u8>),
    /// The peer closed and nothing is left to read.
    Closed,
}

/// The state of a socket as programs ask for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SocketState {
    /// Created, not connected.
    Created,
    /// Connected.
    Connected,
    /// Bound to a port of this cabinet.
    Bound,
    /// Takes connections.
    Listening,
    /// Closed, or never created.
    Closed,
}

/// Who reads an operator message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogKind {
    /// The operator's screen (TPWrite).
    Operator,
    /// The controller's event log (ErrWrite, stops).
    EventLog,
}

/// The cabinet as a program sees it.
pub trait System {
    /// Simulated time of the statement now executing (moves on between statements).
    fn now(&self) -> SimTime;

    /// Value of a signal: 0 or 1, or the number of a group or analogue signal.
    fn signal(&self, name: &str) -> Result<f64, Fault>;
    /// Sets an output (digital, group, analogue).
    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault>;

    /// Hands a move to the motion queue. `Pending` while the queue is full.
    /// A fault is that of this move (out of reach) or of the motion as a whole (supervision).
    fn start_move(&mut self, request: &MoveRequest) -> Poll<Result<MoveId, Fault>>;
    /// Whether a move is over: it reached its fine point, or its corner was left behind.
    fn is_move_done(&self, id: MoveId) -> Result<bool, Fault>;
    /// Whether the arm stands and nothing is queued.
    fn is_standing(&self) -> bool;
    /// Drops what is queued and stops the arm (program stop).
    fn stop_motion(&mut self);

    /// Measured joints now, radians.
    fn joints(&self) -> JointPositions;
    /// Joint positions at the end of all queued moves, radians: where the next move will start.
    fn planned_joints(&self) -> JointPositions;
    /// `base_from_flange` of joint positions.
    fn forward(&self, joints: &JointPositions) -> Pose;
    /// Joint positions for `base_from_flange`, nearest to `near`.
    fn inverse(
        &self,
        base_from_flange: &Pose,
        near: &JointPositions,
    ) -> Result<JointPositions, Fault>;

    /// A new, unconnected client socket.
    fn socket_create(&mut self) -> SocketId;
    /// Connects. Asked again until ready. A refusal is `SocketClosed`.
    fn socket_connect(
        &mut self,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>>;
    /// Sends all bytes.
    fn socket_send(&mut self, socket: SocketId, bytes: &[u8]) -> Result<(), Fault>;
    /// Takes what has arrived, at most `limit` bytes; `Pending` if nothing has.
    fn socket_receive(&mut self, socket: SocketId, limit: usize) -> Poll<Result<Received, Fault>>;
    /// Closes; unread bytes are lost.
    fn socket_close(&mut self, socket: SocketId);
    /// The state of a socket.
    fn socket_state(&self, socket: SocketId) -> SocketState;

    /// When a call began: the same time as [`now`](Self::now), asked for the record only.
    /// A cabinet that wants to know whether a waiting program looks at the clock counts `now`, not this.
    fn call_time(&self) -> SimTime {
        self.now()
    }
    /// Sets a signal after a delay (the end of a pulse). A later call for the same signal replaces it.
    fn set_signal_later(
        &mut self,
        name: &str,
        value: f64,
        delay: SimDuration,
    ) -> Result<(), Fault> {
        let _ = (value, delay);
        Err(Fault::NotThere {
            message: format!("pulses on signal {name}"),
        })
    }
    /// As [`start_move`](Self::start_move), with outputs that are set along the way.
    fn start_move_with_events(
        &mut self,
        request: &MoveRequest,
        events: &[PathEvent],
    ) -> Poll<Result<MoveId, Fault>> {
        if events.is_empty() {
            return self.start_move(request);
        }
        Poll::Ready(Err(Fault::NotThere {
            message: "outputs that are set along the way".into(),
        }))
    }
    /// What hangs on the flange all the time, in moves handed over from now on: mass in kg, centre of mass in metres in
    /// the flange frame; `None` for what the cabinet was set up with. A cabinet without torque limits has no use for it.
    fn set_tool_load(&mut self, load: Option<(f64, Point)>) {
        let _ = load;
    }
    /// The load carried on top of it, of moves handed over from now on: mass in kg, centre of mass in metres in the
    /// frame of the tool that the move names. A cabinet without torque limits has no use for it.
    fn set_payload(&mut self, mass: f64, centre_in_tcp: Point) {
        let _ = (mass, centre_in_tcp);
    }
    /// Whether the arm has begun with a move: the corner before it is behind.
    fn is_move_begun(&self, id: MoveId) -> bool {
        let _ = id;
        true
    }
    /// Stops the arm on its path and keeps the path. Ready when it stands. Calling it again does no harm.
    fn hold_motion(&mut self) -> Poll<Result<(), Fault>> {
        Poll::Ready(Err(Fault::NotThere {
            message: "a motion that can be held".into(),
        }))
    }
    /// The arm goes on along the path that was held.
    fn resume_motion(&mut self) -> Result<(), Fault> {
        Err(Fault::NotThere {
            message: "a motion that can be held".into(),
        })
    }
    /// Drops the path that is held, and the hold.
    fn clear_path(&mut self) -> Result<(), Fault> {
        Err(Fault::NotThere {
            message: "a motion that can be held".into(),
        })
    }
    /// Puts the path aside, so that other moves can be made meanwhile. Ready when the arm stands.
    fn store_path(&mut self) -> Poll<Result<(), Fault>> {
        Poll::Ready(Err(Fault::NotThere {
            message: "paths that can be put aside".into(),
        }))
    }
    /// Takes up the path that was put aside last; the arm must stand where it left it.
    fn restore_path(&mut self) -> Result<(), Fault> {
        Err(Fault::NotThere {
            message: "paths that can be put aside".into(),
        })
    }
    /// Binds a created socket to a port of this cabinet.
    fn socket_bind(&mut self, socket: SocketId, address: &str, port: u16) -> Result<(), Fault> {
        let _ = (socket, address, port);
        Err(Fault::NotThere {
            message: "server sockets".into(),
        })
    }
    /// A bound socket begins to take connections.
    fn socket_listen(&mut self, socket: SocketId) -> Result<(), Fault> {
        let _ = socket;
        Err(Fault::NotThere {
            message: "server sockets".into(),
        })
    }
    /// The next connection to a listening socket: a connected socket and the peer's address.
    fn socket_accept(&mut self, socket: SocketId) -> Poll<Result<(SocketId, String), Fault>> {
        let _ = socket;
        Poll::Ready(Err(Fault::NotThere {
            message: "server sockets".into(),
        }))
    }
    /// The operator's answer to a question; `Pending` while nobody answers.
    fn answer(&mut self, question: &Question) -> Poll<String> {
        let _ = question;
        Poll::Pending
    }
    /// The bytes of a file in the program's folder.
    fn read_file(&mut self, path: &str) -> Result<Vec<u8>, Fault> {
        Err(Fault::File {
            message: format!("{path}: this cabinet has no files"),
        })
    }
    /// Writes a file in the program's folder, whole.
    fn write_file(&mut self, path: &str, bytes: &[u8]) -> Result<(), Fault> {
        let _ = bytes;
        Err(Fault::File {
            message: format!("{path}: this cabinet has no files"),
        })
    }

    /// How many statements beside the one that begins now fit into this cycle. A task may run so many, if they
    /// ask nothing of the cabinet, in the same step, and tells with [`statements_ran`](Self::statements_ran).
    /// A cabinet that says 0, as by default, sees each statement.
    fn spare_statements(&self) -> u32 {
        0
    }
    /// So many statements ran that asked nothing of the cabinet; the time of each has passed. The statement under
    /// way is not among them.
    fn statements_ran(&mut self, count: u32) {
        let _ = count;
    }
    /// Adds to the end of a file in the program's folder; a file that is not there is made.
    fn append_file(&mut self, path: &str, bytes: &[u8]) -> Result<(), Fault> {
        let mut all = self.read_file(path).unwrap_or_default();
        all.extend_from_slice(bytes);
        self.write_file(path, &all)
    }
    /// Removes a file from the program's folder.
    fn remove_file(&mut self, path: &str) -> Result<(), Fault> {
        Err(Fault::File {
            message: format!("{path}: this cabinet has no files"),
        })
    }
    /// Paths of all files in the program's folder; a folder without files ends in a slash.
    fn file_names(&self) -> Vec<String> {
        Vec::new()
    }

    /// An attribute of the controller's configuration: domain, type and name of the instance, and its name there.
    fn configuration(&self, instance: [&str; 3], attribute: &str) -> Option<String> {
        let _ = (instance, attribute);
        None
    }

    /// Number of the task among those of its cabinet, from 1.
    fn task_number(&self) -> usize {
        1
    }
    /// Whether the task moves the arm; in a task that does not, moves are refused.
    fn task_moves_arm(&self) -> bool {
        true
    }
    /// How many notices of this name moves have given.
    fn notices(&self, name: &str) -> u64 {
        let _ = name;
        0
    }
    /// Waits at a meeting point until all tasks of these names, this one among them, wait there. Then each is told
    /// once that it may go on. A name that is no task of the cabinet is a fault.
    fn meet(&mut self, point: &str, tasks: &[String]) -> Poll<Result<(), Fault>> {
        let _ = tasks;
        Poll::Ready(Err(Fault::NotThere {
            message: format!("other tasks to meet at {point}"),
        }))
    }
    /// Waits no longer at a meeting point.
    fn leave_meeting(&mut self, point: &str) {
        let _ = point;
    }

    /// A line for the operator or the event log.
    fn log(&mut self, kind: LogKind, location: &ProgramLocation, text: &str);
    /// A statement is about to run (for the trace and the replay).
    fn statement(&mut self, location: &ProgramLocation);
}
