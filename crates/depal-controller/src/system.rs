use std::task::Poll;

use depal_frames::{JointPositions, Point, Pose};
use depal_time::{SimDuration, SimTime};
use depal_vm::system::{
    Fault, LogKind, MoveId, MoveRequest, PathAction, PathEvent, ProgramLocation, Question,
    Received, SocketId, SocketState, System,
};

use crate::{Cabinet, ControllerEvent, Network};

/// The cabinet as its task sees it within a cycle: with the network at hand and the time of the statement.
pub(crate) struct CabinetSystem<'a> {
    pub cabinet: &'a mut Cabinet,
    pub network: &'a mut dyn Network,
}

impl CabinetSystem<'_> {
    /// Whether an output of this name can have this value.
    fn check_output(&self, name: &str, value: f64) -> Result<(), Fault> {
        let signal = self.cabinet.signals.get(name)?;
        let checked = if signal.spec.kind.is_input() {
            Err("is an input of the robot, the program cannot set it".to_owned())
        } else {
            signal.spec.kind.check(value)
        };
        checked.map_err(|message| Fault::SignalValue {
            signal: name.to_owned(),
            message,
        })
    }
}

impl System for CabinetSystem<'_> {
    fn now(&self) -> SimTime {
        self.cabinet.looked.set(true);
        self.cabinet.cursor
    }

    fn call_time(&self) -> SimTime {
        self.cabinet.cursor
    }

    fn signal(&self, name: &str) -> Result<f64, Fault> {
        self.cabinet.signals.get(name).map(|signal| signal.value)
    }

    fn set_signal(&mut self, name: &str, value: f64) -> Result<(), Fault> {
        let at = self.cabinet.cursor;
        self.cabinet
            .later
            .retain(|(_, later, _)| !later.eq_ignore_ascii_case(name));
        self.cabinet.change(at, name, value, false)
    }

    fn set_signal_later(
        &mut self,
        name: &str,
        value: f64,
        delay: SimDuration,
    ) -> Result<(), Fault> {
        self.check_output(name, value)?;
        let later = &mut self.cabinet.later;
        later.retain(|(_, other, _)| !other.eq_ignore_ascii_case(name));
        later.push((self.cabinet.cursor + delay, name.to_owned(), value));
        Ok(())
    }

    fn start_move(&mut self, request: &MoveRequest) -> Poll<Result<MoveId, Fault>> {
        self.start_move_with_events(request, &[])
    }

    fn start_move_with_events(
        &mut self,
        request: &MoveRequest,
        events: &[PathEvent],
    ) -> Poll<Result<MoveId, Fault>> {
        let role = &self.cabinet.tasks[self.cabinet.current].role;
        if !role.moves_arm {
            return Poll::Ready(Err(Fault::NotThere {
                message: format!(
                    "an arm for task {}; moves belong into the task that moves the robot",
                    role.name
                ),
            }));
        }
        for event in events {
            if let PathAction::Set { signal, value } = &event.action
                && let Err(fault) = self.check_output(signal, *value)
            {
                return Poll::Ready(Err(fault));
            }
        }
        let cabinet = &mut *self.cabinet;
        cabinet
            .motion
            .start(cabinet.cursor, request, events, &mut cabinet.fresh)
    }

    fn set_tool_load(&mut self, load: Option<(f64, Point)>) {
        self.cabinet.motion.set_tool_load(load);
    }

    fn set_payload(&mut self, mass: f64, centre_in_tcp: Point) {
        self.cabinet.motion.set_payload(mass, centre_in_tcp);
    }

    fn is_move_begun(&self, id: MoveId) -> bool {
        self.cabinet.motion.is_begun(self.cabinet.cursor, id)
    }

    fn hold_motion(&mut self) -> Poll<Result<(), Fault>> {
        let cabinet = &mut *self.cabinet;
        cabinet
            .motion
            .hold(cabinet.cursor, &mut cabinet.fresh)
            .map(Ok)
    }

    fn resume_motion(&mut self) -> Result<(), Fault> {
        let cabinet = &mut *self.cabinet;
        cabinet.motion.resume(cabinet.cursor, &mut cabinet.fresh);
        Ok(())
    }

    fn clear_path(&mut self) -> Result<(), Fault> {
        let cabinet = &mut *self.cabinet;
        if !cabinet.motion.is_resting(cabinet.cursor) {
            return Err(Fault::NotThere {
                message:
                    "a path that may be cleared while the arm moves; stop it with StopMove first"
                        .into(),
            });
        }
        let reason = "the program clears the path";
        cabinet
            .motion
            .clear(cabinet.cursor, reason, &mut cabinet.fresh);
        Ok(())
    }

    fn store_path(&mut self) -> Poll<Result<(), Fault>> {
        let cabinet = &mut *self.cabinet;
        cabinet.motion.store(cabinet.cursor, &mut cabinet.fresh)
    }

    fn restore_path(&mut self) -> Result<(), Fault> {
        let cabinet = &mut *self.cabinet;
        cabinet.motion.restore(cabinet.cursor)
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
        self.cabinet.motion.forward(joints)
    }

    fn inverse(
        &self,
        base_from_flange: &Pose,
        near: &JointPositions,
    ) -> Result<JointPositions, Fault> {
        self.cabinet
            .motion
            .inverse(base_from_flange, near)
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
        self.cabinet.sockets.create(self.cabinet.current)
    }

    fn socket_connect(
        &mut self,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        self.cabinet.looked.set(true);
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
        self.cabinet.looked.set(true);
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

    fn socket_bind(&mut self, socket: SocketId, address: &str, port: u16) -> Result<(), Fault> {
        self.cabinet.sockets.bind(socket, address, port)
    }

    fn socket_listen(&mut self, socket: SocketId) -> Result<(), Fault> {
        let cabinet = &mut *self.cabinet;
        cabinet
            .sockets
            .listen(self.network, cabinet.cursor, &cabinet.name, socket)
    }

    fn socket_accept(&mut self, socket: SocketId) -> Poll<Result<(SocketId, String), Fault>> {
        self.cabinet.looked.set(true);
        let cabinet = &mut *self.cabinet;
        cabinet
            .sockets
            .accept(self.network, cabinet.cursor, &cabinet.name, socket)
    }

    fn answer(&mut self, question: &Question) -> Poll<String> {
        let Some(answer) = self.cabinet.answers.pop_front() else {
            return Poll::Pending;
        };
        self.cabinet.fresh.push(ControllerEvent::Answered {
            at: self.cabinet.cursor,
            instruction: question.instruction,
            text: question.text.clone(),
            answer: answer.clone(),
        });
        Poll::Ready(answer)
    }

    fn read_file(&mut self, path: &str) -> Result<Vec<u8>, Fault> {
        let found = self.cabinet.files.get(path).cloned();
        found.ok_or_else(|| Fault::File {
            message: format!("{path}: there is no such file in the program's folder"),
        })
    }

    fn write_file(&mut self, path: &str, bytes: &[u8]) -> Result<(), Fault> {
        self.cabinet.files.insert(path.to_owned(), bytes.to_vec());
        Ok(())
    }

    fn append_file(&mut self, path: &str, bytes: &[u8]) -> Result<(), Fault> {
        let file = self.cabinet.files.entry(path.to_owned()).or_default();
        file.extend_from_slice(bytes);
        Ok(())
    }

    fn remove_file(&mut self, path: &str) -> Result<(), Fault> {
        match self.cabinet.files.remove(path) {
            Some(_) => Ok(()),
            None => Err(Fault::File {
                message: format!("{path}: there is no such file in the program's folder"),
            }),
        }
    }

    fn file_names(&self) -> Vec<String> {
        self.cabinet.files.keys().cloned().collect()
    }

    fn configuration(&self, instance: [&str; 3], attribute: &str) -> Option<String> {
        let value = self.cabinet.configuration.value(instance, attribute);
        value.map(str::to_owned)
    }

    fn task_number(&self) -> usize {
        self.cabinet.current + 1
    }

    fn task_moves_arm(&self) -> bool {
        self.cabinet.tasks[self.cabinet.current].role.moves_arm
    }

    fn notices(&self, name: &str) -> u64 {
        self.cabinet.notices.get(name).copied().unwrap_or(0)
    }

    fn meet(&mut self, point: &str, tasks: &[String]) -> Poll<Result<(), Fault>> {
        self.cabinet.meet(point, tasks)
    }

    fn leave_meeting(&mut self, point: &str) {
        self.cabinet.leave_meeting(point);
    }

    fn log(&mut self, kind: LogKind, location: &ProgramLocation, text: &str) {
        self.cabinet.fresh.push(ControllerEvent::Log {
            at: self.cabinet.cursor,
            kind,
            location: location.clone(),
            text: text.to_owned(),
        });
    }

    fn spare_statements(&self) -> u32 {
        let left = self
            .cabinet
            .cycle_limit
            .saturating_since(self.cabinet.cursor);
        let cost = self.cabinet.statement_cost.as_nanos().max(1);
        u32::try_from(left.as_nanos().div_ceil(cost).saturating_sub(1)).unwrap_or(0)
    }

    fn statements_ran(&mut self, count: u32) {
        let passed = self.cabinet.statement_cost.as_nanos() * u64::from(count);
        self.cabinet.cursor += SimDuration::from_nanos(passed);
    }

    fn statement(&mut self, location: &ProgramLocation) {
        // Most statements lie in the routine of the one before: the strings are reused.
        let at = self.cabinet.cursor;
        match &mut self.cabinet.tasks[self.cabinet.current].statement {
            Some((begun, known)) => {
                *begun = at;
                if known.routine != location.routine || known.module != location.module {
                    known.clone_from(location);
                }
                known.line = location.line;
            }
            none => *none = Some((at, location.clone())),
        }
    }
}
