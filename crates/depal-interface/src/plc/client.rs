//! A client of a controller's data block without sockets: bytes in, bytes out.

use depal_time::SimTime;
use depal_wire::s7::{
    CotpConnect, CotpPacket, MIN_PDU, PREFERRED_PDU, S7Body, S7Error, S7Message, Setup,
    TelegramReader, Tsap, VarAddress, VarData, read_capacity, write_capacity,
};
use thiserror::Error;

use super::{Handshake, HandshakeSettings, Transfer};

/// Why a connection is of no more use.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PlcClientError {
    /// Bytes that are no telegram.
    #[error("unreadable answer: {0}")]
    Wire(#[from] S7Error),
    /// The controller refuses, or answers something else.
    #[error("{0}")]
    Refused(String),
}

/// [`Handshake`] and telegrams in one: what stands between a connection to a controller and a session.
///
/// After every call that takes something in, poll [`poll_output`](Self::poll_output) and
/// [`poll_request`](Self::poll_request) until `None`, and call [`handle_timeout`](Self::handle_timeout) when
/// [`poll_timeout`](Self::poll_timeout) is due. After an error, close and [connect](Self::handle_connect) again.
#[derive(Debug, Clone)]
pub struct PlcClient {
    handshake: Handshake,
    db: u16,
    called: Tsap,
    reader: TelegramReader,
    stage: Stage,
    pdu: u16,
    reference: u16,
    output: Vec<u8>,
}

#[derive(Debug, Clone)]
enum Stage {
    Down,
    Connecting,
    Agreeing,
    Idle,
    /// A transfer, and how much of it is done.
    Transferring {
        transfer: Transfer,
        read: Vec<u8>,
        written: usize,
    },
}

impl PlcClient {
    /// For data block `db` of the processor in `rack` and `slot`; not connected.
    pub fn new(settings: HandshakeSettings, db: u16, rack: u8, slot: u8) -> Self {
        Self {
            handshake: Handshake::new(settings),
            db,
            called: Tsap::of_place(rack, slot),
            reader: TelegramReader::new(usize::from(PREFERRED_PDU)),
            stage: Stage::Down,
            pdu: PREFERRED_PDU,
            reference: 0,
            output: Vec::new(),
        }
    }

    /// A connection is there.
    pub fn handle_connect(&mut self) {
        self.handle_disconnect();
        self.stage = Stage::Connecting;
        let request = CotpPacket::ConnectRequest(CotpConnect {
            destination: 0,
            source: 1,
            tpdu_size: Some(10),
            calling: Some(Tsap::LOCAL),
            called: Some(self.called),
        });
        self.output.extend(request.emit());
    }

    /// The connection is gone.
    pub fn handle_disconnect(&mut self) {
        self.handshake.handle_disconnect();
        self.stage = Stage::Down;
        self.reader = TelegramReader::new(usize::from(PREFERRED_PDU));
        self.output.clear();
    }

    /// Bytes came.
    pub fn handle_input(&mut self, now: SimTime, bytes: &[u8]) -> Result<(), PlcClientError> {
        self.reader.push(bytes);
        while let Some(packet) = self.reader.poll()? {
            match (packet, &self.stage) {
                (CotpPacket::ConnectConfirm(_), Stage::Connecting) => {
                    self.stage = Stage::Agreeing;
                    self.ask(S7Body::SetupRequest(Setup {
                        calling_jobs: 1,
                        called_jobs: 1,
                        pdu: PREFERRED_PDU,
                    }));
                }
                (CotpPacket::Data { payload, .. }, _) => {
                    let message = S7Message::parse(&payload)?;
                    if message.reference == self.reference {
                        self.take(now, message.body)?;
                    }
                }
                (packet, stage) => {
                    return Err(refused(format!("{packet:?} while {stage:?}")));
                }
            }
        }
        self.handle_timeout(now);
        Ok(())
    }

    /// One whole reply of the session.
    pub fn handle_reply(&mut self, now: SimTime, bytes: &[u8]) {
        self.handshake.handle_reply(bytes);
        self.handle_timeout(now);
    }

    /// Time passed.
    pub fn handle_timeout(&mut self, now: SimTime) {
        if matches!(self.stage, Stage::Idle)
            && let Some(transfer) = self.handshake.poll_transfer(now)
        {
            self.stage = Stage::Transferring {
                transfer,
                read: Vec::new(),
                written: 0,
            };
            self.ask_next();
        }
    }

    /// Bytes to send.
    pub fn poll_output(&mut self) -> Option<Vec<u8>> {
        (!self.output.is_empty()).then(|| std::mem::take(&mut self.output))
    }

    /// The next request for the session.
    pub fn poll_request(&mut self) -> Option<Vec<u8>> {
        self.handshake.poll_request()
    }

    /// What people should know.
    pub fn poll_notice(&mut self) -> Option<String> {
        self.handshake.poll_notice()
    }

    /// When [`handle_timeout`](Self::handle_timeout) has something to do.
    pub fn poll_timeout(&self) -> Option<SimTime> {
        let is_idle = matches!(self.stage, Stage::Idle);
        self.handshake.poll_timeout().filter(|_| is_idle)
    }

    fn take(&mut self, now: SimTime, body: S7Body) -> Result<(), PlcClientError> {
        match (&mut self.stage, body) {
            (Stage::Agreeing, S7Body::SetupReply(setup)) if setup.pdu >= MIN_PDU => {
                self.pdu = setup.pdu.min(PREFERRED_PDU);
                self.stage = Stage::Idle;
                self.handshake.handle_connect();
            }
            (
                Stage::Transferring {
                    transfer: Transfer::Read { first, len },
                    read,
                    ..
                },
                S7Body::ReadReply(values),
            ) => {
                let part = (*len - read.len()).min(read_capacity(self.pdu));
                match values.as_slice() {
                    [Ok(value)] if value.bytes.len() == part => read.extend(&value.bytes),
                    other => {
                        let from = *first + read.len();
                        let text = format!("DB {}, {part} bytes from {from}: {other:?}", self.db);
                        return Err(refused(text));
                    }
                }
                if read.len() == *len {
                    let bytes = std::mem::take(read);
                    self.stage = Stage::Idle;
                    self.handshake.handle_read(now, &bytes);
                } else {
                    self.ask_next();
                }
            }
            (
                Stage::Transferring {
                    transfer: Transfer::Write { first, bytes },
                    written,
                    ..
                },
                S7Body::WriteReply(codes),
            ) => {
                if !matches!(codes.as_slice(), [code] if code.is_ok()) {
                    let from = *first + *written;
                    return Err(refused(format!("DB {}, from {from}: {codes:?}", self.db)));
                }
                *written += (bytes.len() - *written).min(write_capacity(self.pdu));
                if *written == bytes.len() {
                    self.stage = Stage::Idle;
                    self.handshake.handle_written(now);
                } else {
                    self.ask_next();
                }
            }
            (stage, body) => return Err(refused(format!("{body:?} while {stage:?}"))),
        }
        Ok(())
    }

    /// Asks for the next part of the transfer.
    fn ask_next(&mut self) {
        let Stage::Transferring {
            transfer,
            read,
            written,
        } = &self.stage
        else {
            return;
        };
        // Places are inside the block, which is far shorter than 64 KiB.
        let body = match transfer {
            Transfer::Read { first, len } => {
                let part = (len - read.len()).min(read_capacity(self.pdu));
                let from = first + read.len();
                let address = VarAddress::bytes(self.db, from as u16, part as u16);
                S7Body::ReadRequest(vec![address])
            }
            Transfer::Write { first, bytes } => {
                let rest = &bytes[*written..];
                let part = &rest[..rest.len().min(write_capacity(self.pdu))];
                let from = first + written;
                let address = VarAddress::bytes(self.db, from as u16, part.len() as u16);
                S7Body::WriteRequest(vec![(address, VarData::bytes(part))])
            }
        };
        self.ask(body);
    }

    fn ask(&mut self, body: S7Body) {
        self.reference = self.reference.wrapping_add(1);
        let reference = self.reference;
        let frame = CotpPacket::data(S7Message { reference, body }.emit()).emit();
        self.output.extend(frame);
    }
}

fn refused(text: String) -> PlcClientError {
    PlcClientError::Refused(text)
}
