//! `depal serve` as a controller meets it: the real program, a data block on either side.
#![allow(missing_docs, clippy::disallowed_methods)]

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use depal_wire::s7::{
    BLOCK_BYTES, CotpConnect, CotpPacket, DataBlock, Field, ReturnCode, S7Body, S7Message, Setup,
    TelegramReader, Tsap, VarAddress, VarData,
};

use served::{BINARY, FEW, Served};

mod served;

fn served(args: &[&str]) -> Served {
    Served::start(&[args, FEW].concat())
}

/// The block, wherever it is.
trait Block {
    fn read(&mut self, first: usize, len: usize) -> Result<Vec<u8>, ReturnCode>;
    fn write(&mut self, first: usize, bytes: &[u8]);

    fn int(&mut self, field: Field) -> i16 {
        let bytes = self.read(field.offset(), 2).expect("inside");
        i16::from_be_bytes([bytes[0], bytes[1]])
    }

    fn set(&mut self, field: Field, value: i16) {
        self.write(field.offset(), &value.to_be_bytes());
    }

    fn is_set(&mut self, field: Field) -> bool {
        self.read(field.offset(), 1).expect("inside")[0] & 1 != 0
    }

    fn wait(&mut self, field: Field, value: bool) {
        let started = Instant::now();
        while self.is_set(field) != value {
            assert!(
                started.elapsed() < Duration::from_secs(15),
                "{field:?} is not {value}"
            );
            thread::sleep(Duration::from_millis(1));
        }
    }

    fn call(&mut self, command: i16) -> i16 {
        self.set(Field::Command, command);
        self.write(0, &[1]);
        self.wait(Field::Acknowledge, true);
        self.write(0, &[0]);
        self.wait(Field::Acknowledge, false);
        let started = Instant::now();
        loop {
            let status = self.int(Field::Status);
            if status != 0 {
                return status;
            }
            assert!(
                started.elapsed() < Duration::from_secs(15),
                "{command} has no Status"
            );
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// What an integrator's program asks for.
    fn cycle(&mut self) {
        self.set(Field::Project, 1);
        self.set(Field::PoseType, 0);
        assert_eq!(self.call(901), 1101);
        for (place, side) in [400.0_f32, 300.0, 250.0].into_iter().enumerate() {
            self.write(Field::BoxSize.offset() + 4 * place, &side.to_be_bytes());
        }
        assert_eq!(self.call(501), 1108);
        assert_eq!(self.call(101), 1102);
        assert_eq!(self.call(102), 1100);
        self.wait(Field::PoseSent, true);
        assert_eq!(self.int(Field::PoseCount), 8);
        assert_eq!(self.call(201), 2103);
        self.set(Field::Project, 0);
        self.set(Field::PoseType, 4);
        assert_eq!(self.call(210), 2100);
        self.wait(Field::PoseSent, true);
        let count = self.int(Field::PoseCount) as usize;
        assert!((4..=20).contains(&count), "{count}");
        let pick = self.int(Field::VisionMoveIndex) as usize;
        assert!((1..=count).contains(&pick), "{pick} of {count}");
        let flags = self
            .read(Field::IsVisionMove.offset(), 2 * count)
            .expect("inside");
        assert_eq!(flags[2 * pick - 1], 1);
        let row = Field::PlanResult.offset() + 160 * (pick - 1);
        let plan = self.read(row, 84).expect("inside");
        let real = |place: usize| {
            f32::from_be_bytes(
                plan[4 * place..4 * place + 4]
                    .try_into()
                    .expect("four bytes"),
            )
        };
        assert_eq!([real(18), real(19), real(20)], [400.0, 300.0, 250.0]);
        assert_eq!(self.call(206), 2102);
        let list = self
            .read(Field::DigitalOutput.offset(), 128)
            .expect("inside");
        assert!(
            list[..2] != [0xff, 0xff] && list[126..] == [0xff, 0xff],
            "{list:?}"
        );
        assert_eq!(self.call(210), 2022);
    }
}

/// A block that is offered.
struct Remote {
    stream: TcpStream,
    reader: TelegramReader,
    reference: u16,
}

impl Remote {
    fn connect(address: SocketAddr, called: Tsap) -> Self {
        let stream = TcpStream::connect(address).expect("it listens");
        stream.set_nodelay(true).expect("a socket");
        stream
            .set_read_timeout(Some(Duration::from_secs(10)))
            .expect("a socket");
        let mut remote = Self {
            stream,
            reader: TelegramReader::new(480),
            reference: 0,
        };
        let request = CotpPacket::ConnectRequest(CotpConnect {
            destination: 0,
            source: 9,
            tpdu_size: Some(10),
            calling: Some(Tsap::LOCAL),
            called: Some(called),
        });
        remote.stream.write_all(&request.emit()).expect("sent");
        assert!(matches!(remote.packet(), CotpPacket::ConnectConfirm(c) if c.destination == 9));
        let setup = Setup {
            calling_jobs: 1,
            called_jobs: 1,
            pdu: 480,
        };
        assert_eq!(
            remote.ask(S7Body::SetupRequest(setup)),
            S7Body::SetupReply(setup)
        );
        remote
    }

    fn packet(&mut self) -> CotpPacket {
        let mut chunk = [0; 600];
        loop {
            if let Some(packet) = self.reader.poll().expect("a good frame") {
                return packet;
            }
            let count = self.stream.read(&mut chunk).expect("an answer");
            assert!(count > 0, "closed");
            self.reader.push(&chunk[..count]);
        }
    }

    fn ask(&mut self, body: S7Body) -> S7Body {
        self.reference += 1;
        let reference = self.reference;
        let frame = CotpPacket::data(S7Message { reference, body }.emit()).emit();
        self.stream.write_all(&frame).expect("sent");
        let CotpPacket::Data { payload, .. } = self.packet() else {
            panic!("no telegram");
        };
        let answer = S7Message::parse(&payload).expect("a good telegram");
        assert_eq!(answer.reference, reference);
        answer.body
    }
}

impl Block for Remote {
    fn read(&mut self, first: usize, len: usize) -> Result<Vec<u8>, ReturnCode> {
        let address = VarAddress::bytes(1, first as u16, len as u16);
        match self.ask(S7Body::ReadRequest(vec![address])) {
            S7Body::ReadReply(mut values) => values.remove(0).map(|value| value.bytes),
            other => panic!("{other:?}"),
        }
    }

    fn write(&mut self, first: usize, bytes: &[u8]) {
        let address = VarAddress::bytes(1, first as u16, bytes.len() as u16);
        let answer = self.ask(S7Body::WriteRequest(vec![(address, VarData::bytes(bytes))]));
        assert_eq!(answer, S7Body::WriteReply(vec![ReturnCode::OK]));
    }
}

/// A controller that offers its block: the program is played on the memory.
#[derive(Clone, Default)]
struct Plc(Arc<Mutex<DataBlock>>);

impl Plc {
    fn listen(&self) -> SocketAddr {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("bound");
        let plc = self.clone();
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let plc = plc.clone();
                thread::spawn(move || plc.serve(stream));
            }
        });
        address
    }

    fn serve(&self, mut stream: TcpStream) -> Option<()> {
        let mut reader = TelegramReader::new(480);
        let mut chunk = [0; 600];
        loop {
            let count = stream.read(&mut chunk).ok().filter(|count| *count > 0)?;
            reader.push(&chunk[..count]);
            while let Some(packet) = reader.poll().ok()? {
                let reply = match packet {
                    CotpPacket::ConnectRequest(request) => CotpPacket::ConnectConfirm(request),
                    CotpPacket::Data { payload, .. } => {
                        let request = S7Message::parse(&payload).ok()?;
                        let body = self.answer(request.body);
                        let reference = request.reference;
                        CotpPacket::data(S7Message { reference, body }.emit())
                    }
                    _ => return None,
                };
                stream.write_all(&reply.emit()).ok()?;
            }
        }
    }

    fn answer(&self, request: S7Body) -> S7Body {
        let mut block = self.0.lock().expect("alive");
        match request {
            S7Body::SetupRequest(setup) => S7Body::SetupReply(Setup { pdu: 240, ..setup }),
            S7Body::ReadRequest(items) => {
                let value = |item: &VarAddress| {
                    let bytes = block.bytes(item.first_byte(), item.count.into());
                    bytes.map(VarData::bytes).ok_or(ReturnCode::BAD_ADDRESS)
                };
                S7Body::ReadReply(items.iter().map(value).collect())
            }
            S7Body::WriteRequest(items) => {
                let mut codes = Vec::new();
                for (item, value) in items {
                    assert!(
                        item.first_byte() >= 108,
                        "vision wrote byte {}",
                        item.first_byte()
                    );
                    assert!(block.write(item.first_byte(), &value.bytes));
                    codes.push(ReturnCode::OK);
                }
                S7Body::WriteReply(codes)
            }
            other => panic!("{other:?}"),
        }
    }
}

impl Block for Plc {
    fn read(&mut self, first: usize, len: usize) -> Result<Vec<u8>, ReturnCode> {
        let block = self.0.lock().expect("alive");
        Ok(block.bytes(first, len).expect("inside").to_vec())
    }

    fn write(&mut self, first: usize, bytes: &[u8]) {
        assert!(self.0.lock().expect("alive").write(first, bytes));
    }
}

#[test]
fn a_controller_is_polled() {
    let mut plc = Plc::default();
    let address = plc.listen();
    let listen = format!("s7={address}?db=1&rack=0&slot=2&poll_ms=10");
    let mut served = served(&["--listen", &listen]);
    assert_eq!(served.port(0), ("s7".to_owned(), address));
    served.wait_told("connected to DB 1, rack 0, slot 2, telegrams of 240 bytes");
    plc.cycle();
    let beat = plc.is_set(Field::Heartbeat);
    plc.wait(Field::Heartbeat, !beat);
    assert_eq!(served.terminate().0, Some(0));
}

#[test]
fn a_controller_that_is_not_there() {
    let reserved = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = reserved.local_addr().expect("bound");
    drop(reserved);
    let listen = format!("s7={address}");
    let mut served = served(&["--listen", &listen, "--listen", "ascii=127.0.0.1:0"]);
    assert_eq!(served.port(0), ("s7".to_owned(), address));
    served.wait_told(&format!("PLC {address}: cannot connect"));
    // Other ports do not mind.
    let mut robot = TcpStream::connect(served.port(1).1).expect("it listens");
    robot.write_all(b"901\r").expect("sent");
    let mut reply = [0; 9];
    robot.read_exact(&mut reply).expect("a reply");
    assert_eq!(&reply, b"901,1101\r");
    assert_eq!(served.terminate().0, Some(0));
}

#[test]
fn the_block_is_offered() {
    let journal = Path::new(env!("CARGO_TARGET_TMPDIR")).join("s7.jsonl");
    let journal = journal.to_str().expect("text");
    let mut served = served(&["--listen", "s7-server=127.0.0.1:0", "--journal", journal]);
    let (kind, address) = served.port(0);
    assert_eq!(kind, "s7-server");
    assert!(address.port() > 0);
    // Any rack and slot, and several clients of one block.
    let mut watcher = Remote::connect(address, Tsap::of_place(7, 31));
    let mut plc = Remote::connect(address, Tsap::of_place(0, 2));
    plc.cycle();
    assert_eq!(watcher.int(Field::Status), 2022);
    assert!(watcher.read(BLOCK_BYTES - 1, 1).is_ok());
    assert_eq!(
        watcher.read(BLOCK_BYTES - 1, 2),
        Err(ReturnCode::BAD_ADDRESS)
    );
    let other = VarAddress::bytes(2, 0, 2);
    assert_eq!(
        watcher.ask(S7Body::ReadRequest(vec![other])),
        S7Body::ReadReply(vec![Err(ReturnCode::NO_OBJECT)])
    );
    // A client that ends in the middle of a telegram hurts nobody.
    let mut rude = TcpStream::connect(address).expect("it listens");
    rude.write_all(&[3, 0, 0, 22, 17]).expect("sent");
    drop(rude);
    plc.set(Field::Project, 1);
    assert_eq!(plc.call(901), 1101);
    assert_eq!(served.terminate().0, Some(0));
    // The journal answers the same without sockets.
    let replayed = Command::new(BINARY)
        .args(["serve", "--replay", journal])
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&replayed.stderr);
    assert!(replayed.status.success(), "{said}");
    assert!(said.contains("all as recorded"), "{said}");
}

/// Two blocks are two sessions.
#[test]
fn blocks_do_not_touch_one_another() {
    let served = served(&["--listen", "s7-server=:0", "--listen", "s7-server=:0"]);
    let mut first = Remote::connect(served.port(0).1, Tsap::LOCAL);
    let mut second = Remote::connect(served.port(1).1, Tsap::LOCAL);
    first.set(Field::Project, 1);
    assert_eq!(first.call(101), 1102);
    assert_eq!(second.int(Field::Project), 0);
    second.set(Field::Project, 1);
    assert_eq!(second.call(102), 1020);
    assert_eq!(first.call(102), 1100);
}
