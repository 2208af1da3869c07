//! A controller on a thread: its block is memory that the test plays the program on.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use depal_wire::s7::{
    CotpConnect, CotpPacket, DataBlock, Field, S7Body, S7Message, TelegramReader, answer,
};
use socket2::SockRef;

use crate::s7::PlcAddress;

/// What the controller does with one packet.
pub enum Act {
    Normal,
    /// Does what it is asked, and answers something else.
    Change(fn(Vec<u8>) -> Vec<u8>),
    /// Answers a telegram with another body.
    Body(fn(S7Body) -> S7Body),
    /// Answers with these bytes and nothing more.
    Raw(&'static [u8]),
    /// The good answer in pieces, with a pause between.
    Pieces(usize, Duration),
    Silence,
    /// Closes before it does anything.
    Close,
    /// Does what it is asked, and closes.
    CloseAfter,
    /// Closes with a reset.
    Reset,
}

/// One packet that came.
pub struct Packet<'a> {
    /// Connections so far, from 1.
    pub connection: usize,
    /// Packets of this connection so far, from 0: connect, setup, then the rest.
    pub number: usize,
    pub request: Option<&'a S7Body>,
}

impl Packet<'_> {
    /// Whether this writes to a register.
    pub fn writes(&self, field: Field) -> bool {
        matches!(self.request, Some(S7Body::WriteRequest(items))
            if items.iter().any(|(address, _)| address.first_byte() == field.offset()))
    }

    /// Whether this reads or writes variables.
    pub fn is_transfer(&self) -> bool {
        matches!(
            self.request,
            Some(S7Body::ReadRequest(_) | S7Body::WriteRequest(_))
        )
    }
}

pub type Fault = fn(&Packet<'_>) -> Act;

#[derive(Clone)]
pub struct FakePlc {
    pub address: SocketAddr,
    block: Arc<Mutex<DataBlock>>,
    /// Connections taken so far.
    pub connections: Arc<AtomicUsize>,
    /// Registers as they were written, heartbeats left out.
    pub written: Arc<Mutex<Vec<Field>>>,
    /// When Heartbeat was written.
    pub beats: Arc<Mutex<Vec<Instant>>>,
    fault: Fault,
}

impl FakePlc {
    pub fn start(fault: Fault) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        Self::start_on(listener, fault)
    }

    pub fn start_on(listener: TcpListener, fault: Fault) -> Self {
        let plc = Self {
            address: listener.local_addr().expect("bound"),
            block: Arc::default(),
            connections: Arc::default(),
            written: Arc::default(),
            beats: Arc::default(),
            fault,
        };
        let server = plc.clone();
        thread::spawn(move || {
            while let Ok((stream, _)) = listener.accept() {
                let connection = server.connections.fetch_add(1, Ordering::SeqCst) + 1;
                let server = server.clone();
                thread::spawn(move || server.serve(stream, connection));
            }
        });
        plc
    }

    pub fn plc(&self) -> PlcAddress {
        PlcAddress {
            poll: Duration::from_millis(5),
            ..PlcAddress::new(self.address)
        }
    }

    /// Everything to the end of the connection.
    fn serve(&self, mut stream: TcpStream, connection: usize) -> Option<()> {
        stream.set_nodelay(true).ok()?;
        let mut reader = TelegramReader::new(480);
        let mut pdu = 480;
        let mut number = 0;
        let mut chunk = [0; 1024];
        loop {
            let count = stream.read(&mut chunk).ok().filter(|count| *count > 0)?;
            reader.push(&chunk[..count]);
            while let Some(packet) = reader.poll().ok()? {
                let message = match &packet {
                    CotpPacket::Data { payload, .. } => Some(S7Message::parse(payload).ok()?),
                    _ => None,
                };
                let act = (self.fault)(&Packet {
                    connection,
                    number,
                    request: message.as_ref().map(|message| &message.body),
                });
                number += 1;
                match act {
                    Act::Close => return None,
                    Act::Reset => {
                        SockRef::from(&stream)
                            .set_linger(Some(Duration::ZERO))
                            .ok()?;
                        return None;
                    }
                    Act::Raw(bytes) => stream.write_all(bytes).ok()?,
                    Act::Silence => {}
                    Act::CloseAfter => {
                        self.reply(packet, message, &mut pdu, |body| body);
                        return None;
                    }
                    Act::Body(change) => {
                        let frame = self.reply(packet, message, &mut pdu, change);
                        stream.write_all(&frame).ok()?;
                    }
                    Act::Normal => {
                        let frame = self.reply(packet, message, &mut pdu, |body| body);
                        stream.write_all(&frame).ok()?;
                    }
                    Act::Change(change) => {
                        let frame = self.reply(packet, message, &mut pdu, |body| body);
                        stream.write_all(&change(frame)).ok()?;
                    }
                    Act::Pieces(len, pause) => {
                        let frame = self.reply(packet, message, &mut pdu, |body| body);
                        for piece in frame.chunks(len) {
                            stream.write_all(piece).ok()?;
                            thread::sleep(pause);
                        }
                    }
                }
            }
        }
    }

    fn reply(
        &self,
        packet: CotpPacket,
        message: Option<S7Message>,
        pdu: &mut u16,
        change: impl Fn(S7Body) -> S7Body,
    ) -> Vec<u8> {
        let Some(message) = message else {
            let CotpPacket::ConnectRequest(request) = packet else {
                return Vec::new();
            };
            return CotpPacket::ConnectConfirm(CotpConnect {
                destination: request.source,
                source: 3,
                ..request
            })
            .emit();
        };
        if let S7Body::WriteRequest(items) = &message.body {
            for (address, _) in items {
                match Field::at(address.first_byte()).expect("inside the block") {
                    Field::Heartbeat => self.beats.lock().expect("alive").push(Instant::now()),
                    field => self.written.lock().expect("alive").push(field),
                }
            }
        }
        let mut block = self.block.lock().expect("alive");
        let (body, _) = answer(&mut block, pdu, message.body);
        let body = change(body);
        // A changed setup counts for this end, too.
        if let S7Body::SetupReply(setup) = &body {
            *pdu = setup.pdu.min(480);
        }
        CotpPacket::data(
            S7Message {
                reference: message.reference,
                body,
            }
            .emit(),
        )
        .emit()
    }

    /// The program looks at or changes the block.
    pub fn block<T>(&self, look: impl FnOnce(&mut DataBlock) -> T) -> T {
        look(&mut self.block.lock().expect("alive"))
    }

    pub fn wait(&self, what: &str, done: impl Fn(&DataBlock) -> bool) {
        let started = Instant::now();
        while !self.block(|block| done(block)) {
            assert!(
                started.elapsed() < Duration::from_secs(20),
                "waited 20 s for: {what}"
            );
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// The four-way handshake; Status at its end.
    pub fn call(&self, command: i16) -> i16 {
        self.block(|block| {
            block.set_int(Field::Command, 0, command);
            block.set_bool(Field::Trigger, true);
        });
        self.wait("Acknowledge", |block| block.bool(Field::Acknowledge));
        self.block(|block| block.set_bool(Field::Trigger, false));
        self.wait("Acknowledge falls", |block| !block.bool(Field::Acknowledge));
        self.wait("Status", |block| block.int(Field::Status, 0) != 0);
        self.block(|block| block.int(Field::Status, 0))
    }

    /// 101 and 102: the points are there.
    pub fn fetch(&self) {
        self.block(|block| block.set_int(Field::Project, 0, 1));
        assert_eq!(self.call(101), 1102);
        assert_eq!(self.call(102), 1100);
        self.wait("Status of Pose Sent", |block| block.bool(Field::PoseSent));
        self.block(|block| {
            assert_eq!(block.int(Field::PoseCount, 0), 3);
            assert_eq!(block.int(Field::TargetLabel, 2), 3);
            assert_eq!(block.real(Field::TargetPose, 12), 300.0);
        });
    }
}
