use std::task::Poll;

use depal_frames::{JointPositions, Pose};
use depal_time::SimTime;
use depal_vm::system::{
    Fault, LogKind, MoveId, MoveRequest, ProgramLocation, Received, SocketId, SocketState, System,
};

use crate::{Cabinet, ControllerEvent, Network};

/// The cabinet as its task sees it within a cycle: with the network at hand and the time of the statement.
pub(crate) struct CabinetSystem<'a> {
    pub cabinet: &'a mut Cabinet,
    pub network: &'a mut dyn Network,
}

impl System for CabinetSystem<'_> {
    fn now(&self) -> SimTime {
        self.cabinet.cursor
    }

    fn signal(&self, name: &str) -> Result<f64, Fault> {
        self.cabinet.signals.get(name).map(|signal| signal.value)
    }

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        let at = self.cabinet.cursor;
        if let Some(signal) = self.cabinet.signals.set(at, name, value, false)? {
            self.cabinet.fresh.push(ControllerEvent::SignalEdge {
                at,
                name: signal.spec.name.clone(),
                value,
            });
        }
        Ok(())
    }

    fn start_move(&mut self, request: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        let cabinet = &mut *self.cabinet;
        cabinet
            .motion
            .start(cabinet.cursor, request, &mut cabinet.fresh)
    }

    fn is_move_done(&self, id: MoveId) -> Result<bool, Fault> {
        self.cabinet.motion.is_done(self.cabinet.cursor, id)
    }

    fn is_standing(&self) -> bool {
        self.cabinet.motion.is_standing(self.cabinet.cursor)
    }

    fn stop_motion(&mut self) {
        let cabinet = &mut *self.cabinet;
        cabinet.motion.stop(
            cabinet.cursor,
            "the program stops the motion",
            &mut cabinet.fresh,
        );
    }

    fn joints(&self) -> JointPositions {
        self.cabinet.motion.joints(self.cabinet.cursor)
    }

    fn planned_joints(&self) -> JointPositions {
        self.cabinet.motion.planned_joints()
    }

    fn forward(&self, joints: &JointPositions) -> Pose {
        self.cabinet.arm.base_from_flange(joints)
    }

    fn inverse(
        &self,
        base_from_flange: &Pose,
        near: &JointPositions,
    ) -> Result<JointPositions, Fault> {
        self.cabinet
            .arm
            .inverse_nearest(base_from_flange, near)
            .ok_or_else(|| {
                let p = base_from_flange.translation.vector * 1e3;
                Fault::OutOfReach {
                    message: format!(
                        "no joint positions reach the flange at x {:.1}, y {:.1}, z {:.1} mm in the robot base",
                        p.x, p.y, p.z
                    ),
                }
            })
    }

    fn socket_create(&mut self) -> SocketId {
        self.cabinet.sockets.create()
    }

    fn socket_connect(
        &mut self,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        let cabinet = &mut *self.cabinet;
        cabinet.sockets.connect(
            self.network,
            cabinet.cursor,
            &cabinet.name,
            socket,
            (address, port),
        )
    }

    fn socket_send(&mut self, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        let cabinet = &mut *self.cabinet;
        cabinet
            .sockets
            .send(self.network, cabinet.cursor, &cabinet.name, socket, bytes)
    }

    fn socket_receive(&mut self, socket: SocketId, limit: usize) -> Poll<Result<Received, Fault>> {
        let cabinet = &mut *self.cabinet;
        cabinet
            .sockets
            .receive(self.network, cabinet.cursor, &cabinet.name, socket, limit)
    }

    fn socket_close(&mut self, socket: SocketId) {
        let cabinet = &mut *self.cabinet;
        cabinet
            .sockets
            .close(self.network, cabinet.cursor, &cabinet.name, socket);
    }

    fn socket_state(&self, socket: SocketId) -> SocketState {
        self.cabinet.sockets.state(socket)
    }

    fn log(&mut self, kind: LogKind, location: &ProgramLocation, text: &str) {
        self.cabinet.fresh.push(ControllerEvent::Log {
            at: self.cabinet.cursor,
            kind,
            location: location.clone(),
            text: text.to_owned(),
        });
    }

    fn statement(&mut self, location: &ProgramLocation) {
        self.cabinet.statement = Some((self.cabinet.cursor, location.clone()));
    }
}
