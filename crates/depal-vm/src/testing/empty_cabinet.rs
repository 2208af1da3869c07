use std::task::Poll;

use depal_frames::{JointPositions, Pose};
use depal_time::SimTime;

use crate::system::{
    Fault, LogKind, MoveId, MoveRequest, ProgramLocation, Received, SocketId, SocketState, System,
};

/// A cabinet with nothing in it, which counts statements: for programs that only compute, in benches and tests of
/// languages. Its time stands still, signals are not there, moves and connections stay pending.
#[derive(Debug, Clone)]
pub struct EmptyCabinet {
    per_cycle: u32,
    in_cycle: u32,
    statements: u64,
}

impl EmptyCabinet {
    /// A cabinet whose cycles have room for so many statements; 1 sees each of them.
    pub fn new(per_cycle: u32) -> Self {
        Self {
            per_cycle: per_cycle.max(1),
            in_cycle: 0,
            statements: 0,
        }
    }

    /// How many statements ran.
    pub fn statements(&self) -> u64 {
        self.statements
    }
}

impl System for EmptyCabinet {
    fn spare_statements(&self) -> u32 {
        self.per_cycle - 1 - self.in_cycle
    }
    fn statements_ran(&mut self, count: u32) {
        assert!(
            count <= self.spare_statements(),
            "no more statements than there is time for"
        );
        self.in_cycle += count;
        self.statements += u64::from(count);
    }
    fn statement(&mut self, _: &ProgramLocation) {
        self.in_cycle = (self.in_cycle + 1) % self.per_cycle;
        self.statements += 1;
    }
    fn now(&self) -> SimTime {
        SimTime::ZERO
    }
    fn signal(&self, name: &str) -> Result<f64, Fault> {
        Err(Fault::UnknownSignal(name.to_owned()))
    }
    fn set_signal(&mut self, name: &str, _: f64) -> Result<(), Fault> {
        Err(Fault::UnknownSignal(name.to_owned()))
    }
    fn start_move(&mut self, _: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        Poll::Pending
    }
    fn is_move_done(&self, _: MoveId) -> Result<bool, Fault> {
        Ok(true)
    }
    fn is_standing(&self) -> bool {
        true
    }
    fn stop_motion(&mut self) {}
    fn joints(&self) -> JointPositions {
        JointPositions::zeros(6)
    }
    fn planned_joints(&self) -> JointPositions {
        self.joints()
    }
    fn forward(&self, _: &JointPositions) -> Pose {
        Pose::identity()
    }
    fn inverse(&self, _: &Pose, near: &JointPositions) -> Result<JointPositions, Fault> {
        Ok(*near)
    }
    fn socket_create(&mut self) -> SocketId {
        SocketId(0)
    }
    fn socket_connect(&mut self, _: SocketId, _: &str, _: u16) -> Poll<Result<(), Fault>> {
        Poll::Pending
    }
    fn socket_send(&mut self, _: SocketId, _: &[u8]) -> Result<(), Fault> {
        Err(Fault::SocketClosed)
    }
    fn socket_receive(&mut self, _: SocketId, _: usize) -> Poll<Result<Received, Fault>> {
        Poll::Pending
    }
    fn socket_close(&mut self, _: SocketId) {}
    fn socket_state(&self, _: SocketId) -> SocketState {
        SocketState::Closed
    }
    fn log(&mut self, _: LogKind, _: &ProgramLocation, _: &str) {}
}
