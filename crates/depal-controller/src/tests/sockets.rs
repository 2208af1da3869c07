use std::collections::BTreeMap;

use depal_vm::system::{Received, SocketId, SocketState};

use super::*;
use crate::ControllerState;

/// A network of one peer in memory: it echoes after a delay, refuses, stays silent, or closes after its first answer.
struct Peer {
    manner: Manner,
    delay: SimDuration,
    inbox: BTreeMap<SocketId, Vec<(SimTime, Vec<u8>)>>,
    connecting_since: Option<SimTime>,
    closed: Vec<(String, SocketId)>,
}

#[derive(PartialEq, Clone, Copy)]
enum Manner {
    Echo,
    Refuse,
    Silent,
    CloseAfterAnswer,
}

fn peer(manner: Manner) -> Peer {
    Peer {
        manner,
        delay: SimDuration::from_millis(30),
        inbox: BTreeMap::new(),
        connecting_since: None,
        closed: Vec::new(),
    }
}

impl Network for Peer {
    fn connect(
        &mut self,
        now: SimTime,
        controller: &str,
        socket: SocketId,
        address: &str,
        port: u16,
    ) -> Poll<Result<(), Fault>> {
        assert_eq!((controller, address, port), ("rob1", "192.168.1.10", 50000));
        let since = *self.connecting_since.get_or_insert(now);
        if now - since < self.delay {
            return Poll::Pending;
        }
        if self.manner == Manner::Refuse {
            return Poll::Ready(Err(Fault::SocketClosed));
        }
        self.inbox.insert(socket, Vec::new());
        Poll::Ready(Ok(()))
    }

    fn send(&mut self, now: SimTime, _: &str, socket: SocketId, bytes: &[u8]) -> Result<(), Fault> {
        if self.manner != Manner::Silent {
            let due = now + self.delay;
            self.inbox
                .get_mut(&socket)
                .ok_or(Fault::SocketClosed)?
                .push((due, bytes.to_vec()));
        }
        Ok(())
    }

    fn receive(&mut self, now: SimTime, _: &str, socket: SocketId, limit: usize) -> Poll<Received> {
        let inbox = self.inbox.get_mut(&socket).expect("connected");
        let Some((due, bytes)) = inbox.first_mut() else {
            return if self.manner == Manner::CloseAfterAnswer {
                Poll::Ready(Received::Closed)
            } else {
                Poll::Pending
            };
        };
        if *due > now {
            return Poll::Pending;
        }
        let data = bytes.drain(..limit.min(bytes.len())).collect();
        if bytes.is_empty() {
            inbox.remove(0);
        }
        Poll::Ready(Received::Data(data))
    }

    fn close(&mut self, _: SimTime, controller: &str, socket: SocketId) {
        self.closed.push((controller.to_owned(), socket));
        self.inbox.remove(&socket);
    }
}

const SOCKET: SocketId = SocketId(0);

fn connected() -> Script {
    Script::new()
        .then(|system| {
            assert_eq!(system.socket_create(), SOCKET);
            assert_eq!(system.socket_state(SOCKET), SocketState::Created);
            Poll::Ready(Ok(()))
        })
        .then(|system| system.socket_connect(SOCKET, "192.168.1.10", 50000))
        .then(|system| Poll::Ready(system.socket_send(SOCKET, b"101, 1\r")))
}

/// Waits for exactly these bytes, taking at most four at a time, for at most so long.
fn receive(script: Script, expected: &'static [u8], seconds: f64) -> Script {
    let mut got = Vec::new();
    let mut since = None;
    script.then(move |system| {
        let since = *since.get_or_insert(system.now());
        match system.socket_receive(SOCKET, 4) {
            Poll::Pending if (system.now() - since).as_secs_f64() >= seconds => {
                Poll::Ready(system.set_signal("goSections", 9.0))
            }
            Poll::Pending => Poll::Pending,
            Poll::Ready(Err(fault)) => Poll::Ready(Err(fault)),
            Poll::Ready(Ok(Received::Closed)) => Poll::Ready(Err(Fault::SocketClosed)),
            Poll::Ready(Ok(Received::Data(bytes))) => {
                assert!(!bytes.is_empty() && bytes.len() <= 4);
                got.extend(bytes);
                if got == expected {
                    Poll::Ready(system.set_signal("doVacuum", 1.0))
                } else {
                    Poll::Pending
                }
            }
        }
    })
}

#[test]
fn echo_arrives_after_its_delay() {
    let mut network = peer(Manner::Echo);
    let mut controller = controller(receive(connected(), b"101, 1\r", 1.0));
    let (events, _) = run(&mut controller, &mut network, 100);
    // 30 ms to connect and 30 ms for the answer, each found at a cycle; and one cycle for the second piece.
    let at = edge(&events, "doVacuum").as_secs_f64();
    assert!((0.060..0.076).contains(&at), "{at}");
    assert_eq!(*controller.state(), ControllerState::Finished);
    assert_eq!(
        network.closed,
        [("rob1".to_owned(), SOCKET)],
        "closed with the task"
    );
}

#[test]
fn silence_is_timed_by_the_program() {
    let mut network = peer(Manner::Silent);
    let mut controller = controller(receive(connected(), b"101, 1\r", 2.0));
    let (events, _) = run(&mut controller, &mut network, 1000);
    let at = edge(&events, "goSections").as_secs_f64();
    assert!((2.030..2.044).contains(&at), "{at}");
}

#[test]
fn refusal_and_closing_are_faults() {
    let mut network = peer(Manner::Refuse);
    let mut refused = controller(connected());
    run(&mut refused, &mut network, 100);
    let ControllerState::Failed(error) = refused.state() else {
        panic!("{:?}", refused.state());
    };
    assert_eq!(
        (error.name.as_str(), error.call_stack[0].line),
        ("SocketClosed", 2)
    );

    let mut network = peer(Manner::CloseAfterAnswer);
    let script = receive(receive(connected(), b"101, 1\r", 1.0), b"more", 1.0);
    let mut closed = controller(script);
    run(&mut closed, &mut network, 100);
    let ControllerState::Failed(error) = closed.state() else {
        panic!("{:?}", closed.state());
    };
    assert_eq!(
        (error.name.as_str(), error.call_stack[0].line),
        ("SocketClosed", 5)
    );
    assert_eq!(
        closed.output("doVacuum"),
        Ok(1.0),
        "the answer before the end was read"
    );
}

#[test]
fn sockets_in_the_wrong_state() {
    let script = Script::new().then(|system| {
        let socket = system.socket_create();
        assert!(matches!(
            system.socket_send(socket, b"x"),
            Err(Fault::SocketState { .. })
        ));
        assert!(matches!(
            system.socket_receive(socket, 10),
            Poll::Ready(Err(Fault::SocketState { .. }))
        ));
        system.socket_close(socket);
        assert_eq!(system.socket_state(socket), SocketState::Closed);
        assert_eq!(system.socket_send(socket, b"x"), Err(Fault::SocketClosed));
        assert_eq!(
            system.socket_connect(socket, "192.168.1.10", 50000),
            Poll::Ready(Err(Fault::SocketClosed))
        );
        Poll::Ready(Ok(()))
    });
    let mut controller = controller(script);
    run(&mut controller, &mut NoNetwork, 2);
    assert_eq!(*controller.state(), ControllerState::Finished);
}
